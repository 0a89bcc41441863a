"""Motions in time: trajectories by integration, as dense as each motion needs, or at given times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import (
    CoarseTimesWarning,
    InputError,
    jobs_of,
    number,
    one_of,
    positive,
    said,
    warn,
    whole,
    words,
)
from explorer.motion import dense_output
from explorer.motion.integration import MAX_STEPS, InitialValues
from explorer.motion.plan import Plan, plan
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk
from explorer.phase.results import WithStatus
from explorer.phase.states import Array, States, require_states

ALL = ("phi", "chi", "psi", "path", "contact")  # what simulate gives where nothing else is asked for
_VECTORS = ("path", "contact")
_TURNING = ("chi", "psi", *_VECTORS)  # observables of which a curve is wrong where it misses a race
_MOST_TURNED = 1e4  # rad of chi at the start; what is added to a larger one is lost in its last digits
_ROUNDED = 1.0 + 1e-15  # natural units and back may end a motion a hair after its t_end
_MOST_STEPS = 10**9  # of one motion: an hour or so, and `steps` still counts them in 32 bits
_COARSE = 0.5 * np.pi  # rad of chi between two times, beyond which a curve is no longer the motion's


@dataclass(frozen=True, repr=False, eq=False)
class Trajectories(WithStatus):
    """Motions in time, in the units of the disk: what `simulate` returns. Call it with times.

    Arrays have the shape of the states, written ... here, and own axes behind it; of a single state these alone.
    An observable that was not asked for is None. A motion that failed, or falls, is NaN with its status.

    Attributes
    ----------
    t : (..., nt) array
        Times. Without t_eval each motion has its own times; `lengths` says how many. After them, the row of a
        motion is filled with its last time, and in all other arrays with its last value, so that whole rows can be
        drawn. With t_eval, the times given there, the same for all.
    phi : (..., nt) array or None
        Angle to the vertical (rad), -pi/2 to pi/2.
    tilt : (..., nt) array or None
        Angle of the disk's plane to the table (rad), 0 to pi/2: from the nearer of the two flat states. Small
        angles keep all their digits.
    phidot, sigma3, sigma4 : (..., nt) array or None
        Rates of eq. (2.14), units of the disk.
    chi, psi : (..., nt) array or None
        Contact angles in space and in the body (rad); chi starts at `chi0` and psi at 0.
    path, contact : (..., nt, 3) array or None
        Centre of mass and contact point, in the unit of length. The centre starts above the origin.
    status : array of int8
        `Status` of each motion. A motion also has STEP_TOO_SMALL if its path grows so fast, by thousands of r in a
        unit of time, that rounding alone moves it by more than the accuracy asked.
    steps : array of int32
        Attempted steps of the integrator.
    constants_error : (..., 3) array
        How far the constants moved: energy (relative), sigma3_bar and eta (natural units).
    error_estimate : array
        The larger of the errors of the angles (rad) and of the path (r) at the end. It is estimated from three
        things: how far steps were moved to hold the constants; how fast chi turns at the end, since inside a race
        a small error of the time is a large one of chi; and the rounding of a long path. If rounding keeps a path
        from the accuracy asked, the estimate says which accuracy can be reached. Motions that may err by more than
        was asked are followed again by finer steps. Where the constants do not reveal the error, as with I3 = 0,
        in fast spins and after many periods, the motion is integrated twice and the two results are compared.
    lengths : array of int
        Number of times in the row of each motion; 0 where the status is not OK.
    t_end : float
        The last time at which it can be called.
    states : States
        The states in which the motions start.

    Examples
    --------
    >>> import explorer as ex
    >>> motion = ex.simulate(ex.constants_to_states(ex.Disk.uniform(), 1.0, [0.1, 1e-12], 1.0), t_end=3.0)
    >>> motion.chi.shape == motion.t.shape == (2, motion.lengths.max())
    True
    >>> motion([0.0, 1.0]).phi.round(4)
    array([[0.    , 1.3215],
           [0.    , 1.3535]])
    """

    t: Array
    phi: Array | None
    tilt: Array | None
    phidot: Array | None
    sigma3: Array | None
    sigma4: Array | None
    chi: Array | None
    psi: Array | None
    path: Array | None
    contact: Array | None
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array
    error_estimate: Array
    lengths: NDArray[np.int64]
    t_end: float
    states: States
    _start: InitialValues
    _records: dense_output.Records | None
    _jobs: int

    @property
    def observables(self) -> tuple[str, ...]:
        """The names of those that were asked for."""
        return tuple(name for name in (*_OTHERS, *ALL) if getattr(self, name) is not None)

    def at(self, rows: NDArray[np.intp]) -> Trajectories:
        """Some of the motions in a row, by their numbers among all."""
        records = self._records and self._records.at(rows)
        return replace(super().at(rows), _start=self._start.at(rows), _records=records)

    def __call__(self, t: ArrayLike) -> Trajectories:
        """The motions at any times from 0 to `t_end`, also inside a race.

        A state between two points of a curve is found by the method of the integration itself, from the point
        before, and is as accurate as these points. If t_eval was given, the motion is integrated again from its
        start. In a race chi turns at a rate of some 4/eta_hat (natural units), and an error of the time becomes an
        error of chi that many times as large. The time has two errors: that of the integration, which shifts the
        whole race, and the rounding of t, some 1e-15. For eta_hat below 1e-14 you can therefore not tell from a
        single time how far the race has got. But chi as a function of phidot, phi or the path is right at any
        eta_hat.

        Parameters
        ----------
        t : array_like
            Times in any order, of any shape.

        Returns
        -------
        Trajectories
            The same observables, arrays with the shape of the states and behind it that of t.

        Raises
        ------
        InputError
            For times before 0 or after `t_end`.
        """
        (times,), _ = read_columns(t=t)
        if not (np.isfinite(times).all() and np.all((times >= 0.0) & (times <= self.t_end * _ROUNDED))):
            raise InputError(
                f"{said('t', t)}: times must lie between 0 and {self.t_end:g}, to which the motion was followed"
            )
        disk, shape = self.states.disk, np.shape(t)
        order, places = np.unique(times, return_inverse=True)  # the kernels take increasing times
        if self._records is None:
            found = dense_output.sample(self._start, order * disk.rate_unit, self._jobs)[0]
        else:
            found = dense_output.between(self._start, self._records, order)
        at = np.moveaxis(found[:, places].reshape(*self.shape, *shape, 10), -1, 0)
        own = np.broadcast_to(times.reshape(shape), (*self.shape, *shape))[()]
        lengths = np.where(self.lengths > 0, times.size, 0)[()]
        return replace(self, t=own, **_observables(disk, at, self.observables), lengths=lengths)

    def __repr__(self) -> str:
        times = np.atleast_1d(self.t).shape[-1]
        return (
            f"Trajectories of {self.states.size:,} motion(s) to t = {self.t_end:g}, {times:,} time(s)\n"
            f"  status: {self._counted()}\n"
            f"  observables: {', '.join(self.observables)}"
        )


_OTHERS = ("tilt", "phidot", "sigma3", "sigma4")


def simulate(
    states: States,
    t_end: float | None = None,
    *,
    t_eval: ArrayLike | None = None,
    observables: Sequence[str] = ALL,
    method: str = "auto",
    accuracy: float = 1e-6,
    chi0: float = 0.0,
    max_steps: int = MAX_STEPS,
    jobs: int = 1,
) -> Trajectories:
    """Follow motions in time from their initial states, at times as dense as each motion needs.

    After each step the state is projected back onto sigma3_bar and eta. Onto the energy it is projected only once
    in each oscillation of the tilt, and the change of the energy is reported as an error. An eta_hat that was
    given is kept, down to 1e-300. A state on the falling set has the status FALLS.

    Parameters
    ----------
    states : States
        Where the motions start.
    t_end : float, optional
        End of the motion. It is recorded at points between which chi changes by 0.2 rad at most, near F too.
    t_eval : (nt,) array, optional
        Increasing times >= 0 at which to sample instead, the same for all motions.
    observables : sequence of str
        Any of phi, tilt, phidot, sigma3, sigma4, chi, psi, path, contact. Only these are integrated.
    method : str
        'auto' (dopri5 or dop853, whichever is cheaper), 'rk4', 'rk8', 'dopri5' or 'dop853'.
    accuracy : float
        Largest error, 1e-11 to 0.1, of angles (rad) and path (in r) in one passage, which takes about 2 sqrt(r/g).
        Over k passages the error grows like k. During a race the angles may err by more: there the accuracy bounds
        the error of the time at which the race happens.
    chi0 : float
        Contact angle at the start (rad), -1e4 to 1e4.
    max_steps : int
        The most steps that a motion may take, up to 10^9.
    jobs : int
        Threads.

    Returns
    -------
    Trajectories
        The observables at these times; call it for any other time.

    Raises
    ------
    InputError
        For arguments that cannot be used, and if the motions would have to be recorded at more than 4 million
        points of time.

    Warns
    -----
    CoarseTimesWarning
        If chi, psi, path or contact is asked for, and chi turns by more than pi/2 between two times of t_eval.

    Notes
    -----
    Eqs (2.15) to (2.18) of the paper, regularised at flat, with the path by (2.33) and (2.35).

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> states = ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 1.0, 0.7)
    >>> motion = ex.simulate(states, t_end=4.0, accuracy=1e-9)
    >>> bool(abs(np.diff(motion.chi)).max() < 0.2), motion([2.0, 4.0]).phi.round(4)
    (True, array([0.2749, 0.5152]))
    """
    require_states(states)
    end, times = _times(t_end, t_eval)
    names = [one_of("observable", name, (*_OTHERS, *ALL)) for name in words("observables", observables)]
    if not names:
        raise InputError(f"observables: the list is empty; give some of {', '.join((*_OTHERS, *ALL))}")
    how = plan(names, accuracy, method)
    chi0 = number("chi0", chi0, -_MOST_TURNED, _MOST_TURNED)
    start = dense_output.motions(states, how, chi0, whole("max_steps", max_steps, 1, _MOST_STEPS))
    return _followed(states, start, (end, times), tuple(names), jobs_of("jobs", jobs), warns=True)


def trajectories_by(
    states: States, how: Plan, times: Array, observables: Sequence[str] = ALL, chi0: float = 0.0
) -> Trajectories:
    """As `simulate` at given times, by a plan that was made, which may name its setting, and without a warning."""
    start = dense_output.motions(states, how, chi0, MAX_STEPS)
    return _followed(states, start, (float(times[-1]), times), tuple(observables))


def finer(t: Array, parts: int) -> Array:
    """Increasing times with `parts` equal steps for each step there was, for a call of recorded motions."""
    places = np.arange(parts * (t.size - 1) + 1) / parts
    return np.interp(places, np.arange(t.size), t)


def _followed(
    states: States,
    start: InitialValues,
    until: tuple[float, Array | None],
    names: tuple[str, ...],
    jobs: int = 1,
    warns: bool = False,
) -> Trajectories:
    """The motions from their starts. until: the end, and the times where these are given."""
    disk, (end, times), rows, records = states.disk, until, compiled.field.ROW, None
    if times is None:
        records, outcome = dense_output.record(start, end * disk.rate_unit, jobs)
        found, lengths = records.points[:10], records.lengths
        values = _observables(disk, found, names)
        values = {name: None if value is None else records.padded(value) for name, value in values.items()}
        times = records.padded(found[rows.t] * disk.time_unit)
    else:
        sampled, outcome = dense_output.sample(start, times * disk.rate_unit, jobs)
        found = np.moveaxis(sampled, -1, 0)
        values = _observables(disk, found, names)
        lengths = np.where(outcome.status == compiled.status.Status.OK, times.size, 0)
        if warns and set(names) & set(_TURNING):
            _warn_of_races(abs(np.diff(found[rows.chi])).max(axis=1, initial=0.0))
    known = {**values, **outcome._asdict(), "lengths": lengths, "t_end": end, "states": states}
    known["t"] = np.broadcast_to(times, (states.size, times.shape[-1]))
    known["constants_error"] = outcome.constants_error.T
    return Trajectories(**known, _start=start, _records=records, _jobs=jobs).reshaped(states.shape)


def _times(t_end: float | None, t_eval: ArrayLike | None) -> tuple[float, Array | None]:
    """The end of the motion, and the times that were given."""
    if t_eval is None:
        if t_end is None:
            raise InputError("t_end: is missing; give the end of the time, or the times themselves as t_eval")
        return positive("t_end", t_end), None
    (times,), _ = read_columns(t_eval=t_eval)
    if not (times.size > 0 and np.isfinite(times).all() and np.all(np.diff(times) > 0.0) and times[0] >= 0.0):
        raise InputError(f"{said('t_eval', t_eval)} must be a non-empty list of finite, increasing times >= 0")
    last = float(times[-1])
    if t_end is None:
        return last, times
    end = number("t_end", t_end)
    if last > end:
        raise InputError(f"t_eval goes to {last:g}, past t_end = {end:g}; leave out one of them")
    return end, times


def _observables(disk: Disk, states: Array, names: Sequence[str]) -> dict[str, Any]:
    """The observables `names` of states (10, ...) in the units of the disk, and None for all others."""
    q, z, p, rho, sigma4, _t, chi, psi, a1, a2 = states
    r, unit = disk.r, disk.rate_unit
    height = shadow = q
    if "path" in names or "contact" in names:
        # An integration keeps q^2 + z^2 = 1 to its own error; the rim is r away from the centre whatever that is.
        norm = np.hypot(q, z)
        height, shadow = q / norm, z / norm
    values: dict[str, Callable[[], Array]] = {
        "phi": lambda: np.arctan2(z, q),
        "tilt": lambda: np.arctan2(q, abs(z)),
        "phidot": lambda: -p * unit,
        "sigma3": lambda: q * rho * unit,
        "sigma4": lambda: sigma4 * unit,
        "chi": lambda: chi,
        "psi": lambda: psi,
        "path": lambda: r * np.stack([a1, a2, height], axis=-1),
        # eq. (2.35): the contact point lies r z (cos chi, sin chi) from the centre's shadow
        "contact": lambda: r * np.stack([a1 + shadow * np.cos(chi), a2 + shadow * np.sin(chi), 0.0 * q], axis=-1),
    }
    return {name: make() if name in names else None for name, make in values.items()}


def _warn_of_races(turned: Array) -> None:
    """Warn where a curve would miss turns of the contact point. turned: the most between two times of each."""
    missed = int(np.sum(turned > _COARSE))
    if missed:
        warn(
            f"t_eval: in {missed:,} of {turned.size:,} motion(s) chi turns by more than pi/2 between two times, "
            f"by up to {np.nanmax(turned):.3g} rad, and a curve through them would miss races; leave t_eval out "
            "for times as dense as the motion needs, and call the result with your own",
            CoarseTimesWarning,
        )

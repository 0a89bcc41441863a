"""Motions in time: exact ones, known for all time, and integrations at given times."""

from __future__ import annotations

import math
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
from explorer.motion.exact import SINCE_START, Exact, Outcome
from explorer.motion.integrated import ByIntegration
from explorer.motion.integration import MAX_STEPS
from explorer.motion.plan import PATH, Plan, plan
from explorer.motion.threads import in_parts
from explorer.phase.arguments import column, read_columns
from explorer.phase.disk import Disk
from explorer.phase.results import WithStatus
from explorer.phase.states import Array, States, require_states

ALL = ("phi", "chi", "psi", "path", "contact")  # what simulate gives where nothing else is asked for
OTHERS = ("tilt", "phidot", "sigma3", "sigma4")
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
        drawn. With t_eval, the times given there.
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
        `Status` of each motion. Of an integrated path it is also STEP_TOO_SMALL if the path grows so fast, by
        thousands of r in a unit of time, that rounding alone moves it by more than the accuracy asked.
    steps : array of int32
        Attempted steps of the integrator; 0 of exact motions.
    constants_error : (..., 3) array
        How far the constants moved: energy (relative), sigma3_bar and eta (natural units); 0 of exact motions.
    error_estimate : array
        The larger of the errors of the angles (rad) and of the path (r), the largest of all times of an exact
        motion, and that at the end of an integration. An exact motion errs by what its series leave out, by the
        rounding of their sums and of the state that was given, and by what a shift of the time, some 1e-16 t,
        makes of chi inside a race. Of an integration it is estimated from how far steps were moved to hold the
        constants, how fast chi turns at the end, and the rounding of a long path; motions that may err by more
        than was asked are followed again by finer steps. Where the constants do not reveal the error, as with I3 =
        0, in fast spins and after many periods, the motion is integrated twice and the two results are compared.
    lengths : array of int
        Number of times in the row of each motion; 0 where the status is not OK.
    period, turn : array or None
        Period of the tilt, and by how much chi increases in it (rad); of exact motions, and NaN where that is not
        known to the accuracy asked, as of one that stands on an equilibrium.
    shift : (..., 3) array or None
        Shift of the centre in the first period, along the table; of exact motions whose path was asked for.
    t_end : float
        The last time. An exact motion can be called at any time, an integration at no later one.
    states : States
        The states in which the motions start.

    Examples
    --------
    >>> import explorer as ex
    >>> motion = ex.simulate(ex.constants_to_states(ex.Disk.uniform(), 1.0, [0.1, 1e-12], 1.0), t_end=3.0)
    >>> motion.chi.shape == motion.t.shape == (2, motion.lengths.max())
    True
    >>> motion([0.5, 1.0]).phi.round(4)
    array([[0.5812, 1.3215],
           [0.5909, 1.3535]])
    """

    t: Array
    # None where it was not asked for; whoever asked knows that it is there.
    phi: Any
    tilt: Any
    phidot: Any
    sigma3: Any
    sigma4: Any
    chi: Any
    psi: Any
    path: Any
    contact: Any
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array
    error_estimate: Array
    lengths: NDArray[np.int64]
    period: Any
    turn: Any
    shift: Any
    t_end: float
    states: States
    _source: Exact | ByIntegration
    _jobs: int

    @property
    def observables(self) -> tuple[str, ...]:
        """The names of those that were asked for."""
        return tuple(name for name in (*OTHERS, *ALL) if getattr(self, name) is not None)

    def at(self, rows: NDArray[np.intp]) -> Trajectories:
        """Some of the motions in a row, by their numbers among all."""
        return replace(super().at(rows), _source=self._source.at(rows))

    def __call__(self, t: ArrayLike, since: str = "start") -> Trajectories:
        """The motions at any times.

        In a race chi turns at a rate of some 4/eta_hat (natural units), so that an error of the time is one of chi
        that many times as large. Times since the start are rounded at some 1e-16 of their size: for eta_hat below
        1e-14 they cannot tell how far the race has got. Times since the lowest point can, at any eta_hat. An
        integration is followed once more from its start.

        Parameters
        ----------
        t : array_like
            Times in any order, of any shape, in the units of the disk. Of an exact motion they may be negative.
        since : str
            'start', or 'lowest' of exact motions: the first point at or after the start at which the motion is
            flattest, of those on the face on which it comes nearest to flat.

        Returns
        -------
        Trajectories
            The same observables, arrays with the shape of the states and behind it that of t.

        Raises
        ------
        InputError
            For times that are not finite and, of an integration, before 0 or after `t_end`.

        Examples
        --------
        >>> import numpy as np, explorer as ex
        >>> states = ex.constants_to_states(ex.Disk.uniform(), 1.0, 1e-200, 1.0)
        >>> motion = ex.simulate(states, t_end=3.0)
        >>> race = motion([-1e-190, 1e-190], since="lowest")
        >>> print(f"{np.diff(race.chi)[0] / np.pi:.4f} pi, and kappa pi is {states.disk.kappa:.4f} pi")
        2.2361 pi, and kappa pi is 2.2361 pi
        """
        one_of("since", since, ("start", "lowest"))
        (times,), _ = read_columns(t=t)
        shape, source = np.shape(t), self._source
        exact, lows = isinstance(source, Exact), SINCE_START
        if not np.isfinite(times).all():
            raise InputError(f"{said('t', t)}: times must be finite")
        if not exact and (since != "start" or not ((times >= 0.0) & (times <= self.t_end * _ROUNDED)).all()):
            raise InputError(
                f"{said('t', t)}, since = {since!r}: times must lie between 0 and {self.t_end:g}, to which the "
                "motion was integrated; a motion of method auto has no such limits"
            )
        if isinstance(source, Exact) and since == "lowest":
            lows = source.lowest()[:, None]
        order, places = (times, np.s_[:]) if exact else np.unique(times, return_inverse=True)
        found = _trajectories(source, self.states, order[None], self.observables, self._jobs, lows)
        return replace(found._in_order(places, shape), t_end=self.t_end)

    def _in_order(self, places: Any, shape: tuple[int, ...]) -> Trajectories:
        """The times at some places, in a shape of their own."""
        axis = len(self.shape)
        arrays = {name: getattr(self, name) for name in ("t", *self.observables)}
        chosen = {
            name: np.moveaxis(np.moveaxis(values, axis, 0)[places], 0, axis) for name, values in arrays.items()
        }
        shaped = {name: v.reshape((*self.shape, *shape, *v.shape[axis + 1 :]))[()] for name, v in chosen.items()}
        return replace(self, **shaped)

    def __repr__(self) -> str:
        times = np.atleast_1d(self.t).shape[-1]
        return (
            f"Trajectories of {self.states.size:,} motion(s) to t = {self.t_end:g}, {times:,} time(s)\n"
            f"  status: {self._counted()}\n"
            f"  observables: {', '.join(self.observables)}"
        )


def simulate(
    states: States,
    t_end: float | None = None,
    *,
    t_eval: ArrayLike | None = None,
    observables: Sequence[str] = ALL,
    method: str = "auto",
    accuracy: float = 1e-6,
    chi0: ArrayLike = 0.0,
    max_steps: int = MAX_STEPS,
    jobs: int = 1,
) -> Trajectories:
    """Motions in time from their initial states, at given times or at times as dense as each motion needs.

    The tilt swings between two turning points, and one swing, as series, gives the motion at any time: method
    'auto' is exact but for rounding, at a cost that does not depend on the time, and keeps an eta_hat that was
    given, down to 1e-300. The other methods integrate step by step: after each step the state is projected back
    onto sigma3_bar and eta, onto the energy once in each oscillation of the tilt, and the change of the energy is
    reported as an error. Where I3 = 0, 'auto' is 'dop853'. A state on the falling set has the status FALLS.

    Parameters
    ----------
    states : States
        Where the motions start.
    t_end : float, optional
        End of the motion, for method 'auto' and I3 > 0. Its times are those between which chi changes by 0.2 rad
        at most, near F too.
    t_eval : (nt,) or (..., nt) array, optional
        Increasing times at which to sample instead, the same for all motions, or those of each. Only those of
        exact motions may be negative, or differ.
    observables : sequence of str
        Any of phi, tilt, phidot, sigma3, sigma4, chi, psi, path, contact. Only these are computed.
    method : str
        'auto', 'rk4', 'rk8', 'dopri5' or 'dop853'.
    accuracy : float
        Largest error, 1e-11 to 0.1, of angles (rad) and path (in r) in one passage, which takes about 2 sqrt(r/g).
        Over k passages the error may grow like k, up to 0.1. During a race the angles may err by more: there the
        accuracy bounds the error of the time at which the race happens. Exact motions err by much less, and are
        refused where rounding of the state makes them err by more.
    chi0 : float or array
        Contact angle at the start (rad), -1e4 to 1e4; an array of the states' shape.
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
        For arguments that cannot be used, and if curves would have more than 4 million points of time.

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
    >>> motion = ex.simulate(states, t_end=4.0)
    >>> bool(abs(np.diff(motion.chi)).max() < 0.2), motion([2.0, 4.0, 1e6]).phi.round(4)
    (True, array([0.2749, 0.5152, 0.2317]))
    """
    require_states(states)
    names = tuple(one_of("observable", name, (*OTHERS, *ALL)) for name in words("observables", observables))
    if not names:
        raise InputError(f"observables: the list is empty; give some of {', '.join((*OTHERS, *ALL))}")
    how, turned, row = plan(names, accuracy, method), _angles(chi0, states), states.flat
    jobs, most = jobs_of("jobs", jobs), whole("max_steps", max_steps, 1, _MOST_STEPS)
    if method == "auto" and states.disk.body.I3 > 0.0:
        source: Exact | ByIntegration = Exact.through(row, turned, accuracy, how.level == PATH)
    else:
        source = ByIntegration.through(row, how, turned, most)
    if t_eval is not None:
        times = _times(t_end, t_eval, states, isinstance(source, Exact))
        return _trajectories(source, states, times, names, jobs, warns=bool(set(names) & set(_TURNING)))
    if t_end is None:
        raise InputError("t_end: is missing; give the end of the time, or the times themselves as t_eval")
    end = positive("t_end", t_end)
    if not isinstance(source, Exact):
        raise InputError(
            f"t_end = {end:g}: method {how.method}, an integration, takes times that are given; give t_eval, or, "
            "where I3 > 0, leave method out"
        )
    times, lows, lengths = source.curve(end * states.disk.rate_unit)
    return _trajectories(source, states, times * states.disk.time_unit, names, jobs, lows, lengths, end)


def trajectories_by(
    states: States, how: Plan, times: Array, observables: Sequence[str] = ALL, chi0: float = 0.0
) -> Trajectories:
    """Integrations at given times, by a plan that was made, which may name its setting, and without a warning."""
    source = ByIntegration.through(states.flat, how, np.full(states.size, chi0), MAX_STEPS)
    return _trajectories(source, states, times[None], tuple(observables))


def at_times(source: Exact, states: States, t: ArrayLike, since: str, names: tuple[str, ...]) -> Trajectories:
    """Exact motions at times of any shape, as a call of Trajectories has them."""
    return _trajectories(source, states, np.zeros((1, 1)), names)(t, since)


def finer(t: Array, parts: int) -> Array:
    """Increasing times with `parts` equal steps for each step there was."""
    places = np.arange(parts * (t.size - 1) + 1) / parts
    return np.interp(places, np.arange(t.size), t)


def _trajectories(
    source: Exact | ByIntegration,
    states: States,
    times: Array,
    names: tuple[str, ...],
    jobs: int = 1,
    lows: Array = SINCE_START,
    lengths: Any = None,
    end: float | None = None,
    warns: bool = False,
) -> Trajectories:
    """The motions of a source at times (n or 1, nt) in the units of the disk; lows: as `Exact.seen` takes them.

    lengths, end: of curves, whose times count from lower turning points, the number and the last one. warns: of
    times between which a curve would miss races.
    """
    n, disk, m = states.size, states.disk, times.shape[1]
    values = {name: np.empty((n, m, *((3,) if name in _VECTORS else ()))) for name in names}
    at, turned = np.array(np.broadcast_to(times, (n, m))), np.zeros(n)

    def part(rows: slice) -> Outcome:
        own_times, own_lows = (table if len(table) == 1 else table[rows] for table in (times, lows))
        seen, outcome = source.at(rows).seen(own_times * disk.rate_unit, own_lows)
        for name, found in _observables(disk, seen, names).items():
            values[name][rows] = found
        if warns:
            turned[rows] = abs(np.diff(seen[compiled.field.ROW.chi])).max(axis=1, initial=0.0)
        if lengths is not None:  # of the points themselves, not of the end, as it was given
            counted = ~np.isnan(own_lows) & (outcome.status == compiled.status.Status.OK)[:, None]
            at[rows] = np.where(counted, seen[compiled.field.ROW.t] * disk.time_unit, at[rows])
        return outcome

    parts = in_parts(jobs, n, part, source.at_once(m))
    columns: list[Any] = [
        None if part[0] is None else np.concatenate(part, axis=-1) for part in zip(*parts, strict=True)
    ]
    outcome = Outcome(*columns)
    _warn_of_races(turned)
    ok = outcome.status == compiled.status.Status.OK
    known: dict[str, Any] = dict.fromkeys(("period", "turn", "shift"))
    if isinstance(source, Exact):
        each, path = compiled.motions.PeriodRow(*outcome.period), source.path
        sure = ok & (each.time_error <= source.accuracy * each.time) & (each.angle_error <= source.accuracy)
        sure &= (not path) | (each.path_error <= source.accuracy)
        each = compiled.motions.PeriodRow(*np.where(sure, outcome.period, np.nan))
        known = {"period": each.time * disk.time_unit, "turn": each.chi}
        away = np.stack([each.a1, each.a2, 0.0 * each.a1], axis=-1)
        known["shift"] = disk.r * away if source.path else None
    return Trajectories(
        t=at,
        **dict.fromkeys((*ALL, *OTHERS)) | values,
        status=outcome.status,
        steps=outcome.steps,
        error_estimate=outcome.error_estimate,
        constants_error=outcome.constants_error.T,
        lengths=np.where(ok, m, 0) if lengths is None else lengths,
        **known,
        t_end=float(times.max(initial=0.0)) if end is None else end,
        states=states,
        _source=source,
        _jobs=jobs,
    ).reshaped(states.shape)


def _angles(chi0: ArrayLike, states: States) -> Array:
    """chi at the start of each motion."""
    given = column("chi0", chi0)
    try:
        angles = np.broadcast_to(given, states.shape).ravel()
    except ValueError:
        raise InputError(f"chi0: has the shape {given.shape}; give a number, or {states.shape}") from None
    if not (abs(angles) <= _MOST_TURNED).all():
        raise InputError(
            f"{said('chi0', chi0)} must be finite numbers, from {-_MOST_TURNED:g} to {_MOST_TURNED:g}"
        )
    return np.array(angles)


def _times(t_end: float | None, t_eval: ArrayLike, states: States, exact: bool) -> Array:
    """The times that were given, (1 or n, nt)."""
    given = np.atleast_1d(column("t_eval", t_eval))
    if given.ndim > 1 and (not exact or given.shape[:-1] != states.shape):
        alone = "exact motions, of method auto, may have times of their own, " if not exact else ""
        raise InputError(f"t_eval: has the shape {given.shape}; {alone}give (nt,) or {(*states.shape, 'nt')}")
    times = given.reshape(-1, given.shape[-1])
    low = -math.inf if exact else 0.0
    if not (times.size > 0 and np.isfinite(times).all() and (np.diff(times) > 0.0).all() and (times >= low).all()):
        least = "" if exact else " >= 0"
        raise InputError(f"{said('t_eval', t_eval)} must be a non-empty list of finite, increasing times{least}")
    end = math.inf if t_end is None else number("t_end", t_end)
    if times.max() > end:
        raise InputError(f"t_eval goes to {times.max():g}, past t_end = {end:g}; leave out one of them")
    return times


def _observables(disk: Disk, states: Array, names: Sequence[str]) -> dict[str, Array]:
    """The observables `names` of states (10, ...) in the units of the disk."""
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
    return {name: values[name]() for name in names}


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

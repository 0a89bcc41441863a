"""Motions in time: trajectories by integration, sampled at given times."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, number, positive, whole
from explorer.motion.plan import ALGEBRA, QUADRATURE, plan
from explorer.motion.starts import held_constants
from explorer.motion.turning_points import MAX_STEPS
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States, columns_of, require_states

_DEFAULT_TIMES = 201  # a curve without corners over some periods, where nothing races


@dataclass(frozen=True)
class Trajectories:
    """Motions sampled at given times, in the units of the disk: what `simulate` returns.

    An observable that was not asked for is None. A motion that failed, or falls, is NaN with its status.

    Attributes
    ----------
    t : (nt,) array
        Times.
    phi : (n, nt) array or None
        Tilt (rad), -pi/2 to pi/2, 0 at the vertical.
    phidot, sigma3, sigma4 : (n, nt) array or None
        Rates of eq. (2.14), units of the disk.
    chi, psi : (n, nt) array or None
        Contact angle and angle of the body, rad; chi starts at `chi0` and psi at 0.
    path, contact : (n, nt, 3) array or None
        Centre of mass and contact point, in the unit of length. The centre starts above the origin.
    status : (n,) array of int8
        `Status` of each motion.
    steps : (n,) array of int32
        Attempted steps of the integrator.
    constants_error : (3, n) array
        How far the constants moved: energy (relative), sigma3_bar and eta (natural units).

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> states = ex.phi_to_states(disk, 0.0, 1.0, 1.0, 0.7)
    >>> motion = ex.simulate(states, t_eval=[0.0, 1.0], observables=["phi"])
    >>> motion.phi.shape, motion.chi is None
    ((1, 2), True)
    """

    t: Array
    phi: Array | None
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


class Integration(TypedDict, total=False):
    """Keywords of `simulate` that say how a motion is integrated; see there."""

    method: str
    accuracy: float
    chi0: float
    max_steps: int


class _Integration(NamedTuple):
    method: str = "auto"
    accuracy: float = 1e-6
    chi0: float = 0.0
    max_steps: int = MAX_STEPS


def simulate(
    states: States,
    t_end: float | None = None,
    *,
    t_eval: ArrayLike | None = None,
    observables: Sequence[str] = ("phi", "chi", "psi", "path", "contact"),
    **integration: Unpack[Integration],
) -> Trajectories:
    """Follow motions in time from their initial states.

    sigma3_bar, eta and the energy are held after every step; what was taken out of the energy on the way is
    reported as its error. States made by `constants_to_states` keep the eta_hat they were given, down to 1e-300.
    A state on the falling set has no motion past the fall: its status is FALLS.

    Parameters
    ----------
    states : States
        Where the motions start.
    t_end : float, optional
        End of the motion; it is sampled at 201 equal steps of time from 0.
    t_eval : (nt,) array, optional
        Increasing times >= 0 at which to sample instead; dense near flat, where the contact point races.
    observables : sequence of str
        Any of phi, phidot, sigma3, sigma4, chi, psi, path, contact. What is not asked for is not integrated.
    **integration
        method : 'auto' (the cheaper adaptive pair), 'rk4', 'rk8', 'dopri5' or 'dop853'. accuracy : error of
        angles (rad) per passage, 1e-11 to 0.1, by default 1e-6; over k passages it grows like k. chi0 : contact
        angle at the start (rad), by default 0. max_steps : attempted steps at most, by default 2 million.

    Returns
    -------
    Trajectories
        The observables at these times, for each motion.

    Raises
    ------
    InputError
        For states, times, observables, a method or an accuracy that cannot be used.

    Notes
    -----
    Eqs (2.15) to (2.18) of the paper, regularised at flat; the path is that of (2.33), (2.35).

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> states = ex.phi_to_states(disk, 0.0, 1.0, 1.0, 0.7)
    >>> motion = ex.simulate(states, t_end=4.0, accuracy=1e-9)
    >>> motion.phi[0, [0, 100, 200]].round(4)
    array([0.    , 0.2749, 0.5152])
    """
    how = _Integration(**integration)
    initial = require_states(states)
    disk = initial.disk
    times = _times(t_end, t_eval)
    recorded = _integrate(initial, observables, times * disk.rate_unit, how)
    return _trajectories(disk, times, recorded, observables)


def _times(t_end: float | None, t_eval: ArrayLike | None) -> Array:
    if t_eval is None:
        if t_end is None:
            raise InputError("t_end or t_eval: give the end of the time, or the times themselves")
        return np.linspace(0.0, positive("t_end", t_end), _DEFAULT_TIMES)
    times = columns_of(t_eval=t_eval)[0]
    if not (times.size > 0 and np.all(np.diff(times) > 0.0) and np.isfinite(times).all() and times[0] >= 0.0):
        raise InputError("t_eval must be a non-empty list of finite, increasing times >= 0")
    if t_end is not None and times[-1] > number("t_end", t_end):
        raise InputError(f"t_eval goes to {times[-1]:g}, past t_end = {t_end:g}; leave out one of them")
    return times


class _Recorded(NamedTuple):
    """states: (n, nt, 10) in the order of kernels.disk.field.State, NaN where a motion is not OK."""

    states: Array
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array


def _integrate(states: States, observables: Sequence[str], times: Array, given: _Integration) -> _Recorded:
    how = plan(observables, given.accuracy, given.method)
    if how.rung in (ALGEBRA, QUADRATURE):
        raise InputError("simulate needs an observable of the motion, such as 'phi' or 'chi'")
    disk, n = states.disk, len(states)
    # The kernel takes times above 0; the state at 0 is known.
    later = times[times > 0.0]
    initial = np.zeros((10, n))
    initial[:5] = states.natural
    initial[compiled.field.ROW.chi] = number("chi0", given.chi0)
    status, held = held_constants(states, natural_constants(states))
    out = np.empty((n, later.size, 10))
    steps, constants_error = np.empty(n, np.int32), np.empty((3, n))
    compiled.trajectory.trajectory_batch(
        # Time itself is carried from this depth on.
        how.integration(
            np.full(n, how.held_control), whole("max_steps", given.max_steps, 1), compiled.field.ANGLES
        ),
        compiled.events.Stops(compiled.events.TIME, later),
        initial,
        np.stack(held),
        disk.natural,
        out,
        compiled.attempt.Outcome(status, steps, constants_error),
    )
    if later.size < times.size:
        out = np.concatenate([initial.T[:, None], out], axis=1)
    out[status != compiled.status.Status.OK] = np.nan
    return _Recorded(out, status, steps, constants_error)


def _trajectories(disk: Disk, times: Array, recorded: _Recorded, observables: Sequence[str]) -> Trajectories:
    q, z, p, rho, sigma4, _t, chi, psi, a1, a2 = np.moveaxis(recorded.states, 2, 0)
    r, unit = disk.r, disk.rate_unit
    values: dict[str, Callable[[], Array]] = {
        "phi": lambda: np.arctan2(z, q),
        "phidot": lambda: -p * unit,
        "sigma3": lambda: q * rho * unit,
        "sigma4": lambda: sigma4 * unit,
        "chi": lambda: chi,
        "psi": lambda: psi,
        "path": lambda: r * np.stack([a1, a2, q], axis=2),
        # eq. (2.35): the contact point lies r z (cos chi, sin chi) from the centre's shadow
        "contact": lambda: r * np.stack([a1 + z * np.cos(chi), a2 + z * np.sin(chi), 0.0 * q], axis=2),
    }
    chosen = {name: make() if name in observables else None for name, make in values.items()}
    return Trajectories(
        times, **chosen, status=recorded.status, steps=recorded.steps, constants_error=recorded.constants_error
    )

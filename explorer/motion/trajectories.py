"""Motions by integration: turning points, and trajectories sampled at given times."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.plan import ALGEBRA, QUADRATURE, Plan, plan
from explorer.phase.constants import NaturalConstants, natural_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants, nearer_plus
from explorer.phase.membership import falls_of
from explorer.phase.states import Array, States, columns_of, rows_to_states

MAX_STEPS = 2_000_000


@dataclass(frozen=True)
class TurningPoints:
    """Where motions next stop tilting (p = 0), natural units except where said.

    theta: tilt from the nearer flat state (rad). face: which flat state that is. way: sigma3/q there,
    whose sign is the direction in which the contact point moves. time, chi, psi:
    increase since the start; zero on the reduced rung. constants_error (3, n): of energy (relative),
    sigma3_bar, eta. Entries are NaN where status is not OK.
    """

    theta: Array
    face: NDArray[np.int8]
    way: Array
    time: Array
    chi: Array
    psi: Array
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array


def classify(states: States, natural: NaturalConstants) -> NDArray[np.int8]:
    """Status before any integration: bad input, or on the falling set."""
    if states.disk.body.I3 > 0.0:
        return falls_of(states, natural).status.copy()
    return states.status.copy()


def turning_points(states: States, how: Plan, natural: NaturalConstants | None = None) -> TurningPoints:
    """Follow every state forward to its next turning point."""
    disk = states.disk
    if natural is None:
        natural = natural_constants(states)
    status = classify(states, natural)
    n = len(states)
    initial = np.zeros((8, n))
    initial[:5] = states.natural
    out, constants_error, steps = np.empty((8, n)), np.empty((3, n)), np.empty(n, np.int32)
    compiled.batch.first_event_batch(
        how.kernel_method,
        how.kernel_depth,
        initial,
        np.nan_to_num(how.control(states.disk, natural), nan=1.0),
        compiled.events.TURNING_POINT,
        0.0,
        MAX_STEPS,
        how.constants_bound,
        disk.body,
        disk.series,
        out,
        status,
        steps,
        constants_error,
    )
    failed = status != compiled.status.Status.OK
    out[:, failed] = np.nan
    return TurningPoints(
        theta=np.arctan2(out[0], abs(out[1])),
        face=np.where(out[1] >= 0.0, 1, -1).astype(np.int8),
        way=out[3],
        time=out[5],
        chi=out[6],
        psi=out[7],
        status=status,
        steps=steps,
        constants_error=constants_error,
    )


def orbit_starts(states: States, linear: LinearConstants) -> Array:
    """What the quadrature kernels know of a motion, (5, n), as seen from the hemisphere it starts in.

    Rows: h = 2 sin(theta/2), theta-dot, sigma3_bar, eta on this face, eta on the other.
    """
    q, z, p = states.natural[:3]
    plus = z >= 0.0
    near = np.where(plus, linear.eta_plus, linear.eta_minus)
    far = np.where(plus, linear.eta_minus, linear.eta_plus)
    h = 2.0 * np.sin(0.5 * np.arctan2(q, abs(z)))
    return np.ascontiguousarray(np.nan_to_num(np.stack([h, p, linear.sigma3_bar, near, far])))


def smallest_tilt(
    states: States, how: Plan, natural: NaturalConstants | None = None
) -> tuple[Array, NDArray[np.int8], NDArray[np.int32]]:
    """theta_min of every motion (rad), with status and number of steps.

    A motion swings between two turning points. By quadrature they are roots of the amended
    potential; by integration, following it forward to one and backward to the other costs half a
    period in all, and if either fails the sample fails.
    """
    if natural is None:
        natural = natural_constants(states)
    if how.method == "quadrature":
        status = classify(states, natural)
        theta = np.empty(len(states))
        disk = states.disk
        starts = orbit_starts(states, natural.linear)
        compiled.orbits.tilt_batch(starts, how.accuracy, disk.body, disk.series, theta, status)
        return np.where(status == 0, theta, np.nan), status, np.zeros(len(states), np.int32)
    forward = turning_points(states, how, natural)
    backward = turning_points(states.reversed(), how, natural)
    status = np.where(forward.status == 0, backward.status, forward.status)
    theta = np.minimum(forward.theta, backward.theta)
    return np.where(status == 0, theta, np.nan), status, forward.steps + backward.steps


@dataclass(frozen=True)
class Trajectories:
    """Motions sampled at times t (nt), in the units of the disk; arrays (n, nt) or (n, nt, 3).

    Fields not asked for are None; failed samples are NaN with their status. chi, psi: increase
    since t = 0 (rad); path: centre of mass; contact: contact point, in the frame where the
    centre starts above the origin and chi(0) is `chi0`. constants_error (3, n): energy (relative),
    sigma3_bar and eta (natural units).
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


def simulate(
    disk: Disk,
    states: ArrayLike | States,
    t_end: float | None = None,
    *,
    t_eval: ArrayLike | None = None,
    observables: Sequence[str] = ("phi", "chi", "psi", "path", "contact"),
    method: str = "auto",
    accuracy: float = 1e-6,
    chi0: float = 0.0,
    max_steps: int = MAX_STEPS,
) -> Trajectories:
    """Trajectories from initial states, sampled at t_eval (default: 201 times from 0 to t_end).

    states: (n, 4) or (4,) rows of phi, phidot, sigma3, sigma4 in the units of the disk, or `States`.
    t_eval: increasing times >= 0. accuracy is per passage; over k passages errors grow like k.
    sigma3_bar, eta and the energy are held after every step, so they do not drift; what was taken out
    of the energy on the way is reported as its error. States made by
    `constants_to_states` keep the eta_hat they were given, down to 1e-300.
    A state on the falling set has no motion past the fall: status FALLS, values NaN.
    """
    initial = rows_to_states(disk, states)
    times = _times(t_end, t_eval)
    how = plan(observables, accuracy, method)
    if how.rung in (ALGEBRA, QUADRATURE):
        raise InputError("simulate needs an observable of the motion, such as 'phi' or 'chi'")
    natural = natural_constants(initial)
    moments = times * disk.rate_unit
    out, status, steps, constants_error = _integrate(initial, how, natural, moments, chi0, max_steps)
    out[status != compiled.status.Status.OK] = np.nan
    return _trajectories(disk, times, out, observables, (status, steps, constants_error))


def _times(t_end: float | None, t_eval: ArrayLike | None) -> Array:
    if t_eval is None:
        if not isinstance(t_end, int | float | np.number) or not (np.isfinite(t_end) and t_end > 0.0):
            raise InputError(f"t_end = {t_end!r} must be a finite time above 0, or give t_eval")
        return np.linspace(0.0, float(t_end), 201)
    times = columns_of(t_eval=t_eval)[0]
    increasing = times.ndim == 1 and times.size > 0 and np.all(np.diff(times) > 0.0)
    if not (increasing and np.isfinite(times).all() and times[0] >= 0.0):
        raise InputError("t_eval must be a non-empty list of finite, increasing times >= 0")
    if t_end is not None and times[-1] > t_end:
        raise InputError(f"t_eval goes to {times[-1]:g}, past t_end = {t_end:g}; leave out one of them")
    return times


def hold(states: States, natural: NaturalConstants) -> tuple[NDArray[np.int8], LinearConstants]:
    """Status before integration, and the constants that trajectories are held to.

    Given constants win over those found from the state. A state whose eta is not known to a tenth
    on the nearer side has no known direction of its race; with I3 = 0 trajectories run free.
    """
    code = compiled.status.Status
    if not states.disk.body.I3 > 0.0:
        return states.status.copy(), LinearConstants(*np.full((3, len(states)), np.nan))
    linear = natural.linear if states.exact is None else states.exact
    near_plus = nearer_plus(linear.eta_plus, linear.eta_minus)
    eta = abs(np.where(near_plus, linear.eta_plus, linear.eta_minus))
    exact = falls_of(states, natural)
    if states.exact is None:
        rounding = natural.rounding(near_plus)
        unknown = (rounding > compiled.attempt.RESOLVED_SHARE * eta) & exact.could_fall & ~exact.on_f
        status = np.where((exact.status == code.OK) & unknown, code.UNRESOLVED_SIDE, exact.status)
    else:
        falls = (eta == 0.0) & exact.could_fall
        status = np.where((states.status == code.OK) & falls, code.FALLS, states.status)
    return status.astype(np.int8), LinearConstants(*np.nan_to_num(linear))


def _integrate(
    states: States, how: Plan, natural: NaturalConstants, times: Array, chi0: float, max_steps: int
) -> tuple[Array, NDArray[np.int8], NDArray[np.int32], Array]:
    disk, n = states.disk, len(states)
    initial = np.zeros((10, n))
    initial[:5] = states.natural
    initial[6] = chi0
    status, held = hold(states, natural)
    out = np.empty((n, times.size, 10))
    steps, constants_error = np.empty(n, np.int32), np.empty((3, n))
    begins_at_zero = times[0] == 0.0
    later = out[:, 1:] if begins_at_zero else out
    recorded = np.empty((n, later.shape[1], 10))
    depth = max(how.kernel_depth, compiled.field.ANGLES)  # time itself is carried from there on
    compiled.trajectory.trajectory_batch(
        how.kernel_method,
        depth,
        initial,
        np.stack(held),
        np.full(n, how.held_control),
        compiled.events.TIME,
        np.ascontiguousarray(times[1:] if begins_at_zero else times),
        max_steps,
        how.constants_bound,
        disk.body,
        disk.series,
        recorded,
        status,
        steps,
        constants_error,
    )
    later[:] = recorded
    if begins_at_zero:
        out[:, 0] = initial.T
    return out, status, steps, constants_error


def _trajectories(disk: Disk, times: Array, out: Array, observables: Sequence[str], info: tuple) -> Trajectories:
    q, z, p, rho, sigma4, _t, chi, psi, a1, a2 = np.moveaxis(out, 2, 0)
    r, unit = disk.r, disk.rate_unit
    values = {
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
    return Trajectories(times, **chosen, status=info[0], steps=info[1], constants_error=info[2])

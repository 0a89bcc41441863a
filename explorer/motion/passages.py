"""Passages from vertical to vertical, and whole periods: by quadrature or by integration."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.plan import plan
from explorer.motion.trajectories import hold, orbit_starts, turning_points
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.gauss import packed_rules
from explorer.phase.lines import linear_constants
from explorer.phase.membership import impact_speed
from explorer.phase.states import Array, States, columns_of, constants_to_states

_OBSERVABLES = ("race_angle", "delta_chi", "delta_psi", "theta_min", "duration")
# What the finer of the two integrations that tell the error is allowed: in tolerance, in step.
_FINER = {"dopri5": 1e-3, "dop853": 1e-4, "rk4": 0.5, "rk8": 0.6}
# An estimate above the accuracy asked by less than this is let pass: the estimate is that of the coarser
# of two integrations, the answer that of the finer.
_LENIENCE = 10.0
# The two may happen to lie close together, on either side of the truth or not.
_CAUTION = 5.0
_ROUNDING = 3e-12  # of some hundred steps
_DRIFT = 3.0  # by which eta goes on losing digits over the steps
_SLOW = 0.15  # natural units; below this speed at the vertical rounding is felt more
# Of speeds and eta_hat, natural units: squares overflow above, eta = I3 r(0) eta_hat loses digits below.
_LARGEST, _SMALLEST = 1e100, 1e-302
_FLOOR = 1e-9  # an accuracy below is met as far as rounding allows, if that is not worse


@dataclass(frozen=True)
class Passages:
    """Passages near flat, one entry per sample; angles in rad, the rest in the units of the disk.

    race_angle: delta_chi less fall_angle, the increase of chi along the limit motion with the same
    sigma3_bar and energy (where that starts later than the vertical, all of it); limit: sgn(eta) kappa
    pi. wrong_way: the contact point moves against sgn(eta) at the flattest moment. theta_min: smallest
    tilt. error_estimate: of the angles (absolute) and of duration and theta_min (relative), whichever
    is larger. A sample whose status is not OK is NaN; with eta_hat = 0 it FALLS, and fall_time is its
    time to flat.
    """

    race_angle: Array
    wrong_way: NDArray[np.bool_]
    delta_chi: Array
    delta_psi: Array
    fall_angle: Array
    theta_min: Array
    duration: Array
    fall_time: Array
    energy: Array
    impact_speed: Array
    limit: Array
    error_estimate: Array
    status: NDArray[np.int8]
    method: str
    model: str

    def __len__(self) -> int:
        return self.status.size


def passages(
    disk: Disk,
    sigma3_bar: ArrayLike,
    eta_hat: ArrayLike,
    phidot: ArrayLike,
    face: ArrayLike = 1,
    method: str = "auto",
    accuracy: float = 1e-6,
    jobs: int = 1,
    window: float | None = None,
) -> Passages:
    """Passages that start at the vertical with speed phidot >= 0 towards the flat state of `face`.

    sigma3_bar, eta_hat (of that side), phidot: rad per unit of time; arguments broadcast. method:
    'quadrature' takes eta_hat as it is, down to 1e-300; 'rk4', 'rk8', 'dopri5', 'dop853' integrate from a state
    and report 'unresolved side' where that state does not determine the direction of the race.
    'auto' is quadrature. window: cos phi (0 to 1) at which to start and stop instead of the vertical.
    Bad input (not finite, beyond 1e100, phidot < 0, face not +-1) has status BAD_INPUT. Section 7 of the paper.
    """
    require_axial_inertia(disk)
    if isinstance(jobs, bool) or not isinstance(jobs, int) or jobs < 1:
        raise InputError(f"jobs = {jobs!r} must be a whole number, 1 or more")
    how = plan(_OBSERVABLES, accuracy, method)
    edge = _check_window(window, how.method)
    s3, eta, speed, s = columns_of(sigma3_bar=sigma3_bar, eta_hat=eta_hat, phidot=phidot, face=face)
    parts = np.array_split(np.arange(s.size), max(1, min(jobs, s.size)))
    call = _by_quadrature if how.method == "quadrature" else _by_integration
    done = Parallel(n_jobs=len(parts), backend="threading")(
        delayed(call)(disk, s3[i], eta[i], speed[i], s[i], how, edge) for i in parts
    )
    merged = {f.name: np.concatenate([p[f.name] for p in done]) for f in fields(Passages) if f.name in done[0]}
    return Passages(**merged, method=how.method, model=how.rung)


def _check_window(window: float | None, method: str) -> float:
    """The tilt phi at the edge of the window (rad); 0 for the vertical."""
    if window is None:
        return 0.0
    if method != "quadrature":
        raise InputError(f"window: {method} goes from vertical to vertical; use method='quadrature'")
    if not isinstance(window, int | float) or not 0.0 < window <= 1.0:
        raise InputError(f"window = {window}: give cos phi, a number between 0 and 1")
    return float(np.arccos(window))


def _status(disk: Disk, s3: Array, eta_hat: Array, speed: Array, face: Array) -> NDArray[np.int8]:
    """Status before any computation: numbers whose squares overflow are no input, a lost eta no side."""
    code, size = compiled.status.Status, abs(eta_hat)
    good = np.fmax(np.fmax(abs(s3), abs(speed)), size) <= _LARGEST * disk.rate_unit
    good &= ~np.isnan(s3 + eta_hat + speed) & (speed >= 0.0) & (abs(face) == 1.0)
    lost = (size > 0.0) & (size < _SMALLEST * disk.rate_unit)
    return np.where(good, np.where(lost, code.UNRESOLVED_SIDE, code.OK), code.BAD_INPUT).astype(np.int8)


def _by_quadrature(
    disk: Disk, s3: Array, eta_hat: Array, speed: Array, face: Array, how: Any, edge: float
) -> dict[str, Any]:
    b, unit = disk.body, disk.rate_unit
    status = _status(disk, s3, eta_hat, speed, face)
    good = status == 0
    sigma3_bar, eta, start = (
        np.where(good, column, 1.0) for column in (s3 / unit, disk.eta_hat_to_eta(eta_hat / unit), speed / unit)
    )
    rules, sizes = packed_rules()
    out = np.empty((8, eta.size))
    compiled.passages.passage_batch(
        sigma3_bar, eta, start, chord(edge), how.accuracy, rules, sizes, disk.tables, b, disk.series, out, status
    )
    energy = np.where(eta == 0.0, _energy_on_f(disk, sigma3_bar, start), out[4])
    rows = [*out[:4], out[7]]
    return _assemble(
        disk, sigma3_bar, eta, face, energy, edge, rows, np.fmax(out[5], out[6]), status, how.accuracy
    )


def _energy_on_f(disk: Disk, sigma3_bar: Array, speed: Array) -> Array:
    """Energy at the vertical on the line, natural units."""
    b = disk.body
    sigma4 = b.I1 * b.dr0 * sigma3_bar / (b.I3 * b.r0)
    return 0.5 * b.M * speed**2 + 0.5 * b.I1 * sigma3_bar**2 + 0.5 * b.J * sigma4**2 + 1.0


def _by_integration(
    disk: Disk, s3: Array, eta_hat: Array, speed: Array, face: Array, how: Any, _edge: float
) -> dict[str, Any]:
    code, unit = compiled.status.Status, disk.rate_unit
    status = _status(disk, s3, eta_hat, speed, face)
    good = status == 0
    s3, eta_hat, speed, facing = (np.where(good, column, 1.0) for column in (s3, eta_hat, speed, face))
    states = constants_to_states(disk, s3, eta_hat, facing * speed, facing)
    natural = natural_constants(states)
    rough = turning_points(states, how, natural)
    finer = how.scaled(_FINER[how.method])
    fine = turning_points(states, finer, natural)
    rounding = natural.rounding(facing > 0.0)
    eta = disk.eta_hat_to_eta(eta_hat / unit)
    doubtful = (fine.status == code.FALLS) | (rounding > compiled.attempt.RESOLVED_SHARE * abs(eta))
    for run in (rough, fine):
        status = np.where(status == code.OK, run.status, status)
    status = np.where(good & doubtful & (eta != 0.0), code.UNRESOLVED_SIDE, status)
    status = np.where(good & (eta == 0.0), code.FALLS, status).astype(np.int8)
    # A passage ends at the flat state it was sent to; one that turns elsewhere was never near it.
    elsewhere = (status == code.OK) & (fine.face != facing)
    known = rounding / np.where(eta == 0.0, 1.0, abs(eta))
    rows = [fine.theta, 2.0 * fine.chi, 2.0 * fine.psi * facing, 2.0 * fine.time, fine.way]
    error = np.fmax(2.0 * abs(fine.chi - rough.chi), 2.0 * abs(fine.psi - rough.psi))
    error = np.fmax(error, abs(rough.time / fine.time - 1.0))
    rounding_of_steps = _ROUNDING * (1.0 + _SLOW * unit / (speed + 5e-5 * unit))
    error = _CAUTION * np.fmax(error, abs(rough.theta / fine.theta - 1.0)) + _DRIFT * known + rounding_of_steps
    if how.adaptive:
        # On short ways both may take much the same steps; then their difference tells nothing.
        error = error + _CAUTION * finer.control(disk, natural)
    missed = (status == code.OK) & ~(error <= _LENIENCE * how.accuracy)
    status = np.where(missed, code.STEP_LIMIT, np.where(elsewhere, code.BAD_INPUT, status)).astype(np.int8)
    return _assemble(disk, s3 / unit, eta, face, natural.energy, 0.0, rows, error, status, how.accuracy)


def _assemble(
    disk: Disk,
    sigma3_bar: Array,
    eta: Array,
    face: Array,
    energy: Array,
    edge: float,
    rows: list[Array],
    error: Array,
    status: NDArray[np.int8],
    accuracy: float,
) -> dict[str, Any]:
    """Results in the units of the disk. rows: theta_min, chi, psi (as on face +1), time, way."""
    code = compiled.status.Status
    time, chi, _psi, fall_error = fall_from_vertical(disk, sigma3_bar, energy, edge)
    falls = status == code.FALLS
    # The fall angle is a part of the race angle, and all there is of a fall.
    error = np.where(falls, fall_error, np.fmax(error, np.nan_to_num(2.0 * fall_error, nan=np.inf)))
    missed = (falls | (status == code.OK)) & ~(error <= np.fmax(_LENIENCE * accuracy, _FLOOR * (1.0 + time)))
    status = np.where(missed, code.STEP_LIMIT, status).astype(np.int8)
    ok, falls = status == code.OK, status == code.FALLS
    limit = np.sign(eta) * disk.race_limit
    fall_angle = np.where(ok | falls, 2.0 * chi, np.nan)
    theta, delta_chi, delta_psi, duration, way = rows
    return {
        "race_angle": np.where(ok, delta_chi - fall_angle, np.nan),
        "wrong_way": ok & (np.sign(way) != np.sign(eta)),
        "delta_chi": np.where(ok, delta_chi, np.nan),
        "delta_psi": np.where(ok, delta_psi * face, np.nan),
        "fall_angle": fall_angle,
        "theta_min": np.where(falls, 0.0, np.where(ok, theta, np.nan)),
        "duration": np.where(ok, duration, np.nan) * disk.time_unit,
        "fall_time": np.where(falls, time, np.nan) * disk.time_unit,
        "energy": np.where(ok | falls, energy, np.nan) * disk.energy_unit,
        "impact_speed": np.where(ok | falls, impact_speed(disk, sigma3_bar, energy), np.nan) * disk.rate_unit,
        "limit": np.where(status == code.BAD_INPUT, np.nan, limit),
        "error_estimate": np.where(ok | falls, error, np.nan),
        "status": status,
    }


@dataclass(frozen=True)
class Forces:
    """What the motion asks of the contact: least normal force (in m g), largest friction coefficient.

    The coefficient is infinite where the normal force is not positive: the disk would lift off.
    """

    min_normal_force: Array
    max_friction: Array


def passage_forces(disk: Disk, sigma3_bar: ArrayLike, eta_hat: ArrayLike, phidot: ArrayLike) -> Forces:
    """Forces during passages (the same on both sides); looked at on a grid, so good to some digits.

    NaN where `passages` would not take the input.
    """
    require_axial_inertia(disk)
    b, unit = disk.body, disk.rate_unit
    given = columns_of(sigma3_bar=sigma3_bar, eta_hat=eta_hat, phidot=phidot)
    good = _status(disk, given[0], given[1], given[2], np.ones_like(given[0])) == compiled.status.Status.OK
    s3, eta, speed = (np.where(good, c / unit, 1.0) for c in given)
    out = np.empty((2, s3.size))
    eta = disk.eta_hat_to_eta(eta)
    compiled.forces.forces_batch(np.ascontiguousarray(s3), eta, np.ascontiguousarray(speed), b, disk.series, out)
    out[:, ~good] = np.nan
    return Forces(out[0], out[1])


@dataclass(frozen=True)
class Periods:
    """Whole periods, one entry per state, in the units of the disk.

    period: time; chi, psi: increase per period (rad); theta_min: smallest tilt from either flat state;
    crosses: whether the motion passes the vertical. NaN where status is not OK.
    """

    period: Array
    chi: Array
    psi: Array
    theta_min: Array
    crosses: NDArray[np.bool_]
    energy: Array
    error_estimate: Array
    status: NDArray[np.int8]


def periods(states: States, accuracy: float = 1e-6, eta_hat: ArrayLike | None = None) -> Periods:
    """Period of the motions through `states`, by quadrature: from turning point to turning point.

    eta_hat (rad per unit of time, on the side of the state's hemisphere, +1 at the vertical) replaces
    the state's own where that is only known to rounding; a state on F to rounding FALLS or is
    UNRESOLVED_SIDE without it. Eqs (3.12), (3.13).
    """
    disk = states.disk
    require_axial_inertia(disk)
    b = disk.body
    plan(_OBSERVABLES, accuracy, "quadrature")
    natural = natural_constants(states)
    plus = states.natural[1] >= 0.0
    if eta_hat is None:
        status, linear = hold(states, natural)
    else:
        given = columns_of(eta_hat=eta_hat, states=natural.sigma3_bar)[0] / disk.rate_unit
        status, linear = states.status.copy(), linear_constants(disk, natural.sigma3_bar, given, plus)
    starts = orbit_starts(states, linear)
    code = compiled.status.Status
    status[(status == code.OK) & (starts[3:] == 0.0).any(axis=0)] = code.FALLS
    out = np.empty((8, status.size))
    rules, sizes = packed_rules()
    compiled.orbits.orbit_batch(starts, accuracy, rules, sizes, b, disk.series, out, status)
    ok = status == code.OK
    out[:, ~ok] = np.nan
    return Periods(
        period=out[4] * disk.time_unit,
        chi=out[2],
        psi=out[3] * np.where(plus, 1.0, -1.0),
        theta_min=np.fmin(out[0], out[1]),
        crosses=np.isfinite(out[1]),
        energy=out[5] * disk.energy_unit,
        error_estimate=np.fmax(out[6], out[7]),
        status=status,
    )


def chord(phi: float) -> float:
    """2 sin(theta/2) at the tilt phi (rad), as the kernels measure tilt; at the vertical exactly theirs."""
    return 2.0 * float(np.sin(0.5 * (0.5 * np.pi - phi))) if phi > 0.0 else float(compiled.quadrature.VERTICAL)


def fall_from_vertical(
    disk: Disk, sigma3_bar: Array, energy: Array, window: float = 0.0
) -> tuple[Array, Array, Array, Array]:
    """Time, chi and psi gained by the fall on F from the vertical to flat (face +1), natural units,
    and an estimate of their error.

    window: phi (rad) at which it begins instead.
    """
    out = np.empty((4, sigma3_bar.size))
    h_end = chord(window)
    compiled.passages.fall_batch(
        np.ascontiguousarray(sigma3_bar),
        np.ascontiguousarray(energy),
        h_end,
        *packed_rules(),
        disk.tables,
        disk.body,
        disk.series,
        out,
    )
    return out[0], out[1], out[2], out[3]

"""Passages near flat: from the vertical to nearly flat and back, by quadrature or by integration."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, jobs_of, positive
from explorer.motion.arcs import OF_ANGLES
from explorer.motion.error_estimates import accepted
from explorer.motion.fall_integrals import departures_of_moving, fall_integrals
from explorer.motion.passage_starts import Followed, VerticalStarts, starts_at_vertical
from explorer.motion.passages_by_integration import by_integration
from explorer.motion.passages_by_quadrature import by_quadrature
from explorer.motion.plan import Plan, plan
from explorer.motion.threads import blocks, in_parts
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.results import Result, joined
from explorer.phase.states import Array

OBSERVABLES = ("race_angle", "delta_chi", "delta_psi", "theta_min", "duration")
# By integration an accuracy below this, times one plus the time of the fall, is met as far as rounding allows.
_FLOOR = 1e-9


@dataclass(frozen=True, repr=False, eq=False)
class Passages(Result):
    """Passages near flat, arrays of the arguments' shape, in the units of the disk: what `passages` returns.

    If the status of a sample is not OK, all that is computed for it is NaN. The exception is a sample that falls,
    because its eta_hat is 0: its status is FALLS, and its fall_time, fall_angle, energy and impact_speed are
    given.

    Attributes
    ----------
    disk : Disk
        The body.
    sigma3_bar, eta_hat, phidot, face : array
        As given.
    race_angle : array
        delta_chi less fall_angle (rad): how far the contact point races round the rim. NaN where fall_angle is.
    wrong_way : array of bool
        Whether the contact point moves against sgn(eta) at the flattest moment.
    delta_chi, delta_psi : array
        Increase of the angles of contact in space and in the body (rad).
    fall_angle : array
        Increase of chi, without its jump, along the limit motion with the same sigma3_bar and energy (rad): from
        the vertical to flat and back, or, if that motion turns before the vertical, from its turning point to flat
        and back. NaN where that motion does not exist: E <= V_0, so that the disk could not come flat.
    theta_min : array
        Smallest tilt from flat (rad).
    duration, fall_time : array
        Time of the passage; and, for a sample that falls, the time from the vertical to flat (NaN for all others).
    energy, impact_speed : array
        Energy, and the speed A of eq. (7.1) with which the limit motion arrives (units of the disk), NaN where
        there is none.
    limit : array
        sgn(eta) kappa pi (rad), to which race_angle tends as eta goes to 0, eq. (7.16); NaN where there is no
        race.
    error_estimate : array
        Of the angles (rad) and of duration and theta_min (relative), whichever is larger.
    status : array of int8
        `Status` of each sample.
    method, model : str
        The method used, and what it computed: 'quadrature' (integrals), 'reduced' (phi, phidot, sigma3
        and sigma4 in time), 'angles' (chi and psi too) or 'path' (the path too).

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.passages(ex.Disk.uniform(), 1.0, [1e-3, -1e-3], 1.0)
    >>> len(found), found.method
    (2, 'quadrature')
    >>> found.limit.round(4)
    array([ 7.0248, -7.0248])
    """

    disk: Disk
    sigma3_bar: Array
    eta_hat: Array
    phidot: Array
    face: Array
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

    _GIVEN = ("sigma3_bar", "eta_hat", "phidot", "face")

    @property
    def side(self) -> NDArray[np.int8]:
        """The side of F: the sign of eta_hat."""
        return np.sign(np.nan_to_num(self.eta_hat)).astype(np.int8)


def passages(
    disk: Disk,
    sigma3_bar: ArrayLike,
    eta_hat: ArrayLike,
    phidot: ArrayLike,
    face: ArrayLike = 1,
    *,
    window: float | None = None,
    method: str = "auto",
    accuracy: float = 1e-6,
    jobs: int = 1,
) -> Passages:
    """Passages from the vertical to nearly flat and back to the vertical.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar : array_like
        Constant of motion of eq. (3.5), units of the disk. The arrays broadcast; the result has their shape.
    eta_hat : array_like
        Signed distance from the line of `face`, eq. (6.2), units of the disk; at 0 the disk falls. Quadrature
        uses it as given, down to 1e-300.
    phidot : array_like
        Speed at the vertical towards flat, units of the disk, not negative.
    face : array_like
        Flat state that the motion starts towards, +1 or -1.
    window : float, optional
        cos(phi), 0 to 1, at which to start and stop instead of at the vertical. Quadrature only.
    method : str
        'auto' or 'quadrature', or 'rk4', 'rk8', 'dopri5', 'dop853', which project each step onto the constants,
        and say UNRESOLVED_SIDE if their error hides the direction of the race.
    accuracy : float
        Largest error accepted: absolute for angles (rad; no angle is known better than to its 14th digit),
        relative for times and theta_min.
    jobs : int
        Threads.

    Returns
    -------
    Passages
        One entry per sample. Numbers that are not finite or beyond 1e75 natural units, a negative phidot and
        a face other than +1 and -1 have status BAD_INPUT.

    Raises
    ------
    InputError
        For arguments that are not numbers, do not broadcast or cannot be used.

    Notes
    -----
    Section 7 of the paper; the integrals are eqs (3.12), (3.13).

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.passages(ex.Disk.uniform(), sigma3_bar=1.0, eta_hat=[1e-6, -1e-6, 1e-200], phidot=1.0)
    >>> found.race_angle.round(4)
    array([ 7.0248, -7.0248,  7.0248])
    """
    how = plan(OBSERVABLES, accuracy, method)
    columns, shape = read_columns(sigma3_bar=sigma3_bar, eta_hat=eta_hat, phidot=phidot, face=face)
    edge, starts = _edge_of(window, how.method), starts_at_vertical(disk, *columns)
    jobs, rows = jobs_of("jobs", jobs), starts.status.size
    found = joined(in_parts(jobs, rows, lambda part: passages_by(disk, rows_of(starts, part), how, edge)[0]))
    # The numbers as they were given, also where a placeholder stood for them.
    given = dict[str, Any](zip(Passages._GIVEN, columns, strict=True))
    return replace(found, **given).reshaped(shape)


def passages_by(
    disk: Disk, starts: VerticalStarts, how: Plan, edge: float = 0.0, tables: bool = True
) -> tuple[Passages, NDArray[np.int32] | None]:
    """As `passages`, by a plan that was made, which may name its setting; and the steps of an integrator.

    edge: of the window, in x = ln tan(theta/2) below the vertical. tables: False for quadrature by arcs alone.
    """
    if how.method == "quadrature":
        some = [rows_of(starts, rows) for rows in blocks(starts.status.size)]
        return joined(
            [_found(disk, each, by_quadrature(disk, each, how, edge, tables), how, edge) for each in some]
        ), None
    followed, steps = by_integration(disk, starts, how)
    return _found(disk, starts, followed, how, edge), steps


def reference_passages(disk: Disk, starts: VerticalStarts) -> Passages:
    """Passages as arcs: by quadrature, but by none of the tables of the body."""
    return passages_by(disk, starts, plan(OBSERVABLES, 1e-11, "quadrature"), tables=False)[0]


def passage_kernels(how: Plan) -> tuple[str, ...]:
    """The kernels of `passages` by a plan, for `compiled.warmup`; a few starts need another one."""
    steps = "algebra.constants_batch", "falling.line_chart_batch", how.kernel
    by = ("passages.passage_batch",) if how.method == "quadrature" else steps
    return *by, "passages.fall_batch"


def _edge_of(window: float | None, method: str) -> float:
    """How far the edge of the window lies below the vertical, in x = ln tan(theta/2), without loss of digits."""
    if window is None:
        return 0.0
    if method != "quadrature":
        raise InputError(f"window: {method} goes from vertical to vertical; use method='quadrature'")
    q = positive("window", window, 1.0)
    return math.log1p(math.sqrt((1.0 - q) * (1.0 + q))) - math.log(q)


@np.errstate(over="ignore", invalid="ignore")  # of what is no input, does not fall, or has no answer
def _found(disk: Disk, starts: VerticalStarts, passage: Followed, how: Plan, edge: float) -> Passages:
    """Results in the units of the disk; a race is chi less the angle of the fall. NaN is what is not known."""
    code, status = compiled.status.Status, passage.status
    kinetic = 0.5 * disk.body.M * passage.speed**2
    departures = departures_of_moving(disk, passage.sigma3_bar, passage.eta, kinetic, kinetic)
    fall = fall_integrals(disk, departures, edge, how.accuracy)
    # With an energy up to V_0 nothing falls: such a passage has no race.
    races = departures.level > 0.0

    # The fall angle is a part of the race angle, and all there is of a fall.
    ok, falls = status == code.OK, status == code.FALLS
    part = np.where(falls, fall.error, np.where(races, 2.0 * fall.error, 0.0))
    error = np.where(ok & (passage.error > part), passage.error, part)
    if how.method == "quadrature":
        allowed = np.fmax(how.accuracy, OF_ANGLES * (abs(passage.chi) + abs(passage.psi)))
    else:
        allowed = np.fmax(accepted(how, 0.0), _FLOOR * (1.0 + np.where(races, fall.time, 0.0)))
    status = np.where((ok | falls) & ~(error <= allowed), code.STEP_LIMIT, status).astype(np.int8)

    ok, falls, side = status == code.OK, status == code.FALLS, np.sign(passage.eta)
    known, fall_angle = ok | falls, 2.0 * fall.chi
    speed = np.sqrt(2.0 * disk.body.inv_M * np.where(races, departures.level, np.nan))

    def where(these: NDArray[np.bool_], values: Any) -> Array:
        return np.where(these, values, np.nan)

    return Passages(
        disk=disk,
        sigma3_bar=starts.sigma3_bar,
        eta_hat=starts.eta_hat,
        phidot=starts.speed,
        face=starts.face,
        race_angle=where(ok, passage.chi - fall_angle),
        wrong_way=ok & (side != 0.0) & ~(passage.turn_rate * side > 0.0),
        delta_chi=where(ok, passage.chi),
        delta_psi=where(ok, passage.psi * passage.face),
        fall_angle=where(known, fall_angle),
        theta_min=where(known, np.where(falls, 0.0, passage.theta_min)),
        duration=where(ok, passage.time * disk.time_unit),
        fall_time=where(falls, fall.time * disk.time_unit),
        energy=where(known, passage.energy * disk.energy_unit),
        impact_speed=where(known, speed * disk.rate_unit),
        limit=where(races & (status != code.BAD_INPUT), side * disk.race_limit),
        error_estimate=where(known, error),
        status=status,
        method=how.method,
        model=how.level,
    )

"""Bounces: every approach to flat of any motion, by quadrature or by integration."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, jobs_of, whole
from explorer.motion.arcs import allowed
from explorer.motion.fall_integrals import KERNELS, departures_of_moving, fall_integrals
from explorer.motion.orbits import KERNELS as OF_ENDS
from explorer.motion.orbits import Ends, tilts_by_face
from explorer.motion.periods import arcs_of, of_motions
from explorer.motion.plan import Plan, plan
from explorer.motion.starts import ArcStarts, face_of
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.falling_set import impact_speed
from explorer.phase.linear_constants import line_chart
from explorer.phase.results import Result
from explorer.phase.states import Array, States, require_states

MOST = 100_000  # bounces of one state in one call: some ten megabytes for each column
_MOST_ROWS = 10**8  # of all states: a gigabyte for each column


@dataclass(frozen=True, repr=False, eq=False)
class Bounces(Result):
    """Approaches to flat, arrays (..., count) in the units of the disk: what `bounces` returns.

    All but `row`, `bounce` and `status` is NaN or 0 where the status is not OK.

    Attributes
    ----------
    row, bounce : array of int
        Which state, and which of its approaches to flat, both counted from 0.
    time : array
        Time from the state to the flattest moment. In a motion that is steady to rounding, every moment is a
        flattest one: the tilt at this time differs from theta_min by rounding only.
    face : array of int8
        Which face came down, +1 or -1; 0 where that is not known.
    side : array of int8
        The side of F: the sign of eta on that face.
    theta_min : array
        Smallest tilt (rad).
    delta_chi, delta_psi : array
        Increase of the angles of contact over the stretch (rad).
    fall_angle : array
        Increase of chi, without its jump, along the limit motion with the same sigma3_bar and energy, over a
        stretch of that motion (rad). NaN where that motion does not exist: E <= V_0, so that the disk could not
        come flat.
    race_angle : array
        delta_chi - fall_angle (rad); NaN where fall_angle is.
    duration : array
        Duration of the stretch.
    error_estimate : array
        The largest of the errors of the angles (rad), of the duration, of theta_min and of the time to the
        flattest moment. The last three are relative; that of the time, if it is shorter, to the period.
    status : array of int8
        `Status` of each bounce.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.uniform(), 1.0, [1e-3, -1e-3], 1.0)
    >>> ex.bounces(states, 2).face
    array([[ 1, -1],
           [ 1, -1]], dtype=int8)
    """

    row: NDArray[np.int64]
    bounce: NDArray[np.int64]
    time: Array
    face: NDArray[np.int8]
    side: NDArray[np.int8]
    theta_min: Array
    delta_chi: Array
    delta_psi: Array
    fall_angle: Array
    race_angle: Array
    duration: Array
    error_estimate: Array
    status: NDArray[np.int8]
    states: States


def bounces(
    states: States, count: int = 1, *, accuracy: float = 1e-6, jobs: int = 1, method: str = "auto"
) -> Bounces:
    """The next `count` approaches to flat in the motion through each of `states`.

    A bounce is one stretch of a motion with its flattest moment in the middle. Where the motion crosses the
    vertical the stretch goes from vertical to vertical, and bounces are on both faces in turn. Where it does
    not, the stretch goes from turning point to turning point. The first bounce may begin before the state.

    Parameters
    ----------
    states : States
        One state of each motion, at any moment of it; the disk needs I3 > 0. If eta_hat was given, to
        `constants_to_states` for instance, it is used as given, however small.
    count : int
        How many bounces of each, 1 to 100,000.
    accuracy : float
        Error of the angles (rad), and relative error of times and tilts, 1e-13 to 0.1. Coarser is faster. No angle
        is known better than to its 14th digit.
    jobs : int
        Threads. For many states see `scan`, which works in batches and shows its progress.
    method : str
        'auto' or 'quadrature'; or 'rk4', 'rk8', 'dopri5', 'dop853', which follow each motion through one period in
        steps, to an accuracy of 1e-11 at best. Even then the fall angle, and only that, is computed by
        quadrature.

    Returns
    -------
    Bounces
        Arrays with the shape of `states` and a last axis for the bounces. A state that lies on F to within
        rounding has the status FALLS. If it lies so near F that rounding hides its side, the status is
        UNRESOLVED_SIDE.

    Raises
    ------
    InputError
        For a disk with I3 = 0, or arguments out of their range.

    Notes
    -----
    The tilt is periodic: the bounces of one state have at most two different theta_min, one on each face, so two
    bounces give all that there is to know about the tilt.

    race_angle = delta_chi - fall_angle. The fall angle belongs to the limit motion with the same sigma3_bar and
    energy: it is the increase of chi, without its jump at the impact, over one stretch of that motion. If the
    limit motion crosses the vertical, the stretch goes from there to flat and back; if not, from a turning point
    to flat and back to a turning point. So race_angle -> side kappa pi as eta -> 0, eq. (7.9). If the energy does
    not exceed V_0 (the value that the potential V has at flat if eta = 0), the disk cannot come flat: there is no
    limit motion, and race_angle and fall_angle are NaN. The sums of duration, delta_chi and delta_psi over the
    bounces of a period are the integrals (3.12), (3.13).

    Examples
    --------
    >>> import explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> states = ex.constants_to_states(coin, 20.0, [1e-9, -1e-200], 30.0)
    >>> ex.bounces(states).race_angle.round(4).ravel(), round(coin.race_limit, 4)
    (array([ 7.0248, -7.0248]), 7.0248)
    """
    require_states(states)
    require_axial_inertia(states.disk)
    count, jobs = whole("count", count, 1, MOST), jobs_of("jobs", jobs)
    if count * states.size > _MOST_ROWS:
        raise InputError(f"count = {count} for {states.size:,} states; give up to {_MOST_ROWS:,} bounces at once")
    how = plan(("race_angle",), accuracy, method)

    found = of_motions(states, jobs, lambda some: _bounces(some, count, how))
    rows = np.arange(states.size)[:, None] + 0 * found.bounce
    numbers = np.arange(count) + 0 * found.bounce
    return replace(found, row=rows, bounce=numbers, states=states).reshaped(states.shape)


def motion_constants(found: Bounces) -> dict[str, NDArray[Any]]:
    """Constants of the motion of each bounce by the names of `phase.columns`; NaN where nothing was found.

    wrong_way is of its flattest moment, where sigma3 has the sign of chi's rate.
    """
    states, disk = found.states, found.states.disk
    motion = states.motion
    ok = (found.status == compiled.status.Status.OK) & (found.face != 0)

    eta = np.where(found.face > 0, found._of_each_state(motion.eta_plus), found._of_each_state(motion.eta_minus))
    eta_hat = eta_to_eta_hat(disk.body, eta)
    speed = impact_speed(disk, motion.sigma3_bar, motion.energy)
    columns = {
        "sigma3_bar": found._of_each_state(motion.sigma3_bar) * disk.rate_unit,
        "eta_hat": eta_hat * disk.rate_unit,
        "energy": found._of_each_state(motion.energy) * disk.energy_unit,
        "impact_speed": found._of_each_state(speed) * disk.rate_unit,
    }
    tilt = np.where(np.isfinite(found.theta_min), found.theta_min, 1.0).ravel()
    chart = line_chart(disk, np.sin(tilt), np.cos(tilt))
    sigma3 = chart.rates(found._of_each_state(motion.sigma3_bar).ravel(), eta_hat.ravel())[0]
    against = np.sign(sigma3).reshape(found.shape) != found.side
    return {name: np.where(ok, values, np.nan) for name, values in columns.items()} | {"wrong_way": ok & against}


def bounce_kernels(how: Plan) -> tuple[str, ...]:
    """The kernels of `bounces` by a plan, for `compiled.warmup`."""
    of_arcs = "nutation.well_batch", "passages.passage_batch"
    own = of_arcs if how.method == "quadrature" else (how.kernel,)
    return "algebra.constants_batch", "falling.line_chart_batch", *OF_ENDS, *own, *KERNELS


@np.errstate(invalid="ignore", divide="ignore")  # of motions that were not found
def _bounces(states: States, count: int, how: Plan) -> Bounces:
    """The first `count` bounces of motions that have a period, those on one and on the other face in turn."""
    disk, own = states.disk, face_of(states)
    rises, number = own * states.rows.p > 0.0, np.arange(count, dtype=np.float64)
    # Where nothing is asked but the first one, the other passage of a motion may stay unknown.
    both = rises | (count > 1)
    motions, ends, (here, there, lead) = arcs_of(states, own, how, both, True)
    crosses = ends.crosses
    on_this = ~crosses[:, None] | ((rises[:, None] + number) % 2 == 0)

    def each(on_own: NDArray[Any], on_other: NDArray[Any]) -> NDArray[Any]:
        return np.where(on_this, on_own[:, None], on_other[:, None])

    def there_and_back(arc: compiled.rules.ArcRow[Array]) -> Array:
        return np.fmax(2.0 * arc.angle_error, arc.time_error / arc.time)

    fall = _falls(disk, motions, ends, how.accuracy)
    back, back_error = (np.where(crosses & both, column, 0.0) for column in (there.time, there.time_error))
    period = 2.0 * (here.time + back)
    to_other = np.where(crosses, here.time + back, period)
    first = np.where(rises, to_other - lead.time, lead.time)
    first_error = lead.time_error + np.where(rises, 2.0 * (here.time_error + back_error), 0.0)
    error = each(there_and_back(here), there_and_back(there)) + np.nan_to_num(2.0 * fall.error)[:, None]
    tilts, tilt_errors = tilts_by_face(motions, ends)
    error = np.fmax(error, each(*tilt_errors))
    error = np.maximum(error, (first_error / period)[:, None])
    chi, psi = each(2.0 * here.chi, 2.0 * there.chi), each(2.0 * own * here.psi, -2.0 * own * there.psi)
    duration = each(2.0 * here.time, 2.0 * there.time)
    known = (np.isfinite(duration) & (error <= allowed(how.accuracy, chi, psi))).all(axis=1)
    later = number * to_other[:, None]
    time: Array = first[:, None] + later
    late = (first_error[:, None] + later * error.max(axis=1)[:, None]) / np.fmax(period[:, None], time)
    fall_angle = np.broadcast_to(2.0 * fall.chi[:, None], chi.shape)
    none = np.zeros(chi.shape, np.int64)
    return Bounces(
        row=none,
        bounce=none,
        time=time * disk.time_unit,
        face=each(own, -own).astype(np.int8),
        side=each(np.sign(motions.starts.Y), np.sign(motions.Y_far)).astype(np.int8),
        theta_min=each(*tilts),
        delta_chi=chi,
        delta_psi=psi,
        fall_angle=fall_angle,
        race_angle=chi - fall_angle,
        duration=duration * disk.time_unit,
        error_estimate=np.fmax(error, late),
        status=motions.status(known, crosses, how.accuracy)[:, None] + np.zeros_like(none, np.int8),
        states=states,
    )


def _falls(disk: Disk, motions: ArcStarts, ends: Ends, accuracy: float) -> compiled.passages.FallRow[Array]:
    """The falls with the constants of motions, from how these are at the vertical or would be."""
    Y, Y_far, K = motions.starts.Y, motions.Y_far, ends.vertical.K
    eta, size = np.where(abs(Y) <= abs(Y_far), Y, Y_far) * disk.body.I1, motions.starts.K
    departures = departures_of_moving(disk, motions.starts.X * disk.body.r0, eta, K, abs(K) + 2.0 * size)
    return fall_integrals(disk, departures, accuracy=accuracy)

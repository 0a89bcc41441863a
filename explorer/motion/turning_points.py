"""Turning points, where motions stop tilting: the next by integration, and the smallest tilt by either method."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion import integration
from explorer.motion.error_estimates import (
    FEW,
    LINGERS,
    PASSAGE,
    accepted,
    amplification,
    error_of,
    less_where_amplified,
    speed_at_vertical,
)
from explorer.motion.orbits import KERNELS, ends_of, tilts_by_face
from explorer.motion.plan import Plan
from explorer.motion.starts import arc_starts, face_of, status_at_start
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array, States


@dataclass(frozen=True)
class TurningPoints:
    """The next points at which motions stop tilting (p = 0), natural units except where said.

    theta: tilt from the nearer flat state (rad). face: which flat state that is. turn_rate: sigma3/q there,
    whose sign is the direction in which the contact point moves. time, chi, psi: increase since the start; zero
    on the reduced level. error: how far they may be off. Entries are NaN where status is not OK.
    """

    theta: Array
    face: NDArray[np.int8]
    turn_rate: Array
    time: Array
    chi: Array
    psi: Array
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    error: Array


def tilt_of(states: Array) -> Array:
    """The tilt of states from the nearer flat state (rad); rows as `compiled.field.ROW`."""
    q, z = states[compiled.field.ROW.q], states[compiled.field.ROW.z]
    return np.asarray(np.arctan2(q, abs(z)))


def turning_points(
    states: States, how: Plan, tilts_only: bool = False, swing: Array | float = np.inf
) -> TurningPoints:
    """Follow every state forward to its next turning point, held to its sigma3_bar and eta.

    tilts_only: nothing else is asked for; a slow way over the vertical amplifies errors of the time and angles.
    swing: how far motions swing, in x = ln tan(theta/2). What is little shows no errors: tolerances are as much
    less, and fixed steps are compared with shorter ones.
    """
    given = integration.InitialValues(
        *(states.disk, how, states.natural, states.motion, status_at_start(states)),
        np.full(states.size, how.control),
    )
    amplified, small = np.ones(states.size), np.fmin(swing, np.ones(states.size))
    if how.adaptive:
        given = given.finer(small)
    if not tilts_only:
        amplified = amplification(speed_at_vertical(states.disk, states.motion))
        given = given.finer(less_where_amplified(how, amplified))

    def estimate(found: integration.Integrated, rows: Any) -> Array:
        ended = found.out[:, 0].T
        error = error_of(states.disk, how, found.moved, ended, amplified[rows], PASSAGE)
        hidden = ended[compiled.field.ROW.t] > LINGERS
        hidden |= found.steps <= FEW if how.adaptive else small[rows] < 1.0
        return np.where(hidden, np.inf, error)

    event, asked = compiled.events.TURNING_POINT, accepted(how, 0.0)
    found, error, _ = integration.follow_accurately(given, event, np.zeros(1), estimate, asked)
    error[found.status != compiled.status.Status.OK] = np.nan
    row, out = compiled.field.ROW, found.out[:, 0].T
    face = np.where(out[row.z] >= 0.0, np.int8(1), np.int8(-1))
    turned = out[row.rho], out[row.t], out[row.chi], out[row.psi]
    return TurningPoints(tilt_of(out), face, *turned, found.status, found.steps, error)


def tilt_kernels(how: Plan) -> tuple[str, ...]:
    """The kernels of `smallest_tilt`, for `compiled.warmup`."""
    return "algebra.constants_batch", *(KERNELS if how.method == "quadrature" else (how.kernel,))


def smallest_tilt(states: States, how: Plan) -> tuple[Array, NDArray[np.int8], NDArray[np.int32]]:
    """theta_min of every motion (rad), with status and number of steps.

    A motion swings between two turning points. By quadrature they are roots of the amended
    potential; by integration, following it forward to one and backward to the other costs half a
    period in all, and if either fails the sample fails.
    """
    if how.method == "quadrature":
        theta, status = smallest_tilts(states, 2, how.accuracy)
        steps = np.zeros(status.size, np.int32)
    else:
        ahead, behind = turning_points_around(states, how, tilts_only=True)
        theta, steps = np.minimum(ahead.theta, behind.theta), ahead.steps + behind.steps
        status = np.where(ahead.status == compiled.status.Status.OK, behind.status, ahead.status)
    return np.where(status == compiled.status.Status.OK, theta, np.nan), status, steps


def turning_points_around(
    states: States, how: Plan, tilts_only: bool = False, swing: Array | float = np.inf
) -> tuple[TurningPoints, TurningPoints]:
    """The next turning points and those before; a state at rest is the one before itself."""
    ahead, behind = (turning_points(each, how, tilts_only, swing) for each in (states, states.reversed()))
    rest = np.flatnonzero(states.rows.p == 0.0)
    behind.theta[rest], behind.face[rest] = tilt_of(states.natural[:, rest]), face_of(states.at(rest))
    for values in (behind.time, behind.chi, behind.psi, behind.error):
        values[rest] = 0.0
    return ahead, behind


def smallest_tilts(states: States, count: int, accuracy: float) -> tuple[Array, NDArray[np.int8]]:
    """The smallest tilt (rad) in the next `count` approaches to flat, and the status; 0 of what falls in these.

    All approaches on one face are alike, so that two say all.
    """
    code, own, status = compiled.status.Status, face_of(states), status_at_start(states, sided=False)
    if not states.disk.body.I3 > 0.0:  # there is no potential of the tilt alone
        status[status == code.OK] = code.STEP_LIMIT
    theta, falls = np.full(status.shape, np.nan), status == code.FALLS
    rows = np.flatnonzero((status == code.OK) | falls)
    motions = rows_of(arc_starts(states.disk, states.rows, states.motion, own > 0.0), rows)
    ends = ends_of(states.disk, motions)
    # The first approach may be on the other face than the one that is nearer to F. A pendulum falls on both.
    pendulum = falls & (states.motion.eta_plus == states.motion.eta_minus)
    elsewhere = (own[rows] * states.rows.p[rows] > 0.0) & ends.crosses & ~pendulum[rows] & (count == 1)
    both, errors = tilts_by_face(motions, ends)
    other = elsewhere if count == 1 else both[1] < both[0]
    tilt, error = (np.where(other, each[1], each[0]) for each in (both, errors))
    falling = falls[rows] & ~elsewhere
    known = falling | (error <= accuracy)
    tilt = np.where(falling, 0.0, tilt)
    theta[rows] = np.where(known, tilt, np.nan)
    status[rows[~known]] = motions.status(known, ends.crosses, accuracy)[~known]
    return theta, status

"""Passages by integration to the turning point, doubled: the second half is the first run backwards."""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.error_estimates import accepted
from explorer.motion.passage_starts import Followed, VerticalStarts
from explorer.motion.plan import Plan
from explorer.motion.turning_points import TurningPoints, turning_points
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States

# What rounding moves p by while a slow start leaves the vertical, for each unit of the rates there: some units of
# the last digit. It covers the errors of starts with any eta_hat up to 1e4, down to speeds of 1e-11, within 2.
_UNIT = 1e-15


def by_integration(disk: Disk, starts: VerticalStarts, how: Plan) -> tuple[Followed, NDArray[np.int32]]:
    """Passages from the vertical to the turning point, doubled: the second half is the first run backwards.

    Also how many steps were attempted for each.
    """
    code, face = compiled.status.Status, starts.face
    states = constants_to_states(disk, starts.sigma3_bar, starts.eta_hat, starts.speed, face)
    turn, error = followed_to_flattest(states, how)
    status = np.where(starts.status == code.OK, turn.status, starts.status).astype(np.int8)
    ok = status == code.OK
    status[ok & ~(error <= accepted(how, 0.0))] = code.STEP_LIMIT
    # A passage ends at the flat state it was sent to; one that turns elsewhere was never near it.
    status[ok & (turn.face != face)] = code.BAD_INPUT
    bar, eta, speed = starts.natural(disk)
    angles, rate = (2.0 * turn.chi, 2.0 * turn.psi * face), np.ascontiguousarray(turn.turn_rate)
    followed = turn.theta, *angles, 2.0 * turn.time, rate, states.motion.energy
    return Followed(bar, eta, speed, face, *followed, error, status), turn.steps


def followed_to_flattest(states: States, how: Plan, swing: Array | float = np.inf) -> tuple[TurningPoints, Array]:
    """The turning points of motions that start at the vertical, and how far they may be off."""
    turn = turning_points(states, how, swing=swing)
    return turn, turn.error + _rounding_at_rest(states, turn.time)


def _rounding_at_rest(states: States, time: Array) -> Array:
    """What the rounding of a slow start adds to the angles (rad), which all turn while it leaves the vertical.

    time: of the way to the turning point, natural units, in which the angles turn by rate * time. Rounding moves p
    by a share of the rates, and the start is early or late by as much as that is beside what p was, or becomes in
    a unit of time by the force at the vertical, eq. (2.16).
    """
    _q, _z, p, rho, sigma4 = states.rows
    body, rate = states.disk.body, np.fmax(abs(rho), abs(sigma4))
    short = np.minimum(time, 1.0)
    leaves = abs(p) + body.J_over_M * abs(rho * sigma4) * short
    with np.errstate(over="ignore"):  # such an estimate is refused, however large it is
        found: Array = _UNIT * rate * np.fmax(rate * time, short) / (leaves + np.finfo(float).tiny)
    return found

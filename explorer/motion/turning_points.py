"""Turning points, where motions stop tilting: the next by integration, and the smallest tilt by either method."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.orbits import ends_of, smallest
from explorer.motion.parts import BLOCK, attended
from explorer.motion.plan import Plan
from explorer.motion.starts import Motions, held_constants, orbit_starts, status_at_start
from explorer.phase.constants import NaturalConstants, best_constants, natural_constants
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States

# Some thousand passages at the finest settings; only a start beside an equilibrium needs more.
MAX_STEPS = 2_000_000


@dataclass(frozen=True)
class TurningPoints:
    """The next points at which motions stop tilting (p = 0), natural units except where said.

    theta: tilt from the nearer flat state (rad). face: which flat state that is. way: sigma3/q there,
    whose sign is the direction in which the contact point moves. time, chi, psi: increase since the start; zero
    on the reduced rung. constants_error: how far the constants of motion tried to move on the way, relative to
    their bounds, which is in proportion to the error. Entries are NaN where status is not OK.
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


def turning_points(
    states: States, how: Plan, natural: NaturalConstants | None = None, share: Array | float = 1.0
) -> TurningPoints:
    """Follow every state forward to its next turning point, held to its sigma3_bar and eta.

    share: of the tolerance or step that the plan gives, for each state.
    """
    if natural is None:
        natural = natural_constants(states)
    status, held = held_constants(states, natural)
    integration = how.integration(np.full(len(states), how.control_for(share)), MAX_STEPS)
    out, outcome = followed(states, integration, status, np.stack(held))
    out[:, outcome.status != compiled.status.Status.OK] = np.nan
    row = compiled.field.ROW
    return TurningPoints(
        theta=np.arctan2(out[row.q], abs(out[row.z])),
        face=np.where(out[row.z] >= 0.0, 1, -1).astype(np.int8),
        way=out[row.rho],
        time=out[row.t],
        chi=out[row.chi],
        psi=out[row.psi],
        status=outcome.status,
        steps=outcome.steps,
        constants_error=abs(outcome.errors[0]) + abs(outcome.errors[1]),
    )


def followed(
    states: States, how: "compiled.attempt.Integration", status: NDArray[np.int8], pinned: Array
) -> tuple[Array, "compiled.attempt.Outcome"]:
    """States (8, n) at the next turning points, rows as `compiled.field.ROW`, and what became of each.

    status: samples that come in as not OK are skipped; it becomes the outcome's. pinned (3, n): sigma3_bar,
    eta_plus and eta_minus that each is held to; NaN: it runs free.
    """
    n, disk = len(states), states.disk
    initial, out = np.zeros((8, n)), np.empty((8, n))
    initial[:5] = states.natural
    outcome = compiled.attempt.Outcome(status, np.empty(n, np.int32), np.empty((3, n)))
    stop = compiled.events.Stop(compiled.events.TURNING_POINT, 0.0)
    work = compiled.batch.Work(how, stop, initial, pinned, out, outcome)
    follow = partial(compiled.batch.FIRST_EVENT[how.method], work, disk.natural, disk.whole)
    if n <= BLOCK:
        follow()
    else:  # a kernel skips samples that are not OK when their turn comes
        attended(follow, partial(status.fill, compiled.status.Status.STEP_LIMIT))
    return out, outcome


def tilt_kernels(how: Plan) -> tuple[str, ...]:
    """The kernels of `smallest_tilt`, for `compiled.warmup`."""
    by_roots = ("turning_points.orbit_batch", "turning_points.inward_batch")
    return "algebra.constants_batch", *(by_roots if how.method == "quadrature" else (how.first_event,))


def smallest_tilt(
    states: States,
    how: Plan,
    natural: NaturalConstants | None = None,
    of_states: NDArray[np.int8] | None = None,
) -> tuple[Array, NDArray[np.int8], NDArray[np.int32]]:
    """theta_min of every motion (rad), with status and number of steps.

    A motion swings between two turning points. By quadrature they are roots of the amended
    potential; by integration, following it forward to one and backward to the other costs half a
    period in all, and if either fails the sample fails.

    natural: without them the constants that were given with the states win over those computed from them.
    of_states: the status that `falls_of` gives them, where it is known already.
    """
    code = compiled.status.Status
    if natural is None:
        natural = best_constants(states)
    if how.method == "quadrature":
        status = status_at_start(states, natural) if of_states is None else of_states.copy()
        steps = np.zeros(len(states), np.int32)
        theta = lowest_tilts(states.disk, orbit_starts(states, natural.linear), how.accuracy, status)
    else:
        theta, status, steps = _both_ways(states, how, natural)
    return np.where(status == code.OK, theta, np.nan), status, steps


def lowest_tilts(disk: Disk, motions: Motions, accuracy: float, status: NDArray[np.int8]) -> Array:
    """The tilt of motions at their flattest moment (rad), from where E - V is 0.

    status: samples that come in as not OK are skipped; it becomes the outcome's.
    """
    theta, code = np.full(status.size, np.nan), compiled.status.Status
    if not disk.body.I3 > 0.0:  # there is no potential of the tilt alone
        status[status == code.OK] = code.STEP_LIMIT
        return theta
    rows = np.flatnonzero(status == code.OK)
    ends = ends_of(disk, motions.at(rows))
    theta[rows] = smallest(ends)
    # Errors are those of ln tan(theta/2), so relative ones of the tilt.
    known = np.fmax(ends.inner.error, ends.far.error) <= accuracy
    status[rows[~known]] = code.STEP_LIMIT
    return theta


def _both_ways(
    states: States, how: Plan, natural: NaturalConstants
) -> tuple[Array, NDArray[np.int8], NDArray[np.int32]]:
    """The smaller tilt at the next turning point and at the one before, integrated in one call.

    A start at rest is a turning point itself, which both of these pass over.
    """
    n, row = len(states), compiled.field.ROW
    status, held = held_constants(states, natural)
    both = States(states.disk, np.hstack([states.natural, states.reversed().natural]), np.tile(states.status, 2))
    integration = how.integration(np.full(2 * n, how.control_for(1.0)), MAX_STEPS)
    out, outcome = followed(both, integration, np.tile(status, 2), np.tile(np.stack(held), 2))
    q, z = np.hstack([out[[row.q, row.z]], states.natural[[row.q, row.z]]])
    tilts = np.arctan2(q, abs(z)).reshape(3, n)
    forward, backward = outcome.status.reshape(2, n)
    found = np.where(forward == compiled.status.Status.OK, backward, forward)
    return tilts.min(axis=0), found, outcome.steps.reshape(2, n).sum(axis=0, dtype=np.int32)

"""Whole motions between their turning points by integration: what `orbits` gives from arcs, from steps."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.orbits import Ends, Orbits
from explorer.motion.passages_by_integration import followed_to_flattest
from explorer.motion.plan import Plan
from explorer.motion.turning_points import turning_points_around
from explorer.phase.coordinates import constants_to_states
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array, States

_OF_ARC = 0.25  # of the accuracy: a motion is followed from its state to both of its turning points, and on


def integrated_orbits(states: States, own: Array, ends: Ends, how: Plan) -> tuple[Ends, Orbits]:
    """The turning points of motions and the arcs between them, by a method of integration.

    own: the face in whose hemisphere each state is. ends: by algebra, for the speed at the vertical. A motion that
    comes to the vertical is followed from there to each face, another one from its state to both turning points.
    What could not be followed has infinite errors.
    """
    n, finer = states.size, replace(how, accuracy=_OF_ARC * how.accuracy)
    # Of a small swing, and of how near a motion comes to rest at a crest, steps have to err by a share.
    small = np.fmin(ends.width, ends.slowest)
    turns = turning_points_around(states, finer, swing=small)
    theta, face, time, chi, psi, steps, error = (
        np.stack([getattr(turn, name) for turn in turns])
        for name in ("theta", "face", "time", "chi", "psi", "steps", "error")
    )
    # Each step may round the tilt by its last digit, and turning points come early or late by that share.
    swing = np.fmin(abs(np.subtract(*(face * np.log(np.tan(0.5 * theta))))), ends.width)
    with np.errstate(divide="ignore"):  # nothing is known where no swing is seen
        share = np.finfo(np.float64).eps * steps.sum(axis=0) / swing
    late, off = share * time.sum(axis=0), share * np.fmax(abs(chi.sum(axis=0)), abs(psi.sum(axis=0)))
    crosses = face[0] != face[1]
    # 0 where the flattest moment on this face lies ahead of the state, 1 where behind it
    inner = np.where(crosses, face[0] != own, theta[0] > theta[1]).astype(int)
    each = np.arange(n)

    def arc(time: Array, chi: Array, psi: Array, error: Array) -> "compiled.rules.ArcRow[Array]":
        error = np.nan_to_num(error, nan=np.inf)
        return compiled.rules.ArcRow(time, chi, psi, time_error=error * time + late, angle_error=0.5 * error + off)

    lead = arc(*(column[inner, each] for column in (time, chi, own * psi, error)))
    here = [time.sum(axis=0), chi.sum(axis=0), own * psi.sum(axis=0), error.sum(axis=0)]
    there = [np.full(n, np.nan) for _ in here]
    rows = np.flatnonzero(crosses)
    for seen, found in ((own, here), (-own, there)):
        passed = _from_vertical(states, seen, ends, finer, rows, small[rows])
        for column, values in zip(found, passed, strict=True):
            column[rows] = values
    unsure = np.nan_to_num(error, nan=np.inf).max(axis=0)

    def turned(at: "compiled.turning_points.Place[Array]", theta: Array) -> "compiled.turning_points.Place[Array]":
        return at._replace(r=np.tan(0.5 * theta), error=unsure)

    known = ends._replace(
        crosses=crosses,
        inner=turned(ends.inner, theta[inner, each]),
        far=turned(ends.far, np.where(crosses, theta[1 - inner, each], np.nan)),
    )
    return known, Orbits(arc(*here), arc(*there), lead)


def _from_vertical(
    states: States, face: Array, ends: Ends, how: Plan, rows: NDArray[np.intp], swing: Array
) -> tuple[Array, ...]:
    """Time, chi, psi as the face has it, and the error, of some motions from the vertical to a turning point."""
    disk, motion, unit = states.disk, rows_of(states.motion, rows), states.disk.rate_unit
    eta_hat, own = eta_to_eta_hat(disk.body, motion.eta(face[rows] > 0.0)), face[rows]
    with np.errstate(invalid="ignore"):  # no speed where there is no vertical: bad input, and no answer
        speed = np.sqrt(2.0 * disk.body.inv_M * ends.vertical.K[rows])
    # Of the other eta more digits are known than this one tells.
    at = replace(
        constants_to_states(disk, motion.sigma3_bar * unit, eta_hat * unit, speed * unit, own), given=motion
    )
    turn, error = followed_to_flattest(at, how, swing)
    failed = (turn.status != compiled.status.Status.OK) | (turn.face != own)
    return turn.time, turn.chi, turn.psi * own, np.where(failed, np.nan, error)

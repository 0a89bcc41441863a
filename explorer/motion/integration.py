"""Motions as the kernels follow them to given values of an event, and again by finer steps where that is needed.

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.error_estimates import SHARE, turned
from explorer.motion.plan import FIXED, Plan
from explorer.motion.threads import attended
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import Motion, rows_of
from explorer.phase.states import Array

# Some thousand passages at the finest settings; only a start beside an equilibrium needs more.
MAX_STEPS = 2_000_000
# Finer steps are to err by a third of what is asked, and by a third of what the ones before did or less. Those to
# be compared err by a tenth; errors of adaptive methods may hardly change between two tolerances that are ten
# times apart, so these are thirty.
_THIRD, _LEAST, _FIXED, _ADAPTIVE = 0.3, 1e-4, 0.1, 0.03
_RUNS = 8  # finer ones at most, each slower than the one before


class InitialValues(NamedTuple):
    """Motions before they are followed: initial (5 or 10, n); motion: the constants that they are held to;
    control (n): their steps or tolerances."""

    disk: Disk
    plan: Plan
    initial: Array
    motion: Motion
    status: NDArray[np.int8]
    control: Array
    max_steps: int = MAX_STEPS

    def at(self, rows: NDArray[np.intp] | slice) -> InitialValues:
        """Some of them."""
        initial, motion = np.ascontiguousarray(self.initial[:, rows]), rows_of(self.motion, rows)
        return self._replace(initial=initial, motion=motion, status=self.status[rows], control=self.control[rows])

    def finer(self, less: Array) -> InitialValues:
        """The same by steps that err by so much less: each (n), or all ()."""
        power = 1.0 if self.plan.adaptive else 1.0 / FIXED[self.plan.method]
        return self._replace(control=self.plan.at_least(self.control * less**power))


class Integrated(NamedTuple):
    """What became of motions: out (n, values, 10), NaN where one did not get there; status (n); attempted steps
    (n); moved (3, n), rows as `engine.Moved`."""

    out: Array
    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    moved: Array


def follow(given: InitialValues, event: compiled.events.Event, values: Array) -> Integrated:
    """Follow motions until the event has taken all of the values, in their order."""
    n, disk, how = given.status.size, given.disk, given.plan
    held = np.stack(given.motion[:3])
    if not disk.body.I3 > 0.0:  # there are no such constants, and motions run free
        held.fill(np.nan)
    moved, steps = np.full((3, n), np.nan), np.zeros(n, np.int32)
    found = Integrated(np.empty((n, values.size, 10)), given.status.copy(), steps, moved)
    work = compiled.engine.Work(
        *(how.kernel_method, given.max_steps, event, values, given.control, given.initial, held),
        *(found.status, found.out, steps, moved),
    )
    run = partial(compiled.engine.FOLLOW[how.kernel_method, how.kernel_depth], work, disk.natural)
    # A kernel ends motions whose status somebody else changes: by that it ends where nobody waits for it.
    attended(run, partial(found.status.fill, compiled.status.Status.STEP_LIMIT))
    found.out[found.status != compiled.status.Status.OK] = np.nan
    return found


Estimator = Callable[[Integrated, Any], Array]


def follow_accurately(
    given: InitialValues, event: compiled.events.Event, values: Array, estimate: Estimator, asked: float
) -> tuple[Integrated, Array, InitialValues]:
    """Follow motions, and those that may err by more than is asked once more by finer steps, until none does.

    estimate(found, rows): of the errors of those rows, from what holding moved; infinite where that does not tell
    it, so that two runs are compared. Returns what was found, how far it may be off, and the motions with the
    steps by which it was. Where no steps do, the status is STEP_LIMIT.
    """
    # numpy compares with a member of an IntEnum ten times more slowly than with an int.
    ok, lost = int(compiled.status.Status.OK), int(compiled.status.Status.NOT_FINITE)
    found, control = follow(given, event, values), given.control.copy()
    error, finest = estimate(found, np.s_[:]), np.zeros(control.size, np.bool_)

    def unsettled() -> NDArray[np.intp]:
        error[found.status == lost] = np.inf  # steps so long that a motion runs away
        rows = np.flatnonzero(~(error <= asked))
        status = found.status[rows]
        return np.asarray(rows[(status == ok) | (status == lost)])

    if given.plan.setting is None:
        for _ in range(_RUNS):
            rows = unsettled()
            rows = rows[~finest[rows]]
            if not rows.size:
                break
            by_accuracy = np.clip(_THIRD * asked / error[rows], _LEAST, _THIRD)
            less = np.where(np.isfinite(error[rows]), by_accuracy, _ADAPTIVE if given.plan.adaptive else _FIXED)
            finer = given._replace(control=control).at(rows).finer(less)
            # What has no finer steps is compared with a run by coarser ones, and stays.
            finest[rows] = finer.control >= control[rows]
            stays = finest[rows]
            finer.control[stays] = control[rows[stays]] / _THIRD
            better = follow(finer, event, values)
            # The difference is the error of the coarser run; of the finer one it is less, with a reserve of three.
            apart = distance_between(better.out, found.out[rows], in_time=event.t != 0.0)
            known = apart + SHARE * given.plan.accuracy
            error[rows] = np.where(stays, known, np.clip(estimate(better, rows), 3.0 * less * apart, known))
            found.steps[rows] += better.steps
            rows = rows[~stays]
            found.out[rows], found.status[rows] = better.out[~stays], better.status[~stays]
            found.moved[:, rows], control[rows] = better.moved[:, ~stays], finer.control[~stays]
        found.status[unsettled()] = compiled.status.Status.STEP_LIMIT
    found.out[found.status != ok] = np.nan
    return found, error, given._replace(control=control)


def distance_between(one: Array, other: Array, in_time: bool) -> Array:
    """How far states (n, values, 10) are apart: in the tilt and the angles (rad), the time or the path (r).

    in_time: at given times, within a race of which chi shows an error of the time many times over.
    """
    row, apart = compiled.field.ROW, np.moveaxis(abs(one - other), -1, 0)
    tilt, path = np.hypot(apart[row.q], apart[row.z]), np.hypot(apart[row.a1], apart[row.a2])
    many = turned(np.moveaxis(one, -1, 0)) if in_time else 1.0
    angles = np.maximum(apart[row.chi], apart[row.psi]) / many
    farthest: Array = np.max([tilt, angles, apart[row.t], path], axis=(0, 2))
    return farthest

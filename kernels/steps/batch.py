"""Many samples at once to their first event: lanes that the compiler vectorises, a kernel for each method.

LANES samples advance side by side, each with its own step; the loop over lanes has no branch.
A lane whose sample has met its event takes the next sample at once, so nobody waits for the slowest.
Lane and scalar code do the same strict arithmetic: the results of samples that run free equal those of a
plain loop bit for bit. None depends on a sample's neighbours.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.disk.body import Disk
from kernels.disk.chaplygin import Whole
from kernels.disk.constants import constants_of
from kernels.disk.field import column
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps import lanes
from kernels.steps.attempt import (
    DOP853,
    DOPRI5,
    RK4,
    RK8,
    Integration,
    Outcome,
    constants_error,
    dop853_attempt,
    dopri5_attempt,
    first_step,
    rk4_attempt,
    rk8_attempt,
    to_depth,
    verdict,
)
from kernels.steps.events import Stop
from kernels.steps.landing import aim, approach_events, move
from kernels.steps.lanes import BROKEN, HIT, LANES, NOTHING, NOW, ROWS, STUCK, read
from kernels.types import Longs, Matrix, Vector

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)


class Work(NamedTuple):
    """Motions to follow, and where their ends go.

    states (8, n): rows as State. pinned (3, n): rows as Pinned, the constants that each motion is held to; NaN in
    the first: it runs free. out (8, n): the states where they came to the stop, NaN where one failed. errors of
    the outcome: rows as ConstantsError of a motion that ran free, as Moved of one that was held.
    """

    how: Integration
    stop: Stop
    states: Matrix
    pinned: Matrix
    out: Matrix
    outcome: Outcome


class Moved(NamedTuple):
    """What holding a motion to its constants showed of the error of its steps.

    energy: its largest relative error. rates: the sum of what sigma3/q and sigma4 were moved by, over their
    bounds.
    """

    energy: float
    rates: float
    nothing: float


class Group(NamedTuple):
    """Samples side by side: their work array, which they are (-1: none), and since which sweep they are there."""

    W: Vector
    samples: Longs
    since: Longs


class Place(NamedTuple):
    """How far the work is: the next sample, how many are in lanes, and when one of them runs out of steps."""

    upcoming: int
    busy: int
    due: int


@subroutine
def fail(work: Work, j: int, code: int, spent: int) -> None:
    """Mark sample j as not computed, after `spent` steps."""
    work.out[:, j] = math.nan
    work.outcome.errors[:, j] = math.nan
    work.outcome.status[j] = code
    work.outcome.steps[j] = spent


@subroutine
def failure(note: float) -> int:
    """Status of a sample that ended without its event."""
    if note == BROKEN:
        return _NOT_FINITE
    if note == STUCK:
        return _TOO_SMALL
    return _STEP_LIMIT


@subroutine
def begin(work: Work, j: int, W: Vector, i: int, disk: Disk) -> None:
    """Start sample j in lane i."""
    control = work.how.control[j]
    unit = lanes.load(W, i, column(work.states, j), disk.body)
    W[lanes.CONTROL * LANES + i] = control
    W[lanes.STEP * LANES + i] = first_step(work.how.method, control, unit)
    W[lanes.X_HELD * LANES + i] = work.pinned[0, j] / disk.body.r0
    W[lanes.Y_PLUS * LANES + i] = work.pinned[1, j] / disk.body.I1
    W[lanes.Y_MINUS * LANES + i] = work.pinned[2, j] / disk.body.I1


@subroutine
def fill(work: Work, at: Group, upcoming: int, sweeps: int, disk: Disk) -> Place:
    """Samples from `upcoming` on into the lanes that are empty."""
    max_steps, status = work.how.max_steps, work.outcome.status
    busy, due = 0, sweeps + max_steps
    for i in range(LANES):
        if at.samples[i] < 0:
            while upcoming < status.size and status[upcoming] != _OK:
                fail(work, upcoming, status[upcoming], 0)
                upcoming += 1
            if upcoming == status.size:
                lanes.idle(at.W, i)
                continue
            begin(work, upcoming, at.W, i, disk)
            at.samples[i], at.since[i] = upcoming, sweeps
            upcoming += 1
        busy += 1
        due = min(due, at.since[i] + max_steps)
    return Place(upcoming, busy, due)


@subroutine
def finish(work: Work, j: int, W: Vector, i: int, disk: Disk) -> None:
    """Store sample j, which reached its event in column i, with its verdict."""
    y = to_depth(read(W, NOW, i), work.how.depth)
    put(y, work.out, j)
    if not math.isnan(W[lanes.X_HELD * LANES + i]):
        energy = W[lanes.EXCESS * LANES + i] / W[lanes.ENERGY * LANES + i]
        rates = W[lanes.MOVED * LANES + i] / W[lanes.UNIT * LANES + i]
        put(Moved(energy, rates, 0.0), work.outcome.errors, j)
        work.outcome.status[j] = _OK if math.isfinite(y.rho + rates) else _NOT_FINITE
        return
    first, last = constants_of(column(work.states, j), disk), constants_of(y, disk)
    near_plus = y.z >= 0.0
    error = constants_error(first, last, near_plus)
    eta = first.eta_plus if near_plus else first.eta_minus
    put(error, work.outcome.errors, j)
    scale, bound = math.sqrt(2.0 * first.energy / disk.body.I1), work.how.constants_bound
    work.outcome.status[j] = verdict(error, eta, scale, bound)


@subroutine
def put_down(attempt_by: Any, work: Work, at: Group, disk: Disk, whole: Whole) -> None:
    """Locate the events of a group within their last steps, and store its samples."""
    W, stop, b = at.W, work.stop, disk.body
    aim(W, stop, b)
    lanes.sweep(attempt_by, W, stop, b)
    lanes.hold(W, W.view(np.int64), whole, b)
    approach_events(W, stop, b)
    for i in range(LANES):
        j = at.samples[i]
        if j >= 0 and W[lanes.NOTE * LANES + i] == NOTHING:
            finish(work, j, W, i, disk)
        elif j >= 0:
            fail(work, j, _STEP_LIMIT, work.outcome.steps[j])
        at.samples[i] = -1


@subroutine
def leave(work: Work, at: Group, sweeps: int, landing: Group, waiting: int, i: int) -> int:
    """Take the sample out of lane i if it is through; returns how many wait for their landing."""
    j, note, spent = at.samples[i], at.W[lanes.NOTE * LANES + i], sweeps - at.since[i]
    if j < 0 or (note == NOTHING and spent < work.how.max_steps):
        return waiting
    at.samples[i] = -1
    if note != HIT:
        fail(work, j, failure(note), spent)
        return waiting
    move(at.W, i, landing.W, waiting)
    landing.samples[waiting] = j
    work.outcome.steps[j] = spent
    return waiting + 1


@maker
def empty() -> Group:
    """A group without samples."""
    return Group(np.zeros(ROWS * LANES), np.full(LANES, -1), np.zeros(LANES, np.int64))


@device
def follow(attempt_by: Any, work: Work, at: Group, landing: Group, disk: Disk, whole: Whole) -> None:
    """Follow every motion until it comes to the stop. `at`, `landing`: empty groups."""
    bits = at.W.view(np.int64)
    sweeps = waiting = 0
    place = fill(work, at, 0, 0, disk)
    while place.busy > 0:
        attention = lanes.sweep(attempt_by, at.W, work.stop, disk.body)
        sweeps += 1
        lanes.hold(at.W, bits, whole, disk.body)
        if attention > 0 or sweeps >= place.due:
            for i in range(LANES):
                waiting = leave(work, at, sweeps, landing, waiting, i)
                if waiting == LANES:
                    put_down(attempt_by, work, landing, disk, whole)
                    waiting = 0
            place = fill(work, at, place.upcoming, sweeps, disk)
    put_down(attempt_by, work, landing, disk, whole)


@kernel
def first_event_rk4(work: Work, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk4 to its stop."""
    follow(rk4_attempt, work, empty(), empty(), disk, whole)


@kernel
def first_event_rk8(work: Work, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk8 to its stop."""
    follow(rk8_attempt, work, empty(), empty(), disk, whole)


@kernel
def first_event_dopri5(work: Work, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dopri5 to its stop."""
    follow(dopri5_attempt, work, empty(), empty(), disk, whole)


@kernel
def first_event_dop853(work: Work, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dop853 to its stop."""
    follow(dop853_attempt, work, empty(), empty(), disk, whole)


FIRST_EVENT: dict[int, Callable[[Work, Disk, Whole], None]] = {
    RK4: first_event_rk4,
    RK8: first_event_rk8,
    DOPRI5: first_event_dopri5,
    DOP853: first_event_dop853,
}

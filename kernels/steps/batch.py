"""Many samples at once to their first event: lanes that the compiler vectorises, a kernel for each method.

LANES samples advance side by side, each with its own step; the loop over lanes has no branch.
A lane whose sample has met its event takes the next sample at once, so nobody waits for the slowest.
Lane and scalar code do the same strict arithmetic: the results of samples that run free equal `trajectory`'s
bit for bit. None depends on a sample's neighbours.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.chaplygin import Whole
from kernels.disk.constants import Pinned, constants_of
from kernels.disk.field import State, column
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
from kernels.steps.landing import aim, land, move
from kernels.steps.lanes import BROKEN, HIT, LANES, NOTHING, NOW, ROWS, STUCK, read
from kernels.types import Matrix, Vector

_OK = int(Status.OK)
_DRIFT = int(Status.INVARIANT_DRIFT)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)


class Motions(NamedTuple):
    """What is followed. states (8, n): rows as State; pinned (3, n): as Pinned, the constants that it is held to."""

    states: Matrix
    pinned: Matrix
    stop: Stop


class Held(NamedTuple):
    """What holding a sample to its constants has shown, instead of a ConstantsError.

    energy: its largest relative error; moved: the sum of what rho and sigma4 were moved by, over their bounds.
    """

    energy: float
    moved: float
    nothing: float


class Arrivals(NamedTuple):
    """Where it came to. out (8, n): the states there, NaN where a sample failed; and what became of it."""

    out: Matrix
    outcome: Outcome


@subroutine
def fail(j: int, code: int, spent: int, to: Arrivals) -> None:
    """Mark sample j as not computed, after `spent` steps."""
    to.out[:, j] = math.nan
    to.outcome.errors[:, j] = math.nan
    to.outcome.status[j] = code
    to.outcome.steps[j] = spent


@subroutine
def failure(note: float) -> int:
    """Status of a sample that ended without its event."""
    if note == BROKEN:
        return _NOT_FINITE
    if note == STUCK:
        return _TOO_SMALL
    return _STEP_LIMIT


@subroutine
def begin(how: Integration, motions: Motions, j: int, W: Vector, i: int, disk: Disk) -> None:
    """Start sample j in lane i."""
    x, control = column(motions.states, j), how.control[j]
    unit = lanes.load(W, i, x, disk.body)
    W[lanes.CONTROL * LANES + i] = control
    W[lanes.STEP * LANES + i] = first_step(how.method, control, unit)
    W[lanes.X_HELD * LANES + i] = motions.pinned[0, j] / disk.body.r0
    W[lanes.Y_PLUS * LANES + i] = motions.pinned[1, j] / disk.body.I1
    W[lanes.Y_MINUS * LANES + i] = motions.pinned[2, j] / disk.body.I1


@subroutine
def finish(how: Integration, motions: Motions, j: int, W: Vector, i: int, disk: Disk, to: Arrivals) -> None:
    """Store sample j, which reached its event in column i, with the error of its constants and the verdict."""
    y = to_depth(read(W, NOW, i), how.depth)
    put(y, to.out, j)
    if not math.isnan(W[lanes.X_HELD * LANES + i]):
        energy, unit = W[lanes.ENERGY * LANES + i], W[lanes.UNIT * LANES + i]
        put(Held(W[lanes.EXCESS * LANES + i] / energy, W[lanes.MOVED * LANES + i] / unit, 0.0), to.outcome.errors, j)
        to.outcome.status[j] = _OK if math.isfinite(y.rho) else _NOT_FINITE
        return
    first, last = constants_of(column(motions.states, j), disk), constants_of(y, disk)
    near_plus = y.z >= 0.0
    error = constants_error(first, last, near_plus)
    eta = first.eta_plus if near_plus else first.eta_minus
    put(error, to.outcome.errors, j)
    to.outcome.status[j] = verdict(
        error, eta, math.sqrt(2.0 * first.energy / disk.body.I1), how.constants_bound
    )


@subroutine
def put_down(
    attempt_by, how: Integration, motions: Motions, V: Vector, samples, disk: Disk, whole: Whole, to: Arrivals
) -> None:  # type: ignore[no-untyped-def]
    """Locate the events of the samples in V and store them."""
    b, stop = disk.body, motions.stop
    aim(V, stop, b)
    length = V[lanes.NOTE * LANES : (lanes.NOTE + 1) * LANES].copy()
    lanes.sweep(attempt_by, V, stop, b)
    lanes.hold(V, V.view(np.int64), whole, b)
    V[lanes.STEP * LANES : (lanes.STEP + 1) * LANES] = length
    land(V, stop, b)
    for i in range(LANES):
        j = samples[i]
        if j >= 0 and V[lanes.NOTE * LANES + i] == NOTHING:
            finish(how, motions, j, V, i, disk, to)
        elif j >= 0:
            fail(j, _STEP_LIMIT, to.outcome.steps[j], to)
        samples[i] = -1


@device
def follow(attempt_by, how: Integration, motions: Motions, disk: Disk, whole: Whole, to: Arrivals) -> None:  # type: ignore[no-untyped-def]
    """Follow every sample until it comes to the stop."""
    max_steps, b, status, n = how.max_steps, disk.body, to.outcome.status, motions.states.shape[1]
    W, V = np.zeros(ROWS * LANES), np.zeros(ROWS * LANES)
    bits = W.view(np.int64)
    sample, landing, since = np.full(LANES, -1), np.full(LANES, -1), np.zeros(LANES, np.int64)
    upcoming = sweeps = due = waiting = 0
    refill = True
    while True:
        if refill:
            busy = 0
            due = sweeps + max_steps
            for i in range(LANES):
                if sample[i] < 0:
                    while upcoming < n and status[upcoming] != _OK:
                        fail(upcoming, status[upcoming], 0, to)
                        upcoming += 1
                    if upcoming == n:
                        lanes.idle(W, i)
                        continue
                    begin(how, motions, upcoming, W, i, disk)
                    sample[i], since[i] = upcoming, sweeps
                    upcoming += 1
                busy += 1
                due = min(due, since[i] + max_steps)
            if busy == 0:
                break
        attention = lanes.sweep(attempt_by, W, motions.stop, b)
        sweeps += 1
        refill = attention > 0 or sweeps >= due
        if refill:
            for i in range(LANES):
                j, note, spent = sample[i], W[lanes.NOTE * LANES + i], sweeps - since[i]
                if j < 0 or (note == NOTHING and spent < max_steps):
                    continue
                sample[i] = -1
                if note != HIT:
                    fail(j, failure(note), spent, to)
                    continue
                move(W, i, V, waiting)
                landing[waiting] = j
                to.outcome.steps[j] = spent
                waiting += 1
                if waiting == LANES:
                    put_down(attempt_by, how, motions, V, landing, disk, whole, to)
                    waiting = 0
        lanes.hold(W, bits, whole, b)
    put_down(attempt_by, how, motions, V, landing, disk, whole, to)


@kernel
def first_event_rk4(how: Integration, motions: Motions, disk: Disk, whole: Whole, to: Arrivals) -> None:
    """Follow every sample of `motions` by rk4 to its stop; alike below."""
    follow(rk4_attempt, how, motions, disk, whole, to)


@kernel
def first_event_rk8(how: Integration, motions: Motions, disk: Disk, whole: Whole, to: Arrivals) -> None:
    """By rk8."""
    follow(rk8_attempt, how, motions, disk, whole, to)


@kernel
def first_event_dopri5(how: Integration, motions: Motions, disk: Disk, whole: Whole, to: Arrivals) -> None:
    """By dopri5."""
    follow(dopri5_attempt, how, motions, disk, whole, to)


@kernel
def first_event_dop853(how: Integration, motions: Motions, disk: Disk, whole: Whole, to: Arrivals) -> None:
    """By dop853."""
    follow(dop853_attempt, how, motions, disk, whole, to)


FIRST_EVENT = {RK4: first_event_rk4, RK8: first_event_rk8, DOPRI5: first_event_dopri5, DOP853: first_event_dop853}

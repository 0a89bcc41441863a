"""Many samples at once to their first event: lanes that the compiler vectorises.

LANES samples advance side by side, each with its own step; the loop over lanes has no branch.
A lane whose sample is finished takes the next sample at once, so nobody waits for the slowest.
Lane and scalar code do the same strict arithmetic: the results equal `trajectory`'s bit for bit
and do not depend on a sample's neighbours.
"""

import math

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.constants import Constants, constants_of
from kernels.disk.field import ANGLES, REDUCED, State, column, speed
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    DOP853,
    DOPRI5,
    RK4,
    RK8,
    Integration,
    Outcome,
    all_finite,
    attempt,
    constants_error,
    first_guess,
    first_step,
    partial_step,
    settle,
    to_depth,
    verdict,
)
from kernels.steps.events import Stop, crossed, level
from kernels.types import Matrix, Vector

LANES = 16  # two AVX-512 registers: enough independent work to hide latency, few enough to stay in them

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)

# Rows of the work array of a group of lanes: entry (row, i) stands at row * LANES + i. One flat
# array with constant offsets, so that the compiler can see that rows do not overlap; with several
# arrays, or a two-dimensional one, it gives up vectorising ("too many memory checks needed").
_NOW, _BEFORE = 0, 8  # states: after and before the latest attempted step
_STEP, _TAKEN, _CONTROL, _UNIT, _NOTE = 16, 17, 18, 19, 20
_ROWS = 21
# notes of a sweep on a lane
_NOTHING, _HIT, _BROKEN, _STUCK = 0.0, 1.0, 2.0, 3.0


@device
def read(W: Vector, row: int, i: int, depth: int) -> State:
    """The state in column i, its first component in the given row."""
    return State(
        W[row * LANES + i],
        W[(row + 1) * LANES + i],
        W[(row + 2) * LANES + i],
        W[(row + 3) * LANES + i],
        W[(row + 4) * LANES + i],
        W[(row + 5) * LANES + i] if depth > REDUCED else 0.0,
        W[(row + 6) * LANES + i] if depth > REDUCED else 0.0,
        W[(row + 7) * LANES + i] if depth > REDUCED else 0.0,
        0.0,
        0.0,
    )


@device
def write(W: Vector, row: int, i: int, y: State, depth: int) -> None:
    """Put a state into column i, its first component into the given row."""
    W[row * LANES + i] = y.q
    W[(row + 1) * LANES + i] = y.z
    W[(row + 2) * LANES + i] = y.p
    W[(row + 3) * LANES + i] = y.rho
    W[(row + 4) * LANES + i] = y.sigma4
    if depth > REDUCED:
        W[(row + 5) * LANES + i] = y.t
        W[(row + 6) * LANES + i] = y.chi
        W[(row + 7) * LANES + i] = y.psi


@device
def sweep(method: int, depth: int, W: Vector, stop: Stop, b: Body) -> int:
    """One attempted step of every lane; returns how many need attention."""
    for i in range(LANES):
        x = read(W, _NOW, i, depth)
        h = W[_STEP * LANES + i]
        unit = W[_UNIT * LANES + i]
        y, accepted, following = attempt(method, depth, x, h, W[_CONTROL * LANES + i], unit, b)
        hit = accepted & crossed(level(x, stop.event), level(y, stop.event), stop.value)
        broken = accepted & (not all_finite(y))
        stuck = (not accepted) & (not following * unit > SHORTEST_STEP)
        note = _HIT if hit else _NOTHING
        note = _BROKEN if broken else note
        note = _STUCK if stuck else note
        W[_NOTE * LANES + i] = note
        W[_TAKEN * LANES + i] = h
        W[_STEP * LANES + i] = following
        write(W, _BEFORE, i, x, depth)
        write(W, _NOW, i, y if accepted else x, depth)
    attention = 0
    for i in range(LANES):
        attention += W[_NOTE * LANES + i] != _NOTHING
    return attention


@device
def sweep_any(method: int, depth: int, W: Vector, stop: Stop, b: Body) -> int:
    """sweep() with method and depth only known at run time: one vectorised loop for each."""
    if method == RK4:
        return sweep_at_depth(RK4, depth, W, stop, b)
    if method == RK8:
        return sweep_at_depth(RK8, depth, W, stop, b)
    if method == DOP853:
        return sweep_at_depth(DOP853, depth, W, stop, b)
    return sweep_at_depth(DOPRI5, depth, W, stop, b)


@device
def sweep_at_depth(method: int, depth: int, W: Vector, stop: Stop, b: Body) -> int:
    """sweep() with the depth only known at run time."""
    if depth == REDUCED:
        return sweep(method, REDUCED, W, stop, b)
    return sweep(method, ANGLES, W, stop, b)


@subroutine
def idle(W: Vector, i: int) -> None:
    """Park lane i: an upright disk at rest that takes steps of length zero."""
    for row in range(_ROWS):
        W[row * LANES + i] = 0.0
    W[_NOW * LANES + i] = 1.0
    W[_CONTROL * LANES + i] = W[_UNIT * LANES + i] = 1.0


@subroutine
def load(method: int, W: Vector, i: int, x: State, control: float, b: Body) -> None:
    """Start the sample with initial state x in lane i."""
    unit = speed(x, b)
    write(W, _NOW, i, x, ANGLES)
    W[_CONTROL * LANES + i] = control
    W[_UNIT * LANES + i] = unit
    W[_STEP * LANES + i] = first_step(method, control, unit)


@subroutine
def fail(j: int, code: int, spent: int, out: Matrix, outcome: Outcome) -> None:
    """Mark sample j as not computed, after `spent` steps."""
    out[:, j] = math.nan
    outcome.errors[:, j] = math.nan
    outcome.status[j] = code
    outcome.steps[j] = spent


@subroutine
def finish(
    j: int, y: State, begin: Constants[float], bound: float, disk: Disk, out: Matrix, outcome: Outcome
) -> None:
    """Store sample j, which reached its event at y, with the change of its constants and verdict."""
    end = constants_of(y, disk)
    # The face that the sample comes to, whichever is nearer: its eta decides the race there.
    plus = y.z >= 0.0
    moved = constants_error(begin, end, plus)
    eta = begin.eta_plus if plus else begin.eta_minus
    outcome.status[j] = verdict(moved, eta, math.sqrt(2.0 * begin.energy / disk.body.I1), bound)
    put(moved, outcome.errors, j)
    put(y, out, j)


@subroutine
def aim(W: Vector, i: int, depth: int, stop: Stop, b: Body) -> None:
    """Put lane i back to the start of its last step, to go only about as far as the event."""
    x, end = read(W, _BEFORE, i, depth), read(W, _NOW, i, depth)
    write(W, _NOW, i, x, depth)
    W[_STEP * LANES + i] = first_guess(x, end, W[_TAKEN * LANES + i], stop, b)


@subroutine
def landed(method: int, depth: int, W: Vector, i: int, h: float, stop: Stop, b: Body) -> State:
    """The state at the event of lane i, whose last step, once of length h, was cut short by `aim`."""
    x, y, length = read(W, _BEFORE, i, depth), read(W, _NOW, i, depth), W[_TAKEN * LANES + i]
    if y.q == x.q and y.z == x.z and y.p == x.p:
        # Refused, although shorter than an accepted step: taken as it is, as `locate` does.
        y = partial_step(method, x, length, b)
    return to_depth(settle(method, x, h, length, y, stop, b), depth)


@subroutine
def failure(note: float) -> int:
    """Status of a sample that ended without its event."""
    if note == _BROKEN:
        return _NOT_FINITE
    if note == _STUCK:
        return _TOO_SMALL
    return _STEP_LIMIT


@kernel
def first_event_batch(
    how: Integration, stop: Stop, states: Matrix, disk: Disk, out: Matrix, outcome: Outcome
) -> None:
    """Follow every column of states (8, n), rows as State, until it comes to the stop.

    out (8, n): the states there, NaN where the sample failed.
    """
    method, depth, max_steps, b = how.method, how.depth, how.max_steps, disk.body
    status, n = outcome.status, states.shape[1]
    W = np.zeros(_ROWS * LANES)
    sample = np.full(LANES, -1, np.int64)
    since = np.zeros(LANES, np.int64)
    # Length of the step in which a lane's event lies, while its last, partial step is taken.
    last_step = np.zeros(LANES)
    upcoming = sweeps = due = landing = 0
    refill = True
    while True:
        if refill:
            busy = 0
            due = sweeps + max_steps
            for i in range(LANES):
                if sample[i] < 0:
                    while upcoming < n and status[upcoming] != _OK:
                        fail(upcoming, status[upcoming], 0, out, outcome)
                        upcoming += 1
                    if upcoming == n:
                        idle(W, i)
                        continue
                    load(method, W, i, column(states, upcoming), how.control[upcoming], b)
                    sample[i], since[i] = upcoming, sweeps
                    upcoming += 1
                busy += 1
                due = min(due, since[i] + max_steps)
            if busy == 0:
                return
        attention = sweep_any(method, depth, W, stop, b)
        sweeps += 1
        refill = False
        if attention == 0 and sweeps < due and landing == 0:
            continue
        for i in range(LANES):
            j, note, spent = sample[i], W[_NOTE * LANES + i], sweeps - since[i]
            if last_step[i] > 0.0:
                y = landed(method, depth, W, i, last_step[i], stop, b)
                begin = constants_of(column(states, j), disk)
                finish(j, y, begin, how.constants_bound, disk, out, outcome)
                last_step[i] = 0.0
                landing -= 1
                outcome.steps[j] = spent - 1
            elif j < 0 or (note == _NOTHING and spent < max_steps):
                continue
            elif note == _HIT:
                last_step[i] = W[_TAKEN * LANES + i]
                aim(W, i, depth, stop, b)
                landing += 1
                continue
            else:
                fail(j, failure(note), spent, out, outcome)
            sample[i] = -1
            refill = True

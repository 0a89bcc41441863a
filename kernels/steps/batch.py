"""Many samples at once to their first event: lanes that the compiler vectorises.

LANES samples advance side by side, each with its own step; the loop over lanes has no branch.
A lane whose sample is finished takes the next sample at once, so nobody waits for the slowest.
Lane and scalar code do the same strict arithmetic: the results equal `trajectory`'s bit for bit
and do not depend on a sample's neighbours.
"""

import math

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.constants import constants_of
from kernels.disk.field import ANGLES, REDUCED, State, speed
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    DOP853,
    DOPRI5,
    RK4,
    RK8,
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
from kernels.steps.events import Event, crossed, level
from kernels.types import Codes, Counts, Matrix, Vector

LANES = 16  # two AVX-512 registers: enough independent work to hide latency, few enough to stay in them

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)

# Rows of the work array of a group of lanes: entry (row, i) stands at row * LANES + i. One flat
# array with constant offsets, so that the compiler can see that rows do not overlap; with several
# arrays, or a two-dimensional one, it gives up vectorising ("too many memory checks needed").
_NOW, _BEFORE = 0, 8  # states: after and before the latest attempted step
_STEP, _TAKEN, _CONTROL, _UNIT, _FOUND = 16, 17, 18, 19, 20
_ROWS = 21
# what a sweep found in a lane
_NOTHING, _HIT, _BROKEN, _STUCK = 0.0, 1.0, 2.0, 3.0


@device
def read(W, row, i, depth):
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
def write(W, row, i, y, depth):
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
def sweep(method, depth, W, event, target, b):
    """One attempted step of every lane; returns how many need attention."""
    for i in range(LANES):
        x = read(W, _NOW, i, depth)
        h = W[_STEP * LANES + i]
        unit = W[_UNIT * LANES + i]
        y, accepted, following = attempt(method, depth, x, h, W[_CONTROL * LANES + i], unit, b)
        hit = accepted & crossed(level(x, event), level(y, event), target)
        broken = accepted & (not all_finite(y))
        stuck = (not accepted) & (not following * unit > SHORTEST_STEP)
        note = _HIT if hit else _NOTHING
        note = _BROKEN if broken else note
        note = _STUCK if stuck else note
        W[_FOUND * LANES + i] = note
        W[_TAKEN * LANES + i] = h
        W[_STEP * LANES + i] = following
        write(W, _BEFORE, i, x, depth)
        write(W, _NOW, i, choose(accepted, y, x), depth)
    attention = 0
    for i in range(LANES):
        attention += W[_FOUND * LANES + i] != _NOTHING
    return attention


@device
def choose(condition, x, y):
    """x where the condition holds, else y."""
    return State(
        x.q if condition else y.q,
        x.z if condition else y.z,
        x.p if condition else y.p,
        x.rho if condition else y.rho,
        x.sigma4 if condition else y.sigma4,
        x.t if condition else y.t,
        x.chi if condition else y.chi,
        x.psi if condition else y.psi,
        x.a1 if condition else y.a1,
        x.a2 if condition else y.a2,
    )


@device
def sweep_any(method, depth, W, event, target, b):
    """sweep() with method and depth only known at run time: one vectorised loop for each."""
    if method == RK4:
        return sweep_at_depth(RK4, depth, W, event, target, b)
    if method == RK8:
        return sweep_at_depth(RK8, depth, W, event, target, b)
    if method == DOP853:
        return sweep_at_depth(DOP853, depth, W, event, target, b)
    return sweep_at_depth(DOPRI5, depth, W, event, target, b)


@device
def sweep_at_depth(method, depth, W, event, target, b):
    """sweep() with the depth only known at run time."""
    if depth == REDUCED:
        return sweep(method, REDUCED, W, event, target, b)
    return sweep(method, ANGLES, W, event, target, b)


@subroutine
def idle(W, i):
    """Park lane i: an upright disk at rest that takes steps of length zero."""
    for row in range(_ROWS):
        W[row * LANES + i] = 0.0
    W[_NOW * LANES + i] = 1.0
    W[_CONTROL * LANES + i] = W[_UNIT * LANES + i] = 1.0


@subroutine
def column(states, j):
    """The state in column j of an (8, n) array."""
    return State(
        states[0, j],
        states[1, j],
        states[2, j],
        states[3, j],
        states[4, j],
        states[5, j],
        states[6, j],
        states[7, j],
        0.0,
        0.0,
    )


@subroutine
def load(method, W, i, x, control, b):
    """Start the sample with initial state x in lane i."""
    unit = speed(x, b)
    write(W, _NOW, i, x, ANGLES)
    W[_CONTROL * LANES + i] = control
    W[_UNIT * LANES + i] = unit
    W[_STEP * LANES + i] = first_step(method, control, unit)


@subroutine
def fail(j, code, out, errors, status):
    """Mark sample j as not computed."""
    out[:, j] = math.nan
    errors[:, j] = math.nan
    status[j] = code


@subroutine
def finish(j, y, begin, constants_bound, b, series, out, errors, status):
    """Store sample j, which reached its event at y, with the change of its constants and verdict."""
    end = constants_of(y, b, series)
    near_plus = y.z >= 0.0
    moved = constants_error(begin, end, near_plus)
    eta = begin.eta_plus if near_plus else begin.eta_minus
    status[j] = verdict(moved, eta, math.sqrt(2.0 * begin.energy / b.I1), constants_bound)
    errors[0, j], errors[1, j], errors[2, j] = moved.energy, moved.sigma3_bar, moved.eta
    out[0, j], out[1, j], out[2, j], out[3, j] = y.q, y.z, y.p, y.rho
    out[4, j], out[5, j], out[6, j], out[7, j] = y.sigma4, y.t, y.chi, y.psi


@subroutine
def aim(W, i, depth, event, target, b):
    """Put lane i back to the start of its last step, to go only about as far as the event."""
    x, end = read(W, _BEFORE, i, depth), read(W, _NOW, i, depth)
    write(W, _NOW, i, x, depth)
    W[_STEP * LANES + i] = first_guess(x, end, W[_TAKEN * LANES + i], event, target, b)


@subroutine
def landed(method, depth, W, i, h, event, target, b):
    """The state at the event of lane i, whose last step, once of length h, was cut short by `aim`."""
    x, y, length = read(W, _BEFORE, i, depth), read(W, _NOW, i, depth), W[_TAKEN * LANES + i]
    if y.q == x.q and y.z == x.z and y.p == x.p:
        # Refused, although shorter than an accepted step: taken as it is, as `locate` does.
        y = partial_step(method, x, length, b)
    return to_depth(settle(method, x, h, length, y, event, target, b), depth)


@subroutine
def failure(found):
    """Status of a sample that ended without its event."""
    if found == _BROKEN:
        return _NOT_FINITE
    if found == _STUCK:
        return _TOO_SMALL
    return _STEP_LIMIT


@kernel
def first_event_batch(
    method: int,
    depth: int,
    states: Matrix,
    control: Vector,
    event: Event,
    target: float,
    max_steps: int,
    constants_bound: float,
    b: Body,
    series: Matrix,
    out: Matrix,
    status: Codes,
    steps: Counts,
    errors: Matrix,
) -> None:
    """Follow every column of states (8, n) until `event` first takes the value `target`.

    control (n): step in units of 1/speed (RK4, RK8) or tolerance (DOPRI5, DOP853).
    out (8, n): the states there, NaN where the sample failed. status (n): samples that come in as not
    OK are skipped. steps (n): attempted steps. errors (3, n): as attempt.ConstantsError.
    """
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
                    while upcoming < status.size and status[upcoming] != _OK:
                        steps[upcoming] = 0
                        fail(upcoming, status[upcoming], out, errors, status)
                        upcoming += 1
                    if upcoming == status.size:
                        idle(W, i)
                        continue
                    load(method, W, i, column(states, upcoming), control[upcoming], b)
                    sample[i], since[i] = upcoming, sweeps
                    upcoming += 1
                busy += 1
                due = min(due, since[i] + max_steps)
            if busy == 0:
                return
        attention = sweep_any(method, depth, W, event, target, b)
        sweeps += 1
        refill = False
        if attention == 0 and sweeps < due and landing == 0:
            continue
        for i in range(LANES):
            j, found, spent = sample[i], W[_FOUND * LANES + i], sweeps - since[i]
            if last_step[i] > 0.0:
                y = landed(method, depth, W, i, last_step[i], event, target, b)
                begin = constants_of(column(states, j), b, series)
                finish(j, y, begin, constants_bound, b, series, out, errors, status)
                last_step[i] = 0.0
                landing -= 1
                steps[j] = spent - 1
            elif j < 0 or (found == _NOTHING and spent < max_steps):
                continue
            elif found == _HIT:
                last_step[i] = W[_TAKEN * LANES + i]
                aim(W, i, depth, event, target, b)
                landing += 1
                continue
            else:
                fail(j, failure(found), out, errors, status)
                steps[j] = spent
            sample[i] = -1
            refill = True

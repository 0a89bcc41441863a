"""One trajectory recorded at its own steps, dense enough for a curve, and its states at any time between them.

In s, with dt = q ds, a race is as smooth as the rest of a motion: dchi/ds = rho is bounded by kappa times the
speed. So steps are kept short enough for a picture, and each is recorded with its own time. The times of another
integration would not do: near F they differ from these by more than the race lasts.
"""

import math
from typing import NamedTuple

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.constants import Pinned, constants_of
from kernels.disk.field import State, column, energy, reduced, speed
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    RK4,
    RK8,
    Integration,
    Outcome,
    all_finite,
    first_step,
    locate,
    partial_step,
    to_depth,
)
from kernels.steps.events import TIME, Stop
from kernels.steps.trajectory import Ending, attempt_any, begin, hold, judge
from kernels.types import Longs, Matrix, Vector

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)

# Steps are planned this much below the longest that are kept, so that few are refused.
_SHARE = 0.9
# What `Going.stage` says.
FRESH, UNDERWAY, ENDED = range(3)


class Curve(NamedTuple):
    """What is recorded: steps of chi (rad) and of time (units of 1/speed) at most so long, up to t_end."""

    angle: float
    time: float
    t_end: float


class Start(NamedTuple):
    """Where a motion began, x (10, 1), and what it is held to, pinned (3, 1): rows as Pinned."""

    x: Matrix
    pinned: Matrix


class Going(NamedTuple):
    """A motion between two pieces of its record; all is read and written.

    x (10, 1): the state. h, unit, total, removed (1): the next step, the rate by which steps are measured, the
    energy to be held and what was taken out of it.
    steps, rows, stage (1): attempted steps so far, records in this piece, and FRESH, UNDERWAY or ENDED.
    """

    x: Matrix
    h: Vector
    unit: Vector
    total: Vector
    removed: Vector
    steps: Longs
    rows: Longs
    stage: Longs


STEP = len(State._fields)  # the column of a record, after the state, with the step in s that was taken from there


@subroutine
def longest(x: State, curve: Curve, pace: float, b: Body) -> float:
    """The step in s in which chi or the time changes nearly as much as is allowed between two records.

    chi changes by rho h + rho' h^2 / 2: where a race begins, the second term is the larger one.
    """
    _dq, _dz, _dp, drho, _dsigma4 = reduced(x, b)
    angle = _SHARE * curve.angle
    steep = abs(x.rho) + math.sqrt(x.rho * x.rho + 2.0 * abs(drho) * angle)
    return min(2.0 * angle / steep, curve.time / (pace * x.q))


@subroutine
def write(x: State, h: float, out: Matrix, row: int) -> None:
    """One record: the state and the step that is taken from it."""
    for component in range(STEP):
        out[row, component] = x[component]
    out[row, STEP] = h


@subroutine
def step_on(how: Integration, curve: Curve, x: State, going: Going, b: Body) -> tuple[int, State, float]:
    """One accepted step that is short enough: a status, the state after it, and its length."""
    fixed = how.method in (RK4, RK8)
    pace, unit = speed(x, b), going.unit[0]
    while going.steps[0] < how.max_steps:
        h = min(going.h[0], longest(x, curve, pace, b))
        y, accepted, following = attempt_any(how.method, how.depth, x, h, how.control[0], unit, b)
        going.steps[0] += 1
        if accepted and not all_finite(y):
            return _NOT_FINITE, x, h
        if accepted and abs(y.chi - x.chi) <= curve.angle:
            # A fixed step must not stay as short as one place asked for.
            going.h[0] = first_step(how.method, how.control[0], unit) if fixed else following
            return _OK, y, h
        going.h[0] = 0.5 * h if accepted else following
        if not going.h[0] * unit > SHORTEST_STEP:
            return _TOO_SMALL, x, h
    return _STEP_LIMIT, x, 0.0


@subroutine
def piece(
    how: Integration, curve: Curve, x: State, pinned: Pinned[float], disk: Disk, going: Going, out: Matrix
) -> tuple[int, State]:
    """Follow one motion until t_end, or until out (rows, 11) has only one row left: status and last state."""
    b = disk.body
    for row in range(out.shape[0] - 1):
        code, y, h = step_on(how, curve, x, going, b)
        if code != _OK:
            return code, x
        write(x, h, out, row)
        going.rows[0] = row + 1
        if y.t >= curve.t_end:
            end = y if y.t == curve.t_end else locate(how.method, x, y, h, Stop(TIME, curve.t_end), b)
            write(to_depth(end, how.depth), 0.0, out, row + 1)
            going.rows[0] = row + 2
            going.stage[0] = ENDED
        x, excess = hold(x, y, pinned, going.total[0], disk)
        going.removed[0] += excess
        if going.stage[0] == ENDED:
            break
    return _OK, x


@kernel
def record_piece(
    how: Integration, curve: Curve, start: Start, disk: Disk, going: Going, out: Matrix, outcome: Outcome
) -> None:
    """The next piece of the record of one motion, out (rows, 11); `Going` says how many rows and if it has ended.

    outcome: of one sample, when it has ended.
    """
    first, pinned = column(start.x, 0), start.pinned
    to = Pinned(pinned[0, 0], pinned[1, 0], pinned[2, 0])
    going.rows[0] = 0
    if going.stage[0] == FRESH:
        x = begin(first, to, disk)
        going.total[0], going.removed[0] = energy(x, disk.body), 0.0
        going.unit[0] = speed(x, disk.body)
        going.h[0] = first_step(how.method, how.control[0], going.unit[0])
        going.stage[0] = UNDERWAY
    else:
        x = column(going.x, 0)
    code, x = piece(how, curve, x, to, disk, going, out)
    put(x, going.x, 0)
    outcome.steps[0] = going.steps[0]
    if code != _OK:
        going.stage[0] = ENDED
    if going.stage[0] == ENDED:
        held = not math.isnan(to.sigma3_bar)
        end = Ending(code, x.t, going.removed[0], held, how.constants_bound)
        start_constants, last = constants_of(first, disk), constants_of(x, disk)
        outcome.status[0], errors = judge(end, start_constants, last, disk.body)
        put(errors, outcome.errors, 0)


@kernel
def at_times(how: Integration, rows: Matrix, places: Longs, times: Vector, disk: Disk, out: Matrix) -> None:
    """States at given times, out (10, times): from the record before each by a part of the step taken there.

    rows (n, 11): the record. places (times): the last row whose time is not later.
    """
    b = disk.body
    for i in range(times.size):
        t, row = times[i], rows[places[i]]
        x = State(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], row[9])
        h = row[STEP]
        if h > 0.0 and t > x.t:
            y = partial_step(how.method, x, h, b)
            # Rounding may leave the end of the step before the next record.
            x = locate(how.method, x, y, h, Stop(TIME, t), b) if y.t > t else y
        put(to_depth(x, how.depth), out, i)

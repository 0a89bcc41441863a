"""Curves of many motions from the steps they took, and their states at any time between the points of a curve.

In s, with dt = q ds, a race is as smooth as the rest of a motion: dchi/ds = rho is bounded by kappa times the
speed. So each step is cut into as many pieces in s as a picture needs, and each point has its own time. The times
of another integration would not do: near F they differ from these by more than the race lasts.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.field import ROW, State, column, field, reduced, speed
from kernels.status import Status
from kernels.steps.attempt import Integration, first_guess, locate, partial_step, to_depth
from kernels.steps.events import TIME, Stop
from kernels.steps.trail import LENGTH, SAMPLE, SHARE, Curve
from kernels.types import Codes, Longs, Matrix, Table, Vector

_OK = int(Status.OK)
_T, _CHI = int(ROW.t), int(ROW.chi)
# A step is interpolated from the ends of so many steps, with their slopes: its own and two to either side. From
# one to either side rk8 and dop853 would have to take steps half as long, and at 1e-9 each would be a point.
_NODES = 6
_WIDTH = 10  # components of a state
ROWS = 11  # of a point
_MOST_PIECES = 10_000  # of one step
# By so much may the only piece of a step be longer than planned, as long as chi does not turn too far: a step that
# is long for its interpolation, and was to be one piece, then stays one.
_LONGER = 0.3
# Columns of the ends of steps, after the state: its slope, and the step from there.
_SLOPE, _STEP, _COLUMNS = 10, 20, 21
# Places in one work array, which costs less to pass on than several: of the nodes of a polynomial their places,
# the squares of their weights and the sums of their inverse distances; products on the way; its value.
_AT, _SQUARES, _SUMS, _BELOW = 0, _NODES, 2 * _NODES, 3 * _NODES
_Y = 4 * _NODES
_WORK = _Y + _WIDTH


class Course(NamedTuple):
    """What motions did: the rows of their `Trail`; last (10, n), end (n, 1, 10): where their last step ended, and
    where in it they came to t_end; status (n); their method; the components that their depth carries; most: points
    of a curve, beyond which it is not drawn to its end."""

    curve: Curve
    rows: Matrix
    last: Matrix
    end: Table
    status: Codes
    t_end: float
    method: int
    depth: int
    most: int


class Drawing(NamedTuple):
    """Curves: points (11, as many as there is room for), rows as State and the step in s to take from there; first
    (n + 1): those of motion j are from first[j] to first[j + 1]."""

    points: Matrix
    first: Longs


@maker
def in_order(course: Course, begins: Longs, order: Longs) -> int:
    """Which rows are of which motion: order from begins[j] to begins[j + 1]; returns how many the longest has."""
    rows, n = course.rows, course.status.size
    for row in range(rows.shape[0]):
        begins[int(rows[row, SAMPLE]) + 1] += 1
    most = 0
    for j in range(n):
        most = max(most, begins[j + 1])
        begins[j + 1] += begins[j]
    place = begins.copy()
    for row in range(rows.shape[0]):
        j = int(rows[row, SAMPLE])
        order[place[j]] = row
        place[j] += 1
    return int(most)


@device
def put_end(ends: Matrix, i: int, x: State, depth: int, b: Body) -> None:
    """The state at the start of step i, with its slope."""
    slope = to_depth(field(x, b), depth)
    for c in range(_WIDTH):
        ends[i, c], ends[i, _SLOPE + c] = x[c], slope[c]


@device
def state(rows: Matrix, i: int) -> State:
    """The state in a row."""
    return State(
        rows[i, 0],
        rows[i, 1],
        rows[i, 2],
        rows[i, 3],
        rows[i, 4],
        rows[i, 5],
        rows[i, 6],
        rows[i, 7],
        rows[i, 8],
        rows[i, 9],
    )


@subroutine
def gather(rows: Matrix, order: Longs, last: State, how: tuple[int, int], ends: Matrix, b: Body) -> None:
    """The ends of the steps in the rows `order`, the last of which leads to `last`, from 1 on; how: method, depth.

    Another such step before the first one and after the last lets these be interpolated from either side as well:
    from one side alone they would err 20 times as much as the others.
    """
    method, depth = how
    count, start = order.size, state(rows, order[0])
    first, final = rows[order[0], LENGTH], rows[order[count - 1], LENGTH]
    put_end(ends, 0, to_depth(partial_step(method, start, -first, b), depth), depth, b)
    ends[0, _STEP] = first
    for i in range(count):
        put_end(ends, i + 1, state(rows, order[i]), depth, b)
        ends[i + 1, _STEP] = rows[order[i], LENGTH]
    put_end(ends, count + 1, last, depth, b)
    ends[count + 1, _STEP] = final
    put_end(ends, count + 2, to_depth(partial_step(method, last, final, b), depth), depth, b)


class Nodes(NamedTuple):
    """The ends of steps, with their slopes, by which step i is interpolated: `number` of them from `first` on."""

    i: int
    first: int
    number: int


@device
def choose(ends: Matrix, i: int, count: int, W: Vector) -> Nodes:
    """The nodes about step i, and what Hermite's formula needs of their places; count: of all ends."""
    first, number = max(min(i - _NODES // 2 + 1, count - _NODES), 0), min(count, _NODES)
    W[_AT + i - first] = 0.0
    for k in range(i - first, number - 1):
        W[_AT + k + 1] = W[_AT + k] + ends[first + k, _STEP]
    for k in range(i - first - 1, -1, -1):
        W[_AT + k] = W[_AT + k + 1] - ends[first + k, _STEP]
    for k in range(number):
        weight, total = 1.0, 0.0
        for j in range(number):
            if j != k:
                inverse = 1.0 / (W[_AT + k] - W[_AT + j])
                weight *= inverse
                total += inverse
        W[_SQUARES + k], W[_SUMS + k] = weight * weight, 2.0 * total
    return Nodes(i, first, number)


@device
def evaluate(ends: Matrix, nodes: Nodes, W: Vector, s: float) -> None:
    """The polynomial s after the start of its step, as a change from there: what changes by less than rounding
    does not change."""
    i, product = nodes.i, 1.0
    for k in range(nodes.number):
        W[_BELOW + k] = product
        product *= s - W[_AT + k]
    for c in range(_WIDTH):
        W[_Y + c] = ends[i, c]
    product = 1.0
    for k in range(nodes.number - 1, -1, -1):
        step, row = s - W[_AT + k], nodes.first + k
        others = W[_BELOW + k] * product
        square = others * others * W[_SQUARES + k]
        of_value, of_slope = (1.0 - W[_SUMS + k] * step) * square, step * square
        for c in range(_WIDTH):
            W[_Y + c] += of_value * (ends[row, c] - ends[i, c]) + of_slope * ends[row, _SLOPE + c]
        product *= step


class Piecewise(NamedTuple):
    """How a step of length h is cut: how densely at its start and at its end (pieces per s), and how many."""

    h: float
    start: float
    end: float
    number: int


@device
def density(rho: float, q: float, curve: Curve, pace: float) -> float:
    """Pieces per s that a curve needs where dchi/ds = rho and dt/ds = q."""
    return max(abs(rho) / (SHARE * curve.angle), pace * q / curve.time)


@subroutine
def pieces(x: State, y: State, h: float, curve: Curve, b: Body) -> Piecewise:
    """How to cut the step from x to y: by its ends, and by Simpson's rule where chi turns faster in its middle."""
    pace = speed(x, b)
    before, after = reduced(x, b), reduced(y, b)
    rho = 0.5 * (x.rho + y.rho) + 0.125 * h * (before[3] - after[3])
    q = 0.5 * (x.q + y.q) + 0.125 * h * (before[0] - after[0])
    start, end = density(x.rho, x.q, curve, pace), density(y.rho, y.q, curve, pace)
    by_ends = 0.5 * (start + end)
    needed = h * max(by_ends, (by_ends + 2.0 * density(rho, q, curve, pace)) / 3.0)
    return Piecewise(h, start, end, 1 if needed <= 1.0 + _LONGER else math.ceil(needed))


@device
def cut(how: Piecewise, number: int, k: int) -> float:
    """Where, in s, piece k of `number` begins: as if the density changed evenly along the step."""
    share = k / number
    root = math.sqrt(how.start * how.start + share * (how.end * how.end - how.start * how.start))
    return how.h * share * (how.start + how.end) / (how.start + root)


@device
def store(y: State, h: float, points: Matrix, point: int) -> None:
    """One point, if there is room, with the step to take from there."""
    if point < points.shape[1]:
        for c in range(_WIDTH):
            points[c, point] = y[c]
        points[_WIDTH, point] = h


class Goal(NamedTuple):
    """What the pieces of a step lead to: chi and the time there; by how much chi may change from point to point;
    and how much of the step, in s, is left beyond."""

    chi: float
    t: float
    angle: float
    rest: float


@subroutine
def draw_pieces(
    ends: Matrix, nodes: Nodes, W: Vector, how: Piecewise, goal: Goal, points: Matrix, point: int
) -> int:
    """The points of one step, from its start on, which becomes `point`; returns the one after them."""
    number = how.number
    while True:
        before, t, here, wide = ends[nodes.i, _CHI], ends[nodes.i, _T], 0.0, False
        for k in range(number):
            there = cut(how, number, k + 1) if k + 1 < number else how.h + goal.rest
            evaluate(ends, nodes, W, here)
            # Rounding must not turn time back.
            t = W[_Y + _T] = min(max(W[_Y + _T], t), goal.t)
            wide |= not abs(W[_Y + _CHI] - before) <= goal.angle
            before = W[_Y + _CHI]
            if point + k < points.shape[1]:
                for c in range(_WIDTH):
                    points[c, point + k] = W[_Y + c]
                points[_WIDTH, point + k] = there - here
            here = there
        wide |= not abs(goal.chi - before) <= goal.angle
        if not wide or number > _MOST_PIECES:
            return point + number
        number += 1 + number // 8


class Extent(NamedTuple):
    """Steps of a motion, and the point beyond which its curve is too long to be drawn to its end."""

    steps: int
    most: int


@maker
def draw_motion(
    ends: Matrix, extent: Extent, end: State, curve: Curve, points: Matrix, point: int, b: Body
) -> int:
    """The points of a motion, whose last step comes to its `end`; returns the one after them."""
    W, steps = np.empty(_WORK), extent.steps
    for i in range(1, steps + 1):
        if point > extent.most:
            break
        x, y, h = state(ends, i), state(ends, i + 1), ends[i, _STEP]
        length = h
        if i == steps:
            length = min(max(first_guess(x, y, h, Stop(TIME, end.t), b), 0.0), h)
            y = end
        how = pieces(x, y, length, curve, b)
        if how.number == 1 and abs(y.chi - x.chi) <= curve.angle:
            store(x, h, points, point)
            point += 1
        else:
            nodes = choose(ends, i, steps + 3, W)
            how = Piecewise(length, how.start, how.end, max(how.number, 2))
            goal = Goal(y.chi, y.t, curve.angle, h - length)
            point = draw_pieces(ends, nodes, W, how, goal, points, point)
    store(end, 0.0, points, point)
    return point + 1


@kernel
def draw_batch(course: Course, drawing: Drawing, disk: Disk) -> None:
    """The curves of all motions that are OK; of others none. There was room where the last of `first` says so."""
    n = course.status.size
    begins, order = np.zeros(n + 1, np.int64), np.empty(course.rows.shape[0], np.int64)
    most, point = in_order(course, begins, order), 0
    ends, end = np.empty((most + 3, _COLUMNS)), course.end.reshape((n, _WIDTH))
    how = course.method, course.depth
    for j in range(n):
        drawing.first[j] = point
        if course.status[j] == _OK:
            own = order[begins[j] : begins[j + 1]]
            gather(course.rows, own, column(course.last, j), how, ends, disk.body)
            y = state(end, j)
            # The time where it was located, but for rounding
            y = State(y.q, y.z, y.p, y.rho, y.sigma4, course.t_end, y.chi, y.psi, y.a1, y.a2)
            extent = Extent(own.size, point + course.most)
            point = draw_motion(ends, extent, y, course.curve, drawing.points, point, disk.body)
    drawing.first[n] = point


class Moments(NamedTuple):
    """Times in any unit; how long that is, and how many there are in a natural one."""

    times: Vector
    unit: float
    per_unit: float


@subroutine
def last_before(t: Vector, unit: float, time: float, low: int, high: int) -> int:
    """The last of the points from low to high - 1 whose time is not later, or the first."""
    while high - low > 1:
        middle = (low + high) // 2
        if t[middle] * unit <= time:
            low = middle
        else:
            high = middle
    return low


@kernel
def at_times(how: Integration, drawing: Drawing, moments: Moments, disk: Disk, out: Table) -> None:
    """States at given times, out (n, times, 10), NaN without a curve: from the point before each by a part of the
    step to be taken there.

    A time of the curve itself, in the unit of the times, is that point: rounding of units must not move it within
    a race.
    """
    b, points, first = disk.body, drawing.points, drawing.first
    for j in range(out.shape[0]):
        if first[j + 1] == first[j]:
            out[j] = math.nan
            continue
        for i in range(moments.times.size):
            time = moments.times[i]
            place = last_before(points[_T], moments.unit, time, first[j], first[j + 1])
            x, h, t = column(points, place), points[_WIDTH, place], time * moments.per_unit
            if h > 0.0 and t > x.t and x.t * moments.unit != time:
                y = partial_step(how.method, x, h, b)
                # Rounding may leave the end of the step before the next point.
                x = locate(how.method, x, y, h, Stop(TIME, t), b) if y.t > t else y
            x = to_depth(x, how.depth)
            for component in range(_WIDTH):
                out[j, i, component] = x[component]

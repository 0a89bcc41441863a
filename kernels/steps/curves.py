"""Curves: the steps of many motions, short enough to be drawn, and states at any time between two of them.

In s, with dt = q ds, a race is as smooth as the rest of a motion: dchi/ds = rho is bounded by kappa times the
speed. So steps that turn chi by little are no shorter there than elsewhere, and each point has its own time. The
times of another integration would not do: near F they differ from these by more than the race lasts.
"""

import math
from typing import NamedTuple

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.field import ROW, State, column, reduced, speed
from kernels.steps.attempt import partial_step, to_depth
from kernels.steps.events import TIME, Stop, first_guess, settle
from kernels.steps.lanes import BEFORE, LANES, NOW, SAMPLE, STEP, TAKEN, read
from kernels.types import Longs, Matrix, Table, Vector

_WIDTH = 10  # components of a state
# Columns of a history, and rows of points, after the state: the step from there; and which motion it is of.
LENGTH, OWNER, COLUMNS = 10, 11, 12
# chi is planned by two terms in the length of the step; where it grows like the exponential of it, as a race
# begins, they miss an eighth of a step of one unit.
_SHARE = 0.85
_T = int(ROW.t)


class History(NamedTuple):
    """The accepted steps of many motions, those of one in their order, among those of others.

    angle, time: chi (rad) and the time (in units of 1/speed) change by no more in a step. rows (as many as there
    is room for, 12): the state before a step, its length in s, and which motion it is of. used (1): how many steps
    there were, also those for which there was no room. most: when there are so many, nothing is followed any
    further. Where most is 0 there is no history, and steps are as long as the accuracy allows.
    """

    angle: float
    time: float
    rows: Matrix
    used: Longs
    most: int


@device
def longest(x: State, angle: float, time: float, b: Body) -> float:
    """The step in s in which chi or the time changes nearly as much as is allowed between two points.

    chi changes by rho h + rho' h^2 / 2: where a race begins, the second term is the larger one.
    """
    drho = reduced(x, b)[3]
    steep = abs(x.rho) + math.sqrt(x.rho * x.rho + 2.0 * abs(drho) * _SHARE * angle)
    of_chi, of_time = 2.0 * _SHARE * angle / steep, time / (speed(x, b) * x.q)
    return of_chi if of_chi < of_time else of_time


@subroutine
def shorten(history: History, W: Vector, b: Body) -> None:
    """Steps about to be taken by all lanes, short enough to be drawn."""
    angle, time = history.angle, history.time
    for i in range(LANES):
        step, most = W[STEP + i], longest(read(W, NOW, i), angle, time, b)
        W[STEP + i] = most if most < step else step


@subroutine
def keep(history: History, W: Vector) -> int:
    """Write down the steps that the lanes have just taken; returns how many there are so far."""
    used = history.used[0]
    for i in range(LANES):
        if W[TAKEN + i] > 0.0 and W[SAMPLE + i] >= 0.0:
            if used < history.rows.shape[0]:
                for component in range(_WIDTH):
                    history.rows[used, component] = W[BEFORE + component * LANES + i]
                history.rows[used, LENGTH] = W[TAKEN + i]
                history.rows[used, OWNER] = W[SAMPLE + i]
            used += 1
    history.used[0] = used
    return int(used)


class Curves(NamedTuple):
    """Points (11, all), rows as State and the step in s to take from there; first (n + 1): those of motion j are
    from first[j] to first[j + 1]."""

    points: Matrix
    first: Longs


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
def at_times(method: int, depth: int, curves: Curves, moments: Moments, b: Body, out: Table) -> None:
    """States at given times, out (n, times, 10), NaN without a curve: from the point before each by a part of the
    step to be taken there.

    A time of the curve itself, in the unit of the times, is that point: rounding of units must not move it within
    a race.
    """
    points, first = curves.points, curves.first
    for j in range(out.shape[0]):
        if first[j + 1] == first[j]:
            out[j] = math.nan
            continue
        for i in range(moments.times.size):
            time = moments.times[i]
            place = last_before(points[_T], moments.unit, time, first[j], first[j + 1])
            x, h, t = column(points, place), points[LENGTH, place], time * moments.per_unit
            if h > 0.0 and t > x.t and x.t * moments.unit != time:
                y = partial_step(method, x, h, b)
                # Rounding may leave the end of the step before the next point.
                if y.t > t:
                    y = settle(method, x, h, first_guess(x, y, h, Stop(TIME, t), b), Stop(TIME, t), b)
                x = y
            x = to_depth(x, depth)
            for component in range(_WIDTH):
                out[j, i, component] = x[component]

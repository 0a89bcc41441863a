"""Trails: the steps that many motions take in lanes, kept as they are taken, from which curves are drawn.

A step that is to be drawn by more than one piece is interpolated from the states and slopes at the ends of five
steps (`recording`). That errs like the twelfth power of the steps; so long ones of order 8 are then taken shorter.
"""

import math
from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.field import State, reduced, speed
from kernels.steps import motion_lanes as lanes
from kernels.steps.attempt import DOP853, RK4, RK8, first_step
from kernels.steps.motion_lanes import BEFORE, LANES, NOW, read
from kernels.types import Longs, Matrix, Vector

# Pieces are planned this much below the longest that are kept, so that few are refused.
SHARE = 0.9
# Steps of order 8 as long as the accuracy allows would be interpolated with up to 5 times the error asked where
# they are long for six ends of steps (in units of 1/speed): from _LONG on the longer are the more shortened, by up
# to _BETWEEN, and are interpolated with half of it at most. Steps of order 4 and 5 are short enough.
_LONG, _BETWEEN = 0.3, 1.25
# Columns of a trail after the state before the step.
LENGTH, SAMPLE = 10, 11
COLUMNS = 12


class Curve(NamedTuple):
    """How dense a curve is: pieces of chi (rad) and of time (units of 1/speed) at most so long."""

    angle: float
    time: float


class Trail(NamedTuple):
    """The accepted steps of many motions, those of one in their order, among those of others.

    rows (as many as there is room for, 12): the state before a step, its length in s, and which motion it is of.
    used (1): how many steps there were, also those for which there was no room. most: when there are so many,
    nothing is followed any further. Where most is 0 there is no trail.
    """

    curve: Curve
    rows: Matrix
    used: Longs
    most: int


@device
def longest(x: State, curve: Curve, pace: float, b: Body) -> float:
    """The step in s in which chi or the time changes nearly as much as is allowed between two points.

    chi changes by rho h + rho' h^2 / 2: where a race begins, the second term is the larger one.
    """
    _dq, _dz, _dp, drho, _dsigma4 = reduced(x, b)
    angle = SHARE * curve.angle
    steep = abs(x.rho) + math.sqrt(x.rho * x.rho + 2.0 * abs(drho) * angle)
    of_chi, of_time = 2.0 * angle / steep, curve.time / (pace * x.q)
    return of_chi if of_chi < of_time else of_time


@subroutine
def shorten(curve: Curve, method: int, W: Vector, b: Body) -> None:
    """Steps about to be taken by all lanes, no longer than their interpolation allows."""
    if method in (RK4, RK8):
        for i in range(LANES):
            # A fixed step must not stay as short as one place asked for.
            step = first_step(method, W[lanes.CONTROL * LANES + i], W[lanes.UNIT * LANES + i])
            W[lanes.STEP * LANES + i] = step if W[lanes.SAMPLE * LANES + i] >= 0.0 else 0.0
    if method in (RK8, DOP853):
        for i in range(LANES):
            x, step = read(W, NOW, i), W[lanes.STEP * LANES + i]
            rate = speed(x, b)
            one_piece = longest(x, curve, rate, b)
            shorter = step / min(max(1.0 - _LONG + step * rate, 1.0), _BETWEEN)
            shorter = shorter if shorter > one_piece else one_piece
            W[lanes.STEP * LANES + i] = shorter if shorter < step else step


@subroutine
def keep(trail: Trail, W: Vector) -> int:
    """Write down the steps that the lanes have just taken; returns how many there are so far."""
    used = trail.used[0]
    for i in range(LANES):
        if W[lanes.TAKEN * LANES + i] > 0.0 and W[lanes.SAMPLE * LANES + i] >= 0.0:
            if used < trail.rows.shape[0]:
                for component in range(LENGTH):
                    trail.rows[used, component] = W[(BEFORE + component) * LANES + i]
                trail.rows[used, LENGTH] = W[lanes.TAKEN * LANES + i]
                trail.rows[used, SAMPLE] = W[lanes.SAMPLE * LANES + i]
            used += 1
    trail.used[0] = used
    return int(used)

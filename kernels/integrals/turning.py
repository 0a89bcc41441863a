"""Turning points: where a motion that comes from the vertical, or goes there, turns back."""

import math

from kernels._jit import subroutine
from kernels.disk.body import Disk
from kernels.integrals import nodes
from kernels.integrals.nodes import ROOM
from kernels.integrals.point import VERTICAL, Motion, kinetic, point
from kernels.types import Vector

# Tilts tried between the vertical and flat when looking for the first turning point.
_SCAN = 24
# Newton's method takes some six steps; bisection, where that leaves the bracket, ends at rounding long before.
_ROOT_LIMIT = 200
# Bisection to rounding of intervals in ln h and in h.
_CREST_LIMIT, _OUTWARD_LIMIT = 60, 80
# ln h below which h is denormal, and where the steps down end.
_DENORMAL, _DEEPEST = -744.0, -740.0
_BESIDE = 0.7  # in ln h: how far from the guess of first order the turning point is looked for
_STRIDE = 2.0  # in ln h
_LN2 = math.log(2.0)
_EPSILON = 2.2e-16


@subroutine
def refine(low: float, high: float, motion: Motion, disk: Disk) -> float:
    """The turning point between ln h = low (P < 0) and high (P > 0), by bracketed Newton in ln h."""
    x = 0.5 * (low + high)
    for _ in range(_ROOT_LIMIT):
        at = point(math.exp(x), motion.X, motion.Y, disk)
        gap = motion.level - at.V
        if gap < 0.0:
            low = x
        else:
            high = x
        # d(E - V)/d ln h = -slope
        guess = x + gap / at.slope if at.slope != 0.0 else low
        if not (low < guess < high):
            guess = 0.5 * (low + high)
        if abs(guess - x) <= 2.0 * _EPSILON * max(1.0, abs(x)):
            return math.exp(guess)
        x = guess
    return math.exp(x)


@subroutine
def crest(low: float, high: float, motion: Motion, disk: Disk) -> float:
    """ln h of the maximum of V between ln h = low, where V rises with h, and high, where it falls."""
    for _ in range(_CREST_LIMIT):
        middle = 0.5 * (low + high)
        if point(math.exp(middle), motion.X, motion.Y, disk).slope > 0.0:
            low = middle
        else:
            high = middle
    return low


@subroutine
def turning_point(h_end: float, rest: bool, motion: Motion, disk: Disk, W: Vector) -> float:
    """h of the first turning point on the way from h_end to flat; NaN if it starts beyond it.

    Steps down in tilt, looking at every local minimum of P on the way (a barrier), then in ln h. W is room
    for `nodes`.
    """
    level, X, Y = motion.level, motion.X, motion.Y
    if rest:
        # From rest it moves towards flat only if V falls that way.
        if not point(h_end, X, Y, disk).slope > 0.0:
            return math.nan
    elif not kinetic(h_end, motion, disk) >= 0.0:
        return math.nan
    for i in range(_SCAN):
        h = h_end * (1.0 - i / _SCAN)
        W[nodes.H * ROOM + i] = h
        W[nodes.LOG * ROOM + i] = 2.0 * math.log(h) - _LN2
    nodes.levels(W, _SCAN, motion, disk)
    above = math.log(h_end)
    for i in range(1, _SCAN):
        here = 0.5 * (W[nodes.LOG * ROOM + i] + _LN2)
        if level < W[nodes.LEVEL * ROOM + i]:
            return refine(here, above, motion, disk)
        if W[nodes.SLOPE * ROOM + i - 1] < 0.0 < W[nodes.SLOPE * ROOM + i]:
            # V rose and falls again: its maximum is between.
            top = crest(here, above, motion, disk)
            if level < point(math.exp(top), X, Y, disk).V:
                return refine(top, above, motion, disk)
        above = here
    return near_flat(above, motion, disk)


@subroutine
def near_flat(above: float, motion: Motion, disk: Disk) -> float:
    """h of the turning point below ln h = above, where P > 0; NaN if there is none."""
    # Near flat h_m = |Y| sqrt(I1/M) / A to leading order: look there before walking down.
    if motion.level > 0.0 and motion.Y != 0.0:
        guess = math.log(abs(motion.Y)) + 0.5 * math.log(0.5 * disk.body.I1 / motion.level)
        if guess + _BESIDE < above:
            low = kinetic(math.exp(max(guess - _BESIDE, _DENORMAL)), motion, disk)
            if low < 0.0 < kinetic(math.exp(guess + _BESIDE), motion, disk):
                return refine(guess - _BESIDE, guess + _BESIDE, motion, disk)
    below = above
    while below > _DEEPEST:
        below -= _STRIDE
        if kinetic(math.exp(below), motion, disk) < 0.0:
            return refine(below, below + _STRIDE, motion, disk)
    return math.nan


@subroutine
def turning_point_outward(h0: float, motion: Motion, disk: Disk) -> float:
    """h of the turning point on the way from h0 to the vertical; NaN if the motion reaches it."""
    level, X, Y = motion.level, motion.X, motion.Y
    inside = math.log(h0)
    slope_inside = point(h0, X, Y, disk).slope
    # At the vertical, but for the rounding of h, there is one place to look at.
    tried = _SCAN if VERTICAL - h0 > 8.0 * _EPSILON else 1
    for i in range(1, tried + 1):
        h = h0 + (VERTICAL - h0) * i / tried
        at = point(h, X, Y, disk)
        here = math.log(h)
        edge = here
        blocked = level < at.V
        if not blocked and slope_inside > 0.0 and at.slope < 0.0:
            edge = crest(inside, here, motion, disk)
            blocked = level < point(math.exp(edge), X, Y, disk).V
        if blocked:
            low, high = inside, edge
            for _ in range(_OUTWARD_LIMIT):
                middle = 0.5 * (low + high)
                if level < point(math.exp(middle), X, Y, disk).V:
                    high = middle
                else:
                    low = middle
            return math.exp(low)
        inside, slope_inside = here, at.slope
    return math.nan

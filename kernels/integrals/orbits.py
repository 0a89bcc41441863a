"""Whole orbits between two turning points: periods, and the smallest tilt without any integral."""

import math

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.falling import potential_at_flat
from kernels.integrals import nodes
from kernels.integrals.quadrature import SCAN, VERTICAL, Passage, crest, passage, point, turning_point
from kernels.status import Status
from kernels.types import Codes, Longs, Matrix, Table, Vector

_OK = int(Status.OK)
_LIMIT = int(Status.STEP_LIMIT)


@subroutine
def turning_point_outward(h0, level, X, Y, b, series):
    """h of the turning point on the way from h0 to the vertical; NaN if the motion reaches it."""
    inside = math.log(h0)
    slope_inside = point(h0, X, Y, b, series).slope
    for i in range(1, SCAN + 1):
        h = h0 + (VERTICAL - h0) * i / SCAN
        at = point(h, X, Y, b, series)
        here = math.log(h)
        edge = here
        blocked = level < at.V
        if not blocked and slope_inside > 0.0 and at.slope < 0.0:
            edge = crest(inside, here, X, Y, b, series)
            blocked = level < point(math.exp(edge), X, Y, b, series).V
        if blocked:
            low, high = inside, edge
            for _ in range(80):
                middle = 0.5 * (low + high)
                if level < point(math.exp(middle), X, Y, b, series).V:
                    high = middle
                else:
                    low = middle
            return math.exp(low)
        inside, slope_inside = here, at.slope
    return math.nan


@subroutine
def orbit(h0, p, X, near, far, target, rules, sizes, b, series, W):
    """One whole period through (h0, theta-dot = p) on face +1, with Y on this and on the other side.

    Returns status, the passage on this side (or between both turning points), the one on the other
    side (chi = psi = time = 0 if the motion does not cross the vertical), and the energy.
    """
    level = 0.5 * b.M * p * p + point(h0, X, near, b, series).V
    none = Passage(math.nan, math.nan, 0.0, 0.0, 0.0, 0.0, 0.0)
    outer = turning_point_outward(h0, level, X, near, b, series)
    if outer > 0.0:
        status, here = passage(outer, True, level, X, near, target, rules, sizes, b, series, W)
        return status, here, none, level
    status, here = passage(VERTICAL, False, level, X, near, target, rules, sizes, b, series, W)
    other_status, there = passage(VERTICAL, False, level, X, far, target, rules, sizes, b, series, W)
    return max(status, other_status), here, there, level


@kernel
def orbit_batch(
    starts: Matrix, target: float, rules: Table, sizes: Longs, b: Body, series: Matrix, out: Matrix, status: Codes
) -> None:
    """`orbit` for every column of starts (5, n): h, theta-dot, sigma3_bar, eta here, eta on the other side.

    All as seen from the hemisphere of the start. out (8, n): smallest tilt here, smallest tilt on the
    other side (NaN if never there), chi, psi, time of one period, energy, error of angles, relative
    error of time. status (n): samples that come in as not OK are skipped.
    """
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        out[:, i] = math.nan
        if status[i] != _OK:
            continue
        h, p, s3 = starts[0, i], starts[1, i], starts[2, i]
        near, far = starts[3, i] / b.I1, starts[4, i] / b.I1
        code, here, there, level = orbit(h, p, s3 / b.r0, near, far, target, rules, sizes, b, series, W)
        status[i] = code
        out[0, i], out[1, i] = 2.0 * math.asin(0.5 * here.h_turn), 2.0 * math.asin(0.5 * there.h_turn)
        out[2, i], out[3, i] = here.chi + there.chi, here.psi - there.psi
        out[4, i], out[5, i] = here.time + there.time, level + potential_at_flat(s3 / b.r0, b)
        out[6, i] = here.angle_error + there.angle_error
        out[7, i] = max(here.time_error, there.time_error)


# V is measured from V_0; where V_0 exceeds the energy by more (I3 near 0), its rounding is felt.
_ROUNDING = 20.0 * 2.2e-16


@kernel
def tilt_batch(starts: Matrix, target: float, b: Body, series: Matrix, out: Vector, status: Codes) -> None:
    """Smallest tilt of every motion, from both of its turning points; starts as for orbit_batch.

    A sample whose energy is not known to `target` times what it has above V_0 is STEP_LIMIT.
    """
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        out[i] = math.nan
        if status[i] != _OK:
            continue
        h, p, X = starts[0, i], starts[1, i], starts[2, i] / b.r0
        near, far = starts[3, i] / b.I1, starts[4, i] / b.I1
        level = 0.5 * b.M * p * p + point(h, X, near, b, series).V
        least = turning_point(h, p == 0.0, level, X, near, b, series, W)
        if not turning_point_outward(h, level, X, near, b, series) > 0.0:
            least = min(least, turning_point(VERTICAL, False, level, X, far, b, series, W))
        out[i] = 2.0 * math.asin(0.5 * least)
        scale = potential_at_flat(X, b)
        if not (least > 0.0 and _ROUNDING * scale <= target * abs(level + scale)):
            status[i] = _LIMIT

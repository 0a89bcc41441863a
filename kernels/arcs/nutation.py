"""Small oscillations about steady motion: K from V'' alone, so that no width of the well is too little.

Between turning points at x and x + L, K = (L/2)^2 (1 - u^2) share(u) with u from -1 to 1. At no point
does V'' cancel. With V'' = sum v_m P'_(m+1)(u) of Legendre's polynomials, whose ((1 - u^2) P_n')'' =
-n (n + 1) P_n',

    share(u) = sum v_m P'_(m+1)(u) / ((m + 1)(m + 2))

At Chebyshev's points that is one matrix, and Gauss-Chebyshev gives the period, and the way to any state, from the
same points. Where the spin is fast the search finds the turning points of so narrow a well only roughly, as what
cancels in its K grows with the square of the spin. In V' of the state it does not cancel: by K and V' there, and
V'' around it, the turning points are set right.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from kernels._jit import kernel, subroutine
from kernels.arcs.potential import (
    END_ROWS,
    LANES,
    ArcDisk,
    FaceMotion,
    make_ends,
    point_at,
    put_end,
    slope_and_bend,
)
from kernels.arcs.rules import ArcRow
from kernels.arcs.turning_points import Starts
from kernels.disk.body import Body
from kernels.disk.elementary import EPSILON
from kernels.records import put
from kernels.types import Matrix, Vector

POINTS = 16
WIDEST = 0.5  # in x: so narrow a well needs no more points for all digits
_FELT = 16.0 * EPSILON  # of the length: turning points that are off by less stay
_FAR = END_ROWS  # rows of the end at the vertical, of the other face
# INNER, OUTER: how much farther from each other the turning points are than they were found; SLACK: what rounding
# leaves unknown of distances from them, as a share.
_X, _Y, _Y_FAR, _L, _UPRIGHT, _INNER, _OUTER, _SLACK = range(2 * END_ROWS, 2 * END_ROWS + 8 * LANES, LANES)
_AT_POINTS = 2 * END_ROWS + 8 * LANES  # q, ratio, z ratio - q sigma4 and V'', POINTS each; then room for sums
_BEND, _SUMS = 3, 4
_ROWS = _AT_POINTS + 5 * POINTS * LANES


class Points(NamedTuple):
    """share (POINTS): distance from the inner end, of a well of unit length, at angles alpha with u = -cos(alpha).

    twice (POINTS, POINTS): columns from V'' to the share of K. cosines (POINTS, POINTS): columns from values to
    coefficients of cos(m alpha).
    """

    share: Vector
    twice: Matrix
    cosines: Matrix


class Wells(NamedTuple):
    """Wells (n) above their inner turning points: distances of the state and of the vertical from both ends.

    The vertical is at inf, and that far from the outer end, where a well does not reach it. Of the other face: Y
    and sigma4 at the vertical, as that face has them.
    """

    inner: Starts
    state: Starts
    to_state: Vector
    from_state: Vector
    to_vertical: Vector
    from_vertical: Vector
    Y_far: Vector
    sigma3_vertical: Vector
    sigma4_far: Vector


def make_points() -> Points:
    """Chebyshev's points, and V'' there integrated twice."""
    angle = (np.arange(POINTS) + 0.5) * np.pi / POINTS
    u, order = -np.cos(angle), np.arange(POINTS)
    slopes = np.stack([legendre.legval(u, legendre.legder(np.eye(POINTS + 1)[m + 1])) for m in order], axis=1)
    twice = slopes @ np.diag(1.0 / ((order + 1.0) * (order + 2.0))) @ np.linalg.inv(slopes)
    cosines = np.where(order == 0, 1.0, 2.0)[:, None] / POINTS * np.cos(np.outer(order, angle))
    return Points(np.sin(0.5 * angle) ** 2, np.ascontiguousarray(twice.T), np.ascontiguousarray(cosines.T))


@subroutine
def load(A: Vector, wells: Wells, first: int, disk: ArcDisk) -> None:
    """Wells into lanes; the last one fills those that are left over."""
    inner = wells.inner
    for i in range(LANES):
        j = min(first + i, wells.to_state.size - 1)
        A[_X + i], A[_Y + i], A[_Y_FAR + i] = inner.X[j], inner.Y[j], wells.Y_far[j]
        A[_L + i] = wells.to_state[j] + wells.from_state[j]
        A[_UPRIGHT + i], A[_INNER + i], A[_OUTER + i] = wells.to_vertical[j], 0.0, 0.0
        put_end(A, 0, i, inner.r[j], inner.w[j], inner.sigma3[j], inner.sigma4[j])
        put_end(A, _FAR, i, 1.0, 0.0, wells.sigma3_vertical[j], wells.sigma4_far[j])
    make_ends(A, 0, disk)
    make_ends(A, _FAR, disk)


@subroutine
def look(A: Vector, j: int, share: float, b: Body) -> None:
    """What integrands and V'' need of point j, in all lanes."""
    for i in range(LANES):
        s, upright = (A[_L + i] + A[_OUTER + i]) * share - A[_INNER + i] * (1.0 - share), A[_UPRIGHT + i]
        P = point_at(A, 0, i, min(s, upright), False, FaceMotion(A[_X + i], A[_Y + i]), b)
        beyond = max(s - upright, 0.0)
        F = point_at(A, _FAR, i, beyond, True, FaceMotion(A[_X + i], A[_Y_FAR + i]), b)
        here = s <= upright
        q, z, ratio = P.q if here else F.q, P.z if here else -F.z, P.ratio if here else F.ratio
        sigma4 = P.sigma4 if here else -F.sigma4
        _slope, bend = slope_and_bend(q, z, ratio, sigma4, b)
        at = _AT_POINTS + j * LANES + i
        A[at], A[at + POINTS * LANES] = q, ratio
        A[at + 2 * POINTS * LANES], A[at + _BEND * POINTS * LANES] = z * ratio - q * sigma4, bend


@subroutine
def multiply(A: Vector, i: int, row: int, matrix: Matrix) -> None:
    """Values of lane i at the points, times a matrix."""
    values, sums = A[_AT_POINTS + row * POINTS * LANES :], A[_AT_POINTS + _SUMS * POINTS * LANES :]
    for k in range(POINTS):
        sums[k] = 0.0
    for j in range(POINTS):
        for k in range(POINTS):
            sums[k] += matrix[j, k] * values[j * LANES + i]
    for j in range(POINTS):
        values[j * LANES + i] = sums[j]


@subroutine
def part_of(coefficients: Vector, upto: float) -> float:
    """One integral from the inner end up to an angle."""
    before, now, twice = 0.0, math.sin(upto), 2.0 * math.cos(upto)
    total = coefficients[0] * upto
    for m in range(1, POINTS):
        total += coefficients[m * LANES] * now / m
        before, now = now, twice * now - before
    return total


@subroutine
def erred(coefficients: Vector, off: float) -> float:
    """The error of an integral whose end is off by an angle, and of what its coefficients leave out."""
    most = 0.0
    for m in range(POINTS):
        most += abs(coefficients[m * LANES])
    return most * off + abs(coefficients[(POINTS - 2) * LANES]) + abs(coefficients[(POINTS - 1) * LANES])


@subroutine
def partly(A: Vector, i: int, to: float, rest: float, slack: float) -> ArcRow[float]:
    """Integrals from the inner end over `to` of the length; slack: what rounding leaves unknown of it, as a share.

    A motion that is steady to rounding is at either end at any time.
    """
    upto = 2.0 * math.atan2(math.sqrt(to), math.sqrt(rest))
    near, far = min(to, rest), max(to, rest)
    off = (slack * math.sqrt(near / far) if near > 0.0 and slack < 1.0 else 0.0) + 16.0 * EPSILON
    at = _AT_POINTS + i
    time, chi, psi = A[at:], A[at + POINTS * LANES :], A[at + 2 * POINTS * LANES :]
    angle_error = erred(chi, off) + erred(psi, off)
    return ArcRow(part_of(time, upto), part_of(chi, upto), part_of(psi, upto), erred(time, off), angle_error)


@subroutine
def set_right(A: Vector, i: int, wells: Wells, j: int, points: Points, b: Body) -> bool:
    """The turning points of lane i by K and V' at the state of well j; whether they are elsewhere than was found.

    Needs the share of K at the points. K by it is right but for a part that is linear in the distance.
    """
    shares, to, rest = A[_AT_POINTS + _BEND * POINTS * LANES + i :], wells.to_state[j], wells.from_state[j]
    length = to + rest
    # The interpolating polynomial at the state and at both ends, and its slope in u = -cos(alpha) at the state, by
    # the recurrences of cos(m alpha) and of sin(m alpha)/sin(alpha).
    here, slope, inner, outer, turned = 0.0, 0.0, 0.0, 0.0, (rest - to) / length
    cosine, next_cosine, sine, next_sine, sign = 1.0, turned, 0.0, 1.0, 1.0
    for m in range(POINTS):
        of_order = 0.0
        for n in range(POINTS):
            of_order += points.cosines[n, m] * shares[n * LANES]
        here += of_order * cosine
        slope -= of_order * m * sine
        inner += of_order
        outer += of_order * sign
        cosine, next_cosine = next_cosine, 2.0 * turned * next_cosine - cosine
        sine, next_sine, sign = next_sine, 2.0 * turned * next_sine - sine, -sign
    state = wells.state
    inv = 1.0 / (1.0 + state.r[j] * state.r[j])
    q = 2.0 * state.r[j] * inv
    ratio, spin = state.sigma3[j] / q, state.sigma4[j]
    fall, _bend = slope_and_bend(q, state.w[j] * inv, ratio, spin, b)
    missing = state.K[j] - to * rest * here
    tilted = -fall - (rest - to) * here - to * rest * slope * 2.0 / length
    # Each term of V' has some four roundings; an error of V' moves both turning points in the same direction.
    terms = b.J * abs(ratio * q * spin) + b.I1 * ratio * ratio + q
    A[_SLACK + i] = 4.0 * EPSILON * terms / (length * here) if length > 0.0 else 0.0
    farther_in, farther_out = (
        (missing - tilted * to) / (length * inner),
        (missing + tilted * rest) / (length * outer),
    )
    felt = abs(farther_in) + abs(farther_out) > _FELT * length
    A[_INNER + i], A[_OUTER + i] = farther_in if felt else 0.0, farther_out if felt else 0.0
    return felt


@subroutine
def weigh(A: Vector, i: int, points: Points, b: Body) -> None:
    """Coefficients of the integrals in lane i, from values and the share of K at the points."""
    values = A[_AT_POINTS + i :]
    for m in range(POINTS):
        scale = math.sqrt(0.5 * b.M / values[(_BEND * POINTS + m) * LANES])
        for row in range(3):
            values[(row * POINTS + m) * LANES] *= scale
    for row in range(3):
        multiply(A, i, row, points.cosines)


@kernel
def well_batch(wells: Wells, points: Points, disk: ArcDisk, out: Matrix) -> None:
    """Every well -> three times (5, n) as ArcRow: all of it, its way to the state, that to the vertical."""
    A, n = np.zeros(_ROWS), wells.to_state.size
    whole, state, vertical = out[:5], out[5:10], out[10:]
    for first in range(0, n, LANES):
        load(A, wells, first, disk)
        last, looked, moved = min(LANES, n - first), 0, 1
        while looked < 2 and moved > 0:
            for j in range(POINTS):
                look(A, j, points.share[j], disk.body)
            looked, moved = looked + 1, 0
            for i in range(last):
                multiply(A, i, _BEND, points.twice)
                if looked == 1 and set_right(A, i, wells, first + i, points, disk.body):
                    moved += 1
        for i in range(min(LANES, n - first)):
            j, inner, outer = first + i, A[_INNER + i], A[_OUTER + i]
            weigh(A, i, points, disk.body)
            put(partly(A, i, 1.0, 0.0, 0.0), whole, j)
            to, rest = max(wells.to_state[j] + inner, 0.0), max(wells.from_state[j] + outer, 0.0)
            put(partly(A, i, to, rest, A[_SLACK + i]), state, j)
            to, rest = max(wells.to_vertical[j] + inner, 0.0), max(wells.from_vertical[j] + outer, 0.0)
            put(partly(A, i, to, rest, A[_SLACK + i]), vertical, j)

"""Integrals over arcs by one family of rules: Clenshaw and Curtis's, with more nodes until the estimate allows.

In a variable in which the roots at turning points are gone, integrands are analytic, and the error is squared
where the nodes are doubled:

    from a turning point on: d = L s^2, even in s       an arc that goes on at both ends: d = L (1 - cos g)/2
    between turning points: the same, periodic in g      a fall to flat: in tan(theta/2), where flat is nothing
    special

Nodes are given as distances from the nearer end with all their digits, which is what differences from ends need.
Where the motion is slow at an end, since K vanishes at a distance delta beyond it, d = delta sinh y first and the
rule in y, on a short arc whose nodes all are given from that end. (The double-exponential rule of Takahasi and
Mori serves all of this as well, with two to five times as many nodes.)
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import device, kernel, subroutine
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
from kernels.arcs.turning_points import next_zero
from kernels.disk.body import Body
from kernels.disk.elementary import EPSILON, exponential, logarithm
from kernels.records import Entry, put
from kernels.types import Longs, Matrix, Vector

# Nodes of the rules, less one; half and a quarter of them are rules as well.
_NODES = *(number << doubled for doubled in range(7) for number in (8, 12)), 1024
SIZES = len(_NODES)
# Kinds of arcs: from a turning point outwards, or inwards; one that goes on at both ends; between turning points;
# a fall from somewhere, and from rest; slow at the inner end, at the outer one, and the same if these turn.
TURN_INSIDE, TURN_OUTSIDE, NO_TURN, TWO_TURNS, FALL, FALL_FROM_REST = range(6)
SLOW_INSIDE, SLOW_OUTSIDE, SLOW_TURN_INSIDE, SLOW_TURN_OUTSIDE = range(6, 10)
KINDS = 10
NOTHING = -1  # an arc of no length
# Even in s: half of a rule with twice as many intervals over pi in g serves.
_HALVED = TURN_INSIDE, TURN_OUTSIDE, FALL_FROM_REST, SLOW_TURN_INSIDE, SLOW_TURN_OUTSIDE
# All nodes from the inner end, or from the outer one.
_FROM_INSIDE, _FROM_OUTSIDE = (SLOW_INSIDE, SLOW_TURN_INSIDE), (SLOW_OUTSIDE, SLOW_TURN_OUTSIDE)
_LEAST_SINE = 1e-15  # in the place of s = 0: in its square no node is an end, and all ratios are those at the end
_END_OF_FALL = 300.0  # of falls, in x: what is left is below any rounding
# The error of a sum is at most so many times D sqrt(D'): D is its difference from that of half the nodes, over its
# size, and D' the largest of time, chi and psi. Doubling the nodes squares the error, save where these rules, at
# first as fast as Gauss's, begin to converge half as fast: across this kink it gains the power 3/2 (Weideman and
# Trefethen 2007). Angles converge as the time does, also where they are so small that their own D is. Lest two
# rules agree by chance, D is at least the square of the difference before. (Of 230,000 arcs of twelve bodies, at
# accuracies of 1e-3 to 1e-9, 5 in 100,000 err by over three times that.)
_SAFETY, _POWER = 6.0, 1.5
# With which rule to begin, which no answer depends on. An ellipse with both ends of the arc as its foci goes
# through the nearest singularity; with half the arc as the unit, each node divides D by the sum of its half axes
# (Bernstein). So many digits more are for how strong the singularity is.
_HEADROOM = 1.5
_LAST_FIRST = SIZES - 4  # with no finer rule than this one
_LN10 = math.log(10.0)
_ROUNDING = 8.0 * EPSILON  # of K, for each unit of what it was summed from; the root takes half of it
# The bound of where a turning point is allows four units of rounding for a sum that is off by about one.
_OF_BOUND = 0.25
# Rows of the work array: the inner end, the outer one, and then these.
_OUTER = END_ROWS
(
    # the motion, and of both ends K and the size of what it was found from; SLOW, LENGTH: of arcs with a slow end;
    # MOVED: as `moved_by`
    _X, _Y, _L, _K_IN, _K_OUT, _SIZE_IN, _SIZE_OUT, _SLOW, _LENGTH, _MOVED,
    # sums by the rule, of their rounding, and by the rules of a half and a quarter of the nodes
    _TIME, _CHI, _PSI, _ROUNDED, _TIME_ROUNDED,
    _OLD_TIME, _OLD_CHI, _OLD_PSI, _OLDER_TIME, _OLDER_CHI, _OLDER_PSI,
) = range(2 * END_ROWS, 2 * END_ROWS + 21 * LANES, LANES)  # fmt: skip
_ROWS = 2 * END_ROWS + 21 * LANES


class Rule(NamedTuple):
    """Nodes of all kinds of arcs and all sizes, those at the inner end and those at the outer one.

    share, rate: distances from the nearer end, of arcs of unit length, and how they grow; weight; coarse, coarser:
    of the rules of a half and a quarter of the nodes. first (2, KINDS * SIZES * 2): where the nodes of each begin,
    and how many there are.
    """

    share: Vector
    rate: Vector
    weight: Vector
    coarse: Vector
    coarser: Vector
    first: Matrix


class Node(NamedTuple):
    """A node of a rule, as in `Rule`."""

    share: float
    rate: float
    weight: float
    coarse: float
    coarser: float


class Arcs(NamedTuple):
    """Arcs (n): constants of the motion, length in x; both ends as in `turning_points.Starts`, with K there.

    slow_in, slow_out: the distance beyond an end of the next zero of K, inf where none is near. error_in,
    error_out: from rounding, of K, or of x at a turning point.
    """

    X: Vector
    Y: Vector
    L: Vector
    r_in: Vector
    w_in: Vector
    sigma3_in: Vector
    sigma4_in: Vector
    K_in: Vector
    slow_in: Vector
    error_in: Vector
    r_out: Vector
    w_out: Vector
    sigma3_out: Vector
    sigma4_out: Vector
    K_out: Vector
    slow_out: Vector
    error_out: Vector


class ArcEnd(NamedTuple):
    """An end of an arc: K there, and the state as in `turning_points.Starts`."""

    K: float
    r: float
    w: float
    sigma3: float
    sigma4: float


class ArcRow(NamedTuple, Generic[Entry]):
    """Integrals over an arc, and the errors of the time and of both angles."""

    time: Entry
    chi: Entry
    psi: Entry
    time_error: Entry
    angle_error: Entry


def clenshaw_curtis(n: int) -> Vector:
    """Weights of cos(j pi / n), j = 0 ... n, for integrals over -1 ... 1."""
    moments = 1.0 / (1.0 - 4.0 * np.arange(n // 2 + 1) ** 2)
    weights: Vector = 2.0 * np.append(np.fft.irfft(moments, n), 0.0)
    weights[[0, n]] = 0.5 * weights[0]
    return weights


def weights_of(kind: int, n: int) -> Vector:
    """Weights of the angles j pi / n of a rule with n intervals."""
    if kind == TWO_TURNS:
        return np.where(np.isin(np.arange(n + 1), (0, n)), 0.5, 1.0) * np.pi / n
    weights = clenshaw_curtis(n)
    if kind not in _HALVED:
        return weights
    return np.append(weights[: n // 2], 0.5 * weights[n // 2])


def places(kind: int, g: Vector) -> tuple[Vector, Vector, Vector]:
    """(distance from the inner end, from the outer one, rate) of the nodes at angles g, of arcs of unit length."""
    s, c = (np.clip(abs(f(g)), _LEAST_SINE, 1.0) for f in (np.cos, np.sin))
    near, far = (np.clip(abs(f(0.5 * g)), _LEAST_SINE, 1.0) ** 2 for f in (np.sin, np.cos))
    if kind in (TURN_INSIDE, SLOW_TURN_INSIDE):
        return s * s, c * c, 2.0 * s
    if kind in (TURN_OUTSIDE, SLOW_TURN_OUTSIDE):
        return c * c, s * s, 2.0 * s
    if kind in (NO_TURN, SLOW_INSIDE, SLOW_OUTSIDE):
        return near, far, np.full(g.size, 0.5)
    if kind == TWO_TURNS:
        return near, far, np.sqrt(near * far)
    # Falls: r = tan(theta/2) over that at the start, 1 - s^2 = c^2 from rest.
    below, left, rate = (s * s, c * c, 2.0 * s) if kind == FALL_FROM_REST else (far, near, np.full(g.size, 0.5))
    left = np.maximum(left, math.exp(-_END_OF_FALL))
    with np.errstate(divide="ignore"):  # of the branch that is not taken
        return np.full(g.size, math.inf), np.where(below < 0.5, -np.log1p(-below), -np.log(left)), rate / left


def make_rule() -> Rule:
    """The nodes and weights of all kinds."""
    columns: list[Matrix] = []
    first, start = np.zeros((2, KINDS * SIZES * 2)), 0
    for kind in range(KINDS):
        for size in range(SIZES):
            n = 2 * _NODES[size] if kind in _HALVED else _NODES[size]
            weight = weights_of(kind, n)
            coarse, coarser = np.zeros((2, weight.size))
            coarse[::2], coarser[::4] = weights_of(kind, n // 2), weights_of(kind, n // 4)
            g = np.arange(weight.size) * np.pi / n
            inner, outer, rate = places(kind, g)
            nearer = (
                np.full(g.size, kind in _FROM_INSIDE) if kind in _FROM_INSIDE + _FROM_OUTSIDE else inner <= 0.5
            )
            for end, (share, mine) in enumerate(((inner, nearer), (outer, ~nearer))):
                columns.append(np.stack([share, rate, weight, coarse, coarser])[:, mine])
                first[:, (kind * SIZES + size) * 2 + end] = start, columns[-1].shape[1]
                start += columns[-1].shape[1]
    share, rate, weight, coarse, coarser = map(np.ascontiguousarray, np.concatenate(columns, axis=1))
    return Rule(share, rate, weight, coarse, coarser, first)


@device
def moved_by(K: float, slow: float, error: float, length: float) -> float:
    """The share by which time and angles are off since a turning point is, close beside a crest.

    With the crest at the distance delta beyond it both grow by asinh(L/delta) of what a motion does in one unit of
    that, whose part of an error e of the turning point is e/delta.
    """
    felt = (K == 0.0) & (slow < math.inf)
    return _OF_BOUND * error / (slow * math.asinh(length / slow)) if felt else 0.0


@subroutine
def load(A: Vector, arcs: Arcs, rows: Longs, first: int, n: int, disk: ArcDisk) -> None:
    """Arcs into lanes; the last one fills those that are left over."""
    for i in range(LANES):
        j = rows[min(first + i, n - 1)]
        A[_X + i], A[_Y + i], A[_L + i] = arcs.X[j], arcs.Y[j], arcs.L[j]
        A[_K_IN + i], A[_K_OUT + i] = arcs.K_in[j], arcs.K_out[j]
        # What K is a sum of, and was found from; at a turning point it is 0, and that may be elsewhere.
        A[_SIZE_IN + i] = arcs.K_in[j] + arcs.error_in[j] / _ROUNDING if arcs.K_in[j] > 0.0 else 0.0
        A[_SIZE_OUT + i] = arcs.K_out[j] + arcs.error_out[j] / _ROUNDING if arcs.K_out[j] > 0.0 else 0.0
        A[_MOVED + i] = moved_by(arcs.K_in[j], arcs.slow_in[j], arcs.error_in[j], arcs.L[j])
        A[_MOVED + i] += moved_by(arcs.K_out[j], arcs.slow_out[j], arcs.error_out[j], arcs.L[j])
        slow = min(arcs.slow_in[j], arcs.slow_out[j])
        A[_SLOW + i], A[_LENGTH + i] = slow, math.asinh(arcs.L[j] / slow) if slow < math.inf else 0.0
        put_end(A, 0, i, arcs.r_in[j], arcs.w_in[j], arcs.sigma3_in[j], arcs.sigma4_in[j])
        put_end(A, _OUTER, i, arcs.r_out[j], arcs.w_out[j], arcs.sigma3_out[j], arcs.sigma4_out[j])
    make_ends(A, 0, disk)
    make_ends(A, _OUTER, disk)


@device
def sinh_cosh(y: float) -> tuple[float, float]:
    """(sinh y, cosh y) for y >= 0, each to rounding."""
    e, grown = exponential(y)
    return 0.5 * (grown + grown / e), 0.5 * (e + 1.0 / e)


@device
def placed(A: Vector, i: int, share: float, rate: float, slow: bool) -> tuple[float, float]:
    """Distance of a node from its end, and its rate; slow: a constant."""
    if not slow:
        return A[_L + i] * share, A[_L + i] * rate
    sinh_y, cosh_y = sinh_cosh(A[_LENGTH + i] * share)
    return A[_SLOW + i] * sinh_y, A[_SLOW + i] * A[_LENGTH + i] * rate * cosh_y


@device
def add_node(A: Vector, i: int, node: Node, inside: bool, slow: bool, b: Body) -> None:
    """Add a node to the sums of lane i; inside, slow: constants."""
    d, rate = placed(A, i, node.share, node.rate, slow)
    P = point_at(A, 0 if inside else _OUTER, i, d, not inside, FaceMotion(A[_X + i], A[_Y + i]), b)
    K = (A[_K_IN + i] if inside else A[_K_OUT + i]) - P.rise
    inv_K = 1.0 / K
    ds = rate * math.sqrt(0.5 * b.M * inv_K)
    turn = P.z * P.ratio - P.q * P.sigma4
    time, chi, psi = ds * P.q, ds * P.ratio, ds * turn
    weight, coarse, coarser = node.weight, node.coarse, node.coarser
    size = P.size + (A[_SIZE_IN + i] if inside else A[_SIZE_OUT + i])
    rounding = weight * ds * size * inv_K
    A[_TIME + i] += weight * time
    A[_CHI + i] += weight * chi
    A[_PSI + i] += weight * psi
    A[_ROUNDED + i] += rounding * (abs(P.ratio) + abs(turn))
    A[_TIME_ROUNDED + i] += rounding * P.q
    A[_OLD_TIME + i] += coarse * time
    A[_OLD_CHI + i] += coarse * chi
    A[_OLD_PSI + i] += coarse * psi
    A[_OLDER_TIME + i] += coarser * time
    A[_OLDER_CHI + i] += coarser * chi
    A[_OLDER_PSI + i] += coarser * psi


@subroutine
def integrate(A: Vector, kind: int, size: int, rule: Rule, b: Body) -> None:
    """The sums of the arcs in the lanes."""
    slow = kind >= SLOW_INSIDE
    A[_TIME : _OLDER_PSI + LANES] = 0.0
    for end in range(2):
        row = (kind * SIZES + size) * 2 + end
        first = int(rule.first[0, row])
        for j in range(first, first + int(rule.first[1, row])):
            node = Node(rule.share[j], rule.rate[j], rule.weight[j], rule.coarse[j], rule.coarser[j])
            if slow and end == 0:
                for i in range(LANES):
                    add_node(A, i, node, True, True, b)
            elif slow:
                for i in range(LANES):
                    add_node(A, i, node, False, True, b)
            elif end == 0:
                for i in range(LANES):
                    add_node(A, i, node, True, False, b)
            else:
                for i in range(LANES):
                    add_node(A, i, node, False, False, b)


@device
def difference(new: float, old: float, older: float, size: float) -> float:
    """Of a sum from that of half the nodes, over its size; at least what theirs from a quarter's lets expect."""
    before = (old - older) / size
    return max(abs(new - old) / size, before * before)


@subroutine
def found_in(A: Vector, i: int) -> tuple[ArcRow[float], float]:
    """The arc in lane i, and the part of its error that more nodes would lessen: rad, or relative of the time."""
    time, chi, psi = A[_TIME + i], A[_CHI + i], A[_PSI + i]
    turn = 1.0 + abs(chi) + abs(psi)
    of_chi = difference(chi, A[_OLD_CHI + i], A[_OLDER_CHI + i], turn)
    of_psi = difference(psi, A[_OLD_PSI + i], A[_OLDER_PSI + i], turn)
    of_time = difference(time, A[_OLD_TIME + i], A[_OLDER_TIME + i], time)
    largest = max(of_time, max(of_chi, of_psi))
    left = _SAFETY * math.sqrt(largest)
    # Of the time alone two rules may agree by chance; the angles ask for as many nodes anyhow.
    angle, off = left * turn * (of_chi + of_psi), left * largest
    time_error = time * (off + A[_MOVED + i]) + _ROUNDING * A[_TIME_ROUNDED + i]
    angle_error = angle + (abs(chi) + abs(psi)) * A[_MOVED + i] + _ROUNDING * A[_ROUNDED + i]
    return ArcRow(time, chi, psi, time_error, angle_error), max(angle, off)


@device
def half_axis(beyond: float, aside: float, length: float) -> float:
    """The larger half axis of the ellipse about an arc through a point beyond one of its ends, and aside."""
    far = length + beyond
    return (math.sqrt(beyond * beyond + aside * aside) + math.sqrt(far * far + aside * aside)) / length


@device
def zero_axis(end: ArcEnd, inward: bool, length: float, b: Body) -> float:
    """The same for the next zero of K beyond an end."""
    inv = 1.0 / (1.0 + end.r * end.r)
    q = 2.0 * end.r * inv
    slope, bend = slope_and_bend(q, end.w * inv, end.sigma3 / q, end.sigma4, b)
    beyond, aside = next_zero(end.K, -slope if inward else slope, bend)
    return half_axis(beyond, aside, length)


@subroutine
def first_size(kind: int, arcs: Arcs, j: int, digits: float, b: Body) -> int:
    """The rule to begin with: half of its nodes bring the digits of the difference that the estimate needs."""
    r, length = arcs.r_out[j], arcs.L[j]
    inner = ArcEnd(arcs.K_in[j], arcs.r_in[j], arcs.w_in[j], arcs.sigma3_in[j], arcs.sigma4_in[j])
    outer = ArcEnd(arcs.K_out[j], r, arcs.w_out[j], arcs.sigma3_out[j], arcs.sigma4_out[j])
    # The poles of q are at i pi/2 beside the vertical; in tan(theta/2), of falls, at i.
    if kind >= SLOW_INSIDE:
        axis = half_axis(0.0, 0.5 * math.pi, math.asinh(length / min(arcs.slow_in[j], arcs.slow_out[j])))
    elif kind >= FALL:
        axis = min(half_axis(0.0, 1.0 / r, 1.0), zero_axis(outer, False, 1.0, b))
    else:
        poles = half_axis(-logarithm(r), 0.5 * math.pi, length)
        axis = min(poles, min(zero_axis(inner, True, length, b), zero_axis(outer, False, length, b)))
    nodes = (digits + _HEADROOM) * _LN10 / logarithm(axis + math.sqrt(axis * axis - 1.0))
    size = 0
    while _NODES[size] < nodes and size < _LAST_FIRST:
        size += 1
    return size


@subroutine
def pick(kind: int, kinds: Longs, arcs: Arcs, digits: float, rows: Longs, sizes: Longs, b: Body) -> int:
    """The arcs of a kind -> rows, and the rules that they begin with -> sizes; how many there are."""
    n = 0
    for j in range(kinds.size):
        if kinds[j] == kind:
            rows[n], sizes[n] = j, first_size(kind, arcs, j, digits, b)
            n += 1
    return n


@kernel
def arc_batch(kinds: Longs, arcs: Arcs, accuracy: float, rule: Rule, disk: ArcDisk, out: Matrix) -> None:
    """Every arc of its kind (n) -> out (5, n), rows as ArcRow.

    accuracy: of the angles (rad) and, relative, of the time: more nodes are taken until the estimate allows, or
    what the last rule gives stays, with its error.
    """
    n = kinds.size
    A, rows, sizes, now = np.zeros(_ROWS), np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64)
    digits = math.log10(_SAFETY / accuracy) / _POWER
    for kind in range(KINDS):
        left = pick(kind, kinds, arcs, digits, rows, sizes, disk.body)
        for size in range(SIZES):
            # Those that begin later stay in `rows`; those that do now, or go on, move to `now`.
            m, later = 0, 0
            for k in range(left):
                if sizes[k] <= size:
                    now[m] = rows[k]
                    m += 1
                else:
                    rows[later], sizes[later] = rows[k], sizes[k]
                    later += 1
            left = later
            for first in range(0, m, LANES):
                load(A, arcs, now, first, m, disk)
                integrate(A, kind, size, rule, disk.body)
                for i in range(min(LANES, m - first)):
                    j = now[first + i]
                    row, missing = found_in(A, i)
                    put(row, out, j)
                    if missing > accuracy:
                        rows[left], sizes[left] = j, size
                        left += 1

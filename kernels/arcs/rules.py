"""Integrals over arcs by one family of rules: Clenshaw and Curtis's, doubled until the estimate allows.

In a variable in which the roots at turning points are gone, integrands are analytic, and the error is squared where
the nodes are doubled:

    from a turning point on: d = L s^2, even in s       an arc that goes on at both ends: d = L (1 - cos g)/2
    between turning points: the same, periodic in g      a fall to flat: in tan(theta/2), where flat is nothing
    special

Nodes are given as distances from the nearer end with all their digits, which is what differences from ends need.
Where the motion is slow at an end, since K vanishes at a distance delta beyond it, d = delta sinh y first and the
rule in y. (The double-exponential rule of Takahasi and Mori serves all of this as well, with two to five times as
many nodes.)
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel
from kernels.arcs.exponentials import exponential, logarithm
from kernels.arcs.potential import (
    END_ROWS,
    LANES,
    SIGMA3,
    SIGMA4,
    Chart,
    Motion,
    R,
    W,
    end_of,
    make_ends,
    point_at,
)
from kernels.disk.body import Body
from kernels.disk.rows import Entry, put
from kernels.types import Longs, Matrix, Vector

DOUBLINGS = 7
# Kinds of arcs: from a turning point outwards, or inwards; one that goes on at both ends; between turning points;
# a fall from somewhere, and from rest.
TURN_INSIDE, TURN_OUTSIDE, NO_TURN, TWO_TURNS, FALL, FALL_FROM_REST = range(6)
KINDS = 6
NOTHING = -1  # an arc of no length
_FIRST = 16, 16, 8, 8, 8, 16  # intervals of the first rule, over pi in g
_HALVED = TURN_INSIDE, TURN_OUTSIDE, FALL_FROM_REST  # even in s: half of the rule serves
_AT_END = 1e-15  # in the place of s = 0: in its square no node is an end, and all ratios are those at the end
_DEEPEST = 300.0  # of falls, in x: what is left is below any rounding
# The error is at most so many times the difference of two rules to the power of 1.5: doubling would square it.
_SAFETY = 10.0
# With which rule to begin, which no answer depends on: a node brings some 0.6 digits, fewer on a long arc.
_DIGITS, _LONG = 0.6, 20.0
_EPSILON = 2.2e-16
_ROUNDING = 4.0 * _EPSILON  # of K, for each unit of what it was summed from; the root takes half of it
# Rows of the work array: the inner end, the outer one, and then these.
_OUTER = END_ROWS
(
    _X,
    _Y,
    _L,
    _K_IN,
    _K_OUT,
    _SLOW_IN,
    _SLOW_OUT,
    _LENGTH,
    _TIME,
    _CHI,
    _PSI,
    _NOISE,
    _OLD_TIME,
    _OLD_CHI,
    _OLD_PSI,
) = range(2 * END_ROWS * LANES, (2 * END_ROWS + 15) * LANES, LANES)
_ROWS = (2 * END_ROWS + 15) * LANES


class Rule(NamedTuple):
    """Nodes of all kinds of arcs and all doublings, those at the inner end and those at the outer one.

    share, rate: distances from the nearer end, of arcs of unit length, and how they grow; weight; coarse: of the
    rule of half as many nodes. first (2, KINDS * DOUBLINGS * 2): where the nodes of each begin, and how many there
    are.
    """

    share: Vector
    rate: Vector
    weight: Vector
    coarse: Vector
    first: Matrix


class Arcs(NamedTuple):
    """Arcs (n): constants of the motion, length in x; both ends as in `turning_points.Starts`, with K there.

    slow_in, slow_out: the distance beyond an end of the next zero of K, inf where none is near.
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
    r_out: Vector
    w_out: Vector
    sigma3_out: Vector
    sigma4_out: Vector
    K_out: Vector
    slow_out: Vector


class ArcRow(NamedTuple, Generic[Entry]):
    """Integrals over an arc, and the errors of the time and of both angles."""

    time: Entry
    chi: Entry
    psi: Entry
    time_error: Entry
    angle_error: Entry


def clenshaw_curtis(n: int) -> Vector:
    """Weights of cos(j pi / n), j = 0 ... n, for integrals over -1 ... 1."""
    j, k = np.arange(n + 1), np.arange(n // 2 + 1)
    moments = np.where((k == 0) | (2 * k == n), 1.0, 2.0) / (1.0 - 4.0 * k * k)
    ends = np.where((j == 0) | (j == n), 0.5, 1.0)
    weights: Vector = 2.0 * ends * (np.cos(2.0 * np.pi / n * np.outer(j, k)) @ moments) / n
    return weights


def weights_of(kind: int, n: int) -> Vector:
    """Weights of the angles j pi / n of a rule with n intervals."""
    if kind == TWO_TURNS:
        return np.where(np.isin(np.arange(n + 1), (0, n)), 0.5, 1.0) * np.pi / n
    weights = clenshaw_curtis(n)
    if kind not in _HALVED:
        return weights
    half = weights[: n // 2 + 1]
    return np.append(half[:-1], 0.5 * half[-1]) if n % 2 == 0 else half


def places(kind: int, g: Vector) -> tuple[Vector, Vector, Vector]:
    """(distance from the inner end, from the outer one, rate) of the nodes at angles g, of arcs of unit length."""
    s, c = (np.clip(abs(f(g)), _AT_END, 1.0) for f in (np.cos, np.sin))
    near, far = (np.clip(abs(f(0.5 * g)), _AT_END, 1.0) ** 2 for f in (np.sin, np.cos))
    if kind == TURN_INSIDE:
        return s * s, c * c, 2.0 * s
    if kind == TURN_OUTSIDE:
        return c * c, s * s, 2.0 * s
    if kind == NO_TURN:
        return near, far, np.full(g.size, 0.5)
    if kind == TWO_TURNS:
        return near, far, np.sqrt(near * far)
    # Falls: r = tan(theta/2) over that at the start, 1 - s^2 = c^2 from rest.
    below, left, rate = (s * s, c * c, 2.0 * s) if kind == FALL_FROM_REST else (far, near, np.full(g.size, 0.5))
    left = np.maximum(left, math.exp(-_DEEPEST))
    with np.errstate(divide="ignore"):  # of the branch that is not taken
        return np.full(g.size, math.inf), np.where(below < 0.5, -np.log1p(-below), -np.log(left)), rate / left


def make_rule() -> Rule:
    """The nodes and weights of all kinds."""
    columns: list[Matrix] = []
    first, start = np.zeros((2, KINDS * DOUBLINGS * 2)), 0
    for kind in range(KINDS):
        for doubling in range(DOUBLINGS):
            n = _FIRST[kind] << doubling
            weight = weights_of(kind, n)
            coarse = np.zeros(weight.size)
            coarse[::2] = weights_of(kind, n // 2)
            inner, outer, rate = places(kind, np.arange(weight.size) * np.pi / n)
            for end, (share, mine) in enumerate(((inner, inner <= 0.5), (outer, inner > 0.5))):
                columns.append(np.stack([share, rate, weight, coarse])[:, mine])
                first[:, (kind * DOUBLINGS + doubling) * 2 + end] = start, columns[-1].shape[1]
                start += columns[-1].shape[1]
    share, rate, weight, coarse = (np.ascontiguousarray(row) for row in np.concatenate(columns, axis=1))
    return Rule(share, rate, weight, coarse, first)


@contracted_subroutine
def load(A: Vector, arcs: Arcs, rows: Longs, first: int, n: int, chart: Chart) -> None:
    """Arcs into lanes; the last one fills those that are left over."""
    E = A[_OUTER * LANES :]
    for i in range(LANES):
        j = rows[min(first + i, n - 1)]
        A[_X + i], A[_Y + i], A[_L + i] = arcs.X[j], arcs.Y[j], arcs.L[j]
        A[_K_IN + i], A[_K_OUT + i] = arcs.K_in[j], arcs.K_out[j]
        A[_SLOW_IN + i], A[_SLOW_OUT + i] = arcs.slow_in[j], arcs.slow_out[j]
        A[R * LANES + i], A[W * LANES + i] = arcs.r_in[j], arcs.w_in[j]
        A[SIGMA3 * LANES + i], A[SIGMA4 * LANES + i] = arcs.sigma3_in[j], arcs.sigma4_in[j]
        E[R * LANES + i], E[W * LANES + i] = arcs.r_out[j], arcs.w_out[j]
        E[SIGMA3 * LANES + i], E[SIGMA4 * LANES + i] = arcs.sigma3_out[j], arcs.sigma4_out[j]
    make_ends(A, 0, chart)
    make_ends(A, _OUTER, chart)


@contracted_subroutine
def begin(A: Vector) -> bool:
    """No sums yet. Returns whether an end is so slow that distances go by sinh."""
    slowest = math.inf
    for i in range(LANES):
        for row in range(7):
            A[_TIME + row * LANES + i] = 0.0
        slow = min(A[_SLOW_IN + i], A[_SLOW_OUT + i])
        slow = slow if slow < 0.5 * A[_L + i] else math.inf
        A[_SLOW_IN + i] = A[_SLOW_IN + i] if A[_SLOW_IN + i] == slow else math.inf
        A[_SLOW_OUT + i] = slow if A[_SLOW_IN + i] == math.inf else math.inf
        length = A[_L + i] / slow
        # asinh
        A[_LENGTH + i] = logarithm(length + math.sqrt(length * length + 1.0)) if slow < math.inf else 0.0
        slowest = min(slowest, slow)
    return slowest < math.inf


@contracted_device
def sinh_cosh(y: float) -> tuple[float, float]:
    """(sinh y, cosh y) for y >= 0, each to rounding."""
    e, grown = exponential(y)
    return 0.5 * (grown + grown / e), 0.5 * (e + 1.0 / e)


@contracted_device
def placed(A: Vector, i: int, share: float, rate: float, inside: bool, slow_lanes: bool) -> tuple[float, float]:
    """Distance of a node from its end, and its rate; inside, slow_lanes: constants."""
    L = A[_L + i]
    if not slow_lanes:
        return L * share, L * rate
    slow_in, slow_out, length = A[_SLOW_IN + i], A[_SLOW_OUT + i], A[_LENGTH + i]
    here, there = (slow_in, slow_out) if inside else (slow_out, slow_in)
    slow = min(here, there)
    slow = slow if slow < math.inf else 1.0
    y = length * share
    sinh_y, cosh_y = sinh_cosh(y)
    sinh_half, _ = sinh_cosh(0.5 * y)
    _, cosh_rest = sinh_cosh(length - 0.5 * y)
    _, cosh_there = sinh_cosh(length - y)
    at_slow, at_other = here < math.inf, there < math.inf
    d = slow * sinh_y if at_slow else 2.0 * slow * cosh_rest * sinh_half if at_other else L * share
    grows = slow * length * rate
    return d, grows * cosh_y if at_slow else grows * cosh_there if at_other else L * rate


@contracted_device
def add_node(A: Vector, i: int, j: int, rule: Rule, inside: bool, slow_lanes: bool, b: Body) -> None:
    """Add node j to the sums of lane i."""
    d, rate = placed(A, i, rule.share[j], rule.rate[j], inside, slow_lanes)
    end = end_of(A, 0 if inside else _OUTER, i)
    P = point_at(A, d, not inside, end, Motion(A[_X + i], A[_Y + i]), b)
    K = (A[_K_IN + i] if inside else A[_K_OUT + i]) - P.rise
    ds = rate * math.sqrt(0.5 * b.M / K)
    turn = P.z * P.ratio - P.q * P.sigma4
    time, chi, psi = ds * P.q, ds * P.ratio, ds * turn
    weight, coarse = rule.weight[j], rule.coarse[j]
    A[_TIME + i] += weight * time
    A[_CHI + i] += weight * chi
    A[_PSI + i] += weight * psi
    A[_NOISE + i] += weight * (ds * (P.q + abs(P.ratio) + abs(turn))) * ((P.size + abs(P.rise + K)) / K)
    A[_OLD_TIME + i] += coarse * time
    A[_OLD_CHI + i] += coarse * chi
    A[_OLD_PSI + i] += coarse * psi


@contracted_subroutine
def integrate(A: Vector, kind: int, doubling: int, rule: Rule, b: Body) -> None:
    """The sums of the arcs in the lanes."""
    slow_lanes = begin(A)
    for end in range(2):
        row = (kind * DOUBLINGS + doubling) * 2 + end
        first = int(rule.first[0, row])
        for j in range(first, first + int(rule.first[1, row])):
            if slow_lanes and end == 0:
                for i in range(LANES):
                    add_node(A, i, j, rule, True, True, b)
            elif slow_lanes:
                for i in range(LANES):
                    add_node(A, i, j, rule, False, True, b)
            elif end == 0:
                for i in range(LANES):
                    add_node(A, i, j, rule, True, False, b)
            else:
                for i in range(LANES):
                    add_node(A, i, j, rule, False, False, b)


@contracted_device
def missed(new: float, old: float, size: float) -> float:
    """The error of a sum from its difference to that of half as many nodes."""
    share = abs(new - old) / size
    return size * _SAFETY * share * math.sqrt(share)


@contracted_subroutine
def found_in(A: Vector, i: int) -> tuple[ArcRow[float], float]:
    """The arc in lane i, and what of its errors more nodes would lessen, relative to what is allowed."""
    time, chi, psi = A[_TIME + i], A[_CHI + i], A[_PSI + i]
    turn = 1.0 + abs(chi) + abs(psi)
    angle = missed(chi, A[_OLD_CHI + i], turn) + missed(psi, A[_OLD_PSI + i], turn)
    off = missed(time, A[_OLD_TIME + i], time)
    noise = _ROUNDING * A[_NOISE + i]
    return ArcRow(time, chi, psi, off + noise, angle + noise), max(angle, off / time)


@contracted_subroutine
def first_doubling(kind: int, length: float, digits: float) -> int:
    """The rule to begin with: half of its nodes bring the digits of the difference that the estimate needs."""
    nodes, half = digits / _DIGITS * (1.0 + length / _LONG), 0.5 * _FIRST[kind]
    half = 0.5 * half if kind == TURN_INSIDE or kind == TURN_OUTSIDE or kind == FALL_FROM_REST else half
    doubling = 0
    while half < nodes and doubling < DOUBLINGS - 2:
        half *= 2.0
        doubling += 1
    return doubling


@contracted_subroutine
def pick(kind: int, kinds: Longs, arcs: Arcs, digits: float, rows: Longs, doublings: Longs) -> int:
    """The arcs of a kind -> rows, and the rules that they begin with -> doublings; how many there are."""
    n = 0
    for j in range(kinds.size):
        if kinds[j] == kind:
            rows[n], doublings[n] = j, first_doubling(kind, arcs.L[j], digits)
            n += 1
    return n


@kernel
def arc_batch(kinds: Longs, arcs: Arcs, accuracy: float, rule: Rule, chart: Chart, out: Matrix) -> None:
    """Every arc of its kind (n) -> out (5, n), rows as ArcRow.

    accuracy: of the angles (rad) and, relative, of the time: nodes are doubled until the estimate allows, or what
    is best stays, with its error.
    """
    n = kinds.size
    A, rows, doublings, now = np.zeros(_ROWS), np.zeros(n, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64)
    digits = math.log10(_SAFETY / accuracy) / 1.5
    for kind in range(KINDS):
        left = pick(kind, kinds, arcs, digits, rows, doublings)
        for doubling in range(DOUBLINGS):
            # Those that begin later stay in `rows`; those that do now, or go on, move to `now`.
            m, later = 0, 0
            for k in range(left):
                if doublings[k] <= doubling:
                    now[m] = rows[k]
                    m += 1
                else:
                    rows[later], doublings[later] = rows[k], doublings[k]
                    later += 1
            left = later
            for first in range(0, m, LANES):
                load(A, arcs, now, first, m, chart)
                integrate(A, kind, doubling, rule, chart.body)
                for i in range(min(LANES, m - first)):
                    j = now[first + i]
                    row, missing = found_in(A, i)
                    put(row, out, j)
                    if missing > accuracy:
                        rows[left], doublings[left] = j, doubling
                        left += 1

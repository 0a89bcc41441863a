"""Turning points: the one search, in lanes, by steps that cannot pass one.

From a point with K > 0, K' and a bound B of V'', K(d + h) >= K + K' h - B h^2/2, so that up to the root of that
parabola the motion goes on. Such steps need no bracket, begin from rest (K = 0, K' > 0), and notice crests of V,
where K turns from falling to rising. As soon as the bound proves one root near by, Halley's steps find it. Deep
below, V has one minimum only, and Newton's method in 1/q^2, in which the wall of V is straight, needs three steps.
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
    Point,
    R,
    end_of,
    make_ends,
    point_at,
    potential,
    put_end,
    slope_and_bend,
)
from kernels.disk.body import Body
from kernels.disk.elementary import EPSILON, log_ratio, logarithm
from kernels.records import Entry
from kernels.types import Matrix, Vector

# In x: where the next zero of K lies no farther beyond an end, or K is as little at a crest, the motion is slow.
SLOW = 0.05
REACH = 0.35  # in x: within it rho and sigma4 are bounded by their values and rates
_GROWN = math.exp(REACH)
_DEEP = math.exp(-3.0)  # tan(theta/2) below which V falls, and then rises as the wall
_FAR = 0.1  # such a step at least is no end in sight
_NEWTON = 60
_LEAST_STEP = 2.0 * EPSILON  # of a distance: no step is shorter
_ALMOST = 1e-12  # of a distance: the next step is at rounding
_DEEPEST = 745.0  # in x, below the vertical: tan(theta/2) is the smallest number there
_STEPS = 400 + int(_DEEPEST / REACH)  # sixteen for each decade of closeness to a crest, and those of the whole way
_BESIDE = 1e-13  # in x: so near to a start on a crest K is as its derivatives say there; rounding loses it
_FLAT = 60.0  # from the vertical: V on F is that at flat
_LEAST = 1e-300  # what is never 0
_ROUNDING = 4.0 * EPSILON  # of K, for each unit of what it was summed from
# How far a search is: by steps that cannot pass a root, by Halley's, by Newton's in the depth, done.
_OPEN, _NEAR, _IN_DEPTH, _FOUND, _FOUND_DEEP = 0.0, 1.0, 2.0, 3.0, 4.0
(
    _X, _Y, _MOVING, _D, _K, _SLOPE, _BEND, _R, _Q, _RATIO, _SIGMA4, _BEFORE, _K_BEFORE, _FALLING, _CREST, _STATE,
    _CROSSES, _ENERGY, _UPRIGHT, _LOW, _HIGH, _RISES, _BENDS, _PLACE,
) = range(END_ROWS, END_ROWS + 24 * LANES, LANES)  # fmt: skip


class Starts(NamedTuple):
    """Points of motions (n) on one face: constants, K, and the state. r: tan(theta/2); w: 1 - r^2."""

    X: Vector
    Y: Vector
    K: Vector
    r: Vector
    w: Vector
    sigma3: Vector
    sigma4: Vector


class Place(NamedTuple, Generic[Entry]):
    """A point of a motion at the distance d from a start; if searched a turning point, or the vertical before it.

    r, w, sigma3, sigma4: the state, as in `Starts`. K: there, 0 at a turning point. slow: how far from here K has
    its next zero beyond, inf where that is not near. error: from rounding, of x at turning points, elsewhere of K.
    crest: a distance on the way at which K has a least value that is as slow, else NaN. All is NaN where nothing
    was found.
    """

    d: Entry
    r: Entry
    w: Entry
    sigma3: Entry
    sigma4: Entry
    K: Entry
    slow: Entry
    error: Entry
    crest: Entry


_D_AT, _R_AT, _W_AT, _SIGMA3_AT, _SIGMA4_AT, _K_AT, _SLOW_AT, _ERROR_AT, _CREST_AT = range(
    _PLACE, _PLACE + 9 * LANES, LANES
)
_ROWS = _PLACE + 9 * LANES


@device
def steepest(q: float, ratio: float, sigma4: float, energy: float, inward: bool, b: Body) -> float:
    """A bound of V'' within REACH of a point, wherever V <= energy."""
    grown = q if inward else min(1.0, q * _GROWN)
    rate = grown * REACH
    rho = _GROWN * (abs(ratio) + b.k * rate * abs(sigma4)) / (1.0 - _GROWN * b.c * rate * rate)
    most = math.sqrt(2.0 * energy / b.I1)
    bounded = rho if (rho >= 0.0) & (rho < most) else most
    spin = min(abs(sigma4) + rate * bounded * b.inv_J, math.sqrt(2.0 * energy * b.inv_J))
    turn = grown * spin
    of_spin = 2.0 * b.I3 * bounded * turn + b.J * b.k * turn * turn
    return (b.M * grown * grown + 2.0 * b.I1) * bounded * bounded + of_spin + grown


@device
def step_of(moving: float, slope: float, bound: float) -> float:
    """How far the motion goes on at least; moving: K there, slope: dK/dd. Deep below their squares underflow."""
    steep, left = slope / bound, moving / bound
    root = math.sqrt(steep * steep + 2.0 * (left if left > 0.0 else 0.0))
    rising, falling = steep + root, 2.0 * left / max(root - steep, _LEAST)
    h = 0.0 if moving < 0.0 else rising if slope > 0.0 else falling
    return min(h, REACH)


@subroutine
def load(A: Vector, starts: Starts, first: int, disk: ArcDisk) -> None:
    """Starts from `first` on into lanes; the last one fills those that are left over."""
    last = starts.X.size - 1
    for i in range(LANES):
        j = min(first + i, last)
        A[_X + i], A[_Y + i], A[_MOVING + i] = starts.X[j], starts.Y[j], starts.K[j]
        put_end(A, 0, i, starts.r[j], starts.w[j], starts.sigma3[j], starts.sigma4[j])
    make_ends(A, 0, disk)


@device
def point_of(A: Vector, i: int, d: float, inward: bool, b: Body) -> Point:
    """The point at a distance from the start of lane i."""
    return point_at(A, 0, i, d, inward, FaceMotion(A[_X + i], A[_Y + i]), b)


@device
def stand(A: Vector, i: int, inward: bool, b: Body) -> None:
    """K, its derivatives along the way and what bounds V'' at the distance of lane i."""
    d, K = A[_D + i], A[_MOVING + i]
    P = point_of(A, i, d, inward, b)
    slope, bend = slope_and_bend(P.q, P.z, P.ratio, P.sigma4, b)
    lost = (d < _BESIDE) & (A[_BENDS + i] > 0.0) & (abs(K - P.rise) <= _ROUNDING * P.size)
    A[_K + i] = K + d * (A[_RISES + i] + 0.5 * d * A[_BENDS + i]) if lost else K - P.rise
    A[_SLOPE + i], A[_BEND + i] = slope if inward else -slope, -bend
    A[_R + i], A[_Q + i], A[_RATIO + i], A[_SIGMA4 + i] = P.r, P.q, P.ratio, P.sigma4


@subroutine
def begin(A: Vector, inward: bool, b: Body) -> None:
    """All searches at their starts."""
    for i in range(LANES):
        end = end_of(A, 0, i)
        slope, bend = slope_and_bend(end.q, end.w * end.inv, end.ratio, end.sigma4, b)
        A[_D + i] = A[_BEFORE + i] = A[_K_BEFORE + i] = A[_FALLING + i] = A[_CROSSES + i] = 0.0
        A[_K + i], A[_SLOPE + i], A[_BEND + i] = A[_MOVING + i], slope if inward else -slope, -bend
        A[_RISES + i], A[_BENDS + i] = A[_SLOPE + i], -bend
        A[_R + i], A[_Q + i], A[_RATIO + i], A[_SIGMA4 + i] = end.r, end.q, end.ratio, end.sigma4
        A[_CREST + i], A[_STATE + i] = math.nan, _OPEN
        A[_ENERGY + i] = A[_MOVING + i] + potential(end.q, end.ratio, end.sigma4, b)
        # -ln r, with all its digits beside the vertical
        A[_UPRIGHT + i] = -logarithm(end.r) if end.w > 0.5 else -0.5 * log_ratio(-end.w / (2.0 - end.w))


@device
def notice_crest(A: Vector, i: int) -> None:
    """Note where K has just passed a least value at which the motion is slow.

    A step that passes one at K_c begins where K <= 3 K_c/2, since it is no longer than sqrt(K_c/B).
    """
    slope = A[_SLOPE + i]
    slow = A[_K_BEFORE + i] <= 3.0 * SLOW * SLOW * A[_BEND + i]
    past = (A[_STATE + i] == _OPEN) & (A[_FALLING + i] == 1.0) & (slope > 0.0) & slow
    A[_CREST + i] = 0.5 * (A[_BEFORE + i] + A[_D + i]) if past else A[_CREST + i]
    A[_BEFORE + i], A[_K_BEFORE + i], A[_FALLING + i] = A[_D + i], A[_K + i], 1.0 if slope < 0.0 else 0.0


@device
def advance(A: Vector, i: int, inward: bool, b: Body) -> None:
    """One step of the search in lane i, without branches."""
    d, moving, slope, state = A[_D + i], A[_K + i], A[_SLOPE + i], A[_STATE + i]
    is_open = state == _OPEN
    bound = steepest(A[_Q + i], A[_RATIO + i], A[_SIGMA4 + i], A[_ENERGY + i], inward, b)
    h = step_of(moving, slope, bound)
    if inward:
        deep = is_open & (A[_R + i] < _DEEP) & (moving > 0.0) & (h >= _FAR)
        there, left = False, REACH
    else:
        deep = False
        left = A[_UPRIGHT + i] - d
        out = h >= left
        there = is_open & out & (left <= _LEAST_STEP * d)
        h = left if out else h
    ends = is_open & ((h <= _LEAST_STEP * d) | (h <= 0.0) | there)
    # Within twice Newton's step K falls, and has a root.
    newton = -moving / slope
    alone = (moving > 0.0) & (slope < 0.0) & (2.0 * newton <= min(left, REACH)) & (2.0 * bound * newton <= -slope)
    near = (state == _NEAR) | (is_open & alone & (not deep) & (not ends))
    high = d + 2.0 * newton if is_open else d if moving < 0.0 else A[_HIGH + i]
    low = A[_LOW + i] if moving < 0.0 else d
    new = d + 2.0 * newton / (2.0 + newton * (A[_BEND + i] / slope))
    new = new if (new >= low) & (new <= high) else 0.5 * (low + high)
    # What Halley's step leaves is of its third order.
    step, steep = abs(new - d), bound / abs(slope)
    settled = near & (step * step * step * steep * (steep + 1.0) <= _LEAST_STEP * new)
    A[_LOW + i], A[_HIGH + i] = low, high
    A[_CROSSES + i] = 1.0 if there & (moving > 0.0) else A[_CROSSES + i]
    A[_STATE + i] = _IN_DEPTH if deep else _FOUND if ends | settled else _NEAR if near else state
    A[_D + i] = new if near else d + h if is_open & (not deep) & (not ends) else d


@subroutine
def any_left(A: Vector, until: float) -> bool:
    """Whether a search is not yet so far."""
    n = 0
    for i in range(LANES):
        n += 1 if A[_STATE + i] < until else 0
    return n > 0


@device
def enter_depth(A: Vector, i: int, b: Body) -> None:
    """A distance to begin with, from the law of first order."""
    wall = A[_K + i] + potential(A[_Q + i], A[_RATIO + i], 0.0, b)
    guess = 0.5 * abs(A[_Y + i]) * math.sqrt(0.5 * b.I1 / wall)
    first = logarithm(A[R + i]) - logarithm(guess if guess > _LEAST else _LEAST)
    A[_LOW + i], A[_HIGH + i] = A[_D + i], _DEEPEST
    first = first if first > A[_D + i] + 1e-3 else A[_D + i] + 1e-3
    A[_D + i] = (first if first < _DEEPEST else _DEEPEST) if A[_STATE + i] == _IN_DEPTH else A[_D + i]


@device
def approach(A: Vector, i: int) -> None:
    """A step of Newton's in 1/q^2 in lane i, or of bisection where that leaves the bracket."""
    d, moving, slope, r = A[_D + i], A[_K + i], A[_SLOPE + i], A[_R + i]
    is_open = A[_STATE + i] == _IN_DEPTH
    low, high = A[_LOW + i] if moving < 0.0 else d, d if moving < 0.0 else A[_HIGH + i]
    z = (1.0 - r * r) / (1.0 + r * r)
    share = -2.0 * z * moving / slope if slope < 0.0 else -1.0
    able = share > -0.99
    grown = 1.0 + (share if able else 0.0)
    new, shrunk = d + 0.5 * logarithm(grown), r / math.sqrt(grown)
    newton = able & (new >= low) & (new <= high)
    ends = is_open & newton & (abs(new - d) <= _ALMOST * d)
    # In r the last step leaves more digits than a distance of hundreds has.
    A[_R + i] = shrunk if ends else r
    A[_LOW + i], A[_HIGH + i] = low, high
    A[_D + i] = (new if newton else 0.5 * (low + high)) if is_open else d
    A[_STATE + i] = _FOUND_DEEP if ends else A[_STATE + i]


@subroutine
def dive(A: Vector, b: Body) -> None:
    """The searches that are deep below, by Newton's method."""
    for i in range(LANES):
        enter_depth(A, i, b)
    for _ in range(_NEWTON):
        for i in range(LANES):
            r = A[_R + i]
            stand(A, i, True, b)
            A[_R + i] = A[_R + i] if A[_STATE + i] == _IN_DEPTH else r
        for i in range(LANES):
            approach(A, i)
        if not any_left(A, _FOUND):
            break


@device
def approach_rest(A: Vector, i: int) -> None:
    """A step of Newton's towards K = 0 in lane i, or of bisection; K < 0 before and V falls all the way."""
    d, moving, slope = A[_D + i], A[_K + i], A[_SLOPE + i]
    low, high = d if moving < 0.0 else A[_LOW + i], A[_HIGH + i] if moving < 0.0 else d
    new = d - moving / slope
    middle = 0.5 * (low + high) if (low > 0.0) | (high < 1e-3) else 0.1 * high
    newton = (slope > 0.0) & (new >= low) & (new <= high)
    is_open = A[_STATE + i] == _OPEN
    A[_STATE + i] = _FOUND if is_open & newton & (abs(new - d) <= _ALMOST * new) else A[_STATE + i]
    new = new if newton else middle
    A[_LOW + i], A[_HIGH + i] = low, high
    A[_D + i] = new if is_open else d


@subroutine
def search(A: Vector, inward: bool, b: Body) -> None:
    """The next turning points; outwards the vertical where that comes first."""
    begin(A, inward, b)
    for _ in range(_STEPS):
        for i in range(LANES):
            notice_crest(A, i)
        if inward:
            for i in range(LANES):
                advance(A, i, True, b)
        else:
            for i in range(LANES):
                advance(A, i, False, b)
        if not any_left(A, _IN_DEPTH):
            break
        if inward:
            for i in range(LANES):
                stand(A, i, True, b)
        else:
            for i in range(LANES):
                stand(A, i, False, b)
    if any_left(A, _FOUND):
        dive(A, b)


@subroutine
def search_rest(A: Vector, b: Body) -> None:
    """Where motions on F that lack -K at their starts begin from rest, towards flat."""
    begin(A, True, b)
    for i in range(LANES):
        A[_LOW + i], A[_HIGH + i] = 0.0, _FLAT
    for _ in range(_NEWTON):
        for i in range(LANES):
            approach_rest(A, i)
        if not any_left(A, _IN_DEPTH):
            break
        for i in range(LANES):
            stand(A, i, True, b)


@device
def next_zero(K: float, fall: float, bend: float) -> tuple[float, float]:
    """How far beyond a point the parabola of K has its next zero, inf for none, and, if complex, how far aside.

    fall: the rate at which K falls there; bend: V''. Deep below their squares underflow.
    """
    scale = 1.0 / max(max(_LEAST, abs(K)), max(abs(fall), abs(bend)))
    K, fall, bend = K * scale, fall * scale, bend * scale
    square = fall * fall + 2.0 * bend * K
    root = math.sqrt(abs(square))
    real = 2.0 * K / (fall + root) if K > 0.0 else -2.0 * fall / bend
    real = real if real > 0.0 else math.inf
    return (real, 0.0) if square >= 0.0 else (-fall / bend, root / bend)


@device
def slow_beyond(K: float, slope: float, bend: float) -> float:
    """The distance to the next zero of K, from K and derivatives of V; inf beyond SLOW."""
    beyond, aside = next_zero(K, abs(slope), bend)
    aside = abs(aside)
    # Squares of what lies so near would underflow.
    large = max(max(beyond, aside), _LEAST)
    share = min(beyond, aside) / large
    slow = large * math.sqrt(1.0 + share * share)
    return max(slow, _LEAST) if slow < SLOW else math.inf


@device
def place(A: Vector, i: int, inward: bool, b: Body) -> None:
    """The point at the distance of lane i."""
    d = A[_D + i]
    P = point_of(A, i, d, inward, b)
    slope, bend = slope_and_bend(P.q, P.z, P.ratio, P.sigma4, b)
    K = A[_MOVING + i] - P.rise
    A[_D_AT + i], A[_R_AT + i], A[_W_AT + i] = d, P.r, P.w
    A[_SIGMA3_AT + i], A[_SIGMA4_AT + i], A[_K_AT + i] = P.sigma3, P.sigma4, K
    A[_SLOW_AT + i], A[_CREST_AT + i] = slow_beyond(K, slope, bend), math.nan
    A[_ERROR_AT + i] = _ROUNDING * (P.size + abs(A[_MOVING + i]))
    A[_SLOPE + i], A[_BEND + i] = slope, bend


@device
def as_found(A: Vector, i: int) -> None:
    """The point in lane i, which a search has found, as such."""
    crosses, r = A[_CROSSES + i] == 1.0, A[_R + i] if A[_STATE + i] == _FOUND_DEEP else A[_R_AT + i]
    w = A[_W_AT + i] if r > 0.5 else (1.0 - r) * (1.0 + r)
    A[_R_AT + i], A[_W_AT + i] = 1.0 if crosses else r, 0.0 if crosses else w
    A[_K_AT + i] = A[_K_AT + i] if crosses else 0.0
    A[_SLOW_AT + i] = A[_SLOW_AT + i] if crosses else slow_beyond(0.0, A[_SLOPE + i], A[_BEND + i])
    A[_ERROR_AT + i] = A[_ERROR_AT + i] if crosses else A[_ERROR_AT + i] / abs(A[_SLOPE + i])
    A[_D_AT + i] = A[_D_AT + i] if A[_STATE + i] >= _FOUND else math.nan


@subroutine
def place_all(A: Vector, inward: bool, b: Body) -> None:
    """The points at the distances of all lanes."""
    if inward:
        for i in range(LANES):
            place(A, i, True, b)
    else:
        for i in range(LANES):
            place(A, i, False, b)


@subroutine
def write(A: Vector, first: int, out: Matrix) -> None:
    """The points in the lanes into columns from `first` on; all NaN without a distance."""
    n = min(LANES, out.shape[1] - first)
    for row in range(out.shape[0]):
        for i in range(n):
            out[row, first + i] = A[_PLACE + row * LANES + i] if A[_PLACE + i] == A[_PLACE + i] else math.nan


@subroutine
def store(A: Vector, first: int, inward: bool, b: Body, out: Matrix) -> None:
    """What searches have found into columns from `first` on."""
    place_all(A, inward, b)
    for i in range(LANES):
        as_found(A, i)
    for i in range(LANES):
        if A[_CREST + i] == A[_CREST + i]:
            A[_CREST_AT + i] = find_crest(A, i, inward, b)
    write(A, first, out)


@subroutine
def find_crest(A: Vector, i: int, inward: bool, b: Body) -> float:
    """The distance of a crest from near it, by Newton's method; NaN where the motion is not slow there."""
    d, slow = A[_CREST + i], False
    for _ in range(_NEWTON):
        P = point_of(A, i, d, True, b) if inward else point_of(A, i, d, False, b)
        slope, bend = slope_and_bend(P.q, P.z, P.ratio, P.sigma4, b)
        step = max(-REACH, min(REACH, (slope if inward else -slope) / bend))
        slow = (bend < 0.0) & (A[_MOVING + i] - P.rise < -0.5 * SLOW * SLOW * bend)
        d += step
        if not ((abs(step) > _LEAST_STEP * d) & (bend < 0.0) & (d > 0.0) & (d < A[_D + i])):
            break
    return d if slow & (d > 0.0) & (d < A[_D + i]) else math.nan


@subroutine
def store_ends(A: Vector, first: int, b: Body, state: Matrix, vertical: Matrix) -> None:
    """The starts, and the vertical as the constants of their motions have it, into columns from `first` on."""
    A[_D : _D + LANES] = 0.0
    place_all(A, False, b)
    write(A, first, state)
    for i in range(LANES):
        A[_D + i] = A[_UPRIGHT + i]
    place_all(A, False, b)
    A[_R_AT : _R_AT + LANES], A[_W_AT : _W_AT + LANES] = 1.0, 0.0
    write(A, first, vertical)


@kernel
def inward_batch(starts: Starts, disk: ArcDisk, out: Matrix) -> None:
    """The next turning point towards flat from every start -> out (9, n), rows as Place."""
    A = np.zeros(_ROWS)
    for first in range(0, out.shape[1], LANES):
        load(A, starts, first, disk)
        search(A, True, disk.body)
        store(A, first, True, disk.body, out)


@kernel
def orbit_batch(
    starts: Starts, disk: ArcDisk, state: Matrix, inner: Matrix, outer: Matrix, vertical: Matrix
) -> None:
    """Where every motion turns on the face of its start -> four times (9, n), rows as Place.

    state: the start. inner: the next turning point towards flat. outer: the next away from it, or the vertical
    before. vertical: what the constants of the motion give there, whether it comes there or not; K below 0 is what
    it lacks.
    """
    A = np.zeros(_ROWS)
    for first in range(0, inner.shape[1], LANES):
        load(A, starts, first, disk)
        search(A, True, disk.body)
        store(A, first, True, disk.body, inner)
        search(A, False, disk.body)
        store(A, first, False, disk.body, outer)
        store_ends(A, first, disk.body, state, vertical)


@kernel
def rest_batch(starts: Starts, disk: ArcDisk, out: Matrix) -> None:
    """Where motions on F (Y = 0) with K < 0 at their starts begin from rest, towards flat -> out (9, n)."""
    A = np.zeros(_ROWS)
    for first in range(0, out.shape[1], LANES):
        load(A, starts, first, disk)
        search_rest(A, disk.body)
        store(A, first, True, disk.body, out)


@kernel
def point_batch(starts: Starts, d: Vector, inward: bool, disk: ArcDisk, out: Matrix) -> None:
    """The point at a distance from every start -> out (9, n), rows as Place."""
    A = np.zeros(_ROWS)
    for first in range(0, d.size, LANES):
        load(A, starts, first, disk)
        for i in range(LANES):
            A[_D + i] = d[min(first + i, d.size - 1)]
        place_all(A, inward, disk.body)
        write(A, first, out)

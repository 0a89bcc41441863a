"""A rise of the tilt as series: time, angles and centre on pieces of the way between two turning points.

Points of a rise are counted from anchors, so that no digit of the speed is lost (`potential`): from a turning
point, or from a place between at which the motion is slow. The stretch that is counted from one anchor is cut into
pieces a <= d <= a + L of the distance d in x. With v = (d - a)/L, integrals over a piece are Chebyshev series of N
coefficients: in odd T(sqrt v) where it begins at a turning point, since all goes like sqrt(v) there, else in T(2v
- 1). By mirror symmetry about the line through a turning point, of the centre only the part along that line goes
like sqrt(v); the part across goes like v.

Deep below nothing changes but tan(theta/2), linearly in time: on a coast, which is one piece at any depth.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from kernels._jit import device, subroutine
from kernels.arcs.potential import (
    END_ROWS,
    LANES,
    ArcDisk,
    FaceMotion,
    Point,
    make_ends,
    point_at,
    put_end,
    slope_and_bend,
)
from kernels.arcs.rules import moved_by
from kernels.disk.body import Body
from kernels.disk.elementary import EPSILON, logarithm, sine_cosine
from kernels.records import reader, writer
from kernels.types import Vector

N = LANES  # nodes and coefficients of a piece
STRETCHES = 4  # of a rise at most: from the lower turning point, from a slow place both ways, from the upper one
DEEP = 37.5  # in x: so far from the wall and from the vertical only tan(theta/2) changes, by rounding
STEADY = 1e-30  # in x: how far apart the turning points of a steady motion are said to be
MOST = 2048  # pieces of a rise: most have 2 to 40, and a path one more for every eight radians of chi
LEFT_OUT = 2e-14  # by a series, relative to its own size or to a radian
_FIRST, _LONGEST, _GROWTH = (
    1.7,
    5.0,
    1.2,
)  # lengths in x: of the scale of a turning point; at most; of the distance
_BARELY = 1.3  # of a step: a last piece as long is not cut
_SHORTEST = 1e-9  # of the scale at an anchor
TAILS = 3.0  # what a series leaves out is within so many times what its last coefficients say
_NEAR = 0.5  # in x: so far from a place at which a motion is slow K comes from V''
_ROUNDING = 0.5 * EPSILON  # of a speed, for each unit of what K is a sum of: that is off by about one of rounding
# Kinds of pieces
PLAIN, TURN, COAST = 0.0, 1.0, 2.0
SERIES = 8
TIME, CHI, PSI, ACROSS, ALONG, SPEED, RATIO, SIGMA4 = range(0, SERIES * N, N)


class Anchor(NamedTuple):
    """A place from which distances are counted, as in `turning_points.Place`; face: +1 on the lower one's.

    Of flat, r is tan(theta/2) up to which a motion on F only coasts. loose: by how many units of rounding X and Y
    may be off, as they were found from a state.
    """

    X: float
    Y: float
    face: float
    r: float
    w: float
    sigma3: float
    sigma4: float
    K: float
    slow: float
    error: float
    loose: float


class Stretch(NamedTuple):
    """A part of a rise; without length and coast it is not there.

    anchor: from which it is counted; beyond: the vertical as its other face sees it. upright: distance of the
    vertical, inf where it is not on the way. length: in x. coast: how much farther only tan(theta/2) changes.
    apart: of both turning points, in a narrow well, else 0.
    """

    anchor: float
    beyond: float
    upright: float
    length: float
    coast: float
    apart: float


class Low(NamedTuple):
    """What time, angles and the centre are where a piece begins, at its smaller distance."""

    time: float
    chi: float
    psi: float
    a1: float
    a2: float


class Piece(NamedTuple):
    """A piece but for its series: kind; the stretch it is of, whose distances grow with time where sign is +1.

    face, r: of the anchor. start, length: in x; of a coast tan(theta/2) at its beginning, and how fast that
    changes. span: of time. slope, grown, bend: how the time begins to grow with v or its root, by how much faster
    it does at the end, and the logarithm of that.
    """

    kind: float
    stretch: float
    sign: float
    face: float
    r: float
    start: float
    length: float
    span: float
    slope: float
    grown: float
    bend: float


class Rates(NamedTuple):
    """How fast chi and psi turn at the start of a motion, and sigma4 there, as its rise sees them.

    Where rounding delays a motion, all that goes on as at the start is not seen of it at a given time. Of a motion
    that lingers beside an equilibrium, where delays are long, hardly anything is.
    """

    chi: float
    psi: float
    sigma4: float


class Errors(NamedTuple):
    """Errors of a rise from end to end, and within.

    delay: of time, from rounding; time, angle (rad), path: what else there is of these, of what does not go on as
    at the start. time_within, angle_within, path_within: what series leave out. way: of the centre.
    """

    delay: float
    time: float
    angle: float
    path: float
    time_within: float
    angle_within: float
    path_within: float
    way: float


anchor_of, stretch_of = reader(Anchor, 1), reader(Stretch, 1)
low_of, put_low = reader(Low, 1), writer(Low, 1)
piece_of, put_piece = reader(Piece, 1), writer(Piece, 1)
ANCHOR, STRETCH = len(Anchor._fields), len(Stretch._fields)
LOW, PIECE = len(Low._fields), len(Piece._fields)
HEAD = LOW + PIECE  # where the series of a piece begin
WIDE = HEAD + SERIES * N
# Rows of the work array: the ends, what is at the nodes, coefficients; then the nodes v and matrices.
_D, _K, _Q, _Z, _RATIO, _SIGMA4, _SIZE, _BEND, _F0, _F1, _F2, _F3, _F4, _F5, _CHI, _MEAN, _C = range(
    2 * END_ROWS, 2 * END_ROWS + 17 * N, N
)
_V = _C + SERIES * N
_COSINES, _PLAIN, _TURN, _PLAIN_AT, _TURN_AT, _BENT = range(_V + N, _V + N + 6 * N * N, N * N)
ROOM = _BENT + N * N


def matrices() -> Vector:
    """Nodes v (N), and matrices from values there, transposed, one after another.

    They give coefficients of the values, of the integral from v = 0 and of that of values/sqrt(v), both of these
    at the nodes, and from V'' the coefficients of its mean, as `bend` has it.
    """
    angle, order = (np.arange(N) + 0.5) * np.pi / N, np.arange(N)
    cosines = np.where(order == 0, 1.0, 2.0)[:, None] / N * np.cos(np.outer(order, angle))
    first = np.where(order == 0, 2.0, 1.0)  # of T_j(2v - 1) dv, and of 2 T_2j(u) du with u = sqrt(v)
    low = np.where(order > 1, 0.25 / np.fmax(order - 1, 1), 0.0)
    plain = np.diag((0.25 * first / (order + 1))[:-1], -1) - np.diag(low[1:], 1)
    turn = np.diag(first / (2 * order + 1)) - np.diag(1.0 / (2 * order[1:] - 1), 1)
    plain[0] = -((-1.0) ** order[1:] @ plain[1:])  # zero at v = 0
    plain, turn = plain @ cosines, turn @ cosines
    plain_at, turn_at = np.cos(np.outer(angle, order)), np.cos(np.outer(0.5 * angle, 2 * order + 1))
    # (The mean of V'' over the way, weighted by what is left of it, at the nodes, and its coefficients.)
    at, weights = legendre.leggauss(N)
    at, weights, v = 0.5 * (1.0 + at), 0.5 * weights, 0.5 * (1.0 + np.cos(angle))
    means = np.cos(order * np.arccos(2.0 * v[:, None, None] * at[:, None] - 1.0))
    bent = cosines @ np.einsum("i,kij->kj", weights * (1.0 - at), means) @ cosines
    parts = 0.5 * (1.0 + np.cos(angle)), cosines, plain, turn, plain_at @ plain, turn_at @ turn, bent
    return np.concatenate([part.T.ravel() for part in parts])


_MATRICES = matrices()


@subroutine
def prepare(W: Vector) -> None:
    """The nodes and matrices into a work array."""
    for k in range(_MATRICES.size):
        W[_V + k] = _MATRICES[k]


@device
def _sixteen(W: Vector, at: int) -> tuple[float, ...]:
    """The numbers of a row; LANES is 16."""
    return (
        W[at], W[at + 1], W[at + 2], W[at + 3], W[at + 4], W[at + 5], W[at + 6], W[at + 7],
        W[at + 8], W[at + 9], W[at + 10], W[at + 11], W[at + 12], W[at + 13], W[at + 14], W[at + 15],
    )  # fmt: skip


@device
def multiply(W: Vector, matrix: int, row: int, out: int) -> None:
    """Row `out` = a matrix times a row. What is read into numbers first cannot overlap what is written."""
    a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p = _sixteen(W, row)
    for x in range(N):
        y = matrix + x
        s = W[y] * a + W[y + 16] * b + W[y + 32] * c + W[y + 48] * d + W[y + 64] * e + W[y + 80] * f
        s += W[y + 96] * g + W[y + 112] * h + W[y + 128] * i + W[y + 144] * j + W[y + 160] * k + W[y + 176] * l
        W[out + x] = s + W[y + 192] * m + W[y + 208] * n + W[y + 224] * o + W[y + 240] * p


@device
def total(W: Vector, row: int) -> float:
    """The sum of a row."""
    a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p = _sixteen(W, row)
    return (((a + b) + (c + d)) + ((e + f) + (g + h))) + (((i + j) + (k + l)) + ((m + n) + (o + p)))


@device
def tail(W: Vector, series: int) -> float:
    """What a series leaves out, as its last four coefficients fall; of each two one may be small by parity."""
    at = _C + series + N
    last, before = max(abs(W[at - 1]), abs(W[at - 2])), max(abs(W[at - 3]), abs(W[at - 4]))
    return last * last / before if before > last else last


class View(NamedTuple):
    """A stretch as it is counted: its anchor, and the vertical behind which its points are counted from there.

    sign: +1 where distances grow with time. inward: towards flat. turns: the anchor is a turning point. steep: by
    which K grows there. rates: at the start; unsure: what rounding of that leaves unknown of the energy.
    """

    near: Anchor
    beyond: Anchor
    stretch: Stretch
    sign: float
    inward: bool
    turns: bool
    steep: float
    rates: Rates
    unsure: float


@subroutine
def stand(W: Vector, at: int, anchor: Anchor, disk: ArcDisk) -> None:
    """An anchor as the end in all lanes."""
    for k in range(N):
        put_end(W, at, k, anchor.r, anchor.w, anchor.sigma3, anchor.sigma4)
    make_ends(W, at, disk)


@device
def size_of(anchor: Anchor) -> float:
    """What K at an anchor was found from; at a turning point it is 0, and that may be elsewhere."""
    return anchor.error / (4.0 * EPSILON) if anchor.K > 0.0 else 0.0


@device
def write(W: Vector, k: int, P: Point, anchor: Anchor, there: bool, b: Body) -> None:
    """A point that is counted from an anchor into node k, where it is there."""
    _slope, bend = slope_and_bend(P.q, P.z, P.ratio, P.sigma4, b)
    W[_K + k], W[_Q + k] = anchor.K - P.rise if there else W[_K + k], P.q if there else W[_Q + k]
    W[_Z + k], W[_RATIO + k] = anchor.face * P.z if there else W[_Z + k], P.ratio if there else W[_RATIO + k]
    W[_SIGMA4 + k] = anchor.face * P.sigma4 if there else W[_SIGMA4 + k]
    W[_SIZE + k] = anchor.loose * (P.size + size_of(anchor)) if there else W[_SIZE + k]
    W[_BEND + k] = bend if there else W[_BEND + k]


@subroutine
def look(W: Vector, view: View, a: float, length: float, b: Body) -> None:
    """The motion at the nodes of a piece that begins at the distance a."""
    near, beyond, upright = (
        FaceMotion(view.near.X, view.near.Y),
        FaceMotion(view.beyond.X, view.beyond.Y),
        view.stretch.upright,
    )
    for k in range(N):
        W[_D + k] = a + length * W[_V + k]
    if view.inward:
        for k in range(N):
            write(W, k, point_at(W, 0, k, W[_D + k], True, near, b), view.near, True, b)
    elif a < upright:
        for k in range(N):
            write(W, k, point_at(W, 0, k, min(W[_D + k], upright), False, near, b), view.near, True, b)
    if a + length > upright:
        for k in range(N):
            d = W[_D + k] - upright
            write(W, k, point_at(W, END_ROWS, k, max(d, 0.0), True, beyond, b), view.beyond, d > 0.0, b)


@subroutine
def bend(W: Vector, view: View, extent: float, b: Body) -> float:
    """The mean of V'' over the way from an anchor, weighted by what is left of it, as a series up to some extent.

    K is K + steep d - mean d^2 then, where its differences from the anchor would be lost in rounding. Returns
    `steep`, by which K grows; in a narrow well such that K vanishes at the other end.
    """
    look(W, view, 0.0, extent, b)
    multiply(W, _BENT, _BEND, _MEAN)
    return extent * total(W, _MEAN) if view.stretch.apart > 0.0 else view.steep


@subroutine
def by_bend(W: Vector, view: View, steep: float, extent: float) -> None:
    """K at the nodes, from V''. In a narrow well it is known as well as V'' is.

    A motion that is steady is anywhere within its well, also where V has no minimum there.
    """
    steady = view.stretch.apart == STEADY
    for k in range(N):
        d, b1, b2 = W[_D + k], 0.0, 0.0
        u = 4.0 * d / extent - 2.0
        for j in range(N - 1, 0, -1):
            b1, b2 = (W[_MEAN + j] - b2) + u * b1, b1
        K = view.near.K + d * (steep - d * (W[_MEAN] - b2 + 0.5 * u * b1))
        W[_K + k], W[_SIZE + k] = abs(K) if steady else K, K if view.stretch.apart > 0.0 else W[_SIZE + k]


@subroutine
def integrate(W: Vector, turns: bool, length: float, sign: float, path: bool, b: Body) -> bool:
    """Coefficients of all series from what is at the nodes; False where the motion does not get through."""
    least = W[_K]
    for k in range(N):
        least = min(least, W[_K + k])
    if not least > 0.0:
        return False
    half_M, inv_M, integral = 0.5 * b.M, 2.0 * b.inv_M, _TURN if turns else _PLAIN
    for k in range(N):
        over = length * W[_V + k] / W[_K + k] if turns else length / W[_K + k]
        ds = math.sqrt(half_M * length * over)  # times sqrt(v) where it turns
        W[_F0 + k], W[_F1 + k] = ds * W[_Q + k], ds * W[_RATIO + k]
        W[_F2 + k] = ds * (W[_Z + k] * W[_RATIO + k] - W[_Q + k] * W[_SIGMA4 + k])
        W[_F5 + k] = math.sqrt(inv_M * W[_K + k] / W[_V + k]) if turns else math.sqrt(inv_M * W[_K + k])
    multiply(W, integral, _F0, _C + TIME)
    multiply(W, integral, _F1, _C + CHI)
    multiply(W, integral, _F2, _C + PSI)
    multiply(W, _COSINES, _F5, _C + SPEED)
    multiply(W, _COSINES, _RATIO, _C + RATIO)
    multiply(W, _COSINES, _SIGMA4, _C + SIGMA4)
    if path:  # eq. (2.33), in the frame of the piece's beginning
        multiply(W, _TURN_AT if turns else _PLAIN_AT, _F1, _CHI)
        for k in range(N):
            s, c = sine_cosine(sign * W[_CHI + k])
            root, slide = math.sqrt(W[_V + k]) if turns else 1.0, W[_Q + k] * W[_F5 + k]
            W[_F3 + k] = W[_F0 + k] * (slide * c + W[_SIGMA4 + k] * s / root)
            W[_F4 + k] = W[_F0 + k] * (slide * root * s - W[_SIGMA4 + k] * c)
        multiply(W, _PLAIN, _F3, _C + ACROSS)
        multiply(W, integral, _F4, _C + ALONG)
    return True


@device
def small(W: Vector, series: int) -> bool:
    """Whether a series leaves out as little as it should."""
    return tail(W, series) <= LEFT_OUT * (1.0 + abs(W[_C + series]))


@subroutine
def converged(W: Vector, time: float, path: bool) -> bool:
    """Whether the series of a piece leave out as little as they should; time: of the stretch so far."""
    found = tail(W, TIME) <= LEFT_OUT * (time + total(W, _C + TIME))
    found &= small(W, CHI) & small(W, PSI) & small(W, SPEED) & small(W, RATIO) & small(W, SIGMA4)
    return found & ((not path) or (tail(W, ACROSS) <= LEFT_OUT) & (tail(W, ALONG) <= LEFT_OUT))


@subroutine
def with_piece(W: Vector, view: View, steep: float, turns: bool, path: bool, before: Errors) -> Errors:
    """The errors of a rise with those of a piece.

    Where the energy is off, a turning point moves, and what is left of that in K grows with the distance from it.
    At the end of a piece as much is left out as within it.
    """
    rates = view.rates
    for k in range(N):
        off = view.unsure * abs(W[_K + k] / (steep * W[_D + k]) - 1.0) if view.turns else 0.5 * view.unsure
        unsure = (_ROUNDING * W[_SIZE + k] + (0.0 if view.stretch.apart > 0.0 else off)) / W[_K + k]
        time, root = W[_F0 + k], math.sqrt(W[_V + k]) if turns else 1.0
        slide = W[_Q + k] * W[_F5 + k] * root
        chi, psi = abs(W[_F1 + k] - rates.chi * time), abs(W[_F2 + k] - rates.psi * time)
        rolled = time * (abs(W[_SIGMA4 + k] - rates.sigma4) + slide) + chi
        W[_F1 + k], W[_F3 + k], W[_F5 + k] = unsure * (chi + psi), unsure * time, unsure * rolled
        W[_F4 + k] = time * (abs(W[_SIGMA4 + k]) + slide)
    weight, time, angle = 2.0 / N if turns else 1.0 / N, tail(W, TIME), tail(W, CHI) + tail(W, PSI)
    moved = max(tail(W, ACROSS), tail(W, ALONG)) if path else 0.0
    return Errors(
        before.delay + weight * total(W, _F3),
        before.time + TAILS * time,
        before.angle + TAILS * angle + weight * total(W, _F1),
        before.path + TAILS * moved + weight * total(W, _F5),
        max(before.time_within, TAILS * time),
        max(before.angle_within, TAILS * angle),
        max(before.path_within, TAILS * moved),
        before.way + weight * total(W, _F4),
    )


@subroutine
def keep(W: Vector, view: View, number: int, a: float, length: float, turns: bool, P: Vector, at: int) -> float:
    """The piece whose series were found into the pool; returns its time."""
    near, span, grown = view.near, total(W, _C + TIME), W[_F0] / W[_F0 + N - 1]
    slope, kind, bend = 2.0 * W[_F0 + N - 1], TURN if turns else PLAIN, logarithm(grown)
    piece = Piece(kind, number, view.sign, near.face, near.r, a, length, span, slope, grown - 1.0, bend)
    put_piece(P, at + LOW, 0, piece)
    for k in range(SERIES * N):
        P[at + HEAD + k] = W[_C + k]
    return span


@subroutine
def keep_coast(W: Vector, view: View, number: int, P: Vector, at: int, b: Body) -> None:
    """The coast of a stretch into the pool: behind its pieces, or from flat."""
    near, flat = view.near, view.stretch.length == 0.0
    K, sigma4 = near.K if flat else W[_K], near.face * near.sigma4 if flat else W[_SIGMA4]
    first = 0.0 if flat else near.r * math.exp(view.stretch.length)
    last, rate = near.r if flat else first * math.exp(view.stretch.coast), math.sqrt(2.0 * b.inv_M * K)
    span = 2.0 * (last - first) / rate
    put_piece(P, at + LOW, 0, Piece(COAST, number, view.sign, near.face, last, first, rate, span, 0.0, 0.0, 0.0))
    P[at + HEAD : at + WIDE] = 0.0
    P[at + HEAD + SPEED], P[at + HEAD + SIGMA4] = rate, sigma4
    P[at + HEAD + RATIO] = 0.0 if flat else W[_RATIO]


@subroutine
def view_of(anchors: Vector, stretch: Stretch, number: int, rates: Rates, unsure: float, b: Body) -> View:
    """How the points of a stretch are counted: those of the stretches 0 and 2 of a rise with the time."""
    near, beyond = (
        anchor_of(anchors, int(stretch.anchor) * ANCHOR, 0),
        anchor_of(anchors, int(stretch.beyond) * ANCHOR, 0),
    )
    sign, inv = 1.0 if number % 2 == 0 else -1.0, 1.0 / (1.0 + near.r * near.r)
    q, inward = 2.0 * near.r * inv, sign * near.face < 0.0
    slope, _bend = slope_and_bend(q, near.w * inv, near.sigma3 / q, near.sigma4, b)
    steep, turns = slope if inward else -slope, near.K == 0.0
    # From a turning point K grows, whatever rounding says of the slope at one on a crest.
    return View(near, beyond, stretch, sign, inward, turns, abs(steep) if turns else steep, rates, unsure)


@subroutine
def lay(
    W: Vector, view: View, number: int, P: Vector, n: int, most: int, path: bool, before: Errors, disk: ArcDisk
) -> tuple[int, Errors]:
    """The pieces of a stretch into the pool behind n others; how many there are then, or -1, and errors so far."""
    near, length, steep, b = view.near, view.stretch.length, view.steep, disk.body
    scale, extent = min(near.slow, 1.0), view.stretch.apart if view.stretch.apart > 0.0 else min(_NEAR, length)
    bent = (view.stretch.apart > 0.0) | (near.slow < math.inf)
    step, a, time, turned, errors = _FIRST * scale if view.turns else scale, 0.0, 0.0, 0.0, before
    if length > 0.0:
        stand(W, 0, near, disk)
        if view.stretch.upright < math.inf:
            stand(W, END_ROWS, view.beyond, disk)
        if bent:
            steep = bend(W, view, extent, b)
    while a < length:
        L, turns = step if a + _BARELY * step < length else length - a, view.turns and a == 0.0
        look(W, view, a, L, b)
        if bent and a + L <= extent:
            by_bend(W, view, steep, extent)
        if integrate(W, turns, L, view.sign, path, b) and converged(W, time, path):
            span = keep(W, view, number, a, L, turns, P, n * WIDE)
            turned += abs(total(W, _C + CHI) - view.rates.chi * span) + abs(
                total(W, _C + PSI) - view.rates.psi * span
            )
            errors, time = with_piece(W, view, steep, turns, path, errors), time + span
            a, n, step = a + L, n + 1, min(_GROWTH * (a + L + scale), _LONGEST)
        else:
            step = 0.5 * L
        if n >= most or not step > _SHORTEST * scale:
            return -1, errors
    share = moved_by(near.K, near.slow, near.error, length) if length > 0.0 else 0.0
    if view.stretch.coast > 0.0:
        keep_coast(W, view, number, P, n * WIDE, b)
        n += 1
    return n, delayed(errors, share * time, share * turned, share * (errors.way - before.way))


@device
def delayed(errors: Errors, delay: float, angle: float, path: float) -> Errors:
    """Errors, and those of a delay."""
    return Errors(
        errors.delay + delay,
        errors.time,
        errors.angle + angle,
        errors.path + path,
        errors.time_within,
        errors.angle_within,
        errors.path_within,
        errors.way,
    )

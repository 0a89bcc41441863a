"""Motions at any times from one rise of the tilt: the cost does not depend on the time.

The tilt swings between two turning points, and by symmetry about either the way down is the way up run backwards.
One period turns the picture by an angle and moves it along, so that whole periods add up in closed form; what is
left of a time is folded to the nearest lower turning point, about which no digit of a race is lost. On the falling
set the lower turning point is flat itself, and half of the jump of chi lies on either side of it (section 7).

Pieces of N motions are laid at a time, and read N at a time, each lane for one motion at one time; nothing of them
is kept. Errors are sums of those of pieces, over all rises so far.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.arcs.pieces import (
    ACROSS,
    ALONG,
    CHI,
    COAST,
    HEAD,
    LEFT_OUT,
    LOW,
    MOST,
    PSI,
    RATIO,
    ROOM,
    SIGMA4,
    SPEED,
    STRETCH,
    STRETCHES,
    TAILS,
    TIME,
    TURN,
    WIDE,
    Errors,
    Low,
    N,
    Piece,
    Rates,
    lay,
    low_of,
    piece_of,
    prepare,
    put_low,
    stretch_of,
    view_of,
)
from kernels.arcs.potential import ArcDisk
from kernels.disk.elementary import EPSILON, SMALLEST, exponential, logarithm, sine_cosine
from kernels.records import Entry, put, reader, writer
from kernels.types import Longs, Matrix, Table, Vector


class Given(NamedTuple):
    """A state on its rise, natural units.

    stretch, distance: where it is counted from an anchor; tan(theta/2) where it `coasts`. rises: whether theta, as
    the rise sees it, grows. face: -1 where the rise is seen in a mirror, as from the other face. jump: of chi at
    flat, 0 off F; upright: the rise ends at the other flat state. chi_rate, psi_rate, sigma4: as `Rates`. unsure:
    what rounding of the state leaves unknown of its energy. grows: the rate at which a motion leaves an
    equilibrium on which it stands; else 0.
    """

    stretch: float
    distance: float
    coasts: float
    rises: float
    face: float
    jump: float
    upright: float
    chi_rate: float
    psi_rate: float
    sigma4: float
    unsure: float
    grows: float


class Rises(NamedTuple):
    """Rises of n motions: records of `Anchor`, `Stretch`, STRETCHES for each, and `Given`, in flat arrays."""

    anchors: Vector
    stretches: Vector
    given: Vector


class Rise(NamedTuple):
    """What a rise comes to, from the lower turning point to the upper one, natural units.

    time, chi, psi, a1, a2: from one to the other, with half of a jump at flat. since: the time of the state after
    the lower turning point, negative where it falls.
    """

    time: float
    chi: float
    psi: float
    a1: float
    a2: float
    since: float


class PeriodRow(NamedTuple, Generic[Entry]):
    """What a period of a motion comes to from its start, natural units.

    time; chi, psi; a1, a2: the shift of the centre. since: the time of the start after the lower turning point
    nearest to it. time_error, angle_error, path_error: of these.
    """

    time: Entry
    chi: Entry
    psi: Entry
    a1: Entry
    a2: Entry
    since: Entry
    time_error: Entry
    angle_error: Entry
    path_error: Entry


class Seen(NamedTuple):
    """A point of a rise or of a fall, as from the lower turning point between them."""

    q: float
    z: float
    p: float
    ratio: float
    sigma4: float
    chi: float
    psi: float
    a1: float
    a2: float


class Origin(NamedTuple):
    """Where a motion starts: angles and centre; sine and cosine of chi, of a period's, and of half of that."""

    chi: float
    psi: float
    a1: float
    a2: float
    sine: float
    cosine: float
    back_sine: float
    back_cosine: float
    half: float
    half_sine: float
    half_cosine: float


given_of, GIVEN = reader(Given, 1), len(Given._fields)
rise_of, put_rise, RISE = reader(Rise, 1), writer(Rise, 1), len(Rise._fields)
errors_of, put_errors, ERRORS = reader(Errors, 1), writer(Errors, 1), len(Errors._fields)
origin_of, put_origin, ORIGIN = reader(Origin, 1), writer(Origin, 1), len(Origin._fields)
seen_of, put_seen = reader(Seen, N), writer(Seen, N)
_low_of, _piece_of = reader(Low, N), reader(Piece, N)
# Rows of lanes: which piece, the time on the rise, -1 on the fall; Newton's method; what is found; the piece
# itself.
_NUMBER, _TIME, _SIDE, _WANT, _U, _BELOW, _ABOVE, _LEFT = range(0, 8 * N, N)
_SEEN = 8 * N
_HERE = _SEEN + len(Seen._fields) * N
_SERIES = _HERE + HEAD * N
_ROWS = _HERE + WIDE * N
_NEWTON, _ALMOST = 60, 1e-9  # steps, each of which doubles the digits; the last one has them all
FAST = 3.0  # rates (natural units) from which an error of the time is a larger one of angles: in a race
_MOST_GROWN = 100.0  # of an error, by so many powers of e: nothing is known
_HALF_TURNED = 1e-12  # rad: below, periods add up in a straight line
OUT = 13  # what is found at a time: a state, and the errors of its time, angles and centre


@device
def clenshaw(P: Vector, at: int, v: float, odd: bool) -> float:
    """A series of a piece in the pool."""
    x, b1, b2 = 4.0 * v - 2.0, 0.0, 0.0
    for k in range(N - 1, 0, -1):
        b1, b2 = (P[at + k] - b2) + x * b1, b1
    b0 = (P[at] - b2) + x * b1
    return math.sqrt(v) * (b0 - b1) if odd else b0 - 0.5 * x * b1


class Pool(NamedTuple):
    """Pieces of N motions; in which order they come on their rises, at which times, and where each rise begins."""

    pieces: Vector
    order: Longs
    times: Vector
    first: Longs


@device
def time_of(given: Given, piece: Piece, P: Vector, at: int) -> float:
    """The time between the low end of a piece and a state, NaN where that is elsewhere."""
    d, part = given.distance, math.nan
    here = piece.stretch == given.stretch
    if here & (piece.kind == COAST) & (given.coasts == 1.0):
        part = 2.0 * (d - piece.start) / piece.length
    within = (d >= piece.start) & (d <= (piece.start + piece.length) * (1.0 + EPSILON))
    if here & (piece.kind != COAST) & (given.coasts == 0.0) & within:
        v = min((d - piece.start) / piece.length, 1.0)
        part = clenshaw(P, at + HEAD + TIME, v, piece.kind == TURN)
    return piece.sign * part


@subroutine
def assemble(pool: Pool, low: int, high: int, given: Given) -> Rise:
    """Where every piece of a rise begins, and what the rise comes to."""
    P, half_jump = pool.pieces, 0.5 * given.jump
    t, chi, psi, x, y, since = 0.0, half_jump, half_jump, 0.0, 0.0, math.nan
    for k in range(low, high):
        at = pool.order[k] * WIDE
        piece = piece_of(P, at + LOW, 0)
        odd, up = piece.kind == TURN, piece.sign > 0.0
        dx, dy = clenshaw(P, at + HEAD + ACROSS, 1.0, False), clenshaw(P, at + HEAD + ALONG, 1.0, odd)
        t1, chi1 = t + piece.span, chi + clenshaw(P, at + HEAD + CHI, 1.0, odd)
        psi1 = psi + clenshaw(P, at + HEAD + PSI, 1.0, odd)
        s, c = sine_cosine(chi if up else chi1)
        x1, y1 = x + c * dx - s * dy, y + s * dx + c * dy
        put_low(P, at, 0, Low(t, chi, psi, x, y) if up else Low(t1, chi1, psi1, x1, y1))
        part, pool.times[k] = time_of(given, piece, P, at), t
        since = (t if up else t1) + part if part == part else since
        t, chi, psi, x, y = t1, chi1, psi1, x1, y1
    if given.upright == 1.0:
        chi, psi = chi - half_jump, psi + half_jump
    since *= 1.0 if given.rises == 1.0 else -1.0
    return Rise(t, chi, psi, x, y, since)


@subroutine
def locate(L: Vector, i: int, pool: Pool, j: int, half: float, tau: float) -> None:
    """Into lane i: the time tau, of either sign, since the nearest lower turning point of motion j."""
    low, high, t = pool.first[j], pool.first[j + 1], min(abs(tau), half)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if pool.times[middle] <= t else (low, middle)
    L[_TIME + i], L[_SIDE + i] = t, 1.0 if tau >= 0.0 else -1.0
    number = pool.order[low]
    if L[_NUMBER + i] != number:
        L[_NUMBER + i] = number
        for k in range(WIDE):
            L[_HERE + k * N + i] = pool.pieces[number * WIDE + k]


@subroutine
def begin(L: Vector) -> None:
    """A first guess of where on its piece each lane is: as if the slope of the time grew exponentially."""
    for i in range(N):
        low, piece = _low_of(L, _HERE, i), _piece_of(L, _HERE + LOW * N, i)
        want = min(max(piece.sign * (L[_TIME + i] - low.time), 0.0), piece.span)
        y = want / piece.span
        u = logarithm(1.0 + piece.grown * y) / piece.bend if abs(piece.bend) > 1e-3 else y
        u = want / piece.slope if (piece.kind == TURN) & (y < 1e-3) else u
        L[_WANT + i], L[_U + i], L[_BELOW + i], L[_ABOVE + i] = want, min(max(u, 0.0), 1.0), 0.0, 1.0
        L[_LEFT + i] = 0.0 if piece.kind == COAST else 1.0


@subroutine
def newton(L: Vector) -> bool:
    """A step of Newton's method in sqrt(v) or v, within brackets; returns whether a lane still moves."""
    for i in range(N):
        u, odd = L[_U + i], L[_HERE + LOW * N + i] == TURN
        v = u * u if odd else u
        x, b1, b2, d1, d2, at = 4.0 * v - 2.0, 0.0, 0.0, 0.0, 0.0, _SERIES + TIME * N + i
        for k in range(N - 1, N // 2, -1):  # in two loops, short enough to unroll
            d1, d2 = (b1 - d2) + x * d1, d1
            b1, b2 = (L[at + k * N] - b2) + x * b1, b1
        for k in range(N // 2, 0, -1):
            d1, d2 = (b1 - d2) + x * d1, d1
            b1, b2 = (L[at + k * N] - b2) + x * b1, b1
        d0, b0 = (b1 - d2) + x * d1, (L[at] - b2) + x * b1
        off = (u * (b0 - b1) if odd else b0 - 0.5 * x * b1) - L[_WANT + i]
        slope = (b0 - b1) + 8.0 * v * (d0 - d1) if odd else 4.0 * d0 - 2.0 * b1 - 2.0 * x * d1
        low, high = u if off < 0.0 else L[_BELOW + i], L[_ABOVE + i] if off < 0.0 else u
        new = u - off / slope
        new = new if (new >= low) & (new <= high) else 0.5 * (low + high)
        active = L[_LEFT + i] > 0.0
        L[_BELOW + i], L[_ABOVE + i], L[_U + i] = low, high, new if active else u
        L[_LEFT + i] = 1.0 if active & (abs(new - u) > _ALMOST * new) else 0.0
    left = 0.0
    for i in range(N):
        left += L[_LEFT + i]
    return left > 0.0


@device
def value(L: Vector, series: int, x: float, u: float, odd: bool, i: int) -> float:
    """A series of the piece in lane i."""
    at, b1, b2 = _SERIES + series * N + i, 0.0, 0.0
    for k in range(N - 1, N // 2, -1):
        b1, b2 = (L[at + k * N] - b2) + x * b1, b1
    for k in range(N // 2, 0, -1):
        b1, b2 = (L[at + k * N] - b2) + x * b1, b1
    b0 = (L[at] - b2) + x * b1
    return u * (b0 - b1) if odd else b0 - 0.5 * x * b1


@subroutine
def read(L: Vector) -> None:
    """What all lanes see; on the fall as the rise run backwards, mirrored at the lower turning point."""
    begin(L)
    for _ in range(_NEWTON):
        if not newton(L):
            break
    for i in range(N):
        low, piece, u, side = _low_of(L, _HERE, i), _piece_of(L, _HERE + LOW * N, i), L[_U + i], L[_SIDE + i]
        odd, coasts, sign = piece.kind == TURN, piece.kind == COAST, piece.sign
        v = u * u if odd else u
        x = 4.0 * v - 2.0
        dx, dy = value(L, ACROSS, x, u, False, i), value(L, ALONG, x, u, odd, i)
        s, c = sine_cosine(low.chi)
        grown, _ = exponential(0.0 if coasts else sign * piece.face * (piece.start + piece.length * v))
        coasted = piece.start + 0.5 * piece.length * sign * (L[_TIME + i] - low.time)
        r = coasted if coasts else piece.r * grown
        inv = 1.0 / (1.0 + r * r)
        ratio = value(L, RATIO, x, u, False, i)
        put_seen(L, _SEEN, i, Seen(
            2.0 * r * inv,
            piece.face * (1.0 - r) * (1.0 + r) * inv,
            side * value(L, SPEED, x, u, False, i) * (u if odd else 1.0),
            ratio * (piece.start / r) if coasts & (piece.start > 0.0) else ratio,
            value(L, SIGMA4, x, u, False, i),
            side * (low.chi + sign * value(L, CHI, x, u, odd, i)),
            side * (low.psi + sign * value(L, PSI, x, u, odd, i)),
            low.a1 + sign * (c * dx - s * dy),
            side * (low.a2 + sign * (s * dx + c * dy)),
        ))  # fmt: skip


@device
def origin(at: Seen, back: float) -> Origin:
    """The start of a motion that is seen there; back: by how much a period turns the picture."""
    half = 0.5 * math.atan2(math.sin(back), math.cos(back))
    turned = math.sin(at.chi), math.cos(at.chi), math.sin(back), math.cos(back)
    return Origin(
        at.chi,
        at.psi,
        at.a1,
        at.a2,
        turned[0],
        turned[1],
        turned[2],
        turned[3],
        half,
        math.sin(half),
        math.cos(half),
    )


class When(NamedTuple):
    """A time after the start; periods: how many there are between the lower turning points nearest to both.

    since: the time as it was given; passed: the periods between the lower turning point since which it counts and
    the one that is nearest, or NaN.
    """

    time: float
    periods: float
    since: float
    passed: float


@device
def when(t: float, low: float, rise: Rise) -> When:
    """A time that counts since the start, or since a lower turning point."""
    counted = low == low
    whole = math.floor(0.5 * (t + (0.0 if counted else rise.since)) / rise.time + 0.5)
    time = (t - rise.since) + 2.0 * rise.time * low if counted else t
    return When(time, whole + (low if counted else 0.0), t, whole if counted else math.nan)


@subroutine
def put_motion(
    out: Vector, at: Seen, at_time: When, start: Origin, rise: Rise, errors: Errors, given: Given
) -> None:
    """A point as its motion has it, so many periods after the start: each turns the picture and moves it along."""
    count = at_time.periods
    x, y, own = rise.a1, rise.a2, given.face
    sn, cn, gx, gy, wide = 0.0, 1.0, -start.a1, -start.a2, 0.0
    if count != 0.0:
        sn, cn = math.sin(count * start.half), math.cos(count * start.half)
        many = sn / start.half_sine if abs(start.half_sine) > _HALF_TURNED else count
        mx = many * (cn * start.half_cosine + sn * start.half_sine)
        my = many * (sn * start.half_cosine - cn * start.half_sine)
        dx = x - start.back_cosine * x - start.back_sine * y
        dy = y - start.back_sine * x + start.back_cosine * y
        gx, gy = gx + mx * dx - my * dy, gy + my * dx + mx * dy
        wide = math.sqrt(dx * dx + dy * dy) * min(abs(count), 1.0 / abs(start.half_sine))  # of all periods
        sn, cn = 2.0 * sn * cn, (cn - sn) * (cn + sn)
    gx, gy = gx + cn * at.a1 - sn * at.a2, gy + sn * at.a1 + cn * at.a2
    chi, psi = at.chi - start.chi + 2.0 * rise.chi * count, at.psi - start.psi + 2.0 * rise.psi * count
    out[0], out[1], out[2], out[3], out[4] = at.q, own * at.z, own * at.p, at.ratio, own * at.sigma4
    out[5], out[6], out[7] = at_time.time, chi, own * psi
    out[8] = own * (start.cosine * gx + start.sine * gy)
    out[9] = own * (start.cosine * gy - start.sine * gx)
    # Errors of whole rises, and of the place of the state, add up; within a piece there is that of its series.
    # What a delay changes is what goes on otherwise than at the start, but an error of the time itself changes
    # all.
    rises = abs(at_time.time) / rise.time + 1.0
    delay, clock = rises * errors.delay, rises * errors.time + errors.time_within
    clock += EPSILON * (abs(at_time.time) + abs(rise.since))
    if (
        at_time.passed == at_time.passed
    ):  # since a lower turning point: there series know the time relative to itself
        part = abs(at_time.since) / rise.time
        delay, clock = part * errors.delay, part * errors.time + (TAILS * LEFT_OUT + EPSILON) * abs(at_time.since)
    chi_rate = at.ratio / max(at.q, SMALLEST)
    turned = abs(chi_rate - given.chi_rate) + abs(at.z * chi_rate - at.sigma4 - given.psi_rate)
    grown = math.exp(min(given.grows * abs(at_time.time), _MOST_GROWN))
    angle = rises * errors.angle + errors.angle_within + 4.0 * EPSILON * (abs(chi) + abs(psi) + grown)
    out[10] = delay * turned + clock * abs(chi_rate)
    out[11] = angle + delay * (abs(at.p) + min(turned, FAST)) + clock * (abs(at.p) + FAST)
    moved = rises * (errors.path + errors.way * errors.angle_within) + errors.path_within
    away = abs(at.sigma4 - given.sigma4) + abs(at.p) + min(turned, FAST) * (1.0 + abs(gx) + abs(gy))
    out[12] = delay * away + clock * (abs(at.sigma4) + abs(at.p)) + moved + (wide + abs(gx) + abs(gy)) * angle


@subroutine
def lay_rise(W: Vector, rises: Rises, g: int, j: int, pool: Pool, E: Vector, path: bool, disk: ArcDisk) -> Rise:
    """The pieces of rise g into the pool as those of motion j, behind those of the ones before."""
    given, before, errors = (
        given_of(rises.given, g * GIVEN, 0),
        pool.first[j],
        Errors(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    )
    n, rates = before, Rates(given.chi_rate, given.psi_rate, given.sigma4)
    for number in range(STRETCHES):
        stretch, start = stretch_of(rises.stretches, (g * STRETCHES + number) * STRETCH, 0), n
        if n >= 0 and stretch.length + stretch.coast > 0.0:
            view = view_of(rises.anchors, stretch, number, rates, given.unsure, disk.body)
            n, errors = lay(W, view, number, pool.pieces, n, before + MOST - 1, path, errors, disk)
            for k in range(start, n):
                pool.order[k] = k if number % 2 == 0 else n - 1 - (k - start)  # laid from its end
    pool.first[j + 1] = max(n, before)
    put_errors(E, j * ERRORS, 0, errors)
    return assemble(pool, before, pool.first[j + 1], given)


@device
def entry(table: Matrix, row: int, column: int) -> float:
    """An entry of a table whose rows, or columns, may all be one."""
    return table[min(row, table.shape[0] - 1), min(column, table.shape[1] - 1)]


@maker
def make_pool() -> Pool:
    """Room for the pieces of N motions; memory that nothing is written to is not taken."""
    most = N * MOST
    return Pool(np.empty(most * WIDE), np.empty(most, np.int64), np.empty(most), np.zeros(N + 1, np.int64))


@kernel
def motion_batch(
    rises: Rises, times: Matrix, lows: Matrix, path: bool, disk: ArcDisk, found: Matrix, out: Table
) -> None:
    """Motions at times -> found (9, n), rows as PeriodRow; out (n, nt, OUT). NaN of motions without pieces.

    times, lows: (n or 1, nt or 1); lows: the number of the lower turning point since which a time counts, 0 the
    one nearest to the state, or NaN: it counts since the state.
    """
    W, L, pool, n, m = np.zeros(ROOM), np.zeros(_ROWS), make_pool(), out.shape[0], out.shape[1]
    R, E, S = np.zeros(N * RISE), np.zeros(N * ERRORS), np.zeros(N * ORIGIN)
    one = np.zeros(OUT)
    prepare(W)
    for block in range(0, n, N):
        count = min(N, n - block)
        L[_NUMBER : _NUMBER + N] = -1.0
        for j in range(count):
            rise = lay_rise(W, rises, block + j, j, pool, E, path, disk)
            put_rise(R, j * RISE, 0, rise)
            if pool.first[j + 1] > pool.first[j]:
                locate(L, j, pool, j, rise.time, rise.since)
        read(L)
        for j in range(count):
            rise, errors, seen = rise_of(R, j * RISE, 0), errors_of(E, j * ERRORS, 0), seen_of(L, _SEEN, j)
            start, given = origin(seen, 2.0 * rise.chi), given_of(rises.given, (block + j) * GIVEN, 0)
            put_origin(S, j * ORIGIN, 0, start)
            put_motion(one, seen, When(2.0 * rise.time, 1.0, 0.0, math.nan), start, rise, errors, given)
            late, chi_rate = 2.0 * (errors.delay + errors.time), seen.ratio / max(seen.q, SMALLEST)
            fast = abs(chi_rate) + abs(seen.z * chi_rate - seen.sigma4)
            period = PeriodRow(
                one[5] if pool.first[j + 1] > pool.first[j] else math.nan,
                one[6],
                one[7],
                one[8],
                one[9],
                rise.since,
                late,
                one[11] + fast * late,
                one[12] + (abs(seen.sigma4) + abs(seen.p)) * late,
            )
            put(period, found, block + j)
        for pair in range(0, count * m, N):
            for i in range(min(N, count * m - pair)):
                j, k = (pair + i) // m, (pair + i) % m
                if pool.first[j + 1] > pool.first[j]:
                    rise = rise_of(R, j * RISE, 0)
                    t, low = entry(times, block + j, k), entry(lows, block + j, k)
                    at, since = when(t, low, rise), rise.since if math.isnan(low) else 0.0
                    whole = at.periods if math.isnan(low) else at.passed
                    locate(L, i, pool, j, rise.time, (t - 2.0 * rise.time * whole) + since)
            read(L)
            for i in range(min(N, count * m - pair)):
                j, k = (pair + i) // m, (pair + i) % m
                row = out[block + j, k]
                row[:] = math.nan
                if pool.first[j + 1] > pool.first[j]:
                    rise, errors = rise_of(R, j * RISE, 0), errors_of(E, j * ERRORS, 0)
                    given, start = given_of(rises.given, (block + j) * GIVEN, 0), origin_of(S, j * ORIGIN, 0)
                    t, low = entry(times, block + j, k), entry(lows, block + j, k)
                    put_motion(row, seen_of(L, _SEEN, i), when(t, low, rise), start, rise, errors, given)


@kernel
def course_batch(rises: Rises, disk: ArcDisk, first: Longs, out: Matrix) -> None:
    """Times and chi at N + 1 points of each piece, from the lower turning point on, dense where a motion is fast.

    out (2, room for n * MOST * (N + 1)): rows time and chi; first (n + 1): where each rise begins.
    """
    W, pool, E, n = np.zeros(ROOM), make_pool(), np.zeros(ERRORS), 0
    prepare(W)
    for g in range(first.size - 1):
        lay_rise(W, rises, g, 0, pool, E, False, disk)
        for place in range(pool.first[1]):
            at = pool.order[place] * WIDE
            low, piece = low_of(pool.pieces, at, 0), piece_of(pool.pieces, at + LOW, 0)
            odd = piece.kind == TURN
            for k in range(N + 1):
                u = k / N if piece.sign > 0.0 else 1.0 - k / N
                v = u * u if odd else u
                time = piece.span * u if piece.kind == COAST else clenshaw(pool.pieces, at + HEAD + TIME, v, odd)
                out[0, n] = low.time + piece.sign * time
                out[1, n] = low.chi + piece.sign * clenshaw(pool.pieces, at + HEAD + CHI, v, odd)
                n += 1
        first[g + 1] = n

"""Where motions turn back, in lanes: both turning points, or that of either face where the vertical is crossed.

The tilts of `leg_tables` bracket them. Newton's method then looks for the zero of h^2 (E - V), which is nearly
linear in h^2 beside the wall that keeps a motion from flat; what leaves the bracket is bisected. A motion that a
barrier between two tilts may stop, and one that is not settled soon, is left to `orbits`.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel
from kernels.disk.body import Body, Disk
from kernels.disk.elementary import log_ratio
from kernels.disk.falling import contracted_potential_above_flat
from kernels.disk.polynomials import long_horner
from kernels.disk.rows import Entry, put
from kernels.integrals.leg_tables import LegTables, Tilt, Wide, tilt
from kernels.integrals.near_flat import Near, Smooth, joined, slope_of
from kernels.integrals.point import VERTICAL, Motion, Orbits
from kernels.integrals.sums import LANES
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_ROUNDS = 14  # of Newton's method
_SETTLED = 1e-8  # the relative step after which the next is rounding
AT_VERTICAL = 8.0 * 2.2e-16  # of h
_HIDDEN = 64.0 * 2.2e-16  # rounding of E - V, for each unit of its terms
_LARGEST_STEP = 1.0 / 3.0  # (h' - h)/(h' + h): as far as `log_ratio` goes

ROWS = 27
(
    # the sample: its constants, tilt, speed and cos(tilt); LEVEL, SLOPE, KINETIC: E - V_0, h dV/dh and
    # M theta-dot^2/2 there
    X, NEAR, FAR, H0, RATE, UP, LEVEL, SLOPE, KINETIC,
    # at the tilt tried before: E - V and dV/dtheta; MOVING: E - V at the vertical; CHECK: 0 where all is
    # well; CROSSES: 1 where nothing bars the vertical
    GAP, DV, MOVING, CHECK, CROSSES,
    # fields of Bracket, for the turning point inside and for the other one; Y of the latter
    INSIDE, AT_INSIDE, OUTSIDE, AT_OUTSIDE, BARRED, AT_BARRED, OPEN, AT_OPEN, Y,
    # of Newton's method; WAY: +1 where V is to fall with h at the turning point, -1 where it is to rise
    H, LOG_H, STEP, WAY,
) = range(ROWS)  # fmt: skip


class EndRow(NamedTuple, Generic[Entry]):
    """Where a motion turns back.

    level: E - V_0; moving: E - V at the vertical, NaN where it does not come there; here: h flattest on this face;
    outer: h of the other end, VERTICAL or a turning point; there: h flattest on the other face, if ever.
    """

    level: Entry
    moving: Entry
    here: Entry
    outer: Entry
    there: Entry


class Ends(NamedTuple):
    """Such rows of samples (n)."""

    level: Vector
    moving: Vector
    here: Vector
    outer: Vector
    there: Vector


class Bracket(NamedTuple):
    """Rows: a tilt where E < V, one where E >= V, and h^2 (E - V) there."""

    barred: int
    at_barred: int
    open: int
    at_open: int


INNER = Bracket(INSIDE, AT_INSIDE, OUTSIDE, AT_OUTSIDE)
OTHER = Bracket(BARRED, AT_BARRED, OPEN, AT_OPEN)


@contracted_device
def anywhere(h: float, log_h: float, motion: Motion, b: Body, wide: Wide) -> Near:
    """The motion at any h up to the vertical."""
    S = 0.5 * h * h
    t = 2.0 * S - 1.0
    excess = long_horner(wide.excess, t)
    f = Smooth(
        g=long_horner(wide.rho_over_S, t),
        drho=1.0 + S * excess,
        v=long_horner(wide.v, t),
        dv=long_horner(wide.dv, t),
        excess=excess,
        inv_shape=1.0 / math.sqrt(1.0 - 0.5 * S),
    )
    return joined(h, 1.0 / h, log_h, f, motion, b)


@contracted_device
def at_tilt(at: Tilt, X: float, Y: float, b: Body) -> tuple[float, float]:
    """(V - V_0, dV/dtheta) of a motion at a tilt of the table."""
    ratio, rise, flat = X * at.ratio_x + Y * at.ratio_y, X * at.rise_x + Y * at.rise_y, X / b.k
    gyration = 0.5 * b.I1 * ratio * ratio
    V, _spin = contracted_potential_above_flat(gyration, rise, 2.0 * flat, at.height, b)
    return V, b.J * ratio * (flat + rise) + at.z - 2.0 * gyration * at.z / at.height


@contracted_device
def barrier_between(gap: float, dV: float, next_gap: float, next_dV: float, apart: float) -> bool:
    """Whether V may pass the level between two tilts where it does not: where the tangents meet, it would."""
    rises = (gap >= 0.0) & (next_gap >= 0.0) & (dV > 0.0) & (next_dV < 0.0)
    along = (gap - next_gap - next_dV * apart) / ((dV - next_dV) if rises else 1.0)
    return rises & (gap - dV * along <= 0.0)


@contracted_subroutine
def begin(W: Vector, wide: Wide, b: Body) -> None:
    """LEVEL and SLOPE at the states, and brackets that reach from there to flat; CHECK becomes 0."""
    for i in range(LANES):
        W[LOG_H * LANES + i] = math.log(W[H0 * LANES + i])
    for i in range(LANES):
        x, y, h, rate = W[X * LANES + i], W[NEAR * LANES + i], W[H0 * LANES + i], W[RATE * LANES + i]
        at = anywhere(h, W[LOG_H * LANES + i], Motion(x, y, 0.0), b, wide)
        kinetic = 0.5 * b.M * rate * rate
        W[LEVEL * LANES + i], W[SLOPE * LANES + i] = kinetic + at.V, slope_of(h, at, x, b)
        W[KINETIC * LANES + i], W[CHECK * LANES + i] = kinetic, 0.0
        W[INSIDE * LANES + i], W[AT_INSIDE * LANES + i] = 0.0, 0.0
        W[OUTSIDE * LANES + i], W[AT_OUTSIDE * LANES + i] = h, h * h * kinetic
        W[BARRED * LANES + i], W[OPEN * LANES + i] = 0.0, h
        W[AT_BARRED * LANES + i], W[AT_OPEN * LANES + i] = 0.0, h * h * kinetic


@contracted_subroutine
def look_around(W: Vector, tilts: Matrix, b: Body) -> None:
    """Brackets on both sides of the states, BARRED being 0 where nothing bars the vertical; MOVING there."""
    before = at = tilt(tilts, 0)
    for k in range(tilts.shape[1]):
        at = tilt(tilts, k)
        u = at.h * at.h
        for i in range(LANES):
            h0, level, kinetic = W[H0 * LANES + i], W[LEVEL * LANES + i], W[KINETIC * LANES + i]
            V, dV = at_tilt(at, W[X * LANES + i], W[NEAR * LANES + i], b)
            gap, last_gap = level - V, W[GAP * LANES + i]
            barrier = (k > 0) & barrier_between(last_gap, W[DV * LANES + i], gap, dV, at.theta - before.theta)
            W[CHECK * LANES + i] = 1.0 if barrier else W[CHECK * LANES + i]
            below, bars = at.h < h0, gap < 0.0
            hit, first = below & bars, below & (not bars) & (W[OUTSIDE * LANES + i] >= h0)
            W[INSIDE * LANES + i] = at.h if hit else W[INSIDE * LANES + i]
            W[AT_INSIDE * LANES + i] = u * gap if hit else W[AT_INSIDE * LANES + i]
            W[OUTSIDE * LANES + i] = h0 if hit else at.h if first else W[OUTSIDE * LANES + i]
            at_state = h0 * h0 * kinetic
            W[AT_OUTSIDE * LANES + i] = at_state if hit else u * gap if first else W[AT_OUTSIDE * LANES + i]
            hit = (at.h > h0) & bars & (W[BARRED * LANES + i] == 0.0)
            passed = hit & (k > 0) & (before.h > h0)
            W[BARRED * LANES + i] = at.h if hit else W[BARRED * LANES + i]
            W[AT_BARRED * LANES + i] = u * gap if hit else W[AT_BARRED * LANES + i]
            W[OPEN * LANES + i] = before.h if passed else W[OPEN * LANES + i]
            W[AT_OPEN * LANES + i] = before.h * before.h * last_gap if passed else W[AT_OPEN * LANES + i]
            W[GAP * LANES + i], W[DV * LANES + i] = gap, dV
        before = at
    for i in range(LANES):
        x, y, gap = W[X * LANES + i], W[NEAR * LANES + i], W[GAP * LANES + i]
        upright = W[H0 * LANES + i] >= VERTICAL - AT_VERTICAL
        # Beside the vertical V falls by half of h dV/dh times cos(tilt).
        beside = W[KINETIC * LANES + i] - 0.5 * W[UP * LANES + i] * W[SLOPE * LANES + i]
        W[MOVING * LANES + i] = beside if upright else gap
        ratio, rise = x * at.ratio_x + y * at.ratio_y, x * at.rise_x + y * at.rise_y
        terms = 0.5 * b.I1 * ratio * ratio + 0.5 * b.J * abs(rise) * (2.0 * abs(x / b.k) + abs(rise)) + 1.0
        # Whether the vertical is crossed is told by others where this difference cannot.
        hidden = abs(gap) <= _HIDDEN * (terms + abs(W[LEVEL * LANES + i]) + W[KINETIC * LANES + i])
        W[CHECK * LANES + i] = 1.0 if hidden else W[CHECK * LANES + i]


@contracted_subroutine
def look_beyond(W: Vector, tilts: Matrix, b: Body) -> None:
    """Where the vertical is crossed, the bracket OTHER on the other face, and Y there."""
    before = tilt(tilts, 0)
    for i in range(LANES):
        crosses = W[BARRED * LANES + i] == 0.0
        W[CROSSES * LANES + i] = 1.0 if crosses else 0.0
        W[Y * LANES + i] = W[FAR * LANES + i] if crosses else W[NEAR * LANES + i]
    for k in range(tilts.shape[1]):
        at = tilt(tilts, k)
        u = at.h * at.h
        for i in range(LANES):
            crosses = W[CROSSES * LANES + i] == 1.0
            V, dV = at_tilt(at, W[X * LANES + i], W[FAR * LANES + i], b)
            gap = W[LEVEL * LANES + i] - V
            barrier = barrier_between(W[GAP * LANES + i], W[DV * LANES + i], gap, dV, at.theta - before.theta)
            W[CHECK * LANES + i] = 1.0 if crosses & (k > 0) & barrier else W[CHECK * LANES + i]
            bars = gap < 0.0
            hit = crosses & bars
            # The first open tilt after one that bars; the last such pair is the nearest to the vertical.
            first = crosses & (not bars) & ((k == 0) | (W[GAP * LANES + i] < 0.0))
            W[BARRED * LANES + i] = at.h if hit else W[BARRED * LANES + i]
            W[AT_BARRED * LANES + i] = u * gap if hit else W[AT_BARRED * LANES + i]
            W[OPEN * LANES + i] = at.h if first else W[OPEN * LANES + i]
            W[AT_OPEN * LANES + i] = u * gap if first else W[AT_OPEN * LANES + i]
            W[GAP * LANES + i], W[DV * LANES + i] = gap, dV
        before = at


@contracted_subroutine
def guess(W: Vector, bracket: Bracket, y_row: int, b: Body) -> None:
    """H between the ends of a bracket."""
    for i in range(LANES):
        barred, opened = W[bracket.barred * LANES + i], W[bracket.open * LANES + i]
        minus, plus = -W[bracket.at_barred * LANES + i], W[bracket.at_open * LANES + i]
        u_open, size = opened * opened, abs(W[y_row * LANES + i])
        share = minus / (minus + plus if minus + plus > 0.0 else 1.0)
        u = barred * barred + (u_open - barred * barred) * share
        # At flat itself h^2 (E - V) is -I1 Y^2/2, whose square root does not underflow.
        wall = 0.5 * b.I1
        near = size * math.sqrt(wall / ((plus + wall * size * size) / u_open))
        h = near if barred == 0.0 else math.sqrt(u)
        # From a state that rests at the other turning point this one lies further on.
        at_state = (opened == W[H0 * LANES + i]) & (W[WAY * LANES + i] * W[SLOPE * LANES + i] > 0.0)
        W[H * LANES + i] = 0.5 * (barred + opened) if at_state else h
    for i in range(LANES):
        W[LOG_H * LANES + i] = math.log(W[H * LANES + i])


@contracted_subroutine
def settle(W: Vector, bracket: Bracket, y_row: int, wide: Wide, b: Body) -> None:
    """The turning point in a bracket, from a guess in H; CHECK is raised where it is not found.

    Lanes that are settled stay as they are, so that none depends on its neighbours.
    """
    for i in range(LANES):
        W[STEP * LANES + i] = 1.0
    for _ in range(_ROUNDS):
        worst = 0.0
        for i in range(LANES):
            h, log_h, x = W[H * LANES + i], W[LOG_H * LANES + i], W[X * LANES + i]
            level, barred, opened = (
                W[LEVEL * LANES + i],
                W[bracket.barred * LANES + i],
                W[bracket.open * LANES + i],
            )
            at = anywhere(h, log_h, Motion(x, W[y_row * LANES + i], level), b, wide)
            gap, slope = level - at.V, slope_of(h, at, x, b)
            barred, opened = h if gap < 0.0 else barred, opened if gap < 0.0 else h
            share = slope / (slope - 2.0 * gap)
            better = h * math.sqrt(share if share > 0.0 else 0.0)
            inside = (better - barred) * (better - opened) <= 0.0
            newton = (better - h) / (better + h)
            better = better if inside else 0.5 * (barred + opened)
            step = (better - h) / (better + h)
            # So short a bisection is not yet at rounding; Newton's step is, if rounding led it out of the bracket.
            short = (not inside) & (abs(step) < _SETTLED)
            step = newton if short & (abs(newton) < _SETTLED) else step
            right = (W[WAY * LANES + i] * slope < 0.0) & ((not short) | (abs(newton) < _SETTLED))
            step = max(min(step, _LARGEST_STEP), -_LARGEST_STEP)
            settled = W[STEP * LANES + i] < _SETTLED
            W[H * LANES + i] = h if settled else h * (1.0 + step) / (1.0 - step)
            W[LOG_H * LANES + i] = log_h if settled else log_h + log_ratio(step)
            W[bracket.barred * LANES + i], W[bracket.open * LANES + i] = barred, opened
            W[STEP * LANES + i] = W[STEP * LANES + i] if settled else abs(step) if right else 1.0
        for i in range(LANES):
            waited = W[STEP * LANES + i] if W[CHECK * LANES + i] == 0.0 else 0.0
            worst = waited if waited > worst else worst
        if worst < _SETTLED:
            break
    for i in range(LANES):
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if W[STEP * LANES + i] < _SETTLED else 1.0


@contracted_subroutine
def fill(W: Vector, first: int, n: int, orbits: Orbits, b: Body) -> None:
    """States from `first` on into lanes; a lane without one is given numbers that are not used."""
    for i in range(LANES):
        j = first + i
        W[X * LANES + i] = orbits.sigma3_bar[j] / b.r0 if j < n else 0.0
        W[NEAR * LANES + i] = orbits.near[j] / b.I1 if j < n else 1.0
        W[FAR * LANES + i] = orbits.far[j] / b.I1 if j < n else 1.0
        W[H0 * LANES + i] = orbits.h[j] if j < n else 1.0
        W[RATE * LANES + i] = orbits.rate[j] if j < n else 1.0
        W[UP * LANES + i] = orbits.z[j] if j < n else 0.5


@contracted_subroutine
def find_ends(W: Vector, of_body: LegTables, b: Body) -> None:
    """Both ends of the motions in the lanes: H of the inner one into INSIDE, of the other one into BARRED."""
    begin(W, of_body.wide, b)
    look_around(W, of_body.tilts, b)
    look_beyond(W, of_body.tilts, b)
    for i in range(LANES):
        W[WAY * LANES + i] = 1.0
    guess(W, INNER, NEAR, b)
    settle(W, INNER, NEAR, of_body.wide, b)
    for i in range(LANES):
        W[INSIDE * LANES + i] = W[H * LANES + i]
        W[WAY * LANES + i] = 1.0 if W[CROSSES * LANES + i] == 1.0 else -1.0
    guess(W, OTHER, Y, b)
    settle(W, OTHER, Y, of_body.wide, b)
    for i in range(LANES):
        W[BARRED * LANES + i] = W[H * LANES + i]
        stands = (W[CROSSES * LANES + i] == 1.0) & (not W[MOVING * LANES + i] > 0.0)
        W[CHECK * LANES + i] = 1.0 if stands else W[CHECK * LANES + i]


@kernel
def end_batch(orbits: Orbits, of_body: LegTables, disk: Disk, out: Matrix, status: Codes) -> None:
    """The ends of the motion of every sample -> out (5, n), rows as EndRow; NaN where lanes do not find them.

    status (n): samples that come in as not OK are skipped.
    """
    b, n = disk.body, status.size
    W = np.ones(ROWS * LANES)
    for first in range(0, n, LANES):
        fill(W, first, n, orbits, b)
        find_ends(W, of_body, b)
        for j in range(first, min(first + LANES, n)):
            i = j - first
            out[:, j] = math.nan
            if status[j] != _OK or W[CHECK * LANES + i] != 0.0:
                continue
            crosses, other = W[CROSSES * LANES + i] == 1.0, W[BARRED * LANES + i]
            ends = EndRow(
                level=W[LEVEL * LANES + i],
                moving=W[MOVING * LANES + i] if crosses else math.nan,
                here=W[INSIDE * LANES + i],
                outer=VERTICAL if crosses else other,
                there=other if crosses else math.nan,
            )
            put(ends, out, j)

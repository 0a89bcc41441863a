"""Ways between a turning point and an end, in lanes, by one panel of few nodes: what whole motions are made of.

A leg goes from the turning point h_m to a tilt h_e: the vertical, the other turning point, or where a state is.
With h = h_m cosh y and y = y_low + reach sin(phi) the square roots at both turning points are gone, and one beyond
h_e, to which the motion would go on, is a little further in phi. The race is taken out in closed form as in
`quadrature`. The integrands are even in phi, so that the positive half of a symmetric rule serves: five nodes at
1e-2, ten at 1e-6. The last Legendre coefficients tell the error, as in `sums`; rounding in E - V is counted
at every node. Legs that are not known well enough wait for a larger rule, and at last for `orbits`.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.elementary import DEEPEST, cosine, exp_fall, log_ratio, sine
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import Entry, put
from kernels.integrals import leg_tables
from kernels.integrals.ends import Ends, anywhere
from kernels.integrals.leg_errors import (
    ANGLE,
    BELOW,
    BESIDE_TURN,
    CAP,
    CLOSED,
    FURTHER,
    H_BEYOND,
    H_END,
    H_TURN,
    LOG_CAP,
    LOG_END,
    LOG_TURN,
    MOVING,
    RACE,
    REACH,
    ROUNDING,
    ROWS,
    SINE_END,
    SLOW,
    TURN2,
    Y_END,
    beside_turn,
    slowness,
    tell_errors,
    tell_thin,
    tell_turn,
)
from kernels.integrals.leg_tables import LegTables, Wide
from kernels.integrals.near_flat import Near, slope_of
from kernels.integrals.point import VERTICAL, Motion, Orbits
from kernels.integrals.quadrature import FLOOR, PassageRow
from kernels.integrals.sums import (
    ANGLE_ERROR,
    CHECK,
    CHI,
    ERRORS,
    LANES,
    LEAST,
    LEVEL,
    NOISE,
    OF_CHI,
    OF_REST,
    OF_TIME,
    PSI,
    SUMS,
    TAILS,
    TIME,
    TIME_ERROR,
    X,
    Y,
    clear,
    finish,
    gather,
    keep_least,
)
from kernels.integrals.wobbles import NOT_THERE
from kernels.types import Longs, Matrix, Vector

HERE, THERE, LEAD = 0, 1, 2  # kinds of legs, in blocks of as many as there are samples
_LN2 = math.log(2.0)
_EPSILON = 2.2e-16
_NOISE = 100.0  # units of rounding, as in tabulated
# Units of rounding in E - V, of the sizes of its terms; where a way ends at the vertical, what the constants are
# rounded by is felt as well.
ROUNDING_UNITS, UPRIGHT_UNITS = 4.0, 8.0
_LEFT_OUT = 2.0  # in y: what is below the deepest node falls off like e^y
_DEPTH, _PER_NODE = 2.5, 1.44  # in y: what rules of so many nodes look at
BESIDE = 1e-5  # of h: a state so near an end tells the way there by its rate
_LEAST_LEFT = 1e-300
# Of h at both ends: below the first ratio a way is short, above the others long; rules to leave out or to add.
_SHORTER, _LONGER, _LONGEST = 1.5, 10.0, 1e3
_SAVED, _MORE, _MOST = 3, 2, 3
_FAR = 30.0  # times the accuracy: an error after which the next rule but one is tried


class LegRow(NamedTuple, Generic[Entry]):
    """A leg there and back: increases of chi, psi and time; errors of angles (rad) and of time (relative)."""

    chi: Entry
    psi: Entry
    time: Entry
    angle_error: Entry
    time_error: Entry


@subroutine
def leg_at(legs: Matrix, j: int) -> LegRow[float]:
    """Leg j of such rows."""
    return LegRow(legs[0, j], legs[1, j], legs[2, j], legs[3, j], legs[4, j])


@subroutine
def passages_of(
    i: int, X: float, ends: Ends, legs: Matrix, b: Body
) -> tuple[PassageRow[float], PassageRow[float]]:
    """The passages of sample i on this and the other face, as `orbits.orbit` gives them; NaN what is not known."""
    energy, leg = ends.level[i] + potential_at_flat(X, b), leg_at(legs, i)
    theta = 2.0 * math.asin(0.5 * ends.here[i])
    here = PassageRow(theta, leg.chi, leg.psi, leg.time, energy, leg.angle_error, leg.time_error, math.nan)
    if math.isnan(ends.there[i]):
        return here, NOT_THERE
    leg = leg_at(legs, ends.level.size + i)
    theta = 2.0 * math.asin(0.5 * ends.there[i])
    there = PassageRow(theta, leg.chi, leg.psi, leg.time, energy, leg.angle_error, leg.time_error, math.nan)
    return here, there


@contracted_device
def at_depth(d: float, cap: float, log_cap: float, turn2: float) -> tuple[float, float, float]:
    """(h, tau, ln h) at d, in y, below the tilt where (h + tau)/2 is cap; turn2 = (h_m/2)^2."""
    rising = cap * exp_fall(d)
    inv_rising = 1.0 / rising
    falling = turn2 * inv_rising
    fraction = falling * inv_rising
    return rising + falling, rising - falling, log_cap - d + log_ratio(fraction / (2.0 + fraction))


@contracted_device
def terms_of(h: float, at: Near, motion: Motion, b: Body) -> float:
    """Sum of the sizes of what V is made of: its rounding is some units of that."""
    parts = abs(at.smooth) + abs(motion.Y * at.inv_h * at.D)
    spin = b.J * abs(at.rise) * (2.0 * abs(motion.X / b.k) + abs(at.rise))
    return 0.5 * b.I1 * parts * parts / at.shape2 + spin + h * at.shape


@contracted_subroutine
def measure(W: Vector, depth: float) -> None:
    """How far the lanes' legs go in y, and the angle of the race; the loop calls libraries."""
    for i in range(LANES):
        turn, end = W[H_TURN * LANES + i], W[H_END * LANES + i]
        tau = math.sqrt((end - turn) * (end + turn))
        cap = 0.5 * (end + tau)
        W[CAP * LANES + i], W[LOG_CAP * LANES + i] = cap, math.log(cap)
        W[LOG_TURN * LANES + i], W[LOG_END * LANES + i] = math.log(turn), math.log(end)
        W[TURN2 * LANES + i] = 0.25 * turn * turn
        y_end = W[LOG_CAP * LANES + i] + _LN2 - W[LOG_TURN * LANES + i]
        W[Y_END * LANES + i], W[BELOW * LANES + i] = y_end, min(max(y_end - depth, 0.0), _LEFT_OUT)
        W[RACE * LANES + i] = math.atan2(tau, turn)
        beyond = W[H_BEYOND * LANES + i]
        last = 0.5 * (beyond + math.sqrt((beyond - turn) * (beyond + turn))) if beyond > end else cap
        W[FURTHER * LANES + i] = math.log1p((last - cap) / cap)


@contracted_subroutine
def lay_panel(W: Vector, depth: float, wide: Wide, b: Body) -> None:
    """The panel of every lane, and what is known at both of its ends."""
    for i in range(LANES):
        turn, end, level = W[H_TURN * LANES + i], W[H_END * LANES + i], W[LEVEL * LANES + i]
        motion = Motion(W[X * LANES + i], W[Y * LANES + i], level)
        at = anywhere(turn, W[LOG_TURN * LANES + i], motion, b, wide)
        slope = -slope_of(turn, at, motion.X, b)
        good = (slope > 0.0) & (W[Y_END * LANES + i] > 0.0)
        slope = slope if good else 1.0
        W[CHECK * LANES + i] = 0.0 if good else 2.0
        closed = at.D / (at.shape2 * at.shape * math.sqrt(slope * b.inv_M))
        W[CLOSED * LANES + i] = closed
        W[BESIDE_TURN * LANES + i] = beside_turn(turn, level, slope, motion)
        W[RACE * LANES + i] = closed * motion.Y / turn * W[RACE * LANES + i]
        last = anywhere(end, W[LOG_END * LANES + i], motion, b, wide)
        terms = abs(level) + terms_of(turn, at, motion, b) + terms_of(end, last, motion, b)
        units = UPRIGHT_UNITS if end >= VERTICAL else ROUNDING_UNITS
        rounding = units * _EPSILON * terms
        W[ROUNDING * LANES + i], W[NOISE * LANES + i] = rounding, _NOISE * _EPSILON + rounding / slope
        # In y. Where V does not rise towards the end, the motion would not turn back soon.
        at_end = slope_of(end, last, motion.X, b)
        rise = at_end * (2.0 * W[CAP * LANES + i] - end) / end
        width = W[Y_END * LANES + i] if W[Y_END * LANES + i] < depth else depth
        moving = W[MOVING * LANES + i]
        further = moving / rise if rise * width > moving else width
        known = W[FURTHER * LANES + i]
        further = further if known == 0.0 else known if known < width else width
        further = further if moving > 0.0 else 0.0
        W[REACH * LANES + i], W[SINE_END * LANES + i] = width + further, width / (width + further)
        W[SLOW * LANES + i] = slowness(W, i, at_end)
        W[LEAST * LANES + i] = 1.0
    for i in range(LANES):
        W[ANGLE * LANES + i] = math.asin(min(max(W[SINE_END * LANES + i], 0.0), 1.0))


@contracted_subroutine
def add_nodes(W: Vector, rules: Matrix, first: int, last: int, of_body: LegTables, b: Body) -> None:
    """Add the integrands at the nodes first to last - 1 of `rules`."""
    for j in range(first, last):
        node, weight = rules[leg_tables.NODE, j], rules[leg_tables.WEIGHT, j]
        even, but_one = rules[leg_tables.EVEN, j], rules[leg_tables.EVEN_BUT_ONE, j]
        for i in range(LANES):
            phi, reach = W[ANGLE * LANES + i] * node, W[REACH * LANES + i]
            d = reach * (W[SINE_END * LANES + i] - sine(phi))
            dy = weight * W[ANGLE * LANES + i] * reach * cosine(phi)
            h, tau, log_h = at_depth(
                d if d < DEEPEST else DEEPEST,
                W[CAP * LANES + i],
                W[LOG_CAP * LANES + i],
                W[TURN2 * LANES + i],
            )
            motion = Motion(W[X * LANES + i], W[Y * LANES + i], W[LEVEL * LANES + i])
            at = anywhere(h, log_h, motion, b, of_body.wide)
            left = motion.level - at.V
            keep_least(W, i, left)
            left = left if left > _LEAST_LEFT else _LEAST_LEFT
            inv_shape2 = 1.0 / at.shape2
            dt = dy * tau / (at.shape * math.sqrt(2.0 * b.inv_M * left))
            turn = dt * at.inv_h * inv_shape2
            fast = motion.Y * at.inv_h
            smooth, whole = turn * at.smooth, fast * at.D * turn
            chi = smooth + whole - fast * W[CLOSED * LANES + i] * dy
            rest = dt * (0.5 * h * at.n * inv_shape2 + motion.X * (1.0 / b.k) + at.rise)
            gather(W, i, OF_CHI, chi, even, but_one)
            gather(W, i, OF_REST, rest, even, but_one)
            gather(W, i, OF_TIME, dt, even, but_one)
            # The first node is the deepest; no rule looks further down.
            missed = W[BELOW * LANES + i] / dy if j == first else 0.0
            doubt = W[ROUNDING * LANES + i] / left
            W[ANGLE_ERROR * LANES + i] += missed * (abs(chi) + abs(rest)) + doubt * (
                abs(smooth) + abs(whole) + abs(rest)
            )
            W[TIME_ERROR * LANES + i] += (missed + doubt) * dt


@contracted_subroutine
def integrate(W: Vector, target: float, grade: int, of_body: LegTables, b: Body) -> None:
    """The legs in the lanes by one rule."""
    sizes = of_body.sizes
    first = 0
    for g in range(grade):
        first += sizes[g]
    depth = min(_DEPTH + _PER_NODE * sizes[grade], DEEPEST)
    clear(W, SUMS)
    clear(W, TAILS)
    clear(W, ERRORS)
    measure(W, depth)
    lay_panel(W, depth, of_body.wide, b)
    add_nodes(W, of_body.rules, first, first + sizes[grade], of_body, b)
    tell_errors(W, sizes[grade])
    tell_turn(W, sizes[grade])
    for i in range(LANES):
        W[CHI * LANES + i] += W[RACE * LANES + i]
    tell_thin(W, b)
    finish(W, target, FLOOR)


@subroutine
def fill(W: Vector, group: Longs, n: int, orbits: Orbits, ends: Ends, b: Body) -> None:
    """Legs into lanes; the first one fills those that are left over."""
    samples = orbits.h.size
    for k in range(LANES):
        j = group[k] if k < n else group[0]
        kind, i = j // samples, j % samples
        rate, moving = orbits.rate[i], ends.moving[i]
        crosses = not math.isnan(moving)
        W[X * LANES + k] = orbits.sigma3_bar[i] / b.r0
        W[Y * LANES + k] = (orbits.far[i] if kind == THERE else orbits.near[i]) / b.I1
        W[LEVEL * LANES + k] = ends.level[i]
        W[H_TURN * LANES + k] = ends.there[i] if kind == THERE else ends.here[i]
        W[H_END * LANES + k] = orbits.h[i] if kind == LEAD else ends.outer[i]
        W[H_BEYOND * LANES + k] = 0.0 if crosses or kind != LEAD else ends.outer[i]
        W[MOVING * LANES + k] = 0.5 * b.M * rate * rate if kind == LEAD else moving if crosses else 0.0


@subroutine
def wanted(kind: int, i: int, orbits: Orbits, ends: Ends) -> bool:
    """Whether there is such a leg: another face only beyond the vertical, and none from where a motion turns."""
    if kind == THERE:
        return ends.there[i] > 0.0
    if kind == LEAD:
        # From either end, and from rest, it is half a passage or nothing.
        inside = (1.0 + BESIDE) * ends.here[i] < orbits.h[i] < (1.0 - BESIDE) * ends.outer[i]
        return orbits.rate[i] != 0.0 and inside
    return ends.here[i] > 0.0


@subroutine
def serves(W: Vector, k: int, whole: float, target: float) -> bool:
    """Whether the leg in lane k stands, or its time alone, as part of the time `whole`; NaN: it is no part."""
    check, error = W[CHECK * LANES + k], W[TIME_ERROR * LANES + k] * W[TIME * LANES + k]
    known = check == 1.0 and W[LEAST * LANES + k] > 0.0
    return check == 0.0 or (known and error <= max(target, FLOOR) * whole)


@subroutine
def first_rule(kind: int, i: int, middling: int, orbits: Orbits, ends: Ends) -> int:
    """The rule to begin with, from that of ways of middling length."""
    turn = ends.there[i] if kind == THERE else ends.here[i]
    ratio = (orbits.h[i] if kind == LEAD else VERTICAL if kind == THERE else ends.outer[i]) / turn
    if ratio < _SHORTER:
        return max(middling - _SAVED, 0)
    return middling + (_MOST if ratio > _LONGEST else _MORE if ratio > _LONGER else 0)


@subroutine
def finer(W: Vector, k: int, grade: int, last: int, target: float) -> int:
    """The rule to try after this one for the leg in lane k; `last` where none will do better."""
    if W[CHECK * LANES + k] == 2.0:
        return last
    far = max(W[ANGLE_ERROR * LANES + k], W[TIME_ERROR * LANES + k]) > _FAR * target
    return max(grade + 1, min(grade + 2, last - 1)) if far else grade + 1


@kernel
def leg_batch(
    orbits: Orbits, ends: Ends, first: int, target: float, of_body: LegTables, disk: Disk, out: Matrix
) -> None:
    """Legs there and back of samples with known ends -> out (5, kinds * n), rows as LegRow, a block for each kind.

    Two blocks are of the passages HERE and THERE, a third one of LEAD, from the state to its flattest moment. What
    is not NaN in `out` is left as it is. first: the rule to begin with on ways of middling length. A leg that no
    rule settles stays NaN. Of a lead the time alone counts, as part of that of the passage.
    """
    n, b, last = orbits.h.size, disk.body, of_body.sizes.size
    W = np.ones(ROWS * LANES)
    waiting, group = np.empty(out.shape[1], np.int64), np.zeros(LANES, np.int64)
    begins = np.full(out.shape[1], last)
    for j in range(out.shape[1]):
        if math.isnan(out[0, j]) and wanted(j // n, j % n, orbits, ends):
            begins[j] = min(first_rule(j // n, j % n, first, orbits, ends), last - 1)
    for grade in range(last):
        count = 0
        for j in range(out.shape[1]):
            if begins[j] == grade:
                waiting[count] = j
                count += 1
        for start in range(0, count, LANES):
            taken = min(LANES, count - start)
            group[:taken] = waiting[start : start + taken]
            fill(W, group, taken, orbits, ends, b)
            integrate(W, target, grade, of_body, b)
            for k in range(taken):
                whole = out[2, group[k] - LEAD * n] if group[k] >= LEAD * n else math.nan
                if serves(W, k, whole, target):
                    leg = LegRow(
                        chi=W[CHI * LANES + k],
                        psi=W[PSI * LANES + k],
                        time=W[TIME * LANES + k],
                        angle_error=W[ANGLE_ERROR * LANES + k],
                        time_error=W[TIME_ERROR * LANES + k],
                    )
                    put(leg, out, group[k])
                else:
                    begins[group[k]] = finer(W, k, grade, last, target)

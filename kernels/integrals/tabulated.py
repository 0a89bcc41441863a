"""Passages from the vertical by tables: samples side by side, a fixed number of nodes, no branch.

The integrals of `quadrature`, for motions that come near flat (h at the turning point <= WIDEST)
and do not start too slowly. From the vertical to HANDOVER the nodes stand at tilts that are the same
for all samples (`tables`). From there to the turning point they lie in y, and what the terms of first
order give is known in closed form (`near_flat`), so the same nodes serve every |eta|: five of them at 1e-3,
28 at 1e-11. The last coefficients of each panel's Legendre series say how well it has converged, or a bound that
is known beforehand; samples that have not, and those outside these bounds, are left to a finer grade of rules and
at last to `quadrature`.

Formulas are devices that return tuples; the loops over lanes read, call and write.
"""

import math
from typing import NamedTuple

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.body import Body
from kernels.disk.falling import contracted_potential_above_flat
from kernels.integrals import tables
from kernels.integrals.near_flat import (
    Closed,
    Integrals,
    Place,
    closed_forms,
    left_at_node,
    near_flat,
    newton,
    place_of_node,
    slope_of,
)
from kernels.integrals.point import Motion
from kernels.integrals.tables import Fixed, Grade, Limits, Series, fixed
from kernels.types import Matrix, Vector

LANES = 32  # ROWS rows of them are 11 kB, a third of the first cache
WIDEST = 0.2  # of h_m: well inside HANDOVER
NARROWEST = 1e-303  # of |Y|: h_m must not be denormal
_LEFT_OUT = 2.0  # in y: what is below the deepest node falls off like e^y, or ends at the turning point
# The inner rule's error is told by the size of what it adds up, which for single motions nearly cancels.
_LEAST_SIZE = 0.02
TURNED = 40.0  # what an error of the turning point, about the square of Newton's last step, does to the angles
_SLOWEST = 1e-3  # share of the energy with which a motion must leave the vertical, whatever the grade
_PARKED = 0.1  # h_m of lanes that are left to `quadrature`: any number within the bounds
EPSILON = 2.2e-16
NOISE_UNITS = 100.0  # units of rounding, as in quadrature

# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`. Their order means nothing.
ROWS = 43
(
    # the sample; NOISE: of E - V, START: what it does at a slow start; LEAST: least theta-dot^2 met
    X, Y, SPEED, LEVEL, H_TURN, LOG_TURN, STEP, NOISE, START, LEAST,
    # results; CHECK: 0 where they stand, 1 where finer rules may do better, 2 where none here will
    CHI, REST, TIME, PSI, ANGLE_ERROR, TIME_ERROR, WAY, CHECK,
    # fields of Closed
    CAP, LOG_CAP, WIDTH, BELOW, TURN2, RACE, PULL, SPIN, SLOW, REST0, REST1,
    # of a panel, as in Gathered
    CHI_SIZE, CHI_LAST, CHI_LAST_BUT_ONE, REST_SIZE, REST_LAST, REST_LAST_BUT_ONE,
    TIME_SIZE, TIME_LAST, TIME_LAST_BUT_ONE,
    # fields of Place
    NODE, TAU, LOG_NODE, INV_NODE, INV_TAU2,
) = range(ROWS)  # fmt: skip


class Goal(NamedTuple):
    """Accuracy of angles (rad) and time (relative), and what rounding allows, relative to chi and to the time."""

    target: float
    floor: float


class Gathered(NamedTuple):
    """Rows of one integral: its sum, and of the latest panel the sum of sizes and the last two coefficients."""

    total: int
    size: int
    last: int
    last_but_one: int


OF_CHI = Gathered(CHI, CHI_SIZE, CHI_LAST, CHI_LAST_BUT_ONE)
OF_REST = Gathered(REST, REST_SIZE, REST_LAST, REST_LAST_BUT_ONE)
OF_TIME = Gathered(TIME, TIME_SIZE, TIME_LAST, TIME_LAST_BUT_ONE)
SUMS = (CHI, REST, TIME)
ERRORS = (ANGLE_ERROR, TIME_ERROR)
TAILS = (*OF_CHI[1:], *OF_REST[1:], *OF_TIME[1:])
MOVING = SPEED  # of falls, which leave the vertical with a kinetic energy; START is its rounding
FALLEN = (Y, *SUMS, *ERRORS, *TAILS)  # zero where a fall begins


@contracted_subroutine
def clear(W: Vector, rows: tuple[int, ...]) -> None:
    """Zeros in these rows."""
    for row in rows:
        for i in range(LANES):
            W[row * LANES + i] = 0.0


@contracted_device
def start_noise(terms: float, moving: float, ratio: float, sigma4: float, b: Body) -> float:
    """What rounding in E - V, a difference of `terms`, does at the vertical to angles and time, relative.

    It acts while the motion is within about a radian of the vertical.
    """
    duration = min(1.0, math.sqrt(0.5 * b.M / moving))
    return 4.0 * EPSILON * terms / moving * duration * (1.0 + abs(ratio) + abs(sigma4))


@contracted_device
def departure(
    x: float, y: float, speed: float, slowest: float, at: Fixed, b: Body
) -> tuple[float, float, float, float, float]:
    """(level, terms of E - V, noise of the start, guess at the turning point, CHECK) from the vertical."""
    inv_k = 1.0 / b.k
    ratio, rise = x * at.ratio_x + y * at.ratio_y, x * at.rise_x + y * at.rise_y
    gyration = 0.5 * b.I1 * ratio * ratio
    _V, spin = contracted_potential_above_flat(gyration, rise, 2.0 * x * inv_k, 1.0, b)
    moving = 0.5 * b.M * speed * speed
    level = moving + gyration + spin + 1.0
    terms = abs(level) + gyration + abs(spin) + 1.0
    noise = start_noise(terms, moving, ratio, x * inv_k + rise, b)
    size = abs(y)
    first = size * math.sqrt(0.5 * b.I1 / level)
    # Gravity shares the energy at the turning point: one step of q = h.
    left = level - first
    near = (size > NARROWEST) & (first < 2.0 * WIDEST) & (left > 0.5 * level) & (moving > _SLOWEST * level)
    check = 0.0 if moving > slowest * level else 1.0
    return level, terms, noise, size * math.sqrt(0.5 * b.I1 / left), check if near else 2.0


@contracted_subroutine
def start(W: Vector, vertical: Matrix, slowest: float, b: Body) -> None:
    """LEVEL from SPEED at the vertical, a guess at the turning point, and NOISE of E - V."""
    at = fixed(vertical, 0)
    for i in range(LANES):
        x, y, speed = W[X * LANES + i], W[Y * LANES + i], W[SPEED * LANES + i]
        level, terms, noise, h, check = departure(x, y, speed, slowest, at, b)
        W[LEVEL * LANES + i], W[NOISE * LANES + i], W[START * LANES + i] = level, terms, noise
        W[H_TURN * LANES + i] = h if check == 0.0 else _PARKED
        W[CHECK * LANES + i] = check
    for i in range(LANES):
        W[LOG_TURN * LANES + i] = math.log(W[H_TURN * LANES + i])


@contracted_device
def motion_of(W: Vector, i: int) -> Motion:
    """The motion in lane i."""
    return Motion(W[X * LANES + i], W[Y * LANES + i], W[LEVEL * LANES + i])


@contracted_device
def newton_in_lanes(W: Vector, rounds: int, b: Body, low: Series) -> None:
    """H_TURN and LOG_TURN by Newton in ln h, and STEP, the last step."""
    for _ in range(rounds):
        for i in range(LANES):
            h, log_h, step = newton(W[H_TURN * LANES + i], W[LOG_TURN * LANES + i], motion_of(W, i), b, low)
            W[H_TURN * LANES + i], W[LOG_TURN * LANES + i], W[STEP * LANES + i] = h, log_h, step


@contracted_subroutine
def turn(W: Vector, limits: Limits, b: Body, low: Series) -> None:
    """H_TURN and LOG_TURN; CHECK is raised where Newton's method has not converged."""
    newton_in_lanes(W, int(limits.rounds), b, low)
    for i in range(LANES):
        inside = W[H_TURN * LANES + i] < WIDEST
        good = (abs(W[STEP * LANES + i]) < limits.settled) & inside
        raised = max(W[CHECK * LANES + i], 1.0 if inside else 2.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else raised
        W[H_TURN * LANES + i] = W[H_TURN * LANES + i] if good else _PARKED
        W[LOG_TURN * LANES + i] = W[LOG_TURN * LANES + i] if good else math.log(_PARKED)


@contracted_subroutine
def closed(W: Vector, depth: float, b: Body, low: Series) -> None:
    """What is known in closed form below the handover goes into CHI, REST, TIME; its factors into rows."""
    for i in range(LANES):
        motion, h, log_h = motion_of(W, i), W[H_TURN * LANES + i], W[LOG_TURN * LANES + i]
        at = near_flat(h, log_h, motion, b, low)
        slope = -slope_of(h, at, motion.X, b)
        W[WAY * LANES + i] = at.n * at.inv_shape
        W[NOISE * LANES + i] = NOISE_UNITS * EPSILON * (1.0 + W[NOISE * LANES + i] / slope) + W[START * LANES + i]
        good = slope > 0.0
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 2.0
        known, integrals = closed_forms(h, log_h, at, slope if good else 1.0, motion, b, low)
        W[CAP * LANES + i], W[LOG_CAP * LANES + i] = known.cap, known.log_cap
        wide = known.width if known.width < depth else depth
        below = known.width - wide
        W[WIDTH * LANES + i], W[BELOW * LANES + i] = wide, below if below < _LEFT_OUT else _LEFT_OUT
        W[TURN2 * LANES + i], W[RACE * LANES + i] = known.turn2, known.race
        W[PULL * LANES + i], W[SPIN * LANES + i], W[SLOW * LANES + i] = known.pull, known.spin, known.slow
        W[REST0 * LANES + i], W[REST1 * LANES + i] = known.rest0, known.rest1
        W[CHI * LANES + i], W[REST * LANES + i], W[TIME * LANES + i] = integrals
        W[LEAST * LANES + i] = 1.0
    clear(W, TAILS)
    clear(W, ERRORS)


@contracted_device
def known_of(W: Vector, i: int) -> Closed:
    """The factors of the closed forms in lane i."""
    cap, log_cap, width = W[CAP * LANES + i], W[LOG_CAP * LANES + i], W[WIDTH * LANES + i]
    turn2, race, pull = W[TURN2 * LANES + i], W[RACE * LANES + i], W[PULL * LANES + i]
    spin, slow = W[SPIN * LANES + i], W[SLOW * LANES + i]
    return Closed(cap, log_cap, width, turn2, race, pull, spin, slow, W[REST0 * LANES + i], W[REST1 * LANES + i])


@contracted_device
def gather(W: Vector, i: int, rows: Gathered, value: float, last: float, last_but_one: float) -> None:
    """Add a weighted value to the sum, to the panel's sum of sizes and to its last two coefficients."""
    W[rows.total * LANES + i] += value
    W[rows.size * LANES + i] += abs(value)
    W[rows.last * LANES + i] += value * last
    W[rows.last_but_one * LANES + i] += value * last_but_one


@contracted_device
def keep_least(W: Vector, i: int, speed2: float) -> None:
    """Note the least theta-dot^2 met."""
    least = W[LEAST * LANES + i]
    W[LEAST * LANES + i] = speed2 if speed2 < least else least


@contracted_subroutine
def near_panel(W: Vector, inner: Matrix, b: Body, low: Series) -> None:
    """Add what the closed forms leave between the turning point and the handover."""
    for j in range(inner.shape[1]):
        gap, weight = inner[tables.GAP, j], inner[tables.WEIGHT, j]
        last, last_but_one = inner[tables.EVEN, j], inner[tables.EVEN_BUT_ONE, j]
        # Apart from what follows: one chain of all these operations is longer than a processor looks ahead.
        for i in range(LANES):
            at = place_of_node(gap, known_of(W, i), low)
            W[NODE * LANES + i], W[TAU * LANES + i], W[LOG_NODE * LANES + i] = at.h, at.tau, at.log_h
            W[INV_NODE * LANES + i], W[INV_TAU2 * LANES + i] = at.inv_h, at.inv_tau2
        for i in range(LANES):
            h_turn, log_turn, known = W[H_TURN * LANES + i], W[LOG_TURN * LANES + i], known_of(W, i)
            h, tau, log_h = W[NODE * LANES + i], W[TAU * LANES + i], W[LOG_NODE * LANES + i]
            at = Place(h, tau, log_h, W[INV_NODE * LANES + i], W[INV_TAU2 * LANES + i])
            speed2, node = left_at_node(at, motion_of(W, i), h_turn, log_turn, known, b, low)
            keep_least(W, i, speed2)
            step = weight * known.width
            gather(W, i, OF_CHI, step * node.chi, last, last_but_one)
            gather(W, i, OF_REST, step * node.rest, last, last_but_one)
            gather(W, i, OF_TIME, step * node.time, last, last_but_one)
            # The first node is the deepest; no rule looks further down.
            left_out = W[BELOW * LANES + i] if j == 0 else 0.0
            W[ANGLE_ERROR * LANES + i] += left_out * (abs(node.chi) + abs(node.rest))
            W[TIME_ERROR * LANES + i] += left_out * abs(node.time)


@contracted_device
def at_fixed(at: Fixed, motion: Motion, b: Body) -> tuple[float, Integrals]:
    """(theta-dot^2, weighted integrands) of a motion at a fixed tilt."""
    ratio = motion.X * at.ratio_x + motion.Y * at.ratio_y
    rise = motion.X * at.rise_x + motion.Y * at.rise_y
    flat = motion.X * (1.0 / b.k)
    V, _spin = contracted_potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * flat, at.height, b)
    speed2 = 2.0 * b.inv_M * (motion.level - V)
    inv_speed = 1.0 / math.sqrt(speed2 if speed2 > 0.0 else 1.0)
    rest = at.time * inv_speed * (ratio * at.slope + flat + rise)
    return speed2, Integrals(at.chi * ratio * inv_speed, rest, at.time * inv_speed)


@contracted_subroutine
def far_panel(W: Vector, outer: Matrix, b: Body) -> None:
    """Add the stretch from the handover to the vertical, by nodes at tilts that all samples share."""
    for j in range(outer.shape[1]):
        at, last, last_but_one = fixed(outer, j), outer[tables.LAST, j], outer[tables.LAST_BUT_ONE, j]
        for i in range(LANES):
            speed2, node = at_fixed(at, motion_of(W, i), b)
            keep_least(W, i, speed2)
            gather(W, i, OF_CHI, node.chi, last, last_but_one)
            gather(W, i, OF_REST, node.rest, last, last_but_one)
            gather(W, i, OF_TIME, node.time, last, last_but_one)


@contracted_device
def tail_of(W: Vector, i: int, rows: Gathered) -> float:
    """The sum of sizes of the last two coefficients."""
    return abs(W[rows.last * LANES + i]) + abs(W[rows.last_but_one * LANES + i])


@contracted_device
def remainder(W: Vector, i: int, rows: Gathered) -> float:
    """Error of a Gauss rule of n nodes from coefficients n - 1 and n - 2: of a geometric series about
    size * ratio^(2n), where they are size * ratio^n. Never more than they are themselves."""
    return tail_of(W, i, rows) * share_of_tail(W, i, rows)


@contracted_device
def share_of_tail(W: Vector, i: int, rows: Gathered) -> float:
    """The last coefficients over the sum of sizes, 1 at most."""
    share = tail_of(W, i, rows) / (W[rows.size * LANES + i] + 1e-300)  # never 0/0
    return share if share < 1.0 else 1.0


@contracted_subroutine
def told_by_coefficients(W: Vector) -> None:
    """Add the panel's errors as its last coefficients tell them, and clear its sums."""
    for i in range(LANES):
        chi, rest, time = remainder(W, i, OF_CHI), remainder(W, i, OF_REST), remainder(W, i, OF_TIME)
        W[ANGLE_ERROR * LANES + i] += 2.0 * (chi + rest)
        W[TIME_ERROR * LANES + i] += 2.0 * time
    clear(W, TAILS)


@contracted_subroutine
def told_by_the_worst(W: Vector, trust: float) -> None:
    """As `told_by_coefficients` for rules of some ten nodes.

    Two coefficients in turn may vanish by chance there: the largest share of all three integrals serves each. The
    error of a Gauss rule goes like its square; trust: how many times the square that is at most.
    """
    for i in range(LANES):
        chi, rest, time = share_of_tail(W, i, OF_CHI), share_of_tail(W, i, OF_REST), share_of_tail(W, i, OF_TIME)
        share = max(max(chi, rest), time)
        missed = trust * share * share
        W[ANGLE_ERROR * LANES + i] += missed * (W[CHI_SIZE * LANES + i] + W[REST_SIZE * LANES + i])
        W[TIME_ERROR * LANES + i] += missed * W[TIME_SIZE * LANES + i]
    clear(W, TAILS)


@contracted_subroutine
def told_by_size(W: Vector, missed: float, spun: float) -> None:
    """Add the errors of an inner rule that misses this share of what it adds up, and clear its sums."""
    for i in range(LANES):
        size = W[CHI_SIZE * LANES + i] + spun * (W[REST_SIZE * LANES + i] + W[TIME_SIZE * LANES + i])
        error = missed * (size + _LEAST_SIZE) + TURNED * W[STEP * LANES + i] * W[STEP * LANES + i]
        W[ANGLE_ERROR * LANES + i] += error
        W[TIME_ERROR * LANES + i] += error
    clear(W, TAILS)


@contracted_subroutine
def finish(W: Vector, target: float, floor: float) -> None:
    """There and back in CHI, REST, PSI and TIME, errors with rounding; CHECK is 0 where they meet the
    target, or the floor relative to chi and to the time."""
    for i in range(LANES):
        chi, rest, time = 2.0 * W[CHI * LANES + i], 2.0 * W[REST * LANES + i], 2.0 * W[TIME * LANES + i]
        noise = W[NOISE * LANES + i]
        angle_error = 2.0 * W[ANGLE_ERROR * LANES + i] + noise * (abs(chi) + abs(rest))
        time_error = 2.0 * W[TIME_ERROR * LANES + i] / time + noise
        W[CHI * LANES + i], W[PSI * LANES + i], W[TIME * LANES + i] = chi, chi - rest, time
        W[ANGLE_ERROR * LANES + i], W[TIME_ERROR * LANES + i] = angle_error, time_error
        size = abs(chi) if abs(chi) > 1.0 else 1.0
        angle_target = floor * size if floor * size > target else target
        time_target = floor if floor > target else target
        good = (angle_error <= angle_target) & (time_error <= time_target) & (W[LEAST * LANES + i] > 0.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else max(W[CHECK * LANES + i], 1.0)


@contracted_subroutine
def passages(W: Vector, goal: Goal, grade: Grade, vertical: Matrix, low: Series, b: Body) -> None:
    """Whole passages of the samples in rows X, Y and SPEED."""
    limits = grade.limits
    start(W, vertical, limits.slowest, b)
    turn(W, limits, b, low)
    closed(W, limits.depth, b, low)
    near_panel(W, grade.inner, b, low)
    if limits.missed > 0.0:
        told_by_size(W, limits.missed, limits.spun)
    else:
        told_by_coefficients(W)
    far(W, grade.outer, limits.trust, b)
    finish(W, goal.target, goal.floor)


@contracted_subroutine
def far(W: Vector, nodes: Matrix, trust: float, b: Body) -> None:
    """A stretch at tilts that all samples share, with its errors. trust: 0 for rules of many nodes."""
    far_panel(W, nodes, b)
    if trust > 0.0:
        told_by_the_worst(W, trust)
    else:
        told_by_coefficients(W)


@contracted_device
def departure_on_f(x: float, level: float, moving: float, doubt: float, at: Fixed, b: Body) -> float:
    """Noise of a fall on F that leaves the vertical with the kinetic energy `moving`."""
    ratio, rise = x * at.ratio_x, x * at.rise_x
    gyration = 0.5 * b.I1 * ratio * ratio
    _V, spin = contracted_potential_above_flat(gyration, rise, 2.0 * x / b.k, 1.0, b)
    terms = abs(level) + gyration + abs(spin) + 1.0
    noise = start_noise(terms + doubt / (4.0 * EPSILON), moving, ratio, x / b.k + rise, b)
    return NOISE_UNITS * EPSILON * (1.0 + terms / abs(level)) + noise


@contracted_subroutine
def falls(W: Vector, goal: Goal, grade: Grade, vertical: Matrix, b: Body) -> None:
    """Twice the falls on F from the vertical, for rows X, LEVEL, MOVING and START; row Y becomes 0."""
    at, slowest = fixed(vertical, 0), grade.limits.slowest
    clear(W, FALLEN)
    for i in range(LANES):
        x, level, moving = W[X * LANES + i], W[LEVEL * LANES + i], W[MOVING * LANES + i]
        W[NOISE * LANES + i] = departure_on_f(x, level, moving, W[START * LANES + i], at, b)
        W[LEAST * LANES + i] = 1.0
        W[CHECK * LANES + i] = 0.0 if moving > slowest * level else 1.0
    far(W, grade.fall, grade.limits.trust_of_fall, b)
    finish(W, goal.target, goal.floor)

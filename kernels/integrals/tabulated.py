"""Passages from the vertical by tables: samples side by side, a fixed number of nodes, no branch.

For motions that come near flat (h at the turning point <= WIDEST) and do not start too slowly. From the
vertical to HANDOVER the nodes stand at tilts that are the same for all samples (`tables`). From there to the
turning point they lie in y, and what the terms of first order give is known in closed form (`near_flat`), so
the same nodes serve every |eta|: four of them at 1e-3, 22 at 1e-11. The last coefficients of each panel's
Legendre series say how well it has converged, or a bound that is known beforehand; samples that have not, and
those outside these bounds, are left to a finer grade of rules and at last to arcs.

Formulas are devices that return tuples; the loops over lanes read, call and write.
"""

import math

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.body import Body
from kernels.disk.constants import Motion
from kernels.disk.elementary import inverse_root
from kernels.disk.falling import contracted_potential_above_flat
from kernels.integrals import tables
from kernels.integrals.near_flat import (
    Closed,
    Integrals,
    Moving,
    Place,
    closed_forms,
    fall_off,
    left_at_node,
    motion_at_node,
    near_flat,
    newton,
    place_of_node,
    slope_of,
)
from kernels.integrals.sums import (
    ANGLE_ERROR,
    BELOW,
    CAP,
    CHECK,
    CHI,
    DEPARTED,
    DOMINANT,
    ERRORS,
    FALLEN,
    H_TURN,
    INV_NODE,
    INV_SHAPE,
    INV_TAU2,
    LANES,
    LEAST,
    LEVEL,
    LOG_CAP,
    LOG_NODE,
    LOG_TURN,
    MOVING,
    NODE,
    NOISE,
    OF_CHI,
    OF_REST,
    OF_TIME,
    PULL,
    RACE,
    RATIO,
    REST,
    REST0,
    REST1,
    ROOT,
    ROOT2,
    SLOW,
    SMOOTH,
    SPEED,
    SPIN,
    SPIN_THERE,
    START,
    STEP,
    TAILS,
    TAU,
    TIME,
    TIME_ERROR,
    TURN2,
    WAY,
    WIDTH,
    Goal,
    X,
    Y,
    add,
    clear,
    finish,
    gather,
    told_by_coefficients,
    told_by_size,
    told_by_the_start,
    told_by_the_worst,
)
from kernels.integrals.tables import Fixed, Grade, Limits, Series, fixed
from kernels.types import Matrix, Vector

WIDEST = 0.2  # of h_m: well inside HANDOVER
NARROWEST = 1e-303  # of |Y|: h_m must not be denormal
_LEFT_OUT = 2.0  # in y: what is below the deepest node falls off like e^y, or ends at the turning point
_SLOWEST = 1e-3  # share of the energy with which a motion must leave the vertical, whatever the grade
# r^2 of a slow start that has gained as much as it left with at the middle of the rule.
_MIDDLE = 0.8
_PARKED = 0.1  # h_m of lanes that are left to arcs: any number within the bounds
EPSILON = 2.2e-16
NOISE_UNITS = 100.0  # units of rounding


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
        W[DEPARTED * LANES + i] = 0.5 * b.M * speed * speed
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
def place_at(W: Vector, i: int) -> Place:
    """Where the node stands in lane i."""
    h, tau, log_h = W[NODE * LANES + i], W[TAU * LANES + i], W[LOG_NODE * LANES + i]
    return Place(h, tau, log_h, W[INV_NODE * LANES + i], W[INV_TAU2 * LANES + i])


@contracted_device
def moving_at(W: Vector, i: int) -> Moving:
    """The motion at the node in lane i."""
    smooth, D, n = W[SMOOTH * LANES + i], W[DOMINANT * LANES + i], W[RATIO * LANES + i]
    return Moving(smooth, D, n, W[SPIN_THERE * LANES + i], W[INV_SHAPE * LANES + i], W[ROOT * LANES + i])


@contracted_subroutine
def near_panel(W: Vector, inner: Matrix, b: Body, low: Series) -> None:
    """Add what the closed forms leave between the turning point and the handover."""
    for j in range(inner.shape[1]):
        gap, weight = inner[tables.GAP, j], inner[tables.WEIGHT, j]
        # Apart from one another: a chain of all these operations is longer than a processor looks ahead.
        for i in range(LANES):
            W[NODE * LANES + i] = fall_off(W[WIDTH * LANES + i] * gap, low)
        for i in range(LANES):
            d, fallen = W[WIDTH * LANES + i] * gap, W[NODE * LANES + i]
            at = place_of_node(d, fallen, known_of(W, i), low)
            W[NODE * LANES + i], W[TAU * LANES + i], W[LOG_NODE * LANES + i] = at.h, at.tau, at.log_h
            W[INV_NODE * LANES + i], W[INV_TAU2 * LANES + i] = at.inv_h, at.inv_tau2
        for i in range(LANES):
            m = motion_at_node(place_at(W, i), motion_of(W, i), b, low)
            W[SMOOTH * LANES + i], W[DOMINANT * LANES + i], W[RATIO * LANES + i] = m.smooth, m.D, m.n
            W[SPIN_THERE * LANES + i], W[INV_SHAPE * LANES + i], W[ROOT * LANES + i] = m.spin, m.inv_shape, m.root
        for i in range(LANES):
            h_turn, log_turn, known = W[H_TURN * LANES + i], W[LOG_TURN * LANES + i], known_of(W, i)
            node = left_at_node(place_at(W, i), moving_at(W, i), motion_of(W, i), h_turn, log_turn, known)
            step = weight * known.width
            add(W, i, OF_CHI, step * node.chi)
            add(W, i, OF_REST, step * node.rest)
            add(W, i, OF_TIME, step * node.time)
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
    inv_speed = inverse_root(speed2)
    rest = at.time * inv_speed * (ratio * at.slope + flat + rise)
    return speed2, Integrals(at.chi * ratio * inv_speed, rest, at.time * inv_speed)


@contracted_subroutine
def far_panel(W: Vector, outer: Matrix, b: Body) -> None:
    """Add the stretch from the handover to the vertical, by nodes at tilts that all samples share."""
    for j in range(outer.shape[1]):
        at, last, last_but_one = fixed(outer, j), outer[tables.LAST, j], outer[tables.LAST_BUT_ONE, j]
        for i in range(LANES):
            _speed2, node = at_fixed(at, motion_of(W, i), b)
            gather(W, i, OF_CHI, node.chi, last, last_but_one)
            gather(W, i, OF_REST, node.rest, last, last_but_one)
            gather(W, i, OF_TIME, node.time, last, last_but_one)


@contracted_subroutine
def passages(W: Vector, goal: Goal, grade: Grade, vertical: Matrix, low: Series, b: Body) -> None:
    """Whole passages of the samples in rows X, Y and SPEED."""
    limits = grade.limits
    start(W, vertical, limits.slowest, b)
    turn(W, limits, b, low)
    closed(W, limits.depth, b, low)
    near_panel(W, grade.inner, b, low)
    told_by_size(W, limits.missed, limits.spun)
    far(W, grade.outer, limits.trust, b)
    finish(W, goal.target, goal.floor)


@contracted_subroutine
def slow_start(W: Vector, nodes: Matrix, b: Body) -> None:
    """ROOT2 from what motions have gained at the middle of a rule whose nodes are crowded at the vertical."""
    at = fixed(nodes, nodes.shape[1] // 2)
    for i in range(LANES):
        speed2, _node = at_fixed(at, motion_of(W, i), b)
        moving = W[DEPARTED * LANES + i]
        gained = 0.5 * b.M * speed2 - moving
        W[ROOT2 * LANES + i] = _MIDDLE * moving / (gained if gained > moving else moving)


@contracted_subroutine
def far(W: Vector, nodes: Matrix, trust: float, b: Body) -> None:
    """A stretch at tilts that all samples share, with its errors. trust: 0 for rules of many nodes."""
    slow_start(W, nodes, b)
    far_panel(W, nodes, b)
    told_by_the_start(W, nodes.shape[1])
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
        W[LEAST * LANES + i], W[DEPARTED * LANES + i] = 1.0, moving
        W[CHECK * LANES + i] = 0.0 if moving > slowest * level else 1.0
    far(W, grade.fall, grade.limits.trust_of_fall, b)
    finish(W, goal.target, goal.floor)

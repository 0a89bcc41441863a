"""The fall on F from the vertical, or from wherever a lower energy begins, to flat: adaptive rules.

theta = start - scale sinh^2 x makes the square root of E - V smooth in x, however slow the start. Beside the
vertical E - V is the series of `departure`, whose constant is given and not a difference.
"""

import math
from typing import NamedTuple

from kernels._jit import subroutine
from kernels.disk.body import Body, Disk
from kernels.integrals import nodes
from kernels.integrals.arrival import doubt_beside_turn, expand_turn, left_beside_turn
from kernels.integrals.departure import (
    WIDEST,
    divide,
    doubt,
    expand_start,
    first_root,
    first_slope,
    known_noise,
    left_at,
    quotient_at,
)
from kernels.integrals.nodes import ROOM
from kernels.integrals.point import VERTICAL, Motion, Point, point
from kernels.integrals.quadrature import EPSILON, LEAST, FallRow, Rules, Start, magnitude, slow_node, slow_start
from kernels.types import Matrix, Vector

_LN2 = math.log(2.0)
_BISECTIONS = 60  # to rounding, of h
_NOISE = 50.0  # units of rounding: an exponential's none, some sixty nodes, the solutions


class Departure(NamedTuple):
    """How a fall leaves the vertical: kinetic energy there, below 0 what it lacks, and the rounding of that."""

    moving: float
    doubt: float


class Begin(NamedTuple):
    """Where a fall begins: its tilt theta and sin(phi), and how E - V = moving + slope d + ... grows with d.

    known: whether E - V is the vertical's series there; rest: whether it begins from rest.
    """

    theta: float
    u: float
    moving: float
    slope: float
    known: bool
    rest: bool


@subroutine
def slow_noise(slow: float, distance: float, rounding: float, at: Point[float], b: Body) -> float:
    """Error of angles and time from rounding in E - V, which acts for as long as the motion is slow."""
    if not slow > 0.0:
        return math.inf
    duration = math.sqrt(2.0) * distance / math.sqrt(2.0 * b.inv_M * slow)
    return 4.0 * rounding / slow * duration * (1.0 + abs(at.ratio) + abs(at.sigma4))


@subroutine
def start_of_fall(h_end: float, motion: Motion, disk: Disk) -> Start:
    """Where the fall on F begins: at h_end, or at rest at the turning point if that comes later."""
    if motion.level >= point(h_end, motion.X, 0.0, disk).V:
        return Start(h_end, False, 0.0)
    low, high = 0.0, h_end
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if motion.level < point(middle, motion.X, 0.0, disk).V:
            high = middle
        else:
            low = middle
    return Start(low, True, 0.0)


@subroutine
def begin_of(h_end: float, departure: Departure, motion: Motion, disk: Disk, W: Vector) -> Begin:
    """Where and how the fall begins: by the series of the vertical, where that holds."""
    if h_end == VERTICAL and departure.moving != 0.0:
        expand_start(W, departure.moving, motion.X, 0.0, disk.body)
        if departure.moving > 0.0:
            return Begin(0.5 * math.pi, 0.0, departure.moving, max(first_slope(W), 0.0), True, False)
        u = first_root(W, -1.0, 1.0)
        if u > 0.0:
            divide(W, u)
            slope = -quotient_at(W, u) * math.sqrt((1.0 - u) * (1.0 + u))
            return Begin(math.acos(u), u, 0.0, max(slope, 0.0), True, True)
    start = start_of_fall(h_end, motion, disk)
    first = point(start.h, motion.X, 0.0, disk)
    if start.rest:
        expand_turn(W, first, motion, disk.body)
    moving = 0.0 if start.rest else motion.level - first.V
    slope = max(first.slope * first.shape / start.h, 0.0)
    return Begin(2.0 * math.asin(0.5 * start.h), 0.0, moving, slope, False, start.rest)


@subroutine
def lay_fall_nodes(W: Vector, begin: Begin, scale: float, rule: Matrix) -> None:
    """Place the nodes of a fall: theta = that of its start less scale sinh^2 x."""
    stretch = math.asinh(math.sqrt(begin.theta / scale))
    for j in range(rule.shape[1]):
        distance, dtheta = slow_node(rule[0, j], rule[1, j], stretch, scale)
        h = 2.0 * math.sin(0.5 * max(begin.theta - distance, LEAST))
        W[nodes.GAP * ROOM + j] = distance
        W[nodes.H * ROOM + j] = h
        W[nodes.LOG * ROOM + j] = 2.0 * math.log(h) - _LN2
        W[nodes.E2 * ROOM + j] = W[nodes.CLOSED * ROOM + j] = W[nodes.KNOWN * ROOM + j] = 0.0
        # integrands() takes weights in y, with dtheta = h tanh(y) dy / shape
        W[nodes.WEIGHT * ROOM + j] = dtheta * math.sqrt(1.0 - 0.25 * h * h) / h


@subroutine
def know_beside_vertical(W: Vector, n: int, begin: Begin, least: float, departure: Departure) -> None:
    """KNOWN = E - V at nodes beside the vertical, and NOISE = its rounding.

    least: where less is left than that, a rounding of all E - V moves the start, and little else.
    """
    height = math.sqrt((1.0 - begin.u) * (1.0 + begin.u))
    for j in range(n):
        sine = math.sin(0.5 * W[nodes.GAP * ROOM + j])
        cosine = math.sqrt((1.0 - sine) * (1.0 + sine))
        # sin(phi) less that of the start
        w = 2.0 * sine * (height * cosine - begin.u * sine)
        if W[nodes.GAP * ROOM + j] < WIDEST and begin.u + w < WIDEST:
            u = begin.u + w
            known = max(-w * quotient_at(W, u) if begin.rest else left_at(W, u), LEAST)
            W[nodes.KNOWN * ROOM + j] = known
            W[nodes.NOISE * ROOM + j] = (departure.doubt + doubt(W, u)) * min(1.0, known / least)


@subroutine
def know_beside_rest(W: Vector, n: int, begin: Begin, least: float, rounding: float) -> None:
    """The same at nodes beside the rest that a fall far from the vertical begins with."""
    sine = math.sin(0.5 * begin.theta)
    for j in range(n):
        half = 0.5 * W[nodes.GAP * ROOM + j]
        x = -math.sin(begin.theta - half) * math.sin(half) / (sine * sine)
        if x > -WIDEST:
            known = max(left_beside_turn(W, x), LEAST)
            W[nodes.KNOWN * ROOM + j] = known
            W[nodes.NOISE * ROOM + j] = (rounding + doubt_beside_turn(W, -x)) * min(1.0, known / least)


@subroutine
def fall(
    h_end: float, departure: Departure, motion: Motion, rules: Rules, disk: Disk, W: Vector
) -> FallRow[float]:
    """The fall on F (Y = 0) from h_end to flat; departure: from the vertical.

    Where the energy is too low for h_end the fall begins at rest, later. Orders of the rules rise until two in
    turn agree as far as rounding lets them.
    """
    begin = begin_of(h_end, departure, motion, disk, W)
    first = point(2.0 * math.sin(0.5 * begin.theta), motion.X, 0.0, disk)
    bend = max(motion.level - begin.moving - begin.slope * begin.theta, 0.0) / (begin.theta * begin.theta)
    # The energy comes from a start at the vertical, where q = 1.
    rounding = EPSILON * (magnitude(first, motion, disk.body) + 1.0)
    scale, slow = slow_start(begin.moving, begin.slope, bend, begin.theta, begin.rest, rounding)
    told = begin.known or begin.rest
    unknown = 0.0 if told else slow_noise(slow, scale, rounding, first, disk.body)
    time = chi = psi = math.nan
    error = noise = math.inf
    done = 0
    for size in rules.sizes:
        n = int(size)
        lay_fall_nodes(W, begin, scale, rules.packed[1, :, done : done + n])
        done += n
        if begin.known:
            know_beside_vertical(W, n, begin, slow if begin.rest else LEAST, departure)
        elif begin.rest:
            know_beside_rest(W, n, begin, slow, 4.0 * rounding)
        nodes.integrands(W, n, motion, disk)
        new_time, new_chi = nodes.total(W, nodes.TIME, n), nodes.total(W, nodes.CHI, n)
        new_psi = new_chi - nodes.total(W, nodes.REST, n)
        error = max(abs(new_time - time), max(abs(new_chi - chi), abs(new_psi - psi)))
        time, chi, psi = new_time, new_chi, new_psi
        noise = _NOISE * EPSILON * (1.0 + time + abs(chi) + abs(psi)) + unknown * (1.0 + time)
        if told:
            twice_angles, twice_time = known_noise(W, 0, n, 4.0 * rounding, motion.level)
            noise += 0.5 * (twice_angles + twice_time)
        if error <= noise:
            break
    return FallRow(time, chi, psi, error + noise)

"""One passage near flat as an integral: no time steps, and eta as an input of its own.

With h = 2 sin(theta/2) and h = h_m cosh y, where h_m is the turning point, the passage from h_m to
the vertical is an integral over y of an even analytic function. Its only sharp feature is the race
itself, sigma_3/q^2 ~ Y/h^2, which is integrated in closed form:

    chi = Y w(0)/h_m * gd(y_c) + integral of [ X (rho/S) h w / 2 + (Y/h) (D w - D_m w(0)) ] dy + ...

with w = (1 - S/2)^(-3/2) (P / tanh^2 y)^(-1/2) and P = theta-dot^2. What is left varies over unit
distances in y by an amount of order eta, so a fixed Gauss rule serves |eta| from 1 to 1e-300: below
y_c - 36 the rest is smaller than rounding, and the range never grows. The end towards the vertical,
where a slow start makes P nearly vanish, has a panel of its own in d = scale sinh^2 x.
The nodes of a rule are evaluated together, in `nodes`.
"""

import math
from typing import Generic, NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.falling import potential_at_anchor, rounding_at_anchor, spin_at_anchor
from kernels.disk.rows import Entry
from kernels.integrals import nodes
from kernels.integrals.arrival import expand_turn, know_beside_turn
from kernels.integrals.departure import (
    divide,
    divide_again,
    expand_start,
    first_root,
    know,
    known_noise,
    return_noise,
    there_and_back,
    way_at,
)
from kernels.integrals.nodes import ROOM
from kernels.integrals.point import Motion, Point, point
from kernels.integrals.turning import turning_point
from kernels.status import Status
from kernels.types import Longs, Matrix, Table, Vector

_DEEP = 1e-60  # of h_m, below which squares of S underflow in the series beside the turning point
# Length of the panel towards the vertical, in y: it ends at a fifth of the vertical's h.
_END_PANEL = 1.5
# e^-36 = 2e-16: nothing but the closed part is left below.
_DEEPEST = 36.0
EPSILON = 2.2e-16
FLOOR = 1e-11  # an accuracy below this is met as far as rounding allows
# Units of rounding, some times the largest errors seen against 60 digits: of what races beside the turning
# point, and of what is smooth there.
_NOISE, _QUIET = 40.0, 10.0
_SPUN = 3.0  # the same, of sigma4 at the vertical
_CLOSING = 1.75
LEAST = 1e-300  # of what is divided by

_OK = int(Status.OK)
_BAD = int(Status.BAD_INPUT)
_LIMIT = int(Status.STEP_LIMIT)


class Rules(NamedTuple):
    """Gauss rules of rising order on [-1, 1], side by side.

    packed (2, 2, n): nodes and weights of the positive halves of symmetric rules, and of whole rules;
    sizes: how many nodes each has.
    """

    packed: Table
    sizes: Longs


class Start(NamedTuple):
    """Where a passage begins: h there, and whether it begins from rest, whatever rounding makes of its speed.

    moving: kinetic energy, at the vertical; 0 where it is only known as a difference.
    """

    h: float
    rest: bool
    moving: float


class PassageRow(NamedTuple, Generic[Entry]):
    """A passage from its start to the turning point and back, natural units, face +1.

    theta_min: smallest tilt; chi, psi, time: increases; angle_error (rad), time_error (relative): of these.
    way: sigma3/q at the turning point, whose sign is the direction of the race.
    """

    theta_min: Entry
    chi: Entry
    psi: Entry
    time: Entry
    energy: Entry
    angle_error: Entry
    time_error: Entry
    way: Entry


class FallRow(NamedTuple, Generic[Entry]):
    """The fall on F to flat: time, increases of chi and psi, and their error. psi changes sign on face -1."""

    time: Entry
    chi: Entry
    psi: Entry
    error: Entry


class Panels(NamedTuple):
    """Where the nodes of a passage lie.

    y_end: y at the start; length: of the panel there; scale: where a slow start stops being slow;
    closed: D_m w(0), the factor of the closed part.
    """

    y_end: float
    length: float
    scale: float
    closed: float


@device
def magnitude(at: Point, motion: Motion, b: Body) -> float:
    """Sum of the sizes of what E - V is a difference of: its rounding is some units of that."""
    flat = spin_at_anchor(motion.X, motion.Y, b)
    spin = b.J * abs(at.sigma4 - flat) * (abs(flat) + abs(at.sigma4))
    return abs(motion.level) + 0.5 * b.I1 * at.ratio * at.ratio + spin + math.sqrt(2.0 * at.S) * at.shape


@device
def slow_start(
    kinetic_energy: float, slope: float, bend: float, length: float, rest: bool, rounding: float
) -> tuple[float, float]:
    """(scale, least kinetic energy that matters) of E - V = kinetic + slope d + bend d^2, d from the start.

    scale: where the start's terms give way to the last; with d = scale sinh^2 x the root of E - V is
    smooth in x. From rest the first node is about a thousandth of the length away.
    """
    scale = length
    if rest:
        least = 1e-3 * (slope + bend * length) * length
        if bend > 0.0:
            scale = min(length, slope / bend)
            least = min(least, slope * slope / bend)
        return max(scale, LEAST), least
    if kinetic_energy > 0.0 and slope + bend > 0.0:
        root = math.sqrt(slope * slope + 4.0 * bend * kinetic_energy)
        scale = min(length, 2.0 * kinetic_energy / (slope + root))
    return scale, max(kinetic_energy, rounding)


@subroutine
def end_scale(
    h_turn: float, y_end: float, length: float, begin: Start, motion: Motion, disk: Disk
) -> tuple[float, float]:
    """(scale, rounding): where a slow start at y_end stops being slow, and the rounding of E - V there."""
    b, level = disk.body, motion.level
    last = point(h_turn * math.cosh(y_end), motion.X, motion.Y, disk)
    start = begin.moving if begin.moving > 0.0 else max(level - last.V, 0.0)
    start = 0.0 if begin.rest else start
    slope = max(last.slope * math.tanh(y_end), 0.0)
    other = level - point(h_turn * math.cosh(y_end - length), motion.X, motion.Y, disk).V
    bend = max(other - start - slope * length, 0.0) / (length * length)
    rounding = EPSILON * magnitude(last, motion, b)
    scale, _least = slow_start(start, slope, bend, length, begin.rest, rounding)
    return scale, rounding


@subroutine
def rounding_noise(start: Start, turn: Point, y_cut: float, motion: Motion, disk: Disk) -> float:
    """Relative error from rounding in E - V, away from a slow start.

    The terms of V may be larger than their sum, the spin's at the start most of all where I3 is small.
    """
    b = disk.body
    gyration = 0.5 * b.I1 * turn.ratio * turn.ratio
    rise = turn.sigma4 - spin_at_anchor(motion.X, motion.Y, b)
    terms = abs(motion.level) + gyration + abs(point(start.h, motion.X, motion.Y, disk).V)
    few = 1.0 + min(2.0 / y_cut, 2.0)  # on a short way
    # Of a way that is very short doubles hold little: y^2/2 is h/h_turn - 1.
    units = _NOISE * few + 4.0 / (y_cut * y_cut)
    spin, least = b.J * abs(rise) * rounding_at_anchor(motion.Y, b), max(-turn.slope, EPSILON * gyration)
    return units * EPSILON * (1.0 + terms / least) + _SPUN * EPSILON * (spin / least)


@device
def spin_noise(time: float, motion: Motion, b: Body) -> float:
    """Error of psi from rounding in sigma4 at the vertical, where motions are measured from there."""
    return _SPUN * EPSILON * rounding_at_anchor(motion.Y, b) * time


@device
def slow_node(node: float, weight: float, stretch: float, scale: float) -> tuple[float, float]:
    """(distance from a slow start, weight) of a node: distance = scale sinh^2 x, 0 < x < stretch."""
    sinh = math.sinh(0.5 * stretch * (1.0 + node))
    return scale * sinh * sinh, weight * stretch * scale * sinh * math.sqrt(1.0 + sinh * sinh)


@subroutine
def lay_nodes(W: Vector, panels: Panels, half: Matrix, whole: Matrix) -> int:
    """Place the nodes of both panels, as distances below y_end; returns how many.

    Flat panel, 0 < y < y_end - length: the positive half of a symmetric rule, since the integrand is
    even. Where y_end is large it starts at _DEEPEST below its end: nothing is left under that, and it
    makes no difference that the integrand is not even there. End panel: y_end - scale sinh^2 x.
    """
    n, scale = half.shape[1], panels.scale
    width = min(panels.y_end - panels.length, _DEEPEST)
    for j in range(n):
        W[nodes.GAP * ROOM + j] = panels.length + width * (1.0 - half[0, j])
        W[nodes.WEIGHT * ROOM + j] = width * half[1, j]
        W[nodes.CLOSED * ROOM + j] = panels.closed * width * half[1, j]
    stretch = math.asinh(math.sqrt(panels.length / scale))
    for j in range(n):
        distance, weight = slow_node(whole[0, j], whole[1, j], stretch, scale)
        W[nodes.GAP * ROOM + n + j], W[nodes.WEIGHT * ROOM + n + j] = distance, weight
        W[nodes.CLOSED * ROOM + n + j] = 0.0
    return 2 * n


@subroutine
def place_nodes(W: Vector, panels: Panels, half: Matrix, whole: Matrix, start: Start, h_turn: float) -> int:
    """Nodes of both panels, with what series know of E - V there; returns how many."""
    n = lay_nodes(W, panels, half, whole)
    nodes.place(W, n, start.h, h_turn, panels.y_end)
    if start.moving > 0.0:
        know(W, n, panels.y_end)
    if h_turn > _DEEP:
        know_beside_turn(W, n, panels.y_end)
    return n


@subroutine
def panels_of(
    h_turn: float, y_end: float, turn: Point, start: Start, motion: Motion, disk: Disk
) -> tuple[Panels, float]:
    """The panels between a start at y_end and the turning point, and the rounding of E - V at the start."""
    length = min(_END_PANEL, 0.5 * y_end)
    scale, rounding = end_scale(h_turn, y_end, length, start, motion, disk)
    closed = turn.D / (turn.shape**3 * math.sqrt(max(-turn.slope * disk.body.inv_M, LEAST)))
    return Panels(y_end, length, scale, closed), rounding


@device
def missed(apart: float, before: float, size: float) -> float:
    """What a rule misses at most of an integral of that size.

    apart: its distance from the rule before; before: that one's, NaN for the first. Errors have signs, and two
    rules may agree by chance while both are far off. What is missed, relative to the size, falls like its own
    power _CLOSING from one rule to the next, so that the rule before them tells as well.
    """
    closing = size * (before / size) ** _CLOSING
    return apart if apart > closing else closing


@device
def good_enough(error: float, noise: float, target: float, floor: float) -> bool:
    """True where two rules agree to `target`, or as far as rounding lets them, and rounding leaves that much."""
    return error <= max(target, noise) and error + noise <= max(target, floor)


@subroutine
def short_passage(
    u_turn: float, motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float]]:
    """The passage of a motion that turns back beside the vertical, at u_turn; status and results as `passage`."""
    b = disk.body
    u_before = -first_root(W, 1.0, -1.0)
    divide(W, u_turn)
    if u_before < 0.0:
        divide_again(W, u_before)
    chi = psi = time = math.nan
    angles_apart = time_apart = math.nan
    angle_error = time_error = math.inf
    status, first = _LIMIT, 0
    for size in rules.sizes:
        last = first + int(size)
        chi_before, psi_before, time_before = chi, psi, time
        angles_before, apart_before = angles_apart, time_apart
        chi, rest, time, least = there_and_back(W, u_turn, u_before, rules.packed[0, :, first:last], b)
        first, psi = last, chi - rest
        noise = return_noise(W, u_turn, least)
        angle_noise = noise * (abs(chi) + abs(rest)) + spin_noise(time, motion, b)
        angles_apart, time_apart = max(abs(chi - chi_before), abs(psi - psi_before)), abs(time / time_before - 1.0)
        turned = max(1.0, abs(chi), abs(psi))
        angle_error, time_error = (
            missed(angles_apart, angles_before, turned),
            missed(time_apart, apart_before, 1.0),
        )
        if good_enough(angle_error, angle_noise, target, FLOOR * turned) and good_enough(
            time_error, noise, target, FLOOR
        ):
            angle_error, time_error = 2.0 * (angle_error + angle_noise), 2.0 * (time_error + noise)
            status = _OK
            break
    energy = motion.level + potential_at_anchor(motion.X, motion.Y, b)
    theta_min, way = math.acos(u_turn), way_at(W, u_turn)
    return status, PassageRow(theta_min, chi, psi, time, energy, angle_error, time_error, way)


@subroutine
def passage(
    start: Start, motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float]]:
    """The passage from its start to the turning point and back; Y != 0. Returns status and results.

    Orders of the rules rise until what they miss is less than `target` (rad, relative in time).
    """
    b = disk.body
    energy = motion.level + potential_at_anchor(motion.X, motion.Y, b)
    if start.moving > 0.0:
        expand_start(W, start.moving, motion.X, motion.Y, b)
        u_turn = first_root(W, 1.0, 1.0)
        if u_turn > 0.0:
            return short_passage(u_turn, motion, target, rules, disk, W)
    h_turn = turning_point(start.h, start.rest, motion, disk, W)
    y_end = math.acosh(max(start.h / h_turn, 1.0)) if h_turn > 0.0 else 0.0
    chi = psi = time = math.nan
    if not y_end > 0.0:
        return _BAD, PassageRow(math.nan, chi, psi, time, energy, math.nan, math.nan, math.nan)
    turn = point(h_turn, motion.X, motion.Y, disk)
    panels, rounding = panels_of(h_turn, y_end, turn, start, motion, disk)
    race = panels.closed * motion.Y / h_turn * 2.0 * math.atan(math.tanh(0.5 * (y_end - panels.length)))
    # Nodes lie so near the turning point that E - V ~ y^2 has few digits as a difference.
    if h_turn > _DEEP:
        expand_turn(W, turn, motion, b)
    noise = rounding_noise(start, turn, y_end - panels.length, motion, disk)
    angles_apart = time_apart = angle_error = time_error = math.nan
    status, first = _LIMIT, 0
    for size in rules.sizes:
        last = first + int(size)
        half, whole = rules.packed[0, :, first:last], rules.packed[1, :, first:last]
        n, first = place_nodes(W, panels, half, whole, start, h_turn), last
        nodes.integrands(W, n, motion, disk)
        chi_before, psi_before, time_before = chi, psi, time
        angles_before, apart_before = angles_apart, time_apart
        chi = 2.0 * (race + nodes.total(W, nodes.CHI, n))
        psi = chi - 2.0 * nodes.total(W, nodes.REST, n)
        time = 2.0 * nodes.total(W, nodes.TIME, n)
        angles_apart, time_apart = max(abs(chi - chi_before), abs(psi - psi_before)), abs(time / time_before - 1.0)
        turned = max(1.0, abs(chi), abs(psi))
        angle_error, time_error = (
            missed(angles_apart, angles_before, turned),
            missed(time_apart, apart_before, 1.0),
        )
        if math.isnan(angle_error):
            continue  # nothing yet to compare the first rules with
        slow_angles, slow_time = known_noise(W, 0 if h_turn > _DEEP else n // 2, n, 2.0 * rounding, motion.level)
        quiet = _QUIET * EPSILON * abs(psi - chi) + spin_noise(time, motion, b)
        angle_noise = noise * (abs(race) + abs(chi)) + quiet + slow_angles
        time_noise = noise + slow_time / time
        if good_enough(angle_error, angle_noise, target, FLOOR * turned) and good_enough(
            time_error, time_noise, target, FLOOR
        ):
            # Twice over: where rounding is all that is left, two rules may be wrong alike.
            angle_error, time_error = 2.0 * (angle_error + angle_noise), 2.0 * (time_error + time_noise)
            status = _OK
            break
    return status, PassageRow(
        2.0 * math.asin(0.5 * h_turn), chi, psi, time, energy, angle_error, time_error, turn.ratio
    )

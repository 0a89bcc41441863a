"""A start at the vertical, however slow: E - V beside it as a power series in u = sin(phi), with no constant lost.

E - V is a difference of numbers of order 1 and, at a slow start, smaller than their rounding. What it is at the
vertical is known, M phidot^2/2, and what it gains is a power series: sigma3 as a function of u obeys

    (1 - u^2) sigma3'' = c sigma3,     k sigma4 = -sigma3',     ' = d/du,

eqs (4.2), (4.3), and u = 1 - S. A motion that turns back where the series holds is an integral of its own,
over s with u = u_turn (1 - s^2), in which nothing vanishes.
"""

import math

from kernels._jit import subroutine
from kernels.disk.body import Body
from kernels.integrals import nodes
from kernels.integrals.nodes import ROOM
from kernels.types import Matrix, Vector

TERMS = 22
WIDEST = 0.15  # of the variable of a series: its power TERMS is below rounding
_SIGMA, _LEFT, _QUOTIENT = 0, 32, 64  # where series begin in row SERIES: sigma3, E - V, and E - V over u_turn - u
_SIZES = 96  # of the first two coefficients of E - V, as `rounding_at` has them
_HALVINGS = 64  # more than a number has bits: bisection ends at rounding
_ROUNDING = 4.0 * 2.2e-16
_LEAST = 1e-300


@subroutine
def expand_start(W: Vector, moving: float, X: float, Y: float, b: Body) -> None:
    """Series of the motion with constants X, Y beside the vertical. moving: its kinetic energy there.

    At S = 1 the dominant solution vanishes and its slope is -1/r(0), since the Wronskian is -1: nothing is lost.
    """
    at, c = nodes.SERIES * ROOM, b.c
    sigma3, turning, falling = X * b.r0, X * b.dr0, Y / b.r0
    W[at + _SIGMA], W[at + _SIGMA + 1] = sigma3, falling - turning
    for n in range(TERMS):
        W[at + _SIGMA + n + 2] = (n * (n - 1) + c) / ((n + 1) * (n + 2)) * W[at + _SIGMA + n]
    rigid, spin = 0.5 * b.I1, 0.5 * b.J / (b.k * b.k)
    W[at + _LEFT] = moving
    even, odd = rigid * sigma3 * sigma3, 0.0
    height_even = 1.0
    reach = abs(turning) + abs(falling)  # of what sigma4 is a difference
    W[at + _SIZES], W[at + _SIZES + 1] = 4.0 * (rigid + spin * c) * abs(sigma3) * reach, 0.0
    for n in range(1, TERMS):
        square = turning = size = 0.0
        for i in range(n + 1):
            one = rigid * W[at + _SIGMA + i] * W[at + _SIGMA + n - i]
            other = spin * (i + 1) * (n - i + 1) * W[at + _SIGMA + i + 1] * W[at + _SIGMA + n - i + 1]
            square, turning, size = square + one, turning + other, size + abs(one) + abs(other)
        if n % 2 == 0:
            even += square
            height_even *= (n - 3.0) / n
            W[at + _LEFT + n] = -(even + turning + height_even)
        else:
            odd += square
            W[at + _LEFT + n] = -(odd + turning)
        if n == 2:
            W[at + _SIZES + 1] = size + rigid * sigma3 * sigma3 + 1.0


@subroutine
def at_vertical(W: Vector, u: float, moving: float, X: float, Y: float, b: Body) -> tuple[float, float]:
    """(E - V at the vertical, its rounding) where the kinetic energy at u is `moving`.

    NaN where the series do not reach u, or a barrier may stand between.
    """
    if not u < WIDEST:
        return math.nan, math.inf
    expand_start(W, 0.0, X, Y, b)
    rounding = doubt(W, u) + _ROUNDING * moving
    there = moving - value(W, _LEFT, TERMS, u)
    at = nodes.SERIES * ROOM + _LEFT
    first, second = W[at + 1], W[at + 2]
    lowest = -0.5 * first / second if second > 0.0 else 0.0
    if 0.0 < lowest < u and not there + value(W, _LEFT, TERMS, lowest) > 0.0:
        return math.nan, math.inf
    return there, rounding


@subroutine
def value(W: Vector, first: int, terms: int, u: float) -> float:
    """The series that begins at `first`, at u."""
    at, result = nodes.SERIES * ROOM + first, 0.0
    for n in range(terms - 1, -1, -1):
        result = result * u + W[at + n]
    return result


@subroutine
def doubt(W: Vector, u: float) -> float:
    """Rounding of E - V at u."""
    return rounding_at(W, _SIZES, u)


@subroutine
def rounding_at(W: Vector, sizes: int, u: float) -> float:
    """Rounding at u of a series without its constant. Of the next two coefficients, the sums of sizes of what they
    are made of stand at `sizes` of row SERIES."""
    at = nodes.SERIES * ROOM + sizes
    return _ROUNDING * u * (W[at] + u * W[at + 1])


@subroutine
def left_at(W: Vector, u: float) -> float:
    """E - V at u."""
    return value(W, _LEFT, TERMS, u)


@subroutine
def first_slope(W: Vector) -> float:
    """d(E - V)/du at the vertical."""
    return W[nodes.SERIES * ROOM + _LEFT + 1]


@subroutine
def quotient_at(W: Vector, u: float) -> float:
    """(E - V)/(u_turn - u) at u, after `divide`."""
    return value(W, _QUOTIENT, TERMS - 1, u)


@subroutine
def first_root(W: Vector, sign: float, side: float) -> float:
    """Least |u| on this side (+1, -1) of the vertical where E - V, of that sign there, changes it; 0 where the
    series knows none."""
    low, high = 0.0, 0.0
    for n in range(_HALVINGS, -1, -1):
        u = WIDEST * 0.5**n
        if sign * left_at(W, side * u) < 0.0:
            high = u
            break
        low = u
    if high == 0.0:
        return 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if sign * left_at(W, side * middle) < 0.0:
            high = middle
        else:
            low = middle
    return 0.5 * (low + high)


@subroutine
def divide(W: Vector, u_turn: float) -> None:
    """The series of (E - V)/(u_turn - u), E - V having its root at u_turn."""
    at, share = nodes.SERIES * ROOM, 0.0
    for n in range(TERMS - 1, 0, -1):
        share = share * u_turn - W[at + _LEFT + n]
        W[at + _QUOTIENT + n - 1] = share


@subroutine
def divide_again(W: Vector, u_before: float) -> None:
    """The series of (E - V)/(u_turn - u)/(u - u_before), E - V having a root before the vertical too."""
    at, share = nodes.SERIES * ROOM, 0.0
    for n in range(TERMS - 2, -1, -1):
        above = W[at + _QUOTIENT + n]
        W[at + _QUOTIENT + n] = share
        share = share * u_before + above


@subroutine
def there_and_back(
    W: Vector, u_turn: float, u_before: float, half: Matrix, b: Body
) -> tuple[float, float, float, float]:
    """(chi, rest, time, slope) from the vertical to u_turn and back, after `divide` and `divide_again`.

    With u - u_before = (u_turn - u_before) cos^2(x/2) no root is left, and the integrand is even in x. u_before: 0
    where there is no such root; then u = u_turn (1 - s^2). half: positive half of a symmetric rule. slope: the
    least, at any node, of what moves the turning point and the time little where it is large.
    """
    chi = rest = time = 0.0
    two, span, least = u_before < 0.0, u_turn - u_before, math.inf
    longest = 2.0 * math.atan(math.sqrt(u_turn / -u_before)) if two else 0.0  # x of the vertical
    factor = 0.5 * longest if two else math.sqrt(u_turn)
    for j in range(half.shape[1]):
        sine = math.sin(0.5 * longest * half[0, j])
        u = u_turn - span * sine * sine if two else u_turn * (1.0 - half[0, j]) * (1.0 + half[0, j])
        quotient = quotient_at(W, u)
        least = min(least, span * quotient if two else quotient)
        height2 = (1.0 - u) * (1.0 + u)
        dt = half[1, j] * factor * math.sqrt(2.0 * b.M / (height2 * max(quotient, _LEAST)))
        sigma3, slope = value(W, _SIGMA, TERMS, u), 0.0
        for n in range(TERMS, 0, -1):
            slope = slope * u + n * W[nodes.SERIES * ROOM + _SIGMA + n]
        turn = dt * sigma3 / height2
        chi, rest, time = chi + turn, rest + turn * (1.0 - u) - dt * slope / b.k, time + dt
    return 2.0 * chi, 2.0 * rest, 2.0 * time, least


@subroutine
def return_noise(W: Vector, u_turn: float, least: float) -> float:
    """Relative error of a return to the vertical from rounding."""
    return 8.0 * _ROUNDING + 4.0 * doubt(W, u_turn) / (u_turn * max(least, _LEAST))


@subroutine
def way_at(W: Vector, u: float) -> float:
    """sigma3/q at u."""
    return value(W, _SIGMA, TERMS, u) / math.sqrt((1.0 - u) * (1.0 + u))


@subroutine
def know(W: Vector, n: int, y_end: float) -> None:
    """KNOWN = E - V at nodes beside the vertical, which is at y_end; NOISE = its rounding, 0 elsewhere."""
    slant = math.tanh(y_end)
    for j in range(n):
        gap = W[nodes.GAP * ROOM + j]
        if gap < WIDEST:
            sinh = math.sinh(0.5 * gap)
            shrink = slant * math.sinh(gap) - 2.0 * sinh * sinh  # 1 - h/h_end
            u = shrink * (2.0 - shrink)
            if 0.0 <= u < WIDEST:
                W[nodes.KNOWN * ROOM + j] = max(left_at(W, u), _LEAST)
                W[nodes.NOISE * ROOM + j] = doubt(W, u)


@subroutine
def known_noise(W: Vector, first: int, n: int, rounding: float, motion_level: float) -> tuple[float, float]:
    """(error of angles, of time) of nodes first to n, there and back, from rounding in E - V.

    rounding: of E - V where it is a difference.
    """
    angles = time = 0.0
    for j in range(first, n):
        known = W[nodes.KNOWN * ROOM + j]
        left = known if known > 0.0 else max(motion_level - W[nodes.LEVEL * ROOM + j], _LEAST)
        share = (W[nodes.NOISE * ROOM + j] if known > 0.0 else rounding) / left
        angles += share * (abs(W[nodes.CHI * ROOM + j]) + abs(W[nodes.REST * ROOM + j]))
        time += share * W[nodes.TIME * ROOM + j]
    return 2.0 * angles, 2.0 * time

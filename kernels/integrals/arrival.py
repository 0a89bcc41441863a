"""The turning point of a motion that does not come near flat: E - V beside it as a power series, with no constant.

Beside the turning point E - V is a difference that vanishes, and nodes of a short way lie close to it. With
S = 1 - sin(phi) = S_turn (1 + x) and q^2 = S (2 - S) = S_turn g(x), g of second degree, sigma3 obeys

    g sigma3'' = c S_turn sigma3,     k S_turn sigma4 = sigma3',     ' = d/dx,

eqs (4.2), (4.3). With h = h_turn cosh y, x is sinh^2 y.
"""

import math

from kernels._jit import subroutine
from kernels.disk.body import Body
from kernels.integrals import nodes
from kernels.integrals.departure import TERMS, WIDEST, rounding_at, value
from kernels.integrals.nodes import ROOM
from kernels.integrals.point import Motion, Point
from kernels.types import Vector

# Where series begin in row SERIES, behind those of `departure`: sigma3, S_turn/q^2, q/sqrt(S_turn), E - V.
_SIGMA, _INVERSE, _HEIGHT, _LEFT = 100, 128, 156, 184
_SIZES = 212  # of the first two coefficients of E - V, as `rounding_at` has them


@subroutine
def expand_turn(W: Vector, turn: Point[float], motion: Motion, b: Body) -> None:
    """Series of a motion beside its turning point."""
    at, S = nodes.SERIES * ROOM, turn.S
    inner = 2.0 - S
    bent = inner - S
    sigma3, slope = turn.ratio * math.sqrt(S * inner), S * b.k * turn.sigma4
    W[at + _SIGMA], W[at + _SIGMA + 1] = sigma3, slope
    W[at + _INVERSE], W[at + _INVERSE + 1] = 1.0 / inner, -bent / (inner * inner)
    W[at + _HEIGHT], W[at + _HEIGHT + 1] = math.sqrt(inner), 0.5 * bent / math.sqrt(inner)
    for n in range(TERMS):
        here, above = W[at + _SIGMA + n], W[at + _SIGMA + n + 1]
        W[at + _SIGMA + n + 2] = ((b.c + n * (n - 1)) * S * here - bent * (n + 1) * n * above) / (
            inner * (n + 2) * (n + 1)
        )
    for n in range(1, TERMS):
        here, below = W[at + _INVERSE + n], W[at + _INVERSE + n - 1]
        W[at + _INVERSE + n + 1] = (S * below - bent * here) / inner
        here, below = W[at + _HEIGHT + n], W[at + _HEIGHT + n - 1]
        W[at + _HEIGHT + n + 1] = ((0.5 - n) * bent * here + (n - 2) * S * below) / (inner * (n + 1))
    _gather_left(W, b, S)
    # sigma3 and sigma4 are sums of two terms, of which one is at most this.
    size = abs(sigma3) + 2.0 * abs(motion.Y * turn.D)
    turning = 2.0 * S * (b.k * abs(turn.sigma4) + abs(motion.X) * b.dr0)
    own = abs(sigma3) * turning + size * abs(slope)
    W[at + _SIZES] += (b.I1 / (S * inner) + b.J * b.c / (b.k * b.k * S * inner)) * own


@subroutine
def _gather_left(W: Vector, b: Body, S: float) -> None:
    """Series of E - V, and the sizes of what its first two coefficients are made of."""
    at = nodes.SERIES * ROOM
    rigid, spin, height = 0.5 * b.I1 / S, 0.5 * b.J / (b.k * b.k * S * S), math.sqrt(S)
    W[at + _LEFT] = 0.0
    for n in range(1, TERMS):
        total = height * W[at + _HEIGHT + n]
        size = abs(total)
        for i in range(n + 1):
            square = 0.0
            for j in range(i + 1):
                square += W[at + _SIGMA + j] * W[at + _SIGMA + i - j]
            gyration = rigid * square * W[at + _INVERSE + n - i]
            turning = spin * (i + 1) * (n - i + 1) * W[at + _SIGMA + i + 1] * W[at + _SIGMA + n - i + 1]
            total, size = total + gyration + turning, size + abs(gyration) + abs(turning)
        W[at + _LEFT + n] = -total
        if n <= 2:
            W[at + _SIZES + n - 1] = size


@subroutine
def left_beside_turn(W: Vector, x: float) -> float:
    """E - V at x, after `expand_turn`."""
    return value(W, _LEFT, TERMS, x)


@subroutine
def doubt_beside_turn(W: Vector, x: float) -> float:
    """Rounding of E - V at x."""
    return rounding_at(W, _SIZES, x)


@subroutine
def know_beside_turn(W: Vector, n: int, y_end: float) -> None:
    """KNOWN = E - V and NOISE = its rounding at nodes beside the turning point, but for those known better."""
    for j in range(n):
        sinh = math.sinh(min(y_end - W[nodes.GAP * ROOM + j], 1.0))
        x = sinh * sinh
        if x < WIDEST:
            left, doubt = left_beside_turn(W, x), doubt_beside_turn(W, x)
            unknown = not W[nodes.KNOWN * ROOM + j] > 0.0
            if left > 0.0 and (unknown or doubt < W[nodes.NOISE * ROOM + j]):
                W[nodes.KNOWN * ROOM + j], W[nodes.NOISE * ROOM + j] = left, doubt

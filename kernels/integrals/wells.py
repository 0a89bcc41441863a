"""The well of a motion that wobbles: its bottom and turning points, with no difference of nearly equal numbers.

With x = ln tan(theta/2) and dt = q ds a motion is that of a particle of mass M in the potential V(x), since
dx/ds = p, and what the kernels know of it obeys

    q' = q z,   z' = -q^2,   rho' = k q sigma4 - z rho,   sigma4' = (m r^2/J) q rho,   ' = d/dx,

eqs (4.2), (4.3) once more. So power series in x about any tilt follow from the state there, and converge up to
pi/2, from flat to the vertical and beyond. Near equilibrium E - V is a difference of numbers that nearly agree.
But with x from the bottom of the well, V - V_bottom = x^2 (V_2 + V_3 x + ...), and what the state has above the
bottom is a sum of its kinetic energy and such a square. With the turning points x_1 < x_2

    E - V = (x - x_1) (x_2 - x) share(x),

where the share is the divided difference of V over x_1, x_2 and x: V''/2 at the bottom where all three meet.
"""

import math
from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body, Disk
from kernels.integrals.nodes import ROOM
from kernels.integrals.point import VERTICAL, Motion, Point
from kernels.types import Vector

# Rows of the work array in which series begin.
Q, Z, RHO, SIGMA4, LEVEL, SHARE = (row * ROOM for row in range(6))
MOST_TERMS = 48
WIDEST = 0.75  # in x, from the state and from the bottom; its power MOST_TERMS, in units of pi/2, is rounding
_GUESSED = 1.5  # times what the parabola at the state says of the well
_GROWTH = 1.5  # of steps in the search for a bracket
_FIRST_STEP = 0.25  # in units of the parabola's amplitude
_ROOT_LIMIT = 100  # bisection alone ends at rounding in 53; Newton's method in five or so
_EPSILON = 2.2e-16
_NOISE = 8.0 * _EPSILON  # of a term of V': the series, the solutions
_NO_WELL = math.nan


class Well(NamedTuple):
    """The well of a motion, x measured from its bottom.

    inner, outer: turning points; state, vertical: of these. terms: of the series in the work array. blur: relative
    error of V'' from rounding, shift: error of the bottom, waver: of dchi/ds and dpsi/ds. inner is NaN where the
    series do not hold the motion.
    """

    inner: float
    outer: float
    state: float
    vertical: float
    terms: int
    bend: float
    blur: float
    shift: float
    waver: float


@device
def outside(terms: int) -> Well:
    """No well that the series hold."""
    return Well(_NO_WELL, _NO_WELL, 0.0, 0.0, terms, 0.0, 0.0, 0.0, 0.0)


@subroutine
def expand(W: Vector, terms: int, b: Body) -> None:
    """Series of q, z, rho, sigma4 and V in x, from the constant terms of the first four; that of V is 0."""
    for n in range(terms):
        qz = qq = qs = zr = qr = 0.0
        for i in range(n + 1):
            j = n - i
            q, z = W[Q + i], W[Z + i]
            qz += q * W[Z + j]
            qq += q * W[Q + j]
            qs += q * W[SIGMA4 + j]
            qr += q * W[RHO + j]
            zr += z * W[RHO + j]
        inverse = 1.0 / (n + 1)
        W[Q + n + 1], W[Z + n + 1] = inverse * qz, -inverse * qq
        W[RHO + n + 1], W[SIGMA4 + n + 1] = inverse * (b.k * qs - zr), inverse * b.inv_J * qr
    W[LEVEL] = 0.0
    for n in range(1, terms + 1):
        turning = spinning = 0.0
        for i in range(n + 1):
            turning += W[RHO + i] * W[RHO + n - i]
            spinning += W[SIGMA4 + i] * W[SIGMA4 + n - i]
        W[LEVEL + n] = 0.5 * (b.I1 * turning + b.J * spinning) + W[Q + n]


@subroutine
def value(W: Vector, first: int, last: int, x: float) -> float:
    """The polynomial in x with coefficients first ... last."""
    result = 0.0
    for n in range(last, first - 1, -1):
        result = result * x + W[n]
    return result


@subroutine
def slope_and_bend(W: Vector, terms: int, x: float) -> tuple[float, float]:
    """(V', V'') at x."""
    slope = bend = 0.0
    for n in range(terms, 1, -1):
        bend = bend * x + n * (n - 1) * W[LEVEL + n]
        slope = slope * x + n * W[LEVEL + n]
    return slope * x + W[LEVEL + 1], bend


@device
def guess(h: float, rate: float, at: Point[float], b: Body) -> float:
    """How far from the state, in x, the motion may go, by the parabola that touches V there; NaN if it is open."""
    q, z = h * at.shape, 1.0 - at.S
    turn, spin = at.ratio * at.ratio, q * at.sigma4
    bend = (b.M * q * q + 2.0 * b.I1 * z * z) * turn - 2.0 * b.I3 * z * at.ratio * spin + b.J * b.k * spin * spin
    bend += q * (z - q) * (z + q)
    if not bend > 0.0:
        return math.nan
    middle = at.slope * at.shape * at.shape / bend
    return _GUESSED * (abs(middle) + math.sqrt(b.M * rate * rate / bend + middle * middle))


@subroutine
def bottom(W: Vector, terms: int) -> float:
    """x of the bottom of V nearest to 0 on the way down; NaN if it is beyond WIDEST."""
    slope, bend = slope_and_bend(W, terms, 0.0)
    if slope == 0.0:
        return 0.0
    down = -1.0 if slope > 0.0 else 1.0
    low, high = 0.0, min(abs(slope) / max(abs(bend), 1e-300), WIDEST / 8.0)
    while slope_and_bend(W, terms, down * high)[0] * down < 0.0:
        low, high = high, _GROWTH * high
        if not 0.0 < high <= WIDEST:
            return math.nan
    x = high
    for _ in range(_ROOT_LIMIT):
        slope, bend = slope_and_bend(W, terms, down * x)
        if slope * down < 0.0:
            low = x
        else:
            high = x
        # Where the slope falls Newton's step leads away.
        guess = x - down * slope / bend if bend > 0.0 else math.nan
        if not low <= guess <= high:
            guess = 0.5 * (low + high)
        if abs(guess - x) <= 2.0 * _EPSILON * x:
            return down * guess
        x = guess
    return math.nan


@subroutine
def turning(W: Vector, terms: int, excess: float, way: float) -> float:
    """Distance of the turning point from the bottom towards `way`, excess: energy above the bottom; NaN if none.

    Between the bottom and that point V must rise: a barrier or a second well is not for the series.
    """
    # Beyond WIDEST the series may be of any size, and a bracket there holds no root or a false one.
    low, high = 0.0, min(_FIRST_STEP * math.sqrt(excess / W[LEVEL + 2]), WIDEST)
    if high == 0.0:
        return 0.0
    while high * high * value(W, LEVEL + 2, LEVEL + terms, way * high) < excess:
        if not (high <= WIDEST and slope_and_bend(W, terms, way * high)[0] * way > 0.0):
            return math.nan
        low, high = high, _GROWTH * high
    x = high
    for _ in range(_ROOT_LIMIT):
        above = x * x * value(W, LEVEL + 2, LEVEL + terms, way * x) - excess
        if above < 0.0:
            low = x
        else:
            high = x
        slope = slope_and_bend(W, terms, way * x)[0] * way
        guess = x - above / slope if slope > 0.0 else math.nan
        if not low <= guess <= high:
            guess = 0.5 * (low + high)
        if abs(guess - x) <= _EPSILON * x:
            return guess
        x = guess
    return math.nan


@subroutine
def divide(W: Vector, terms: int, inner: float, outer: float) -> None:
    """The series of share: V less its value at the turning points, divided by both factors; terms - 1 of them."""
    # The division by x - outer leaves coefficients that that by x - inner needs one at a time.
    once = W[LEVEL + terms]
    W[SHARE + terms - 2] = once
    for n in range(terms - 2, 0, -1):
        once = W[LEVEL + n + 1] + outer * once
        W[SHARE + n - 1] = once + inner * W[SHARE + n]


@subroutine
def find_well(h: float, rate: float, at: Point[float], motion: Motion, far: float, disk: Disk, W: Vector) -> Well:
    """The well of the motion through h, where `at` is its point; leaves the series about the bottom in W.

    far: how far from the state they are to hold, in x, as `guess` has it.
    """
    b = disk.body
    if not far <= WIDEST:
        return outside(0)
    terms = min(MOST_TERMS, 12 + int(MOST_TERMS * far))
    # At the vertical z is exactly 0.
    W[Q], W[Z] = h * at.shape, 0.5 * (VERTICAL - h) * (VERTICAL + h)
    W[RHO], W[SIGMA4] = at.ratio, at.sigma4
    expand(W, terms, b)
    state = -bottom(W, terms)
    if not abs(state) <= WIDEST:
        return outside(terms)
    for row in (Q, Z, RHO, SIGMA4):
        W[row] = value(W, row, row + terms, -state)
    expand(W, terms, b)
    if not W[LEVEL + 2] > 0.0:
        return outside(terms)
    W[LEVEL + 1] = 0.0  # but for rounding
    excess = 0.5 * b.M * rate * rate + state * state * value(W, LEVEL + 2, LEVEL + terms, state)
    inner, outer = -turning(W, terms, excess, -1.0), turning(W, terms, excess, 1.0)
    if not max(-inner, outer) <= WIDEST:
        return outside(terms)
    divide(W, terms, inner, outer)
    vertical = math.atanh(W[Z]) if abs(W[Z]) < WIDEST else math.inf
    return measured(Well(inner, outer, state, vertical, terms, W[LEVEL + 2], 0.0, 0.0, 0.0), at, motion, W, b)


@subroutine
def measured(well: Well, at: Point[float], motion: Motion, W: Vector, b: Body) -> Well:
    """The well with its noise: rounding of V' and V'', which are sums of terms of either sign.

    rho and sigma4 are sums too, of the parts of X and Y; a bound of these parts stands for their sizes.
    """
    q, rho, spin = W[Q], abs(W[RHO]), abs(W[SIGMA4])
    h = 2.0 * math.sqrt((1.0 - at.shape) * (1.0 + at.shape)) if at.S > 0.25 else math.sqrt(2.0 * at.S)
    other = abs(motion.Y * at.D / h) / at.shape if h > 0.0 else 0.0
    rho_parts = max(rho, abs(at.ratio) + 2.0 * other)
    spin_parts = spin + 2.0 * abs(motion.X) * b.dr0 / b.k
    mixed = q * (rho * spin_parts + rho_parts * spin)
    size = (
        (6.0 * b.I1 + 2.0) * rho * rho_parts
        + (2.0 * b.I3 + b.J) * mixed
        + 2.0 * b.J * b.k * q * q * spin * spin_parts
        + q
    )
    shift = _NOISE * size / (2.0 * well.bend)
    skew = abs(W[LEVEL + 3]) / well.bend
    cut = (max(abs(well.inner), abs(well.outer), abs(well.state)) / (0.5 * math.pi)) ** well.terms
    blur = _NOISE + cut + shift * (1.0 + 2.0 * skew)
    waver = _NOISE * (rho_parts + q * spin_parts) + shift * (2.0 * rho + (1.0 + b.k) * q * spin)
    return Well(
        well.inner, well.outer, well.state, well.vertical, well.terms, well.bend, blur, shift + _NOISE, waver
    )

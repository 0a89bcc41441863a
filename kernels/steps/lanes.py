"""Lanes: samples that advance side by side, one attempted step at a time, in loops without a branch.

Each lane has its own step. Constants of motion that a sample is held to are put back after every step; what that
moves is added up and tells the error.
"""

import math
from typing import Any, NamedTuple

from kernels._jit import contracted_device, contracted_subroutine, device, subroutine
from kernels.disk.algebra import FRACTION, OFFSET, ONE, SHIFTER, depth
from kernels.disk.body import Body
from kernels.disk.chaplygin import Whole, whole_solutions
from kernels.disk.field import ANGLES, State, contracted_energy, energy, speed, with_reduced
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import all_finite
from kernels.steps.events import Stop, crossed, level
from kernels.types import Longs, Vector

LANES = 16  # two AVX-512 registers: enough independent work to hide latency, few enough to stay in them

# Rows of the work array: entry (row, i) stands at row * LANES + i. One flat array with constant offsets, so
# that the compiler can see that rows do not overlap; with several arrays, or a two-dimensional one, it gives
# up vectorising ("too many memory checks needed").
NOW, BEFORE = 0, 8  # states: after and before the latest attempted step
(
    STEP, TAKEN, CONTROL, UNIT, NOTE,
    # constants of motion that the sample is held to, as Motion has them; NaN in X_HELD: it runs free
    X_HELD, Y_PLUS, Y_MINUS, ENERGY,
    # the sum of what holding has moved, rho and sigma4 by their bounds; the largest error of the energy, by itself
    MOVED, EXCESS,
    EXPONENT, MANTISSA,
    WHOLE,  # in a landing: the length of the step in which the event is
) = range(16, 30)  # fmt: skip
ROWS = 30
# notes of a sweep on a lane
NOTHING, HIT, BROKEN, STUCK = 0.0, 1.0, 2.0, 3.0


@device
def read(W: Vector, row: int, i: int) -> State:
    """The state in column i, its first component in the given row."""
    return State(
        W[row * LANES + i],
        W[(row + 1) * LANES + i],
        W[(row + 2) * LANES + i],
        W[(row + 3) * LANES + i],
        W[(row + 4) * LANES + i],
        W[(row + 5) * LANES + i],
        W[(row + 6) * LANES + i],
        W[(row + 7) * LANES + i],
        0.0,
        0.0,
    )


@device
def write(W: Vector, row: int, i: int, y: State) -> None:
    """Put a state into column i, its first component into the given row."""
    W[row * LANES + i] = y.q
    W[(row + 1) * LANES + i] = y.z
    W[(row + 2) * LANES + i] = y.p
    W[(row + 3) * LANES + i] = y.rho
    W[(row + 4) * LANES + i] = y.sigma4
    W[(row + 5) * LANES + i] = y.t
    W[(row + 6) * LANES + i] = y.chi
    W[(row + 7) * LANES + i] = y.psi


@device
def onto_circle(y: State, held: bool) -> State:
    """y with q^2 + z^2 = 1 restored by the smaller of both, where it is held."""
    size = abs(y.z)
    near = y.q < size
    small = y.q if near else size
    large = math.sqrt((1.0 - small) * (1.0 + small))
    q, size = y.q if near else large, large if near else size
    z = size if y.z >= 0.0 else -size
    return with_reduced(y, q if held else y.q, z if held else y.z, y.p, y.rho, y.sigma4)


@subroutine
def sweep(attempt_by: Any, W: Vector, stop: Stop, b: Body) -> int:
    """One attempted step of every lane by `attempt_by`; returns how many need attention."""
    for i in range(LANES):
        x = read(W, NOW, i)
        h = W[STEP * LANES + i]
        unit = W[UNIT * LANES + i]
        y, accepted, following = attempt_by(ANGLES, x, h, W[CONTROL * LANES + i], unit, b)
        hit = accepted & crossed(level(x, stop.event), level(y, stop.event), stop.value)
        broken = accepted & (not all_finite(y))
        stuck = (not accepted) & (not following * unit > SHORTEST_STEP)
        note = HIT if hit else NOTHING
        note = BROKEN if broken else note
        note = STUCK if stuck else note
        W[NOTE * LANES + i] = note
        W[TAKEN * LANES + i] = h
        W[STEP * LANES + i] = following
        write(W, BEFORE, i, x)
        y = onto_circle(y, W[X_HELD * LANES + i] == W[X_HELD * LANES + i])
        write(W, NOW, i, y if accepted else x)
    attention = 0
    for i in range(LANES):
        attention += W[NOTE * LANES + i] != NOTHING
    return attention


@contracted_subroutine
def hold(W: Vector, bits: Longs, whole: Whole, b: Body) -> None:
    """Put every lane that is held back onto its constants. `bits`: W seen as integers. Needs I3 > 0.

    The energy is left alone: p would take up an error of the tilt, which makes the angles worse.
    """
    split(bits, NOW, EXPONENT, MANTISSA)
    inv_kappa, weight, inv_k = 1.0 / b.kappa, math.sqrt(b.J_over_M), 1.0 / b.k
    for i in range(LANES):
        x, bar, most = read(W, NOW, i), W[X_HELD * LANES + i], W[EXCESS * LANES + i]
        # All are loaded, so that nothing branches.
        plus, minus = W[Y_PLUS * LANES + i], W[Y_MINUS * LANES + i]
        held = Held(bar, plus, minus, W[MANTISSA * LANES + i], W[EXPONENT * LANES + i])
        rho, sigma4 = rates(held, x, inv_k, whole, b)
        moved = max_of(abs(rho - x.rho) * inv_kappa, abs(sigma4 - x.sigma4) * weight)
        excess = abs(contracted_energy(with_reduced(x, x.q, x.z, x.p, rho, sigma4), b) - W[ENERGY * LANES + i])
        W[(NOW + 3) * LANES + i] = rho if bar == bar else x.rho
        W[(NOW + 4) * LANES + i] = sigma4 if bar == bar else x.sigma4
        W[MOVED * LANES + i] += moved
        W[EXCESS * LANES + i] = max_of(most, excess)


@contracted_device
def max_of(one: float, other: float) -> float:
    """The larger; `other` where one is NaN."""
    return one if one > other else other


class Held(NamedTuple):
    """What a lane is held to, as Motion has it, X NaN where it runs free; and q of its state in two parts."""

    X: float
    plus: float
    minus: float
    mantissa: float
    exponent: float


@contracted_device
def rates(held: Held, x: State, inv_k: float, whole: Whole, b: Body) -> tuple[float, float]:
    """(rho, sigma4) at the tilt of x, from the constants of its lane.

    The saddle beside flat amplifies an error in rho by 1/theta_min. Set anew after every step, rho never carries
    one: eta stays what it was given as, down to 1e-300.
    """
    S, log_S = depth(x, held.mantissa, held.exponent - OFFSET)
    f = whole_solutions(S, log_S, b.c, whole)
    Y = held.plus if x.z >= 0.0 else held.minus
    # sigma3/q written so that S may underflow
    rho = held.X * f.rho_over_S * (x.q / (1.0 + abs(x.z))) + Y * (f.D / x.q)
    sigma4 = (held.X * f.drho + Y * f.dD) * inv_k
    return rho, sigma4 if x.z >= 0.0 else -sigma4


@device
def split(bits: Longs, q: int, exponent: int, mantissa: int) -> None:
    """The numbers in row q of a work array seen as integers, in two parts into the other rows."""
    for i in range(LANES):
        word = bits[q * LANES + i]
        bits[exponent * LANES + i] = (word >> 52) + SHIFTER
        bits[mantissa * LANES + i] = (word & FRACTION) + ONE


@subroutine
def idle(W: Vector, i: int) -> None:
    """Park lane i: an upright disk at rest that takes steps of length zero."""
    for row in range(ROWS):
        W[row * LANES + i] = 0.0
    W[NOW * LANES + i] = W[CONTROL * LANES + i] = W[UNIT * LANES + i] = W[ENERGY * LANES + i] = 1.0
    W[X_HELD * LANES + i] = math.nan


@subroutine
def load(W: Vector, i: int, x: State, b: Body) -> float:
    """Start a sample with initial state x in lane i; returns its speed."""
    unit = speed(x, b)
    write(W, NOW, i, x)
    W[UNIT * LANES + i], W[ENERGY * LANES + i] = unit, energy(x, b)
    W[MOVED * LANES + i] = W[EXCESS * LANES + i] = 0.0
    return unit

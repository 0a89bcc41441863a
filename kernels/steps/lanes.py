"""Lanes: samples that advance side by side, one attempted step at a time, in loops without a branch.

Each lane has its own step. A sample that is held is put back onto its constants of motion after every step, by
sums and products that the compiler may round together; what that moves is added up and tells the error.
"""

import math
from typing import Any

from kernels._jit import device, subroutine
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.chaplygin import solutions
from kernels.disk.constants import depth_below_vertical
from kernels.disk.field import State, energy, reduced, with_reduced
from kernels.records import reader, writer
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.events import Event, crossed, level
from kernels.types import Vector

LANES = 16  # two AVX-512 registers: enough independent work to hide latency, few enough to stay in them

# Rows of the work array.
NOW, BEFORE = 0, 10 * LANES  # states: after and before the latest attempted step
(
    # the next step, and the latest, which is 0 where it was refused; for `locate` that of the whole step
    STEP, TAKEN,
    CONTROL, UNIT, NOTE,
    # the value of the event that is to be met next, infinite where there is none
    NEXT,
    # constants of motion that the sample is held to, as Motion has them; NaN in X_HELD: it runs free
    X_HELD, Y_PLUS, Y_MINUS, ENERGY,
    # errors of the energy: the largest so far, and the sum of those taken out; and moved, rho and sigma4 by their
    # bounds
    LARGEST, REMOVED, MOVED,
    # which sample it is (-1: none), how many values it has met, and the sweep in which it began
    SAMPLE, MET, SINCE,
) = range(20 * LANES, 36 * LANES, LANES)  # fmt: skip
ROWS = 36 * LANES
# notes of a sweep on a lane; THROUGH: it has met all of its values
NOTHING, HIT, BROKEN, STUCK, THROUGH = 0.0, 1.0, 2.0, 3.0, 4.0
# Shares of the energy: kinetic energy below which p is left alone, and the most that p is corrected by.
_MOVING, _SMALL = 0.01, 0.01


read, write = reader(State, LANES), writer(State, LANES)


@subroutine
def idle(W: Vector, i: int) -> None:
    """Park lane i: an upright disk at rest, which stays one whatever steps it takes."""
    for row in range(0, ROWS, LANES):
        W[row + i] = 0.0
    W[NOW + i] = W[BEFORE + i] = W[CONTROL + i] = W[UNIT + i] = 1.0
    W[ENERGY + i] = 1.0
    W[NEXT + i], W[SAMPLE + i], W[X_HELD + i] = math.inf, -1.0, math.nan


@subroutine
def sweep(attempt: Any, W: Vector, event: Event, b: Body) -> int:
    """One attempted step of every lane by `attempt`; returns how many need attention."""
    for i in range(LANES):
        x = read(W, NOW, i)
        h = W[STEP + i]
        unit = W[UNIT + i]
        y, accepted, following = attempt(x, h, W[CONTROL + i], unit, b)
        hit = accepted & crossed(level(x, event), level(y, event), W[NEXT + i])
        broken = accepted & (not all_finite(y))
        stuck = (not accepted) & (not following * unit > SHORTEST_STEP)
        note = HIT if hit else NOTHING
        note = BROKEN if broken else note
        note = STUCK if stuck else note
        W[NOTE + i] = note
        W[TAKEN + i] = h if accepted else 0.0
        W[STEP + i] = following
        write(W, BEFORE, i, x)
        y = onto_circle(y, W[X_HELD + i] == W[X_HELD + i])
        write(W, NOW, i, y if accepted else x)
    attention = 0
    for i in range(LANES):
        attention += W[NOTE + i] != NOTHING
    return attention


@device
def all_finite(x: State) -> bool:
    """False if any component is NaN or infinite."""
    total = x.q + x.z + x.p + x.rho + x.sigma4 + x.t + x.chi + x.psi + x.a1 + x.a2
    return abs(total) < math.inf


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
def hold(W: Vector, disk: NaturalDisk) -> None:
    """Put every lane that is held back onto its constants, and where it is fastest onto its energy.

    That is once in each swing: what steps do to the energy on the way down is mostly undone on the way up, and p
    would take up an error of the tilt. An energy that drifts makes the error of time and angles grow like the
    square of the time; held, like the time. Needs I3 > 0 of lanes that are held.
    """
    b = disk.body
    inv_kappa, weight, inv_k = 1.0 / b.kappa, math.sqrt(b.J_over_M), 1.0 / b.k
    for i in range(LANES):
        x, bar, total = read(W, NOW, i), W[X_HELD + i], W[ENERGY + i]
        # All are loaded, so that nothing branches.
        plus, minus = W[Y_PLUS + i], W[Y_MINUS + i]
        rho, sigma4 = rates(x, bar, plus if x.z >= 0.0 else minus, inv_k, disk)
        y = with_reduced(x, x.q, x.z, x.p, rho, sigma4)
        excess = energy(y, b) - total
        kinetic = 0.5 * b.M * x.p * x.p
        # Where it hardly moves p cannot take the correction up.
        fastest = reduced(read(W, BEFORE, i), b)[2] * reduced(y, b)[2] < 0.0
        able = fastest & (kinetic > _MOVING * total) & (abs(excess) < _SMALL * kinetic) & (bar == bar)
        W[LARGEST + i] = max_of(W[LARGEST + i], abs(excess))
        W[REMOVED + i] += abs(excess) if able else 0.0
        W[MOVED + i] += max_of(abs(rho - x.rho) * inv_kappa, abs(sigma4 - x.sigma4) * weight)
        W[NOW + 2 * LANES + i] = x.p * math.sqrt(1.0 - excess / kinetic) if able else x.p
        W[NOW + 3 * LANES + i] = rho if bar == bar else x.rho
        W[NOW + 4 * LANES + i] = sigma4 if bar == bar else x.sigma4


@device
def max_of(one: float, other: float) -> float:
    """The larger; `other` where one is NaN."""
    return one if one > other else other


@device
def rates(x: State, X: float, Y: float, inv_k: float, disk: NaturalDisk) -> tuple[float, float]:
    """(rho, sigma4) at the tilt of x, from the constants of its motion as seen from the nearer face.

    The saddle beside flat amplifies an error in rho by 1/theta_min. Set anew after every step, rho never carries
    one: eta stays what it was given as, down to 1e-300.
    """
    S, log_S = depth_below_vertical(x.q, x.z)
    f = solutions(S, log_S, disk.body.c, disk.series)
    # sigma3/q written so that S may underflow
    rho = X * f.rho_over_S * (x.q / (1.0 + abs(x.z))) + Y * (f.D / x.q)
    sigma4 = (X * f.drho + Y * f.dD) * inv_k
    return rho, sigma4 if x.z >= 0.0 else -sigma4

"""One adaptive step: Dormand-Prince 5(4) with the error norm and step control of this problem.

Dormand-Prince rather than Tsitouras: its coefficients are exact fractions, so the tableau proves
its own order, and on this polynomial field the two differ by a few per cent.
The seventh stage is not kept for the next step: a field evaluation is some 25 operations against
some 500 of the stage sums, and lanes would have to store and reload ten numbers for it.
"""

import math

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.field import ANGLES, ORIGIN, State, field, shift
from kernels.steps.tableaux import DORMAND_PRINCE_54, floats

_A = tuple(map(floats, DORMAND_PRINCE_54.a[1:]))
_E = floats(DORMAND_PRINCE_54.errors[0][1])

# Usual values: a tenth of a step is given away for fewer refusals, and one estimate, which may be wrong
# by luck, changes the step by a factor of five at most.
SAFETY = 0.9
SHRINK = 0.2
GROW = 5.0
# In units of 1/speed. Beyond one unit a turning point of p could hide inside a step.
LONGEST_STEP = 1.0
# In the same units. It is some thousand units of rounding of the way a motion goes meanwhile: shorter steps
# add rounding and no accuracy.
SHORTEST_STEP = 1e-12
SMALLEST_ERROR = 1e-30  # far below any tolerance, far above underflow


@device
def dopri5_step(x: State, h: float, b: Body) -> tuple[State, State]:
    """The state one step h later, and the estimated local error of each component."""
    k1 = field(x, b)
    k2 = field(shift(x, h * _A[0][0], k1), b)
    k3 = field(shift(shift(x, h * _A[1][0], k1), h * _A[1][1], k2), b)
    y = shift(shift(shift(x, h * _A[2][0], k1), h * _A[2][1], k2), h * _A[2][2], k3)
    k4 = field(y, b)
    y = shift(shift(x, h * _A[3][0], k1), h * _A[3][1], k2)
    y = shift(shift(y, h * _A[3][2], k3), h * _A[3][3], k4)
    k5 = field(y, b)
    y = shift(shift(x, h * _A[4][0], k1), h * _A[4][1], k2)
    y = shift(shift(shift(y, h * _A[4][2], k3), h * _A[4][3], k4), h * _A[4][4], k5)
    k6 = field(y, b)
    y = shift(shift(x, h * _A[5][0], k1), h * _A[5][2], k3)
    y = shift(shift(shift(y, h * _A[5][3], k4), h * _A[5][4], k5), h * _A[5][5], k6)
    k7 = field(y, b)
    e = shift(shift(ORIGIN, h * _E[0], k1), h * _E[2], k3)
    e = shift(shift(shift(shift(e, h * _E[3], k4), h * _E[4], k5), h * _E[5], k6), h * _E[6], k7)
    return y, e


@device
def error_norm(x: State, e: State, unit: float, b: Body, depth: int) -> float:
    """Largest local error of the reduced motion and of the angles, each on the scale that matters.

    q is relative, since its logarithm is what near-flat motion resolves; angles are absolute (rad);
    p, rho, sigma4 are relative to their bounds by the energy: unit is the motion's speed. An error
    in rho is an error in eta of I1 q times it, so this also bounds the error in eta. The path is in units of r:
    large kappa turns it many times per step. NaN propagates.
    """
    worst = abs(e.q) / x.q
    worst = _larger(worst, abs(e.z))
    worst = _larger(worst, abs(e.p) / unit)
    worst = _larger(worst, abs(e.rho) / (b.kappa * unit))
    worst = _larger(worst, abs(e.sigma4) * math.sqrt(b.J_over_M) / unit)
    worst = _larger(_larger(worst, abs(e.chi)), abs(e.psi))
    return _larger(_larger(worst, abs(e.a1)), abs(e.a2)) if depth > ANGLES else worst


@device
def _larger(worst: float, candidate: float) -> float:
    # Keeps NaN: a comparison with NaN is false, so NaN replaces `worst` and then stays.
    return worst if worst >= candidate else candidate + 0.0 * worst


@device
def step_factor(error: float) -> float:
    """Factor for the next step from error / tolerance: near error^(-1/5), by square roots only.

    3/16 is near enough to 1/5 and needs four square roots, which vectorise; pow does not.
    """
    # An exact step must not divide by zero; a NaN passes on.
    error = SMALLEST_ERROR if error < SMALLEST_ERROR else error
    eighth = math.sqrt(math.sqrt(math.sqrt(error)))
    factor = SAFETY / (eighth * math.sqrt(eighth))
    # In this order: a NaN fails the first comparison and shrinks the step.
    factor = factor if factor > SHRINK else SHRINK
    return factor if factor < GROW else GROW

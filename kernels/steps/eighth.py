"""One step of order eight: Dormand and Prince's twelve stages as in Hairer's DOP853.

Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I (1993), II.5 and II.10. The
coefficients are decimals, checked against all order conditions on import. The local error combines
the embedded solutions of orders 5 and 3.
"""

import math

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.field import ORIGIN, State, field, shift
from kernels.steps.adaptive import LONGEST_STEP, SAFETY, SMALLEST_ERROR
from kernels.steps.tableaux import DORMAND_PRINCE_853

Weights = tuple[float, ...]

_A = DORMAND_PRINCE_853.a
_B = DORMAND_PRINCE_853.b
_E5, _E3 = (weights for _order, weights in DORMAND_PRINCE_853.errors)
# Narrower than for order five: the eighth power of such a change is 1e4 and more.
_SHRINK, _GROW = 0.3, 4.0
# Where the longest step begins to grow with the tolerance, and how far: beyond, the energy is lost.
_LOOSE, _LONGER = 1e-3, 1.5


@device
def _sum4(x: State, h: float, w: Weights, k1: State, k4: State, k5: State, k6: State) -> State:
    """x + h (w1 k1 + w4 k4 + w5 k5 + w6 k6): what rows seven and later begin with."""
    return shift(shift(shift(shift(x, h * w[0], k1), h * w[3], k4), h * w[4], k5), h * w[5], k6)


@device
def eighth_order_step(x: State, h: float, b: Body) -> tuple[State, State, State]:
    """The state one step of length h in s later, and its local error by orders 5 and 3."""
    k1 = field(x, b)
    k2 = field(shift(x, h * _A[1][0], k1), b)
    k3 = field(shift(shift(x, h * _A[2][0], k1), h * _A[2][1], k2), b)
    k4 = field(shift(shift(x, h * _A[3][0], k1), h * _A[3][2], k3), b)
    k5 = field(shift(shift(shift(x, h * _A[4][0], k1), h * _A[4][2], k3), h * _A[4][3], k4), b)
    k6 = field(shift(shift(shift(x, h * _A[5][0], k1), h * _A[5][3], k4), h * _A[5][4], k5), b)
    k7 = field(_sum4(x, h, _A[6], k1, k4, k5, k6), b)
    k8 = field(shift(_sum4(x, h, _A[7], k1, k4, k5, k6), h * _A[7][6], k7), b)
    y = shift(_sum4(x, h, _A[8], k1, k4, k5, k6), h * _A[8][6], k7)
    k9 = field(shift(y, h * _A[8][7], k8), b)
    y = shift(_sum4(x, h, _A[9], k1, k4, k5, k6), h * _A[9][6], k7)
    k10 = field(shift(shift(y, h * _A[9][7], k8), h * _A[9][8], k9), b)
    y = shift(shift(_sum4(x, h, _A[10], k1, k4, k5, k6), h * _A[10][6], k7), h * _A[10][7], k8)
    k11 = field(shift(shift(y, h * _A[10][8], k9), h * _A[10][9], k10), b)
    y = shift(shift(_sum4(x, h, _A[11], k1, k4, k5, k6), h * _A[11][6], k7), h * _A[11][7], k8)
    k12 = field(shift(shift(shift(y, h * _A[11][8], k9), h * _A[11][9], k10), h * _A[11][10], k11), b)
    stages = (k1, k6, k7, k8, k9, k10, k11, k12)
    return _outcome(x, h, _B, stages), _outcome(ORIGIN, h, _E5, stages), _outcome(ORIGIN, h, _E3, stages)


@device
def _outcome(x: State, h: float, w: Weights, stages: tuple[State, ...]) -> State:
    """x + h times the weighted stages; the weights of stages 2 to 5 vanish."""
    k1, k6, k7, k8, k9, k10, k11, k12 = stages
    y = shift(shift(shift(shift(x, h * w[0], k1), h * w[5], k6), h * w[6], k7), h * w[7], k8)
    return shift(shift(shift(shift(y, h * w[8], k9), h * w[9], k10), h * w[10], k11), h * w[11], k12)


@device
def combined_error(fifth: float, third: float) -> float:
    """Hairer's combination of both norms: fifth where they are alike, of order 8 as the step shrinks."""
    return fifth * fifth / math.sqrt(fifth * fifth + 0.01 * third * third + 1e-300)


@device
def eighth_step_factor(error: float) -> float:
    """Factor for the next step from error / tolerance: error^(-1/8), by square roots alone."""
    error = SMALLEST_ERROR if error < SMALLEST_ERROR else error
    factor = SAFETY / math.sqrt(math.sqrt(math.sqrt(error)))
    # In this order: a NaN fails the first comparison and shrinks the step.
    factor = factor if factor > _SHRINK else _SHRINK
    return factor if factor < _GROW else _GROW


@device
def longest_step(tolerance: float) -> float:
    """The longest step in units of 1/speed: one, where the tolerance is above _LOOSE up to half as much again.

    A step of one unit errs by 1e-4 at most, which a looser tolerance need not pay for.
    """
    grown = math.sqrt(math.sqrt(math.sqrt(tolerance / _LOOSE)))
    grown = grown if grown > 1.0 else 1.0
    return LONGEST_STEP * (grown if grown < _LONGER else _LONGER)

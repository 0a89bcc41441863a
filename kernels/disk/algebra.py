"""Constants of motion of many states, in lanes without a branch."""

import math

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import Whole, whole_solutions
from kernels.disk.constants import Constants, from_solutions
from kernels.disk.elementary import SMALLEST, log_ratio, logarithm
from kernels.disk.field import State, contracted_energy, reduced_state
from kernels.types import Matrix, Vector

LANES = 64  # eight AVX-512 registers; columns of a block stay in the first cache
# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`.
_Q, _Z, _P, _RHO, _SIGMA4 = range(5)
_OUT = 5  # six rows, as Constants
_ROWS = 11

_LN2 = math.log(2.0)
_ROOT_HALF = math.sqrt(0.5)
_SCALE, _LOG_SCALE = 2.0**54, 54.0 * _LN2  # it takes the smallest numbers to where their exponents have bits


@contracted_device
def depth(q: float, z: float, log_q: float) -> tuple[float, float]:
    """(S, ln S) as `depth_below_vertical`, by short series."""
    larger = 1.0 + abs(z)
    # larger is 1 ... 2: ln(larger) = ln(larger / sqrt 2) + ln 2 / 2
    s = (larger * _ROOT_HALF - 1.0) / (larger * _ROOT_HALF + 1.0)
    log_S = 2.0 * log_q - log_ratio(s) - 0.5 * _LN2
    return q * (q / larger), log_S


@contracted_device
def constants_by_series(x: State, whole: Whole, b: Body) -> Constants[float]:
    """Constants of the state x."""
    small = x.q < SMALLEST
    log_q = logarithm(x.q * _SCALE if small else x.q) - (_LOG_SCALE if small else 0.0)
    S, log_S = depth(x.q, x.z, log_q)
    return from_solutions(x, whole_solutions(S, log_S, b.c, whole), contracted_energy(x, b), b)


@contracted_subroutine
def lanes(W: Vector, whole: Whole, b: Body) -> None:
    """Rows _OUT ... from rows _Q ... _SIGMA4."""
    for i in range(LANES):
        q, z, p = W[_Q * LANES + i], W[_Z * LANES + i], W[_P * LANES + i]
        x = reduced_state(q if q > 0.0 else math.nan, z, p, W[_RHO * LANES + i], W[_SIGMA4 * LANES + i])
        constants = constants_by_series(x, whole, b)
        W[_OUT * LANES + i] = constants.sigma3_bar
        W[(_OUT + 1) * LANES + i] = constants.eta_plus
        W[(_OUT + 2) * LANES + i] = constants.eta_minus
        W[(_OUT + 3) * LANES + i] = constants.energy
        W[(_OUT + 4) * LANES + i] = constants.rounding_plus
        W[(_OUT + 5) * LANES + i] = constants.rounding_minus


@kernel
def constants_batch(states: Matrix, whole: Whole, disk: Disk, out: Matrix) -> None:
    """states (5, n): q, z, p, rho, sigma4 -> out (6, n), rows as Constants. NaN where not q > 0."""
    n = states.shape[1]
    W = np.zeros(_ROWS * LANES)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        for row in range(5):
            for i in range(count):
                W[row * LANES + i] = states[row, first + i]
        lanes(W, whole, disk.body)
        for row in range(6):
            for i in range(count):
                out[row, first + i] = W[(_OUT + row) * LANES + i]

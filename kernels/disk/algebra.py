"""Constants of motion of many states: what `constants_of` does for one, in lanes without a branch."""

import math

import numpy as np

from kernels._jit import contracted_device, contracted_subroutine, kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import Whole, whole_solutions
from kernels.disk.constants import Constants, constants_of, contracted_from_solutions
from kernels.disk.elementary import SMALLEST, log_ratio, logarithm
from kernels.disk.field import State, column, contracted_energy, reduced_state
from kernels.disk.rows import put
from kernels.types import Matrix, Vector

LANES = 64  # eight AVX-512 registers; columns of a block stay in the first cache
# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`.
_Q, _Z, _P, _RHO, _SIGMA4 = range(5)
_OUT = 5  # six rows, as Constants
_ROWS = 11

_LN2 = math.log(2.0)
_ROOT_HALF = math.sqrt(0.5)


@contracted_device
def depth(x: State) -> tuple[float, float]:
    """(S, ln S) as `depth_below_vertical`, by short series."""
    larger = 1.0 + abs(x.z)
    # larger is 1 ... 2: ln(larger) = ln(larger / sqrt 2) + ln 2 / 2
    s = (larger * _ROOT_HALF - 1.0) / (larger * _ROOT_HALF + 1.0)
    log_S = 2.0 * logarithm(x.q) - log_ratio(s) - 0.5 * _LN2
    return x.q * (x.q / larger), log_S


@contracted_device
def constants_by_series(x: State, whole: Whole, b: Body) -> Constants[float]:
    """Constants of the state x."""
    S, log_S = depth(x)
    return contracted_from_solutions(x, whole_solutions(S, log_S, b.c, whole), contracted_energy(x, b), b)


@contracted_subroutine
def lanes(W: Vector, whole: Whole, b: Body) -> None:
    """Rows _OUT ... from rows _Q ... _SIGMA4."""
    for i in range(LANES):
        x = reduced_state(
            W[_Q * LANES + i], W[_Z * LANES + i], W[_P * LANES + i], W[_RHO * LANES + i], W[_SIGMA4 * LANES + i]
        )
        constants = constants_by_series(x, whole, b)
        W[_OUT * LANES + i] = constants.sigma3_bar
        W[(_OUT + 1) * LANES + i] = constants.eta_plus
        W[(_OUT + 2) * LANES + i] = constants.eta_minus
        W[(_OUT + 3) * LANES + i] = constants.energy
        W[(_OUT + 4) * LANES + i] = constants.rounding_plus
        W[(_OUT + 5) * LANES + i] = constants.rounding_minus


@subroutine
def one(states: Matrix, j: int, disk: Disk, out: Matrix) -> None:
    """Sample j by itself: a q that is not positive, or so small that its exponent has no bits."""
    if states[0, j] > 0.0:
        put(constants_of(column(states, j), disk), out, j)
    else:
        out[:, j] = math.nan


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
        for i in range(count):
            if not W[_Q * LANES + i] > SMALLEST:
                one(states, first + i, disk, out)

"""Constants of motion of many states: what `constants_of` does for one, in lanes without a branch."""

import math

import numpy as np

from kernels._jit import contracted_subroutine, kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.chaplygin import Whole
from kernels.disk.constants import ULPS, constants_of
from kernels.disk.elementary import log_ratio, long_horner
from kernels.disk.field import State
from kernels.types import Matrix

LANES = 64
# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`.
_Q, _Z, _P, _RHO, _SIGMA4 = range(5)
_OUT = 5  # six rows, as Constants
_EXPONENT, _MANTISSA = 11, 12
_ROWS = 13

_LN2 = math.log(2.0)
_ROOT_HALF = math.sqrt(0.5)
# Bits of a double: the fraction, the exponent of 1, and that of 2^52, which makes an integer a double.
_FRACTION, _ONE, _SHIFTER = 0x000FFFFFFFFFFFFF, 0x3FF0000000000000, 0x4330000000000000
_OFFSET = 2.0**52 + 1023.0
_SMALLEST = 2.3e-308  # below, the exponent's bits are zero


@contracted_subroutine
def split(bits):
    """Exponent and mantissa of row _Q into their rows; `bits` is the work array seen as integers."""
    for i in range(LANES):
        word = bits[_Q * LANES + i]
        bits[_EXPONENT * LANES + i] = (word >> 52) + _SHIFTER
        bits[_MANTISSA * LANES + i] = (word & _FRACTION) + _ONE


@contracted_subroutine
def lanes(W, b, whole):
    """Rows _OUT ... from rows _Q ... _MANTISSA."""
    half_c, both_factor = 0.5 * b.c, 2.0 * b.I1 * b.dr0
    for i in range(LANES):
        q, z, p = W[_Q * LANES + i], W[_Z * LANES + i], W[_P * LANES + i]
        rho_bar, sigma4 = W[_RHO * LANES + i], W[_SIGMA4 * LANES + i]
        # q = m 2^e with m between sqrt(1/2) and sqrt 2, so that ln m is a short series.
        m, e = W[_MANTISSA * LANES + i], W[_EXPONENT * LANES + i] - _OFFSET
        large = m > 2.0 * _ROOT_HALF
        m, e = (0.5 * m if large else m), (e + 1.0 if large else e)
        larger = 1.0 + abs(z)
        # larger is 1 ... 2: ln(larger) = ln(larger / sqrt 2) + ln 2 / 2
        s = (larger * _ROOT_HALF - 1.0) / (larger * _ROOT_HALF + 1.0)
        log_S = 2.0 * (e * _LN2 + log_ratio((m - 1.0) / (m + 1.0))) - log_ratio(s) - 0.5 * _LN2
        S = q * (q / larger)
        t = 2.0 * S - 1.0
        g, drho = long_horner(whole.rho_over_S, t), long_horner(whole.drho, t)
        rho = S * g
        D = half_c * rho * log_S + long_horner(whole.v, t)
        dD = half_c * (drho * log_S + g) + long_horner(whole.dv, t)
        north = z >= 0.0
        spin = b.k * (sigma4 if north else -sigma4)
        sigma3 = q * rho_bar
        sigma3_bar = b.r0 * (spin * D - sigma3 * dD)
        near = b.I1 * (sigma3 * drho - spin * rho)
        both = both_factor * sigma3_bar
        far = both - near
        near_rounding = ULPS * b.I1 * (abs(sigma3 * drho) + abs(spin * rho))
        far_rounding = near_rounding + ULPS * (abs(both) + abs(near))
        energy = 0.5 * b.M * (p * p + rho_bar * rho_bar * b.inv_kappa2) + 0.5 * b.J * sigma4 * sigma4 + q
        W[_OUT * LANES + i] = sigma3_bar
        W[(_OUT + 1) * LANES + i] = near if north else far
        W[(_OUT + 2) * LANES + i] = far if north else near
        W[(_OUT + 3) * LANES + i] = energy
        W[(_OUT + 4) * LANES + i] = near_rounding if north else far_rounding
        W[(_OUT + 5) * LANES + i] = far_rounding if north else near_rounding


@subroutine
def one(states, j, b, series, out):
    """Sample j by itself: a q that is not positive, or so small that its exponent has no bits."""
    q = states[0, j]
    if not q > 0.0:
        out[:, j] = math.nan
        return
    x = State(q, states[1, j], states[2, j], states[3, j], states[4, j], 0.0, 0.0, 0.0, 0.0, 0.0)
    found = constants_of(x, b, series)
    out[0, j], out[1, j], out[2, j] = found.sigma3_bar, found.eta_plus, found.eta_minus
    out[3, j], out[4, j], out[5, j] = found.energy, found.rounding_plus, found.rounding_minus


@kernel
def constants_batch(states: Matrix, whole: Whole, b: Body, series: Matrix, out: Matrix) -> None:
    """states (5, n): q, z, p, rho, sigma4 -> out (6, n), rows as Constants. NaN where not q > 0."""
    n = states.shape[1]
    W = np.zeros(_ROWS * LANES)
    bits = W.view(np.int64)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        for row in range(5):
            for i in range(count):
                W[row * LANES + i] = states[row, first + i]
        split(bits)
        lanes(W, b, whole)
        for row in range(6):
            for i in range(count):
                out[row, first + i] = W[(_OUT + row) * LANES + i]
        for i in range(count):
            if not W[_Q * LANES + i] > _SMALLEST:
                one(states, first + i, b, series, out)

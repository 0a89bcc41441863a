"""An exponential for loops over the nodes of an arc: the library's is a call, which stops vectorising."""

import math

import numpy as np

from kernels._jit import contracted_device
from kernels.disk.elementary import log_ratio
from kernels.disk.polynomials import horner

_INV_LN2 = 1.0 / math.log(2.0)
_LN2, _LN2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # the first has 32 bits
_WHOLE = 1.5 * 2.0**52  # added and taken away it leaves whole numbers, which stand in the last bits of the sum
_BIAS, _FRACTION = 1023, 52  # of the exponent of a double, and bits behind it
_ROOT_HALF = int(np.float64(math.sqrt(0.5)).view(np.int64))
# (e^f - 1)/f for |f| <= ln(2)/2: what is left out is below rounding.
_POWERS = tuple(1.0 / math.factorial(n + 1) for n in range(13))


@contracted_device
def exponential(d: float) -> tuple[float, float]:
    """(e^d, e^d - 1) for |d| <= 700, each to its own rounding."""
    shifted = d * _INV_LN2 + _WHOLE
    n = shifted - _WHOLE
    f = (d - n * _LN2) - n * _LN2_REST
    power = np.int64((np.float64(shifted).view(np.int64) + _BIAS) << _FRACTION).view(np.float64)
    grown = power * (f * horner(_POWERS, f))
    return power + grown, grown + (power - 1.0)


@contracted_device
def logarithm(x: float) -> float:
    """ln x for a normal x > 0, to rounding."""
    word = np.float64(x).view(np.int64)
    # A mantissa from sqrt(1/2) to sqrt 2, so that its logarithm is short.
    exponent = (word - _ROOT_HALF) >> _FRACTION
    mantissa = np.int64(word - (exponent << _FRACTION)).view(np.float64)
    n = np.float64(exponent)
    return n * _LN2 + (log_ratio((mantissa - 1.0) / (mantissa + 1.0)) + n * _LN2_REST)

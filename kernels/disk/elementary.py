"""Elementary functions as polynomials, for loops over lanes: the library's are calls and stop vectorising."""

import math

import numpy as np

from kernels._jit import device
from kernels.disk.polynomials import horner, taylor

_LN2, _LN2_REST = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # the first has 32 bits
_INV_LN2 = 1.0 / math.log(2.0)
_BIAS, _PLACES = 1023, 52  # of the exponent of a double, and bits behind it
# Bits of a double: the fraction, the exponent of 1, and that of 2^52, which makes an integer a double.
_FRACTION, _ONE = np.uint64(0x000FFFFFFFFFFFFF), np.uint64(0x3FF0000000000000)
_SHIFTER, _BEHIND = np.uint64(0x4330000000000000), np.uint64(_PLACES)
_OFFSET, _ROOT_TWO = 2.0**52 + _BIAS, math.sqrt(2.0)
EPSILON = 2.2e-16  # of a double's rounding
SMALLEST = 2.3e-308  # below, the bits of the exponent are zero
# (e^f - 1)/f for |f| <= ln(2)/2: what is left out is below rounding.
_POWERS = tuple(1.0 / math.factorial(n + 1) for n in range(13))
# sin(x)/x in x^2; atanh(s)/s in s^2 up to 1/9; atan(x)/x in x^2.
_STEEPEST = 0.2  # of (h_m / tau)^2 at the handover
_QUARTER = 0.5 * math.pi
_QUARTER_REST = 6.123233995736766e-17  # what pi/2 has beyond its double
# Of pi/2 the first 33 bits, so that whole multiples up to 2^20 are exact, and the rest.
_RIGHT, _RIGHT_REST, _INV_RIGHT = 1.57079632673412561417, 6.07710050650619224932e-11, 2.0 / math.pi
# Added and taken away it leaves whole numbers, which stand in the last bits of the sum: functions that round are
# calls.
_WHOLE = 1.5 * 2.0**52
# Powers of x^2 in sin(x)/x and cos(x) for |x| <= pi/4: what is left out is below rounding.
_SINES = tuple((-1.0) ** n / math.factorial(2 * n + 1) for n in range(8))
_COSINES = tuple((-1.0) ** n / math.factorial(2 * n) for n in range(9))
_SINE = taylor(lambda n: (-1.0) ** n * _QUARTER ** (2 * n) / math.factorial(2 * n + 1), 11)
_ATANH = taylor(lambda n: 9.0**-n / (2 * n + 1), 10)
_ATAN = taylor(lambda n: (-_STEEPEST) ** n / (2 * n + 1), 12)


@device
def log_ratio(s: float) -> float:
    """ln((1 + s)/(1 - s)) for |s| <= 1/3."""
    return 2.0 * s * horner(_ATANH, 18.0 * s * s - 1.0)


@device
def exponential(d: float) -> tuple[float, float]:
    """(e^d, e^d - 1) for |d| <= 700, each to its own rounding."""
    shifted = d * _INV_LN2 + _WHOLE
    n = shifted - _WHOLE
    f = (d - n * _LN2) - n * _LN2_REST
    power = np.int64((np.float64(shifted).view(np.int64) + _BIAS) << _PLACES).view(np.float64)
    grown = power * (f * horner(_POWERS, f))
    return power + grown, grown + (power - 1.0)


@device
def logarithm(x: float) -> float:
    """ln x for x > SMALLEST, to rounding."""
    word = np.float64(x).view(np.uint64)
    n = np.uint64((word >> _BEHIND) | _SHIFTER).view(np.float64) - _OFFSET
    mantissa = np.uint64((word & _FRACTION) | _ONE).view(np.float64)
    # From sqrt(1/2) to sqrt 2, so that its logarithm is short.
    large = mantissa > _ROOT_TWO
    mantissa, n = (0.5 * mantissa if large else mantissa), (n + 1.0 if large else n)
    return n * _LN2 + (log_ratio((mantissa - 1.0) / (mantissa + 1.0)) + n * _LN2_REST)


@device
def inverse_root(x: float) -> float:
    """1/sqrt(x); NaN unless x is above 0.

    (Tried: a guess in single precision and a step of Newton's, where roots and divisions are slow. What nodes do
    besides takes as long, so it gained nothing in vectors of 512 bits and lost a quarter in those of 256.)
    """
    return 1.0 / math.sqrt(x if x > 0.0 else math.nan)


@device
def arctan(x: float) -> float:
    """atan(x) for x^2 <= _STEEPEST."""
    return x * horner(_ATAN, 2.0 / _STEEPEST * x * x - 1.0)


@device
def sine(x: float) -> float:
    """sin(x) for |x| <= pi/2."""
    share = x / _QUARTER
    return x * horner(_SINE, 2.0 * share * share - 1.0)


@device
def cosine(x: float) -> float:
    """cos(x) for |x| <= pi/2, with all its digits also near pi/2."""
    return sine((_QUARTER - abs(x)) + _QUARTER_REST)


@device
def sine_cosine(x: float) -> tuple[float, float]:
    """(sin x, cos x) to rounding and to what x is known to."""
    turns = (x * _INV_RIGHT + _WHOLE) - _WHOLE
    rest = (x - turns * _RIGHT) - turns * _RIGHT_REST
    quarter = turns - 4.0 * (((0.25 * turns - 0.375) + _WHOLE) - _WHOLE)
    square = rest * rest
    s = rest * horner(_SINES, square)
    c = horner(_COSINES, square)
    odd = (quarter == 1.0) | (quarter == 3.0)
    sine_of, cosine_of = c if odd else s, s if odd else c
    return (
        -sine_of if quarter >= 2.0 else sine_of,
        -cosine_of if (quarter == 1.0) | (quarter == 2.0) else cosine_of,
    )

"""Elementary functions as polynomials, for loops over lanes: the library's are calls and stop vectorising."""

import math

from kernels._jit import contracted_device, strict_device
from kernels.disk.polynomials import horner, long_horner, strict_horner, taylor

# Largest range in y, below the handover, that nodes cover. What the closed forms leave decays like e^(-2y):
# e^-32 of it lies deeper.
DEEPEST = 16.0
_SQUARINGS = 3  # so that the polynomial of the exponential covers an eighth of the range

# exp(-d) on 0 <= d <= DEEPEST / 8, squared three times; sin(x)/x in x^2; atanh(s)/s in s^2 up to 1/9; atan(x)/x
# in x^2.
_SHORT = DEEPEST / 2.0**_SQUARINGS
_STEEPEST = 0.2  # of (h_m / tau)^2 at the handover
_QUARTER = 0.5 * math.pi
_QUARTER_REST = 6.123233995736766e-17  # what pi/2 has beyond its double
# Of pi/2 the first 33 bits, so that whole multiples up to 2^20 are exact, and the rest.
_RIGHT, _RIGHT_REST, _INV_RIGHT = 1.57079632673412561417, 6.07710050650619224932e-11, 2.0 / math.pi
_WHOLE = 1.5 * 2.0**52  # added and taken away, it leaves whole numbers: functions that round are calls
# Powers of x^2 in sin(x)/x and cos(x) for |x| <= pi/4: what is left out is below rounding.
_SINES = tuple((-1.0) ** n / math.factorial(2 * n + 1) for n in range(8))
_COSINES = tuple((-1.0) ** n / math.factorial(2 * n) for n in range(9))
_SINE = taylor(lambda n: (-1.0) ** n * _QUARTER ** (2 * n) / math.factorial(2 * n + 1), 11)
_EXP = taylor(lambda n: (-_SHORT) ** n / math.factorial(n), 14)
ATANH = taylor(lambda n: 9.0**-n / (2 * n + 1), 10)
# The same to 1e-8 or better.
EXP_SHORT = taylor(lambda n: (-_SHORT) ** n / math.factorial(n), 9)
ATANH_SHORT = taylor(lambda n: 9.0**-n / (2 * n + 1), 4)
_ATAN = taylor(lambda n: (-_STEEPEST) ** n / (2 * n + 1), 12)


@contracted_device
def exp_fall_by(powers: tuple[float, ...], d: float) -> float:
    """exp(-d) for 0 <= d <= DEEPEST, to the digits of its powers."""
    return _squared(horner(powers, 2.0 / DEEPEST * d - 1.0))


@contracted_device
def _squared(e: float) -> float:
    for _ in range(_SQUARINGS):
        e = e * e
    return e


@contracted_device
def exp_fall_at_once(d: float) -> float:
    """As `exp_fall`, even and odd powers apart, where all that follows waits for it."""
    return _squared(long_horner(_EXP, 2.0 / DEEPEST * d - 1.0))


@contracted_device
def exp_fall(d: float) -> float:
    """exp(-d) for 0 <= d <= DEEPEST."""
    return exp_fall_by(_EXP, d)


@contracted_device
def log_ratio_by(powers: tuple[float, ...], s: float) -> float:
    """ln((1 + s)/(1 - s)) for |s| <= 1/3, to the digits of its powers."""
    return 2.0 * s * horner(powers, 18.0 * s * s - 1.0)


@contracted_device
def log_ratio_at_once(powers: tuple[float, ...], s: float) -> float:
    """As `log_ratio_by`, even and odd powers apart, where all that follows waits for it."""
    return 2.0 * s * long_horner(powers, 18.0 * s * s - 1.0)


@contracted_device
def log_ratio(s: float) -> float:
    """ln((1 + s)/(1 - s)) for |s| <= 1/3."""
    return log_ratio_by(ATANH, s)


@contracted_device
def inverse_root(x: float) -> float:
    """1/sqrt(x); NaN unless x is above 0.

    (Tried: a guess in single precision and a step of Newton's, where roots and divisions are slow. What nodes do
    besides takes as long, so it gained nothing in vectors of 512 bits and lost a quarter in those of 256.)
    """
    return 1.0 / math.sqrt(x if x > 0.0 else math.nan)


@contracted_device
def arctan(x: float) -> float:
    """atan(x) for x^2 <= _STEEPEST."""
    return x * horner(_ATAN, 2.0 / _STEEPEST * x * x - 1.0)


@contracted_device
def sine(x: float) -> float:
    """sin(x) for |x| <= pi/2."""
    share = x / _QUARTER
    return x * horner(_SINE, 2.0 * share * share - 1.0)


@contracted_device
def cosine(x: float) -> float:
    """cos(x) for |x| <= pi/2, with all its digits also near pi/2."""
    return sine((_QUARTER - abs(x)) + _QUARTER_REST)


@strict_device
def sine_cosine(x: float) -> tuple[float, float]:
    """(sin x, cos x) to rounding and to what x is known to; not contracted, so alike in and out of lanes."""
    turns = (x * _INV_RIGHT + _WHOLE) - _WHOLE
    rest = (x - turns * _RIGHT) - turns * _RIGHT_REST
    quarter = turns - 4.0 * (((0.25 * turns - 0.375) + _WHOLE) - _WHOLE)
    square = rest * rest
    s = rest * strict_horner(_SINES, square)
    c = strict_horner(_COSINES, square)
    odd = (quarter == 1.0) | (quarter == 3.0)
    sine_of, cosine_of = c if odd else s, s if odd else c
    return (
        -sine_of if quarter >= 2.0 else sine_of,
        -cosine_of if (quarter == 1.0) | (quarter == 2.0) else cosine_of,
    )

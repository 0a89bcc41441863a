"""Elementary functions as polynomials, for loops over lanes: the library's are calls and stop vectorising."""

import math

import numpy as np

from kernels._jit import contracted_device
from kernels.disk.chaplygin import economise

# Range in y, below the handover, that the nodes cover. What the closed forms leave decays like e^(-2y):
# e^-32 of it lies deeper.
DEEPEST = 16.0
_SQUARINGS = 3


def _economised(term, degree):
    """Ascending powers of 2u - 1 on 0 <= u <= 1 of the sum of term(n) u^n."""
    terms = np.array([term(n) for n in range(60)])
    return tuple(map(float, economise(terms, degree)))


# exp(-d) on 0 <= d <= DEEPEST / 8, squared three times; atanh(s)/s in s^2 up to 1/9; atan(x)/x in x^2.
_SHORT = DEEPEST / 2.0**_SQUARINGS
_STEEPEST = 0.2  # of (h_m / tau)^2 at the handover
_EXP = _economised(lambda n: (-_SHORT) ** n / math.factorial(n), 14)
_ATANH = _economised(lambda n: 9.0**-n / (2 * n + 1), 10)
_ATAN = _economised(lambda n: (-_STEEPEST) ** n / (2 * n + 1), 12)


@contracted_device
def horner(coefficients, x):
    """The polynomial with the given ascending powers."""
    total = coefficients[len(coefficients) - 1]
    for k in range(len(coefficients) - 2, -1, -1):
        total = total * x + coefficients[k]
    return total


@contracted_device
def long_horner(coefficients, x):
    """As `horner`, even and odd powers apart: short loops, which the compiler unrolls; degree even, >= 4."""
    square = x * x
    n = len(coefficients)
    even, odd = coefficients[n - 1], coefficients[n - 2]
    for k in range(n - 3, -1, -2):
        even = even * square + coefficients[k]
    for k in range(n - 4, 0, -2):
        odd = odd * square + coefficients[k]
    return even + x * odd


@contracted_device
def exp_fall(d):
    """exp(-d) for 0 <= d <= DEEPEST."""
    e = horner(_EXP, 2.0 / DEEPEST * d - 1.0)
    for _ in range(_SQUARINGS):
        e = e * e
    return e


@contracted_device
def log_ratio(s):
    """ln((1 + s)/(1 - s)) for |s| <= 1/3."""
    return 2.0 * s * horner(_ATANH, 18.0 * s * s - 1.0)


@contracted_device
def arctan(x):
    """atan(x) for x^2 <= _STEEPEST."""
    return x * horner(_ATAN, 2.0 / _STEEPEST * x * x - 1.0)

"""Polynomials: how coefficients of ascending powers are made, and how they are evaluated."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np

from kernels._jit import device
from kernels.types import Matrix, Vector

_TERMS = 60  # of a Taylor series on an interval where it gains a digit per term or more


def economise(coefficients: Vector, degree: int) -> Vector:
    """Ascending powers of S on [0, 1] -> ascending powers of 2S - 1 up to `degree`, by way of Chebyshev.

    S^n = 2^(1-2n) sum' C(2n, n-j) T_j(2S - 1) has positive weights only: nothing cancels, where a
    fit through points would lose a digit.
    """
    parts = np.asarray(coefficients)[:, None] * _weights(len(coefficients), degree)
    chebyshev = np.array([math.fsum(terms) for terms in parts.T.tolist()])
    return _powers(chebyshev)


@cache
def _weights(terms: int, degree: int) -> Matrix:
    """Share of T_j(2S - 1) in S^n, rows n and columns j: the same for every body, and slow to work out."""
    shares = np.zeros((terms, degree + 1))
    for n in range(terms):
        for j in range(min(n, degree) + 1):
            shares[n, j] = math.comb(2 * n, n - j) / 4**n * (1.0 if j == 0 else 2.0)
    return shares


def taylor(term: Callable[[int], float], degree: int) -> tuple[float, ...]:
    """Ascending powers of 2u - 1 on 0 <= u <= 1 of the sum of term(n) u^n."""
    return tuple(map(float, economise(np.array([term(n) for n in range(_TERMS)]), degree)))


def interpolate(function: Callable, degree: int) -> Vector:
    """Ascending powers of 2u - 1 of the Chebyshev interpolant of function(u) on 0 <= u <= 1."""
    return _powers(np.polynomial.chebyshev.chebinterpolate(lambda t: function(0.5 * (1.0 + t)), degree))


def _powers(chebyshev: Vector) -> Vector:
    powers = np.polynomial.chebyshev.cheb2poly(chebyshev)
    return np.pad(powers, (0, chebyshev.size - powers.size))  # numpy drops trailing zeros


@device
def horner(coefficients: tuple[float, ...], x: float) -> float:
    """The polynomial with the given ascending powers, two or more.

    Even and odd powers apart: compilers unroll a short loop only, and loops over lanes around one that is left
    stay scalar.
    """
    n, square = len(coefficients), x * x
    last, other = coefficients[n - 1], coefficients[n - 2]
    for k in range(n - 3, -1, -2):
        last = last * square + coefficients[k]
    for k in range(n - 4, -1, -2):
        other = other * square + coefficients[k]
    return last + x * other if n % 2 == 1 else other + x * last

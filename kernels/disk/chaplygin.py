"""Chaplygin's equations: recessive and dominant solutions, constants of motion without integration.

With S = 1 - |sigma_1| the distance from the nearer flat state, sigma_3 and sigma_4 are exact
combinations of two fixed functions of S (sections 5.1 and 5.2 of the paper):

    sigma3        = X rho(S)  + Y D(S)
    face*k*sigma4 = X rho'(S) + Y D'(S)         k = I3/I1, ' = d/dS

with constants X = sigma3_bar / r(0) and Y = eta_side / I1. The Wronskian rho D' - rho' D = -1
makes the inverse equally short, so eta is found from a state by one subtraction, and
D(S) = (c/2) rho ln S + v keeps the logarithm of eq. (5.9) explicit: near flat nothing cancels.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numba import float64
from numba import types as nb

from kernels._jit import device
from kernels.disk.polynomials import economise, horner
from kernels.types import Matrix, Vector

# The nearest singularity is S = 2, so Chebyshev coefficients on [0, 1] fall like 5.8^-n:
# degree 20 is at rounding (17 leaves 4e-14 in D'), and the monomial form in 2S - 1 loses nothing.
DEGREE = 20
TERMS = 90  # of the power series, which at S = 1 gains a bit per term


class Solutions(NamedTuple):
    """The two solutions at one S, with derivatives in S."""

    rho: float
    drho: float
    rho_over_S: float
    D: float
    dD: float


Powers = Annotated[tuple[float, ...], nb.UniTuple(float64, DEGREE + 1)]


class Series(NamedTuple):
    """Chaplygin's series on 0 <= S <= 1, ascending powers of 2 S - 1; excess: of (rho' - 1)/S.

    Tuples, which the compiler sees no array overlap: loops over lanes need that.
    """

    rho_over_S: Powers
    drho: Powers
    v: Powers
    dv: Powers
    excess: Powers


def make_series(c: float) -> tuple[Series, float, float]:
    """Chaplygin's series, and r(0), r'(0); c is the dimensionless parameter of eq. (4.3)."""
    rows, r0, dr0 = power_series(c)
    return Series(*(tuple(map(float, economise(row, DEGREE))) for row in rows)), r0, dr0


def power_series(c: float) -> tuple[Matrix, float, float]:
    """The five functions of `Series` in ascending powers of S, and r(0), r'(0).

    Eqs (5.1)-(5.3), and v of Lemma 2.
    """
    r, v = _unsettled(c)
    # A multiple of rho may be added to v; v(1) = 0 fixes it.
    v -= math.fsum(v) / math.fsum(r) * r
    orders = np.arange(r.size)
    drho, dv = np.roll(r * orders, -1), np.roll(v * orders, -1)
    rows = np.stack([np.roll(r, -1), drho, v, dv, np.append(drho[1:], 0.0)])
    return rows, math.fsum(r), math.fsum(r * orders)


def _unsettled(c: float) -> tuple[Vector, Vector]:
    """Ascending powers of r, and of v before a multiple of r is added to it."""
    r = np.zeros(TERMS + 2)
    r[1] = 1.0
    for n in range(1, TERMS + 1):
        r[n + 1] = (c + n * (n - 1)) / (2 * n * (n + 1)) * r[n]
    v = np.zeros(TERMS + 2)
    v[0] = 1.0
    for k in range(1, TERMS + 1):
        source = 0.5 * c * (2 * (2 * k + 1) * r[k + 1] - (2 * k - 1) * r[k])
        v[k + 1] = ((k * (k - 1) + c) * v[k] - source) / (2 * k * (k + 1))
    return r, v


@device
def solutions(S: float, log_S: float, c: float, series: Series) -> Solutions:
    """The solutions at 0 <= S <= 1; log_S is passed because S may underflow."""
    t, half_c = 2.0 * S - 1.0, 0.5 * c
    g, drho = horner(series.rho_over_S, t), horner(series.drho, t)
    v, dv = horner(series.v, t), horner(series.dv, t)
    rho = S * g
    return Solutions(rho, drho, g, half_c * rho * log_S + v, half_c * (drho * log_S + g) + dv)


@device
def sigma_from_constants(face: float, X: float, Y: float, f: Solutions, k: float) -> tuple[float, float]:
    """(sigma3, sigma4) from (X, Y) at a point of the hemisphere `face`. Needs I3 > 0."""
    return X * f.rho + Y * f.D, face * (X * f.drho + Y * f.dD) / k

"""The motion at many tilts at once: array loops that the compiler vectorises.

What `quadrature.point` does for one tilt, for all nodes of a rule. Every loop here runs over nodes with
no branch and no library call: exponentials and logarithms are polynomials, evaluated like the series
of Chaplygin's solutions, one coefficient after another for all nodes. One flat work array with
constant offsets, for the reason given in `batch`.
"""

import math

import numpy as np

from kernels._jit import subroutine
from kernels.disk.chaplygin import DEGREE

ROOM = 288  # nodes that fit: two panels of the largest rule
GAP, WEIGHT, CLOSED = 0, 1, 2  # set by the caller
H, E2, LOG = 3, 4, 5  # set by `place`, or by the caller
CHI, REST, TIME, LEVEL, SLOPE = 6, 7, 8, 9, 10  # results
_X, _G, _DRHO, _V, _DV, _EXCESS, _Y, _FALL, _LEFT = 11, 12, 13, 14, 15, 16, 17, 18, 19
ROWS = 20

_LN2 = math.log(2.0)
# exp(-d) for 0 <= d <= FARTHEST: polynomials on a sixteenth of the range, squared four times.
FARTHEST = 40.0
_SQUARINGS = 4
_STRETCH = FARTHEST / 2.0**_SQUARINGS
# Up to this y the distance of h from h_turn keeps its relative accuracy.
_NEAR = 16.0


def _powers(function, degree):
    """Ascending powers of t of the Chebyshev interpolant of function((1 + t)/2) on -1 <= t <= 1."""
    chebyshev = np.polynomial.chebyshev.chebinterpolate(lambda t: function(0.5 * (1.0 + t)), degree)
    powers = np.polynomial.chebyshev.cheb2poly(chebyshev)
    return np.ascontiguousarray(powers)


_EXP = _powers(lambda u: np.exp(-u * _STRETCH), 18)
_GROWN = _powers(lambda u: -np.expm1(-u * _STRETCH) / (u * _STRETCH), 18)
_LOG1P = _powers(np.log1p, 22)


@subroutine
def polynomial(W, target, coefficients, n):
    """Row `target` = the polynomial in row _X."""
    for j in range(n):
        W[target * ROOM + j] = coefficients[coefficients.size - 1]
    for k in range(coefficients.size - 2, -1, -1):
        a = coefficients[k]
        for j in range(n):
            W[target * ROOM + j] = W[target * ROOM + j] * W[_X * ROOM + j] + a


@subroutine
def decay(W, source, target, n):
    """Row `target` = exp(-d), d from row `source` and clipped at FARTHEST. Relative error 16 roundings."""
    scale = 2.0 / FARTHEST
    for j in range(n):
        d = W[source * ROOM + j]
        W[_X * ROOM + j] = scale * (d if d < FARTHEST else FARTHEST) - 1.0
    polynomial(W, target, _EXP, n)
    for _ in range(_SQUARINGS):
        for j in range(n):
            W[target * ROOM + j] = W[target * ROOM + j] * W[target * ROOM + j]


@subroutine
def growth(W, target, n):
    """Row `target` = 1 - exp(-d), its relative error some 1e-14 at any d; d is that of the last `decay`."""
    polynomial(W, target, _GROWN, n)
    for j in range(n):
        W[target * ROOM + j] = W[target * ROOM + j] * (0.5 * _STRETCH * (1.0 + W[_X * ROOM + j]))
    for _ in range(_SQUARINGS):
        for j in range(n):
            m = W[target * ROOM + j]
            W[target * ROOM + j] = m * (2.0 - m)  # 1 - (1 - m)^2


@subroutine
def place(W, n, h_end, h_turn, y_end):
    """H, E2 = exp(-2y), LOG = ln S of nodes that lie GAP below y_end; h = h_turn cosh y.

    Near the turning point h is h_turn and a small relative excess, since P depends on that excess;
    elsewhere it is h_end and a decay by GAP, which is exact however large y_end is.
    """
    for j in range(n):
        W[_Y * ROOM + j] = y_end - W[GAP * ROOM + j]
    decay(W, _Y, E2, n)
    growth(W, _LEFT, n)
    decay(W, GAP, _FALL, n)
    end2 = math.exp(-2.0 * y_end)
    for j in range(n):
        e, m = W[E2 * ROOM + j], W[_LEFT * ROOM + j]
        e2 = e * e
        near = h_turn + h_turn * (0.5 * m * m / e)
        far = h_end * W[_FALL * ROOM + j] * (1.0 + e2) / (1.0 + end2)
        W[H * ROOM + j] = near if W[_Y * ROOM + j] < _NEAR else far
        W[E2 * ROOM + j] = e2
        W[_X * ROOM + j] = 2.0 * e2 - 1.0
    polynomial(W, LOG, _LOG1P, n)
    at_end = math.log(h_end) - math.log1p(end2)
    for j in range(n):
        W[LOG * ROOM + j] = 2.0 * (W[LOG * ROOM + j] + at_end - W[GAP * ROOM + j]) - _LN2


@subroutine
def expand(W, n, series):
    """Chaplygin's series at S = H^2/2 for all nodes."""
    for j in range(n):
        W[_X * ROOM + j] = W[H * ROOM + j] * W[H * ROOM + j] - 1.0
        W[_G * ROOM + j] = series[0, DEGREE]
        W[_DRHO * ROOM + j] = series[1, DEGREE]
        W[_V * ROOM + j] = series[2, DEGREE]
        W[_DV * ROOM + j] = series[3, DEGREE]
        W[_EXCESS * ROOM + j] = series[4, DEGREE]
    for k in range(DEGREE - 1, -1, -1):
        a0, a1, a2, a3, a4 = series[0, k], series[1, k], series[2, k], series[3, k], series[4, k]
        for j in range(n):
            x = W[_X * ROOM + j]
            W[_G * ROOM + j] = W[_G * ROOM + j] * x + a0
            W[_DRHO * ROOM + j] = W[_DRHO * ROOM + j] * x + a1
            W[_V * ROOM + j] = W[_V * ROOM + j] * x + a2
            W[_DV * ROOM + j] = W[_DV * ROOM + j] * x + a3
            W[_EXCESS * ROOM + j] = W[_EXCESS * ROOM + j] * x + a4


@subroutine
def levels(W, n, X, Y, b, series):
    """LEVEL = V - V_0 and SLOPE = h dV/dh at nodes with H and LOG set."""
    expand(W, n, series)
    half_c, inv_k, flat = 0.5 * b.c, 1.0 / b.k, X / b.k
    for j in range(n):
        h, log_S, g = W[H * ROOM + j], W[LOG * ROOM + j], W[_G * ROOM + j]
        S = 0.5 * h * h
        shape = math.sqrt(1.0 - 0.5 * S)
        D = half_c * S * g * log_S + W[_V * ROOM + j]
        dD = half_c * (W[_DRHO * ROOM + j] * log_S + g) + W[_DV * ROOM + j]
        ratio = (0.5 * X * g * h + Y * D / h) / shape
        rise = (X * S * W[_EXCESS * ROOM + j] + Y * dD) * inv_k
        z = 1.0 - S
        gyration = b.I1 * ratio * ratio
        W[LEVEL * ROOM + j] = 0.5 * gyration + 0.5 * b.J * rise * (2.0 * flat + rise) + h * shape
        tilting = h / shape * (b.J * ratio * (flat + rise) + z)
        W[SLOPE * ROOM + j] = tilting - z * gyration / (shape * shape)


@subroutine
def integrands(W, n, level, X, Y, b, series):
    """CHI (less the closed part), REST and TIME, weighted, at nodes placed by `place`.

    chi needs sigma3/q^2 dt, psi is chi less REST: S sigma3/q^2 + sigma4. CLOSED holds D_m w(0) times
    the weight where the race is taken out, and 0 elsewhere.
    """
    expand(W, n, series)
    half_c, inv_k, flat, twice = 0.5 * b.c, 1.0 / b.k, X / b.k, 2.0 * b.inv_M
    for j in range(n):
        h, log_S, g, e2 = W[H * ROOM + j], W[LOG * ROOM + j], W[_G * ROOM + j], W[E2 * ROOM + j]
        S = 0.5 * h * h
        shape2 = 1.0 - 0.5 * S
        shape = math.sqrt(shape2)
        D = half_c * S * g * log_S + W[_V * ROOM + j]
        dD = half_c * (W[_DRHO * ROOM + j] * log_S + g) + W[_DV * ROOM + j]
        smooth = 0.5 * X * g * h
        ratio = (smooth + Y * D / h) / shape
        rise = (X * S * W[_EXCESS * ROOM + j] + Y * dD) * inv_k
        V = 0.5 * b.I1 * ratio * ratio + 0.5 * b.J * rise * (2.0 * flat + rise) + h * shape
        left = level - V
        left = left if left > 1e-300 else 1e-300
        dt = W[WEIGHT * ROOM + j] * h * (1.0 - e2) / ((1.0 + e2) * shape * math.sqrt(twice * left))
        w = dt / (h * shape2)
        W[CHI * ROOM + j] = w * smooth + Y / h * (D * w - W[CLOSED * ROOM + j])
        W[REST * ROOM + j] = dt * (ratio * h * shape / (2.0 - S) + flat + rise)
        W[TIME * ROOM + j] = dt


@subroutine
def total(W, row, n):
    """Sum of a row, in order."""
    result = 0.0
    for j in range(n):
        result += W[row * ROOM + j]
    return result

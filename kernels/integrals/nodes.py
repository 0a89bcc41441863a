"""The motion at many tilts at once: array loops that the compiler vectorises.

What `point.point` does for one tilt, for all nodes of a rule. Every loop here runs over nodes with
no branch and no library call: exponentials and logarithms are polynomials, evaluated like the series
of Chaplygin's solutions, one coefficient after another for all nodes. One flat work array with
constant offsets, for the reason given in `batch`.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import device, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import DEGREE
from kernels.disk.falling import potential_above_flat, spin_at_anchor
from kernels.disk.polynomials import interpolate
from kernels.integrals.point import Motion
from kernels.types import Matrix, Vector

ROOM = 288  # nodes that fit: two panels of the largest rule
ROWS = 23
(
    # set by the caller; H, E2 and LOG by the caller or by `place`
    GAP, WEIGHT, CLOSED, H, E2, LOG,
    # results
    CHI, REST, TIME, LEVEL, SLOPE,
    # E - V where it is known better than as a difference, else 0; its rounding there; room for series of a start
    KNOWN, NOISE, SERIES,
    # between
    _X, _G, _DRHO, _V, _DV, _EXCESS, _Y, _FALL, _LEFT,
) = range(ROWS)  # fmt: skip

_LN2 = math.log(2.0)
# exp(-d) for 0 <= d <= FARTHEST: polynomials on a sixteenth of the range, squared four times.
FARTHEST = 40.0
_SQUARINGS = 4
_STRETCH = FARTHEST / 2.0**_SQUARINGS
# Up to this y the distance of h from h_turn keeps its relative accuracy.
_NEAR = 16.0
# Below this 1 - exp(-y) is known better than the other: a rounding of ln S moves V by ten of its own.
_GROWN_LITTLE = 0.9
_LEAST = 1e-300  # of E - V, which rounding may make negative: the root of it must exist

_EXP = interpolate(lambda u: np.exp(-u * _STRETCH), 18)
_GROWN = interpolate(lambda u: -np.expm1(-u * _STRETCH) / (u * _STRETCH), 18)
_LOG1P = interpolate(np.log1p, 22)


class Series(NamedTuple):
    """Chaplygin's five series at one node, as `chaplygin.make_series`."""

    g: float
    drho: float
    v: float
    dv: float
    excess: float


@subroutine
def polynomial(W: Vector, target: int, coefficients: Vector, n: int) -> None:
    """Row `target` = the polynomial in row _X."""
    for j in range(n):
        W[target * ROOM + j] = coefficients[coefficients.size - 1]
    for k in range(coefficients.size - 2, -1, -1):
        a = coefficients[k]
        for j in range(n):
            W[target * ROOM + j] = W[target * ROOM + j] * W[_X * ROOM + j] + a


@subroutine
def decay(W: Vector, source: int, target: int, n: int) -> None:
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
def short_decay(W: Vector, source: int, target: int, n: int) -> None:
    """As `decay`; where d is short no square is needed, and the relative error is some two roundings."""
    scale = 2.0 / FARTHEST
    for j in range(n):
        d = W[source * ROOM + j]
        clipped = scale * (d if d < FARTHEST else FARTHEST)
        W[_X * ROOM + j] = (2.0**_SQUARINGS * clipped if d < _STRETCH else clipped) - 1.0
    polynomial(W, target, _EXP, n)
    for _ in range(_SQUARINGS):
        for j in range(n):
            e = W[target * ROOM + j]
            W[target * ROOM + j] = e if W[source * ROOM + j] < _STRETCH else e * e


@subroutine
def growth(W: Vector, target: int, n: int) -> None:
    """Row `target` = 1 - exp(-d), its relative error some 1e-14 at any d; d is that of the last `decay`."""
    polynomial(W, target, _GROWN, n)
    for j in range(n):
        W[target * ROOM + j] = W[target * ROOM + j] * (0.5 * _STRETCH * (1.0 + W[_X * ROOM + j]))
    for _ in range(_SQUARINGS):
        for j in range(n):
            m = W[target * ROOM + j]
            W[target * ROOM + j] = m * (2.0 - m)  # 1 - (1 - m)^2


@subroutine
def place(W: Vector, n: int, h_end: float, h_turn: float, y_end: float) -> None:
    """H, E2 = exp(-2y), LOG = ln S of nodes that lie GAP below y_end; h = h_turn cosh y.

    Near the turning point h is h_turn and a small relative excess, since P depends on that excess;
    elsewhere it is h_end and a decay by GAP, which is exact however large y_end is.
    """
    for j in range(n):
        W[_Y * ROOM + j] = y_end - W[GAP * ROOM + j]
    decay(W, _Y, E2, n)
    growth(W, _LEFT, n)
    short_decay(W, GAP, _FALL, n)
    end2 = math.exp(-2.0 * y_end)
    for j in range(n):
        e, m = W[E2 * ROOM + j], W[_LEFT * ROOM + j]
        e = 1.0 - m if m < _GROWN_LITTLE else e
        e2 = e * e
        near = h_turn + h_turn * (0.5 * m * m / e)
        far = h_end * W[_FALL * ROOM + j] * (1.0 + e2) / (1.0 + end2)
        W[H * ROOM + j] = near if W[_Y * ROOM + j] < _NEAR else far
        W[E2 * ROOM + j] = e2
        W[_X * ROOM + j] = 2.0 * e2 - 1.0
    polynomial(W, LOG, _LOG1P, n)
    at_end = math.log(h_end) - math.log1p(end2)
    for j in range(n):
        W[KNOWN * ROOM + j] = 0.0
        W[LOG * ROOM + j] = 2.0 * (W[LOG * ROOM + j] + at_end - W[GAP * ROOM + j]) - _LN2


@subroutine
def expand(W: Vector, n: int, series: Matrix) -> None:
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


@device
def expanded(W: Vector, j: int) -> Series:
    """The series at node j, after `expand`."""
    return Series(
        W[_G * ROOM + j], W[_DRHO * ROOM + j], W[_V * ROOM + j], W[_DV * ROOM + j], W[_EXCESS * ROOM + j]
    )


class Node(NamedTuple):
    """The motion at one node: what `point.Point` is for one tilt; smooth: the part of sigma3/q by X, times shape.

    V: amended potential above V_0; flat: sigma4 at the anchor, rise: what sigma4 has above that.
    """

    S: float
    shape: float
    smooth: float
    D: float
    ratio: float
    flat: float
    rise: float
    V: float


class Weights(NamedTuple):
    """Weight of a node, and of the closed part there."""

    whole: float
    closed: float


@device
def at_node(h: float, log_S: float, f: Series, X: float, Y: float, b: Body) -> Node:
    """The motion with constants X, Y at h."""
    half_c, inv_k, flat = 0.5 * b.c, 1.0 / b.k, spin_at_anchor(X, Y, b)
    S = 0.5 * h * h
    shape = math.sqrt(1.0 - 0.5 * S)
    D = half_c * S * f.g * log_S + f.v
    dD = half_c * (f.drho * log_S + f.g) + f.dv
    smooth = 0.5 * X * f.g * h
    ratio = (smooth + Y * D / h) / shape
    rise = (X * S * f.excess - X * b.anchor.excess + Y * dD) * inv_k
    V, _spin = potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * flat, h * shape, b)
    return Node(S, shape, smooth, D, ratio, flat, rise, V)


@device
def slope_at(h: float, at: Node, b: Body) -> float:
    """h dV/dh."""
    z = 1.0 - at.S
    tilting = h / at.shape * (b.J * at.ratio * (at.flat + at.rise) + z)
    return tilting - z * (b.I1 * at.ratio * at.ratio) / (at.shape * at.shape)


@device
def integrands_at(
    h: float, e2: float, weights: Weights, left: float, at: Node, Y: float, b: Body
) -> tuple[float, float, float]:
    """(CHI, REST, TIME) of a node. left: E - V."""
    left = left if left > _LEAST else _LEAST
    dt = weights.whole * h * (1.0 - e2) / ((1.0 + e2) * at.shape * math.sqrt(2.0 * b.inv_M * left))
    w = dt / (h * (1.0 - 0.5 * at.S))
    chi = w * at.smooth + Y / h * (at.D * w - weights.closed)
    return chi, dt * (at.ratio * h * at.shape / (2.0 - at.S) + at.flat + at.rise), dt


@subroutine
def levels(W: Vector, n: int, motion: Motion, disk: Disk) -> None:
    """LEVEL = V - V_0 and SLOPE = h dV/dh at nodes with H and LOG set."""
    expand(W, n, disk.series)
    b = disk.body
    for j in range(n):
        h = W[H * ROOM + j]
        at = at_node(h, W[LOG * ROOM + j], expanded(W, j), motion.X, motion.Y, b)
        W[LEVEL * ROOM + j] = at.V
        W[SLOPE * ROOM + j] = slope_at(h, at, b)


@subroutine
def integrands(W: Vector, n: int, motion: Motion, disk: Disk) -> None:
    """CHI (less the closed part), REST and TIME, weighted, at nodes placed by `place`.

    chi needs sigma3/q^2 dt, psi is chi less REST: S sigma3/q^2 + sigma4. CLOSED holds D_m w(0) times
    the weight where the race is taken out, and 0 elsewhere.
    """
    expand(W, n, disk.series)
    b = disk.body
    for j in range(n):
        h = W[H * ROOM + j]
        at = at_node(h, W[LOG * ROOM + j], expanded(W, j), motion.X, motion.Y, b)
        weights = Weights(W[WEIGHT * ROOM + j], W[CLOSED * ROOM + j])
        known = W[KNOWN * ROOM + j]
        left = known if known > 0.0 else motion.level - at.V
        chi, rest, time = integrands_at(h, W[E2 * ROOM + j], weights, left, at, motion.Y, b)
        W[LEVEL * ROOM + j] = at.V
        W[CHI * ROOM + j], W[REST * ROOM + j], W[TIME * ROOM + j] = chi, rest, time


@subroutine
def total(W: Vector, row: int, n: int) -> float:
    """Sum of a row, in order."""
    result = 0.0
    for j in range(n):
        result += W[row * ROOM + j]
    return result

"""What passages and falls near flat need of the body alone, computed once: motions at fixed tilts, low series.

Away from flat the nodes of a rule may stand at the same tilts for every sample. There sigma_3 and
sigma_4 are X and Y times numbers that depend on the tilt and the body, so a node costs a square root
and a division. Near flat, on h <= HANDOVER, the nodes follow the turning point of each sample, but
S <= 1/8 and Chaplygin's solutions are polynomials of degree 8.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
from numba import float64
from numba import types as nb

from kernels._jit import device
from kernels.disk import chaplygin
from kernels.disk.body import NaturalDisk
from kernels.disk.polynomials import economise
from kernels.types import Matrix, Vector

# h = 2 sin(theta/2) where the fixed nodes end: as far out as the low series stay short.
HANDOVER = 0.5
# On S <= 1/8 the nearest singularity is 16 intervals away: coefficients fall like 62^-n.
LOW_DEGREE = 8
# Rows of rules at fixed tilts, behind those of Fixed: they turn weighted values into the last coefficients.
LAST, LAST_BUT_ONE = 8, 9
# Rows of inner rules.
SHARE, WEIGHT = range(2)


# Bodies with less, of kappa above 4.6, race so far that these rules miss more than they say: arcs serve them.
LEAST_I1 = 0.05


class Orders(NamedTuple):
    """Nodes of Gauss rules, and the share of what it adds up that an inner rule misses at most.

    That hardly depends on the motion, and coefficients of so few nodes do not tell it: so much that estimates
    cover the errors of 120,000 passages of ten bodies.
    """

    outer: int
    fall: int
    inner: int
    truncation: float


# Of a passage to 1e-6 and of the best there is: nearly all ordinary passages then meet 1e-6, and 1e-11.
COARSE, FINE = Orders(17, 20, 10, 3e-6), Orders(25, 34, 24, 2e-12)


class Fixed(NamedTuple):
    """A node at a fixed tilt: the first rows of a table.

    ratio_x, ratio_y: sigma3/q per X and per Y; rise_x, rise_y: rise of sigma4 above its value at flat, alike;
    height: q; slope: tan(theta/2); time, chi: weights.
    """

    ratio_x: float
    ratio_y: float
    rise_x: float
    rise_y: float
    height: float
    slope: float
    time: float
    chi: float


@device
def fixed(table: Matrix, j: int) -> Fixed:
    """Node j of a table of fixed tilts."""
    ratio_x, ratio_y, rise_x, rise_y = table[0, j], table[1, j], table[2, j], table[3, j]
    return Fixed(ratio_x, ratio_y, rise_x, rise_y, table[4, j], table[5, j], table[6, j], table[7, j])


LowPowers = Annotated[tuple[float, ...], nb.UniTuple(float64, LOW_DEGREE + 1)]


class Low(NamedTuple):
    """Chaplygin's series for S <= 2/per_S, ascending powers of per_S S - 1: here for S <= 1/8.

    inv_shape: 1/cos(theta/2), which is as smooth. rho' is 1 + S excess.
    """

    per_S: float
    rho_over_S: LowPowers
    v: LowPowers
    dv: LowPowers
    excess: LowPowers
    inv_shape: LowPowers


class Rules(NamedTuple):
    """Rules of one accuracy: outer (10, n), fall (10, n), inner (2, n); truncation: see Orders."""

    outer: Matrix
    fall: Matrix
    inner: Matrix
    truncation: float


class Tables(NamedTuple):
    """Tables of one body: the vertical (8, 1), a single tilt, the series, and rules."""

    vertical: Matrix
    low: Low
    rules: Rules


def make_tables(disk: NaturalDisk, orders: Orders, gauss: Sequence[Matrix]) -> Tables:
    """Tables for passages of a disk; gauss: Gauss rules (2, n) on [-1, 1] of the three orders."""
    series, nearest = chaplygin.power_series(disk.body.c)[0], 0.5 * HANDOVER * HANDOVER
    outer, fall, inner = gauss
    handover = 2.0 * math.asin(0.5 * HANDOVER)
    rules = Rules(
        outer=_from_vertical(disk, 0.5 * math.pi - handover, outer),
        fall=_from_vertical(disk, 0.5 * math.pi, fall),
        inner=np.stack([0.5 * (1.0 + inner[0]), 0.5 * inner[1]]),
        truncation=orders.truncation,
    )
    return Tables(at_tilts(disk, np.array([0.5 * math.pi]), np.zeros(1)), _low(series, nearest), rules)


def _from_vertical(disk: NaturalDisk, length: float, rule: Matrix) -> Matrix:
    """Nodes from the vertical on, over `length`; they lie close there, like u^2, where a slow start is slow."""
    u = 0.5 * (1.0 + rule[0])
    nodes = at_tilts(disk, 0.5 * math.pi - length * u * u, length * u * rule[1])
    return np.concatenate([nodes, last_coefficients(rule)])


def at_tilts(disk: NaturalDisk, theta: Vector, weights: Vector) -> Matrix:
    """The rows of Fixed at the given tilts; weights in theta."""
    body = disk.body
    h = 2.0 * np.sin(0.5 * theta)
    S, log_S = 0.5 * h * h, 2.0 * np.log(h) - math.log(2.0)
    g, drho, v, dv, excess = (np.polynomial.polynomial.polyval(2.0 * S - 1.0, row) for row in disk.series)
    D = 0.5 * body.c * S * g * log_S + v
    dD = 0.5 * body.c * (drho * log_S + g) + dv
    shape = np.cos(0.5 * theta)
    q = h * shape
    return np.stack(
        [0.5 * g * h / shape, D / q, S * excess / body.k, dD / body.k, q, 0.5 * h / shape, weights, weights / q]
    )


def last_coefficients(rule: Matrix) -> Matrix:
    """Factors (2, n) that turn weighted values at a rule's nodes into twice its last two Legendre coefficients."""
    n = rule.shape[1]
    eye = np.eye(n)
    return np.stack([(2 * k + 1) * np.polynomial.legendre.legval(rule[0], eye[k]) for k in (n - 1, n - 2)])


def _low(series: Matrix, widest: float) -> Low:
    """The fields of `Low`, for S <= widest."""
    orders = np.arange(series.shape[1])
    rho_over_S, _drho, v, dv, excess = series
    # (1 - S/2)^(-1/2)
    inv_shape = np.cumprod(np.concatenate([[1.0], (orders[1:] - 0.5) / (2.0 * orders[1:])]))
    rows = (rho_over_S, v, dv, excess, inv_shape)
    return Low(2.0 / widest, *(tuple(map(float, economise(row * widest**orders, LOW_DEGREE))) for row in rows))

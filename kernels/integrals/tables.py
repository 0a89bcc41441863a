"""What a passage needs of the body alone, computed once: motions at fixed tilts, and low series.

Away from flat the nodes of a rule may stand at the same tilts for every sample. There sigma_3 and
sigma_4 are X and Y times numbers that depend on the tilt and the body, so a node costs a square root
and a division. Near flat, on h <= HANDOVER, the nodes follow the turning point of each sample, but
S <= 1/8 and Chaplygin's solutions are polynomials of degree 9.
"""

import math
from typing import Annotated, NamedTuple

import numpy as np
from numba import float64
from numba import types as nb

from kernels._jit import contracted_device
from kernels.disk import chaplygin
from kernels.disk.body import Disk
from kernels.disk.polynomials import economise
from kernels.types import Matrix

# h where the fixed nodes end: as far out as the low series stay short.
HANDOVER = 0.5
LOW_DEGREE = 9  # the nearest singularity is 16 intervals away: coefficients fall like 62^-n

# Rows of the tables of fixed tilts below those of Fixed: the last Legendre coefficients.
LAST, LAST_BUT_ONE = 8, 9
# Rows of the table of relative nodes in y, its last coefficients below them.
GAP, WEIGHT, EVEN, EVEN_BUT_ONE = range(4)


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


@contracted_device
def fixed(table: Matrix, j: int) -> Fixed:
    """Node j of a table of fixed tilts."""
    ratio_x, ratio_y, rise_x, rise_y = table[0, j], table[1, j], table[2, j], table[3, j]
    return Fixed(ratio_x, ratio_y, rise_x, rise_y, table[4, j], table[5, j], table[6, j], table[7, j])


LowPowers = Annotated[tuple[float, ...], nb.UniTuple(float64, LOW_DEGREE + 1)]


class Low(NamedTuple):
    """Chaplygin's series for S <= 1/8, ascending powers of 16 S - 1."""

    rho_over_S: LowPowers
    drho: LowPowers
    v: LowPowers
    dv: LowPowers
    excess: LowPowers


class Limits(NamedTuple):
    """What belongs to a grade of rules besides their nodes.

    depth: range in y, below the handover, that the inner rule covers. rounds: steps of Newton's method towards
    the turning point, and settled: the last of them at most. missed: share of what the inner rule adds up that it
    misses at most; 0 where its last coefficients tell. slowest: share of the energy above V_0 with which a motion
    must leave the vertical. few: whether the other rules have only some ten nodes.
    """

    depth: float
    rounds: int
    settled: float
    missed: float
    slowest: float
    few: bool


class Grade(NamedTuple):
    """Rules of one accuracy: outer (10, n), fall (10, n), inner (4, m)."""

    outer: Matrix
    fall: Matrix
    inner: Matrix
    limits: Limits


class Tables(NamedTuple):
    """Tables of one body: vertical (8, 1), low, and grades of rules for accuracies of COARSE, MIDDLE and any."""

    vertical: Matrix
    low: Low
    coarse: Grade
    middle: Grade
    fine: Grade


# The least accuracies that are left to rules with few nodes.
COARSE, MIDDLE = 1e-3, 1e-5
# What an inner rule misses of what it adds up hardly depends on the motion: that is a sum of e^(-ky), k = 2, 3
# and so on, from the handover down. Twice the largest share of 96,000 passages of twelve bodies, of those with
# I1 >= _ROUND; below that it grows like the power _GROWS, since kappa does.
_ROUND, _GROWS = 0.05, 1.5
_GRADES = (
    Limits(depth=5.5, rounds=3, settled=2e-3, missed=1.2e-3, slowest=1e-2, few=True),
    Limits(depth=9.0, rounds=4, settled=3e-5, missed=4e-5, slowest=5e-3, few=False),
    Limits(depth=16.0, rounds=5, settled=1e-8, missed=0.0, slowest=1e-3, few=False),
)


def make_tables(disk: Disk, rules: tuple[tuple[np.ndarray, ...], ...]) -> Tables:
    """Tables for passages of a disk.

    rules: for each grade Gauss rules (2, n) on [-1, 1] for outer, fall and inner. Inner rules have an even number
    of nodes; their positive half is used.
    """
    low = Low(*(tuple(map(float, row)) for row in _low_series(disk.body.c)))
    vertical = _at_tilts(disk, np.array([0.5 * math.pi]), np.zeros(1))
    coarse, middle, fine = (_grade(disk, each, limits) for each, limits in zip(rules, _GRADES, strict=True))
    return Tables(vertical, low, coarse, middle, fine)


def _grade(disk: Disk, rules: tuple[np.ndarray, ...], limits: Limits) -> Grade:
    outer, fall, inner = rules
    handover = 2.0 * math.asin(0.5 * HANDOVER)
    # A slow start makes theta-dot^2 small towards the vertical; there nodes lie close, like u^2.
    far = _towards_vertical(disk, 0.5 * math.pi - handover, outer)
    if limits.missed > 0.0:
        fallen = _towards_vertical(disk, 0.5 * math.pi, fall)
    else:
        # Where the fall is slow at flat as well, u^2 (3 - 2u) crowds nodes at both ends.
        u = 0.5 * (1.0 + fall[0])
        theta = 0.5 * math.pi * u * u * (3.0 - 2.0 * u)
        fallen = _at_tilts(disk, theta, 1.5 * math.pi * u * (1.0 - u) * fall[1])
    half, n = inner.shape[1] // 2, inner.shape[1]
    # Of an even function the even coefficients are left, of degrees n - 2 and n - 4.
    last = _coefficients(inner, (n - 2, n - 4))[:, half:]
    thin = 1.0 + (_ROUND / disk.body.I1) ** _GROWS
    return Grade(
        outer=np.concatenate([far, _coefficients(outer, (outer.shape[1] - 1, outer.shape[1] - 2))]),
        fall=np.concatenate([fallen, _coefficients(fall, (fall.shape[1] - 1, fall.shape[1] - 2))]),
        inner=np.concatenate([1.0 - inner[:1, half:], inner[1:, half:], last]),
        limits=limits._replace(missed=limits.missed * thin),
    )


def _towards_vertical(disk: Disk, length: float, rule: np.ndarray) -> np.ndarray:
    """Nodes from the vertical on, over `length`, close to it like u^2."""
    u = 0.5 * (1.0 + rule[0])
    return _at_tilts(disk, 0.5 * math.pi - length * u * u, length * u * rule[1])


def _at_tilts(disk: Disk, theta: np.ndarray, weights: np.ndarray) -> np.ndarray:
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


def _coefficients(rule: np.ndarray, degrees: tuple[int, int]) -> np.ndarray:
    """Factors (2, n) that turn weighted values at a rule's nodes into twice two Legendre coefficients."""
    eye = np.eye(max(degrees) + 1)
    return np.stack([(2 * k + 1) * np.polynomial.legendre.legval(rule[0], eye[k]) for k in degrees])


def _low_series(c: float) -> list[np.ndarray]:
    power_series, _r0, _dr0 = chaplygin.power_series(c)
    shrink = (0.5 * HANDOVER * HANDOVER) ** np.arange(power_series.shape[1])
    return [economise(row * shrink, LOW_DEGREE) for row in power_series]

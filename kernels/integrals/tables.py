"""What a passage needs of the body alone, computed once: motions at fixed tilts, and low series.

Away from flat the nodes of a rule may stand at the same tilts for every sample. There sigma_3 and
sigma_4 are X and Y times numbers that depend on the tilt and the body, so a node costs a square root
and a division. Near flat, on h <= HANDOVER, the nodes follow the turning point of each sample, but
S <= 1/8 and Chaplygin's solutions are polynomials of degree 8; of degree 3 where few digits are asked.

There is a grade of rules for each decade of accuracy. All grades stand side by side in one array of nodes.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
from numba import float64
from numba import types as nb

from kernels._jit import contracted_device
from kernels.disk import chaplygin
from kernels.disk.body import Disk
from kernels.disk.elementary import DEEPEST
from kernels.disk.polynomials import economise
from kernels.types import Longs, Matrix

# h where the fixed nodes end: as far out as the low series stay short.
HANDOVER = 0.5
# On S <= 1/8 the nearest singularity is 16 intervals away: coefficients fall like 62^-n.
LOW_DEGREE, SHORT_DEGREE = 8, 3
# Of cos(theta/2) among short series: its error counts in all of the race, not in what is left.
_SHORT_SHAPE = 5
# Rows of the tables of fixed tilts below those of Fixed: the last Legendre coefficients.
LAST, LAST_BUT_ONE = 8, 9
# Rows of the tables of relative nodes.
GAP, WEIGHT = range(2)


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
ShortPowers = Annotated[tuple[float, ...], nb.UniTuple(float64, SHORT_DEGREE + 1)]
ShapePowers = Annotated[tuple[float, ...], nb.UniTuple(float64, _SHORT_SHAPE + 1)]


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


class Short(NamedTuple):
    """As `Low`, for few digits."""

    per_S: float
    rho_over_S: ShortPowers
    v: ShortPowers
    dv: ShortPowers
    excess: ShortPowers
    inv_shape: ShapePowers


Series = Low | Short


class Limits(NamedTuple):
    """What belongs to a grade of rules besides their nodes.

    depth: range in y, below the handover, that the inner rule covers. rounds: steps of Newton's method towards
    the turning point, and settled: the last of them at most. missed: share of what the inner rule adds up that it
    misses at most; 0 where its last coefficients tell. slowest: share of the energy above V_0 with which a motion
    must leave the vertical. trust, trust_of_fall: what the other rules miss of what they add up, in
    squares of the share that their last coefficients have; 0 where these coefficients tell by themselves. spun:
    how many times as much as of chi the inner rule misses of the time, and where spin is fast of chi less psi.
    """

    depth: float
    rounds: float
    settled: float
    missed: float
    slowest: float
    trust: float
    trust_of_fall: float
    spun: float


class Grade(NamedTuple):
    """Rules of one accuracy: outer (10, n), fall (10, n), inner (2, n)."""

    outer: Matrix
    fall: Matrix
    inner: Matrix
    limits: Limits


class Tables(NamedTuple):
    """Tables of one body.

    vertical (8, 1): a single tilt. low, short: series. outer, fall, inner: nodes of all grades side by side; ends:
    where those of a grade end, three numbers for each. limits (GRADES, 8): fields of Limits.
    """

    vertical: Matrix
    low: Low
    short: Short
    outer: Matrix
    fall: Matrix
    inner: Matrix
    ends: Longs
    limits: Matrix


# The least accuracy that is left to each grade, 1e-2 to 1e-11; the last gives the best there is. Less by a little,
# since a power of ten may be rounded down.
TARGETS = (*(float(f"1e-{n}") * (1.0 - 1e-9) for n in range(2, 12)), 0.0)
GRADES = len(TARGETS)
# The grade at which short series end and the others begin.
ROUGH = 4
# What an inner rule misses of what it adds up hardly depends on the motion: that is a sum of e^(-ky), k = 2, 3
# and so on, from the handover down. So much that estimates cover the errors of 10^5 passages of two round bodies,
# and at least twice the largest share of 96,000 passages of those of twelve bodies with I1 >= _ROUND; below that
# it grows like the power _GROWS, since kappa does.
_ROUND, _GROWS = 0.05, 1.5
# The inner rules of bodies with I1 below _SMALL look so deep in fine grades: they miss as much as those of other
# bodies, twice as much at _SMALLEST. Their angles turn more with the turning point: Newton's method
# takes a step more, and the last one must be smaller by _SHARPER.
_SMALL, _SMALLEST, _SHARPER = 0.01, 1e-3, 10.0
_DEEPER = {4: 11.5, 5: 12.5, 6: 14.0, 7: DEEPEST, 8: DEEPEST, 9: DEEPEST, 10: DEEPEST}
# Of bodies smaller than that and slender, races of hundreds of radians err by some 1e-12 of themselves by any
# table, which no grade sees: from this grade on all of it is left to arcs.
_LAST_OF_SLENDER, _SLENDER = 8, 0.1
# What is left of the time falls like e^(-3y), which rules of few nodes see worst. Where I3/I1 is below _SPINNING,
# the spin makes large angles of it, and of what is missed elsewhere.
_SPINNING = 0.03
_GRADES = (
    Limits(3.0, 2, 3e-2, 4e-3, 2e-2, 0.0055, 0.005, 10.0),
    Limits(4.5, 3, 2e-3, 4e-4, 5e-3, 0.04, 0.22, 3.0),
    Limits(5.5, 3, 2e-3, 1e-4, 5e-3, 0.17, 0.9, 1.8),
    Limits(7.0, 4, 3e-5, 5e-6, 2e-2, 0.03, 0.07, 3.0),
    Limits(8.5, 4, 3e-5, 6e-7, 3e-3, 15.0, 20.0, 4.0),
    Limits(9.5, 4, 3e-5, 8e-8, 5e-3, 0.35, 1.3, 2.0),
    Limits(11.0, 5, 1e-6, 1.2e-8, 5e-3, 0.8, 2.2, 2.0),
    Limits(12.5, 5, 1e-6, 8e-10, 5e-3, 1.2, 7.0, 2.0),
    Limits(14.0, 5, 1e-6, 7e-11, 3e-3, 2.2, 20.0, 2.0),
    Limits(15.0, 5, 3e-7, 6e-12, 2e-3, 3.0, 40.0, 2.0),
    Limits(16.0, 5, 1e-8, 2e-14, 1e-3, 0.0, 0.0, 1.0),
)


def make_tables(disk: Disk, rules: Sequence[tuple[np.ndarray, ...]]) -> Tables:
    """Tables for passages of a disk.

    rules: for each grade Gauss rules (2, n) on [-1, 1] for outer, fall and inner. The last has an even number of
    nodes; its positive half is used.
    """
    power_series, nearest = chaplygin.power_series(disk.body.c)[0], 0.5 * HANDOVER * HANDOVER
    grades = [_grade(disk, each, _limits(disk, g)) for g, each in enumerate(rules)]
    sizes = [[nodes.shape[1] for nodes in grade[:3]] for grade in grades]
    outer, fall, inner = (np.concatenate(nodes, axis=1) for nodes in list(zip(*grades, strict=True))[:3])
    return Tables(
        vertical=at_tilts(disk, np.array([0.5 * math.pi]), np.zeros(1)),
        low=Low(4.0 / HANDOVER**2, *_series(power_series, nearest, (LOW_DEGREE, LOW_DEGREE))),
        short=Short(4.0 / HANDOVER**2, *_series(power_series, nearest, (SHORT_DEGREE, _SHORT_SHAPE))),
        outer=outer,
        fall=fall,
        inner=inner,
        ends=np.concatenate([np.zeros(3, np.int64), np.cumsum(sizes, axis=0).ravel()]),
        limits=np.array([grade.limits for grade in grades]),
    )


def _grade(disk: Disk, rules: tuple[np.ndarray, ...], limits: Limits) -> Grade:
    outer, fall, inner = rules
    handover = 2.0 * math.asin(0.5 * HANDOVER)
    # A slow start makes theta-dot^2 small towards the vertical; there nodes lie close, like u^2.
    far = _towards_vertical(disk, 0.5 * math.pi - handover, outer)
    if limits.trust_of_fall > 0.0:
        fallen = _towards_vertical(disk, 0.5 * math.pi, fall)
    else:
        # Where the fall is slow at flat as well, u^2 (3 - 2u) crowds nodes at both ends.
        u = 0.5 * (1.0 + fall[0])
        theta = 0.5 * math.pi * u * u * (3.0 - 2.0 * u)
        fallen = at_tilts(disk, theta, 1.5 * math.pi * u * (1.0 - u) * fall[1])
    n = inner.shape[1] // 2
    return Grade(
        outer=np.concatenate([far, coefficients(outer, (outer.shape[1] - 1, outer.shape[1] - 2))]),
        fall=np.concatenate([fallen, coefficients(fall, (fall.shape[1] - 1, fall.shape[1] - 2))]),
        inner=np.stack([1.0 - inner[0, n:], inner[1, n:]]),
        limits=limits,
    )


def _limits(disk: Disk, number: int) -> Limits:
    """The limits of a grade for a body."""
    body, limits = disk.body, _GRADES[number]
    fine = body.I1 < _SMALL and number in _DEEPER
    if body.I1 < _SMALLEST and body.k < _SLENDER and number >= _LAST_OF_SLENDER:
        limits = limits._replace(missed=1.0)
    thin = 1.0 + ((_SMALLEST if fine else _ROUND) / body.I1) ** _GROWS
    spinning = 1.0 / (1.0 + (body.k / _SPINNING) ** 2)
    return limits._replace(
        depth=_DEEPER[number] if fine else limits.depth,
        rounds=limits.rounds + fine,
        settled=limits.settled / (_SHARPER if fine else 1.0),
        missed=limits.missed * thin,
        trust=limits.trust * (1.0 + spinning),
        spun=1.0 + (limits.spun - 1.0) * spinning,
    )


def _towards_vertical(disk: Disk, length: float, rule: np.ndarray) -> np.ndarray:
    """Nodes from the vertical on, over `length`, close to it like u^2."""
    u = 0.5 * (1.0 + rule[0])
    return at_tilts(disk, 0.5 * math.pi - length * u * u, length * u * rule[1])


def at_tilts(disk: Disk, theta: np.ndarray, weights: np.ndarray) -> np.ndarray:
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


def coefficients(rule: np.ndarray, degrees: tuple[int, int]) -> np.ndarray:
    """Factors (2, n) that turn weighted values at a rule's nodes into twice two Legendre coefficients."""
    eye = np.eye(max(degrees) + 1)
    return np.stack([(2 * k + 1) * np.polynomial.legendre.legval(rule[0], eye[k]) for k in degrees])


def _series(power_series: np.ndarray, widest: float, degrees: tuple[int, int]) -> list[tuple[float, ...]]:
    """Powers of 2 S/widest - 1 of the fields of `Low` for S <= widest. degrees: of Chaplygin's, of the last."""
    orders = np.arange(power_series.shape[1])
    rho_over_S, _drho, v, dv, excess = power_series
    # (1 - S/2)^(-1/2)
    inv_shape = np.cumprod(np.concatenate([[1.0], (orders[1:] - 0.5) / (2.0 * orders[1:])]))
    rows = [(row, degrees[0]) for row in (rho_over_S, v, dv, excess)] + [(inv_shape, degrees[1])]
    return [tuple(map(float, economise(row * widest**orders, degree))) for row, degree in rows]

"""Gauss-Legendre rules good to the last digit, for the tables of `kernels`.

They rest on numpy's longdouble. Where that is a plain double (Windows, macOS on ARM) weights are off by 7e-14
(relative) at 140 nodes and by 1e-12 at 280; those of numpy and SciPy are off by 1e-11 and 3e-10 everywhere.
"""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[np.float64]

# From an error of 1e-3 at most; the last one only confirms.
_NEWTON_STEPS = 4


@cache
def gauss(n: int) -> tuple[_Array, _Array]:
    """Nodes and weights on [-1, 1]: Newton's method in extended precision, from Tricomi's formula.

    numpy promises its rules up to degree 100 only, and at 400 they are off by 1e-13; its eigenvalues, which take
    0.2 s of the start of a command for our rules, would save one step.
    """
    angle = np.pi * (np.arange(n, 0, -1, dtype=np.longdouble) - 0.25) / (n + 0.5)
    x: NDArray[Any] = (1.0 - (n - 1.0) / (8.0 * n**3)) * np.cos(angle)
    for _ in range(_NEWTON_STEPS):
        value, slope = _legendre(n, x)
        x = x - value / slope
    slope = _legendre(n, x)[1]
    weights = 2.0 / ((1.0 - x * x) * slope * slope)
    return x.astype(np.float64), weights.astype(np.float64)


def _legendre(n: int, x: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    before, here = np.ones_like(x), x.copy()
    for k in range(2, n + 1):
        before, here = here, ((2 * k - 1) * x * here - (k - 1) * before) / k
    return here, n * (x * here - before) / (x * x - 1.0)


# Orders of outer, fall and inner rules, for 1e-2, 1e-3 and so on to 1e-11 and the best there is.
_ORDERS = (
    (5, 5, 4),
    (7, 8, 8),
    (9, 11, 10),
    (13, 14, 14),
    (17, 18, 18),
    (17, 20, 22),
    (19, 22, 26),
    (21, 26, 32),
    (22, 30, 38),
    (23, 34, 44),
    (24, 40, 56),
)


# Inner rules of fine grades, for bodies with I1 from a value on: less is left to be integrated near flat there.
_LARGE, _INNER_OF_LARGE = 2.0, {7: 30, 8: 34, 9: 40}
# Of other bodies with I1 below _SLIGHT or I3/I1 below _SLENDER: more is left, and less smooth. Both bounds lie
# apart from 0.1, which other units may round to either side.
_SLIGHT, _SLENDER = 0.099, 0.099
_INNER_OF_SLIGHT = dict(enumerate((8, 12, 16, 22, 34, 44, 48, 52, 64, 64, 64)))


@cache
def table_rules(I1: float, I3: float) -> tuple[tuple[_Array, ...], ...]:
    """Rules for kernels.integrals.tables.make_tables: outer, fall and inner of its grades, coarse to fine.

    I1, I3: of the body, natural units.

    The finest: orders at which the estimated error is below 1e-11 for all of 12,800 ordinary passages (speeds of
    0.5 to 2 at the vertical, |sigma3_bar| <= 2, any eta down to 1e-280); the true one is near 1e-13. The others:
    orders at which few of them miss the accuracy of their grade and have to be computed again.
    """
    slight = I1 < _SLIGHT or I3 < _SLENDER * I1
    own = _INNER_OF_LARGE if I1 >= _LARGE else _INNER_OF_SLIGHT if slight else {}
    orders = [(outer, fall, own.get(g, inner)) for g, (outer, fall, inner) in enumerate(_ORDERS)]
    return tuple(tuple(np.stack(gauss(n)) for n in each) for each in orders)

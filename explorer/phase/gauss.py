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

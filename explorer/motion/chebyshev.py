"""Functions on 0 to pi/2 as Chebyshev series: integrals of what is known at the nodes, as long as they must be."""

from collections.abc import Callable
from typing import Any

import numpy as np

from explorer.phase.series import Series
from explorer.phase.states import Array

HALF_PI = 0.5 * np.pi
# Of the largest coefficient: the last ones are rounding, and a sum that is still of use.
_SETTLED, _USABLE = 1e-13, 1e-9
_LAST = 4  # coefficients looked at, since every second one may vanish


def nodes(degree: int) -> Array:
    """The Chebyshev nodes of 0 to pi/2, in their usual order."""
    return 0.5 * HALF_PI * (1.0 + np.cos(np.pi * (np.arange(degree) + 0.5) / degree))


def primitive(values: Any, low: float = 0.0, high: float = HALF_PI) -> Series:
    """The integral from `low` of a function that is given at the nodes between both ends, real or complex.

    By a cosine transform: numpy's own interpolation solves with a dense matrix, half a gigabyte at degree 8192.
    """
    from scipy.fft import dct

    coefficients = dct(values, type=2) / values.size
    coefficients[0] *= 0.5
    return Series(coefficients, domain=[low, high]).integ(lbnd=low)


def settled(series: Callable[[int], list[Series]], degree: int, most: int) -> list[Series] | None:
    """`series` of the least degree, by doubling up to `most`, whose coefficients have fallen to rounding.

    None where they have not fallen enough to be of use, or are not finite.
    """
    while True:
        made = series(degree)
        tail = np.max([abs(s.coef[-_LAST:]).max() / abs(s.coef).max() for s in made if s.coef.any()])
        if tail < _SETTLED or degree >= most:
            return made if tail <= _USABLE else None
        degree *= 2

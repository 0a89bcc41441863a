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
    The transform is that of Fourier of the values and their mirror image, since SciPy's takes longer to load than
    a limit motion to compute.
    """
    size = values.size
    mirrored = np.fft.fft(np.concatenate([values, values[::-1]]))[:size]
    coefficients = mirrored * np.exp(-0.5j * np.pi * np.arange(size) / size) / size
    coefficients = coefficients if np.iscomplexobj(values) else coefficients.real
    coefficients[0] *= 0.5
    return Series(coefficients, domain=[low, high]).integ(lbnd=low)


def settled(series: Callable[[int], list[Series]], degree: int, most: int) -> list[Series] | None:
    """`series` of the least degree, by doubling up to `most`, whose coefficients have fallen to rounding.

    Where that of the values themselves does not let them fall so far, those that fell furthest: nodes of higher
    degrees are nearer to a turning point, where the rounding of the speed is largest. None where they have not
    fallen enough to be of use, or are not finite.
    """
    best, least = None, _USABLE
    while True:
        made = series(degree)
        tail = np.max([abs(s.coef[-_LAST:]).max() / abs(s.coef).max() for s in made if s.coef.any()])
        grows = best is not None and not tail < least
        if tail <= least:
            best, least = made, tail
        if tail < _SETTLED or grows or degree >= most:
            return best
        degree *= 2

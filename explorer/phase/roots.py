"""Where functions change their signs, for arrays of brackets at once.

By cutting brackets into parts: that takes any function, such as a wall that is no double at its end, and loads
nothing. SciPy's root finders take 0.7 s to load.
"""

from collections.abc import Callable

import numpy as np

from explorer.phase.states import Array

# A bracket of length 1 comes to rounding, or to 1e-19 about zero. What is asked comes from kernels, which take as
# long for a hundred numbers as for one.
_PARTS, _STEPS = 16, 16


def changes_of_sign(function: Callable[[Array], Array], low: Array, high: Array) -> Array:
    """The first change of sign of a function of arrays in each bracket; high where there is none.

    function: called with the shape of the brackets, and with one more axis before that.
    """
    before = np.sign(function(low))
    for _ in range(_STEPS):
        places = low + np.multiply.outer(np.arange(_PARTS + 1) / _PARTS, high - low)
        places[-1] = high
        same = np.sign(function(places[1:-1])) == before
        last = np.logical_and.accumulate(same).sum(axis=0)[None]
        low, high = (np.take_along_axis(places, last + i, 0)[0] for i in (0, 1))
    return high


def roots_among(function: Callable[[Array], Array], places: Array) -> Array:
    """Where a function changes its sign between two neighbours of increasing places; exact zeros are none."""
    sign = np.sign(function(places))
    i = np.flatnonzero(sign[:-1] * sign[1:] < 0.0)
    return changes_of_sign(function, places[i], places[i + 1])

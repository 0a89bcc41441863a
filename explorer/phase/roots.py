"""Where a function of one number changes its sign, without the long start of SciPy's root finders.

They take longer to load than all that a plan computes. What is asked here comes from kernels, which take many
numbers in one call, so every step looks at many places at once.
"""

from collections.abc import Callable

import numpy as np

from explorer.phase.states import Array

_PARTS = 64  # into which an interval is cut at each step: nine steps from a length of one end at rounding
_ROUNDING = 4.0 * 2.2e-16


def root(function: Callable[[Array], Array], low: float, high: float, smallest: float = 1e-18) -> float:
    """A place between low and high where a function of arrays is zero or changes its sign, to rounding.

    smallest: what is left of the interval about a root at zero, which has no digits of its own. Raises ValueError
    where the signs at both ends are the same, or there is no value.
    """
    x = np.array([low, high])
    values = function(x)
    if not np.prod(np.sign(values)) <= 0.0:
        raise ValueError(f"no change of sign between {low} and {high}: {values[0]} and {values[1]}")
    while True:
        zeros = np.flatnonzero(values == 0.0)
        if zeros.size:
            return float(x[zeros[0]])
        after = int(np.argmax(np.sign(values) != np.sign(values[0])))
        low, high = x[after - 1], x[after]
        if high - low <= max(smallest, _ROUNDING * max(abs(low), abs(high))):
            return float(high if abs(values[after]) < abs(values[after - 1]) else low)
        x = np.linspace(low, high, _PARTS + 1)
        values = function(x)

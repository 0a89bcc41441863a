"""The largest value of a function of one number, without the long start of SciPy's optimisers."""

import math
from collections.abc import Callable

_GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))
_ROUNDING = math.sqrt(2.2e-16)  # a peak is flat: nearer than this share of x its values do not differ


def peak(function: Callable[[float], float], low: float, high: float, tolerance: float) -> tuple[float, float]:
    """(x, function(x)) at the peak between low and high, where there is one.

    Brent's method: parabolas through the three best points, golden sections where these lead nowhere. In every
    digit what `scipy.optimize.minimize_scalar(method="bounded")` finds of the negative function.
    """
    best = second = third = low + _GOLDEN * (high - low)
    top = of_second = of_third = function(best)
    step = before = 0.0
    while True:
        middle = 0.5 * (low + high)
        least = _ROUNDING * abs(best) + tolerance / 3.0
        if abs(best - middle) <= 2.0 * least - 0.5 * (high - low):
            return best, top
        p, q = _parabola(best - second, best - third, top - of_second, top - of_third)
        if abs(before) > least and abs(p) < abs(0.5 * q * before) and q * (low - best) < p < q * (high - best):
            before, step = step, p / q
            x = best + step
            if x - low < 2.0 * least or high - x < 2.0 * least:
                step = least if middle >= best else -least
        else:
            before = (low if best >= middle else high) - best
            step = _GOLDEN * before
        x = best + math.copysign(max(abs(step), least), step if step != 0.0 else 1.0)
        value = function(x)
        if value >= top:
            low, high = (best, high) if x >= best else (low, best)
            third, of_third, second, of_second, best, top = second, of_second, best, top, x, value
            continue
        low, high = (x, high) if x < best else (low, x)
        if value >= of_second or second == best:
            third, of_third, second, of_second = second, of_second, x, value
        elif value >= of_third or third in (best, second):
            third, of_third = x, value


def _parabola(to_second: float, to_third: float, above_second: float, above_third: float) -> tuple[float, float]:
    """(p, q): the vertex of the parabola through the three best points lies p / q from the best; q >= 0."""
    r, q = -to_second * above_third, -to_third * above_second
    p, q = to_third * q - to_second * r, 2.0 * (q - r)
    return (-p if q > 0.0 else p), abs(q)

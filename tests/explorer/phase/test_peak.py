"""The peak of a function, against SciPy's method, whose digits it keeps."""

import math

import pytest
from scipy.optimize import minimize_scalar

from explorer.phase.peak import peak

FUNCTIONS = {
    "a parabola": (lambda x: -((x - 0.3) ** 2), -1.0, 2.0),
    "a smooth peak": (lambda x: math.sin(x) + 0.1 * x, 0.0, 3.0),
    "a corner": (lambda x: -abs(x - 0.7), 0.0, 1.0),
    "a peak at the lower end": (lambda x: -x, 1.0, 2.0),
    "a peak at the upper end": (lambda x: math.exp(x), -2.0, -1.0),
    "a flat top": (lambda x: -((x + 0.2) ** 8), -1.0, 0.5),
    "two peaks": (lambda x: math.cos(5.0 * x) + 0.1 * x, -2.0, 2.0),
}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-10])
def test_the_peak_is_what_scipy_finds_digit_for_digit(name, tolerance):
    function, low, high = FUNCTIONS[name]
    theirs = minimize_scalar(
        lambda x: -function(x), bounds=(low, high), method="bounded", options={"xatol": tolerance}
    )
    assert peak(function, low, high, tolerance) == (theirs.x, -theirs.fun)

"""Changes of sign, against SciPy's root finder."""

import numpy as np
import pytest
from scipy.optimize import brentq

from explorer.phase.roots import root

FUNCTIONS = {
    "a simple root": (lambda x: np.cos(x) - x, 0.0, 1.0),
    "a decreasing function": (lambda x: np.exp(-x) - 0.3, -2.0, 5.0),
    "a steep one": (lambda x: np.tanh(1e6 * (x - 0.3)), -1.0, 1.0),
    "a triple root": (lambda x: (x - 0.7) ** 3, -1.0, 1.0),
    "a root at zero": (lambda x: np.sinh(x), -1.0, 2.0),
    "a pole at one end": (lambda x: np.log(x) + 20.0, 0.0, 1.0),
    "values whose product is no double": (lambda x: 1e200 * (x - 0.3), -1.0, 1.0),
    "a root near many noughts": (lambda x: x - 1e-12, -1.0, 1.0),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_root_is_where_scipy_finds_it(name):
    function, low, high = FUNCTIONS[name]
    finest = {"xtol": 1e-18, "rtol": 1e-15, "maxiter": 999}
    with np.errstate(divide="ignore"):
        found = root(function, low, high)
        theirs = brentq(lambda x: float(function(np.array(x))), low, high, **finest)
    assert found == pytest.approx(theirs, rel=2e-15, abs=1e-18)


def test_a_zero_at_an_end_is_a_root_and_one_of_several_is_found():
    assert root(lambda x: x - 2.0, 2.0, 3.0) == 2.0
    assert root(lambda x: x - 3.0, 2.0, 3.0) == 3.0
    assert abs(np.sin(root(np.sin, 1.0, 11.0))) < 1e-14


@pytest.mark.parametrize("function", [lambda x: x * x + 1.0, lambda x: x * np.nan])
def test_no_change_of_sign_is_an_error(function):
    with pytest.raises(ValueError, match="no change of sign"):
        root(function, -1.0, 1.0)

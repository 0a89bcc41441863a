"""Changes of sign, against SciPy's root finder."""

import numpy as np
import pytest
from scipy.optimize import brentq

from explorer.phase.roots import changes_of_sign

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
def test_a_change_of_sign_is_where_scipy_finds_it(name):
    function, low, high = FUNCTIONS[name]
    finest = {"xtol": 1e-18, "rtol": 1e-15, "maxiter": 999}
    with np.errstate(divide="ignore"):
        (found,) = changes_of_sign(function, np.array([low]), np.array([high]))
        theirs = brentq(lambda x: float(function(np.array(x))), low, high, **finest)
    assert found == pytest.approx(theirs, rel=2e-15, abs=1e-18)


def test_brackets_of_any_shape_have_each_their_own():
    squares = np.array([[2.0, 3.0, 5.0], [6.0, 7.0, 8.0]])
    found = changes_of_sign(lambda x: x * x - squares, np.zeros((2, 3)), np.full((2, 3), 3.0))
    np.testing.assert_allclose(found, np.sqrt(squares), rtol=4e-16)

"""Chebyshev series from compiled code, against numpy's, whose digits they keep."""

import numpy as np
import pytest
from numpy.polynomial import Chebyshev

from explorer.phase.series import Series

RANDOM = np.random.default_rng(3)
COEFFICIENTS = {
    "a constant": np.array([0.3]),
    "a line": np.array([0.3, -2.0]),
    "a parabola": np.array([0.3, -2.0, 1e-3]),
    "many": RANDOM.normal(size=65) * 0.7 ** np.arange(65),
    "complex": RANDOM.normal(size=34) + 1j * RANDOM.normal(size=34),
}


@pytest.mark.parametrize("name", COEFFICIENTS)
def test_values_are_those_of_numpy_digit_for_digit(name):
    own, other = (kind(COEFFICIENTS[name], domain=[0.2, 1.7]) for kind in (Series, Chebyshev))
    for x in (np.linspace(0.2, 1.7, 37), np.linspace(-1.0, 3.0, 12).reshape(3, 4)[:, ::2], np.empty(0)):
        np.testing.assert_array_equal(own(x), other(x))
        assert own(x).shape == x.shape
    for x in (0.4, np.float64(0.4), np.array(0.4), np.array([1, 0]), np.array([0.3 + 0.1j])):
        np.testing.assert_array_equal(own(x), other(x))


def test_what_is_made_of_a_series_is_one():
    own = Series.interpolate(np.exp, 12, domain=[0.0, 1.0])
    x = np.linspace(0.0, 1.0, 9)
    for made in (own.integ(lbnd=0.0), own.deriv(), own + 1.0):
        assert type(made) is Series
    assert own.deriv()(x) == pytest.approx(np.exp(x), rel=1e-10)
    assert own.integ(lbnd=0.0)(x) == pytest.approx(np.expm1(x), abs=1e-12)

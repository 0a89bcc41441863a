"""Series of integrals that grow until they are at rounding."""

import numpy as np
import pytest

from explorer.motion.chebyshev import HALF_PI, nodes, primitive, settled


def test_a_primitive_is_the_integral_from_zero():
    made = primitive(np.exp(nodes(24)))
    alpha = np.linspace(0.0, HALF_PI, 33)
    np.testing.assert_allclose(made(alpha), np.expm1(alpha), atol=1e-14)
    turning = primitive(np.exp(3j * nodes(32)))
    np.testing.assert_allclose(turning(alpha), np.expm1(3j * alpha) / 3j, atol=1e-14)


def test_a_series_grows_as_far_as_its_function_needs():
    for width, degree in ((1.0, 32), (0.1, 256)):
        (made,) = settled(lambda n, width=width: [primitive(1.0 / (width**2 + (nodes(n) - 0.7) ** 2))], 16, 4096)
        assert made.degree() <= degree
        exact = (np.arctan((HALF_PI - 0.7) / width) + np.arctan(0.7 / width)) / width
        assert made(HALF_PI) == pytest.approx(exact, rel=1e-12)


def test_a_function_that_is_not_smooth_enough_has_no_series():
    assert settled(lambda n: [primitive((nodes(n) > 0.7) * 1.0)], 16, 256) is None
    assert settled(lambda n: [primitive(nodes(n) * np.nan)], 16, 64) is None

"""Gauss-Legendre rules, to the last digit."""

import numpy as np
import pytest

from explorer.phase.gauss import gauss, packed_rules


def test_gauss_rules_integrate_polynomials_of_their_degree_to_the_last_digit():
    for n in (12, 64, 280):
        x, w = gauss(n)
        for degree in (0, 2, n, 2 * n - 2):
            degree -= degree % 2
            assert (w * x**degree).sum() == pytest.approx(2 / (degree + 1), rel=4e-15)


def test_packed_rules_are_the_rules_one_after_another():
    packed, sizes = packed_rules()
    first = 0
    for n in sizes:
        x, w = gauss(2 * n)
        np.testing.assert_array_equal(packed[0, :, first : first + n], [x[n:], w[n:]])
        np.testing.assert_array_equal(packed[1, :, first : first + n], gauss(n))
        first += n
    assert first == packed.shape[2]

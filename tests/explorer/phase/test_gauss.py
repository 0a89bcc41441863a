"""Gauss-Legendre rules, to the last digit."""

import pytest

from explorer.phase.gauss import gauss


def test_gauss_rules_integrate_polynomials_of_their_degree_to_the_last_digit():
    for n in (12, 64, 280):
        x, w = gauss(n)
        for degree in (0, 2, n, 2 * n - 2):
            degree -= degree % 2
            assert (w * x**degree).sum() == pytest.approx(2 / (degree + 1), rel=4e-15)

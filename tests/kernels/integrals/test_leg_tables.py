"""Tilts to try and rules of legs: the motion at each tilt is that of `point`, and halves of rules are exact."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.phase.gauss import LEG_SIZES
from kernels.integrals.leg_tables import EVEN, NODE, TILTS, WEIGHT
from kernels.integrals.point import VERTICAL, Point, point_batch


def test_tilts_are_those_of_single_motions():
    disk, X, Y = BODIES["thick"], 0.7, -0.2
    tables, out = disk.leg_tables, np.empty((7, TILTS))
    ratio_x, ratio_y, rise_x, rise_y, height, z, h, theta = tables.tilts
    point_batch(h, X, Y, disk.natural, out)
    at = Point(*out)
    assert h[-1] == VERTICAL
    np.testing.assert_allclose(X * ratio_x + Y * ratio_y, at.ratio, rtol=1e-13)
    np.testing.assert_allclose(X / disk.body.k + X * rise_x + Y * rise_y, at.sigma4, rtol=1e-12)
    np.testing.assert_allclose(height, np.sin(theta), rtol=1e-13)
    np.testing.assert_allclose(z, 1.0 - at.S, atol=1e-15)


def test_half_a_rule_integrates_even_powers_and_tells_even_coefficients():
    tables, first = BODIES["uniform"].leg_tables, 0
    assert tables.sizes.tolist() == list(LEG_SIZES)
    for n in LEG_SIZES:
        rule = tables.rules[:, first : first + n]
        first += n
        for power in (0, 2, 4 * n - 2):
            assert (rule[WEIGHT] * rule[NODE] ** power).sum() == pytest.approx(1.0 / (power + 1.0), rel=1e-13)
        degree = 2 * n - 2
        legendre = np.polynomial.legendre.Legendre.basis(degree)(rule[NODE])
        # Twice the coefficient of the highest even degree, from half of the interval.
        assert (rule[WEIGHT] * rule[EVEN] * legendre).sum() == pytest.approx(1.0, rel=1e-12)
    assert first == tables.rules.shape[1]

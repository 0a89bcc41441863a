"""Sections 3 and 4 of the paper hold, and every row fails once something in it is damaged."""

import numpy as np
import pytest
from paper_rows import Statements, scaled

from explorer.paper import eight_dimensions as plain
from explorer.paper import section_3_4
from explorer.paper.closed_forms import scaled as scaled_solution

NUMBERS = range(9, 19)
SLIGHTLY = scaled(1.0 + 1e-6)
DAMAGES = [
    (9, section_3_4, "chaplygin_rates", SLIGHTLY),
    (10, section_3_4, "chaplygin_rates", SLIGHTLY),
    (11, section_3_4, "amended", SLIGHTLY),
    (12, section_3_4.Swing, "period", SLIGHTLY),
    (13, section_3_4.Swing, "period", SLIGHTLY),
    (14, section_3_4, "growth", scaled(1.002)),
    (15, plain, "angular_acceleration", SLIGHTLY),
    (16, section_3_4, "parameters", SLIGHTLY),
    (17, section_3_4, "scaled", SLIGHTLY),
    (18, section_3_4, "scaled_slope", SLIGHTLY),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_the_slope_of_the_scaled_potential_is_its_derivative():
    c, d, X, Y, z, h = 4.0 / 3.0, 2.0 / 3.0, 0.8, 0.3, 0.6, 1e-3
    x, y, _ = scaled_solution(c, d, X, Y, z)
    W = [scaled_solution(c, d, X, Y, z + k * h)[2] for k in (-2, -1, 1, 2)]
    derivative = np.dot([1.0, -8.0, 8.0, -1.0], W) / (12.0 * h)
    assert section_3_4.scaled_slope(c, d, x, y, z) == pytest.approx(derivative, rel=1e-9)
    assert section_3_4.scaled_slope(c, d, x, y, z, printed=True) != pytest.approx(derivative, rel=0.1)

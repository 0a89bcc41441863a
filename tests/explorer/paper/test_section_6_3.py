"""Section 6.3 of the paper holds, and every row fails once something it rests on is damaged."""

import numpy as np
import pytest
from paper_rows import Statements, first, upwards

from explorer.paper import closed_forms, section_6_3
from explorer.paper import eight_dimensions as plain

NUMBERS = range(36, 40)
DAMAGES = [
    (36, plain, "angular_acceleration", upwards),
    (37, closed_forms, "at_vertical", first(1.0 + 1e-6)),
    (38, plain, "angular_acceleration", upwards),
    (39, plain, "angular_acceleration", upwards),
]


class TestStatements(Statements):
    """Those of NUMBERS, each with its damage."""


def test_limits_and_orders_of_a_known_function():
    """3 - 2 tau + tau^2 tends to 3 at the rate tau; its rate of change in time, along which tau falls, is 2."""
    tau = 0.155 + 0.145 * np.cos(np.pi * (np.arange(14) + 0.5) / 14)
    values = 3.0 - 2.0 * tau + tau**2
    assert section_6_3.at_impact(tau, values) == pytest.approx(3.0, abs=1e-12)
    assert section_6_3.at_impact(tau, values, 1) == pytest.approx(2.0, abs=1e-9)
    assert section_6_3.approach(tau, values) == pytest.approx(1.0, abs=0.05)

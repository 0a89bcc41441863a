"""Pictures over all bodies."""

import numpy as np
from conftest import BODIES

from explorer import plot
from explorer.portrait.bodies import measured_gaps, race_numbers

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


def test_the_limits_part_by_a_distance_on_the_circle_and_agree_for_the_matching_bodies():
    numbers = race_numbers(16.0, 200)
    figure = plot.race_bodies(numbers, measured_gaps([HOOP, UNIFORM]))
    curve, matching, measured = figure.axes[1].lines[:3]
    np.testing.assert_array_equal(matching.get_xdata(), [0.0, 3.0, 8.0, 15.0])
    np.testing.assert_array_equal(matching.get_ydata(), 0.0)
    np.testing.assert_allclose(measured.get_ydata(), [2 * np.pi - 4.599611, 1.483259], atol=1e-6)
    y = np.asarray(curve.get_ydata())
    assert y.min() >= 0.0
    assert y.max() <= np.pi
    # Nothing jumps: the steepest piece is at m r^2/I1 = 0
    assert abs(np.diff(y)).max() < np.pi * np.diff(numbers.ratio).max() * 1.01
    assert {text.get_text() for text in figure.axes[0].texts} == {"hoop", "uniform"}

"""Comparisons fail where they should, and the bodies and fits are what they say."""

import math

import numpy as np
import pytest

from explorer.paper.checks import at_least, at_most, exponent, largest, logarithmic, near, worst


def test_the_error_of_a_comparison_is_the_largest_difference():
    finding = near("numbers", [1.0, 2.0, 3.5], [1.0, 2.0, 3.0], 0.5, "a reason")
    assert finding.error == 0.5
    assert finding.passed
    assert not near("numbers", [1.0, 2.0, 3.6], [1.0, 2.0, 3.0], 0.5, "a reason").passed
    assert (finding.measured, finding.expected) == ("1, 2, 3.5", "1, 2, 3")


@pytest.mark.parametrize(
    "finding",
    [
        near("a limit", [1.0, math.nan], 1.0, 10.0, "a reason"),
        at_most("a bound", math.nan, 10.0, "a reason"),
        at_least("a bound", math.nan, -10.0, "a reason"),
        at_most("the largest of some", largest([0.0, math.nan, 1.0]), 10.0, "a reason"),
        near("the worst body", worst(lambda disk: math.nan if disk.name == "hoop" else 0.0), 0.0, 1.0, "a reason"),
    ],
    ids=lambda finding: finding.computed,
)
def test_nan_fails_wherever_it_stands(finding):
    assert not finding.passed


def test_bounds_hold_on_one_side_only():
    assert at_most("a bound", -5.0, 1.0, "a reason").passed
    assert not at_most("a bound", 1.1, 1.0, "a reason").passed
    assert at_least("a bound", 5.0, 1.0, "a reason").passed
    assert not at_least("a bound", 0.9, 1.0, "a reason").passed


def test_fits_find_what_was_put_in():
    x = np.geomspace(1e-6, 1e-2, 9)
    assert exponent(x, -3.0 * x**1.5) == pytest.approx(1.5, abs=1e-12)
    lead, left = logarithmic(-x, 0.3 * -x * np.log(1.0 / x) + 2.0 * -x)
    assert lead == pytest.approx(0.3, rel=1e-10)
    assert left < 1e-12
    assert logarithmic(x, x**0.5)[1] > 0.05

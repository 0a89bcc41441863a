"""Dormand and Prince's method of order eight: its order and its step control."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import summed_errors

from kernels.steps.attempt import RK8
from kernels.steps.eighth import combined_error, eighth_step_factor, longest_step


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_eighth_order_method_converges_with_its_order(name):
    """The sum over components: single ones reach rounding before they settle."""
    errors = summed_errors(RK8, (10, 20), 1.5, 100, BODIES[name].body).sum(axis=1)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8, abs=0.25)


@pytest.mark.parametrize(("error", "factor"), [(np.nan, 0.3), (np.inf, 0.3), (0.0, 4.0), (1.0, 0.9)])
def test_step_control_shrinks_on_nan_and_never_leaves_its_bounds(error, factor):
    assert eighth_step_factor(error) == pytest.approx(factor)


def test_the_combined_error_lies_below_that_of_order_five_and_keeps_a_nan():
    for fifth, third in ((1e-3, 1e-3), (1e-8, 1e-4), (1.0, 0.0)):
        assert 0.0 < combined_error(fifth, third) <= fifth
    assert np.isnan(combined_error(np.nan, 1.0))
    assert np.isnan(combined_error(1.0, np.nan))


def test_a_loose_tolerance_allows_longer_steps_but_no_jump():
    tolerances = 10.0 ** np.linspace(-12, 0, 241)
    longest = np.array([longest_step(tolerance) for tolerance in tolerances])
    assert (longest[tolerances <= 1e-3] == 1.0).all()
    assert longest[-1] == 1.5
    assert (np.diff(longest) >= 0.0).all()
    assert np.diff(longest).max() < 0.03

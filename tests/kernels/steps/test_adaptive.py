"""Dormand and Prince's method of order five: its order, its error estimate, its step control."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import UNIFORM, march, start, summed_errors

from kernels.disk.field import ANGLES, PATH, State, speed
from kernels.steps.adaptive import GROW, SHRINK, dopri5_step, error_norm, step_factor
from kernels.steps.attempt import DOPRI5


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_method_converges_with_its_order_in_every_component(name):
    errors = summed_errors(DOPRI5, (160, 320), 3.0, 30, BODIES[name].body)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 5, atol=0.2)


def test_the_error_estimate_bounds_the_error_of_the_embedded_solution():
    b = UNIFORM.body
    for h in (0.05, 0.1, 0.2):
        y, e = dopri5_step(start(), h, b)
        fine = march(DOPRI5, start(), h / 256, 256, b)
        true = error_norm(start(), State(*(np.array(y) - np.array(fine))), speed(start(), b), b, ANGLES)
        assert true <= error_norm(start(), e, speed(start(), b), b, ANGLES)


@pytest.mark.parametrize(("error", "factor"), [(np.nan, SHRINK), (np.inf, SHRINK), (0.0, GROW), (1.0, 0.9)])
def test_step_control_shrinks_on_nan_and_never_leaves_its_bounds(error, factor):
    assert step_factor(error) == pytest.approx(factor)


def test_the_error_norm_keeps_a_nan_wherever_it_stands():
    x = start()
    for name in ("q", "z", "p", "rho", "sigma4", "chi"):
        e = State(*np.zeros(10))._replace(**{name: np.nan})
        assert np.isnan(error_norm(x, e, 1.0, UNIFORM.body, ANGLES)), name


def test_errors_of_the_path_only_count_where_the_path_is_carried():
    e = State(*np.zeros(10))._replace(a2=0.5, q=0.1)
    assert error_norm(start(), e, 1.0, UNIFORM.body, ANGLES) == pytest.approx(0.1)
    assert error_norm(start(), e, 1.0, UNIFORM.body, PATH) == pytest.approx(0.5)

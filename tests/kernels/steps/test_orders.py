"""The methods have the orders that they are called by, and no step is taken on an error that is not a number."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import UNIFORM, start, summed_errors

from kernels.disk.field import ANGLES, State
from kernels.steps import adaptive, attempt, eighth


@pytest.mark.parametrize("name", ["uniform", "thick"])
@pytest.mark.parametrize(("method", "order"), [(attempt.RK4, 4), (attempt.DOPRI5, 5)])
def test_the_methods_converge_with_their_orders_in_every_component(method, order, name):
    errors = summed_errors(method, (160, 320), 3.0, 30, BODIES[name].body)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), order, atol=0.2)


@pytest.mark.parametrize("name", ["uniform", "thick"])
def test_the_eighth_order_method_converges_with_its_order(name):
    """The sum over components: single ones reach rounding before they settle."""
    errors = summed_errors(attempt.RK8, (10, 20), 1.5, 100, BODIES[name].body).sum(axis=1)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8, abs=0.25)


@pytest.mark.parametrize(
    ("factor", "shrink", "grow"),
    [(adaptive.step_factor, adaptive.SHRINK, adaptive.GROW), (eighth.eighth_step_factor, 0.3, 4.0)],
)
def test_step_control_shrinks_on_nan_and_never_leaves_its_bounds(factor, shrink, grow):
    assert [factor(error) for error in (np.nan, np.inf, 0.0, 1.0)] == pytest.approx([shrink, shrink, grow, 0.9])


def test_errors_keep_a_nan_wherever_it_stands():
    for name in ("q", "z", "p", "rho", "sigma4", "chi"):
        error = State(*np.zeros(10))._replace(**{name: np.nan})
        assert np.isnan(adaptive.error_norm(start(), error, 1.0, UNIFORM.body, ANGLES)), name
    assert np.isnan([eighth.combined_error(np.nan, 1.0), eighth.combined_error(1.0, np.nan)]).all()

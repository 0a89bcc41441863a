"""The classical method of order four."""

import numpy as np
import pytest
from conftest import BODIES
from steppers import summed_errors

from kernels.steps.attempt import RK4


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_method_converges_with_its_order_in_every_component(name):
    errors = summed_errors(RK4, (160, 320), 3.0, 30, BODIES[name].body)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 4, atol=0.2)

"""The depths of a step."""

import numpy as np
import pytest
from steppers import DOPRI5, UNIFORM, march, start

from kernels.disk.field import State, energy
from kernels.steps.lanes import all_finite


def test_the_path_adds_the_centre_and_leaves_the_rest_close():
    b, x = UNIFORM.body, start()
    full = np.array(march(DOPRI5, x, 0.01, 200, b))
    assert abs(full[8:]).max() > 0.1
    assert energy(State(*full), b) == pytest.approx(energy(x, b), rel=1e-11)


def test_one_component_that_is_not_finite_is_enough():
    for place in range(10):
        for bad in (np.nan, np.inf, -np.inf):
            assert not all_finite(State(*np.where(np.arange(10) == place, bad, 1.0)))
    assert all_finite(start())

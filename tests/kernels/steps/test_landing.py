"""Landings of a group: every event is met to rounding, also those of groups that are not full."""

import numpy as np
import pytest
from steppers import CASES, NAMES, RK4, random_states, run_batch

from kernels.disk.field import ANGLES, ROW
from kernels.status import Status


@pytest.mark.parametrize("count", [1, 15, 16, 17, 50])
@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_every_sample_lands_on_its_turning_point(method, control, count):
    out, status, steps, _ = run_batch(method, ANGLES, random_states(count), control)
    assert (status == Status.OK).all()
    assert (steps > 0).all()
    assert (abs(out[ROW.p]) <= 1e-14).all()
    assert (abs(out[ROW.q] ** 2 + out[ROW.z] ** 2 - 1.0) < 1e-4).all()


def test_where_a_step_is_too_long_to_find_the_event_in_it_no_answer_is_given():
    out, status, steps, _ = run_batch(RK4, ANGLES, random_states(32), 2.1)
    found = status == Status.OK
    assert found.any()
    assert (abs(out[ROW.p, found]) <= 1e-12).all()
    missed = status == Status.STEP_LIMIT
    assert missed.any()
    assert steps[missed].max() < 10  # it was not for their number
    assert np.isnan(out[:, missed]).all()

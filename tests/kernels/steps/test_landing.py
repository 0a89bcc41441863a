"""Landings of a group: every event is met to rounding, also those of groups that are not full."""

import pytest
from steppers import CASES, NAMES, random_states, run_batch

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

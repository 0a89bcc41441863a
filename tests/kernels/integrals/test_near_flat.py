"""Formulas of the lanes below the handover, against those of a single tilt."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.integrals.near_flat import near_flat, newton, slope_of
from kernels.integrals.point import VERTICAL, motion_through, point
from kernels.integrals.tables import HANDOVER


@pytest.mark.parametrize("name", ["uniform", "thick"])
def test_a_tilt_is_the_same_in_lanes_and_by_itself(name):
    disk, low = BODIES[name], BODIES[name].tables.low
    motion = motion_through(VERTICAL, 1.0, 0.7, 1e-3, disk.natural)
    for h in np.geomspace(1e-4, HANDOVER, 12):
        lane = near_flat(h, math.log(h), motion, disk.body, low)
        at = point(h, motion.X, motion.Y, disk.natural)
        assert (lane.V, lane.D, lane.n / lane.shape) == pytest.approx((at.V, at.D, at.ratio), rel=1e-13)
        assert slope_of(h, lane, motion.X, disk.body) == pytest.approx(at.slope, rel=1e-12)


def test_five_steps_of_newtons_method_find_the_turning_point():
    disk, low = BODIES["hoop"], BODIES["hoop"].tables.low
    motion = motion_through(VERTICAL, 1.0, 0.7, 1e-2, disk.natural)
    h = abs(motion.Y) * math.sqrt(0.5 * disk.body.I1 / motion.level)
    log_h = math.log(h)
    for _ in range(5):
        h, log_h, step = newton(h, log_h, motion, disk.body, low)
    assert abs(step) < 1e-12
    assert math.exp(log_h) == pytest.approx(h, rel=1e-14)
    assert pytest.approx(motion.level, rel=1e-12) == point(h, motion.X, motion.Y, disk.natural).V

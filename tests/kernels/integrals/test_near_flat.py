"""Formulas of the lanes below the handover, against those of a single tilt."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.disk import chaplygin
from kernels.disk.constants import Motion
from kernels.integrals.near_flat import near_flat, newton, slope_of
from kernels.integrals.tables import HANDOVER


def point(h, X, Y, disk):
    """(V - V_0, D, sigma3/q, h dV/dh) at a chord h, as the equations have it."""
    b, S, shape = disk.body, 0.5 * h * h, math.sqrt(1.0 - 0.25 * h * h)
    f = chaplygin.solutions(S, math.log(S), b.c, disk.natural.series)
    q, z, ratio = h * shape, 1.0 - S, (X * f.rho_over_S * S + Y * f.D) / (h * shape)
    bent = np.polynomial.polynomial.polyval(2.0 * S - 1.0, disk.natural.series[4])  # (rho' - 1)/S
    flat, rise = X / b.k, (X * S * bent + Y * f.dD) / b.k
    V = 0.5 * b.I1 * ratio**2 + 0.5 * b.J * rise * (2.0 * flat + rise) + q
    slope = b.J * ratio * (flat + rise) + z - b.I1 * z * ratio**2 / q
    return V, f.D, ratio, slope * h / shape


def motion_through_the_vertical(speed, X, Y, disk):
    return Motion(X, Y, 0.5 * disk.body.M * speed**2 + point(math.sqrt(2.0), X, Y, disk)[0])


@pytest.mark.parametrize("name", ["uniform", "thick"])
def test_a_tilt_is_the_same_in_lanes_and_by_itself(name):
    disk, low = BODIES[name], BODIES[name].tables.low
    motion = motion_through_the_vertical(1.0, 0.7, 1e-3, disk)
    for h in np.geomspace(1e-4, HANDOVER, 12):
        lane = near_flat(h, math.log(h), motion, disk.body, low)
        V, D, ratio, slope = point(h, motion.X, motion.Y, disk)
        assert (lane.V, lane.D, lane.n / lane.shape) == pytest.approx((V, D, ratio), rel=1e-13)
        assert slope_of(h, lane, motion.X, disk.body) == pytest.approx(slope, rel=1e-12)


def test_five_steps_of_newtons_method_find_the_turning_point():
    disk, low = BODIES["hoop"], BODIES["hoop"].tables.low
    motion = motion_through_the_vertical(1.0, 0.7, 1e-2, disk)
    h = abs(motion.Y) * math.sqrt(0.5 * disk.body.I1 / motion.level)
    log_h = math.log(h)
    for _ in range(5):
        h, log_h, step = newton(h, log_h, motion, disk.body, low)
    assert abs(step) < 1e-12
    assert math.exp(log_h) == pytest.approx(h, rel=1e-14)
    assert pytest.approx(motion.level, rel=1e-12) == point(h, motion.X, motion.Y, disk)[0]

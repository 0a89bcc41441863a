"""The motion at one tilt."""

import math

import numpy as np
import pytest
from conftest import BODIES

from kernels.disk.falling import potential_at_flat
from kernels.disk.field import State, energy
from kernels.integrals.point import VERTICAL, motion_through, point

SHAPES = ["uniform", "hoop", "thick"]


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("h", [0.05, 0.5, VERTICAL])
def test_energy_is_tilting_and_the_potential(name, h):
    """(2.19) for the state that has this tilt and these constants."""
    disk = BODIES[name]
    X, Y, rate = 0.7, -0.2, 0.3
    at = point(h, X, Y, disk.natural)
    state = State(h * at.shape, 1.0 - at.S, rate, at.ratio, at.sigma4, 0.0, 0.0, 0.0, 0.0, 0.0)
    motion = motion_through(h, rate, X, Y, disk.natural)
    assert motion.level + potential_at_flat(X, disk.body) == pytest.approx(energy(state, disk.body), rel=1e-13)


@pytest.mark.parametrize("name", SHAPES)
def test_the_slope_is_the_derivative_in_ln_h(name):
    natural, step = BODIES[name].natural, 1e-5
    for h in np.geomspace(1e-3, 1.4, 12):
        V = [point(h * math.exp(sign * step), 0.7, 1e-3, natural).V for sign in (1.0, -1.0)]
        assert point(h, 0.7, 1e-3, natural).slope == pytest.approx((V[0] - V[1]) / (2.0 * step), rel=1e-6)


def test_near_flat_the_potential_is_that_of_the_race_alone():
    """V - V_0 goes to I1 Y^2 / (2 h^2), however small both are."""
    disk = BODIES["hoop"]
    for h in (1e-100, 1e-250):
        assert pytest.approx(0.5 * disk.body.I1 * 0.09, rel=1e-12) == point(h, 0.7, 0.3 * h, disk.natural).V

"""Normal force and friction of a passage."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from kernels.integrals.forces import forces
from kernels.integrals.point import VERTICAL, motion_through, point


def kinetic(h, motion, disk):
    """theta-dot^2 = 2 (E - V) / M."""
    return 2.0 * disk.body.inv_M * (motion.level - point(h, motion.X, motion.Y, disk.natural).V)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_normal_force_is_the_weight_and_the_acceleration_of_the_height(name):
    """With P = theta-dot^2 the height sin theta accelerates by cos theta P'/2 - sin theta P."""
    natural = BODIES[name].natural
    motion = motion_through(VERTICAL, 0.4, 0.6, 0.2, natural)
    step = 1e-5
    for theta in (0.5, 0.9, 1.3):
        P = [kinetic(2.0 * np.sin(0.5 * t), motion, BODIES[name]) for t in (theta - step, theta, theta + step)]
        height = 0.5 * np.cos(theta) * (P[2] - P[0]) / (2.0 * step) - np.sin(theta) * P[1]
        assert forces(2.0 * np.sin(0.5 * theta), motion, natural).normal == pytest.approx(1.0 + height, rel=1e-7)


@pytest.mark.parametrize(("sigma3_bar", "eta", "speed"), [(0.3, 0.1, 1.0), (1.4, 0.05, 0.2), (-0.9, 0.3, 0.6)])
def test_the_extremes_are_those_of_a_fine_grid_between_the_vertical_and_the_turning_point(sigma3_bar, eta, speed):
    disk = BODIES["uniform"]
    out = ex.passage_forces(disk, sigma3_bar, disk.eta_to_eta_hat(eta), speed)
    motion = motion_through(VERTICAL, speed, sigma3_bar / disk.body.r0, eta / disk.body.I1, disk.natural)
    h = np.geomspace(VERTICAL, 1e-3, 4001)
    moves = np.array([kinetic(each, motion, disk) >= 0.0 for each in h])
    passed = h[: np.argmin(moves)]
    found = np.array([forces(each, motion, disk.natural) for each in passed])
    assert passed.size > 500
    assert out.min_normal_force[0] == pytest.approx(found[:, 0].min(), rel=2e-3)
    assert out.max_friction[0] == pytest.approx(found[:, 1].max(), rel=2e-3)


def test_where_the_disk_is_not_pressed_down_no_friction_is_enough():
    disk = BODIES["uniform"]
    motion = motion_through(VERTICAL, 3.0, 0.2, 0.1, disk.natural)
    at = forces(VERTICAL, motion, disk.natural)
    assert at.normal < 0.0
    assert at.friction == np.inf


def test_a_fast_start_is_pressed_down_least_at_the_vertical_and_no_further():
    """There the contact bears the weight less what holds the centre on its circle: 1 - speed^2."""
    disk, speed = BODIES["uniform"], 3.0
    found = ex.passage_forces(disk, 0.05, disk.eta_to_eta_hat(0.5), speed)
    assert found.min_normal_force[0] == pytest.approx(1.0 - speed**2, rel=1e-12)

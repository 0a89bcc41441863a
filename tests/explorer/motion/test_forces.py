"""Forces at the contact during passages."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories

import explorer as ex
from explorer import compiled
from explorer.motion.trajectories import finer


def along(disk, eta_hat, sigma3_bar, speed):
    """Time, tilt, normal force (m g) and the friction that rolling needs, over one period from the vertical.

    The centre moves at z p upwards and at (p q - i sigma4) e^(i chi) along the table; the field differentiates.
    """
    start, unit = ex.constants_to_states(disk, sigma3_bar, eta_hat, speed), disk.rate_unit
    names = ("phi", "phidot", "sigma3", "sigma4")
    motion = trajectories(start, float(ex.periods(start).period), observables=names, accuracy=1e-9)
    at = motion(finer(motion.t, 4))
    phi, *rates = (getattr(at, name) for name in names)
    force = []
    for q, z, p, s3, s4 in zip(
        np.cos(phi), np.sin(phi), *(rate / unit for rate in (-rates[0], *rates[1:])), strict=True
    ):
        k = compiled.field.field(compiled.field.reduced_state(q, z, p, s3 / q, s4), disk.body)
        force.append(np.array([z * k.p + k.z * p, q * k.p + k.q * p + k.chi * s4, k.chi * p * q - k.sigma4]) / k.t)
    up, *level = np.transpose(force)
    normal = 1.0 + up
    return at.t, 0.5 * np.pi - phi, normal, np.hypot(*level) / np.where(normal > 0.0, normal, np.nan)


@pytest.mark.parametrize(("name", "least"), [("uniform", -0.97), ("hoop", -0.89)])
def test_the_normal_force_of_the_papers_own_scenes_falls_below_zero(name, least):
    """Section 8. Where the disk would lift off, no friction is enough."""
    found = ex.passage_forces(BODIES[name], 1.0, 0.01, 1.0)
    assert found.min_normal_force == pytest.approx(least, abs=0.01)
    assert np.isinf(found.max_friction)


@pytest.mark.parametrize(("sigma3_bar", "eta_hat", "speed"), [(0.3, 0.1, 1.0), (1.4, 0.05, 0.2), (-0.9, 0.3, 0.6)])
def test_the_extremes_are_those_along_the_motion(sigma3_bar, eta_hat, speed):
    """As integrated, with the forces that the field gives, down and up again to the vertical."""
    disk = BODIES["uniform"]
    found = ex.passage_forces(disk, sigma3_bar, eta_hat, speed)
    _, theta, normal, friction = along(disk, eta_hat, sigma3_bar, speed)
    beyond = np.flatnonzero(theta[1:] >= 0.5 * np.pi)
    here = slice(0, 1 + beyond[0] if beyond.size else None)
    normal, friction = normal[here], friction[here]
    assert found.min_normal_force == pytest.approx(normal.min(), rel=2e-3)
    if np.isnan(friction).any():
        assert found.max_friction == np.inf
    else:
        assert found.max_friction[0] == pytest.approx(friction.max(), rel=2e-3)


def test_a_fast_start_is_pressed_down_least_at_the_vertical_and_no_further():
    """There the contact bears the weight less what holds the centre on its circle: 1 - speed^2."""
    disk, speed = BODIES["uniform"], 3.0
    found = ex.passage_forces(disk, 0.05, disk.eta_to_eta_hat(0.5), speed)
    assert found.min_normal_force == pytest.approx(1.0 - speed**2, rel=1e-12)


def test_a_calm_passage_stays_on_the_table():
    found = ex.passage_forces(BODIES["uniform"], 0.05, 0.3, 0.2)
    assert 0.0 < found.min_normal_force < 1.0
    assert np.isfinite(found.max_friction)


def test_what_is_no_passage_has_no_forces():
    found = ex.passage_forces(BODIES["uniform"], 1.0, [1e-3, 1e-3, 5e-324, 0.0], [1.0, -1.0, 1.0, 1.0])
    assert np.isnan(found.max_friction).tolist() == [False, True, True, True]
    assert np.isnan(found.min_normal_force).tolist() == [False, True, True, True]
    assert [found.status[place] for place in (0, 1, 3)] == [ex.Status.OK, ex.Status.BAD_INPUT, ex.Status.FALLS]
    assert found.status[2] != ex.Status.OK


def test_a_friction_that_overflows_is_no_answer():
    found = ex.passage_forces(ex.Disk(I1=0.25, I3=1e-9), 0.3, 1e-300, 0.3)
    assert found.status == ex.Status.NOT_FINITE
    assert np.isnan(found.max_friction)


def test_the_table_carries_the_weight_on_average():
    """Over a period the centre gains no upward speed, so the normal force averages to the weight."""
    coin = BODIES["coin"]
    t, _, normal, friction = along(coin, 0.3 * coin.rate_unit, 20.0, 25.0)
    assert np.trapezoid(normal, t) / t[-1] == pytest.approx(1.0, abs=2e-3)
    assert np.isnan(friction[normal <= 0.0]).all()
    assert (normal <= 0.0).any()


def test_the_forces_are_what_the_centre_s_path_needs():
    """Second differences of its path: upwards the normal force less the weight, along the table the friction."""
    disk, step = BODIES["uniform"], 1e-3
    t, _, normal, friction = along(disk, -0.3, 0.2, 0.3)
    for row in (np.linspace(0.1, 0.9, 5) * t.size).astype(int):
        moments = t[row] + step * np.array([-1.0, 0.0, 1.0])
        start = ex.constants_to_states(disk, 0.2, -0.3, 0.3)
        path = ex.simulate(start, t_eval=moments, observables=("path",)).path
        pull = (path[0] - 2.0 * path[1] + path[2]) / step**2 + [0.0, 0.0, 1.0]
        assert (normal[row], friction[row]) == pytest.approx((pull[2], np.hypot(*pull[:2]) / pull[2]), abs=2e-4)

"""The way to the next turning point by integration, and the smallest tilt."""

import numpy as np
import pytest
from conftest import BODIES
from tools.many_digits import from_constants, from_state

import explorer as ex
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt, turning_points
from explorer.phase.coordinates import constants_to_states
from explorer.phase.states import phi_to_states


def test_passages_computed_in_forty_digits(reference_passages):
    """Of several bodies, by integration."""
    for row in reference_passages:
        disk = ex.Disk(I1=row["I1"], I3=row["I3"])
        states = constants_to_states(disk, row["sigma3_bar"], row["eta_hat"], row["phidot"])
        turn = turning_points(states, plan(("chi", "psi", "theta_min", "time"), 1e-9))
        assert turn.status[0] == ex.Status.OK
        assert 2.0 * turn.chi[0] == pytest.approx(row["chi_0"], abs=1e-7)
        assert 2.0 * turn.psi[0] == pytest.approx(row["psi_0"], abs=1e-7)
        assert 2.0 * turn.time[0] == pytest.approx(row["duration_0"], rel=1e-7)
        assert turn.theta[0] == pytest.approx(row["theta_min_0"], rel=1e-7)


def test_the_smallest_tilt_is_the_lower_of_both_turning_points_by_any_method(body):
    rng = np.random.default_rng(31)
    rates = rng.uniform(-1.5, 1.5, (3, 200)) * body.rate_unit
    states = phi_to_states(body, rng.uniform(-1.2, 1.2, 200), *rates)
    exact, status, steps = smallest_tilt(states, plan(("theta_min",), 1e-9))
    assert (status == ex.Status.OK).all()
    assert (steps == 0).all()
    theta, status, steps = smallest_tilt(states, plan(("theta_min",), 1e-6, "dop853"))
    good = status == ex.Status.OK
    assert good.mean() > 0.98
    assert (steps[good] > 0).all()
    np.testing.assert_allclose(theta[good], exact[good], rtol=1e-5)


def test_a_motion_that_fails_one_way_has_no_smallest_tilt():
    disk = BODIES["uniform"]
    theta, status, _ = smallest_tilt(constants_to_states(disk, 0.7, [0.0, 1e-3], 1.0), plan(("theta_min",)))
    assert status[0] == ex.Status.FALLS
    assert np.isnan(theta).tolist() == [True, False]


@pytest.mark.parametrize("method", ["rk4", "rk8", "dopri5", "dop853"])
def test_a_start_at_rest_is_one_of_the_two_turning_points(body, method):
    """Following it either way leads to the other one; it was left out, and tilts came out 21 times too large."""
    rng = np.random.default_rng(5)
    phi, (sigma3, sigma4) = rng.uniform(-1.5, 1.5, 300), rng.uniform(-2.0, 2.0, (2, 300)) * body.rate_unit
    states = phi_to_states(body, phi, 0.0, sigma3, sigma4)
    exact, known, _ = smallest_tilt(states, plan(("theta_min",), 1e-9))
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-3, method))
    good = (status == ex.Status.OK) & (known == ex.Status.OK)
    assert good.mean() > 0.98
    np.testing.assert_allclose(theta[good], exact[good], rtol=1e-3)


def test_a_state_at_rest_is_flattest_there_or_at_its_other_end():
    """As states beside it that hardly move are; one at rest that rises was left unresolved."""
    disk, phi = BODIES["uniform"], [0.5, -0.3, 0.2]
    by_roots, near_rest = (
        smallest_tilt(phi_to_states(disk, phi, rate, [0.3, 1.5, 0.1], [0.3, 1.2, 0.0]), plan(("theta_min",)))
        for rate in (0.0, 1e-9)
    )
    assert (by_roots[1] == ex.Status.OK).all()
    np.testing.assert_allclose(by_roots[0], near_rest[0], rtol=1e-12)


@pytest.mark.parametrize(("I1", "I3", "accuracy"), [(0.25, 1e-4, 1e-9), (0.25, 1e-6, 1e-6), (1.0, 1e-8, 1e-6)])
def test_the_smallest_tilt_of_bodies_of_little_I3_is_known_to_the_accuracy(I1, I3, accuracy):
    """Of states whose sigma4 at flat would be of the size of 1/I3; from flat nearly all of them were refused."""
    disk, draw = ex.Disk(I1=I1, I3=I3), np.random.default_rng(3)
    given = draw.uniform(-1.4, 1.4, 400), *draw.normal(0.0, 1.0, (3, 400))
    theta, status, _ = smallest_tilt(phi_to_states(disk, *given), plan(("theta_min",), accuracy))
    assert (status == ex.Status.OK).mean() > 0.99
    for i in np.flatnonzero(status == ex.Status.OK)[:12]:
        motion = from_state((I1, I3), *(float(column[i]) for column in given))
        assert theta[i] == pytest.approx(motion.theta_min, rel=accuracy)


def test_little_axial_inertia_takes_no_digits_of_a_tilt():
    """Where I3 = 1e-8, sigma4 at flat may be 1e8 times sigma3."""
    disk, draw = ex.Disk(I1=1.0, I3=1e-8), np.random.default_rng(3)
    given = draw.uniform(-1.4, 1.4, 400), *draw.normal(0.0, 1.0, (3, 400))
    theta, status, _ = smallest_tilt(phi_to_states(disk, *given), plan(("theta_min",), 1e-9))
    assert (status == ex.Status.OK).mean() > 0.99
    for i in np.flatnonzero(status == ex.Status.OK)[:12]:
        motion = from_state((disk.I1, disk.I3), *(float(column[i]) for column in given))
        assert theta[i] == pytest.approx(motion.theta_min, rel=1e-9)


@pytest.mark.parametrize("method", ["quadrature", "dop853"])
def test_the_smallest_tilt_has_the_constants_that_were_given_with_the_states(method):
    """Computed from the states, eta has an error here that is felt in the second digit of the tilt."""
    disk, draw, n = ex.Disk(I1=1.0, I3=1e-8), np.random.default_rng(5), 12
    given = draw.uniform(-1.5, 1.5, n), 10.0 ** draw.uniform(-6.0, 0.0, n), draw.uniform(0.3, 2.0, n)
    states = constants_to_states(disk, *given)
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-6, method))
    assert (status == ex.Status.OK).all()
    for i in range(n):
        bar, eta_hat, phidot = (float(column[i]) for column in given)
        motion = from_constants((disk.I1, disk.I3), 0.0, phidot, bar, eta_hat)
        assert theta[i] == pytest.approx(motion.theta_min, rel=1e-6)

"""The way to the next turning point by integration, and the smallest tilt."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt, turning_points
from explorer.phase.constants import natural_constants
from explorer.phase.states import constants_to_states, phi_to_states


def test_passages_computed_in_forty_digits(reference_passages):
    """Six bodies, slow and fast starts: angles to 1e-7 where |eta_hat| >= 1e-4, and down to 1e-6."""
    for row in reference_passages:
        disk = ex.Disk(*(row[key] for key in ("m", "r", "g", "I1", "I3")))
        states = constants_to_states(disk, row["sigma3_bar"], row["eta_hat"], row["phidot"])
        turn = turning_points(states, plan(("chi", "psi", "theta_min", "time"), 1e-9))
        assert turn.status[0] == ex.Status.OK
        assert 2.0 * turn.chi[0] == pytest.approx(row["delta_chi"], abs=1e-7)
        assert 2.0 * turn.psi[0] == pytest.approx(row["delta_psi"], abs=1e-7)
        assert 2.0 * turn.time[0] * disk.time_unit == pytest.approx(row["duration"], rel=1e-7)
        assert turn.theta[0] == pytest.approx(row["theta_min"], rel=1e-7)


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["rk4", "dopri5", "rk8", "dop853"])
def test_passages_meet_the_accuracy_asked(body, method, accuracy):
    """99th percentile of angle errors and of relative errors of time and theta_min, |eta_hat| >= 1e-4."""
    if method == "rk4" and accuracy < 1e-6:
        pytest.skip("a fixed step of that accuracy takes 10^5 steps; nobody would ask for it")
    rng = np.random.default_rng(6)
    n, unit = 300, body.rate_unit
    eta_hat = 10 ** rng.uniform(-4, -1, n) * rng.choice([-1, 1], n) * unit
    states = constants_to_states(body, rng.uniform(-2, 2, n) * unit, eta_hat, rng.uniform(0.3, 2, n) * unit)
    natural = natural_constants(states)
    observables = ("chi", "psi", "theta_min", "time")
    coarse = turning_points(states, plan(observables, accuracy, method), natural)
    fine = turning_points(states, plan(observables, 1e-11), natural)
    both = (coarse.status == 0) & (fine.status == 0)
    assert both.mean() > 0.97
    for error in (
        2 * abs(coarse.chi - fine.chi),
        2 * abs(coarse.psi - fine.psi),
        abs(coarse.time / fine.time - 1),
        abs(coarse.theta / fine.theta - 1),
    ):
        assert np.percentile(error[both], 99) <= accuracy


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


def test_a_state_at_rest_is_flattest_there_or_at_its_other_end():
    """As states beside it that hardly move are; one at rest that rises was left unresolved."""
    disk, phi = BODIES["uniform"], [0.5, -0.3, 0.2]
    by_roots, near_rest = (
        smallest_tilt(phi_to_states(disk, phi, rate, [0.3, 1.5, 0.1], [0.3, 1.2, 0.0]), plan(("theta_min",)))
        for rate in (0.0, 1e-9)
    )
    assert (by_roots[1] == ex.Status.OK).all()
    np.testing.assert_allclose(by_roots[0], near_rest[0], rtol=1e-12)

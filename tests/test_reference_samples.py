"""Samples on which methods are tried: they are computed as users' calls do, and compared with true answers."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from reference_samples import IN_TIME, ReferenceMotions, ReferencePassages, through_time

import explorer as ex
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.passages import passages
from explorer.motion.plan import plan
from explorer.phase.coordinates import constants_to_states

DISK = BODIES["hoop"]


@pytest.fixture(scope="module")
def start():
    rng = np.random.default_rng(7)
    eta_hat = rng.choice([-1.0, 1.0], 24) * 10.0 ** rng.uniform(-8, 0, 24)
    return rng.uniform(-2, 2, 24), eta_hat, rng.uniform(0.5, 2, 24), np.ones(24)


@pytest.mark.parametrize("method", ["quadrature", "rk8"])
def test_passages_are_those_of_the_public_call(start, method):
    samples = ReferencePassages(DISK, starts_at_vertical(DISK, *start))
    found, _ = samples.call(plan(samples.observables, 1e-6, method))
    called = passages(DISK, *start, method=method, accuracy=1e-6)
    for name in ("race_angle", "theta_min", "duration", "error_estimate", "status"):
        assert np.array_equal(getattr(found, name), getattr(called, name))


def test_a_setting_is_what_is_integrated_with_and_refuses_nothing(start):
    samples = ReferencePassages(DISK, starts_at_vertical(DISK, *start))
    how = plan(samples.observables, 1e-6, "rk4")
    coarse, fine = (samples.compare(samples.call(replace(how, setting=step))) for step in (0.5, 0.1))
    assert (coarse.status == ex.Status.OK).all()
    assert 4.5 < fine.steps.sum() / coarse.steps.sum() < 5.5
    assert np.median(coarse.errors) > 100.0 * np.median(fine.errors) > 0.0


def test_a_passage_on_the_other_side_is_on_the_wrong_way(start):
    sigma3_bar, eta_hat, speed, face = start
    samples = ReferencePassages(DISK, starts_at_vertical(DISK, *start))
    mirrored = ReferencePassages(DISK, starts_at_vertical(DISK, sigma3_bar, -eta_hat, speed, face))
    how = plan(samples.observables, 1e-6, "quadrature")
    near = abs(eta_hat) < 1e-3
    wrong = samples.compare(mirrored.call(how))
    # Each races as its own eta says, and by 2 kappa pi away from the passage that was meant.
    assert np.allclose(wrong.errors[near], 2.0 * DISK.race_limit, atol=0.05)


def test_motions_are_those_of_the_public_call(start):
    states = constants_to_states(DISK, *start)
    samples = through_time(states, 2.0)
    found = samples.call(plan(samples.observables, 1e-6, "dopri5"))
    called = trajectories(states, t_eval=samples.times, observables=IN_TIME, method="dopri5", accuracy=1e-6)
    assert np.array_equal(found.chi, called.chi)
    assert np.array_equal(found.path, called.path)


def test_the_truth_of_motions_is_that_of_passages_where_the_time_is_one(start):
    exact = passages(DISK, *start, accuracy=1e-11)
    for i in range(6):
        states = constants_to_states(DISK, *(column[i : i + 1] for column in start))
        samples = ReferenceMotions(states, exact.duration[i : i + 1])
        assert samples.exact.chi[0, 0] == pytest.approx(exact.delta_chi[i], abs=1e-11)
        assert samples.exact.psi[0, 0] == pytest.approx(exact.delta_psi[i], abs=1e-11)


def test_a_motion_on_the_other_side_is_counted_and_races_are_left_out(start):
    sigma3_bar, eta_hat, speed, face = start
    samples = through_time(constants_to_states(DISK, *start), 2.5)
    other = through_time(constants_to_states(DISK, sigma3_bar, -eta_hat, speed, face), 2.5)
    how = plan(samples.observables, 1e-6, "rk8")
    assert not samples.compare(samples.call(how)).wrong_way.any()
    crossed = samples.exact.phi.min(axis=1) < 0.0  # those that have been near flat and come back
    near = abs(eta_hat) < 1e-3
    assert samples.compare(other.call(how)).wrong_way[near & crossed].all()
    assert (near & crossed).any()
    racing = ReferenceMotions(
        constants_to_states(DISK, 1.0, [1e-6], 1.0), passages(DISK, 1.0, [1e-6], 1.0).duration / 2.0
    )
    assert racing.compare(racing.call(how)).errors == [0.0]

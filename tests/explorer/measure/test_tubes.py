"""Tubes beside F: they hold what comes flat, their draws are the states they claim, their intervals cover."""

import itertools

import numpy as np
import pytest
from conftest import BODIES
from small_runs import coverage
from tools.many_digits import from_constants

import explorer as ex
from explorer.measure.distributions import Distribution
from explorer.measure.falling_constant import constant_of
from explorer.measure.importance_sampling import NearFallingSet, Rare
from explorer.measure.tubes import widest_eta
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.states import COORDINATES, phi_to_states


def drawn(density, face, delta, count, accuracy=1e-6):
    near_f = NearFallingSet(density, 2, accuracy)
    found, *_ = near_f.draw(face, delta, np.random.default_rng(5), count)
    return found


@pytest.mark.parametrize("name", ["uniform", "thick", "heavy-core"])
@pytest.mark.parametrize("delta", [0.3, 0.03])
def test_a_tube_holds_every_state_that_comes_flatter(name, delta):
    """|eta_hat| of plain draws with theta_min < delta never exceeds the bound that tubes are cut at."""
    disk = BODIES[name]
    draw = np.random.default_rng(9).uniform
    states = phi_to_states(disk, draw(-1.5, 1.5, 20_000), *(disk.rate_unit * draw(-2, 2, (3, 20_000))))
    natural = states.motion
    theta, status, _ = smallest_tilt(states, plan(("theta_min",)))
    flat = (status == 0) & (theta < delta)
    eta = disk.eta_to_eta_hat(np.fmin(abs(natural.eta_plus), abs(natural.eta_minus)))[flat]
    assert flat.sum() > 100
    assert (eta <= widest_eta(natural.energy[flat], delta, disk)).all()


@pytest.mark.parametrize("box", [None, "phi=-1.2:1.2", "phi=-1.5:1.5,sigma3=0.1"])
@pytest.mark.parametrize("face", [1, -1])
def test_draws_of_a_tube_are_states_with_the_eta_they_claim(box, face):
    """At an eta that a state can express, the constants of motion of the state itself agree."""
    disk = ex.Disk.hoop(m=2.0, r=0.5, g=9.81)
    density = Distribution.invariant(disk, box)
    found = drawn(density, face, 0.05, 500)
    rows = np.flatnonzero(found.weight > 0.0)
    assert rows.size > 50
    given = ex.constants(found.states[rows])
    states = phi_to_states(disk, *(getattr(found.states[rows], name) for name in COORDINATES))
    known = ex.constants(states)
    for name in ("eta_hat_plus" if face > 0 else "eta_hat_minus", "sigma3_bar", "energy"):
        np.testing.assert_allclose(
            getattr(known, name), getattr(given, name), rtol=1e-12, atol=1e-12 * disk.rate_unit
        )
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-8))
    np.testing.assert_allclose(theta[status == 0], found.theta_min[rows][status == 0], rtol=1e-6)


def test_draws_of_a_tube_of_little_I3_have_the_tilts_of_their_constants():
    disk = ex.Disk(I1=0.25, I3=1e-4)
    density = Distribution.invariant(disk, "sigma4=-100:100")
    found = drawn(density, 1, 0.01, 4000, 1e-9)
    rows = np.flatnonzero((found.weight > 0.0) & (found.states.phi >= 0.0))
    assert rows.size > 20
    assert (found.status[rows] == ex.Status.OK).all()
    known = ex.constants(found.states)
    for i in rows[:15]:
        given = found.states.phi[i], found.states.phidot[i], known.sigma3_bar[i], known.eta_hat_plus[i]
        motion = from_constants((disk.I1, disk.I3), *map(float, given))
        assert found.theta_min[i] == pytest.approx(motion.theta_min, rel=1e-9)


@pytest.mark.parametrize(
    "box", ["phi=1.57,sigma3=-1e-9:1e-9", "phi=-1.5707963:1.5707963,phidot=-1e4:1e4", "phidot=0,sigma4=-1e-300:1"]
)
def test_any_tube_ends_with_a_finite_weight_and_a_status_for_every_draw(box):
    disk = ex.Disk.uniform()
    for delta, face in itertools.product((1e-100, 1e-12, 1.0), (1, -1)):
        found = drawn(Distribution.invariant(disk, box, ":1e9"), face, delta, 200)
        assert np.isfinite(found.weight).all()
        assert (found.weight >= 0.0).all()
        counted = found.weight > 0.0
        assert np.isfinite(found.theta_min[counted & (found.status == 0)]).all()
        assert set(found.status) <= set(map(int, ex.Status))


def test_intervals_cover_over_four_hundred_small_runs():
    """Between 92 % and 98 % of the 95 % intervals of C, of the slope and of a rung contain the truth."""
    disk = ex.Disk.uniform()
    shares = coverage(Distribution.invariant(disk, "phi=-1:1"), runs=400, draws=128, seed=12)
    assert all(0.92 <= share <= 0.98 for share in shares), shares


@pytest.mark.parametrize("box", [None, "phi=-1:1,sigma4=0.3"])
def test_weights_of_draws_are_the_probability_of_coming_flat(box):
    """P = C delta at a delta so small that its next term, of order delta^2, is far below the error."""
    disk = BODIES["hoop"]
    density = Distribution.invariant(disk, box)
    near_f = NearFallingSet(density, 2, 1e-6)
    found = near_f.below(1e-9, np.random.default_rng(5), 20_000)
    assert found.unknown == 0.0
    assert found.estimate.error < 0.02 * found.estimate.value
    assert abs(found.estimate.value - 1e-9 * constant_of(density).value) < 4.0 * found.estimate.error


def test_an_estimate_is_the_sum_of_the_means_of_its_strata_and_so_is_its_variance():
    disk = BODIES["uniform"]
    near_f = NearFallingSet(Distribution.box(disk), 2, 1e-6)
    parts = [part for face in (1, -1) for part in near_f.draw(face, 1e-3, np.random.default_rng(face + 1), 512)]
    hits = np.array([part.weight * (part.theta_min < 1e-3) for part in parts])
    found = Rare.of([part.sums(1e-3) for part in parts], share=0.5)
    assert found.estimate.value == pytest.approx(2.0 * hits.mean(axis=1).sum())
    assert found.estimate.error == pytest.approx(2.0 * np.sqrt((hits.var(axis=1, ddof=1) / 512).sum()))
    assert found.effective == pytest.approx(hits.sum() ** 2 / (hits**2).sum())

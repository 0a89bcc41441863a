"""Tubes beside F: they hold what comes flat, their draws are the states they claim, their intervals cover."""

import itertools

import numpy as np
import pytest
from conftest import BODIES
from slow_chaplygin import SlowMotion
from small_runs import coverage

import explorer as ex
from explorer.measure.density import Density
from explorer.measure.falling_constant import constant_of
from explorer.measure.falling_probability import FallingProbability
from explorer.measure.tubes import widest_eta
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.linear_constants import line_chart
from explorer.phase.states import phi_to_states


def drawn(disk, density, face, delta, count, accuracy=1e-6):
    probability = FallingProbability(disk, density, np.array([delta]), accuracy, 1, 0)
    return probability.draw(face, delta, np.random.default_rng(5), count)


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
    density = Density.of(disk, box)
    found = drawn(disk, density, face, 0.05, 500)
    rows = found.weight > 0.0
    assert rows.sum() > 50
    phi = found.phi[rows]
    s3, s4 = line_chart(disk, np.cos(phi), face * np.sin(phi)).rates(found.sigma3_bar[rows], found.eta_hat[rows])
    states = phi_to_states(disk, phi, found.phidot[rows], s3, face * s4)
    known = ex.constants(states)
    here = known.eta_hat_plus if face > 0 else known.eta_hat_minus
    np.testing.assert_allclose(here, found.eta_hat[rows], atol=1e-13 * disk.rate_unit)
    np.testing.assert_allclose(known.sigma3_bar, found.sigma3_bar[rows], atol=1e-12 * disk.rate_unit)
    np.testing.assert_allclose(known.energy, found.energy[rows], rtol=1e-12)
    theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-8))
    np.testing.assert_allclose(theta[status == 0], found.theta_min[rows][status == 0], rtol=1e-6)


def test_draws_of_a_tube_of_little_I3_have_the_tilts_of_their_constants():
    disk = ex.Disk(I1=0.25, I3=1e-4)
    density = Density.of(disk, "sigma4=-100:100")
    found = drawn(disk, density, 1, 0.01, 4000, 1e-9)
    rows = np.flatnonzero((found.weight > 0.0) & (found.phi >= 0.0))
    assert rows.size > 20
    assert (found.status[rows] == ex.Status.OK).all()
    for i in rows[:15]:
        given = found.sigma3_bar[i], found.eta_hat[i], found.phidot[i], found.phi[i]
        motion = SlowMotion.of_constants(disk, *map(float, given))
        assert motion.turns_between(found.theta_min[i] * (1.0 - 1e-9), found.theta_min[i] * (1.0 + 1e-9))


@pytest.mark.parametrize(
    "box", ["phi=1.57,sigma3=-1e-9:1e-9", "phi=-1.5707963:1.5707963,phidot=-1e4:1e4", "phidot=0,sigma4=-1e-300:1"]
)
def test_any_tube_ends_with_a_finite_weight_and_a_status_for_every_draw(box):
    disk, deltas = ex.Disk.uniform(), np.array([1e-100, 1e-12, 1.0])
    probability = FallingProbability(disk, Density.of(disk, box, ":1e9"), deltas, 1e-6, 1, 0)
    for delta, face in itertools.product(deltas.tolist(), (1, -1)):
        found = probability.draw(face, delta, np.random.default_rng(5), 200)
        assert np.isfinite(found.weight).all()
        assert (found.weight >= 0.0).all()
        counted = found.weight > 0.0
        assert np.isfinite(found.theta_min[counted & (found.status == 0)]).all()
        assert set(found.status) <= set(map(int, ex.Status))


def test_intervals_cover_over_four_hundred_small_runs():
    """Between 92 % and 98 % of the 95 % intervals of C, of the slope and of a rung contain the truth."""
    disk = ex.Disk.uniform()
    shares = coverage(disk, Density.of(disk, "phi=-1:1"), runs=400, draws=128, seed=12)
    assert all(0.92 <= share <= 0.98 for share in shares), shares


@pytest.mark.parametrize("box", [None, "phi=-1:1,sigma4=0.3"])
def test_weights_of_draws_are_the_probability_of_coming_flat(box):
    """P = C delta at a delta so small that its next term, of order delta^2, is far below the error."""
    disk = BODIES["hoop"]
    density = Density.of(disk, box)
    constant = constant_of(disk, density)
    total = variance = 0.0
    for face in (1, -1):
        draws = drawn(disk, density, face, 1e-9, 20_000)
        hits = draws.weight * (draws.theta_min < 1e-9)
        total, variance = total + hits.mean(), variance + hits.var() / hits.size
    assert variance**0.5 < 0.02 * total
    assert abs(total - 1e-9 * constant.value) < 4.0 * variance**0.5

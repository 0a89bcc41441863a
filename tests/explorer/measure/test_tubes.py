"""Tubes beside F: they hold what comes flat, their draws are the states they claim, their intervals cover."""

import numpy as np
import pytest
from conftest import BODIES
from slow_chaplygin import SlowMotion
from small_runs import coverage

import explorer as ex
from explorer.measure.density import Density
from explorer.measure.falling_constant import constant_of
from explorer.measure.tubes import TiltAndRate, Tube, dimensions, draw_tube, widest_eta
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.states import phi_to_states


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


def test_a_tube_in_a_box_of_fast_spins_holds_every_state_of_it_that_comes_flatter():
    disk, draw, n = BODIES["uniform"], np.random.default_rng(9).uniform, 4000
    given = draw(-1.5, 1.5, n), draw(-1.0, 1.0, n), draw(10.0, 20.0, n), draw(-1.0, 1.0, n)
    states = phi_to_states(disk, *given)
    theta, status, _ = smallest_tilt(states, plan(("theta_min",)))
    known = ex.constants(states)
    flat = (status == 0) & (theta < 0.3) & (abs(known.eta_hat_plus) < abs(known.eta_hat_minus))
    assert flat.sum() > 100
    density = Density.of(disk, "phi=-1.5:1.5,phidot=-1:1,sigma3=10:20,sigma4=-1:1")
    place = TiltAndRate.at(disk, given[0][flat], given[1][flat])
    widest = Tube(disk, density, 1, 0.3)._widest(place)
    assert (abs(known.eta_hat_plus[flat]) <= widest).all()


@pytest.mark.parametrize("box", [None, "phi=-1.2:1.2", "phi=-1.5:1.5,sigma3=0.1"])
@pytest.mark.parametrize("face", [1, -1])
def test_draws_of_a_tube_are_states_with_the_eta_they_claim(box, face):
    """At an eta that a state can express, the constants of motion of the state itself agree."""
    disk = ex.Disk.hoop(m=2.0, r=0.5, g=9.81)
    density = Density.of(disk, box)
    unit = np.random.default_rng(3).random((500, dimensions(density)))
    found = draw_tube(disk, density, constant_of(disk, density).mass, face, 0.05, unit)
    rows = found.weight > 0.0

    unit_rate = disk.rate_unit
    place = TiltAndRate.at(disk, face * found.phi[rows], face * found.phidot[rows] / unit_rate)
    s3, s4 = place.chart.rates(found.sigma3_bar[rows] / unit_rate, found.eta_hat[rows] / unit_rate)
    given = found.phi[rows], found.phidot[rows], s3 * unit_rate, face * s4 * unit_rate
    states = phi_to_states(disk, *given)
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
    unit = np.random.default_rng(3).random((4000, dimensions(density)))
    found = draw_tube(disk, density, constant_of(disk, density).mass, 1, 0.01, unit, 1e-9)
    rows = np.flatnonzero((found.weight > 0.0) & (found.phi >= 0.0))
    assert rows.size > 20
    assert (found.status[rows] == ex.Status.OK).all()
    for i in rows[:15]:
        given = found.sigma3_bar[i], found.eta_hat[i], found.phidot[i], found.phi[i]
        motion = SlowMotion.of_constants(disk, *map(float, given))
        assert motion.turns_between(found.theta_min[i] * (1.0 - 1e-9), found.theta_min[i] * (1.0 + 1e-9))


@pytest.mark.parametrize("delta", [1e-100, 1e-12, 1.0])
@pytest.mark.parametrize(
    "box", ["phi=1.57,sigma3=-1e-9:1e-9", "phi=-1.5707963:1.5707963,phidot=-1e4:1e4", "phidot=0,sigma4=-1e-300:1"]
)
def test_any_tube_ends_with_a_finite_weight_and_a_status_for_every_draw(box, delta):
    disk = ex.Disk.uniform()
    density = Density.of(disk, box, ":1e9")
    unit = np.random.default_rng(4).random((200, dimensions(density)))
    for face in (1, -1):
        found = draw_tube(disk, density, 1.0, face, delta, unit)
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
        points = np.random.default_rng(5).random((20_000, dimensions(density)))
        draws = draw_tube(disk, density, constant.mass, face, 1e-9, points)
        hits = draws.weight * (draws.theta_min < 1e-9)
        total, variance = total + hits.mean(), variance + hits.var() / hits.size
    assert variance**0.5 < 0.02 * total
    assert abs(total - 1e-9 * constant.value) < 4.0 * variance**0.5

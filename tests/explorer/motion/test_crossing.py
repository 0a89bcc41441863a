"""Rises that turn beside the other flat state: small sigma3_bar, down to where it vanishes."""

import numpy as np
import pytest

import explorer as ex
from explorer.motion.crossing import CrossingRise
from explorer.motion.rise import rise
from explorer.phase.constants import natural_constants

BARS = [1e-2, -1e-3, 1e-4, -5.37e-5, 1e-5, 1e-9, -1e-30, 1e-200]


def constants(disk, sigma3_bar, speed):
    natural = natural_constants(ex.constants_to_states(disk, sigma3_bar, 0.0, speed))
    return float(natural.energy[0]), float(natural.sigma3_bar[0])


@pytest.mark.parametrize("speed", [1.0, 1.865])
@pytest.mark.parametrize("sigma3_bar", BARS)
def test_a_rise_is_half_a_period_of_the_motions_beside_it(paper_body, sigma3_bar, speed):
    """Periods by quadrature, which know nothing of series, at an eta that makes no difference."""
    made = rise(paper_body, *constants(paper_body, sigma3_bar, speed))
    states = ex.constants_to_states(paper_body, sigma3_bar, 1e-290, speed)
    period = ex.periods(states, 1e-10)
    assert 2.0 * made.half == pytest.approx(period.period[0], rel=1e-11)
    race = paper_body.race_limit
    assert 2.0 * made.chi_half == pytest.approx(period.chi[0] - race, abs=1e-10)
    assert 2.0 * made.psi_half == pytest.approx(period.psi[0] - race, abs=1e-10)


@pytest.mark.parametrize("sigma3_bar", BARS)
def test_a_rise_in_pieces_keeps_its_energy_and_its_place(sigma3_bar):
    disk = ex.Disk.hoop()
    energy, bar = constants(disk, sigma3_bar, 1.2)
    made = CrossingRise(disk, energy, bar)
    time = np.linspace(0.0, made.half, 400)
    here = made.at(time)
    b = disk.body
    kinetic = b.M * here.speed**2 + b.I1 * (here.turn * here.q) ** 2 + b.J * here.sigma4**2
    np.testing.assert_allclose(0.5 * kinetic + here.q, energy, rtol=1e-9)
    assert here.theta[-1] == pytest.approx(made.theta_turn, rel=1e-14)
    assert made.at(np.array([made.time_at(2.5)])).theta[0] == pytest.approx(2.5, rel=1e-12)


def test_the_period_converges_as_sigma3_bar_vanishes(paper_body):
    """Two swings of the pendulum, which is the limit; every start has a limit motion on both sides."""
    swing = ex.limit_motion(ex.constants_to_states(paper_body, 0.0, 0.0, 1.865)).period
    away = []
    for sigma3_bar in (1e-2, 1e-3, 1e-4, 1e-5, 5.37e-5, 1e-6, 1e-100):
        base = ex.constants_to_states(paper_body, sigma3_bar, 0.0, 1.865)
        plus, minus = (ex.limit_motion(base, side) for side in (1, -1))
        assert plus.period == minus.period
        assert plus.chi_per_period - minus.chi_per_period == pytest.approx(2.0 * paper_body.race_limit)
        away.append(abs(plus.period - 2.0 * swing))
    assert away[0] < 1e-3
    assert away[-1] < 1e-12

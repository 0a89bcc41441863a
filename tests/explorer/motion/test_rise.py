"""One rise on F from flat to its turning point."""

import mpmath
import numpy as np
import pytest
from passing import start_on_f

import explorer as ex
from explorer.motion.falls import fall_from_vertical
from explorer.motion.limit_motions import limit_motion
from explorer.motion.rise import Rise
from explorer.phase.constants import natural_constants
from explorer.phase.lines import line_chart
from explorer.phase.states import constants_to_states


def test_the_fall_from_the_vertical_agrees_with_the_limit_motion(paper_body):
    states = start_on_f(paper_body, 1, 0.7, 0.4)
    natural = natural_constants(states)
    time, chi, psi, _error = fall_from_vertical(paper_body, natural.sigma3_bar, natural.energy)
    limit = limit_motion(states, 1)
    hit = limit.impacts(10.0)[0]
    assert time[0] == pytest.approx(hit, rel=1e-10)
    before = limit(hit * (1 - 1e-12))
    assert chi[0] == pytest.approx(float(before.chi), abs=1e-9)
    assert psi[0] == pytest.approx(float(before.psi), abs=1e-9)


@pytest.mark.parametrize(("sigma3_bar", "energy"), [(0.9, 1.4), (-2.0, 2.5), (0.1, 0.8)])
def test_a_rise_keeps_its_energy_and_ends_at_rest(body, sigma3_bar, energy):
    sigma3_bar *= float(np.sqrt(min(1.0, 0.5 * energy / body.energy_at_flat(sigma3_bar))))
    rise = Rise(body, energy, sigma3_bar)
    time = np.linspace(0.0, rise.half, 30)
    here = rise.at(time)
    b = body.body
    q, z = np.sin(here.theta[1:]), np.cos(here.theta[1:])
    V = 0.5 * b.I1 * (here.turn[1:] * q) ** 2 + 0.5 * b.J * here.sigma4[1:] ** 2 + q
    np.testing.assert_allclose(0.5 * b.M * here.speed[1:] ** 2 + V, energy, rtol=1e-9)
    chart = line_chart(body, q, z)
    np.testing.assert_allclose(here.turn[1:] * q * q, chart.bar_to_sigma3 * sigma3_bar, atol=1e-11)
    assert here.speed[0] == pytest.approx(rise.impact_speed, rel=1e-11)
    assert here.speed[-1] < 1e-6
    assert here.theta[-1] == pytest.approx(rise.theta_turn, rel=1e-12)


def test_the_time_of_a_tilt_is_when_the_rise_is_there(paper_body):
    rise = Rise(paper_body, 1.6, 0.5)
    for theta in (1e-3, 0.4, 0.99 * rise.theta_turn):
        assert rise.at(np.array([rise.time_at(theta)])).theta[0] == pytest.approx(theta, rel=1e-9)
    with pytest.raises(ex.InputError, match="not on the part of F"):
        rise.time_at(1.01 * rise.theta_turn)


def exact_half(disk, sigma3_bar, speed, guess):
    """The time from flat to the turning point in 25 digits, from a speed at the vertical."""
    with mpmath.workdps(25):
        I1, I3 = mpmath.mpf(disk.I1), mpmath.mpf(disk.I3)
        c = I3 / ((I3 + 1) * I1)
        root = mpmath.sqrt(1 - 4 * c)
        a, b = (1 + root) / 2, (1 - root) / 2
        X = sigma3_bar / (mpmath.hyp2f1(a, b, 2, 0.5)).real

        def V(theta):
            q, S = mpmath.sin(theta), 1 - mpmath.cos(theta)
            sigma3 = X * S * mpmath.hyp2f1(a, b, 2, S / 2).real
            sigma4 = X * mpmath.hyp2f1(a, b, 1, S / 2).real * I1 / I3
            return I1 / 2 * (sigma3 / q) ** 2 + (I3 + 1) / 2 * sigma4**2 + q

        energy = (I1 + 1) / 2 * mpmath.mpf(speed) ** 2 + V(mpmath.pi / 2)

        turn = mpmath.findroot(lambda theta: energy - V(theta), guess)
        roots, weights = np.polynomial.legendre.leggauss(256)
        alphas = [mpmath.pi / 4 * (1 + mpmath.mpf(x)) for x in roots]
        rates = [
            turn * mpmath.cos(x) / mpmath.sqrt(2 / (I1 + 1) * (energy - V(turn * mpmath.sin(x)))) for x in alphas
        ]
        return mpmath.pi / 4 * mpmath.fdot(weights, rates)


def test_a_slow_rise_over_the_vertical_takes_as_long_as_in_many_digits():
    """Just above the height of the vertical no series falls to rounding; the one that falls furthest is taken."""
    disk, sigma3_bar, speed = ex.Disk(I1=0.02, I3=0.04), -0.2231, 0.0407
    made = limit_motion(constants_to_states(disk, sigma3_bar, 0.0, speed))
    exact = exact_half(disk, sigma3_bar, speed, made._rise.theta_turn)
    assert made._rise.half == pytest.approx(float(exact), rel=1e-9)

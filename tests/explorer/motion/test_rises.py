"""Rises on F, as limit motions show them: their periods, and what they keep."""

import mpmath
import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories
from moving import nu, velocity
from passing import start_on_f
from scipy.special import ellipkinc

import explorer as ex
from explorer.motion.fall_integrals import fall_from_vertical
from explorer.motion.limit_motions import limit_motion
from explorer.phase.coordinates import constants_to_states
from explorer.phase.falling_set import barrier, well

UNIFORM = BODIES["uniform"]
# The last ones turn beside the other flat state, and race there as well.
BARS = [1.0, -0.3, 1e-2, -1e-3, 1e-4, -5.37e-5, 1e-5, 1e-9, -1e-30, 1e-200, 1e-290]


def test_the_fall_from_the_vertical_agrees_with_the_limit_motion(paper_body):
    states = start_on_f(paper_body, 1, 0.7, 0.4)
    natural = states.motion
    time, chi, psi, _error = fall_from_vertical(paper_body, natural.sigma3_bar, natural.energy)
    limit = limit_motion(states, 1)
    hit = limit.impacts(10.0)[0]
    assert time[0] == pytest.approx(hit, rel=1e-10)
    before = limit(hit * (1 - 1e-12))
    assert chi[0] == pytest.approx(float(before.chi), abs=1e-9)
    assert psi[0] == pytest.approx(float(before.psi), abs=1e-9)


def agree(limit, states, accuracy):
    """Whether a limit motion has the period and angles of the motions beside it, by quadrature."""
    period = ex.periods(states, accuracy=accuracy)
    assert limit.period == pytest.approx(period.period, rel=10.0 * accuracy)
    assert limit.chi_per_period == pytest.approx(period.chi, abs=10.0 * accuracy)
    turned = limit(limit.period).psi - limit(0.0).psi
    assert turned == pytest.approx(period.psi, abs=10.0 * accuracy)


@pytest.mark.parametrize("speed", [1e-6, 1.0, 1.865, 30.0, 1e4])
@pytest.mark.parametrize("sigma3_bar", BARS)
def test_a_limit_motion_has_the_period_of_the_motions_beside_it(paper_body, sigma3_bar, speed):
    """At an eta that makes no difference."""
    limit = ex.limit_motion(ex.constants_to_states(paper_body, sigma3_bar, 0.0, speed))
    agree(limit, ex.constants_to_states(paper_body, sigma3_bar, 1e-292, speed), 1e-12)


@pytest.mark.parametrize("moments", [(1e-6, 2e-6), (1 / 3, 1e-3), (100.0, 50.0)])
@pytest.mark.parametrize("sigma3_bar", [1.0, 1e-3, 1e-200])
def test_so_it_has_for_bodies_at_the_rim(moments, sigma3_bar):
    disk = ex.Disk(I1=moments[0], I3=moments[1])
    limit = ex.limit_motion(ex.constants_to_states(disk, sigma3_bar, 0.0, 1.0))
    agree(limit, ex.constants_to_states(disk, sigma3_bar, 1e-292, 1.0), 1e-10)


def over_the_barrier(disk, share, excess):
    """A start at the vertical, of a sigma3_bar that has a barrier, with a relative excess over its height."""
    bar = share * well(disk).sigma3_bar
    height = float(barrier(disk, np.array([bar]))[0])
    energy = float(ex.constants(ex.constants_to_states(disk, bar, 0.0, 0.0)).energy)
    return bar, np.sqrt(2.0 * (height * (1.0 + excess) - energy) / disk.body.M)


@pytest.mark.parametrize("excess", [1e-2, 1e-5, -1e-5])
def test_so_it_has_beside_a_separatrix(paper_body, excess):
    bar, speed = over_the_barrier(paper_body, 0.3, excess)
    limit = ex.limit_motion(ex.constants_to_states(paper_body, bar, 0.0, speed))
    agree(limit, ex.constants_to_states(paper_body, bar, 1e-292, speed), 1e-11)


def test_on_the_separatrix_itself_the_period_is_infinite(paper_body):
    bar, speed = over_the_barrier(paper_body, 0.9, 0.0)
    with pytest.raises(ex.InputError, match="its period is infinite"):
        ex.limit_motion(ex.constants_to_states(paper_body, bar, 0.0, speed))


@pytest.mark.parametrize("sigma3_bar", [*BARS, 0.0])
def test_a_limit_motion_keeps_its_energy(body, sigma3_bar):
    unit = body.rate_unit
    states = ex.constants_to_states(body, sigma3_bar * unit, 0.0, 1.2 * unit)
    limit = ex.limit_motion(states)
    here = limit(np.linspace(0.0, 2.0 * limit.period, 400))
    b, tilting = body.body, (here.phidot / unit) ** 2
    moving = (velocity(here) ** 2).sum(-1) / (body.r * unit) ** 2  # eq. (2.33): phidot^2 + sigma4^2
    turning = (nu(here) ** 2).sum(-1) / unit**2  # and (sigma3/q)^2 more
    kinetic = b.M * tilting + b.I1 * (turning - moving) + b.J * (moving - tilting)
    energy = ex.constants(states).energy / body.energy_unit
    np.testing.assert_allclose(0.5 * kinetic + here.path[:, 2] / body.r, energy, rtol=1e-11)


@pytest.mark.parametrize("phi", [1.2, 0.3, -0.2, -1.2])
@pytest.mark.parametrize("time", [0.0, 0.7])
def test_a_limit_motion_may_begin_anywhere_on_its_way(paper_body, phi, time):
    """Before and beyond the vertical, on the rise and on the fall."""
    first = ex.limit_motion(ex.constants_to_states(paper_body, 0.02, 0.0, 1.5))
    times = np.linspace(0.0, first.period, 20001)
    at = times[np.argmin(abs(first(times).phi - phi))]
    there = first(at)
    states = ex.phi_to_states(paper_body, there.phi, there.phidot, there.sigma3, there.sigma4)
    second = ex.limit_motion(states)
    assert second.period == pytest.approx(first.period, rel=1e-8)
    for name in ("phi", "phidot"):
        assert getattr(second(time), name) == pytest.approx(getattr(first(at + time), name), abs=1e-7)


def test_a_disk_at_rest_beside_flat_falls_like_a_plank_and_rises_again():
    phi = 1.5707963267948
    theta = np.cos(phi)
    limit = ex.limit_motion(ex.phi_to_states(UNIFORM, phi, 0.0, 0.0, 0.0))
    assert limit.period == pytest.approx(2.0 * np.sqrt(2.0 * UNIFORM.body.M * theta), rel=1e-9)


def test_a_disk_at_rest_beside_the_upright_equilibrium_keels_over_in_its_time():
    states = ex.phi_to_states(UNIFORM, 0.0, 0.0, 1e-4, 0.7285923160189477e-4)
    period = ex.periods(ex.constants_to_states(UNIFORM, 1e-4, 1e-200, 0.0)).period
    assert ex.limit_motion(states).period == pytest.approx(period, rel=1e-8)


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
    disk, sigma3_bar, speed = ex.Disk(I1=0.02, I3=0.04), -0.2231, 0.0407
    made = limit_motion(constants_to_states(disk, sigma3_bar, 0.0, speed))
    top = made(made.impacts(50.0)[0] + 0.5 * made.period)
    exact = exact_half(disk, sigma3_bar, speed, 0.5 * np.pi - float(top.phi))
    assert 0.5 * made.period == pytest.approx(float(exact), rel=1e-12)


def test_the_pendulum_falls_to_both_sides_in_turn():
    disk = BODIES["uniform"]
    for sign in (1, -1):
        for face in (1, -1):
            limit = ex.limit_motion(ex.phi_to_states(disk, 0.0, float(face), 0.0, 0.0), sign)
            hits = limit.impacts(10.0)
            assert hits[0] == pytest.approx(1.293920, abs=5e-7)
            times = np.linspace(0.05, 9.0, 80)
            times = times[abs(times[:, None] - hits).min(axis=1) > 0.1]
            states = constants_to_states(disk, 0.0, face * sign * 1e-10, 1.0, face)
            names = ("phi", "phidot", "chi", "psi", "path", "contact")
            got, want = trajectories(states, t_eval=times, observables=names, accuracy=1e-10), limit(times)
            for name in names:
                np.testing.assert_allclose(getattr(got, name), getattr(want, name), atol=1e-7)


@pytest.mark.parametrize(
    ("begin", "speed"), [(0.0, 1e-7), *((phi, s) for phi in (0.0, 0.4, -0.9) for s in (1e-4, 0.1, 1.0, 6.0))]
)
def test_a_swing_of_the_pendulum_takes_the_time_of_its_integral(body, begin, speed):
    """Legendre's integral of the first kind: M phidot^2 / 2 is that at the vertical and 2 sin^2(phi/2)."""
    unit, M = body.rate_unit, body.body.M
    above = 0.5 * M * speed * speed

    def time(phi):
        return np.sqrt(2.0 * M / above) * ellipkinc(0.5 * phi, -2.0 / above) * body.time_unit

    there = np.sqrt(2.0 / M * (above + 2.0 * np.sin(0.5 * begin) ** 2)) * unit
    limit = ex.limit_motion(ex.phi_to_states(body, begin, there, 0.0, 0.0))
    assert limit.period == pytest.approx(2.0 * time(0.5 * np.pi), rel=1e-12 if begin == 0.0 else 1e-7)
    for phi in (0.5, 1.5):
        assert limit(time(phi) - time(begin)).phi == pytest.approx(phi, abs=1e-9 if begin == 0.0 else 1e-6)


@pytest.mark.parametrize("begin", [0.0, 0.7, -1.1])
def test_the_pendulum_swings_the_same_way_however_slender_the_body(begin):
    swings = [
        ex.limit_motion(ex.phi_to_states(ex.Disk(I1=I1, I3=1.5 * I1), begin, 1.5, 0.0, 0.0)).period
        for I1 in (1e-6, 1e-9)
    ]
    assert swings[0] == pytest.approx(swings[1], rel=1e-5)

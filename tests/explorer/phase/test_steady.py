"""Steady motions by what one measures, against the integrator and against closed forms."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex


@pytest.mark.parametrize("face", [1, -1])
def test_steady_motions_keep_their_tilt_and_their_precession(body, face):
    unit = body.rate_unit
    tilt, precession = np.array([0.2, 0.8, 1.4]), np.array([[2.0], [-3.0]]) * unit
    motion = ex.steady_motions(body, tilt, precession, face)
    assert motion.shape == motion.states.shape == (2, 3)
    assert motion.ok.all()
    run = ex.simulate(motion.states, 1.0 / unit, observables=["phi", "chi"], accuracy=1e-9)
    np.testing.assert_allclose(0.5 * math.pi - face * run.phi, tilt[:, None] + 0.0 * run.t, atol=1e-8)
    np.testing.assert_allclose(run.chi[..., -1] * unit, motion.precession, rtol=1e-7)


def test_the_spin_of_a_wobbling_coin_agrees_with_the_rates_that_it_came_from():
    coin = BODIES["coin"]
    motion = ex.steady_motions(coin, 10.0, math.degrees(60.0), degrees=True)
    states = ex.rates_to_states(coin, math.radians(10.0), 0.0, 60.0, motion.spin)
    np.testing.assert_allclose(states.natural, motion.states.natural, rtol=1e-13, atol=1e-15)
    assert motion.to_pandas().precession[0] == pytest.approx(60.0)


@pytest.mark.parametrize("face", [1, -1])
def test_a_coin_that_does_not_spin_about_its_axis_precesses_by_the_textbook_however_flat(face):
    """precession^2 = 4 g/(r sin tilt) of a uniform disk; the energy is 1.5 m g r sin tilt."""
    coin, tilt = BODIES["coin"], 10.0 ** -np.arange(0.5, 15.0, 0.5)
    precession = np.sqrt(4.0 * coin.g / (coin.r * np.sin(tilt)))
    motion = ex.steady_motions(coin, tilt, precession, face)
    assert motion.ok.all()
    assert (abs(motion.spin) <= 1e-14 * precession).all()
    share = ex.constants(motion.states).energy / (1.5 * coin.energy_unit * np.sin(tilt))
    # Rounding of so fast a precession leaves a spin of 1e-16 of it, and the energy of that.
    assert (abs(share - 1.0) <= 1e-13 + (2.2e-16 / tilt) ** 2).all()
    np.testing.assert_allclose(ex.periods(motion.states).theta_min, tilt, rtol=1e-6)


def test_what_is_not_steady_is_nan_and_bad_input():
    tilt = [0.5, 0.5, 0.0, 4.0, np.nan, 0.5 * np.pi]
    motion = ex.steady_motions(BODIES["uniform"], tilt, [1, 0, 1, 1, 1, 1])
    assert motion.status_names.tolist() == ["ok", *["bad_input"] * 4, "ok"]
    assert np.isnan(motion.spin[1:5]).all()
    assert (motion.states.status == motion.status)[[0, 2, 3, 4, 5]].all()
    assert not motion.stable[1:5].any()
    assert motion.spin[5] == pytest.approx(0.0, abs=1e-15)
    assert len(ex.steady_motions(BODIES["uniform"], [], [])) == 0


def test_a_lean_may_be_in_degrees():
    disk = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    one, other = (
        ex.circular_rolling(disk, 20.0, 0.07, degrees=True),
        ex.circular_rolling(disk, np.radians(20.0), 0.07),
    )
    np.testing.assert_allclose(one.precession, other.precession, rtol=1e-15)
    with pytest.raises(ex.InputError, match="degrees=True"):
        ex.circular_rolling(disk, 20.0, 0.07)


def test_circular_rolling_goes_round_the_circle_that_was_asked_for(paper_body):
    motion = ex.circular_rolling(paper_body, lean=0.4, radius=3.0)
    assert motion.radius == pytest.approx(3.0, rel=1e-12)
    run = ex.simulate(motion.states, 2.0 * math.pi / motion.precession, accuracy=1e-9)
    x, y = run.contact[:, :2].T
    assert np.ptp(x) == pytest.approx(6.0, rel=1e-3)
    assert np.ptp(y) == pytest.approx(6.0, rel=1e-3)
    np.testing.assert_allclose(run.contact[-1], run.contact[0], atol=1e-6)
    with pytest.raises(ex.InputError, match="rolls round circles above"):
        ex.circular_rolling(paper_body, 1.0, 0.1)
    with pytest.raises(ex.InputError, match="lean = x"):
        ex.circular_rolling(paper_body, "x", 0.1)


def test_numbers_of_any_kind_are_read():
    from decimal import Decimal

    found = ex.circular_rolling(ex.Disk.uniform(), Decimal("0.25"), np.array([2.0]))
    assert found.precession == ex.circular_rolling(ex.Disk.uniform(), 0.25, 2.0).precession


def test_a_motion_too_fast_for_states_is_bad_input():
    found = ex.steady_motions(ex.Disk.uniform(), 0.5, [1.0, 1e150])
    assert found.status.tolist() == found.states.status.tolist() == [0, 2]
    assert found.stable.tolist() == [True, False]
    assert np.isnan(found.spin).tolist() == [False, True]

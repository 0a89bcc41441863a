"""Turns per bounce near flat: the Euler disk, the race, and the curve between them."""

import math

import numpy as np
import pytest
from conftest import BODIES
from scipy.integrate import quad

import explorer as ex
from explorer.motion.rocking import rocking

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


def leading_turn(disk, excess):
    """Turn per bounce of p^2/2 M + 1/(2 u^2) + u at 3/2 excess: an integral over u = m + s sin(x)."""
    inner, outer = sorted(root.real for root in np.roots([1.0, -1.5 * excess, 0.0, 0.5]) if root.real > 0.0)
    third = -0.5 / (inner * outer)  # (2E u^2 - 1 - 2 u^3) = 2 (u - inner)(outer - u)(u - third)
    middle, half = 0.5 * (inner + outer), 0.5 * (outer - inner)

    def rate(x):
        u = middle + half * math.sin(x)
        return 1.0 / (u * math.sqrt(2.0 * (u - third)))

    turn = quad(rate, -0.5 * math.pi, 0.5 * math.pi, epsabs=1e-12, epsrel=1e-12, limit=500)[0]
    return 2.0 * math.sqrt(disk.body.M / disk.body.I1) * turn


@pytest.mark.parametrize(
    ("disk", "first", "last"), [(UNIFORM, 2.58177, 2.23607), (HOOP, 1.99983, 1.73205)], ids=["uniform", "hoop"]
)
def test_the_turn_per_bounce_goes_from_the_euler_disk_to_the_race(disk, first, last):
    turns = rocking(disk, [1.001, 1e4])
    np.testing.assert_allclose(turns.chi / math.pi, [first, last], atol=6e-6)
    closer = rocking(disk, [1.0001, 1.001]).chi
    # linear in the energy above the bottom, so the limit can be read off
    assert closer[0] + (closer[0] - closer[1]) / 9.0 == pytest.approx(turns.slowest, abs=1e-7)
    assert turns.slowest == pytest.approx(2.0 * math.pi * math.sqrt(disk.kappa**2 / 3.0))
    assert turns.chi[1] == pytest.approx(disk.race_limit, abs=2e-4)


def test_the_whole_curve_is_the_leading_order_integral(body):
    turns = rocking(body, np.geomspace(1.01, 1e3, 12), 1e-12 * body.rate_unit)
    wanted = [leading_turn(body, excess) for excess in turns.excess]
    np.testing.assert_allclose(turns.chi, wanted, rtol=0.0, atol=2e-6)
    np.testing.assert_allclose(turns.excess, np.geomspace(1.01, 1e3, 12), rtol=1e-6)
    assert (np.diff(turns.chi) < 0.0).all()


def test_the_sign_of_eta_is_the_way_of_the_bounces():
    one, other = (rocking(HOOP, [2.0, 50.0], eta).chi for eta in (1e-10, -1e-10))
    np.testing.assert_allclose(one, -other, rtol=1e-12)


def test_the_euler_disk_turns_at_the_rate_of_the_steady_motion():
    """Near the bottom chi-dot = Omega with Omega^2 = m g r/(I1 sin theta)."""
    turns = rocking(UNIFORM, 1.0001)
    rate = turns.chi / turns.period
    assert rate == pytest.approx(math.sqrt(1.0 / (UNIFORM.I1 * math.sin(turns.theta_0))), rel=1e-3)


@pytest.mark.parametrize("eta_hat", [1e-100, -1e-200, 1e-231, -1e-236, 1e-250, 1e-300, 1e-307])
def test_the_curve_is_the_same_at_the_smallest_tilts(body, eta_hat):
    """From the bottom to the race, at tilts of 1e-205 to 1e-60: squares of V' there are no numbers."""
    excess = np.append(1.0 + np.geomspace(1e-4, 1e-1, 7), np.geomspace(1.5, 1e4, 12))
    turns = rocking(body, excess, eta_hat * body.rate_unit)
    assert turns.ok.all()
    np.testing.assert_allclose(
        turns.chi * math.copysign(1.0, eta_hat), [leading_turn(body, e) for e in excess], rtol=1e-9
    )
    # In u = theta/theta_0 the turning points are roots of 1/(2 u^2) + u = 3/2 excess
    inner = [min(root.real for root in np.roots([1.0, -1.5 * e, 0.0, 0.5]) if root.real > 0.0) for e in excess]
    np.testing.assert_allclose(turns.theta_min / turns.theta_0, inner, rtol=1e-9)


def test_motions_have_the_shape_of_their_energies_and_a_status():
    turns = rocking(HOOP, [[5.0, 3.0, 2.0]])
    assert turns.shape == turns.chi.shape == turns.status.shape == (1, 3)
    assert turns.ok.all()
    assert turns[0, 1].chi == rocking(HOOP, 3.0).chi


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: rocking(UNIFORM, [0.9, 2.0]), "excess = [0.9, 2.0]"),
        (lambda: rocking(UNIFORM, [2.0], 0.0), "eta_hat = 0.0"),
        (lambda: rocking(UNIFORM, [2.0], [[]]), "eta_hat = [[]] is not a number"),
        (lambda: rocking(UNIFORM, [1e4], 1e-3), "eta_hat = 0.001"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)

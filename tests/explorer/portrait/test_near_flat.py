"""Passages near flat: in their own unit of time all races are an arctangent, and rho stays bounded."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.falling_surface import zoom
from explorer.portrait.near_flat import near_flat, toward_limits

HOOP = BODIES["hoop"]


@pytest.mark.parametrize("eta_hat", [1e-4, -1e-4, 1e-8, -1e-8])
def test_the_race_is_the_arctangent_of_the_stretched_time(eta_hat):
    (one,) = near_flat(HOOP, eta_hat)
    seen = abs(one.stretched) < 30.0
    assert seen.sum() > 20
    apart = one.raced[seen] - math.copysign(1.0, eta_hat) * np.arctan(one.stretched[seen])
    # phi is rounded near pi/2, and at the flattest moment the stretched time is a square root of a difference.
    rounded = math.sqrt(np.finfo(float).eps / one.theta_min)
    assert abs(apart).max() < 100.0 * abs(eta_hat) + rounded


def test_a_passage_keeps_to_the_ellipse_of_the_energy_at_flat():
    """p^2 + (rho/kappa)^2 = A^2, but for what gravity and the spin add at a tilt of theta."""
    (one,) = near_flat(HOOP, -1e-6)
    flat = one.theta < 1e-4
    round_it = np.hypot(one.p, one.rho / HOOP.kappa)[flat]
    np.testing.assert_allclose(round_it, one.impact_speed, rtol=2e-4)
    assert one.rho[flat].min() == pytest.approx(-HOOP.kappa * one.impact_speed, rel=1e-2)


def test_nearer_to_f_a_path_is_nearer_to_the_limit_of_its_own_side():
    def apart(both, sign):
        away = np.linalg.norm(both.motions[sign]["contact"] - both.limits[sign].contact, axis=1)
        far = abs(both.t[:, None] - both.impacts).min(axis=1) > 0.3
        return away[far].max()

    far, near = toward_limits(HOOP, [1e-2, 1e-4])
    for sign in (1, -1):
        assert apart(near, sign) < 0.05 * apart(far, sign)


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: near_flat(HOOP, 1e-12), "eta_hat = 1e-12"),
        (lambda: near_flat(HOOP, 1e-3, phidot=-1.0), "phidot = -1.0"),
        (lambda: near_flat(HOOP, np.full(501, 0.1)), "501 distances"),
        (lambda: toward_limits(HOOP, np.full(100_000, 0.1)), "100,000 distances"),
        (lambda: zoom(HOOP, np.full(1_000, 0.1), points=200), "1,000 maps of 200 by 200 points"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)

"""The film's data: two motions at the same times, a body that rolls, a clock that slows."""

import math

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.pictures.film_motions import film

UNIFORM = BODIES["uniform"]


@pytest.fixture(scope="module")
def shown():
    return film(UNIFORM, frames=60)


def test_both_motions_of_the_film_are_flattest_at_zero_and_race_opposite_ways(shown):
    wanted = ex.passages(UNIFORM, 1.0, [0.05, -0.05], 1.0)
    for sign, theta, turn in zip((1, -1), wanted.theta_min, wanted.delta_chi, strict=True):
        tilt = 0.5 * math.pi - shown.phi[sign]
        assert abs(shown.t[np.argmin(tilt)]) < 2e-3
        assert tilt.min() == pytest.approx(theta, rel=1e-3)
        assert shown.chi[sign][-1] - shown.chi[sign][0] == pytest.approx(turn, abs=0.02)
        np.testing.assert_allclose(shown.contact[sign][:, 2], 0.0, atol=1e-15)


def test_the_clock_of_the_film_slows_in_proportion_to_the_tilt(shown):
    """dt = q ds: from frame to frame time goes on by q, so that the race fills many frames."""
    steps = np.diff(shown.t)
    assert (steps > 0.0).all()
    middle = 0.5 * (1.0 / shown.slowed[1:] + 1.0 / shown.slowed[:-1])
    ratio = steps / middle
    assert ratio.max() / ratio.min() < 1.02
    per_frame = abs(np.diff(shown.chi[1][shown.frames]))
    assert per_frame.max() < 0.6
    assert shown.slowed.max() > 20.0


def test_the_rim_touches_the_table_without_sliding(shown):
    for sign in (1, -1):
        for row in (0, 100, 177, 300):
            rim = shown.pose(sign, row).rim(np.linspace(0.0, 2.0 * math.pi, 181))
            np.testing.assert_allclose(rim[0], shown.contact[sign][row], atol=1e-12)
            assert rim[:, 2].min() > -1e-12
            np.testing.assert_allclose(np.linalg.norm(rim - shown.centre[sign][row], axis=1), 1.0, rtol=1e-12)


def test_the_point_of_the_body_at_the_contact_is_at_rest(shown):
    """The one that touches the table at a row has hardly a speed, while the contact point runs."""
    for sign in (1, -1):
        for row in (60, 150, 250):
            moves = []
            for near in (row + 1, row - 1):
                point = shown.pose(sign, near).place(shown.psi[sign][row] - shown.psi[sign][near])
                moves.append(point - shown.contact[sign][row])
            speed = np.linalg.norm(moves[0] - moves[1]) / (shown.t[row + 1] - shown.t[row - 1])
            raced = np.linalg.norm(shown.contact[sign][row + 1] - shown.contact[sign][row - 1]) / (
                shown.t[row + 1] - shown.t[row - 1]
            )
            assert speed < 0.02 * max(raced, 1.0)


def test_over_several_bounces_both_sides_lie_down_together():
    both = film(UNIFORM, eta_hat=0.02, frames=60, bounces=3)
    assert both.phidot[1] == 1.0
    assert 0.9 < both.phidot[-1] < 1.0
    for sign in (1, -1):
        for at in both.flat:
            near = abs(both.t - at) < 0.5
            assert both.phi[sign][near].argmax() == pytest.approx(abs(both.t[near] - at).argmin(), abs=2)
        assert both.phi[sign].max() > 1.55
    assert both.chi[1][-1] > 3.0 * UNIFORM.race_limit
    assert both.chi[-1][-1] < -1.5 * UNIFORM.race_limit


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: film(UNIFORM, eta_hat=-0.05), "eta_hat = -0.05"),
        (lambda: film(UNIFORM, frames=1), "frames = 1"),
        (lambda: film(UNIFORM, bounces=0), "bounces = 0"),
        (lambda: film(UNIFORM, phidot=0.5, bounces=2), "no common period"),
        (lambda: film(UNIFORM, sigma3_bar=[1.0, 2.0]), "sigma3_bar = [1.0, 2.0]"),
        (lambda: film(UNIFORM, sigma3_bar=math.nan), "sigma3_bar = nan"),
        (lambda: film(UNIFORM, phidot=-1.0), "phidot = -1.0"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)

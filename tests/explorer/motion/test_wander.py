"""Where the disk goes in one period and in many, and the resonances."""

import math

import numpy as np
import pytest
from conftest import BODIES
from wandering import start

import explorer as ex
from explorer.motion.wander import resonance, wander, wander_path

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


@pytest.mark.parametrize(
    ("disk", "eta_hat", "period", "chi", "step"),
    [
        (UNIFORM, 0.01, 3.5309125568, 10.16442885, 1.62355),
        (UNIFORM, -0.01, 3.5069444328, -3.87572184, 2.16059),
        (HOOP, 0.01, 3.5443368831, 8.57037740, 2.14376),
        (HOOP, -0.01, 3.5168724512, -2.31358306, 1.61133),
    ],
)
def test_the_wander_is_that_of_the_figures_of_the_paper(disk, eta_hat, period, chi, step):
    """sigma1 = 0, sigma2 = sigma3 = 1: phidot = 1 at the vertical."""
    found = wander(start(disk, 1.0, eta_hat))
    assert found.period == pytest.approx(period, abs=1e-9)
    assert found.chi == pytest.approx(chi, abs=1e-7)
    assert abs(found.step) == pytest.approx(step, abs=6e-6)


def test_one_period_tells_the_place_after_many(wanders):
    for found in wanders.values():
        places = found.wander.after(found.count)
        after = np.isin(found.t, found.wander.period * np.arange(found.count + 1))
        assert after.sum() == found.count + 1
        np.testing.assert_allclose(found.centre[after] @ [1.0, 1j], places, atol=1e-6)
        # the contact point stays within a radius of the centre's shadow
        assert np.hypot(*(found.contact - found.centre).T).max() <= 1.0 + 1e-9


def test_at_a_resonance_the_wander_has_no_bound_and_elsewhere_it_has(resonant, wanders):
    root, states = resonant
    assert 0.15 < root < 0.3
    found = ex.periods(states, accuracy=1e-9)
    assert found.chi == pytest.approx(4.0 * math.pi, abs=1e-9)
    beside = ex.periods(start(UNIFORM, root + 1e-3, 0.01), accuracy=1e-9)
    assert abs(beside.chi - 4.0 * math.pi) > 1e-4
    walked = wanders["resonance"]
    distance = abs(walked.wander.after(1000))
    np.testing.assert_allclose(distance, np.arange(1001) * abs(walked.wander.step), rtol=1e-6)
    assert np.hypot(*walked.centre[-1]) == pytest.approx(8 * abs(walked.wander.step), rel=1e-6)
    generic = wanders["generic"].wander
    assert abs(generic.after(100_000)).max() == pytest.approx(2.0 * generic.radius, rel=1e-3)


def test_the_wander_scales_with_the_units():
    """The coin in SI units wanders as the uniform disk does, in radii."""
    coin = BODIES["coin"]
    one, other = (wander(start(disk, [0.4, 1.0], 0.02)) for disk in (UNIFORM, coin))
    np.testing.assert_allclose(other.step / coin.r, one.step, rtol=1e-7)
    np.testing.assert_allclose(other.radius / coin.r, one.radius, rtol=1e-7)


def test_paths_keep_the_race_round_at_small_eta():
    path = wander_path(start(UNIFORM, 1.0, 1e-6), 2)
    hops = np.hypot(*np.diff(path.contact, axis=0).T)
    assert hops.max() < 0.2


def test_a_motion_without_a_period_has_no_numbers_and_says_why():
    each = wander(start(UNIFORM, 1.0, [0.0, 0.01]))
    assert each.status.tolist() == [ex.Status.FALLS, ex.Status.OK]
    for column in (each.period, each.chi, each.step, each.radius):
        assert np.isnan(column).tolist() == [True, False]


def test_a_motion_that_rounding_moves_too_far_has_no_numbers_and_says_why():
    """Its angle psi turns by 70,000 rad in a period."""
    each = wander(ex.constants_to_states(ex.Disk(I1=0.25, I3=1e-9), 1.0, 1e-3, 0.7))
    assert each.status == ex.Status.TOO_FEW_DIGITS
    for column in (each.period, each.chi, each.step, each.radius):
        assert np.isnan(column).all()


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: resonance(UNIFORM, 0.01, 1.0, 2, (0.5, 1.0)), "2 is not in between"),
        (lambda: resonance(UNIFORM, 0.01, 1.0, 2, (0.5,)), "two numbers"),
        (lambda: resonance(UNIFORM, 0.01, 1.0, 1.5, (0.1, 1.0)), "turns = 1.5"),
        (lambda: resonance(UNIFORM, 0.0, 1.0, 2, (0.1, 1.0)), "no period at sigma3_bar = 0.1"),
        (lambda: wander_path(start(UNIFORM, [1.0, 1.1], 0.01), 3), "2 were given"),
        (lambda: wander_path(start(UNIFORM, 1.0, 0.01), 0), "count = 0"),
        (lambda: wander_path(start(UNIFORM, 1.0, 0.0), 3), "no period"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)


def test_results_have_the_shape_of_the_states_and_are_tables():
    states = ex.constants_to_states(UNIFORM, 0.7, [[0.05, -0.05], [0.1, 0.0]], 1.0)
    found = ex.wander(states)
    assert found.shape == (2, 2)
    assert found.after(3).shape == (2, 2, 4)
    assert found[0, 1].step == found.step[0, 1]
    table = found.to_pandas()
    np.testing.assert_array_equal(table.shift_x + 1j * table.shift_y, found.step.ravel())
    assert table.status.tolist() == ["ok", "ok", "ok", "falls"]

"""Motions on both sides of a point of F beside their limits."""

import numpy as np
import pytest
from conftest import BODIES
from motions import trajectories

import explorer as ex
from explorer.motion.both_sides import FALLS, MARGIN, QUANTITIES, both_sides, limits_from, sample_times

HOOP = BODIES["hoop"]
START = {"sigma3_bar": 0.6, "phidot": 1.0, "face": 1}
ON_F = ex.constants_to_states(HOOP, eta_hat=0.0, **START)


@pytest.fixture(scope="module")
def both():
    return both_sides(ON_F)


def test_each_motion_stays_with_the_limit_of_its_own_side(both):
    """Away from the impacts; eta ln(1/eta) is 0.05 here, and the other side is 4.6 rad away after one fall."""
    period = both.impacts[1] - both.impacts[0]
    away = abs(both.t[:, None] - both.impacts).min(axis=1) > 0.1 * period
    after = away & (both.t > both.impacts[0])
    for sign in (1, -1):
        np.testing.assert_allclose(both.motions[sign]["chi"][away], both.limits[sign].chi[away], atol=0.3)
        assert (abs(both.motions[sign]["chi"] - both.limits[-sign].chi)[after] > 2.0).all()
        np.testing.assert_allclose(both.motions[sign]["phi"][away], both.limits[sign].phi[away], atol=0.1)


def test_the_race_is_sampled_finely(both):
    for sign in (1, -1):
        assert abs(np.diff(both.motions[sign]["chi"])).max() < 0.2 + 1e-9


def test_the_description_fits_on_a_screen(both):
    """Hundreds of times, two motions and two limits are no text."""
    assert repr(both).startswith(
        f"BothSides of the disk hoop: eta_hat +-{both.eta_hat:g}\n  t: {both.t.size:,} times"
    )
    assert len(repr(both)) < 200


def test_distances_are_taken_away_from_the_impacts():
    limit = limits_from(ON_F)[1]
    times, middle = sample_times(limit)
    impacts = limit.impacts(2.0 * times[-1])
    assert abs(times[:, None] - impacts).min() > MARGIN * limit.period
    assert np.searchsorted(impacts, times[-1]) == FALLS
    assert times[middle] == pytest.approx(0.5 * (impacts[0] + impacts[1]))


def test_the_distance_to_the_limit_shrinks_with_eta():
    limit = limits_from(ON_F)[1]
    times, _ = sample_times(limit)
    motion = trajectories(
        ex.constants_to_states(HOOP, eta_hat=[1e-2, 1e-4], **START),
        t_eval=times,
        observables=QUANTITIES,
        accuracy=1e-8,
    )
    far, near = abs(motion.chi - limit(times).chi).max(axis=1)
    # eta ln(1/eta) falls by 50
    assert 20.0 < far / near < 120.0


@pytest.mark.parametrize("face", [1, -1])
def test_both_sides_start_anywhere_on_f_and_come_nearer_to_their_limits(face):
    """A coin in SI units, on its way up from flat; chi at the end of both motions against the limits."""
    coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    upright = ex.constants_to_states(coin, 20.0, 0.0, 30.0, face)
    there = ex.limit_motion(upright, 1)(0.02)
    bar = ex.constants(upright).sigma3_bar
    start = ex.coordinates_to_states(
        coin, phi=there.phi, phidot=there.phidot, sigma3_bar=bar, eta_hat=0.0, face=face
    )
    apart = []
    for eta_hat in (1e-2, 1e-5, 1e-11):
        both = ex.both_sides(start, eta_hat)
        for side in (1, -1):
            assert abs(np.diff(both.motions[side]["chi"])).max() <= 0.2
        apart.append(max(abs(both.motions[s]["chi"][-1] - both.limits[s].chi[-1]) for s in (1, -1)))
    assert apart[0] > 10.0 * apart[1] > 10.0 * apart[2]
    assert apart[2] < 1e-5
    with pytest.raises(ex.InputError, match="eta_hat"):
        ex.both_sides(start, 0.0)


def test_the_path_of_the_limit_with_its_races_is_that_of_a_motion_beside_it():
    both = ex.both_sides(ON_F, 1e-4)
    for sign in (1, -1):
        whole, near = both.limit_path(sign), both.motions[sign]["contact"][:, :2]
        # Each point of one lies on the other: the races as well.
        apart = np.linalg.norm(near[:, None] - whole[None], axis=2)
        assert apart.min(axis=1).max() < 0.05
        assert apart.min(axis=0).max() < 0.1


def test_a_last_time_of_ones_own_says_how_many_falls_there_are():
    both = both_sides(ON_F, 1e-4, 30.0)
    limit = limits_from(ON_F)[1]
    assert both.t[-1] == 30.0
    np.testing.assert_array_equal(both.impacts, limit.impacts(30.0))
    for side in (1, -1):
        raced = np.interp(both.impacts[:, None] + [-0.1, 0.1], both.t, both.motions[side]["chi"])
        assert (side * np.diff(raced, axis=1) > 0.9 * HOOP.race_limit).all()

"""Motions on both sides of a point of F beside their limits."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.portrait.both_sides import FALLS, MARGIN, both_sides, follow, limits_at, sample_times

HOOP = BODIES["hoop"]
START = (0.6, 1.0, 1)


@pytest.fixture(scope="module")
def both():
    return both_sides(HOOP, START)


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


def test_distances_are_taken_away_from_the_impacts():
    limit = limits_at(HOOP, START)[1]
    times, middle = sample_times(limit)
    impacts = limit.impacts(2.0 * times[-1])
    assert abs(times[:, None] - impacts).min() > MARGIN * limit.period
    assert np.searchsorted(impacts, times[-1]) == FALLS
    assert times[middle] == pytest.approx(0.5 * (impacts[0] + impacts[1]))


def test_the_distance_to_the_limit_shrinks_with_eta():
    limit = limits_at(HOOP, START)[1]
    times, _ = sample_times(limit)
    motion = follow(HOOP, START, np.array([1e-2, 1e-4]), times, 1e-8, "auto")
    far, near = abs(motion.chi - limit(times).chi).max(axis=1)
    # eta ln(1/eta) falls by 50
    assert 20.0 < far / near < 120.0

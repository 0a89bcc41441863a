"""The stage of the film: what moves stands where the data say, and the rest stands still."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.pictures import stage
from explorer.pictures.film_motions import film

COIN = BODIES["coin"]


@pytest.fixture(scope="module")
def shown():
    unit = COIN.rate_unit
    return film(COIN, 0.05 * unit, unit, unit, frames=30)


@pytest.fixture(scope="module")
def made(shown):
    return stage.Stage(shown, dpi=20)


def test_the_same_row_is_the_same_picture_whatever_was_shown_between(shown, made):
    first = np.asarray(made.image(0))
    assert (np.asarray(made.image(int(shown.frames[15]))) != first).any()
    np.testing.assert_array_equal(np.asarray(made.image(0)), first)


def test_all_of_both_disks_is_inside_the_picture(shown):
    low, high = stage.limits_of(shown)
    for sign in (1, -1):
        for row in shown.frames:
            seen = stage.camera_of(shown).see(shown.pose(sign, row).rim(np.linspace(0.0, 6.3, 40)))
            assert (seen > low).all()
            assert (seen < high).all()

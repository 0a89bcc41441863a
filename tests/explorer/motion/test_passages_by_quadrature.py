"""Passages as integrals, against arithmetic in 30 and 40 digits and at the extremes."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion.fall_integrals import fall_from_vertical
from explorer.phase.energy import energy_at
from explorer.phase.linear_constants import line_slope


def test_a_fall_is_the_limit_of_passages_and_takes_half_their_time():
    disk = BODIES["thick"]
    found = ex.passages(disk, 0.6, [1e-250, 0.0], 0.8, accuracy=1e-11)
    assert found.fall_time[1] == pytest.approx(0.5 * found.duration[0], rel=1e-10)
    assert found.energy[1] == pytest.approx(found.energy[0], rel=1e-14)
    energy = energy_at(disk.body, 0.8, 0.6, 0.6 * line_slope(disk), 1.0) * np.ones(1)
    fall = fall_from_vertical(disk, np.array([0.6]), energy, accuracy=1e-11)
    assert fall.time[0] == found.fall_time[1]
    assert 2.0 * fall.chi[0] == found.fall_angle[1]


def test_a_speed_that_changes_no_digit_starts_as_from_rest():
    """Also where its square underflows; but a motion that would stay at the vertical is not taken from there."""
    speeds = [0.0, 1e-300, 1e-200, 1e-160, 1e-130, 1e-100]
    for sigma3_bar in (1.0, -2.0):
        got = ex.passages(BODIES["uniform"], sigma3_bar, -1e-3, speeds)
        assert got.ok.all()
        assert got.phidot.tolist() == speeds
        assert (abs(got.race_angle - got.race_angle[0]) <= got.error_estimate).all()
    assert not ex.passages(BODIES["uniform"], 0.0, 1e-10, [0.0, 1e-200]).ok.any()


@pytest.mark.parametrize("phidot", [1e-3, 1e-6, 1e-9])
def test_a_fall_knows_how_slowly_it_leaves_the_vertical(phidot):
    """The race of a start next to an equilibrium: the energy of its fall is no difference of large ones."""
    disk = BODIES["uniform"]
    got = ex.passages(disk, 0.01, [1e-7, -1e-7], phidot, accuracy=1e-10)
    assert (got.status == ex.Status.OK).all()
    assert (got.error_estimate < 1e-10).all()
    # Twice kappa pi, but for the falls: that of one side has more energy at the vertical, the other none.
    assert got.race_angle[0] - got.race_angle[1] == pytest.approx(2.0 * disk.race_limit, abs=1e-2)

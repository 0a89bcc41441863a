"""Rotation numbers over the constants of motion."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.rotation import rotation_map

UNIFORM = BODIES["uniform"]


@pytest.fixture(scope="module")
def found():
    return rotation_map(UNIFORM, 2.0, points=24)


def test_each_motion_of_the_map_has_its_energy_and_its_turns(found):
    for row, column in ((12, 12), (5, 15), (20, 8)):
        bar, spin = found.sigma3_bar[column], found.sigma4_bar[row]
        left = 2.0 * (2.0 - 1.0) - UNIFORM.I1 * bar**2 - (UNIFORM.I3 + 1.0) * spin**2
        period = ex.periods(ex.phi_to_states(UNIFORM, 0.0, np.sqrt(left / (UNIFORM.I1 + 1.0)), bar, spin))
        assert period.energy.item() == pytest.approx(2.0)
        assert period.chi.item() / (2.0 * np.pi) == pytest.approx(found.turns[row, column], abs=1e-4)


def test_what_the_energy_does_not_allow_is_left_out(found):
    """An ellipse in its box: pi/4 of it."""
    assert np.isfinite(found.turns).mean() == pytest.approx(np.pi / 4.0, abs=0.03)


def test_turning_the_other_way_turns_the_other_way(found):
    np.testing.assert_allclose(found.turns, -found.turns[::-1, ::-1], atol=1e-3)


def test_too_little_energy_is_refused():
    with pytest.raises(ex.InputError, match="give more"):
        rotation_map(UNIFORM, 0.9)

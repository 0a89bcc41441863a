"""Energies of steady motions along a path through the constants, and potentials in each region."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.bifurcation_portraits import bifurcation_portraits
from explorer.portrait.steady import path_values

HOOP = BODIES["hoop"]


def test_on_the_falling_line_both_steady_motions_vanish_at_the_threshold():
    edge = max(path_values(HOOP, "line")[1])
    found = bifurcation_portraits(HOOP, "line", [(0.999 * edge, 1.2), (1.001 * edge, 1.2)])
    assert found.threshold == edge
    assert [len(potential.equilibria) for potential in found.potentials] == [2, 0]


@pytest.mark.parametrize(("path", "counts"), [("line", [1, 2, 1, 1]), ("rolling", [2, 1, 1])])
def test_there_is_one_place_in_each_region(path, counts):
    found = bifurcation_portraits(HOOP, path)
    pieces = [
        potential.components(energy) for (_, energy), potential in zip(found.places, found.potentials, strict=True)
    ]
    assert [len(each) for each in pieces] == counts
    for (parameter, energy), potential in zip(found.places, found.potentials, strict=True):
        assert energy > np.interp(parameter, found.parameter, found.floor)
        assert np.interp(parameter, found.parameter, found.floor) == pytest.approx(potential.bottom, abs=2e-3)


@pytest.mark.parametrize(
    ("path", "places", "words"),
    [("diagonal", None, "diagonal"), ("line", [], "at least one"), ("line", [(0.2, -1.0)], "no motion of energy")],
)
def test_bad_input_is_named(path, places, words):
    with pytest.raises(ex.InputError, match=words):
        bifurcation_portraits(HOOP, path, places)


def test_the_floor_has_no_gap_at_the_threshold_where_the_one_steady_motion_is_of_no_branch():
    thick = ex.Disk(I1=0.5, I3=0.3, name="thick")
    found = bifurcation_portraits(thick, "rolling")
    row = int(np.flatnonzero(found.parameter == found.threshold)[0])
    np.testing.assert_allclose(found.floor[row], 0.5 * (found.floor[row - 1] + found.floor[row + 1]), rtol=1e-3)
    assert np.isfinite(found.floor).all()

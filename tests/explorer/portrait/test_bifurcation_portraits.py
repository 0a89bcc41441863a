"""Potentials along a path through the constants."""

import pytest
from conftest import BODIES

import explorer as ex
from explorer.portrait.bifurcation_portraits import bifurcation_portraits


def test_on_the_falling_line_both_steady_motions_vanish_at_the_threshold():
    found = bifurcation_portraits(BODIES["hoop"], "line", (0.999, 1.001))
    assert [len(potential.equilibria) for potential in found.potentials] == [2, 0]


def test_an_unknown_path_is_named():
    with pytest.raises(ex.InputError, match="diagonal"):
        bifurcation_portraits(BODIES["hoop"], "diagonal")

"""The potential at constants that users give: from both sides the same, and refused where there is none."""

import numpy as np
import pytest

import explorer as ex
from explorer.portrait.potentials import at_constants, level_energies, on_line, well_separatrix

DISK = ex.Disk.hoop()


@pytest.mark.parametrize("face", [1, -1])
def test_both_ways_to_name_the_constants_give_one_potential(face):
    near = on_line(DISK, 0.4, 0.03, face)
    same = at_constants(DISK, near.sigma3_bar, near.sigma4_bar)
    phi = np.linspace(-1.2, 1.2, 7)
    np.testing.assert_allclose(same.V(phi), near.V(phi), rtol=1e-13)


def test_constants_on_a_line_to_rounding_are_on_it():
    line = on_line(DISK, 0.3)
    assert at_constants(DISK, line.sigma3_bar, line.sigma4_bar * (1.0 + 2e-16)).eta == 0.0


def test_levels_lie_between_the_bottom_and_above_the_saddles():
    potential = on_line(DISK, 0.25, 0.01)
    levels = level_energies(potential)
    assert levels.min() > potential.bottom
    assert levels.max() > well_separatrix(DISK, 0.25).saddle.energy


@pytest.mark.parametrize("size", [1e7, 1e9, 1e60, 1e99])
def test_levels_of_the_fastest_motions_are_apart_in_doubles(size):
    for potential in (on_line(DISK, 0.25, size), at_constants(DISK, 0.25, size), on_line(DISK, size)):
        levels = level_energies(potential)
        assert (np.diff(levels, prepend=potential.bottom) > 0.0).all()
        assert all(potential.components(float(energy)) for energy in levels)


@pytest.mark.parametrize(("name", "value"), [("sigma3_bar", 1e101), ("sigma3_bar", np.nan), ("eta_hat", "x")])
def test_constants_that_are_none_are_refused_by_name(name, value):
    with pytest.raises(ex.InputError, match=f"{name} = "):
        on_line(DISK, **{"sigma3_bar": 0.1, name: value})

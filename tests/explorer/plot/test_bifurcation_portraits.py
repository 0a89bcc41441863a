"""The bifurcation diagram with its portraits."""

import numpy as np
import pytest
from conftest import BODIES

from explorer import plot
from explorer.portrait.bifurcation_portraits import bifurcation_portraits

HOOP = BODIES["hoop"]


@pytest.fixture(scope="module")
def line():
    return bifurcation_portraits(HOOP, "line")


def test_each_place_has_its_letter_in_the_plane_and_over_its_portrait(line):
    figure = plot.bifurcation_portraits(line)
    plane, *portraits = figure.axes
    titles = [ax.get_title() for ax in portraits]
    assert titles == ["A: all fall", "B: some fall", "C: all fall", "D: all fall"]
    letters = {text.get_text(): text.get_position() for text in plane.texts if len(text.get_text()) == 1}
    assert letters == dict(zip("ABCD", line.places, strict=True))
    low, high = plane.get_xlim()
    assert all(low < parameter < high for parameter, _ in line.places)
    assert plot.caption_of(figure).text.count("Above,") == 1


def test_the_thick_level_of_a_portrait_has_the_energy_of_its_place(line):
    figure = plot.bifurcation_portraits(line)
    for (_, energy), potential, ax in zip(line.places, line.potentials, figure.axes[1:], strict=True):
        thick = [each for each in ax.lines if each.get_lw() == 2.4 and len(each.get_xdata()) > 2]
        assert len(thick) == 2 * len(potential.components(energy))
        for each in thick:
            phi, phidot = (values[1:-1] for values in each.get_data())
            total = 0.5 * HOOP.body.M * phidot**2 + potential.V(phi)
            np.testing.assert_allclose(total, energy, rtol=1e-9)


def test_curves_of_the_plane_are_energies_of_steady_motions_and_v_0(line):
    plane = plot.bifurcation_portraits(line).axes[0]
    drawn = {each.get_label(): each for each in plane.lines}
    x, y = drawn["$V_0$: flat can be reached"].get_data()
    np.testing.assert_allclose(y, 0.13923263 * x**2, rtol=1e-7)
    # Spinning upright at the vertical: V = I1 sigma3^2/2 + m g r
    upright = plot.bifurcation_portraits(bifurcation_portraits(HOOP, "spinning")).axes[0]
    x, y = {each.get_label(): each for each in upright.lines}["unstable one, and its separatrix"].get_data()
    np.testing.assert_allclose(y, 0.5 * HOOP.I1 * x**2 + 1.0, rtol=1e-12)

"""Pictures of rosettes and resonances."""

import numpy as np
import pytest
from conftest import BODIES
from wandering import start

import explorer as ex
from explorer import plot
from explorer.portrait.wander import wander

UNIFORM = BODIES["uniform"]


def test_the_pictures_of_paths_show_places_and_circle(wanders):
    figure = plot.rosette_and_resonance(wanders["generic"], wanders["resonance"])
    rosette, walk = figure.axes
    wander = wanders["generic"].wander
    x, y = rosette.lines[3].get_data()
    place = wander.after(30)[0]
    middle = wander.step[0] / (1.0 - np.exp(1j * wander.chi[0]))
    np.testing.assert_allclose(np.hypot(x - middle.real, y - middle.imag), wander.radius[0])
    np.testing.assert_allclose(abs(place - middle), wander.radius[0])
    assert len(walk.lines) == 3
    assert "it walks" in walk.get_title()
    assert "it stays" in rosette.get_title()


def test_the_picture_of_distances_bounds_the_generic_motion_only(wanders):
    ax = plot.wander_distance(wanders)
    bound = [line for line in ax.lines if line.get_ls() == ":" and len(line.get_xdata()) == 2]
    assert [line.get_ydata()[0] for line in bound] == pytest.approx([2.0 * wanders["generic"].wander.radius[0]])


def test_the_radius_peaks_at_the_resonance(resonant):
    bars = np.linspace(0.15, 0.3, 31)
    ax = plot.wander_radius(UNIFORM, bars, wander(start(UNIFORM, bars, 0.01)), {2: resonant[0]})
    x, y = ax.lines[0].get_data()
    assert abs(x[np.argmax(y)] - resonant[0]) < 0.005
    # The curve leaves the picture there, rather than end at a height of the grid.
    assert y.max() > 5.0 * ax.get_ylim()[1]
    assert ax.lines[1].get_xdata()[0] == resonant[0]
    turns = ax.child_axes[0].lines[0]
    assert np.interp(resonant[0], *turns.get_data()) == pytest.approx(2.0, abs=1e-3)


def test_the_radius_is_drawn_of_the_motions_that_are_known():
    disk, bars = ex.Disk.uniform(), [0.6, 0.65, 0.7]
    found = ex.portrait.wander(ex.constants_to_states(disk, bars, [0.05, 0.0, 0.05], 1.0))
    assert np.isnan(found.radius).tolist() == [False, True, False]
    assert np.isfinite(plot.wander_radius(disk, bars, found).lines[0].get_ydata()).all()
    for wrong, says in (([0.6], "has 1 entries, wander 3"), ([0.7, 0.65, 0.6], "does not increase")):
        with pytest.raises(ex.InputError, match=says):
            plot.wander_radius(disk, wrong, found)
    with pytest.raises(ex.InputError, match="of no motion the period is known"):
        plot.wander_radius(disk, [np.nan] * 3, found)

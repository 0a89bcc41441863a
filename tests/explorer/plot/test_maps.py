"""Maps of the falling set: what they claim to show, and the exact lines over them."""

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer import plot
from explorer.portrait.slices import Slice, slice_map
from explorer.scenes.falling_set import FallingSet

UNIFORM = BODIES["uniform"]


def plane_by(method):
    """The map of all samples of a small run."""
    scene = FallingSet(samples=200, method=method, accuracy=1e-3)
    return scene.plane(computed(scene).plane)


def cut_by(method):
    return slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=9, method=method)


@pytest.mark.parametrize(
    ("draw", "data_by"),
    [(plot.constants_plane, plane_by), (plot.slice_map, cut_by)],
    ids=["constants_plane", "slice_map"],
)
@pytest.mark.parametrize(
    ("method", "says"),
    [("auto", "by quadrature"), ("quadrature", "by quadrature"), ("dop853", "integrated with dop853")],
)
def test_the_colour_bar_says_how_the_tilt_was_computed(draw, data_by, method, says):
    label = draw(data_by(method)).figure.axes[1].get_ylabel()
    assert label.endswith(f"(rad), {says}")
    assert ("integrated" in label) == (method == "dop853")


def test_the_exact_lines_are_drawn_over_the_map_of_samples():
    ax = plot.constants_plane(plane_by("auto"))
    slopes = [np.diff(line.get_ydata())[0] / np.diff(line.get_xdata())[0] for line in ax.lines]
    assert slopes == pytest.approx(2 * [0.7285923160189477] + 2 * [-0.7285923160189477])
    # The middle of each ridge is left to the samples.
    assert min(abs(line.get_xdata()).min() for line in ax.lines) > 0.5 * ax.get_xlim()[1]


@pytest.mark.parametrize("phidot", [0.0, 1e-3, 0.05])
def test_the_falling_set_lies_on_its_valleys_of_states_that_hardly_move_too(phidot):
    """There could_fall is true on one side of F alone, and no line was drawn."""
    cut = slice_map(UNIFORM, f"phi=0.3,phidot={phidot},sigma3=-2:2,sigma4=-2:2", points=101)
    ax = plot.slice_map(cut)
    told = [text.get_text() for text in ax.get_legend().get_texts()] if ax.get_legend() else []
    told += [text.get_text() for legend in ax.figure.legends for text in legend.get_texts()]
    assert {"$F$, face +", "$F$, face −"} <= set(told)
    lengths = [sum(len(path.vertices) for path in drawn.get_paths()) for drawn in ax.collections[1:]]
    assert max(lengths) > 100


def test_tilts_flatter_than_the_colours_tell_are_marked_on_the_bar():
    mesh = plot.slice_map(cut_by("auto")).collections[0]
    assert mesh.norm.vmin == -3.0
    assert mesh.colorbar.extend == "min"


def test_shares_of_samples_have_the_interval_of_their_counts():
    ax = plot.theta_min_distribution(np.geomspace(1e-3, 1.0, 10), 1000)
    band = ax.collections[0].get_paths()[0].vertices
    first = band[np.isclose(band[:, 0], band[:, 0].min(), rtol=0.01)]
    # Garwood: between 0.0253 and 5.57 for one count
    assert first[:, 1].min() == pytest.approx(0.0253e-3, rel=0.01)
    assert first[:, 1].max() == pytest.approx(5.572e-3, rel=0.01)


def test_the_unit_of_the_axes_is_that_of_the_numbers():
    coin = BODIES["coin"]
    natural, given = (
        plot.slice_map(slice_map(d, Slice.defaults(d)[0], points=9)).get_xlabel() for d in (UNIFORM, coin)
    )
    assert natural == r"$\sigma_3$ ($\sqrt{g/r}$)"
    assert given == rf"$\sigma_3$ (units of the disk; $\sqrt{{g/r}}$ = {coin.rate_unit:.4g})"


def test_a_picture_of_no_sample_says_so_and_one_sample_is_a_point():
    none = ex.portrait.flattest_per_cell(ex.phi_to_states(UNIFORM, 2.0, 1.0, 1.0, 0.7), cells=4)
    assert "no sample was computed" in [text.get_text() for text in plot.constants_plane(none).texts]
    for theta, told in (([], "no sample was computed"), ([0.0, 0.0], "all samples fall flat")):
        assert plot.theta_min_distribution(theta).texts[0].get_text() == told
    assert plot.theta_min_distribution([0.1]).lines[0].get_marker() == "o"
    for theta, samples, says in (([0.1, 0.2], 1, "samples = 1: theta has 2"), ([-0.1], None, "theta has -0.1")):
        with pytest.raises(ex.InputError, match=says):
            plot.theta_min_distribution(theta, samples)

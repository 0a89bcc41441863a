"""Maps of the falling set: what they claim to show, and the exact lines over them."""

import numpy as np
import pytest
from conftest import BODIES, computed

from explorer import plot
from explorer.portrait.slices import Slice, slice_map
from explorer.scenes.registry import build_scene

UNIFORM = BODIES["uniform"]


def plane_by(method):
    """The map of all samples of a small run."""
    scene = build_scene("falling-set", samples=200, method=method, accuracy=1e-3)
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
    assert slopes == pytest.approx([0.7285923160189477, -0.7285923160189477])


def test_the_unit_of_the_axes_is_that_of_the_numbers():
    coin = BODIES["coin"]
    natural, given = (
        plot.slice_map(slice_map(d, Slice.defaults(d)[0], points=9)).get_xlabel() for d in (UNIFORM, coin)
    )
    assert natural == r"$\sigma_3$ ($\sqrt{g/r}$)"
    assert given == rf"$\sigma_3$ (units of the disk; $\sqrt{{g/r}}$ = {coin.rate_unit:.4g})"

"""Slices coloured by side."""

import numpy as np
import pytest
from conftest import BODIES
from matplotlib.figure import Figure

from explorer import plot
from explorer.plot.slices import signed_tilt
from explorer.portrait.slices import Slice, slice_map

UNIFORM = BODIES["uniform"]


@pytest.fixture(scope="module")
def slice_of_uniform():
    return slice_map(UNIFORM, Slice.defaults(UNIFORM)[0], points=61)


def test_colours_tell_side_and_tilt_everywhere_and_hatches_hide_neither(slice_of_uniform):
    ax = Figure().subplots()
    assert plot.race_slice_map(slice_of_uniform, ax) is ax
    drawn = ax.collections[0].get_array()
    values = signed_tilt(slice_of_uniform)
    np.testing.assert_array_equal(np.ravel(np.ma.filled(drawn, np.nan)), np.ravel(values))
    np.testing.assert_array_equal(np.isnan(values), np.isnan(slice_of_uniform["theta_min"]))
    could = slice_of_uniform.side != 0
    assert could.any()
    assert not could.all()
    np.testing.assert_array_equal(np.sign(values[could]), slice_of_uniform.side[could])
    known = np.isfinite(values) & could
    flat = np.argsort(slice_of_uniform["theta_min"][known])
    assert (np.diff(abs(values[known])[flat]) >= 0.0).all()
    (hatched,) = [each for each in ax.collections if any(getattr(each, "hatches", None) or [])]
    assert hatched.get_facecolor().size == 0 or hatched.get_facecolor()[..., 3].max() == 0.0


def test_sides_are_named_where_they_are_so_that_grey_tells_them_too(slice_of_uniform):
    ax = plot.race_slice_map(slice_of_uniform)
    cut, values = slice_of_uniform, signed_tilt(slice_of_uniform)
    names = {"$\\eta > 0$": 1.0, "$\\eta < 0$": -1.0}
    found = [(text.get_position(), names[text.get_text()]) for text in ax.texts if text.get_text() in names]
    assert {side for _, side in found} == {1.0, -1.0}
    for (x, y), side in found:
        assert np.sign(values[np.argmin(abs(cut.y - y)), np.argmin(abs(cut.x - x))]) == side

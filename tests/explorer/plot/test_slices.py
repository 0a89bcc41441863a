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


def test_colours_are_strongest_at_f_and_missing_where_nothing_falls(slice_of_uniform):
    ax = Figure().subplots()
    assert plot.race_slice_map(slice_of_uniform, ax) is ax
    drawn = np.ma.getmaskarray(ax.collections[0].get_array())
    np.testing.assert_array_equal(drawn[slice_of_uniform.side == 0], True)
    values = signed_tilt(slice_of_uniform)
    shown = np.isfinite(values)
    np.testing.assert_array_equal(np.sign(values[shown]), slice_of_uniform.side[shown])
    flat = np.argsort(slice_of_uniform["theta_min"][shown])
    assert (np.diff(abs(values[shown])[flat]) >= 0.0).all()

"""What all pictures share."""

import pytest
from matplotlib.figure import Figure

from explorer import plot
from explorer.plot.style import axes_or_new, dress


def test_stacked_pictures_share_the_lowest_name_of_the_axis():
    figure = plot.stacked(*(lambda ax, i=i: dress(ax, "x", f"y{i}") for i in range(3)), height=9.0)
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "", "x"]
    assert figure.get_size_inches()[1] == pytest.approx(9.0)


def test_figure_of_gives_the_figure_of_a_picture():
    assert isinstance(plot.figure_of(lambda text: dress(axes_or_new(None), text, "y"), "x"), Figure)
    ax = axes_or_new(None)
    assert plot.figure_of(ax) is plot.figure_of(ax.figure) is ax.figure

"""Sizes, units and labels that all pictures share."""

import pytest
from conftest import BODIES
from matplotlib.figure import Figure

from explorer import plot
from explorer.plot.style import axes_or_new, coordinate_label, dress, rates_of, times_of, values_label

UNIFORM, COIN = BODIES["uniform"], BODIES["coin"]


def test_axes_that_are_given_are_used_and_others_are_new():
    ax = Figure().subplots()
    assert axes_or_new(ax) is ax
    assert axes_or_new(None).figure is not axes_or_new(None).figure


def test_rates_and_times_are_natural_where_the_disk_is_and_say_their_unit_elsewhere():
    assert (rates_of(UNIFORM), times_of(UNIFORM)) == (r"$\sqrt{g/r}$", r"$\sqrt{r/g}$")
    assert rates_of(COIN) == rf"units of the disk; $\sqrt{{g/r}}$ = {COIN.rate_unit:.4g}"
    assert times_of(COIN).endswith(f"{COIN.time_unit:.4g}")


def test_coordinates_have_a_symbol_and_a_unit():
    assert coordinate_label("phi", COIN) == r"$\varphi$ (rad)"
    assert coordinate_label("sigma4", UNIFORM) == r"$\sigma_4$ ($\sqrt{g/r}$)"
    assert values_label({"phi": 0.0, "phidot": 0.05}) == r"$\varphi$ = 0, $\dot\varphi$ = 0.05"


def test_a_dressed_picture_has_both_names_and_no_upper_frame():
    ax = dress(axes_or_new(None), "x (m)", "y (s)", "title")
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_title()) == ("x (m)", "y (s)", "title")
    assert not ax.spines["top"].get_visible()


def test_stacked_pictures_share_the_lowest_name_of_the_axis():
    figure = plot.stacked(*(lambda ax, i=i: dress(ax, "x", f"y{i}") for i in range(3)), height=9.0)
    assert [ax.get_xlabel() for ax in figure.axes] == ["", "", "x"]
    assert figure.get_size_inches()[1] == pytest.approx(9.0)


def test_figure_of_gives_the_figure_of_a_picture():
    assert isinstance(plot.figure_of(lambda text: dress(axes_or_new(None), text, "y"), "x"), Figure)
    ax = axes_or_new(None)
    assert plot.figure_of(ax) is plot.figure_of(ax.figure) is ax.figure

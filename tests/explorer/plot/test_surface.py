"""Pictures of F: as a surface and under a magnifying glass."""

from conftest import BODIES

from explorer import plot
from explorer.portrait.falling_surface import falling_surface, zoom

HOOP = BODIES["hoop"]


def test_both_sheets_are_drawn_and_named():
    (ax,) = plot.falling_surface(falling_surface(HOOP, points=5)).axes
    assert len(ax.collections[0].get_facecolor()) == 2 * 16
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["falls on face +1", "falls on face −1"]


def test_the_squares_say_how_much_they_magnify_and_that_none_falls():
    figure = plot.zoom_on_f(zoom(HOOP, [0.3, 3e-13], points=4))
    assert [ax.get_title() for ax in figure.axes] == ["as it is", "magnified $10^{12}$"]
    assert "of 32 motions none falls" in figure.get_suptitle()

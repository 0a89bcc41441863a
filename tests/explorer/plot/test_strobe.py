"""The hero: both sides fall alike, race in opposite ways, and rise elsewhere."""

import math

import numpy as np
import pytest
from conftest import BODIES
from matplotlib.figure import Figure

from explorer import plot
from explorer.errors import InputError
from explorer.plot.strobe import _band, _rows
from explorer.portrait.film import film

HOOP = BODIES["hoop"]


@pytest.fixture(scope="module")
def shown():
    return film(HOOP, 0.002 * HOOP.rate_unit, HOOP.rate_unit, HOOP.rate_unit, frames=100)


def test_the_arrow_of_the_race_has_the_turns_and_the_way_of_the_race(shown):
    for sign in (1, -1):
        rows = _rows(shown, sign)
        inner = _band(shown, sign, rows)[:160] - shown.centre[sign][rows.flat] * [1.0, 1.0, 0.0]
        angles = np.unwrap(np.arctan2(inner[:, 1], inner[:, 0]))
        assert angles[-1] - angles[0] == pytest.approx(sign * HOOP.race_limit, abs=0.25)
        assert shown.chi[sign][rows.leaves] - shown.chi[sign][rows.lies] == pytest.approx(
            sign * HOOP.race_limit, abs=0.5
        )


def test_ghosts_fall_and_rise_in_their_order(shown):
    for sign in (1, -1):
        rows = _rows(shown, sign)
        down, up = shown.phi[sign][rows.fall], shown.phi[sign][rows.rise]
        assert (np.diff(down) > 0.0).all()
        assert (np.diff(up) < 0.0).all()
        assert max(rows.fall) < rows.lies < rows.flat < rows.leaves < min(rows.rise)


def test_the_hero_says_how_many_turns_and_draws_both_sides(shown):
    figure = plot.hero(shown)
    assert isinstance(figure, Figure)
    words = " ".join(text.get_text() for ax in figure.axes for text in ax.texts)
    assert words.count(f"{HOOP.race_limit / (2.0 * math.pi):.2f} turns") == 2
    figure.canvas.draw()


def test_a_film_that_stays_far_from_flat_is_refused_with_the_remedy():
    with pytest.raises(InputError, match="smaller eta_hat"):
        plot.hero(film(HOOP, 0.3, frames=20))

"""The hero: both sides fall alike, race in opposite ways, and rise elsewhere."""

import math

import pytest
from conftest import BODIES

from explorer.errors import InputError
from explorer.pictures.hero import hero

HOOP = BODIES["hoop"]


def test_the_hero_says_how_many_turns_and_draws_both_sides():
    figure = hero(HOOP, 0.002 * HOOP.rate_unit)
    words = " ".join(text.get_text() for ax in figure.axes for text in ax.texts)
    assert words.count(f"{HOOP.race_limit / (2.0 * math.pi):.2f} turns") == 2
    figure.canvas.draw()


def test_a_film_that_stays_far_from_flat_is_refused_with_the_remedy():
    with pytest.raises(InputError, match="smaller eta_hat"):
        hero(HOOP, 0.3)

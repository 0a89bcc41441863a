"""The stage of the film: what moves stands where the data say, and the rest stands still."""

import numpy as np
import pytest
from conftest import BODIES

from explorer.plot import stage
from explorer.portrait.film import film

COIN = BODIES["coin"]


@pytest.fixture(scope="module")
def shown():
    unit = COIN.rate_unit
    return film(COIN, 0.05 * unit, unit, unit, frames=30)


@pytest.fixture(scope="module")
def made(shown):
    return stage.Stage(shown, dpi=20)


def test_a_row_shows_both_trails_up_to_it_and_leaves_nothing_behind(shown, made, monkeypatch):
    row, drawn = int(shown.frames[20]), []
    kept = made.tables[0].ax.draw_artist
    monkeypatch.setattr(made.tables[0].ax, "draw_artist", lambda artist: (drawn.append(artist), kept(artist)))
    count = len(made.tables[0].ax.get_children())
    made.image(row)
    assert len(made.tables[0].ax.get_children()) == count
    trail = next(artist for artist in drawn if hasattr(artist, "get_xdata") and len(artist.get_xdata()) == row + 1)
    contact = stage.camera_of(shown).see(shown.contact[1][row])
    np.testing.assert_allclose([trail.get_xdata()[-1], trail.get_ydata()[-1]], contact)


def test_the_same_row_is_the_same_picture_whatever_was_shown_between(shown, made):
    first = np.asarray(made.image(0))
    assert (np.asarray(made.image(int(shown.frames[15]))) != first).any()
    np.testing.assert_array_equal(np.asarray(made.image(0)), first)


def test_the_words_say_how_slow_and_how_far(shown, made, monkeypatch):
    said = []
    monkeypatch.setattr(
        made.clock, "text", lambda x, y, words, **_: (said.append(words), made.figure.text(0, 0, ""))[1]
    )
    row = int(np.argmax(shown.phi[1]))
    made._tell(row)
    assert f"slowed {shown.slowed[row]:.0f} times" in said
    turns = (shown.chi[-1][row] - shown.chi[-1][0]) / (2.0 * np.pi)
    assert f"the other side: {turns:+.2f} turns".replace("-", "−") in said


def test_all_of_both_disks_is_inside_the_picture(shown):
    low, high = stage.limits_of(shown)
    for sign in (1, -1):
        for row in shown.frames:
            seen = stage.camera_of(shown).see(shown.pose(sign, row).rim(np.linspace(0.0, 6.3, 40)))
            assert (seen > low).all()
            assert (seen < high).all()

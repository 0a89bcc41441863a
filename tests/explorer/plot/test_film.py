"""The film as a GIF and its artists."""

from itertools import pairwise

import matplotlib
import numpy as np
import pytest
from conftest import BODIES
from PIL import Image

import explorer as ex
from explorer import plot
from explorer.plot.film import Stage, seen
from explorer.portrait.film import film

UNIFORM, HOOP = BODIES["uniform"], BODIES["hoop"]


@pytest.fixture(scope="module")
def shown():
    return film(UNIFORM, frames=60)


def test_the_film_is_a_small_gif_whose_panels_differ(tmp_path):
    before = dict(matplotlib.rcParams)
    target = tmp_path / "fall.gif"
    plot.animate(target, HOOP)
    assert dict(matplotlib.rcParams) == before
    assert target.stat().st_size < 3_000_000
    with Image.open(target) as gif:
        assert gif.n_frames == 100
        assert gif.info["loop"] == 0
        durations, frames = [], []
        for number in range(gif.n_frames):
            gif.seek(number)
            durations.append(gif.info["duration"])
            frames.append(np.asarray(gif.convert("RGB"), dtype=int))
    assert durations == [60] * 99 + [1500]
    height, width = frames[0].shape[:2]
    inside = slice(int(0.2 * height), int(0.85 * height))
    last_left, last_right = frames[-1][inside, : width // 2], frames[-1][inside, width // 2 :]
    assert (abs(last_left - last_right).sum(axis=2) > 60).mean() > 0.05
    for one, next_one in pairwise(frames):
        assert (abs(one - next_one).sum(axis=2) > 60).any()


def test_the_artists_of_the_film_follow_the_rows(shown):
    stage = Stage(shown)
    row = int(shown.frames[30])
    stage.show(row)
    for panel, sign in zip(stage.panels, (1, -1), strict=True):
        contact = seen(shown.contact[sign][row])
        np.testing.assert_allclose(np.ravel(panel.contact.get_data()), contact)
        assert len(panel.past.get_xdata()) == row + 1
        rim = np.array(panel.rim.get_data()).T
        assert np.linalg.norm(rim - contact, axis=1).min() < 1e-12
    assert f"{shown.slowed[row]:.1f} times" in stage.clock.get_text()


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: plot.animate("fall.png", UNIFORM), ".gif"),
        (lambda: plot.animate("no/such/folder/fall.gif", UNIFORM), "make it first"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)

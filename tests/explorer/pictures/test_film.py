"""The film as a GIF for pages and as a WebP for talks."""

import matplotlib
import numpy as np
import pytest
from conftest import BODIES
from PIL import Image

import explorer as ex
from explorer.commands.gallery import caption_in
from explorer.pictures.film import CAPTION, animate

HOOP = BODIES["hoop"]
FRAMES = 10


@pytest.mark.parametrize(
    ("kind", "size", "count"), [("gif", (640, 360), FRAMES // 2), ("webp", (1280, 720), FRAMES)]
)
def test_the_film_loops_in_the_size_of_its_kind_and_carries_its_caption(kind, size, count, tmp_path):
    before = dict(matplotlib.rcParams)
    target = tmp_path / f"fall.{kind}"
    shown = animate(target, HOOP, frames=FRAMES, bounces=1, eta_hat=0.05)
    assert dict(matplotlib.rcParams) == before
    assert (shown.eta_hat, shown.flat.size) == (0.05, 1)
    if kind == "gif":
        assert caption_in(target) == CAPTION
    with Image.open(target) as film_there:
        assert film_there.size == size
        assert film_there.n_frames == count
        assert film_there.info["loop"] == 0
        film_there.seek(count // 2)
        pixels = np.asarray(film_there.convert("RGB"), dtype=int)
    half = size[0] // 2
    assert (abs(pixels[:, :half] - pixels[:, half:]).sum(axis=2) > 60).mean() > 0.02


@pytest.mark.parametrize(
    ("call", "says"),
    [
        (lambda: animate("fall.png", HOOP), ".webp or .gif"),
        (lambda: animate("no/such/folder/fall.gif", HOOP), "make it first"),
    ],
)
def test_bad_input_gets_a_sentence(call, says):
    with pytest.raises(ex.InputError) as caught:
        call()
    assert says in str(caught.value)

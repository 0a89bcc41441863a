"""Captions: every picture has one, and carries it."""

import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image, ImageChops, ImageDraw
from PIL.PngImagePlugin import PngInfo

from explorer import plot
from explorer.plot.captions import (
    CAPTIONS,
    Caption,
    Question,
    add_caption,
    caption_in,
    exif_of,
    few_colours,
    packed,
    replace_caption,
)
from explorer.portrait.bodies import race_numbers

# They draw nothing of their own.
TOOLS = {"caption_of", "figure_of", "save", "stacked"}
# Their panels are pictures with captions.
OF_PANELS = {"race_bodies", "rosette_and_resonance"}


def test_every_picture_has_a_caption_in_whole_sentences():
    assert {name for name in plot.__all__ if getattr(plot, name)} - TOOLS - OF_PANELS <= set(CAPTIONS)
    assert all(re.fullmatch(r"[A-Z](\S| (?! ))+\.", caption.text) for caption in CAPTIONS.values())


def test_a_figure_has_the_captions_of_what_was_drawn_on_it_once():
    figure = plot.race_bodies(race_numbers(4.0))
    both = [CAPTIONS[name].text for name in ("race_number", "race_gap")]
    assert plot.caption_of(figure) == Caption(Question.HOW_FAR, " ".join(both))
    add_caption(figure, CAPTIONS["race_gap"])
    assert plot.caption_of(figure).text == " ".join(both)
    whole = Caption(Question.PAPER, "All of it.")
    replace_caption(figure, whole)
    assert plot.caption_of(figure) == whole
    assert plot.caption_of(Figure()) is None


@pytest.mark.rendered("png", "svg", "pdf")
def test_a_file_carries_the_caption_of_its_figure(tmp_path):
    figure = Figure(figsize=(1, 1))
    caption = Caption(Question.WHERE_TO, "κ and η̂ — in Greek.")
    plot.save(figure, tmp_path / "none.png")
    assert caption_in(tmp_path / "none.png") is None
    add_caption(figure, caption)
    for kind in ("png", "svg", "pdf"):
        plot.save(figure, tmp_path / f"one.{kind}")
    assert caption_in(tmp_path / "one.png") == caption
    assert caption.text in (tmp_path / "one.svg").read_text("utf-8")
    assert caption_in(tmp_path / "one.svg") is None


def test_a_picture_of_lines_is_saved_with_few_colours_and_looks_the_same(tmp_path):
    lines = Image.new("RGB", (300, 200), "white")
    draw = ImageDraw.Draw(lines)
    for row in range(40):
        draw.line([(0, 5 * row), (300, 200 - 3 * row)], fill=(0, 114, 5 * row), width=2)
    inside = PngInfo()
    inside.add_itxt("Description", packed(Caption(Question.HAPPENS, "Lines.")))
    lines.save(tmp_path / "lines.png", pnginfo=inside, dpi=(150, 150))
    few_colours(tmp_path / "lines.png")
    with Image.open(tmp_path / "lines.png") as saved:
        assert saved.mode == "P"
        assert saved.info["dpi"] == pytest.approx((150, 150), abs=0.1)
        assert max(top for _, top in ImageChops.difference(saved.convert("RGB"), lines).getextrema()) <= 8
    assert caption_in(tmp_path / "lines.png").text == "Lines."


def test_a_picture_of_too_many_colours_and_a_transparent_one_keep_them_all(tmp_path):
    noise = np.random.default_rng(0).integers(0, 256, (60, 80, 3), dtype=np.uint8)
    Image.fromarray(noise).save(tmp_path / "noise.png")
    Image.new("RGBA", (60, 80), (0, 114, 178, 40)).save(tmp_path / "glass.png")
    for name in ("noise", "glass"):
        before = (tmp_path / f"{name}.png").read_bytes()
        few_colours(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes() == before


def test_films_carry_captions_too(tmp_path):
    caption = Caption(Question.HAPPENS, "The contact point races by κπ.")
    frame = Image.new("P", (4, 4))
    frame.save(tmp_path / "film.gif", comment=packed(caption).encode())
    assert caption_in(tmp_path / "film.gif") == caption
    frame.convert("RGB").save(tmp_path / "film.webp", exif=exif_of(caption))
    assert caption_in(tmp_path / "film.webp") == caption

"""Captions: every picture has one, and carries it."""

import re

import pytest
from matplotlib.figure import Figure
from PIL import Image

from explorer import plot
from explorer.plot.captions import (
    CAPTIONS,
    Caption,
    Question,
    add_caption,
    caption_in,
    captioned,
    exif_of,
    packed,
    replace_caption,
)
from explorer.portrait.bodies import race_numbers

# They draw nothing of their own.
TOOLS = {"caption_of", "figure_of", "save", "stacked"}
# Their panels are pictures with captions.
OF_PANELS = {"race_bodies", "rosette_and_resonance"}


def test_every_picture_has_a_caption_in_whole_sentences():
    assert set(plot.__all__) - TOOLS - OF_PANELS <= set(CAPTIONS)
    for name, caption in CAPTIONS.items():
        assert re.match(r"[A-Z]", caption.text), name
        assert caption.text.endswith("."), name
        assert 60 < len(caption.text) < 500, name
        assert "\n" not in caption.text, name
        assert "  " not in caption.text, name


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


def test_a_function_with_a_caption_keeps_its_name_and_what_it_returns():
    @captioned(Question.HAPPENS, "A number that no picture shows.")
    def number_of_nothing(x: float) -> float:
        """Help."""
        return x

    try:
        assert (number_of_nothing.__name__, number_of_nothing.__doc__) == ("number_of_nothing", "Help.")
        assert number_of_nothing(2.0) == 2.0
        assert CAPTIONS["number_of_nothing"].text == "A number that no picture shows."
    finally:
        del CAPTIONS["number_of_nothing"]


@pytest.mark.rendered
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


def test_films_carry_captions_too_and_other_files_none(tmp_path):
    caption = Caption(Question.HAPPENS, "The contact point races by κπ.")
    frame = Image.new("P", (4, 4))
    frame.save(tmp_path / "film.gif", comment=packed(caption).encode())
    assert caption_in(tmp_path / "film.gif") == caption
    frame.convert("RGB").save(tmp_path / "film.webp", exif=exif_of(caption))
    assert caption_in(tmp_path / "film.webp") == caption
    (tmp_path / "empty.png").touch()
    assert caption_in(tmp_path / "empty.png") is None
    assert caption_in(tmp_path / "missing.png") is None
    frame.save(tmp_path / "other.gif", comment=b"from elsewhere")
    assert caption_in(tmp_path / "other.gif") is None

"""The register: a function becomes a picture with its caption; what it does not take is said in a sentence."""

import re

import matplotlib
import matplotlib.style
import pytest
from conftest import BODIES
from matplotlib.figure import Figure

import explorer as ex
from explorer.commands.pages import caption_in
from explorer.commands.portrait import GROUPS, RECORDED
from explorer.phase.portrait import Portrait
from explorer.pictures.calls import portraits_of
from explorer.pictures.register import Caption, Question, add_caption, caption_of, save
from explorer.pictures.style import SERIES
from explorer.view import record

DISK = ex.Disk.uniform()


def test_captions_are_whole_sentences_and_say_what_no_other_says():
    texts = [each.caption.text for each in ex.pictures.values()]
    assert all(re.fullmatch(r"[A-Z](\S| (?! ))+\.", text) for text in texts)
    assert len(set(texts)) == len(texts)


def test_the_list_of_pictures_says_what_each_takes_by_its_question():
    lines = repr(ex.pictures).split("\n")
    place = lines.index("  rotation(disk, energy=2.0, points=300)")
    assert str(Question.WHERE_TO) in lines[:place]
    assert repr(ex.pictures["rotation"]).startswith("rotation(disk, energy=2.0, points=300): Draw the turn of chi")


def test_a_figure_has_the_captions_of_what_was_drawn_on_it_once():
    left, right = Figure().subplots(1, 2)
    for ax in (left, right):
        figure = ex.picture("steady-map", DISK, ax=ax)
    ex.picture("steady-plane", DISK, ax=right)
    both = [ex.pictures[name].caption.text for name in ("steady-map", "steady-plane")]
    assert caption_of(figure) == Caption(Question.WHICH_MOTIONS, " ".join(both))
    assert caption_of(Figure()) is None


@pytest.mark.rendered("png", "svg", "pdf")
def test_a_file_carries_the_caption_of_its_figure(tmp_path):
    figure = Figure(figsize=(1, 1))
    caption = Caption(Question.WHERE_TO, "κ and η̂ — in Greek.")
    save(figure, tmp_path / "none.png")
    assert caption_in(tmp_path / "none.png") is None
    add_caption(figure, caption)
    for kind in ("png", "svg", "pdf"):
        save(figure, tmp_path / f"one.{kind}")
    assert caption_in(tmp_path / "one.png") == caption
    assert caption.text in (tmp_path / "one.svg").read_text("utf-8")


def test_a_picture_of_several_axes_is_drawn_on_a_part_of_a_figure():
    figure = Figure(layout="constrained")
    above, below = figure.subfigures(2, 1)
    assert ex.picture("limit-paths", DISK, ax=above, eta_hat=(0.1,)) is figure
    ex.picture("steady-map", DISK, ax=below)
    assert len(above.axes) == 2
    assert len(below.axes) == 1


@pytest.mark.parametrize(
    ("name", "what", "numbers", "says"),
    [
        ("rotatoin", (DISK,), {}, "did you mean 'rotation'"),
        ("rotation", (), {}, "missing a required argument: 'disk'; it takes disk, energy, points"),
        ("rotation", (DISK,), {"enrgy": 2.0}, "unexpected keyword argument 'enrgy'"),
        ("rotation", (DISK,), {"energy": 0.9}, "give more"),
        ("rotation", ("hoop",), {}, "disk = 'hoop' is no Disk"),
        ("slice-of-tilts", (DISK,), {}, "is no SliceMap; give one"),
        ("steady-map", (ex.Disk(I1=0.25, I3=0.0),), {}, "I3 = 0"),
        ("limit-paths", (DISK,), {"ax": Figure().subplots()}, "has several axes; give a Figure"),
        ("race-histogram", ({"race": 1},), {}, "summary of a run of race-angles"),
        ("bifurcation-of-tilts", (DISK, "diagonal"), {}, "diagonal"),
        ("bifurcation-of-energies", (DISK, "line", [(0.2, -1.0)]), {}, "no motion of energy"),
        ("portrait-of-sides", (ex.potential(DISK, 0.25),), {}, "on F itself"),
    ],
)
def test_what_a_picture_does_not_take_is_said_in_a_sentence(name, what, numbers, says):
    with pytest.raises(ex.InputError, match=says):
        ex.picture(name, *what, **numbers)


def test_every_group_has_pictures_and_no_two_files_of_one_name():
    groups = {each.group for each in ex.pictures.values() if each.group}
    assert set(GROUPS) == groups | set(RECORDED)
    assert set(RECORDED) == set(record.CAPTIONS)
    names = [name for group in groups - {"slices"} for name, _ in portraits_of(group, Portrait(DISK))]
    assert len(names) == len(set(names)) > 20


def test_the_pictures_of_the_tilt_are_of_the_places_that_are_asked():
    def names(disk=DISK, **asked):
        return {name for name, _ in portraits_of("phase", Portrait(disk, **asked))}

    usual = {"potential", "potential-near-flat", "steady-map", "steady-plane"}
    usual |= {f"steady-{path}" for path in ("line", "rolling", "spinning")}
    assert names() == {"portrait-on", "portrait-sides", *usual}
    assert names(BODIES["thick"], eta_hat=0.02) == {"portrait-on", "portrait-beside", *usual}
    assert names(eta_hat=0.0) == {"portrait-on", *usual}
    assert names(sigma4_bar=0.3) == {"portrait-given", *usual}


def test_figures_of_ones_own_in_the_style_of_the_house_have_the_colours_of_its_series():
    with matplotlib.rc_context():
        matplotlib.style.use("explorer.pictures.house")
        assert matplotlib.rcParams["axes.prop_cycle"].by_key()["color"] == [*SERIES]


def test_a_notebook_shows_a_picture_as_the_last_value_of_a_cell():
    figure = ex.picture("rotation", ex.Disk.uniform(), points=20)
    assert figure._repr_png_().startswith(b"\x89PNG")

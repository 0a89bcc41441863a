"""Pictures of a run: one on a user's axes, all in the formats that were asked for."""

from types import SimpleNamespace

import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

import explorer as ex
from explorer.runs import pictures
from explorer.runs.pictures import read_formats, there


def test_one_picture_is_drawn_on_the_axes_given(computed_once):
    ax = Figure().subplots()
    assert computed_once.figure("histogram", ax=ax) is ax.figure
    assert ax.patches
    assert computed_once.pictures == ["histogram", "deviation"]


def test_what_cannot_be_drawn_is_named(computed_once):
    with pytest.raises(ex.InputError, match=r"'histo' is no picture of this run; did you mean 'histogram'\?"):
        computed_once.figure("histo")
    with pytest.raises(ex.InputError, match="'histogram' cannot be drawn with colours"):
        computed_once.figure("histogram", colours=3)


@pytest.mark.parametrize("value", ["pdf, svg", ["pdf", "svg"]])
def test_formats_are_text_or_a_list(value):
    assert read_formats("--format", value) == ("pdf", "svg")


@pytest.mark.parametrize("value", ["gif", "", [], 3, None, "png,"])
def test_other_formats_are_refused(value):
    with pytest.raises(ex.InputError, match="format"):
        read_formats("--format", value)


def test_pictures_are_there_only_in_all_formats(finished):
    assert there(finished.folder, ["histogram"], ("png", "svg")) == ["histogram"]
    assert there(finished.folder, ["histogram"], ("png", "pdf")) == []
    assert there(finished.folder, None, ()) == []


@pytest.mark.rendered("png", "svg")
def test_all_files_of_a_picture_have_the_layout_of_the_first(tmp_path, monkeypatch):
    laid_out, execute = [], ConstrainedLayoutEngine.execute

    def noted(engine, figure):
        laid_out.append(figure)
        return execute(engine, figure)

    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", noted)
    figure = Figure(layout="constrained")
    figure.subplots().set_ylabel("a wide label\nof two lines")
    progress = SimpleNamespace(expect=bool, drawing=bool, drawn=bool)
    assert pictures.save_all([("one", figure)], tmp_path, ("png", "svg"), progress) == ["one"]
    assert laid_out == [figure]
    assert all((tmp_path / f"one.{kind}").stat().st_size > 1000 for kind in ("png", "svg"))


@pytest.mark.rendered("svg")
def test_settings_with_which_matplotlib_cannot_draw_are_told_and_the_run_is_stored(tmp_path, monkeypatch):
    """And the pictures are drawn once they are changed."""
    monkeypatch.setenv("PATH", str(tmp_path))  # without LaTeX
    out = tmp_path / "races"
    with (
        rc_context({"text.usetex": True}),
        pytest.raises(ex.RunError, match=r"^pictures cannot be drawn \(.*\), samples and numbers are stored; "),
    ):
        ex.run("race-angles", samples=200, out=out, progress=False, format="svg")
    assert (out / "summary.json").is_file()
    assert ex.open(out).resume(progress=False).pictures == ["histogram", "deviation"]


def test_what_a_user_s_own_picture_raises_is_not_laid_to_matplotlib():
    def fails():
        raise ValueError("mine")

    with pytest.raises(ValueError, match="mine") as told:
        fails()
    assert not pictures.is_of_matplotlib(told.value)
    with pytest.raises(ValueError, match="dimension") as told:
        Figure().subplots().plot([1, 2], [1])
    assert pictures.is_of_matplotlib(told.value)

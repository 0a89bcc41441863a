"""Pictures of a run: one on a user's axes, all in the formats that were asked for."""

import pytest
from matplotlib.figure import Figure

import explorer as ex
from explorer.runs.pictures import read_formats, there


def test_one_picture_is_drawn_on_the_axes_given(computed_once):
    ax = Figure().subplots()
    assert computed_once.figure("histogram", ax=ax) is ax.figure
    assert ax.patches
    assert computed_once.pictures == ["histogram", "deviation"]


def test_what_cannot_be_drawn_is_named(computed_once):
    with pytest.raises(ex.InputError, match=r"'histo' is no picture of this run; did you mean 'histogram'\?"):
        computed_once.figure("histo")
    with pytest.raises(ex.InputError, match="cannot be drawn with colours"):
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

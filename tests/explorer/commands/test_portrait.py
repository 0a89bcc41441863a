"""The command that draws portraits: groups, options, and what it refuses."""

import pytest

import explorer as ex
from explorer.commands.portrait import FILM, GROUPS, portrait
from explorer.scenes.portrait import Portrait

HOOP = ex.Disk.hoop()


# The rest is drawn in the tests of its pictures, without pixels: those take seconds.
RENDERED = ("hero", "phase", "race", "bounces", "paths")


@pytest.mark.rendered("png", "svg", "pdf")
@pytest.mark.parametrize("group", RENDERED)
def test_each_group_of_pictures_is_one_command(group, tmp_path):
    written = portrait(tmp_path / "pictures", HOOP, only=group)
    assert written
    for path in written:
        assert path.stat().st_size > 5000
        assert path.with_suffix(".svg").stat().st_size < 5_000_000


def test_options_reach_the_phase_portrait(tmp_path, monkeypatch):
    drawn, pictures = [], Portrait.pictures

    def noted(scene):
        drawn.append(scene)
        return pictures(scene)

    monkeypatch.setattr(Portrait, "pictures", noted)
    written = portrait(tmp_path, HOOP, only="phase", sigma3_bar="0.3", eta_hat="1e-3", energy="0.5:2")
    assert {"portrait-on.png", "portrait-beside.png"} < {path.name for path in written}
    assert "portrait-plus.png" not in {path.name for path in written}
    assert (drawn[-1].sigma3_bar, drawn[-1].eta_hat, drawn[-1].energy) == (0.3, 1e-3, (0.5, 2.0))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"only": "nothing"}, "only 'nothing' is not known"),
        ({"energy": "2:1"}, "energy 2:1 is empty"),
        ({"sigma3_bar": "a lot"}, "sigma3"),
        ({"sigma3_bar": 2.0, "well": True}, "well"),
    ],
)
def test_bad_input_is_named_before_anything_is_written(options, message, tmp_path):
    with pytest.raises(ex.InputError, match=message):
        portrait(tmp_path / "none", HOOP, **options)
    assert not (tmp_path / "none").exists()


def test_a_folder_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ex.InputError, match="out"):
        portrait(tmp_path / "file", HOOP, only="race")


def test_the_film_has_a_group_of_its_own():
    assert FILM not in GROUPS

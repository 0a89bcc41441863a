"""The page of the results: every picture, with its command."""

from pathlib import Path

import pytest

import explorer as ex
from explorer.commands.gallery import gallery
from explorer.commands.made_by import leave_made_by
from explorer.commands.main import main

RESULTS = Path(__file__).parents[3] / "results"


def test_the_committed_page_is_what_the_command_writes():
    assert (RESULTS / "README.md").read_text(encoding="utf-8") == gallery(RESULTS)


def test_every_committed_picture_is_in_it():
    page = gallery(RESULTS)
    for picture in RESULTS.rglob("*.png"):
        assert picture.relative_to(RESULTS).as_posix() in page


def test_the_page_has_the_command_of_every_folder_and_picture(tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "one.png").touch()
    assert "mine, one: `not known`" in gallery(tmp_path)
    leave_made_by(mine, "nearflat demo", {"one.png": "nearflat demo --a"})
    page = gallery(tmp_path)
    assert "| [`mine/`](mine) | `nearflat demo` |" in page
    assert "mine, one: `nearflat demo --a`" in page


def test_what_is_no_folder_is_named(tmp_path):
    with pytest.raises(ex.InputError, match="is no folder"):
        gallery(tmp_path / "none")


def test_a_gallery_is_written_where_it_is_asked_for(tmp_path, capsys):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "one.png").write_bytes(b"")
    leave_made_by(tmp_path / "mine", "nearflat demo")
    assert main(["gallery", str(tmp_path)]) == 0
    assert "mine/one.png" in (tmp_path / "README.md").read_text(encoding="utf-8")
    assert str(tmp_path / "README.md") in capsys.readouterr().out

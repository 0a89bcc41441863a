from pathlib import Path

import pytest

import explorer as ex
from explorer.commands.gallery import command_of, gallery

RESULTS = Path(__file__).parents[3] / "results"


def test_the_committed_page_is_what_the_command_writes():
    assert (RESULTS / "README.md").read_text(encoding="utf-8") == gallery(RESULTS)


def test_every_committed_picture_is_in_it():
    page = gallery(RESULTS)
    for picture in RESULTS.rglob("*.png"):
        assert picture.relative_to(RESULTS).as_posix() in page


def test_commands_come_from_pages_and_from_runs(tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "notes.md").write_text("nothing")
    assert command_of(mine) == "not known"
    page = "Made by `nearflat demo`.", "`nearflat demo --a`", "one.png", "`nearflat b`", "two.png"
    (mine / "notes.md").write_text("\n\n".join(page))
    assert command_of(mine) == "nearflat demo"
    assert command_of(mine, "one.png") == "nearflat demo --a"
    assert command_of(mine, "two.png") == "nearflat b"
    assert command_of(mine, "three.png") == "nearflat demo"
    run = ex.run("race-angles", out=tmp_path / "run", samples=10)
    assert command_of(run.folder).startswith("nearflat run race-angles")
    assert "run, histogram: `nearflat run race-angles" in gallery(tmp_path)


def test_what_is_no_folder_is_named(tmp_path):
    with pytest.raises(ex.InputError, match="is no folder"):
        gallery(tmp_path / "none")

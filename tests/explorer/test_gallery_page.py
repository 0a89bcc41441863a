from pathlib import Path

import pytest

import explorer as ex
from explorer.gallery import command_of, gallery

RESULTS = Path(__file__).parents[2] / "results"


def test_the_committed_page_is_what_the_command_writes():
    assert (RESULTS / "README.md").read_text(encoding="utf-8") == gallery(RESULTS)


def test_every_committed_picture_is_in_it():
    page = gallery(RESULTS)
    for picture in RESULTS.rglob("*.png"):
        assert picture.relative_to(RESULTS).as_posix() in page


def test_a_folder_that_does_not_say_what_made_it_is_named(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "notes.md").write_text("nothing")
    with pytest.raises(ex.InputError, match="mine: no page in it says"):
        gallery(tmp_path)
    (tmp_path / "mine" / "notes.md").write_text("Made by `nearflat demo`.")
    assert command_of(tmp_path / "mine") == "nearflat demo"


def test_what_is_no_folder_is_named(tmp_path):
    with pytest.raises(ex.InputError, match="is no folder"):
        gallery(tmp_path / "none")

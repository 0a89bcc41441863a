"""made_by.json: what made a folder, and each picture in it."""

import json

import pytest

import explorer as ex
from explorer.commands.made_by import FILE, UNKNOWN, command_of, leave_made_by
from explorer.commands.main import main


def test_a_picture_has_a_command_of_its_own_or_that_of_its_folder(tmp_path):
    leave_made_by(tmp_path, "nearflat portrait", {"film.gif": "nearflat portrait --only film"})
    assert command_of(tmp_path) == command_of(tmp_path, "other.png") == "nearflat portrait"
    assert command_of(tmp_path, "film.gif") == "nearflat portrait --only film"
    assert json.loads((tmp_path / FILE).read_text())["made_by"] == "nearflat portrait"


@pytest.mark.parametrize("content", [None, "{", '{"pictures": 3, "made_by": "x"}'])
def test_a_folder_that_does_not_say_it_is_not_known(content, tmp_path):
    if content is not None:
        (tmp_path / FILE).write_text(content)
    assert command_of(tmp_path, "one.png") == UNKNOWN


def test_a_run_remembers_the_command_line_that_made_it(tmp_path, capsys):
    folder = tmp_path / "run"
    words = ["run", "race-angles", "--samples", "500", "--box", "phidot=1:1.5,sigma3=-1:1", "--out", str(folder)]
    assert main(words) == 0
    assert (
        command_of(folder)
        == f"nearflat run race-angles --samples 500 --box phidot=1:1.5,sigma3=-1:1 --out {folder}"
    )
    assert main(["resume", str(folder)]) == 0
    assert command_of(folder).startswith("nearflat run race-angles")
    ex.run("race-angles", samples=500, out=tmp_path / "other")
    assert command_of(tmp_path / "other") == "ex.run('race-angles', ...), with the options in run.json"

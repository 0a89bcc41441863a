"""The command that draws portraits: groups, options, and what it refuses."""

import json
from pathlib import Path

import pytest
from told import said

# The rest is drawn in the tests of its pictures.
RENDERED = ("phase", "race", "bounces", "paths")


@pytest.mark.rendered("svg")
@pytest.mark.parametrize("group", RENDERED)
def test_each_group_of_pictures_is_one_command(group, tmp_path, capsys):
    """The files of points and lines are not so large that a browser would not show them."""
    words = ["--only", group, "--disk", "hoop", "--out", tmp_path / "pictures", "--quiet", "--json"]
    status, out, _ = said(capsys, "portrait", *words)
    written = [Path(name) for name in json.loads(out)["files"]]
    assert (status, bool(written)) == (0, True)
    for path in written:
        assert path.exists()
        assert 5000 < path.with_suffix(".svg").stat().st_size < 5_000_000


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--only", "nothing"], "only 'nothing'"),
        (["--disk", "hop"], "did you mean 'hoop'"),
    ],
)
def test_bad_input_is_named_before_anything_is_written(words, message, tmp_path, capsys):
    status, _, err = said(capsys, "portrait", *words, "--out", tmp_path / "none")
    assert status == 2
    assert message in err
    assert not (tmp_path / "none").exists()


def test_without_a_browser_the_rest_is_drawn_and_what_is_missing_is_said(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("NEARFLAT_CHROMIUM", raising=False)
    monkeypatch.setattr("explorer.commands.portrait.GROUPS", ["hero", "film", "definitions"])
    status, out, err = said(capsys, "portrait", "--quiet", "--out", tmp_path / "all")
    assert status == 0
    assert "1 files" in out
    assert "without hero and film" in err
    assert "no Chromium was found" in err
    assert "film" not in (tmp_path / "all" / "README.md").read_text("utf-8").lower()
    status, _, err = said(capsys, "portrait", "--only", "film", "--out", tmp_path / "none")
    assert status == 2
    assert "no Chromium was found" in err
    assert not (tmp_path / "none").exists()

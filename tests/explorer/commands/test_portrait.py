"""The command that draws portraits: groups, options, and what it refuses."""

import json
import shlex
from pathlib import Path

import pytest
from told import said

import explorer as ex
from explorer.phase.portrait import Portrait

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


def test_the_group_phase_takes_constants_and_energies_and_gives_its_numbers(tmp_path, capsys):
    asked = ["--sigma3-bar", "-0.2", "--eta-hat", "-1e-3", "--energy", "0.5:2"]
    words = ["--only", "phase", "--disk", "hoop", *asked]
    status, out, err = said(capsys, "portrait", *words, "--out", tmp_path / "one", "--quiet", "--json")
    assert status == 0, err
    answer = json.loads(out)
    drawn = {Path(name).stem for name in answer.pop("files")}
    assert {"portrait-on", "portrait-beside"} <= drawn
    portrait = Portrait(ex.Disk.hoop(), sigma3_bar=-0.2, eta_hat=-1e-3, energy=(0.5, 2.0))
    assert answer == portrait.describe()
    page = (tmp_path / "one" / "README.md").read_text("utf-8")
    assert f"`nearflat portrait {shlex.join(words)}`" in page


def test_other_groups_give_their_files_only(tmp_path, capsys):
    status, out, _ = said(
        capsys, "portrait", "--only", "definitions", "--out", tmp_path / "one", "--quiet", "--json"
    )
    assert status == 0
    assert set(json.loads(out)) == {"files"}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--only nothing", "only 'nothing'"),
        ("--disk hop", "did you mean 'hoop'"),
        ("--disk I1=0.25,I3=0", "I3 = 0"),
        ("--only phase --energy 2:1", "energy"),
        ("--only phase --energy 1:1", "empty"),
        ("--only phase --energy far", "energy"),
        ("--only phase --energy -2:-1", "no motion has an energy below"),
        ("--only phase --sigma4-bar 0.1 --eta-hat 0.1", "leave one out"),
        ("--only phase --sigma3-bar nan", "sigma3_bar"),
        ("--only phase --sigma4-bar far", "sigma4_bar"),
        ("--only phase --eta-hat 1:2", "eta_hat"),
        *(
            (
                f"{group} --{name} {value}",
                f"{name.replace('-', '_')} {value}: is for the group phase; add --only phase",
            )
            for group in ("", "--only race")
            for name, value in {"sigma3-bar": 0.2, "sigma4-bar": 0.1, "eta-hat": 0.1, "energy": "0:2"}.items()
        ),
    ],
)
def test_bad_input_is_named_before_anything_is_written(words, message, tmp_path, capsys):
    status, _, err = said(capsys, "portrait", *words.split(), "--out", tmp_path / "none")
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

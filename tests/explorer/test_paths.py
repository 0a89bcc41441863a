"""Files that users name: what may be read, and what is written."""

from pathlib import Path

import pytest
from coins import Coins
from told import said

import explorer as ex
from explorer.errors import InputError
from explorer.paths import read_toml, writing_page
from explorer.scenes.given_states import GivenStates


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (None, "path = None is no path; give text or a Path"),
        (b"x.html", "path = b'x.html' is no path"),
        ("", "path =  is no path; give text or a Path"),
        ("x.jpg", "path = 'x.jpg': the page is HTML; give a name that ends in .html or .htm"),
        ("no such folder/x.html", "there is no folder 'no such folder'; make it first"),
    ],
)
def test_what_is_no_file_that_can_be_written_is_refused_before_anything_is_done(given, says):
    with pytest.raises(InputError, match=says), writing_page("path", given):
        raise AssertionError("nothing may be written")


def test_what_the_system_says_against_a_file_is_told_and_the_path_is_as_it_was_given(tmp_path):
    with writing_page("path", str(tmp_path / "x.HTM")) as path:
        assert path == Path(tmp_path / "x.HTM")
    with (
        pytest.raises(InputError, match=r"x.html': cannot be written \(No such file or directory\)"),
        writing_page("path", tmp_path / "x.html") as path,
    ):
        path.with_name("nowhere").joinpath("x").write_text("x")


def test_what_is_no_toml_is_said_with_its_place(tmp_path):
    (tmp_path / "x.toml").write_text("a = ", encoding="utf-8")
    with pytest.raises(InputError, match=r"disk .*x.toml: not valid TOML \(Invalid value \(at end of document"):
        read_toml(tmp_path / "x.toml", "disk")
    with pytest.raises(InputError, match=r"y.toml: cannot be read \(No such file"):
        read_toml(tmp_path / "y.toml", "disk")


def test_a_link_to_a_file_is_written_to_where_it_leads(tmp_path):
    ex.view().save(tmp_path / "there.html")
    (tmp_path / "view.html").symlink_to(tmp_path / "there.html")
    with writing_page("path", tmp_path / "view.html") as path:
        path.write_text("after")
    assert (tmp_path / "there.html").read_text() == "after"


def test_a_tilde_is_the_home_folder_in_every_path_that_a_user_gives(tmp_path, monkeypatch, capsys):
    for variable in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(variable, str(tmp_path / "home"))
    home, here = tmp_path / "home", tmp_path / "here"
    home.mkdir(), here.mkdir()
    monkeypatch.chdir(here)
    (home / "mine.toml").write_text("I1 = 0.3\nI3 = 0.6\n")
    (home / "asked.toml").write_text('scene = "~/flips.py:Flips"\nsamples = 64\n')
    (home / "flips.py").write_text("from coins import Coins as Base\n\n\nclass Flips(Base):\n    'Which side?'\n")
    (home / "states.csv").write_text("tilt,precession,spin\n0.5,1,1\n0.6,1,1\n")
    assert ex.Disk.parse("~/mine.toml").I1 == 0.3
    assert ex.run("~/flips.py:Flips", samples=10).summary["samples"] == 10
    assert GivenStates.of("states", "~/states.csv").rows == 2
    for words in (
        ("run", "~/asked.toml", "--out", "~/runs", "--no-figures", "--quiet"),
        ("verify", "~/runs"),
        ("resume", "~/runs", "--no-figures", "--quiet"),
        ("summary", "~/runs"),
        ("view", "--disk", "~/mine.toml", "--out", "~/page.html"),
        ("gallery", "~"),
    ):
        assert said(capsys, *words)[0] == 0, words
    assert ex.open("~/runs").folder == home / "runs"
    assert {path.name for path in home.iterdir()} >= {"runs", "page.html", "README.md"}
    assert not list(here.iterdir())


def test_the_home_of_nobody_is_refused_and_a_tilde_elsewhere_is_a_letter(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"~no such user/x: there is no such home folder"):
        ex.run(Coins, samples=10, out="~no such user/x")
    ex.run(Coins, samples=10, out="./~x/a~b", figures=False)
    assert (tmp_path / "~x" / "a~b" / "run.json").is_file()

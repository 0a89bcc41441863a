"""Files that users name: what may be read, and what is written."""

from pathlib import Path

import pytest

from explorer.errors import InputError
from explorer.paths import read_toml, writing


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (None, "path = None is no path; give text or a Path"),
        (b"x.png", "path = b'x.png' is no path"),
        ("", "path =  is no path; give text or a Path"),
        ("x.jpg", "path = 'x.jpg': a picture; give a name that ends in .png, .svg or .pdf"),
        ("no such folder/x.png", "there is no folder 'no such folder'; make it first"),
    ],
)
def test_what_is_no_file_that_can_be_written_is_refused_before_anything_is_done(given, says):
    with pytest.raises(InputError, match=says), writing("path", given, (".png", ".svg", ".pdf"), "a picture; "):
        raise AssertionError("nothing may be written")


def test_what_the_system_says_against_a_file_is_told_and_the_path_is_as_it_was_given(tmp_path):
    with writing("path", str(tmp_path / "x.PNG"), (".png",)) as path:
        assert path == Path(tmp_path / "x.PNG")
    with (
        pytest.raises(InputError, match=r"x.png': cannot be written \(No such file or directory\)"),
        writing("path", tmp_path / "x.png", (".png",)) as path,
    ):
        path.with_name("nowhere").joinpath("x").write_text("x")


def test_what_is_no_toml_is_said_with_its_place(tmp_path):
    (tmp_path / "x.toml").write_text("a = ", encoding="utf-8")
    with pytest.raises(InputError, match=r"disk .*x.toml: not valid TOML \(Invalid value \(at end of document"):
        read_toml(tmp_path / "x.toml", "disk")
    with pytest.raises(InputError, match=r"y.toml: cannot be read \(No such file"):
        read_toml(tmp_path / "y.toml", "disk")


def test_a_link_to_a_file_is_written_to_where_it_leads(tmp_path):
    (tmp_path / "there.html").write_text("before")
    (tmp_path / "view.html").symlink_to(tmp_path / "there.html")
    with writing("path", tmp_path / "view.html", (".html",)) as path:
        path.write_text("after")
    assert (tmp_path / "there.html").read_text() == "after"

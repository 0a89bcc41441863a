"""Files that users name: what may be read, and what is written."""

import os
import sys
import time
from pathlib import Path

import pytest

import explorer as ex
from explorer.errors import InputError
from explorer.phase.paths import path_of, read_toml, writing


@pytest.mark.parametrize(
    ("given", "says"),
    [
        (None, "path = None is no path; give text or a Path"),
        (b"x.png", "path = b'x.png' is no path"),
        ("x\0.png", "give text that is not empty and has no NUL"),
        ("/tmp/\ud800.png", "is no path in UTF-8; give it another name"),
        ("\udcff.png", r"path = \\udcff.png is no path in UTF-8"),
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


@pytest.mark.skipif(sys.platform != "linux", reason="other systems keep names of folders in letters")
def test_from_a_folder_that_has_no_name_in_utf_8_whole_paths_are_read_only(tmp_path, monkeypatch):
    """Chunks written from there were called damaged."""
    odd = tmp_path / "\udcff"
    odd.mkdir()
    monkeypatch.chdir(odd)
    with pytest.raises(InputError, match="the current folder is no path in UTF-8; work in another one"):
        path_of("--out", "races")
    assert path_of("--out", tmp_path / "races") == tmp_path / "races"


@pytest.mark.skipif(sys.platform != "linux", reason="other systems keep the folder in which somebody works")
def test_from_a_folder_that_was_removed_only_whole_paths_are_read(tmp_path, monkeypatch):
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    for text in ("races", ".", "../races", Path("races")):
        with pytest.raises(InputError, match="the current folder was removed; work in another one"):
            path_of("--out", text)
    assert path_of("--out", tmp_path / "races") == tmp_path / "races"


LONG_KEYS = ("a.", " a .\t", "1.", '"a b".', "'a b' . ", '"\\"".')


@pytest.mark.parametrize("part", LONG_KEYS)
@pytest.mark.parametrize("form", ["{}=1", "[{}]", "[[{}]]", "x = {{{} = 1}}", "x = {{y = 1, {} = 1}}"])
def test_a_key_of_very_many_parts_is_refused_before_it_is_parsed(part, form, tmp_path):
    path = tmp_path / "long.toml"
    path.write_text(form.format(50_000 * part + "a"), encoding="utf-8")
    begun = time.process_time()
    with pytest.raises(InputError, match="a key has more than 20 parts"):
        read_toml(path, "--disk")
    assert time.process_time() - begun < 1.0


@pytest.mark.parametrize("quotes", ['"""', "'''"])
def test_strings_of_many_lines_are_not_taken_for_keys(quotes, tmp_path):
    path = tmp_path / "words.toml"
    line = "x" + 25 * ".a"
    path.write_text(
        f"text = {quotes}\n{line}{quotes}\n# {quotes}\n{line.replace('.', '_')} = 1\n", encoding="utf-8"
    )
    assert read_toml(path, "SCENE")["text"] == line
    path.write_text(f"# {quotes}\n{line} = 1\n# {quotes}\n", encoding="utf-8")
    with pytest.raises(InputError, match="a key has more than 20 parts"):
        read_toml(path, "SCENE")


def test_keys_of_some_parts_and_lists_of_many_numbers_are_read(tmp_path):
    path = tmp_path / "some.toml"
    numbers = ", ".join(["0.25"] * 5000)
    path.write_text(f"a.b.c = 1\nsome = [{numbers}]\ntext = '{'. ' * 500}'\n", encoding="utf-8")
    read = read_toml(path, "SCENE")
    assert (read["a"], len(read["some"]), len(read["text"])) == ({"b": {"c": 1}}, 5000, 1000)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a = " + "9" * 5000, "a number has too many digits"),
        ("a = " + "[" * 50_000, "it is nested too deeply"),
        ("a = ", "Invalid value"),
    ],
)
def test_what_is_no_toml_is_said_without_words_of_python(text, says, tmp_path):
    (tmp_path / "x.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=rf"not valid TOML \({says}"):
        read_toml(tmp_path / "x.toml", "--disk")


@pytest.mark.parametrize("what", ["a pipe", "a folder", "a device"])
def test_only_a_plain_file_is_written_over(tmp_path, what):
    """To open a pipe hangs until somebody reads from it."""
    path = tmp_path / "view.html"
    if what == "a folder":
        path.mkdir()
    elif what == "a pipe":
        if not hasattr(os, "mkfifo"):
            pytest.skip("pipes with names are those of POSIX")
        os.mkfifo(path)
    else:
        if not Path("/dev/null").exists():
            pytest.skip("there is no such device")
        path.symlink_to("/dev/null")
    with pytest.raises(InputError, match=r"path = .*view\.html': is no plain file; give another name"):
        ex.view().save(path)


def test_a_link_to_a_file_is_written_to_where_it_leads(tmp_path):
    (tmp_path / "there.html").write_text("before")
    (tmp_path / "view.html").symlink_to(tmp_path / "there.html")
    with writing("path", tmp_path / "view.html", (".html",)) as path:
        path.write_text("after")
    assert (tmp_path / "there.html").read_text() == "after"

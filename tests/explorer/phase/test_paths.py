"""Files that users name: what may be read, and what is written."""

from pathlib import Path

import pytest

from explorer.errors import InputError
from explorer.phase.paths import writing


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
    (tmp_path / "x.png").mkdir()
    with (
        pytest.raises(InputError, match=r"x.png': cannot be written \(Is a directory\)"),
        writing("path", tmp_path / "x.png", (".png",)) as path,
    ):
        path.write_text("x")

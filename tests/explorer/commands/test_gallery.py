"""The page of the results: every picture, with its command."""

import os
import re
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import pytest
from PIL import Image

import explorer as ex
from explorer.commands.gallery import command_of, gallery
from explorer.commands.main import main
from explorer.commands.pages import picture_lines
from explorer.pictures.register import Caption, Question

RESULTS = Path(__file__).parents[3] / "results"


@pytest.fixture(scope="module")
def committed(tmp_path_factory):
    """The results that the repository holds: runs of a user's own stand beside them, where git does not look."""
    root = RESULTS.parent
    if not (root / ".git").exists():
        pytest.skip("only a clone knows which files belong to it")
    listed = subprocess.run(["git", "-C", root, "ls-files", "-z", "results"], capture_output=True, check=True)
    copy = tmp_path_factory.mktemp("committed")
    for name in filter(None, listed.stdout.decode().split("\0")):
        if (root / name).exists():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(root / name, copy / name)
    return copy / "results"


def test_the_committed_page_is_what_the_command_writes(committed):
    assert (committed / "README.md").read_text(encoding="utf-8") == gallery(committed)


@pytest.mark.parametrize("page", [RESULTS.parent / "README.md", *sorted(RESULTS.rglob("README.md"))], ids=str)
def test_pages_name_only_files_that_exist(page):
    text = re.sub(r"^```.*?^```", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    named = re.findall(r'(?:src|href)="([^"]+)"|\]\(([^)\s]+)\)', text)
    for link in (one or other for one, other in named):
        where = link.partition("#")[0]
        if where and not re.match(r"[a-z]+:", where):
            assert (page.parent / where).exists(), link


def test_the_page_has_the_command_of_every_folder_and_its_pictures(tmp_path):
    mine = tmp_path / "mine"
    mine.mkdir()
    (mine / "one.png").touch()
    assert "mine, one<br>\n<code>not known</code>" in gallery(tmp_path)
    (mine / "README.md").write_text("# Mine\n\nMade by `nearflat demo --a`, and more.\n")
    page = gallery(tmp_path)
    assert '| <a href="mine"><code>mine/</code></a> | <code>nearflat demo --a</code> |' in page
    assert "mine, one<br>\n<code>nearflat demo --a</code>" in page


def test_a_run_remembers_the_command_line_that_made_it(tmp_path):
    folder = tmp_path / "run"
    words = ["run", "race-angles", "--samples", "500", "--box", "phidot=1:1.5,sigma3=-1:1", "--out", str(folder)]
    made_by = f"nearflat run race-angles --samples 500 --box phidot=1:1.5,sigma3=-1:1 --out {folder}"
    for command in (words, ["resume", str(folder)]):
        assert main(command) == 0
        assert command_of(folder) == made_by
    ex.run("race-angles", samples=500, out=tmp_path / "other")
    assert command_of(tmp_path / "other") == "ex.run('race-angles', ...), with the options in run.json"


def test_pictures_stand_by_their_question_and_the_hero_comes_first(tmp_path):
    folder = tmp_path / "mine"
    folder.mkdir()
    frame = Image.new("P", (4, 4))
    for name, question in (("a", Question.HOW_FAR), ("film", Question.HAPPENS), ("hero", Question.HAPPENS)):
        caption = Caption(question, f"The picture {name} says <much>.")
        frame.save(folder / f"{name}.gif", comment="\n".join(caption).encode())
    page = gallery(tmp_path)
    places = [page.index(text) for text in ("What happens?", "hero.gif", "film.gif", "How far does", "a.gif")]
    assert places == sorted(places)
    assert "From where" not in page
    assert 'alt="The picture a says &lt;much&gt;."' in page
    assert picture_lines(folder / "a.gif", tmp_path)[-1] == "The picture a says &lt;much&gt;."


def test_what_is_no_folder_is_named(tmp_path):
    with pytest.raises(ex.InputError, match="is no folder"):
        gallery(tmp_path / "none")


def test_a_gallery_is_written_where_it_is_asked_for(tmp_path, capsys):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "one.png").write_bytes(b"")
    assert main(["gallery", str(tmp_path)]) == 0
    assert "mine/one.png" in (tmp_path / "README.md").read_text(encoding="utf-8")
    assert str(tmp_path / "README.md") in capsys.readouterr().out


def test_the_page_of_a_gallery_lets_no_command_write_over_what_it_lists(tmp_path, capsys):
    mine = tmp_path / "definitions.png"
    mine.write_bytes(b"mine")
    assert main(["gallery", str(tmp_path)]) == 0
    assert main(["portrait", "--only", "definitions", "--out", str(tmp_path), "--quiet"]) == 2
    assert "holds what nearflat has not made" in capsys.readouterr().err
    assert mine.read_bytes() == b"mine"
    assert main(["gallery", str(tmp_path)]) == 0


@pytest.mark.skipif(os.name == "nt", reason="names and pipes are others there")
def test_a_folder_with_anything_in_it_has_a_page(tmp_path):
    odd = tmp_path / os.fsdecode(b"odd\xff")
    odd.mkdir()
    (odd / "README.md").write_bytes(b"# x\n\nMade by `nearflat \xff`\n")
    os.mkfifo(odd / "pipe.png")
    # An image of 60,000 x 60,000 points, by its first lines.
    size = b"IHDR" + struct.pack(">IIBBBBB", 60_000, 60_000, 8, 2, 0, 0, 0)
    (odd / "large.png").write_bytes(
        b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + size + struct.pack(">I", zlib.crc32(size))
    )
    assert main(["gallery", str(tmp_path)]) == 0
    page = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "odd%FF/large.png" in page
    assert "pipe" not in page

"""Run the code of pages: Python with what it prints, commands with what they say, pictures with their code.

In a page,

- a `python` block runs; lines after `>>>` must print what stands below them;
- an `sh` block runs each of its lines, which are `nearflat` commands; a `text` block right after it is what the
  last command prints, where `...` stands for anything;
- a block after a `skip` comment runs where what it needs is installed;
- a `bash` block is for reading only: installing, or starting other programs;
- a picture that a block saves as `NAME.png` is `docs/images/NAME.png`, where it carries a digest of that block.

`python tests/tools/pages.py` runs all pages and writes their pictures anew.
"""

import contextlib
import hashlib
import io
import os
import re
import shlex
import sys
from doctest import ELLIPSIS, NORMALIZE_WHITESPACE, OutputChecker
from importlib.util import find_spec
from pathlib import Path
from unittest import SkipTest

import matplotlib
from matplotlib.figure import Figure
from PIL import Image
from sybil.document import Document
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser, SkipParser

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
IMAGES = ROOT / "docs" / "images"
SAVED = re.compile(r"savefig\(\s*[\"']([\w-]+)\.png")
LOOSE = ELLIPSIS | NORMALIZE_WHITESPACE


def run_commands(example):
    """Run the lines of a block as commands and keep what the last one prints."""
    from explorer.commands.main import main

    for line in example.parsed.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if not words:
            continue
        if words[0] != "nearflat":
            return f"{words[0]}: a block of commands runs `nearflat` only; show others in a `bash` block"
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            status = main([*words[1:], "--quiet"])
        example.namespace["_printed"] = printed.getvalue()
        if status != 0:
            return f"{line}: exit status {status}"
    return None


def compare_output(example):
    """Compare a block of text with what the command before it printed."""
    printed = example.namespace.pop("_printed", None)
    if printed is None:
        return "a `text` block shows what the commands before it print"
    if OutputChecker().check_output(example.parsed, printed, LOOSE):
        return None
    return f"expected:\n{example.parsed}\nprinted:\n{printed}"


PARSERS = [
    SkipParser(),
    PythonCodeBlockParser(doctest_optionflags=LOOSE),
    CodeBlockParser("sh", run_commands),
    CodeBlockParser("text", compare_output),
]


def parse(page):
    """The blocks of a page that can be run, as one document with one namespace."""
    return Document.parse(str(page), *PARSERS)


def run(page, folder):
    """Run all blocks of a page in a folder; what goes wrong says its file and line."""
    document = parse(page)
    document.namespace |= {
        "installed": lambda name: find_spec(name) is not None,
        "examples": ROOT / "docs" / "examples",
    }
    # What a page sets of the look of its pictures is its own
    with contextlib.chdir(folder), matplotlib.rc_context():
        for example in document.examples():
            with contextlib.suppress(SkipTest):
                example.evaluate()


def pictures(page):
    """Name -> digest of the block that saves it, for all pictures of a page."""
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    return {name: hashlib.sha256(block.encode()).hexdigest() for block in blocks for name in SAVED.findall(block)}


def stored_digest(name):
    """The digest in a stored picture; None where there is none."""
    with Image.open(IMAGES / f"{name}.png") as image:
        return image.info.get("Source")


def write_pictures(page, folder):
    """Run a page and store its pictures, each with the digest of its block."""
    saved = Figure.savefig
    digests = pictures(page)

    def stamped(figure, path, **options):
        name = Path(path).stem
        if name in digests:
            options = {"dpi": 130} | options | {"metadata": {"Source": digests[name], "Software": None}}
            path = IMAGES / Path(path).name
        saved(figure, path, **options)

    Figure.savefig = stamped
    try:
        run(page, folder)
    finally:
        Figure.savefig = saved


if __name__ == "__main__":
    import tempfile

    os.environ.setdefault("COLUMNS", "100")
    for chosen in [Path(word).resolve() for word in sys.argv[1:]] or PAGES:
        print(chosen.relative_to(ROOT))
        with tempfile.TemporaryDirectory() as scratch:
            write_pictures(chosen, scratch)

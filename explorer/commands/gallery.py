"""`nearflat gallery`: the page of a folder of results by question, every picture with its caption and command.

A folder's own page says "Made by `COMMAND`"; a run says it in run.json.
"""

import argparse
import contextlib
import os
import re
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from explorer.commands import Answer
from explorer.errors import InputError, RunError
from explorer.paths import made_folder, path_of, require_own
from explorer.runs.folder import read_record

KINDS = (".png", ".gif", ".webp")
_FIRST = ("hero", "definitions", "film")  # of their question, in this order
_OTHER = "Other pictures"


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`; captions are in the files, commands in the folders below it.

    Raises InputError where `folder` is none.
    """
    from explorer.commands.pages import caption_in, escaped, image_of, text_of
    from explorer.pictures.register import Question

    root = path_of("DIR", folder)
    if not root.is_dir():
        raise InputError(f"{root}: is no folder; give the one that holds the results")
    parts = [path for path in sorted(root.iterdir()) if path.is_dir()]
    shown: dict[str, list[tuple[Path, str]]] = {str(question): [] for question in (*Question, _OTHER)}
    for part in parts:
        for picture in sorted(path for path in part.rglob("*") if path.suffix in KINDS and path.is_file()):
            if picture.suffix == ".png" and picture.with_suffix(".webp").exists():
                continue  # the same that moves is shown
            caption = caption_in(picture)
            made_by = f"<code>{escaped(command_of(part))}</code>"
            cell = [image_of(picture, root, caption, 420), text_of(picture, caption), made_by]
            shown[str(caption.question) if caption else _OTHER].append((picture, "<br>\n".join(cell)))
    lines = [
        "# Results",
        "",
        "Made by `nearflat gallery`. Each picture is made by the command beside it. Click a picture to",
        "see it in full size.",
    ]
    for question, cells in shown.items():
        cells.sort(key=lambda each: _FIRST.index(each[0].stem) if each[0].stem in _FIRST else len(_FIRST))
        rows = [cells[first : first + 2] for first in range(0, len(cells), 2)]
        if rows:
            lines += ["", f"## {question}", "", "<table>"]
        for row in rows:
            lines += ["<tr>", *(f'<td width="50%" valign="top">\n{cell}\n</td>' for _, cell in row), "</tr>"]
        lines += ["</table>"] if rows else []
    lines += ["", "## All folders", "", "| folder | command |", "|---|---|"]
    for part in parts:
        link = f'<a href="{quote(os.fsencode(part.name))}"><code>{escaped(part.name)}/</code></a>'
        lines.append(f"| {link} | <code>{escaped(command_of(part))}</code> |")
    return "\n".join(lines) + "\n"


def command_of(folder: Path) -> str:
    """The command that made a folder, as its page or its run says it."""
    page = folder / "README.md"
    text = page.read_text("utf-8", "replace") if page.is_file() else ""
    if said := re.search(r"^Made by `(.+?)`", text, re.MULTILINE):
        return said[1]
    with contextlib.suppress(InputError, RunError):
        record = read_record(folder)
        return str(
            record["command"] or f"ex.run({record['options']['scene']!r}, ...), with the options in run.json"
        )
    return "not known"


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat gallery`."""
    command.add_argument("folder", nargs="?", default="results", metavar="DIR", help="folder (default results)")


def call(options: argparse.Namespace) -> Answer:
    """Write the page."""
    page = path_of("DIR", options.folder) / "README.md"
    text = gallery(options.folder)
    require_own(f"DIR {page}", page)
    made_folder("DIR", page.parent)
    page.write_text(text, encoding="utf-8")
    return Answer({"page": str(page)}, f"wrote {page}")

"""`nearflat gallery`: the page of a folder of results by question, every picture with its caption and command."""

import argparse
import html
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from explorer.commands.made_by import command_of
from explorer.errors import InputError
from explorer.phase.paths import path_of

if TYPE_CHECKING:
    from explorer.plot.captions import Caption

KINDS = ("png", "gif", "webp")
_FIRST = ("hero", "definition-sketch", "sketch", "film")  # of their question, in this order
_ACROSS = 2  # thumbnails in a row
_THUMBNAIL, _LARGE = 420, 840  # pixels
_OTHER = "Other pictures"


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`; captions are in the pictures, commands in the folders below it.

    Raises InputError where `folder` is none.
    """
    root = path_of("DIR", folder)
    if not root.is_dir():
        raise InputError(f"{root}: is no folder; give the one that holds the results")
    parts = [path for path in sorted(root.iterdir()) if path.is_dir()]
    lines = [
        "# Results",
        "",
        "Small, committed, each made by the command beside it. This page is made by `nearflat gallery`. A click",
        "on a picture shows it in full size.",
    ]
    for question, shown in _by_question(root, parts).items():
        lines += ["", f"## {question}", ""]
        if shown and shown[0][0].stem == _FIRST[0]:
            lines += [*_one(root, parts, *shown.pop(0)), ""]
        lines += _table(root, parts, shown)
    lines += [
        "",
        "## All folders",
        "",
        "| folder | command |",
        "|---|---|",
        *(f"| [`{path.name}/`]({path.name}) | `{command_of(path)}` |" for path in parts),
    ]
    return "\n".join(lines) + "\n"


def _by_question(root: Path, parts: list[Path]) -> "dict[str, list[tuple[Path, Caption | None]]]":
    """Pictures below the folders by the question that they answer, in the order of a gallery."""
    from explorer.plot.captions import Question, caption_in

    pictures = sorted(picture for path in parts for kind in KINDS for picture in path.rglob(f"*.{kind}"))
    found: dict[str, list[tuple[Path, Caption | None]]] = {str(question): [] for question in Question}
    for picture in pictures:
        caption = caption_in(picture)
        found.setdefault(str(caption.question) if caption else _OTHER, []).append((picture, caption))
    for shown in found.values():
        shown.sort(key=lambda each: _rank(each[0], root))
    return {question: shown for question, shown in found.items() if shown}


def _rank(picture: Path, root: Path) -> tuple[int, str]:
    first = _FIRST.index(picture.stem) if picture.stem in _FIRST else len(_FIRST)
    return first, picture.relative_to(root).as_posix()


def _table(root: Path, parts: list[Path], shown: "list[tuple[Path, Caption | None]]") -> list[str]:
    """Thumbnails with captions, some to a row."""
    if not shown:
        return []
    lines = ["<table>"]
    for first in range(0, len(shown), _ACROSS):
        lines.append("<tr>")
        for picture, caption in shown[first : first + _ACROSS]:
            lines.append(f'<td width="{100 // _ACROSS}%" valign="top">')
            lines += [*_one(root, parts, picture, caption, _THUMBNAIL), "</td>"]
        lines.append("</tr>")
    return [*lines, "</table>"]


def _one(
    root: Path, parts: list[Path], picture: Path, caption: "Caption | None", width: int = _LARGE
) -> list[str]:
    """A picture that leads to its file, its caption, and the command that makes it; HTML, also inside a table."""
    where = picture.relative_to(root).as_posix()
    part = next(path for path in parts if picture.is_relative_to(path))
    text = html.escape(caption.text if caption else title_of(picture))
    command = html.escape(command_of(part, picture.name), quote=False)
    return [
        f'<a href="{where}"><img src="{where}" width="{width}" alt="{text}"></a><br>',
        f"{text}<br>",
        f"<code>{command}</code>",
    ]


def picture_lines(picture: Path, root: Path, width: int = 600) -> list[str]:
    """A picture with its caption for the page of `root`: what the page of one folder shows."""
    from explorer.plot.captions import caption_in

    caption = caption_in(picture)
    text = caption.text if caption else title_of(picture)
    where = picture.relative_to(root).as_posix()
    return [f'<img src="{where}" width="{width}" alt="{html.escape(text)}">', "", text]


def title_of(picture: Path) -> str:
    """What a picture without a caption is called: its own name, and its folder's where that tells more."""
    above = picture.parent if picture.parent.name != "figures" else picture.parent.parent
    return f"{above.name}, {picture.stem.replace('-', ' ')}"


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat gallery`."""
    command.add_argument("folder", nargs="?", default="results", metavar="DIR", help="folder (default results)")


def call(options: argparse.Namespace) -> int:
    page = Path(options.folder) / "README.md"
    text = gallery(options.folder)
    try:
        page.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{page}: cannot be written ({error.strerror}); give a folder that can") from None
    print(f"wrote {page}")
    return 0

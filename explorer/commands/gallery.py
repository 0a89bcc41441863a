"""`nearflat gallery`: the page of a folder of results by question, every picture with its caption and command.

A folder's own page says "Made by `COMMAND`"; a run says it in run.json.
"""

import argparse
import contextlib
import html
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from explorer.commands import Answer
from explorer.errors import InputError, RunError
from explorer.phase.paths import made_folder, path_of
from explorer.runs.folder import read_record

if TYPE_CHECKING:
    from explorer.pictures.register import Caption

KINDS = (".png", ".gif", ".webp")
_FIRST = ("hero", "definitions", "film")  # of their question, in this order
_OTHER = "Other pictures"
_EXIF_DESCRIPTION = 0x010E  # where WebP carries its caption


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`; captions are in the files, commands in the folders below it.

    Raises InputError where `folder` is none.
    """
    from explorer.pictures.register import Question

    root = path_of("DIR", folder)
    if not root.is_dir():
        raise InputError(f"{root}: is no folder; give the one that holds the results")
    parts = [path for path in sorted(root.iterdir()) if path.is_dir()]
    shown: dict[str, list[tuple[Path, str]]] = {str(question): [] for question in (*Question, _OTHER)}
    for part in parts:
        for picture in sorted(path for path in part.rglob("*") if path.suffix in KINDS):
            if picture.suffix == ".png" and picture.with_suffix(".webp").exists():
                continue  # the same that moves is shown
            caption = caption_in(picture)
            full = full_size(picture).relative_to(root).as_posix()
            cell = [f'<a href="{full}">{_image(picture, root, caption, 420)}</a>']
            cell += [_text(picture, caption), f"<code>{html.escape(command_of(part), quote=False)}</code>"]
            shown[str(caption.question) if caption else _OTHER].append((picture, "<br>\n".join(cell)))
    lines = [
        "# Results",
        "",
        "Each picture is made by the command beside it, and this page by `nearflat gallery`. Click a picture to",
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
    lines += [f"| [`{path.name}/`]({path.name}) | `{command_of(path)}` |" for path in parts]
    return "\n".join(lines) + "\n"


def command_of(folder: Path) -> str:
    """The command that made a folder, as its page or its run says it."""
    page = folder / "README.md"
    if page.is_file() and (said := re.search(r"^Made by `(.+?)`", page.read_text("utf-8"), re.MULTILINE)):
        return said[1]
    with contextlib.suppress(InputError, RunError):
        record = read_record(folder)
        return str(
            record["command"] or f"ex.run({record['options']['scene']!r}, ...), with the options in run.json"
        )
    return "not known"


def full_size(picture: Path) -> Path:
    """The file that shows a picture in its full size: of a film its WebM, of a picture that moves its still."""
    larger = {".gif": ".webm", ".webp": ".png"}.get(picture.suffix, picture.suffix)
    return there if (there := picture.with_suffix(larger)).exists() else picture


def caption_in(path: Path) -> "Caption | None":
    """The caption inside a picture or a film, a question and a text; None where there is none."""
    from PIL import Image, UnidentifiedImageError

    from explorer.pictures.register import Caption, Question

    try:
        with Image.open(path) as picture:
            found = picture.info.get("Description") or picture.info.get("comment")
            # Pillow reads what EXIF holds as Latin-1.
            found = found or picture.getexif().get(_EXIF_DESCRIPTION, "").encode("latin-1")
    except (OSError, UnidentifiedImageError):
        return None
    question, _, text = (found.decode("utf-8") if isinstance(found, bytes) else str(found)).partition("\n")
    return Caption(Question(question), text) if question in set(Question) else None


def picture_lines(picture: Path, root: Path) -> list[str]:
    """A picture with its caption for the page of `root`."""
    caption = caption_in(picture)
    image, full = _image(picture, root, caption, 600), full_size(picture)
    shown = image if full == picture else f'<a href="{full.relative_to(root).as_posix()}">{image}</a>'
    return [shown, "", caption.text if caption else _text(picture, None)]


def write_page(folder: Path, title: str, made_by: str, parts: Iterable[tuple[str, list[str], list[Path]]]) -> None:
    """Write the README.md of a folder. parts: heading, lines of text, and pictures, which bring their captions."""
    lines = [f"# {title}", "", f"Made by {made_by}"]
    for heading, text, pictures in parts:
        lines += ["", f"## {heading}", "", *text]
        lines += [line for picture in pictures for line in ("", *picture_lines(picture, folder))]
    (folder / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _image(picture: Path, root: Path, caption: "Caption | None", width: int) -> str:
    text = _text(picture, caption)
    return f'<img src="{picture.relative_to(root).as_posix()}" width="{width}" alt="{text}">'


def _text(picture: Path, caption: "Caption | None") -> str:
    """What is said of a picture: its caption, or its own name with its folder's."""
    above = picture.parent.parent if picture.parent.name == "figures" else picture.parent
    return html.escape(caption.text if caption else f"{above.name}, {picture.stem.replace('-', ' ')}")


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat gallery`."""
    command.add_argument("folder", nargs="?", default="results", metavar="DIR", help="folder (default results)")


def call(options: argparse.Namespace) -> Answer:
    """Write the page."""
    page = Path(options.folder) / "README.md"
    text = gallery(options.folder)
    made_folder("DIR", page.parent)
    page.write_text(text, encoding="utf-8")
    return Answer({"page": str(page)}, f"wrote {page}")

"""The page of a folder of results: every picture with the command that makes it."""

import re
from pathlib import Path

from explorer.errors import InputError

_MADE_BY = re.compile(r"Made by `([^`]+)`")
_WIDTH = 600


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`, from what commands have written into the folders below it.

    A page in a folder says in its first lines by what it was made. Raises InputError where one does not.
    """
    root = Path(folder)
    if not root.is_dir():
        raise InputError(f"{root}: is no folder; give the one that holds the results")
    parts = [(path, command_of(path)) for path in sorted(root.iterdir()) if path.is_dir()]
    lines = [
        "# Results",
        "",
        "Small, committed, each made by the command beside it. This page is made by `nearflat gallery`.",
        "",
        "| folder | command |",
        "|---|---|",
        *(f"| [`{path.name}/`]({path.name}) | `{command}` |" for path, command in parts),
    ]
    for path, command in parts:
        pictures = sorted(found for kind in ("png", "gif") for found in path.rglob(f"*.{kind}"))
        if pictures:
            lines += ["", f"## {path.name}", "", f"`{command}`"]
        for picture in pictures:
            where = picture.relative_to(root).as_posix()
            lines += [
                "",
                f"{_title(picture)}:",
                "",
                f'<img src="{where}" width="{_WIDTH}" alt="{_title(picture)}">',
            ]
    return "\n".join(lines) + "\n"


def _title(picture: Path) -> str:
    """What a picture is called: its own name, and its folder's where that tells more."""
    above = picture.parent if picture.parent.name != "figures" else picture.parent.parent
    return f"{above.name}, {picture.stem.replace('-', ' ')}"


def command_of(folder: Path) -> str:
    """The command that made a folder, from the pages in it. Raises InputError where none says so."""
    for page in sorted(folder.glob("*.md")):
        found = _MADE_BY.search(page.read_text(encoding="utf-8"))
        if found:
            return found[1]
    raise InputError(f"{folder}: no page in it says `Made by`; make it again, or take it out")

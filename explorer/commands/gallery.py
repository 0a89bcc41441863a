"""The page of a folder of results: every picture with the command that makes it."""

import json
import re
from pathlib import Path

from explorer.errors import InputError

_COMMAND = re.compile(r"^`(nearflat [^`]+)`$", re.MULTILINE)
_MADE_BY = re.compile(r"Made by `([^`]+)`")
_WIDTH = 600


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`, from what commands have written into the folders below it.

    The pages in a folder say by what it was made, and what made each picture; a run says it in run.json.
    Raises InputError where `folder` is none.
    """
    root = Path(folder)
    if not root.is_dir():
        raise InputError(f"{root}: is no folder; give the one that holds the results")
    parts = [path for path in sorted(root.iterdir()) if path.is_dir()]
    lines = [
        "# Results",
        "",
        "Small, committed, each made by the command beside it. This page is made by `nearflat gallery`.",
        "",
        "| folder | command |",
        "|---|---|",
        *(f"| [`{path.name}/`]({path.name}) | `{command_of(path)}` |" for path in parts),
    ]
    for path in parts:
        pictures = sorted(found for kind in ("png", "gif") for found in path.rglob(f"*.{kind}"))
        if pictures:
            lines += ["", f"## {path.name}"]
        for picture in pictures:
            where, name = picture.relative_to(root).as_posix(), _title(picture)
            lines += ["", f"{name}: `{command_of(path, picture.name)}`", ""]
            lines.append(f'<img src="{where}" width="{_WIDTH}" alt="{name}">')
    return "\n".join(lines) + "\n"


def _title(picture: Path) -> str:
    """What a picture is called: its own name, and its folder's where that tells more."""
    above = picture.parent if picture.parent.name != "figures" else picture.parent.parent
    return f"{above.name}, {picture.stem.replace('-', ' ')}"


def command_of(folder: Path, picture: str | None = None) -> str:
    """The command that made a folder, or a picture in it where a page tells that apart."""
    for page in sorted(folder.glob("*.md")):
        text = page.read_text(encoding="utf-8")
        found = _MADE_BY.search(text)
        if found is None:
            continue
        before = _COMMAND.findall(text.partition(picture)[0]) if picture and picture in text else []
        return before[-1] if before else found[1]
    record = folder / "run.json"
    if record.is_file():
        scene = json.loads(record.read_text(encoding="utf-8"))["identity"]["options"]["scene"]
        return f"nearflat run {scene}, with the options in run.json"
    return "not known"

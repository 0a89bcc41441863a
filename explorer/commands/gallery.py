"""`nearflat gallery`: the page of a folder of results, every picture with the command that makes it."""

import argparse
from pathlib import Path

from explorer.commands.made_by import command_of
from explorer.errors import InputError

_WIDTH = 600  # pixels


def gallery(folder: Path | str) -> str:
    """Markdown for the README.md of `folder`; commands are read from what they left in the folders below it.

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
        pictures = sorted(picture for kind in ("png", "gif") for picture in path.rglob(f"*.{kind}"))
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


def add_arguments(command: argparse.ArgumentParser) -> None:
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

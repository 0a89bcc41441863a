"""`nearflat portrait`: the pictures that the paper does not have, each group made by one command.

Which pictures a group has stands with the pictures; those of the group phase are of scene portrait.
The hero and the film are recorded from the page in a browser.
"""

import argparse
from functools import partial
from pathlib import Path

from explorer.commands import Answer
from explorer.errors import InputError, note, one_of
from explorer.paths import own_folder
from explorer.phase.disk import Disk
from explorer.scenes.options import DISK, FOLDER, Options, Reader, option
from explorer.scenes.portrait import Portrait

RECORDED = "hero", "film"
# Those of the pictures, by what they answer; here too, so that help need not load all of these
GROUPS = (
    *RECORDED,
    *("definitions", "slices", "surface", "limit", "race", "bounces", "phase", "bifurcation", "rotation", "paths"),
)


class Drawn(Options):
    """What is drawn, and where it goes."""

    disk: Disk | None = option(
        DISK,
        "as for run",
        words="uniform; but the pictures hero and film show a disk with kappa = 2.5, which rises in opposite "
        "places on the two sides of F",
    )
    only: str | None = option(
        Reader(partial(one_of, known=GROUPS), "GROUP", "str"),
        f"one group of pictures: {', '.join(GROUPS)}",
        words="all",
    )
    out: Path = option(FOLDER, "folder", default=Path("results/portrait"))


add_arguments = Drawn.add_to


def call(options: argparse.Namespace) -> Answer:
    """Draw all groups of pictures, or one, into a folder, and say how many files there are.

    Raises InputError for the hero or the film alone where there is no browser.
    """
    from explorer.commands.pages import write_page
    from explorer.view import record
    from explorer.view.browser import find

    asked = Drawn.of(Drawn.said(options))
    folder, files, disk = asked.out, list[Path](), asked.disk or Disk.uniform()
    scene = Portrait.of({"disk": disk})
    groups = [asked.only] if asked.only else GROUPS
    try:
        if set(groups) & set(RECORDED):
            find()
    except InputError as error:
        if asked.only:
            raise
        note(f"without {' and '.join(RECORDED)}, which are recorded in a browser: {error}", quiet=False)
        groups = [group for group in GROUPS if group not in RECORDED]
    command = "nearflat portrait" + (f" --only {asked.only}" if asked.only else "")
    parts = list[tuple[str, list[str], list[Path]]]()
    own_folder("out", folder)
    for group in groups:
        note(f"drawing {group}", options.quiet)
        recorded = group in RECORDED
        drawn = [record.record(group, folder, asked.disk)] if recorded else _group(folder, group, scene)
        parts.append((group.capitalize(), [f"`nearflat portrait --only {group}`"], drawn))
        files += drawn
    write_page(folder, f"Portraits of the {disk.name} disk", f"`{command}`.", parts)
    return Answer({"files": [str(path) for path in files]}, f"{len(files)} files are in {folder}.")


def _group(folder: Path, group: str, scene: Portrait) -> list[Path]:
    """Draw a group as PNG and SVG; the files that a page shows."""
    from explorer.pictures.calls import portraits_of
    from explorer.pictures.register import save

    files = []
    for name, draw in portraits_of(group, scene):
        figure = draw()
        for kind in ("svg", "png"):
            save(figure, folder / f"{name}.{kind}")
        files.append(folder / f"{name}.png")
    return files

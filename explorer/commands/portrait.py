"""`nearflat portrait`: the pictures that the paper does not have, each group made by one command.

Which pictures a group has stands with the pictures; those of the group phase take the options of scene portrait.
"""

import argparse
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from explorer.commands import Answer
from explorer.errors import InputError, note, one_of
from explorer.phase.disk import Disk
from explorer.phase.paths import made_folder
from explorer.scenes.options import DISK, FOLDER, Options, Reader, option, options_of
from explorer.scenes.portrait import Portrait
from explorer.scenes.scene import Scene

FILM = "film"  # written as it is drawn, not a figure
# Those of the pictures, by what they answer; here too, so that help need not load all of these
GROUPS = (
    *("definitions", "hero", "slices", "surface", "limit", "race", "bounces", "phase", "bifurcation", "rotation"),
    *("paths", FILM),
)


class Drawn(Options):
    """What is drawn, and where it goes."""

    disk: Disk = option(DISK, "as for run", default=Disk.uniform())
    only: str | None = option(
        Reader(partial(one_of, known=GROUPS), "GROUP", "str"),
        f"one group of pictures: {', '.join(GROUPS)}",
        words="all",
    )
    out: Path = option(FOLDER, "folder", default=Path("results/portrait"))


_OF_PHASE = {each.name for each in options_of(Portrait)} - {each.name for each in options_of(Scene)}


def portrait(asked: Drawn, given: dict[str, Any], quiet: bool = True) -> list[Path]:
    """Draw all groups of pictures, or one, into a folder; returns the files.

    given, for the group phase, as for scene portrait: sigma3_bar, sigma4_bar or eta_hat, energy, well. Raises
    InputError where they cannot be used.
    """
    from explorer.commands.gallery import picture_lines

    folder, files = asked.out, list[Path]()
    if given and asked.only not in (None, "phase"):
        names = ", ".join(f"--{key.replace('_', '-')}" for key in given)
        raise InputError(f"{names}: only the group phase takes this; leave it out, or --only phase")
    # What the options do not allow is said before anything is written.
    scene = Portrait.of({**given, "disk": asked.disk})
    command = "nearflat portrait" + (f" --only {asked.only}" if asked.only else "")
    lines = [f"# Portraits of the {asked.disk.name} disk", "", f"Made by `{command}`."]
    made_folder("--out", folder)
    for group in [asked.only] if asked.only else GROUPS:
        note(f"drawing {group}", quiet)
        drawn = _film(folder, asked.disk) if group == FILM else _group(folder, group, scene)
        lines += ["", f"## {group.capitalize()}", "", f"`nearflat portrait --only {group}`"]
        lines += [line for path in drawn for line in ("", *picture_lines(path, folder))]
        files += drawn
    (folder / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return files


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


def _film(folder: Path, disk: Disk) -> list[Path]:
    """Write the film, small for pages and large for talks; the small one."""
    from explorer.pictures import film

    small, large = (folder / f"{FILM}.{kind}" for kind in ("gif", "webp"))
    for path in (small, large):
        film.animate(path, disk)
    return [small]


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat portrait`: those of its pictures, and of scene portrait for the group phase."""
    Drawn.add_to(command)
    Portrait.add_to(command, _OF_PHASE)


def call(options: argparse.Namespace) -> Answer:
    """Draw, and say how many there are."""
    asked = Drawn.of(Drawn.said(options))
    given = {name: value for name, value in Portrait.said(options).items() if name in _OF_PHASE}
    files = [str(path) for path in portrait(asked, given, options.quiet)]
    return Answer({"files": files}, f"{len(files)} pictures are in {asked.out}.")

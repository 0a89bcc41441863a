"""`nearflat portrait`: the pictures that the paper does not have, each group made by one command.

Which pictures a group has stands with the pictures; what they are drawn of is a `Portrait`.
The hero and the film are recorded from the page in a browser.
"""

import argparse
import shlex
from functools import partial
from pathlib import Path

from explorer.commands import Answer
from explorer.errors import InputError, note, one_of
from explorer.paths import own_folder
from explorer.phase.disk import Disk
from explorer.phase.portrait import Portrait
from explorer.scenes.options import DISK, FOLDER, NUMBER, RANGE, Options, Reader, option

RECORDED = "hero", "film"
# Those of the pictures, by what they answer; here too, so that help need not load all of these
GROUPS = (
    *RECORDED,
    *("definitions", "slices", "surface", "limit", "race", "bounces", "phase", "bifurcation", "rotation", "paths"),
)
_PHASE = "with --only phase, in the units of the disk:"


class PortraitOptions(Options):
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
    sigma3_bar: float | None = option(
        NUMBER, f"{_PHASE} constant of motion", words="0.25 natural units, or less if l_+ has no well there"
    )
    sigma4_bar: float | None = option(NUMBER, f"{_PHASE} the other constant, instead of eta_hat")
    eta_hat: float | None = option(
        NUMBER, f"{_PHASE} signed distance from F on face +1", words="three: 0, and one on each side"
    )
    energy: tuple[float, float] | None = option(RANGE, f"{_PHASE} range of the energies whose curves are shown")
    out: Path = option(FOLDER, "folder", default=Path("results/portrait"))


add_arguments = PortraitOptions.add_to


def call(options: argparse.Namespace) -> Answer:
    """Draw all groups of pictures, or one, into a folder; give the files, and the numbers of the group phase.

    Raises InputError for the hero or the film alone where there is no browser, and for options of the group phase
    without it.
    """
    from explorer.commands.pages import write_page
    from explorer.view import record
    from explorer.view.browser import find

    said = PortraitOptions.said(options)
    asked = PortraitOptions.of(said)
    folder, files, disk = asked.out, list[Path](), asked.disk or Disk.uniform()
    of_phase = {name: getattr(asked, name) for name in ("sigma3_bar", "sigma4_bar", "eta_hat", "energy")}
    for name in of_phase:
        if name in said and asked.only != "phase":
            raise InputError(f"{name} {said[name]}: is for the group phase; add --only phase, or leave it out")
    portrait = Portrait(disk, **of_phase)
    groups = [asked.only] if asked.only else GROUPS
    try:
        if set(groups) & set(RECORDED):
            find()
    except InputError as error:
        if asked.only:
            raise
        note(f"without {' and '.join(RECORDED)}, which are recorded in a browser: {error}", quiet=False)
        groups = [group for group in GROUPS if group not in RECORDED]
    only = f" --only {asked.only}" if asked.only else ""
    flags = {f"--{name.replace('_', '-')}": said[name] for name in ("disk", *of_phase) if name in said}
    given = "".join(f" {flag} {shlex.quote(text)}" for flag, text in flags.items())
    parts = list[tuple[str, list[str], list[Path]]]()
    own_folder("out", folder)
    for group in groups:
        note(f"drawing {group}", options.quiet)
        recorded = group in RECORDED
        drawn = [record.record(group, folder, asked.disk)] if recorded else _group(folder, group, portrait)
        parts.append((group.capitalize(), [f"`nearflat portrait --only {group}{given}`"], drawn))
        files += drawn
    write_page(folder, f"Portraits of the {disk.name} disk", f"`nearflat portrait{only}{given}`.", parts)
    numbers = portrait.describe() if "phase" in groups else {}
    return Answer({"files": [str(path) for path in files], **numbers}, f"{len(files)} files are in {folder}.")


def _group(folder: Path, group: str, portrait: Portrait) -> list[Path]:
    """Draw a group as PNG and SVG; the files that a page shows."""
    from explorer.pictures.calls import portraits_of
    from explorer.pictures.register import save

    files = []
    for name, draw in portraits_of(group, portrait):
        figure = draw()
        for kind in ("svg", "png"):
            save(figure, folder / f"{name}.{kind}")
        files.append(folder / f"{name}.png")
    return files

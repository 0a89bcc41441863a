"""The commands `nearflat paper`, `nearflat portrait` and `nearflat gallery`."""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from explorer.commands.runs import add_json
from explorer.errors import InputError


def add_commands(commands: Any, add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the three commands. add: the `_add` of `explorer.commands.main`."""
    command = add(
        commands,
        "paper",
        _paper,
        "Check every statement of the paper, draw its figures, list its misprints; exit status 1 if a row fails.",
        "nearflat paper --only LEMMA-5",
    )
    command.add_argument("--only", metavar="NAME", help="one statement, by name or number; writes nothing")
    command.add_argument("--out", default="results/paper", metavar="DIR", help="default results/paper")
    command.add_argument("--jobs", type=int, default=2, metavar="N", help="threads (default 2)")
    add_json(command)
    command = add(
        commands,
        "portrait",
        _portrait,
        "Draw phase portraits, steady motions, slices, race numbers, bounces, paths and a film.",
        "nearflat portrait --disk hoop --only paths",
    )
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    command.add_argument("--only", metavar="GROUP", help="phase, slices, race, bounces, paths or film")
    for flag, text in (
        ("--sigma3-bar", "phase: constant of motion, in the units of the disk"),
        ("--sigma4-bar", "phase: constant of motion, in the units of the disk"),
        ("--eta-hat", "phase: instead of sigma4_bar, the distance beside the line of face +1"),
        ("--energies", "phase: LOW:HIGH, the energies of the levels"),
    ):
        command.add_argument(flag, metavar="X", help=text)
    well = "phase: insist on a well beside the falling motions"
    command.add_argument("--well", action="store_const", const=True, help=well)
    command.add_argument("--out", default="results/portrait", metavar="DIR", help="default results/portrait")
    command = add(
        commands,
        "gallery",
        _gallery,
        "Write the page of a folder of results: every picture with the command that makes it.",
        "nearflat gallery results",
    )
    command.add_argument("folder", nargs="?", default="results", metavar="DIR", help="default results")


def _portrait(options: argparse.Namespace) -> int:
    from explorer.commands.portrait import portrait
    from explorer.phase.disk import Disk

    names = ("sigma3_bar", "sigma4_bar", "eta_hat", "energies", "well")
    given = {name: getattr(options, name) for name in names if getattr(options, name) is not None}
    disk = Disk.parse(options.disk)
    written = portrait(options.out, disk, only=options.only, quiet=options.quiet, **given)
    print(f"{len(written)} pictures are in {options.out}.")
    return 0


def _gallery(options: argparse.Namespace) -> int:
    from explorer.commands.gallery import gallery

    page = Path(options.folder) / "README.md"
    text = gallery(options.folder)
    try:
        page.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"{page}: cannot be written ({error.strerror})") from None
    print(f"wrote {page}")
    return 0


def _paper(options: argparse.Namespace) -> int:
    from explorer.paper.pages import headline, line_of, paper

    rows = paper(options.out, only=options.only, jobs=options.jobs, quiet=options.quiet)
    holding = sum(row.passed for row in rows)
    if options.json:
        counts = {"holding": holding, "failing": len(rows) - holding}
        print(json.dumps(counts | {"rows": [row.describe() for row in rows]}))
    else:
        if options.only is not None:
            for row in rows:
                print(f"{row.statement.number} {row.statement.name}: {row.statement.text}")
                for finding in row.findings:
                    print(line_of(finding))
        for line in headline(rows):
            print(line)
    return 0 if holding == len(rows) else 1

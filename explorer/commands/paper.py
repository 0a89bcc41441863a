"""`nearflat paper`: the paper as checks, figures and misprints."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

from explorer.commands.common import add_json
from explorer.commands.made_by import leave_made_by
from explorer.errors import InputError, jobs_of, note, number, positive, whole
from explorer.paper.figures import ETA_HAT
from explorer.paper.pages import headline, line_of, one_figure, paper
from explorer.phase.disk import Disk


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat paper`."""
    command.add_argument("--only", metavar="NAME", help="one statement, by name or number; nothing is written")
    command.add_argument("--figure", metavar="N", help="one figure, 1 to 9; no statement is checked")
    command.add_argument("--disk", metavar="DISK", help="with --figure: another body, as for run")
    command.add_argument(
        "--eta-hat", metavar="SIZE", help=f"with --figure: distance from F, in sqrt(g/r) (default {ETA_HAT:g})"
    )
    command.add_argument("--out", default="results/paper", metavar="DIR", help="default results/paper")
    command.add_argument("--jobs", default="2", metavar="N", help="threads (default 2)")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    if options.figure is not None:
        return _figure(options)
    for flag, value in (("--disk", options.disk), ("--eta-hat", options.eta_hat)):
        if value is not None:
            raise InputError(f"{flag} {value}: only with --figure; the statements are of the paper's bodies")
    rows = paper(options.out, only=options.only, jobs=jobs_of("--jobs", options.jobs), quiet=options.quiet)
    if options.only is None:
        leave_made_by(Path(options.out), "nearflat paper")
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


def _size(flag: str, given: str, quiet: bool) -> float:
    """A distance from F; its sign is said to mean nothing, since each figure has its own sides."""
    eta_hat = number(flag, given)
    if eta_hat < 0.0:
        note(f"{flag} {given}: the sign is left out; each figure shows its own sides of F", quiet)
    return positive(flag, abs(eta_hat))


def _figure(options: argparse.Namespace) -> int:
    """One figure, and nothing else."""
    if options.only is not None:
        raise InputError("--only and --figure: give one of them")
    disk = None if options.disk is None else Disk.parse(options.disk)
    which = whole("--figure", options.figure, 1, 9)
    eta_hat = ETA_HAT if options.eta_hat is None else _size("--eta-hat", options.eta_hat, options.quiet)
    note(f"drawing figure {which}; the first time, kernels are compiled", options.quiet)
    paths = one_figure(options.out, which, disk, eta_hat)
    if options.json:
        print(json.dumps({"files": [str(path) for path in paths]}))
    else:
        print("\n".join(f"wrote {path}" for path in paths))
    return 0

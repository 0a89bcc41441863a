"""`nearflat status`, `verify`, `resume`, `summary` and `merge`: commands about stored runs."""

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from explorer.commands.common import add_json, show
from explorer.runs.merge import merge
from explorer.runs.run import open
from explorer.runs.settings import Settings

_RESUME = ("jobs", "backend", "scheduler", "format", "figures")


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of the five commands."""
    if command.prog.endswith((" summary", " merge")):
        text = "folder of a run; several are added up, where they ask the same question with different seeds"
        command.add_argument("folder", metavar="DIR", type=Path, nargs="+", help=text)
    else:
        command.add_argument("folder", metavar="DIR", type=Path, help="folder of a run")
    if command.prog.endswith(" resume"):
        Settings.add_to(command, _RESUME)
    add_json(command)


def call(options: argparse.Namespace) -> int:
    each = {"status": _status, "verify": _verify, "resume": _resume, "summary": _summary, "merge": _summary}
    return each[options.command](options)


def _status(options: argparse.Namespace) -> int:
    far = open(options.folder).status
    if options.json:
        print(json.dumps(asdict(far)))
        return 0
    print(f"{far.scene}: {far.chunks_done} of {far.chunks} chunks, {far.samples_done:,} samples")
    for name, count in far.status.items():
        print(f"  {name}: {count:,}")
    if far.missing:
        print(f"missing: {', '.join(far.missing)}; continue with: nearflat resume {options.folder}")
    elif far.finished:
        print(f"finished {far.finished}")
    return 0


def _verify(options: argparse.Namespace) -> int:
    faults = open(options.folder).verify()
    if options.json:
        print(json.dumps({"intact": not faults, "faults": faults}))
    else:
        print(*faults, sep="\n", end="\n" if faults else "")
        print(f"mend what is wrong with: nearflat resume {options.folder}" if faults else "intact")
    return 1 if faults else 0


def _resume(options: argparse.Namespace) -> int:
    given = {name: getattr(options, name) for name in _RESUME if hasattr(options, name)}
    return show(open(options.folder).resume(**given, progress=False if options.quiet else None), options.json)


def _summary(options: argparse.Namespace) -> int:
    runs = [open(folder) for folder in options.folder]
    run = runs[0].renewed() if len(runs) == 1 else merge(*runs)
    print(json.dumps(run.summary) if options.json else "\n".join(run.scene.headline(run.summary)))
    return 0

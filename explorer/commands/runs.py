"""`nearflat status`, `verify`, `resume` and `summary`: commands that look at a stored run or go on with it."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from explorer.commands.common import add_json, show
from explorer.commands.run import add_figures, add_settings
from explorer.runs.folder import scene_of
from explorer.runs.inspect import status, summary, verify
from explorer.runs.merge import merge
from explorer.runs.run import Run, execute, open
from explorer.runs.settings import asked

_RESUME = ("jobs", "backend", "scheduler", "format")


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of the four commands."""
    if command.prog.endswith(" summary"):
        text = "folder of a run; several are added up, where they ask the same question with different seeds"
        command.add_argument("folder", metavar="DIR", type=Path, nargs="+", help=text)
    else:
        command.add_argument("folder", metavar="DIR", type=Path, help="folder of a run")
    if command.prog.endswith(" resume"):
        add_settings(command, _RESUME)
        add_figures(command)
    add_json(command)


def call(options: argparse.Namespace) -> int:
    each = {"status": _status, "verify": _verify, "resume": _resume, "summary": _summary}
    return each[options.command](options)


def _status(options: argparse.Namespace) -> int:
    far = status(options.folder)
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
    faults = verify(options.folder)
    if options.json:
        print(json.dumps({"intact": not faults, "faults": faults}))
    else:
        for fault in faults:
            print(fault)
        many = f"mend what is wrong with: nearflat resume {options.folder}"
        print(many if faults else "intact")
    return 1 if faults else 0


def _resume(options: argparse.Namespace) -> int:
    given = {word: getattr(options, word) for word in (*_RESUME, "figures")}
    scene = scene_of(options.folder)
    run = {"out": options.folder, "progress": False if options.quiet else None}
    manner = asked(scene, {**given, **run}).manner
    return show(execute(scene, options.folder, manner), options.json)


def _summary(options: argparse.Namespace) -> int:
    numbers, run = _added_up(options.folder)
    if options.json:
        print(json.dumps(numbers))
    else:
        print("\n".join(run.scene.headline(numbers)))
    return 0


def _added_up(folders: list[Path]) -> tuple[dict[str, Any], Run]:
    """The numbers of a run, added up anew and stored; or of several together."""
    if len(folders) == 1:
        return summary(folders[0]), open(folders[0])
    run = merge(*map(open, folders))
    return run.summary, run

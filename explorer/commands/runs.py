"""`nearflat status`, `verify`, `resume` and `summary`: commands that look at a stored run or go on with it."""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from explorer.commands.common import add_json, add_workers, show
from explorer.runs.folder import scene_of
from explorer.runs.inspect import status, summary, verify
from explorer.runs.run import execute
from explorer.runs.workers import Workers


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of the four commands."""
    command.add_argument("folder", metavar="DIR", type=Path, help="folder of a run")
    if command.prog.endswith(" resume"):
        add_workers(command)
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
    if far.chunks_done < far.chunks:
        print(f"continue with: nearflat resume {options.folder}")
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
        many = f"{len(faults)} faults; mend them with: nearflat resume {options.folder}"
        print(many if faults else "intact")
    return 1 if faults else 0


def _resume(options: argparse.Namespace) -> int:
    given = {key: getattr(options, key) for key in ("jobs", "backend", "scheduler")}
    workers = Workers(**{key: value for key, value in given.items() if value is not None})
    done = execute(scene_of(options.folder), options.folder, workers=workers, resume=True, quiet=options.quiet)
    return show(done, options.json)


def _summary(options: argparse.Namespace) -> int:
    numbers = summary(options.folder)
    if options.json:
        print(json.dumps(numbers))
    else:
        print("\n".join(scene_of(options.folder).headline(numbers)))
    return 0

"""Commands that look at a stored run or go on with it: status, verify, resume, summary."""

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any


def add_commands(commands: Any, add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the four commands. add: as explorer.commands.main._add."""
    described = (
        ("status", _status, "Say how far a stored run is."),
        ("verify", _verify, "Check every chunk of a stored run; exit status 1 if one is bad."),
        ("resume", _resume, "Go on with a stored run: compute what is missing or bad, nothing else."),
        ("summary", _summary, "Add up the numbers of a stored run anew, from its chunks."),
    )
    for name, call, text in described:
        command = add(commands, name, call, text, f"nearflat {name} results/race-angles-uniform-0")
        command.add_argument("folder", metavar="DIR", help="folder of a run")
        if name == "resume":
            add_workers(command)
        add_json(command)


def add_json(command: argparse.ArgumentParser) -> None:
    """The option of every command that prints a result."""
    command.add_argument("--json", action="store_true", help="print one JSON object on stdout")


def add_workers(command: argparse.ArgumentParser) -> None:
    """Options that say who computes."""
    command.add_argument("--jobs", type=int, metavar="N", help="workers (default 2)")
    command.add_argument("--backend", metavar="NAME", help="threads, processes or dask (default threads)")
    command.add_argument("--scheduler", metavar="ADDRESS", help="of a dask scheduler (default: one of its own)")


def _status(options: argparse.Namespace) -> int:
    from explorer.runs.inspect import status

    found = asdict(status(Path(options.folder)))
    if options.json:
        print(json.dumps(found))
        return 0
    print(
        f"{found['scene']}: {found['chunks_done']} of {found['chunks']} chunks, {found['samples_done']:,} samples"
    )
    for name, count in found["status"].items():
        print(f"  {name}: {count:,}")
    if found["finished"]:
        print(f"finished {found['finished']}")
    elif found["chunks_done"] < found["chunks"]:
        print(f"continue with: nearflat resume {options.folder}")
    return 0


def _verify(options: argparse.Namespace) -> int:
    from explorer.runs.inspect import verify

    faults = verify(Path(options.folder))
    if options.json:
        print(json.dumps({"intact": not faults, "faults": faults}))
    else:
        for fault in faults:
            print(fault)
        print("intact" if not faults else f"{len(faults)} found; mend with: nearflat resume {options.folder}")
    return 1 if faults else 0


def _resume(options: argparse.Namespace) -> int:
    from explorer.runs.folder import scene_of
    from explorer.runs.run import execute
    from explorer.runs.workers import Workers

    folder = Path(options.folder)
    workers = Workers(options.jobs or 2, options.backend or "threads", options.scheduler)
    done = execute(scene_of(folder), folder, workers=workers, resume=True, quiet=options.quiet)
    return show(done, options.json)


def _summary(options: argparse.Namespace) -> int:
    from explorer.runs.folder import scene_of
    from explorer.runs.inspect import summary

    folder = Path(options.folder)
    found = summary(folder)
    if options.json:
        print(json.dumps(found))
    else:
        print("\n".join(scene_of(folder).headline(found)))
    return 0


def show(done: Any, as_json: bool) -> int:
    """Print a finished run."""
    if as_json:
        print(json.dumps(done.summary))
        return 0
    for line in done.scene.headline(done.summary):
        print(line)
    print(f"Samples, numbers and pictures are in {done.folder}.")
    return 0

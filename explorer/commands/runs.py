"""`nearflat status`, `verify`, `resume`, `summary` and `merge`: commands about stored runs."""

import argparse
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from explorer.commands import Answer
from explorer.commands.run import shown
from explorer.errors import note
from explorer.paths import command_line
from explorer.runs.merge import merge
from explorer.runs.run import open
from explorer.runs.settings import Making
from explorer.runs.store import write_json


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of the five commands."""
    if command.prog.endswith((" summary", " merge")):
        text = "folder of a run; several that ask the same question with different seeds are added up"
        command.add_argument("folder", metavar="DIR", type=Path, nargs="+", help=text)
    else:
        command.add_argument("folder", metavar="DIR", type=Path, help="folder of a run")
    command.add_argument("--trust", action="store_true", help="run the file of an own scene that run.json names")
    if command.prog.endswith(" resume"):
        Making.add_to(command)


def call(options: argparse.Namespace) -> Answer:
    """Do what the command is called."""
    each = {"status": _status, "verify": _verify, "resume": _resume, "summary": _summary, "merge": _summary}
    return each[options.command](options)


def _status(options: argparse.Namespace) -> Answer:
    far = open(options.folder).status
    lines = [f"{far.scene}: {far.chunks_done} of {far.chunks} chunks, {far.samples_done:,} samples"]
    lines += [f"  {name}: {count:,}" for name, count in far.status.items()]
    if far.missing:
        lines += [f"missing: {', '.join(far.missing)}; continue with: {command_line('resume', options.folder)}"]
    elif far.finished:
        lines += [f"finished {far.finished}"]
    return Answer(asdict(far), "\n".join(lines))


def _verify(options: argparse.Namespace) -> Answer:
    run = open(options.folder, trust=options.trust)
    faults = run.verify()
    lines = faults or ["intact"]
    if faults and not run.changed():  # what was changed says itself what can be done
        lines = [*faults, f"to repair this: {command_line('resume', options.folder)}"]
    return Answer({"intact": not faults, "faults": faults}, "\n".join(lines), int(bool(faults)))


def _resume(options: argparse.Namespace) -> Answer:
    run = open(options.folder, trust=options.trust)
    return shown(run.resume(**Making.said(options), progress=not options.quiet))


def _summary(options: argparse.Namespace) -> Answer:
    runs = [open(folder, trust=options.trust) for folder in options.folder]
    run = runs[0] if len(runs) == 1 and options.command == "summary" else merge(*runs)
    if run.folder is not None:
        write_json(run.folder / "summary.json", run.summary)
    for each in run.changed():
        note(f"the summary is by what is here now: {each}", options.quiet)
    return Answer(run.summary, "\n".join(run.headline))

"""`nearflat run`, and what all commands about a scene share: its name, its options, and how a run is shown."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explorer.commands import Answer
from explorer.errors import InputError
from explorer.runs.settings import Settings, asked
from explorer.scenes.options import first_line, key_of, names_of, options_of
from explorer.scenes.scene import NAMES, Scene, read_scene_file, scene_class

if TYPE_CHECKING:
    from explorer.runs.run import Run


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the scene with its options, and those of its run; also of `nearflat plan`."""
    text = f"{', '.join(NAMES)}, a TOML file that names a scene and sets options, or FILE.py:CLASS, your own"
    command.add_argument("scene", metavar="SCENE", help=text)
    command.usage = f"{command.prog} SCENE [option ...]"
    kind, first = Scene, words[0] if words else ""
    if first.startswith("-"):
        if not {"-h", "--help"} & {*words}:
            raise InputError(f"scene: comes before its options; write {command.prog} SCENE {first} ...")
    elif first:
        kind = scene_class(read_scene_file(Path(first))["scene"] if first.endswith(".toml") else first)
        command.description = f"{command.description} {first_line(kind)}"
        command.prog = f"{command.prog} {first}"
        command.epilog = f"example: {command.prog} --disk hoop --out results/mine"
    kind.add_to(command)
    Settings.add_to(command)
    which = command.add_mutually_exclusive_group()
    for exist, text in (
        ("resume", "continue the run in --out, or start it where there is none"),
        ("replace", "compute the run in --out anew; the existing one is deleted"),
    ):
        which.add_argument(
            f"--{exist}", dest="exist", action="store_const", const=exist, default=argparse.SUPPRESS, help=text
        )


def given_by(options: argparse.Namespace) -> tuple[Any, dict[str, Any]]:
    """Scene and keywords from a command line, and from a TOML file where one is named; the command line wins."""
    name, given = options.scene, dict[str, Any]()
    if name.endswith(".toml"):
        given = read_scene_file(Path(name))
        name = given.pop("scene")
        if "exist" in given:
            raise InputError(f"{options.scene}: exist is no option of a file; give --resume or --replace")
    kind = scene_class(name)
    said = kind.said(options) | Settings.said(options)
    for each in options_of(kind):
        if each.name in said:
            for other in (key_of(each), *names_of(each)):  # the same option
                given.pop(other, None)
    return name, given | said | ({"progress": False} if options.quiet else {})


def shown(run: "Run") -> Answer:
    """A finished run."""
    lines = [*run.headline, *([f"All of it is in {run.folder}."] if run.folder else [])]
    return Answer(run.summary, "\n".join(lines))


def call(options: argparse.Namespace) -> Answer:
    """Run the scene."""
    from explorer.runs.run import execute

    name, given = given_by(options)
    return shown(execute(*asked(name, {"exist": "error", **given}, options.command_line)))

"""`nearflat run`, and what all commands about a scene share: how it is named, its options, and how a run is shown.

Arrow is loaded when a run is made: `nearflat plan` does without.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explorer.commands import Answer
from explorer.errors import InputError
from explorer.runs.settings import Settings, asked
from explorer.scenes.options import first_line, key_of, options_of
from explorer.scenes.scene import NAMES, Scene, read_scene_file, scene_class

if TYPE_CHECKING:
    from explorer.runs.run import Run

_APART = ("scene", "command", "command_line", "call", "json", "quiet")  # which are no options of a run


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
        command.epilog = f"example: {command.prog} {first} --disk hoop --out results/mine"
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
    given: dict[str, Any] = {"scene": options.scene}
    said = {key: value for key, value in vars(options).items() if key not in _APART and value is not None}
    if str(options.scene).endswith(".toml"):
        given = read_scene_file(Path(options.scene))
        for each in options_of(scene_class(given["scene"])):
            if each.name in said:
                given.pop(key_of(each), None)  # the same option, as run.json calls it
    given |= said
    if options.quiet:
        given["progress"] = False
    return given.pop("scene"), given


def shown(run: "Run") -> Answer:
    """A finished run."""
    lines = [*run.headline, *([f"All of it is in {run.folder}."] if run.folder else [])]
    return Answer(run.summary, "\n".join(lines))


def call(options: argparse.Namespace) -> Answer:
    """Run the scene."""
    from explorer.runs.run import execute

    name, given = given_by(options)
    return shown(execute(*asked(name, {"exist": "error", **given}, options.command_line)))

"""What several commands share: options that are printed or read in one way, and how a finished run is shown."""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explorer.errors import InputError
from explorer.runs.settings import Settings
from explorer.scenes.options import Options, options_of
from explorer.scenes.registry import NAMES, read_scene_file, scene_class
from explorer.scenes.scene import Scene

if TYPE_CHECKING:
    from explorer.runs.run import Run

_APART = ("scene", "command", "command_line", "call", "json", "quiet", "no_store")  # which are no options of a run


def add_json(command: argparse.ArgumentParser) -> None:
    """Add the option of every command that prints a result."""
    command.add_argument("--json", action="store_true", help="print one JSON object on stdout and nothing else")


def add_scene(command: argparse.ArgumentParser, words: Sequence[str], text: str = "", **how: Any) -> type[Scene]:
    """Add the scene that a command is about, and return its class; that of all scenes where none is named."""
    names = f"{', '.join(NAMES)}, a TOML file that names a scene and sets options, or FILE.py:CLASS, your own"
    command.add_argument("scene", metavar="SCENE", help=names + text, **how)
    for word in words:
        if word.endswith(".py"):
            raise InputError(f"scene {word}: name its class too, as in {word}:Scene")
    named = next((word for word in words if word in NAMES or word.endswith(".toml") or ".py:" in word), None)
    if named is None:
        return Scene
    return scene_class(read_scene_file(Path(named))["scene"] if named.endswith(".toml") else named)


def add_question(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the scene with its options, and those of its run."""
    kind = add_scene(command, words)
    command.description = f"{command.description} {(kind.__doc__ or '').partition(chr(10))[0]}"
    if kind is not Scene:
        own = [word for word in words if ".py:" in word]  # a scene of the user's has no other name here
        command.epilog = f"example: {command.prog} {[*own, kind.name][0]} --disk hoop --out results/mine"
    kind.add_to(command)
    Settings.add_to(command)
    which = command.add_mutually_exclusive_group()
    for exist, text in (
        ("resume", "continue the run in --out, or start it where there is none"),
        ("replace", "compute the run in --out anew; the one that is there is lost"),
    ):
        which.add_argument(
            f"--{exist}", dest="exist", action="store_const", const=exist, default=argparse.SUPPRESS, help=text
        )


def given_by(options: argparse.Namespace) -> tuple[Any, dict[str, Any]]:
    """Scene and keywords from a command line, and from a TOML file where one is named; the command line wins."""
    given: dict[str, Any] = {"scene": options.scene}
    if str(options.scene).endswith(".toml"):
        given = read_scene_file(Path(options.scene))
    given |= {key: value for key, value in vars(options).items() if key not in _APART and value is not None}
    if options.quiet:
        given["progress"] = False
    return given.pop("scene"), given


def given_to(kind: type[Options], options: argparse.Namespace) -> dict[str, Any]:
    """What a command line says of the options of a class."""
    return {each.name: getattr(options, each.name) for each in options_of(kind) if hasattr(options, each.name)}


def show(run: "Run", as_json: bool) -> int:
    """Print a finished run; returns the exit status."""
    if as_json:
        print(json.dumps(run.summary))
        return 0
    print(*run.scene.headline(run.summary), sep="\n")
    if run.folder is not None:
        drawn = any((run.folder / "figures").glob("*"))
        print(f"{'Samples, numbers and pictures' if drawn else 'Samples and numbers'} are in {run.folder}.")
    return 0

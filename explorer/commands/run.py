"""`nearflat run`, and what all commands about a scene share: how it is named, its options, and how a run is shown.

Arrow is loaded when a run is made: `nearflat plan` does without.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from explorer.commands import Answer
from explorer.runs.settings import Settings, asked
from explorer.scenes.options import first_line, key_of, options_of
from explorer.scenes.scene import NAMES, Scene, read_scene_file, scene_class

if TYPE_CHECKING:
    from explorer.runs.run import Run

# Flags that take no value.
_ALONE = {"--resume", "--replace", "--json", "--quiet", "--figures", "--no-figures", "--degrees", "--no-degrees"}
_APART = ("scene", "command", "command_line", "call", "json", "quiet")  # which are no options of a run


def scene_named(words: Sequence[str]) -> type[Scene]:
    """The class of the scene that a command names; that of all scenes where none is named."""
    # Options may stand before it: a word after a flag with a value is the scene only if no other word can be.
    flags = [word.startswith("--") and "=" not in word and word not in _ALONE for word in words]
    after = {i + 1 for i, flag in enumerate(flags) if flag}
    free = [word for i, word in enumerate(words) if i not in after and word and not word.startswith("-")]
    others = [words[i] for i in sorted(after) if i < len(words) and _may_be_scene(words[i])]
    if not (free or others):
        return Scene
    named = [*free, *others][0]
    return scene_class(read_scene_file(Path(named))["scene"] if named.endswith(".toml") else named)


def _may_be_scene(word: str) -> bool:
    return word in NAMES or word.endswith(".toml") or ".py:" in word


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the scene with its options, and those of its run; also of `nearflat plan`."""
    text = f"{', '.join(NAMES)}, a TOML file that names a scene and sets options, or FILE.py:CLASS, your own"
    command.add_argument("scene", metavar="SCENE", help=text)
    kind = scene_named(words)
    if kind is not Scene:
        command.description = f"{command.description} {first_line(kind)}"
        own = [word for word in words if ".py:" in word]  # a scene of the user's has no other name here
        command.epilog = f"example: {command.prog} {[*own, kind.name][0]} --disk hoop --out results/mine"
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

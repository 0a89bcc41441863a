"""`nearflat run`, and `ex.run` for Python: a scene on many initial states, stored or in memory."""

import argparse
import inspect
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from textwrap import fill, indent
from typing import Any, Literal, Unpack, overload

from explorer.commands.common import add_json, show
from explorer.errors import in_words
from explorer.runs.run import Run, execute
from explorer.runs.settings import SETTINGS, Settings, asked
from explorer.scenes.base import Scene
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.measure_zero import MeasureZero
from explorer.scenes.one_sided import OneSided
from explorer.scenes.options import Option, described, type_words
from explorer.scenes.portrait import Portrait
from explorer.scenes.race_angles import RaceAngles
from explorer.scenes.registry import SCENES, read_scene_file


class OfFallingSet(FallingSet.Keywords, Settings, total=False):
    """Keywords of `run("falling-set")`."""


class OfMeasureZero(MeasureZero.Keywords, Settings, total=False):
    """Keywords of `run("measure-zero")`."""


class OfOneSided(OneSided.Keywords, Settings, total=False):
    """Keywords of `run("one-sided")`."""


class OfPortrait(Portrait.Keywords, Settings, total=False):
    """Keywords of `run("portrait")`."""


class OfRaceAngles(RaceAngles.Keywords, Settings, total=False):
    """Keywords of `run("race-angles")`."""


@overload
def run(scene: Literal["falling-set"], **options: Unpack[OfFallingSet]) -> Run: ...
@overload
def run(scene: Literal["measure-zero"], **options: Unpack[OfMeasureZero]) -> Run: ...
@overload
def run(scene: Literal["one-sided"], **options: Unpack[OfOneSided]) -> Run: ...
@overload
def run(scene: Literal["portrait"], **options: Unpack[OfPortrait]) -> Run: ...
@overload
def run(scene: Literal["race-angles"], **options: Unpack[OfRaceAngles]) -> Run: ...
@overload
def run(scene: type[Scene], **options: Any) -> Run: ...
def run(scene: str | type[Scene], **options: Any) -> Run:
    """Ask a question about many initial states.

    The options of a scene mean the same here, on the command line, in a TOML file and in run.json. Text is read as
    the command line reads it. "Units of the disk" are those of its m, r and g; a natural unit of a rate is
    sqrt(g/r), one of an energy is m g r.

    Parameters
    ----------
    scene : str or type
        "falling-set", "measure-zero", "one-sided", "portrait" or "race-angles"; or a scene of your own, by its
        class or, once it is registered, by its name.

    Returns
    -------
    Run
        With the numbers (`summary`), the samples (`frame`, `arrow`, `tables`) and the pictures (`figure`).

    Raises
    ------
    InputError
        For an option that the scene does not take or cannot use, before anything is written.
    RunError
        Where writing fails or no sample can be computed. What is finished is kept.

    Examples
    --------
    >>> import explorer as ex
    >>> races = ex.run("race-angles", disk="hoop", samples=1000)
    >>> races.summary["wrong_way"], round(races.summary["median_plus"], 3)
    (0, 5.441)
    """
    return execute(*asked(scene, options))


def _entry(option: Option, text: str) -> str:
    """What help(run) says of an option."""
    text = in_words(text if text.partition(":")[0].partition(",")[0] in SCENES else text[0].upper() + text[1:])
    text = f"For {text}" if text[0].islower() else text
    return f"{option.word} : {type_words(option.kind)}\n{indent(fill(f'{text}.', 110), '    ')}"


def document(function: Callable[..., Any], settings: Sequence[Option] = SETTINGS, kind: type = Settings) -> None:
    """Let help() and inspect.signature() of `run` and its like name settings and the options of all scenes."""
    entries = {option.word: _entry(option, option.help_for(kind)) for option in settings}
    entries |= {option.word: _entry(option, text) for option, text in described(SCENES.values())}
    signature = inspect.signature(function)
    scene, _ = signature.parameters.values()
    words = [inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, default=None) for word in entries]
    vars(function)["__signature__"] = signature.replace(parameters=[scene, *words])
    text = inspect.cleandoc(function.__doc__ or "")  # empty where docstrings are left out (python -OO)
    function.__doc__ = text.replace("\n\nReturns\n", "\n" + "\n".join(entries.values()) + "\n\nReturns\n", 1)


document(run)


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of all scenes; --help after the name of a scene shows those of this scene."""
    add_question(command)
    add_existing(command)
    command.add_argument(
        "-h", "--help", action=_Help, nargs=0, help="show this, or the options of SCENE, and exit"
    )


def add_question(command: argparse.ArgumentParser) -> None:
    """Add the scene, the settings of its run, and the options of all scenes."""
    _add_settings(command)
    add_options(command, SCENES.values())


def add_existing(command: argparse.ArgumentParser) -> None:
    """Add what becomes of a run that is there, and whether pictures are drawn."""
    which = command.add_mutually_exclusive_group()
    resume = "continue the run in --out, or start it where there is none"
    which.add_argument("--resume", dest="exist", action="store_const", const="resume", help=resume)
    replace = "compute the run in --out anew; the one that is there is lost"
    which.add_argument("--replace", dest="exist", action="store_const", const="replace", help=replace)
    add_figures(command)


def add_figures(command: argparse.ArgumentParser) -> None:
    """Add the option that leaves pictures out."""
    text = "draw no pictures into the folder; a later resume without this draws them"
    command.add_argument("--no-figures", dest="figures", action="store_const", const=False, help=text)


def _add_settings(command: argparse.ArgumentParser) -> None:
    add_scene(command, f"{', '.join(SCENES)}, or a TOML file that names a scene and sets options")
    add_settings(command)
    add_json(command)


def add_scene(command: argparse.ArgumentParser, text: str, count: str | None = None) -> None:
    """Add the scene that a command is about."""
    command.add_argument("scene", metavar="SCENE", nargs=count, help=text)


def add_settings(command: argparse.ArgumentParser, words: Iterable[str] | None = None) -> None:
    """Add settings of a run that have a flag, by default all."""
    for option in SETTINGS:
        if option.flag.startswith("--") and (words is None or option.word in words):
            text = option.help_for(Settings)
            command.add_argument(option.flag, metavar=option.metavar, help=text)


def add_options(
    command: argparse.ArgumentParser, kinds: Iterable[type[Scene]], hidden: Sequence[str] = ()
) -> None:
    """Add the options of some scenes, each flag once; its help says for which scenes it is, unless for all.

    hidden: words of options that are read, but not for this command, which says so where they are given.
    """
    for option, text in described(kinds):
        if not option.flag.startswith("--"):
            continue
        shown = argparse.SUPPRESS if option.word in hidden else text.replace("%", "%%")
        how: dict[str, Any] = {"dest": option.word, "help": shown}
        if not option.metavar:
            how |= {"action": "store_const", "const": True}
        else:
            how |= {"metavar": option.metavar, "action": "append" if option.several else "store"}
        command.add_argument(option.flag, **how)


class _Help(argparse.Action):
    """Print the options of the scene that was named before --help, or those of all scenes."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        kind = SCENES.get(getattr(namespace, "scene", None) or "")
        if kind is not None:
            text = f"Run the scene {kind.name}. {_first_line(kind)}"
            example = f"example: nearflat run {kind.name} --disk hoop --out results/mine"
            parser = argparse.ArgumentParser(parser.prog, None, text, example, add_help=False)
            _add_settings(parser)
            add_existing(parser)
            add_options(parser.add_argument_group(f"options of {kind.name}"), [kind])
        parser.print_help()
        parser.exit()


def _first_line(kind: type[Scene]) -> str:
    """What a scene says of itself; one without a docstring has none, or what `dataclass` writes in its place."""
    lines = (kind.__doc__ or "").strip().splitlines()
    return lines[0] if lines and not lines[0].startswith(f"{kind.__name__}(") else ""


def given_by(options: argparse.Namespace, apart: Sequence[str] = ()) -> tuple[Any, dict[str, Any]]:
    """Scene and keywords from a command line, and from a TOML file where one is named; the command line wins.

    apart: options that are no keywords.
    """
    given: dict[str, Any] = {"scene": options.scene}
    if str(options.scene).endswith(".toml"):
        given = read_scene_file(Path(options.scene))
        if given.pop("resume", None):
            given.setdefault("exist", "resume")
    apart = (*apart, "scene", "command", "command_line", "call", "arithmetic", "json", "quiet")
    given |= {key: value for key, value in vars(options).items() if key not in apart and value is not None}
    if options.quiet:
        given["progress"] = False
    return given.pop("scene"), given


def call(options: argparse.Namespace) -> int:
    """Run the scene."""
    name, given = given_by(options)
    return show(execute(*asked(name, given, options.command_line, exist="error")), options.json)

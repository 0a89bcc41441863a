"""`nearflat run`, and `ex.run` for Python: a scene on many initial states, stored."""

import argparse
import inspect
from collections.abc import Iterable, Mapping
from pathlib import Path
from textwrap import fill, indent
from typing import Any, Unpack

from explorer.commands.common import add_json, add_workers, show
from explorer.errors import InputError, in_words, note
from explorer.runs.run import Run, execute
from explorer.runs.workers import Workers
from explorer.scenes.base import SampledScene, Scene, chunk_size_for
from explorer.scenes.options import Option, described, type_words
from explorer.scenes.registry import SCENES, Options, build_scene, read_scene_file, scene_class

_WORKERS = ("backend", "scheduler")


class Keywords(Options, total=False):
    """Keywords of `run` beside its parameters: the options of scenes, and who computes."""

    backend: str
    scheduler: str | None


def run(
    scene: str,
    *,
    out: Path | str | None = None,
    jobs: int = 2,
    memory: str | float | None = None,
    resume: bool = False,
    quiet: bool = True,
    **options: Unpack[Keywords],
) -> Run:
    """Run a scene and store it.

    The options of a scene mean the same here, on the command line, in a TOML file and in run.json. Text is read as
    the command line reads it. "Units of the disk" are those of its m, r and g; a natural unit of a rate is
    sqrt(g/r), one of an energy is m g r.

    Parameters
    ----------
    scene : str
        "falling-set", "measure-zero", "one-sided", "portrait" or "race-angles".
    out : path, optional
        Folder that holds no run yet; results/SCENE-DISK-SEED by default.
    jobs : int
        Number of workers, 2 by default. It changes no number.
    memory : str or float, optional
        Budget such as "1GB", or bytes. It sets `chunk_size`, which is stored with the run.
    resume : bool
        Continue the run in `out`, or start it where there is none: compute what is missing or damaged.
    quiet : bool
        Print no progress and no notes. True by default.
    backend : str
        Who computes: "threads" (default), "processes" or "dask".
    scheduler : str, optional
        Address of a dask scheduler; by default dask starts one of its own.

    Returns
    -------
    Run
        The finished run with its `scene`, `folder` and `summary`; `tables()` reads the stored samples.

    Raises
    ------
    InputError
        For an option that the scene does not take or cannot use, before anything is written.
    RunError
        Where writing fails or no sample can be computed. What is finished is kept.

    Examples
    --------
    >>> import tempfile
    >>> import explorer as ex
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     done = ex.run("race-angles", disk="hoop", samples=1000, out=f"{folder}/races")
    >>> done.summary["wrong_way"], round(done.summary["median_plus"], 3)
    (0, 5.441)
    """
    workers = Workers(jobs, options.pop("backend", "threads"), options.pop("scheduler", None))
    made = _scene(scene, options, memory, workers.jobs, quiet)
    return execute(made, out, workers=workers, resume=resume, quiet=quiet)


def _entry(option: Option, text: str) -> str:
    """What help(run) says of an option."""
    text = in_words(text if text.partition(":")[0].partition(",")[0] in SCENES else text[0].upper() + text[1:])
    text = f"For {text}" if text[0].islower() else text
    return f"{option.word} : {type_words(option.kind)}\n{indent(fill(f'{text}.', 110), '    ')}"


def _document() -> None:
    """Let help(run) and inspect.signature(run) name the options of all scenes, from the scenes' tables."""
    options = {option.word: _entry(option, text) for option, text in described(SCENES.values())}
    plain = inspect.signature(run)
    keywords = [
        inspect.Parameter(word, inspect.Parameter.KEYWORD_ONLY, default=None) for word in (*_WORKERS, *options)
    ]
    vars(run)["__signature__"] = plain.replace(parameters=[*list(plain.parameters.values())[:-1], *keywords])
    text = inspect.cleandoc(run.__doc__ or "")  # empty where docstrings are left out (python -OO)
    run.__doc__ = text.replace("\n\nReturns\n", "\n" + "\n".join(options.values()) + "\n\nReturns\n", 1)


_document()


def _scene(name: str, options: Mapping[str, Any], memory: Any, jobs: int, quiet: bool) -> Scene:
    """The scene of a run, with chunks that fit into a budget where one is given."""
    if memory is None:
        return build_scene(name, **options)
    kind = scene_class(name)
    if not issubclass(kind, SampledScene):
        names = ", ".join(each for each, other in SCENES.items() if issubclass(other, SampledScene))
        raise InputError(f"--memory {memory}: sets the chunks of {names}, {name} has none; leave it out")
    if options.get("chunk_size") is not None:
        raise InputError(f"--memory {memory}: sets chunk_size, which is given too; leave one of them out")
    size = chunk_size_for(kind, memory, jobs)
    note(f"--memory {memory}: chunks of {size:,} samples", quiet)
    return build_scene(name, **{**options, "chunk_size": size})


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of all scenes; --help after the name of a scene shows those of this scene."""
    _add_settings(command)
    _add_options(command, SCENES.values())
    command.add_argument(
        "-h", "--help", action=_Help, nargs=0, help="show this, or the options of SCENE, and exit"
    )


def _add_settings(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "scene", metavar="SCENE", help=f"{', '.join(SCENES)}, or a TOML file that names a scene and sets options"
    )
    add_workers(command)
    command.add_argument(
        "--memory", metavar="SIZE", help="budget such as 1GB; sets the chunk size, which is stored with the run"
    )
    command.add_argument("--out", metavar="DIR", help="folder of the run (default results/SCENE-DISK-SEED)")
    command.add_argument(
        "--resume", action="store_true", help="continue the run in --out, or start it where there is none"
    )
    add_json(command)


def _add_options(command: argparse.ArgumentParser, kinds: Iterable[type[Scene]]) -> None:
    """Add the options of some scenes, each flag once; its help says for which scenes it is, unless for all."""
    for option, text in described(kinds):
        if not option.flag.startswith("--"):
            continue
        how: dict[str, Any] = {"dest": option.word, "help": text.replace("%", "%%")}
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
            text = f"Run the scene {kind.name}. {(kind.__doc__ or '').splitlines()[0]}"
            example = f"example: nearflat run {kind.name} --disk hoop --out results/mine"
            parser = argparse.ArgumentParser(parser.prog, None, text, example, add_help=False)
            _add_settings(parser)
            _add_options(parser.add_argument_group(f"options of {kind.name}"), [kind])
        parser.print_help()
        parser.exit()


def call(options: argparse.Namespace) -> int:
    """Run the scene, with options from a TOML file where one is named; those of the command line win."""
    given: dict[str, Any] = {"scene": options.scene}
    if options.scene.endswith(".toml"):
        given = read_scene_file(Path(options.scene))
    apart = ("scene", "command", "command_line", "call", "arithmetic", "json", "quiet", "resume")
    given |= {key: value for key, value in vars(options).items() if key not in apart and value is not None}
    resume, out, memory = (given.pop(key, None) for key in ("resume", "out", "memory"))
    workers = Workers(**{key: given.pop(key) for key in ("jobs", "backend", "scheduler") if key in given})
    scene = _scene(given.pop("scene"), given, memory, workers.jobs, options.quiet)
    done = execute(
        scene,
        out,
        workers=workers,
        resume=options.resume or bool(resume),
        quiet=options.quiet,
        command=options.command_line,
    )
    return show(done, options.json)

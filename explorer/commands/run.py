"""`nearflat run`, and `ex.run` for Python: a scene on many initial states, stored."""

import argparse
from collections.abc import Iterable, Mapping, Sequence
from inspect import cleandoc
from pathlib import Path
from typing import Any, TypedDict, Unpack

from explorer.commands.common import add_json, add_workers, show
from explorer.errors import InputError, note
from explorer.measure.density import Function
from explorer.measure.sampling import Box, Range
from explorer.phase.disk import Disk
from explorer.portrait.slices import Slice
from explorer.runs.run import Run, execute
from explorer.runs.workers import Workers
from explorer.scenes.base import SampledScene, Scene, chunk_size_for
from explorer.scenes.options import Option
from explorer.scenes.registry import SCENES, build_scene, read_scene_file, scene_class

Ranges = str | Mapping[str, Range]


class Options(TypedDict, total=False):
    """Options of scenes and of workers, as keywords of `run`.

    Other Parameters
    ----------------
    backend : str
        Who computes: "threads" (default), "processes" or "dask".
    scheduler : str
        Address of a dask scheduler; by default dask starts one of its own.
    disk : Disk or str, or several for one-sided
        The body: uniform by default; uniform, hoop and matching for one-sided.
    seed : int
        Seed of the random streams, 0 by default. A sample depends on it and on its place in the run only.
    accuracy : float
        Largest error: absolute of angles (rad), relative of times and tilts; 1e-6 by default.
    method : str
        "auto" (default), "quadrature", "rk4", "rk8", "dopri5" or "dop853".
    samples : int
        Number of samples: 100,000 by default, 4,000,000 for measure-zero, 32 points per disk for one-sided, and
        the rows of the file where `states` are given.
    chunk_size : int
        Samples per chunk: 65,536 by default, and 1,048,576 for falling-set with more than 10^7 samples.
    keep : str
        Which samples are stored: those "near" the falling set (default), "all" or "none". Counts are of all.
    box : str or mapping
        Ranges of phi (rad) and of phidot, sigma3, sigma4 (units of the disk) that states are drawn from. By
        default phi = 0 and the others within two natural units. For race-angles and one-sided: the speed towards
        flat (phidot), 0.5 to 2 natural units by default, and sigma3.
    energy : str or pair
        For falling-set and measure-zero only states with an energy in this range, for portrait the energies of
        the levels; units of the disk. All energies by default.
    states : path
        For falling-set: Parquet file with the columns phi, phidot, sigma3 and sigma4, instead of `box`.
    theta_min : str
        For falling-set: whether "all" states get a theta_min, or those "near" the falling set only. By default
        all up to 10^7 samples.
    slice : str, or several
        For falling-set: slices that are drawn, each two ranges and two numbers; two slices by default.
    grid : int
        For falling-set: points per axis of a slice, 401 by default.
    eta_hat : str, pair or float
        For race-angles and one-sided the range of the distance |eta_hat| from the falling set, on both sides of
        it; by default 1e-6 to 1e-2, and 1e-6 to 1e-1, natural units. For portrait one number, in the units of
        the disk: the distance from the line of face +1.
    gaussian : str or mapping
        For measure-zero: (mean, standard deviation) of coordinates that are not uniform in the box.
    density : callable
        For measure-zero: called with arrays phi, phidot, sigma3, sigma4; returns one number, 0 or more, for each
        state.
    ladder : str or pair
        For measure-zero: smallest and largest tilt delta (rad), by decades; 1e-15 to 1e-1 by default.
    tube : int
        For measure-zero: draws per delta and face in the tubes beside the falling set, 262,144 by default.
    sampling : str
        For measure-zero: draws in the tubes are "random" (default) or "sobol".
    sigma3_bar, sigma4_bar : float
        For portrait: constants of motion (units of the disk). sigma3_bar is 0.25 natural units by default;
        sigma4_bar may be given instead of `eta_hat`.
    well : bool
        For portrait: insist on a well beside the falling motions. False by default.
    """

    accuracy: float
    backend: str
    box: Box | Ranges
    chunk_size: int
    density: Function
    disk: Disk | str | Sequence[Disk | str]
    energy: str | tuple[float | None, float | None]
    eta_hat: str | Range | float
    gaussian: Ranges
    grid: int
    keep: str
    ladder: str | Range
    method: str
    samples: int | float
    sampling: str
    scheduler: str | None
    seed: int
    sigma3_bar: float
    sigma4_bar: float
    slice: str | Slice | Sequence[str | Slice]
    states: Path | str
    theta_min: str
    tube: int | float
    well: bool


def run(
    scene: str,
    *,
    out: Path | str | None = None,
    jobs: int = 2,
    memory: str | float | None = None,
    resume: bool = False,
    quiet: bool = True,
    **options: Unpack[Options],
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


# help(run) shows what the scenes take beside what every run takes. Without docstrings (python -OO) both are empty.
_of_options = cleandoc(Options.__doc__ or "").partition("\n\n")[2]
run.__doc__ = cleandoc(run.__doc__ or "").replace("\nReturns\n", f"\n{_of_options}\n\nReturns\n", 1)


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
    several = list(kinds)
    takers: dict[str, list[tuple[type[Scene], Option]]] = {}
    for kind in several:
        for option in kind.OPTIONS:
            if option.flag.startswith("--"):
                takers.setdefault(option.flag, []).append((kind, option))
    for flag, pairs in takers.items():
        option = pairs[0][1]
        texts: dict[str, list[str]] = {}
        for kind, each in pairs:
            texts.setdefault(each.help_for(kind), []).append(kind.name)
        alone = len(texts) == 1 and len(pairs) == len(several)
        sentences = [text if alone else f"{', '.join(names)}: {text}" for text, names in texts.items()]
        how: dict[str, Any] = {"dest": option.word, "help": "; ".join(sentences).replace("%", "%%")}
        if not option.metavar:
            how |= {"action": "store_const", "const": True}
        else:
            how |= {"metavar": option.metavar, "action": "append" if option.several else "store"}
        command.add_argument(flag, **how)


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

"""`nearflat trade`, and `ex.trade` for Python: speed against accuracy, measured on the samples of a scene."""

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypedDict, Unpack, overload

from explorer import compiled
from explorer.commands import trade_report
from explorer.commands.common import add_json
from explorer.commands.run import add_options, add_scene, document, given_by
from explorer.errors import InputError, flag, note, positive, said, whole
from explorer.motion import calibration
from explorer.motion.trade import Errors, Measured, Row, curves, largest_errors, measure, only_errors
from explorer.motion.trials import Trial
from explorer.phase.disk import Disk
from explorer.phase.paths import path_of
from explorer.runs.settings import SETTINGS
from explorer.scenes.base import Scene
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.measure_zero import MeasureZero
from explorer.scenes.one_sided import OneSided
from explorer.scenes.options import Option, options_of
from explorer.scenes.race_angles import RaceAngles
from explorer.scenes.registry import SCENES, build_scene, scene_class

# With fewer passages or tilts, overheads are measured.
FEWEST, FEWEST_MOTIONS, MOTIONS = 256, 64, 1024
MOST, MOST_MOTIONS = 1_000_000, 100_000  # beyond, a percentile gains nothing and every setting takes minutes
# Without a scene: passages at all these distances from F, natural units.
PLAIN, ALL_DISTANCES = "race-angles", (1e-8, 1.0)
# Errors are calibrated on all of these too, so that they hold for bodies nobody measured.
BODIES = (Disk.uniform(), Disk.hoop(), Disk(I1=0.02, I3=0.04), Disk(I1=0.5, I3=0.3))
_OF_EACH_BODY = 1024, 64  # passages, motions
_LEFT_OUT = ("method", "accuracy")  # what is measured
_IDLE = ("keep", "slice", "grid")  # which change no sample


def _motions(name: str, value: Any) -> int:
    count = whole(name, value, 0, MOST_MOTIONS)
    if 0 < count < FEWEST_MOTIONS:
        raise InputError(f"{name} {count}: so few do not tell methods apart; give {FEWEST_MOTIONS} or more, or 0")
    return count


class Trading(TypedDict, total=False):
    """Keywords of `trade` beside those of the scene."""

    motions: Annotated[
        int,
        Option(
            "--motions",
            _motions,
            "N",
            f"motions in time, from the first samples, that are measured too: {FEWEST_MOTIONS} or more; 0: none",
            default=str(MOTIONS),
        ),
    ]
    t_end: Annotated[
        float,
        Option(
            "--t-end",
            positive,
            "T",
            "end of these motions, in the units of the disk",
            default="2.5 natural units, about a passage; in one-sided the times of the scene",
        ),
    ]
    progress: Annotated[bool | None, Option("progress", flag, "", "False prints nothing")]


TRADING = options_of(Trading)


class TradeFallingSet(FallingSet.Keywords, Trading, total=False):
    """Keywords of `trade("falling-set")`."""


class TradeMeasureZero(MeasureZero.Keywords, Trading, total=False):
    """Keywords of `trade("measure-zero")`."""


class TradeOneSided(OneSided.Keywords, Trading, total=False):
    """Keywords of `trade("one-sided")`."""


class TradeRaceAngles(RaceAngles.Keywords, Trading, total=False):
    """Keywords of `trade("race-angles")`."""


@dataclass(frozen=True, repr=False)
class Trade:
    """Speed against accuracy on the samples of a scene: what `trade` returns.

    Attributes
    ----------
    scene : Scene
        Whose samples were measured.
    parts : list of Measured
        What the scene computes, passages or smallest tilts, and its motions in time.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade("race-angles", disk="hoop", samples=1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in found.rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    scene: Scene
    parts: list[Measured]

    @property
    def rows(self) -> list[Row]:
        """Every method at every setting, of all parts."""
        return [row for part in self.parts for row in part.rows]

    @property
    def asked(self) -> list[Row]:
        """Every method at every accuracy asked, of all parts."""
        return [row for part in self.parts for row in part.asked]

    def store(self) -> Path:
        """Keep it as the calibration of this machine, which `accuracy` and `method="auto"` use from then on.

        Costs are as measured here; errors are the largest of those measured here and on four other bodies.

        Returns
        -------
        Path
            The file, which may be deleted.

        Raises
        ------
        InputError
            Where these samples do not let a method's error fall with its setting.
        RunError
            Where it cannot be written.
        """
        return calibration.store(calibrate(self))

    def __repr__(self) -> str:
        parts = ", ".join(f"{part.samples:,} {part.kind}" for part in self.parts)
        return f"Trade of {self.scene.name}, {self.scene.label}: {parts}; print it for its tables"

    def __str__(self) -> str:
        return "\n".join(trade_report.tables(self.parts))


@overload
def trade(scene: Literal["falling-set"], **options: Unpack[TradeFallingSet]) -> Trade: ...
@overload
def trade(scene: Literal["measure-zero"], **options: Unpack[TradeMeasureZero]) -> Trade: ...
@overload
def trade(scene: Literal["one-sided"], **options: Unpack[TradeOneSided]) -> Trade: ...
@overload
def trade(scene: Literal["race-angles"] | None = None, **options: Unpack[TradeRaceAngles]) -> Trade: ...
@overload
def trade(scene: type[Scene], **options: Any) -> Trade: ...
def trade(scene: str | type[Scene] | None = None, **options: Any) -> Trade:
    """Measure error and cost of every method on the samples that a scene draws, and on its motions in time.

    Passages are compared with arcs, without tables, smallest tilts with quadrature, motions in time with far finer
    steps. Costs are of the calls that the scene and `simulate` make, on one core, without compile time.

    Parameters
    ----------
    scene : str or type, optional
        As for `run`; by default passages as race-angles draws them, with |eta_hat| from 1e-8 to 1 natural units.
        `samples` is 4096 unless it is given.

    Returns
    -------
    Trade
        For `explorer.plot.work_precision`; `store` lets `accuracy` use it.

    Raises
    ------
    InputError
        For an option that the scene does not take, a scene in which no method is chosen, and too few samples.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade("race-angles", disk="hoop", samples=1024, motions=0)  # doctest: +SKIP
    """
    return _asked(scene, options).measured()


document(trade, TRADING, Trading)


class _Asked(NamedTuple):
    """What is to be measured; nothing was computed yet but the true answers."""

    scene: Scene
    trials: list[Trial]
    quiet: bool

    def measured(self) -> Trade:
        return Trade(self.scene, [measure(trial, lambda text: note(text, self.quiet)) for trial in self.trials])


def _asked(scene: str | type[Scene] | None, options: dict[str, Any]) -> _Asked:
    """What options ask for. Raises InputError."""
    read = {option.word: option for option in TRADING}
    said = {
        word: read[word].read(read[word].flag, options[word]) for word in read if options.get(word) is not None
    }
    made = scene_of(scene, {word: value for word, value in options.items() if word not in read})
    _check_size(made)
    count = said.get("motions", MOTIONS)
    in_time = None if count == 0 else made.motions(count, said.get("t_end"))
    trials: list[Trial] = [trial for trial in (made.trial(), in_time) if trial is not None]
    if not trials:
        raise InputError(f"{made.name}: {_why_none(made, count)}")
    for trial in trials:
        _check(made, trial)
    return _Asked(made, trials, said.get("progress") is False)


def scene_of(scene: str | type[Scene] | None, options: dict[str, Any]) -> Scene:
    """The scene whose samples are measured. Raises InputError."""
    for word in _LEFT_OUT:
        if options.get(word) is not None:
            raise InputError(f"{said(f'--{word}', options[word])}: trade measures all of them; leave it out")
    kind = scene_class(PLAIN if scene is None else scene)
    own = (option for option in kind.OPTIONS if option.word not in (*_LEFT_OUT, *_IDLE))
    kind.require_options(options, (*own, *TRADING))
    made = build_scene(kind, **options)
    plain = scene is None and options.get("eta_hat") is None
    if plain and isinstance(made, RaceAngles) and made.eta_hat is not None:
        low, high = (size * made.disk.rate_unit for size in ALL_DISTANCES)
        made = replace(made, eta_hat=(low, high))
    if hasattr(made, "samples") and options.get("samples") is None:
        made = replace(made, samples=min(made.samples, made.tried))  # type: ignore[call-arg]
    return made


def _why_none(scene: Scene, count: int) -> str:
    if count == 0 and scene.motions(1, None) is not None:
        return "computes nothing but motions in time by a method of choice; leave --motions 0 out"
    names = ", ".join(name for name in SCENES if name != "portrait")
    return f"no method is chosen in this scene, so there is nothing to trade; measure {names}"


def _check_size(scene: Scene) -> None:
    """Raise InputError before anything is drawn or compiled where too few or too many samples are asked for."""
    size = scene.trial_size
    given = f"--samples {size}" if getattr(scene, "states", None) is None else f"--states: holds {size}"
    if size is not None and size > MOST:
        raise InputError(f"{given}: all are followed by every method at every setting; give {MOST:,} at most")
    if size is not None and size < FEWEST:
        raise InputError(f"{given}: overheads are measured with fewer than {FEWEST}; give that many or more")


def _check(scene: Scene, trial: Trial) -> None:
    """Raise InputError where there is too little to measure, or no answer to compare with."""
    known, size = int(trial.known.sum()), trial.known.size
    if not trial.in_time and 2 * known < size:
        # Those that quadrature gives up on, by rounding, take it and small steps longest of all.
        raise InputError(
            f"--disk {scene.label}: {known:,} of {size:,} {trial.kind} have a known answer, and so few do not "
            "tell methods apart; give another disk, or a box whose starts are less slow"
        )
    if not trial.in_time and known < FEWEST:
        raise InputError(
            f"--samples {getattr(scene, 'samples', '')}, --disk {scene.label}: {known} {trial.kind} have a known "
            f"answer, and overheads are measured with fewer than {FEWEST}; give more, or another box or disk"
        )
    if known == 0:
        raise InputError(f"{scene.name}: none of these motions could be followed; give another box or disk")


def _plain(disk: Disk, samples: int, seed: int) -> Scene:
    return scene_of(None, {"disk": disk, "samples": samples, "seed": seed})


def calibrate(measured: Trade) -> dict[str, Any]:
    """The table for `calibration`: costs as measured, errors the largest over BODIES too. Raises InputError."""
    by_kind = {part.kind: part for part in measured.parts}
    passages, motions = _OF_EACH_BODY
    bodies = [_plain(disk, passages, number) for number, disk in enumerate(BODIES)]
    plain = by_kind.get("passages") or _measure(_plain(measured.scene.disk, measured.scene.tried, 0).trial())
    in_time = by_kind.get("motions") or _measure(bodies[0].motions(2 * motions, None))
    own = [part.rows for part in measured.parts if part.kind != "motions"]
    errors = largest_errors([*own, plain.rows], _errors(body.trial() for body in bodies))
    errors_in_time = largest_errors([in_time.rows], _errors(body.motions(motions, None) for body in bodies))
    quadrature = [row.nanoseconds for row in plain.rows if row.method == "quadrature"]
    table = {
        "kernels": compiled.source_digest(),
        "measured_on": measured.scene.options(),
        "quadrature": quadrature[-1],
        "methods": curves(plain, errors),
        "motions": curves(in_time, errors_in_time),
    }
    try:
        calibration.parse(table, "")
    except ValueError as error:
        raise InputError(
            f"{measured.scene.name}: {error} on these samples, so they cannot calibrate; --no-store keeps what is "
            "there"
        ) from None
    return table


def _measure(trial: Trial | None) -> Measured:
    assert trial is not None  # race-angles beside F has both
    return measure(trial)


def _errors(trials: Iterable[Trial | None]) -> list[Errors]:
    return [only_errors(trial) for trial in trials if trial is not None]


def folder_for(out: Path) -> Path:
    """The folder for a report, made now rather than after the measurement. Raises InputError."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {out}: cannot be written ({error.strerror}); give a folder that can") from None
    return out


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat trade`: those of the scenes, and its own."""
    add_scene(command, f"{', '.join(SCENES)}, or a TOML file; by default passages as race-angles draws them", "?")
    add_options(command, SCENES.values(), hidden=(*_LEFT_OUT, *_IDLE))
    default = f"{Scene.tried}; measure-zero {MeasureZero.tried} draws; one-sided {OneSided.tried} points per disk"
    command.add_argument("--samples", metavar="N", help=f"samples that are measured (default {default})")
    for option in TRADING:
        if option.metavar:
            command.add_argument(option.flag, metavar=option.metavar, help=option.help_for(Trading))
    command.add_argument("--out", metavar="DIR", help="folder (default results/trade, or results/trade-SCENE)")
    command.add_argument("--no-store", action="store_true", help="do not keep the result for this machine")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    scene, given = given_by(options, apart=("no_store",))
    of_runs = {option.word for option in SETTINGS} - {"out", "progress"}  # a TOML file may have them
    given = {word: value for word, value in given.items() if word not in of_runs}
    out = given.pop("out", None) or ("results/trade" if scene is None else f"results/trade-{scene}")
    asked = _asked(scene, given)
    folder = folder_for(path_of("--out", out))
    found = asked.measured()
    where = None if options.no_store else found.store()
    trade_report.write(found.scene, found.parts, folder, options.command_line, where)
    if options.json:
        print(json.dumps({"scene": found.scene.options(), "parts": [asdict(part) for part in found.parts]}))
        return 0
    print(found)
    print(f"Tables and picture are in {folder}." + (f" Calibration kept in {where}." if where else ""))
    return 0

"""`nearflat trade`: speed against accuracy, measured on the samples of a scene."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from explorer.commands import Answer, trade_report
from explorer.commands.run import add_scene, given_by
from explorer.errors import InputError, flag, note, positive, said
from explorer.motion.work_precision import Measured, Row, measure
from explorer.phase.paths import made_folder, path_of
from explorer.runs.settings import Settings
from explorer.scenes.options import Options, Reader, option, whole_from
from explorer.scenes.scene import Scene, scene_class

# The time of fewer passages or tilts is mostly that of the call.
FEWEST, MOTIONS = 256, 1024
# Without a scene: passages at all these distances from F, natural units.
PLAIN, ALL_DISTANCES = "race-angles", (1e-8, 1.0)
_MEASURED = ("method", "accuracy")


class Trading(Options):
    """What is measured beside the samples of the scene."""

    motions: int = option(
        whole_from(0),
        "number of samples, counted from the first, whose motions in time are measured too; 0 for none",
        default=MOTIONS,
    )
    t_end: float | None = option(
        Reader(positive, "T", "float | str"),
        "end of these motions, in the units of the disk",
        words="2.5 natural units, about a passage; in one-sided the times of the scene",
    )
    progress: bool | None = option(Reader(flag, None, "bool | None"), "False prints nothing")


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
        """Every method at every accuracy, of all parts."""
        return [row for part in self.parts for row in part.rows]

    def __repr__(self) -> str:
        parts = ", ".join(f"{part.samples:,} {part.kind}" for part in self.parts)
        return f"Trade of {self.scene.name}, {self.scene.label}: {parts}; print it for its tables"

    def __str__(self) -> str:
        return "\n".join(trade_report.tables(self.parts))


def measured(scene: str | type[Scene] | None, options: Mapping[str, Any], out: Path | None = None) -> Trade:
    """What `ex.trade` returns. out: a folder that is made before anything is measured. Raises InputError."""
    asked, rest = Trading.apart(options)
    made = scene_for(scene, rest)
    possible = made.reference_samples(asked.motions or 1, asked.t_end)
    chosen = [samples for samples in possible if asked.motions or not samples.in_time]
    if not chosen:
        why = "no method is chosen in this scene, so there is nothing to trade; measure another one"
        if possible:
            why = "methods can be compared only on its motions in time; leave motions = 0 out"
        raise InputError(f"{made.name}: {why}")
    for samples in chosen:
        known, size = int(samples.known.sum()), samples.known.size
        # Those without an answer take small steps longest.
        if known < (fewest := 1 if samples.in_time else max(FEWEST, size // 2)):
            raise InputError(
                f"{known:,} of {size:,} {samples.kind} have a known answer, and {fewest:,} are needed to tell "
                "methods apart; give more samples, another disk, or a box whose starts are less slow"
            )
    if out is not None:
        made_folder("out", out)
    return Trade(made, [measure(samples, lambda text: note(text, asked.progress is False)) for samples in chosen])


def scene_for(scene: str | type[Scene] | None, options: dict[str, Any]) -> Scene:
    """The scene whose samples are measured. Raises InputError."""
    for name in _MEASURED:
        if options.get(name) is not None:
            raise InputError(f"{said(name, options[name])}: trade measures all of them; leave it out")
    made = scene_class(PLAIN if scene is None else scene).of(options)
    more: dict[str, Any] = {}
    if scene is None and options.get("eta_hat") is None and made.options.get("eta_hat") is not None:
        more["eta_hat"] = tuple(size * made.disk.rate_unit for size in ALL_DISTANCES)
    if "samples" in made.options and options.get("samples") is None:
        more["samples"] = min(made.options["samples"], made.tried)
    return replace(made, **more)


def add_arguments(command: argparse.ArgumentParser, words: Sequence[str]) -> None:
    """Add the options of `nearflat trade`: those of the scene, and its own."""
    kind = add_scene(command, words, "; by default the passages of race-angles", nargs="?")
    Trading.add_to(command)
    (scene_class(PLAIN) if kind is Scene else kind).add_to(command)
    command.add_argument("--out", metavar="DIR", help="folder (default results/trade, or results/trade-SCENE)")


def call(options: argparse.Namespace) -> Answer:
    """Measure, and write the page."""
    scene, given = given_by(options)
    out = path_of(
        "out", given.pop("out", None) or ("results/trade" if scene is None else f"results/trade-{scene}")
    )
    settings, rest = Settings.apart(given)  # a TOML file may have some of a run
    found = measured(scene, {**rest, "progress": settings.progress}, out)
    trade_report.write(found.scene, found.parts, out, options.command_line)
    record = {"scene": found.scene.options, "parts": [asdict(part) for part in found.parts]}
    return Answer(record, f"{found}\nTables and picture are in {out}.")

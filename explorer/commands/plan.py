"""`nearflat plan`, and `ex.plan` for Python: how a run would be computed, why, and what it will cost."""

import argparse
import json
from dataclasses import asdict, dataclass
from typing import Any, Literal, Unpack, overload

from explorer.commands.run import (
    OfFallingSet,
    OfMeasureZero,
    OfOneSided,
    OfPortrait,
    OfRaceAngles,
    add_existing,
    add_question,
    document,
    given_by,
)
from explorer.runs.amounts import duration, size
from explorer.runs.estimate import Estimate, estimate
from explorer.runs.settings import Asked, asked
from explorer.scenes.base import Scene


@dataclass(frozen=True)
class RunPlan:
    """How a run would be computed, and what it will cost.

    Attributes
    ----------
    scene : str
        The question.
    observables : list of str
        What it asks of each sample.
    accuracy : float
        Largest error: absolute of angles (rad), relative of times and tilts.
    model, method, reason : str
        The model and the method that give the observables, and why.
    cost : str
        Work per sample in words.
    estimate : Estimate
        Time (s), memory and room on the disk (bytes) of the run, measured on a few of its chunks.

    Examples
    --------
    >>> import explorer as ex
    >>> plan = ex.plan("race-angles", disk="hoop", samples=3e5)
    >>> plan.method, plan.estimate.chunks, 0.01 < plan.estimate.seconds < 60.0
    ('quadrature', 5, True)
    """

    scene: str
    observables: list[str]
    accuracy: float
    model: str
    method: str
    reason: str
    cost: str
    estimate: Estimate

    def __str__(self) -> str:
        lines = [
            f"{key:12} {', '.join(value) if isinstance(value, list) else value}" for key, value in _told(self)
        ]
        return "\n".join(lines)


@overload
def plan(scene: Literal["falling-set"], **options: Unpack[OfFallingSet]) -> RunPlan: ...
@overload
def plan(scene: Literal["measure-zero"], **options: Unpack[OfMeasureZero]) -> RunPlan: ...
@overload
def plan(scene: Literal["one-sided"], **options: Unpack[OfOneSided]) -> RunPlan: ...
@overload
def plan(scene: Literal["portrait"], **options: Unpack[OfPortrait]) -> RunPlan: ...
@overload
def plan(scene: Literal["race-angles"], **options: Unpack[OfRaceAngles]) -> RunPlan: ...
@overload
def plan(scene: type[Scene], **options: Any) -> RunPlan: ...
def plan(scene: str | type[Scene], **options: Any) -> RunPlan:
    """Say how a run would be computed and what it will cost; nothing is stored.

    Parameters
    ----------
    scene : str or type
        As for `run`.

    Returns
    -------
    RunPlan
        Its estimate is within a factor of two where the cores are free.

    Raises
    ------
    InputError
        As `run` would raise it.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.plan("falling-set", samples=1000).model
    'quadrature'
    """
    return _planned(asked(scene, options))


document(plan)


def _planned(made: Asked) -> RunPlan:
    scene = made.scene
    chosen = scene.plan
    return RunPlan(
        scene.name,
        list(scene.observables),
        chosen.accuracy,
        chosen.rung,
        chosen.method,
        chosen.reason,
        chosen.cost,
        estimate(made),
    )


def _told(planned: RunPlan) -> list[tuple[str, Any]]:
    """What is printed: name and value."""
    far = planned.estimate
    figures = f", {far.seconds_for_figures:.0f} s of it for pictures" if far.seconds_for_figures else ""
    more = f", more than the {size(far.free)} free" if far.free is not None and far.disk > far.free else ""
    plain = [(key, value) for key, value in vars(planned).items() if key != "estimate"]
    return [
        *plain,
        ("samples", f"{far.samples:,} in {far.chunks:,} chunks"),
        ("time", f"about {duration(far.seconds)}{figures} (measured on {far.probed} chunks)"),
        ("memory", f"about {size(far.memory)}"),
        ("disk", f"about {size(far.disk)}{more}" if far.disk else "nothing is stored"),
    ]


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat plan`, which are those of `run`."""
    add_question(command)
    add_existing(command)


def call(options: argparse.Namespace) -> int:
    name, given = given_by(options)
    made = asked(name, {**given, "progress": False}, options.command_line)
    planned = _planned(made._replace(manner=made.manner._replace(quiet=options.quiet)))
    print(json.dumps({**vars(planned), "estimate": asdict(planned.estimate)}) if options.json else planned)
    return 0

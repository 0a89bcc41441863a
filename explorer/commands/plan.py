"""`nearflat plan`: how a run would be computed, why, and what it will cost."""

import argparse
import math
from dataclasses import asdict, dataclass
from datetime import timedelta

from tqdm import tqdm

from explorer.commands import Answer
from explorer.commands.run import add_arguments as add_arguments
from explorer.commands.run import given_by
from explorer.runs.estimate import RunCost, estimate
from explorer.runs.settings import Settings, asked
from explorer.scenes.scene import Scene


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
        What is computed (as in `Passages.model`, or 'algebra' if constants of motion are enough), by which method,
        and why.
    estimate : RunCost
        Time (s), memory and storage (bytes) that the run needs without pictures, measured on a few chunks.

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
    estimate: RunCost

    def __str__(self) -> str:
        far = self.estimate
        memory, disk, free = (f"{tqdm.format_sizeof(size or 0)}B" for size in (far.memory, far.disk, far.free))
        more = f", more than the {free} free" if far.free is not None and far.disk > far.free else ""
        time = timedelta(seconds=math.ceil(far.seconds))
        lines = {name: value for name, value in vars(self).items() if name != "estimate" and value} | {
            "observables": ", ".join(self.observables),
            "samples": f"{far.samples:,} in {far.chunks:,} chunks",
            "time": f"about {time} (hours:minutes:seconds) without pictures, measured on {far.probed} chunks",
            "memory": f"about {memory}",
            "disk": f"about {disk}{more}" if far.disk else "nothing is stored",
        }
        return "\n".join(f"{name:12} {value}" for name, value in lines.items() if value)


def planned(scene: Scene, settings: Settings) -> RunPlan:
    """How a run would be computed."""
    chosen = scene.plan
    how = chosen.level, chosen.method, chosen.reason
    if not scene.observables:  # a user's scene need not say what it computes
        own = "that of the scene, which names no observables"
        how = own, scene.method, own
    return RunPlan(scene.name, list(scene.observables), scene.accuracy, *how, estimate(scene, settings))


def call(options: argparse.Namespace) -> Answer:
    """Say the plan."""
    name, given = given_by(options)
    made = planned(*asked(name, given, options.command_line))
    return Answer(asdict(made), str(made))

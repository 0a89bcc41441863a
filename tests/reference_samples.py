"""Samples whose answers are known, on which any method can be tried at any setting: passages and motions."""

from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from explorer.motion.compare import apart
from explorer.motion.passage_starts import VerticalStarts
from explorer.motion.passages import OBSERVABLES as OF_PASSAGES
from explorer.motion.passages import Passages, passages_by, reference_passages
from explorer.motion.plan import INTEGRATORS, Plan, plan
from explorer.motion.trajectories import Trajectories, trajectories_by
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States

IN_TIME = ("phi", "chi", "psi", "path")
_FINEST = 0.04  # step of rk8: no setting that is tried
# Tilt (rad) below which chi races, and errors of the time count many times in it; no error is taken there.
RACING = 0.1
# Median duration of a passage as race-angles draws them (natural units), and times at which motions are compared.
_PASSAGE, _TIMES = 2.5, 8


class Tried(NamedTuple):
    """What a method made of the samples.

    errors (n): the largest of each sample, of angles in rad, of times and tilts relative, of the path in radii;
    NaN where there is none. wrong_way: it came out on the other side of F. steps: attempted, by an integrator.
    """

    errors: Array
    status: NDArray[np.int8]
    wrong_way: NDArray[np.bool_]
    steps: NDArray[np.int32] | None


# Both classes have the same attributes. kind: what the samples are. unit: what a cost is the cost of. error: what
# the error is, in words. observables: what is asked of a plan for them. methods: those that answer.


class ReferencePassages:
    """Passages from starts at the vertical, as `passages` computes them."""

    kind = "passages"
    unit = "passage"
    error = (
        "the largest of the errors of race angle, delta chi, delta psi (rad), duration and theta_min (relative)"
    )
    observables = OF_PASSAGES
    methods = ("quadrature", *INTEGRATORS)

    def __init__(self, disk: Disk, starts: VerticalStarts) -> None:
        self.disk, self.starts = disk, starts

    @cached_property
    def exact(self) -> Passages:
        """The true answers, where they are ok: the passages as arcs, without tables."""
        return reference_passages(self.disk, self.starts)

    def call(self, how: Plan) -> tuple[Passages, NDArray[np.int32] | None]:
        """What users or scenes call, by a plan; this is what is timed."""
        return passages_by(self.disk, self.starts, how)

    def compare(self, found: Any) -> Tried:
        """What `call` returned beside the true answers."""
        (made, steps), exact = found, self.exact
        differences = [apart(name, getattr(made, name), getattr(exact, name)) for name in OF_PASSAGES]
        return Tried(np.max(differences, axis=0), made.status, made.wrong_way, steps)


class ReferenceMotions:
    """Motions in time, as `simulate` follows them: states of a disk at given times."""

    kind = "motions"
    unit = "motion"
    error = (
        "the largest of the errors of phi, chi, psi (rad) and path (r), at times at which the disk does not race"
    )
    observables = IN_TIME
    methods = INTEGRATORS

    def __init__(self, states: States, times: Array) -> None:
        self.states, self.times = states, times

    @cached_property
    def exact(self) -> Trajectories:
        """The true answers, where they are ok: the motions by far finer steps."""
        return self.call(replace(plan(IN_TIME, method="rk8"), setting=_FINEST))

    def call(self, how: Plan) -> Trajectories:
        """What users or scenes call, by a plan; this is what is timed."""
        return trajectories_by(self.states, how, self.times, IN_TIME)

    def compare(self, found: Any) -> Tried:
        """What `call` returned beside the true answers."""
        disk, exact = self.states.disk, self.exact
        away = {name: abs(getattr(found, name) - getattr(exact, name)) for name in IN_TIME}
        away["path"] = np.linalg.norm(away["path"], axis=-1) / disk.r
        assert exact.phi is not None
        racing = 0.5 * np.pi - abs(exact.phi) < RACING
        far = np.where(racing, np.nan, np.stack(list(away.values())))
        errors = np.where(found.ok, np.nanmax(far, axis=(0, 2), initial=0.0), np.nan)
        turned = found.ok & (np.nanmax(far[1], axis=1, initial=0.0) > disk.race_limit)
        return Tried(errors, found.status, turned, found.steps)


ReferenceSamples: TypeAlias = ReferencePassages | ReferenceMotions


def through_time(states: States, t_end: float | None) -> ReferenceMotions:
    """Motions from states of one disk up to `t_end`, by default about as long as a passage takes."""
    last = _PASSAGE * states.disk.time_unit if t_end is None else t_end
    return ReferenceMotions(states, last * np.arange(1, _TIMES + 1) / _TIMES)

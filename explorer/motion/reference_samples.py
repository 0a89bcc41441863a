"""Samples whose answers are known, on which any method can be tried at any setting: passages and motions."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from explorer.motion.compare import apart
from explorer.motion.passages import OBSERVABLES as OF_PASSAGES
from explorer.motion.passages import Passages, passages_by, reference_passages
from explorer.motion.plan import TIGHTEST, Plan, plan
from explorer.motion.trajectories import Trajectories, trajectories_by
from explorer.motion.vertical import VerticalStarts
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States

IN_TIME = ("phi", "chi", "psi", "path")
_FINEST = 0.04  # step of rk8: no setting that is tried
# Tilt (rad) below which chi races, and errors of the time count many times in it; no error is taken there.
RACING = 0.1
# Median duration of a passage as race-angles draws them (natural units), and times at which motions are compared.
_PASSAGE, _TIMES = 2.5, 8
# Settings are tried at this accuracy: errors are what is measured, so no sample is refused for its own.
ANY_ERROR = 1.0


class Tried(NamedTuple):
    """What a method made of the samples.

    errors (n): the largest of each sample, of angles in rad, of times and tilts relative, of the path in radii;
    NaN where there is none. wrong_way: it came out on the other side of F. steps: attempted, by an integrator.
    """

    errors: Array
    status: NDArray[np.int8]
    wrong_way: NDArray[np.bool_]
    steps: NDArray[np.int32] | None


class Samples:
    """Samples with their true answers, on which a method is tried: `compare` with these what `call` returns.

    kind: what they are. unit: what a cost is the cost of. error: what the error is, in words. in_time: whether
    they are motions in time, so that quadrature gives no answer.
    """

    kind: ClassVar[str]
    unit: ClassVar[str]
    error: ClassVar[str]
    observables: ClassVar[tuple[str, ...]]
    in_time: ClassVar[bool] = False

    def plan(self, method: str, accuracy: float, setting: float | None = None) -> Plan:
        """How they are computed by a method, at an accuracy or at a setting."""
        asked = plan(self.observables, TIGHTEST["rk4"] if accuracy == ANY_ERROR else accuracy, method)
        return replace(asked, accuracy=accuracy, setting=setting)


class ReferencePassages(Samples):
    """Passages from starts at the vertical, as `passages` computes them."""

    kind = "passages"
    unit = "passage"
    error = (
        "the largest of the errors of race angle, delta chi, delta psi (rad), duration and theta_min (relative)"
    )
    observables = OF_PASSAGES

    def __init__(self, disk: Disk, starts: VerticalStarts) -> None:
        self.disk, self.starts = disk, starts

    @cached_property
    def exact(self) -> Passages:
        """The passages as arcs, without tables."""
        return reference_passages(self.disk, self.starts)

    @property
    def known(self) -> NDArray[np.bool_]:
        """Samples whose true answer is known."""
        return self.exact.ok

    def call(self, how: Plan) -> tuple[Passages, NDArray[np.int32] | None]:
        """What users or scenes call, by a plan; this is what is timed."""
        return passages_by(self.disk, self.starts, how)

    def compare(self, found: Any, accuracy: float) -> Tried:
        """What `call` returned beside the true answers; ANY_ERROR: only what the integrator itself gives."""
        (made, steps), exact = found, self.exact
        # The fall is found to the accuracy asked, by whatever method the passage is.
        names = OF_PASSAGES if accuracy < ANY_ERROR else [name for name in OF_PASSAGES if name != "race_angle"]
        differences = [apart(name, getattr(made, name), getattr(exact, name)) for name in names]
        return Tried(np.max(differences, axis=0), made.status, made.wrong_way, steps)


class ReferenceMotions(Samples):
    """Motions in time, as `simulate` follows them: some states of a disk at times of their own, group by group."""

    kind = "motions"
    unit = "motion"
    error = (
        "the largest of the errors of phi, chi, psi (rad) and path (r), at times at which the disk does not race"
    )
    observables = IN_TIME
    in_time = True

    def __init__(self, groups: Sequence[tuple[States, Array]]) -> None:
        self.groups = groups

    @cached_property
    def exact(self) -> list[Trajectories]:
        """The motions by far finer steps."""
        return self.call(self.plan("rk8", ANY_ERROR, _FINEST))

    @property
    def known(self) -> NDArray[np.bool_]:
        """Samples whose true answer is known."""
        return np.concatenate([motion.ok for motion in self.exact])

    def call(self, how: Plan) -> list[Trajectories]:
        """What users or scenes call, by a plan; this is what is timed."""
        return [trajectories_by(states, how, times, IN_TIME) for states, times in self.groups]

    def compare(self, found: Any, accuracy: float) -> Tried:
        """What `call` returned beside the true answers."""
        errors, turned = list[Array](), list[NDArray[np.bool_]]()
        for (states, _), made, exact in zip(self.groups, found, self.exact, strict=True):
            away = {name: abs(getattr(made, name) - getattr(exact, name)) for name in IN_TIME}
            away["path"] = np.linalg.norm(away["path"], axis=-1) / states.disk.r
            assert exact.phi is not None
            racing = 0.5 * np.pi - abs(exact.phi) < RACING
            far = np.where(racing, np.nan, np.stack(list(away.values())))
            errors.append(np.where(made.ok, np.nanmax(far, axis=(0, 2), initial=0.0), np.nan))
            turned.append(made.ok & (np.nanmax(far[1], axis=1, initial=0.0) > states.disk.race_limit))
        status, steps = ([getattr(made, name) for made in found] for name in ("status", "steps"))
        return Tried(*map(np.concatenate, (errors, status, turned, steps)))


ReferenceSamples: TypeAlias = ReferencePassages | ReferenceMotions


def through_time(states: States, t_end: float | None) -> ReferenceMotions:
    """Motions from states of one disk up to `t_end`, by default about as long as a passage takes."""
    last = _PASSAGE * states.disk.time_unit if t_end is None else t_end
    return ReferenceMotions([(states, last * np.arange(1, _TIMES + 1) / _TIMES)])

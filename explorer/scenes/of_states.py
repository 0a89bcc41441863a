"""Scenes about states anywhere in the phase space: drawn from a density, or given by the user."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from explorer.errors import InputError
from explorer.measure.density import ANY_ENERGY, Density, Function
from explorer.measure.sampling import Box, Range, chunk_stream
from explorer.motion.trials import MotionTrial, through_time
from explorer.phase.states import States, phi_to_states
from explorer.scenes.base import NoStateError, SampledScene, Table
from explorer.scenes.given_states import Block, Given, GivenStates
from explorer.scenes.options import DEGREES, DENSITY, ENERGY, GAUSSIAN, STATES, OpenRange, Ranges

BLOCK = 1 << 14  # states: intermediate arrays stay in the processor's cache


@dataclass(frozen=True, kw_only=True)
class SceneOfStates(SampledScene):
    """A scene that takes states from a box, a Gaussian, a density or the user, all in one way."""

    box: Box | None
    energy: Range | None = None
    gaussian: dict[str, Range] | None = None
    density: Function | None = None
    states: GivenStates | None = None
    degrees: bool = False

    class Keywords(SampledScene.Keywords, total=False):
        energy: Annotated[OpenRange, ENERGY]
        gaussian: Annotated[Ranges, GAUSSIAN]
        density: Annotated[Function, DENSITY]
        states: Annotated[Given, STATES]
        degrees: Annotated[bool, DEGREES]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.degrees and self.states is None:
            raise InputError("--degrees: says how --states is meant; give both or leave it out")
        made = None if self.states is None else self.states.states
        if made is not None and self.degrees:
            raise InputError("--degrees: States are in radians already; leave it out")
        if made is not None and made.disk != self.disk:
            raise InputError(f"--states: made for the disk {made.disk.name!r}, used with {self.disk.name!r}")
        if self.states is None:
            # An energy or a density that the box does not reach is refused before anything is written.
            self._drawn(chunk_stream(self.seed, 0), 1)

    @classmethod
    def completed_by_source(cls, given: dict[str, Any]) -> dict[str, Any]:
        """What was given, and what follows from where the states come from."""
        states = given.get("states")
        if states is None:
            disk = given.get("disks", cls.disks)[0]
            return {**given, "box": replace(Box.default(disk), **given.get("box", {}))}
        for name in ("box", "energy", "gaussian", "density"):
            if name in given:
                raise InputError(f"--{name}: the states come from --states; leave it out")
        if given.get("samples", 1) > states.rows:
            raise InputError(f"--samples {given['samples']}: --states holds {states.rows}; leave --samples out")
        disks = {} if states.states is None else {"disks": (states.states.disk,)}
        return {**disks, "samples": states.rows, "box": None, **given}

    def options(self) -> dict[str, Any]:
        # A function is identified by its values.
        called = None if self.density is None else self.source.describe().get("density")
        return {**super().options(), "density": called}

    @cached_property
    def source(self) -> Density:
        """What states are drawn from, where they are not given."""
        assert self.box is not None
        bells = tuple((self.gaussian or {}).items())
        return Density(self.box, ANY_ENERGY if self.energy is None else self.energy, bells, self.density)

    def blocks(self, index: int) -> Iterator[Block]:
        """The states of a chunk, block by block."""
        count, random = self.length(index), chunk_stream(self.seed, index)
        given = None
        if self.states is not None:
            given = self.states.read(self.disk, index * self.chunk_size, count, self.degrees)
        for first in range(0, count, BLOCK):
            size = min(BLOCK, count - first)
            if given is not None:
                yield given.at(np.arange(first, first + size))
            else:
                columns = self._drawn(random, size)
                yield Block(phi_to_states(self.disk, **columns), columns, {})

    def first_states(self, count: int) -> States:
        """A few states like those of the run; the same for all seeds, so that runs can be merged."""
        if self.states is not None:
            return self.states.read(self.disk, 0, min(count, self.samples), self.degrees).states
        return phi_to_states(self.disk, **self._drawn(chunk_stream(0, 0), count))

    def states_among(self, status: Mapping[str, int]) -> int:
        """How many samples are states; the others are bad input, and in no statistic.

        Raises NoStateError where none is.
        """
        count = sum(status.values()) - status.get("bad_input", 0)
        if count:
            return count
        if self.states is None:
            remedy = "in --box, give rates below 1e100 natural units"
            raise NoStateError(f"{self.name}: none of {self.samples:,} draws is a state; {remedy}")
        degrees = "" if self.degrees else ", and --degrees where they are in degrees"
        raise NoStateError(
            f"{self.name}: none of the {self.samples} rows of --states is a state; give finite numbers, "
            f"phi between -pi/2 and pi/2 or tilt between 0 and pi{degrees}"
        )

    def motions(self, count: int, t_end: float | None) -> MotionTrial:
        first = next(self.blocks(0)).states
        return through_time(first.at(np.arange(min(count, len(first)))), t_end)

    def _drawn(self, random: np.random.Generator, count: int) -> Table:
        # Where nothing is rejected no draw is wasted: the box is drawn from directly.
        source = self.source
        return source.box.draw(random, count) if source.plain else source.draw(self.disk, random, count)

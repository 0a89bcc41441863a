"""Where samples come from: a density, states of the user's, or the neighbourhood of F at the vertical."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError
from explorer.measure.distributions import ANY_ENERGY, Coordinate, Distribution, Weight
from explorer.measure.sampling import Range, Stream, numbered_stream, signs
from explorer.motion.threads import blocks
from explorer.phase.disk import SYNTAX, Disk, require_axial_inertia
from explorer.phase.results import Columns, count_status
from explorer.phase.states import COORDINATES, Array, States
from explorer.scenes.given_states import Block, GivenStates, coordinates_of
from explorer.scenes.options import BOX, DENSITY, DISK, OPEN_RANGE, TRUTH, Reader, option
from explorer.scenes.scene import SAMPLES, SampledScene

_LOOKED_AT = 1_000_000  # rows of given states, when those are named that are none
# In natural units: where doubles still have all their digits, and where "near F" loses its meaning.
_NEAR_F = (1e-305, 10.0)


class FromDensity(SampledScene):
    """Where states are drawn."""

    box: Distribution = option(
        BOX,
        "how states are drawn, in the units of the disk: each VALUE is a number, LOW:HIGH for even draws, or a "
        'distribution of SciPy, as in "phi=0,phidot=norm:0:1,sigma3=-2:2"; '
        "or, except in measure-zero, of tilt, tilt_rate, precession and spin",
        words="phi=0,phidot=-2:2,sigma3=-2:2,sigma4=-2:2 in natural units",
        follows=lambda self, given: self.box_of(given),
    )
    energy: Range | None = option(
        OPEN_RANGE,
        "only states with an energy in this range, in the units of the disk; LOW or HIGH may be left out",
    )
    density: Weight | None = option(
        DENSITY,
        "a density, called as density(phi, phidot, sigma3, sigma4), or with whatever coordinates the box has; its "
        "arguments are arrays, in rad and the units of the disk",
    )
    degrees: bool = option(
        TRUTH, "angles and rates of box, slice and tables of states are in degrees", default=False
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        require_axial_inertia(self.disk)
        if self.box is not None:
            # An energy or a density that the box does not reach is refused before anything is written.
            self.draw(numbered_stream(self.seed, 0), 1)

    def box_of(self, given: Any) -> Distribution:
        """The laws that are given; what is left out has its natural range."""
        return Distribution.box(self.disk, given, self.degrees)

    @cached_property
    def source(self) -> Distribution:
        """What states are drawn from."""
        return replace(self.box, energy=self.energy or ANY_ENERGY, weight=self.density)

    def as_json(self) -> dict[str, Any]:
        return {**super().as_json(), "density": self.density and self.source.describe_weight()}

    def draw(self, random: Stream, count: int) -> Columns:
        return self.source.draw(random, count)


class FromStates(FromDensity):
    """Which states: drawn from a density, or given in a table.

    `observe` gets a `Block` of them.
    """

    disk: Disk = option(
        DISK,
        f"disk: {SYNTAX}",
        words="uniform",
        follows=lambda self, given: given or getattr(self.states and self.states.states, "disk", Disk.uniform()),
        key="disks",
    )
    samples: int = option(
        *SAMPLES,
        words="100000, or all states that are given",
        follows=lambda self, given: given or (self.states.rows if self.states else 100_000),
    )
    states: GivenStates | None = option(
        Reader(GivenStates.of, "FILE", "Path | str | States | Any"),
        "Parquet or CSV file with states, used instead of box: columns tilt, tilt_rate, precession, spin; or phi, "
        "phidot, sigma3, sigma4; or phidot, sigma3_bar, eta_hat; other columns are copied into the results",
        follows=lambda self, given: given and given.of_degrees(self.degrees),
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.states is not None and self.samples > self.states.rows:
            raise InputError(f"samples {self.samples}: states holds {self.states.rows}; leave samples out")
        if self.states is not None and self.states.chart is not None:
            # What contradicts itself, or is no state at all, is refused before anything is written.
            first = self.states.read(self.disk, 0, min(self.samples, self.block), quiet=False)
            if first.states.size == self.samples:
                self.states_among(count_status(first.states.status))
        made = None if self.states is None else self.states.states
        if made is not None and made.disk != self.disk:
            raise InputError(
                f"states: made for the disk {made.disk.name!r}, not for {self.disk.name!r}; leave disk out"
            )

    def box_of(self, given: Any) -> Any:
        if self.states is None:
            return super().box_of(given)
        for name in ("box", "energy", "density"):
            if getattr(self, name) is not None:
                raise InputError(
                    f"{name}: cannot be combined with states, which says what the states are; leave one out"
                )
        return None

    @property
    def block(self) -> int:
        return 1 << 14

    def blocks(self, index: int) -> Iterator[Any]:
        """The states of a chunk, block by block."""
        if self.states is not None:
            given = self.states.read(self.disk, index * self.chunk_size, self.length(index))
            yield from map(given.at, blocks(self.length(index), self.block))
            return
        for columns in super().blocks(index):
            states = self.box.states(columns)
            known = columns if {*columns} == {*COORDINATES} else coordinates_of(states)
            yield Block(states, known, {name: columns[name] for name in columns if name not in known})

    def first_states(self, count: int, seed: int = 0) -> States:
        """A few states like those of the run: the same whatever its seed is, so that runs can be merged."""
        if self.states is not None:
            return self.states.read(self.disk, 0, min(count, self.samples)).states
        return self.box.states(self.draw(numbered_stream(seed, 0), count))

    def states_among(self, status: Mapping[str, int]) -> int:
        """How many samples are states; the others are bad input, and in no statistic. Raises InputError for 0."""
        count = sum(status.values()) - status.get("bad_input", 0)
        if not count:
            raise InputError(
                f"{self.name}: none of {self.samples:,} samples is a state; give finite numbers, rates below 1e75 "
                "natural units, phi between -pi/2 and pi/2, tilt between 0 and pi; set degrees if they are degrees"
            )
        return count

    def headline(self, summary: dict[str, Any]) -> list[str]:
        """As of all scenes, and the first rows of a table that are no states."""
        lines = super().headline(summary)
        if summary["status"].get("bad_input") and self.states is not None:
            try:
                status = self.first_states(_LOOKED_AT).status
            except InputError as error:
                return [*lines, f"which are no states (bad_input) cannot be said: {error}"]
            bad = np.flatnonzero(status == compiled.status.Status.BAD_INPUT)[:10]
            rows = ", ".join(self.states.told(bad.tolist()))
            lines.append(f"no states (bad_input), for instance, counted from 0: row {rows}")
        return lines


# Near F, at the vertical. The flow preserves the measure, so there a draw of (phidot, sigma3, eta_hat) at the
# vertical stands for draws anywhere along the motion.

BOX_NEAR_F = (
    'upright starts, in the units of the disk, as in "phidot=0.5:2,sigma3=-2:2", where phidot is the '
    "speed towards flat"
)
ETA_HAT = "distance |eta_hat| from the falling set, on both sides, in the units of the disk"


def box_near_f(disk: Disk, given: Any) -> Distribution:
    """Speed towards flat and sigma3 of starts at the vertical; by default 0.5 to 2 and -2 to 2, natural units.

    Slower starts linger at the vertical, where the energy at which a motion compares with its
    limit is no longer close to its own. Raises InputError where they are no starts near F.
    """
    if isinstance(given, Distribution):
        return replace(given, disk=disk)
    unit = disk.rate_unit
    laws = {"phidot": (0.5 * unit, 2.0 * unit), "sigma3": (-2.0 * unit, 2.0 * unit), **(given or {})}
    for name in laws:
        if name not in ("phidot", "sigma3"):
            why = "starts at the vertical and sets sigma4 by eta_hat"
            raise InputError(f"box {name}: this scene {why}; give phidot and sigma3 alone")
    box = Distribution(disk, {name: Coordinate.of(name, law, what="box") for name, law in laws.items()})
    if box.coordinates["phidot"].low < 0.0:
        raise InputError(
            f"box {box.coordinates['phidot']}: this scene takes the speed towards flat, used for both faces; give "
            "0 <= LOW"
        )
    return box


def starts_near_f(box: Distribution, random: Stream, count: int) -> dict[str, Array]:
    """`count` starts as `coordinates_to_states` takes them, but for eta_hat; both faces equally likely."""
    columns = box.draw(random, count)
    face = signs(random.random(count))
    return {"phidot": face * columns["phidot"], "sigma3_bar": columns["sigma3"], "face": face}


def eta_hat_span(disk: Disk, given: Range | None, usual: Range) -> Range:
    """Magnitudes low <= high near F, in the units of the disk: as given, or the usual ones of natural units.

    Raises InputError.
    """
    low, high = given or (usual[0] * disk.rate_unit, usual[1] * disk.rate_unit)
    nearest, furthest = (limit * disk.rate_unit for limit in _NEAR_F)
    if not nearest <= low <= high <= furthest:
        raise InputError(
            f"eta_hat {low:g}:{high:g}: give LOW:HIGH with {nearest:g} <= LOW <= HIGH <= {furthest:g}; "
            "scene one-sided has the limits at 0"
        )
    return low, high

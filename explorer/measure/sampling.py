"""The box in (phi, phidot, sigma3, sigma4) from which initial states are drawn, and seeded streams.

dphi dphidot dsigma3 dsigma4 is invariant under the reduced flow (its vector field has no
divergence in these coordinates), so uniform draws in a box are draws from the natural measure.
Chunk i of a run has a random stream of its own, so a sample depends on the seed and its place
in the run, never on the number of workers.
"""

import math
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, double_of, one_of, shown
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array

Range = tuple[float, float]
Stream = np.random.Generator

BLOCK = 8192  # draws at once: a few columns of them stay in a processor's cache
_SMALLEST_SHARE = 1e-4  # of draws that are kept, below which rejection gives up: it would take 10^4 times as long
_TRIED = 8  # blocks before it does


@dataclass(frozen=True)
class Box:
    """A range for each coordinate, in the units of the disk; a fixed coordinate has equal ends."""

    phi: Range
    phidot: Range
    sigma3: Range
    sigma4: Range

    def __post_init__(self) -> None:
        for name in COORDINATES:
            low, high = getattr(self, name)
            if not (math.isfinite(low) and math.isfinite(high)):
                raise InputError(f"box {name} = {low}:{high} is not finite; give numbers as LOW:HIGH")
            if low > high:
                raise InputError(f"box {name} = {low:g}:{high:g} is empty; give the smaller number first")
        if not (-0.5 * math.pi <= self.phi[0] and self.phi[1] <= 0.5 * math.pi):
            raise InputError("box phi must lie between -pi/2 and pi/2 (-1.5708:1.5708)")
        if abs(self.phi[0]) == 0.5 * math.pi and self.phi[0] == self.phi[1]:
            raise InputError("box phi is flat; give -pi/2 < phi < pi/2")

    @classmethod
    def default(cls, disk: Disk) -> "Box":
        """phi = 0 and the other coordinates within two natural units sqrt(g/r)."""
        two = 2.0 * disk.rate_unit
        return cls((0.0, 0.0), (-two, two), (-two, two), (-two, two))

    @classmethod
    def parse(cls, given: Any, default: "Box") -> "Box":
        """From "phi=0,phidot=-2:2,..." or a mapping; what is left out keeps the default. Raises InputError."""
        return replace(default, **parse_ranges(given, "box"))

    @property
    def free(self) -> list[str]:
        """Coordinates that vary."""
        return [name for name in COORDINATES if getattr(self, name)[0] < getattr(self, name)[1]]

    def draw(self, random: Stream, count: int) -> dict[str, Array]:
        """`count` states, uniform in the box; one array per coordinate."""
        unit = random.random((len(self.free), count))
        columns = {}
        for name in COORDINATES:
            low, high = getattr(self, name)
            columns[name] = np.full(count, low)
            if name in self.free:
                columns[name] = low + (high - low) * unit[self.free.index(name)]
        return columns

    def describe(self) -> dict[str, list[float]]:
        """The entry of run.json."""
        return {name: list(getattr(self, name)) for name in COORDINATES}


def parse_ranges(given: Any, option: str, known: Collection[str] = COORDINATES) -> dict[str, Range]:
    """{"phi": (0, 0), ...} from "phi=0,phidot=-2:2" or a mapping. Raises InputError naming the option."""
    if not isinstance(given, str | Mapping):
        raise InputError(f'{option} {shown(given)} is no text; write "phi=0,phidot=-2:2"')
    items = given.items() if isinstance(given, Mapping) else (part.split("=", 1) for part in given.split(","))
    ranges: dict[str, Range] = {}
    for name, *values in items:
        name, value = one_of(f"{option} coordinate", str(name).strip(), known), values[0] if values else None
        parts = (
            value.split(":") if isinstance(value, str) else value if isinstance(value, list | tuple) else [value]
        )
        ends = [end for part in parts if (end := double_of(part)) is not None]
        if len(ends) != len(parts) or len(ends) not in (1, 2):
            raise InputError(f"{option} {name} = {shown(value)} is not a number or a range LOW:HIGH")
        if name in ranges:
            raise InputError(f"{option}: {name} is there twice; write each coordinate once")
        ranges[name] = ends[0], ends[-1]
    return ranges


def chunk_stream(seed: int, index: int) -> np.random.Generator:
    """The random stream of chunk `index`; only its uniform doubles are used, which no numpy release changes."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(index,))))


def signs(unit: Array) -> Array:
    """1 where a uniform double is below 1/2, else -1."""
    return np.where(unit < 0.5, 1.0, -1.0)


def gather(
    block: Callable[[], tuple[dict[str, Array], NDArray[np.bool_]]], count: int, remedy: str
) -> dict[str, Array]:
    """Rejection sampling: call `block` until `count` states are accepted, and return exactly `count`.

    block: returns BLOCK states and which of them to keep. remedy: the message of the InputError that is raised
    where fewer than one draw in 10^4 is kept, with {} for how many were.
    """
    kept: list[dict[str, Array]] = []
    have = tried = 0
    while have < count:
        drawn, good = block()
        kept.append({name: values[good] for name, values in drawn.items()})
        have, tried = have + int(good.sum()), tried + good.size
        if tried >= _TRIED * BLOCK and have < _SMALLEST_SHARE * tried:
            raise InputError(f"{remedy.format(f'{have} of {tried}')} or shrink the box")
    return {name: np.concatenate([part[name] for part in kept])[:count] for name in kept[0]}


def log_uniform(unit: Array, low: float, high: float) -> Array:
    """Map uniform doubles to a log-uniform magnitude between low and high."""
    return low * (high / low) ** unit

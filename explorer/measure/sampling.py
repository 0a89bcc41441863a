"""The box in (phi, phidot, sigma3, sigma4) from which initial states are drawn, and seeded streams.

dphi dphidot dsigma3 dsigma4 is invariant under the reduced flow (its vector field has no
divergence in these coordinates), so uniform draws in a box are draws from the natural measure.
Chunk i of a run has a random stream of its own, so a sample depends on the seed and its place
in the run, never on the number of workers.
"""

import math
from collections.abc import Callable, Collection, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, double_of, shown, suggest
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array

Range = tuple[float, float]

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
                raise InputError(f"--box {name} = {low}:{high} is not finite; give numbers as LOW:HIGH")
            if low > high:
                raise InputError(f"--box {name} = {low:g}:{high:g} is empty; give the smaller number first")
        if not (-0.5 * math.pi <= self.phi[0] and self.phi[1] <= 0.5 * math.pi):
            raise InputError("--box phi must lie between -pi/2 and pi/2 (-1.5708:1.5708)")
        if abs(self.phi[0]) == 0.5 * math.pi and self.phi[0] == self.phi[1]:
            raise InputError("--box phi is flat; give -pi/2 < phi < pi/2")

    @classmethod
    def default(cls, disk: Disk) -> "Box":
        """phi = 0 and the other coordinates within two natural units sqrt(g/r)."""
        two = 2.0 * disk.rate_unit
        return cls((0.0, 0.0), (-two, two), (-two, two), (-two, two))

    @classmethod
    def parse(cls, text: str, default: "Box") -> "Box":
        """A box from "phi=0,phidot=-2:2,..."; what is left out keeps the default. Raises InputError."""
        return replace(default, **parse_ranges(text, "--box"))

    @property
    def free(self) -> list[str]:
        """Coordinates that vary."""
        return [name for name in COORDINATES if getattr(self, name)[0] < getattr(self, name)[1]]

    def draw(self, random: "Stream", count: int) -> dict[str, Array]:
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
    ranges: dict[str, Range] = {}
    for name, value in _pairs(given) if isinstance(given, str) else given.items():
        if name not in known:
            raise InputError(f"{option}: unknown coordinate {shown(name)}; {suggest(name, known)}")
        if value is None or name in ranges:
            raise InputError(f"{option}: {shown(name)}; write each coordinate once, NAME=VALUE or LOW:HIGH")
        ranges[name] = parse_range(value, f"{option} {name}")
    return ranges


def _pairs(text: str) -> Iterator[tuple[str, str | None]]:
    """Names and what stands behind them, None where nothing does."""
    for item in text.split(","):
        name, equals, value = (part.strip() for part in item.partition("="))
        yield name, value if equals else None


def parse_range(given: Any, option: str) -> Range:
    """(low, high) from "LOW:HIGH", one number, or a pair. Raises InputError naming the option."""
    parts = given.split(":") if isinstance(given, str) else given if isinstance(given, list | tuple) else [given]
    ends = [double_of(part) for part in parts]
    if not 1 <= len(ends) <= 2 or ends[0] is None or ends[-1] is None:
        raise InputError(f"{option} = {shown(given)} is not a number or a range LOW:HIGH")
    return ends[0], ends[-1]


def chunk_stream(seed: int, index: int) -> np.random.Generator:
    """The random stream of chunk `index`; only its uniform doubles are used, which no numpy release changes."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(index,))))


class Stream(Protocol):
    """What draws uniform doubles in [0, 1): a generator of NumPy, or its numbers made in lanes."""

    def random(self, size: int | tuple[int, int], /) -> Array: ...


class LaneStream:
    """The numbers of `chunk_stream`, made in lanes: in a third of the time."""

    KERNELS = ("philox.uniform_batch",)

    def __init__(self, seed: int, index: int) -> None:
        key = chunk_stream(seed, index).bit_generator.state["state"]["key"]
        self._keys, self._place = compiled.philox.round_keys(key), 0
        self._first, self._length = 0, 0

    def of_rows(self, first: int, length: int) -> "LaneStream":
        """A stream of what this one gives from place `first` on in each row of so many numbers.

        Columns of a chunk are drawn one after the other; so a block of all of them can be drawn at a time.
        """
        part = copy(self)
        part._first, part._length = first, length
        return part

    def random(self, size: int | tuple[int, int], /) -> Array:
        """The next numbers; of rows, one for each row of `size`."""
        drawn = np.empty(size)
        for row in drawn.reshape(-1, drawn.shape[-1]) if self._length else (drawn.reshape(-1),):
            compiled.philox.uniform_batch(self._place + self._first, self._keys, row)
            self._place += self._length or row.size
        return drawn


def signs(unit: Array) -> Array:
    """1 where a uniform double is below 1/2, else -1; doubles from a stream are multiples of 2^-53."""
    return np.copysign(1.0, (0.5 - 2.0**-54) - unit)


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

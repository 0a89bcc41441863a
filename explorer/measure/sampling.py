"""Boxes from which initial states are drawn, and seeded streams.

dphi dphidot dsigma3 dsigma4 is invariant under the reduced flow (its vector field has no
divergence in these coordinates), so uniform draws in a box of them are draws from the natural measure.
Each stream gives PER_STREAM samples of a run, in order, so a sample depends on the seed and its place
in the run, never on the size of chunks or the number of workers.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Self

import numpy as np

from explorer.errors import InputError, one_of, shown
from explorer.phase.arguments import read_pair, read_range
from explorer.phase.coordinates import ANGULAR, KNOWN, angle_unit, chart_of, recognise
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, States

Range = tuple[float, float]
Stream = np.random.Generator

PER_STREAM = 1 << 16  # samples of a run that are drawn from one random stream; another number would give others
BLOCK = 8192  # draws at once: a few columns of them stay in a processor's cache
_HALF_PI = 0.5 * math.pi
# Between which numbers coordinates lie, and in words; flat itself is no state.
_ENDS = {
    "phi": (-_HALF_PI, _HALF_PI, "-pi/2 and pi/2"),
    **dict.fromkeys(("theta", "tilt"), (0.0, math.pi, "0 and pi")),
}


@dataclass(frozen=True)
class Ranges:
    """A range for each coordinate of a chart, in rad and the units of the disk; a fixed one has equal ends."""

    ranges: dict[str, Range] = field(hash=False)  # a dict has no hash

    @classmethod
    def of(cls, what: str, given: Mapping[str, Range]) -> Self:
        """From ranges by name. Raises InputError, which says `what`, where they say no state."""
        chart, _ = chart_of(what, given, (0.0, 0.0))
        found = cls({name: given[name] for name in chart.present(given)})
        found.check(what)
        return found

    def check(self, what: str) -> None:
        """Raise InputError where a range is empty or goes beyond what the coordinate may be."""
        for name, (low, high) in self.ranges.items():
            named = f"{what} {pair_said(name, low, high)}"
            if not -math.inf < low <= high < math.inf:
                raise InputError(f"{named}: give finite numbers as LOW:HIGH, the smaller one first")
            least, most, words = _ENDS.get(name, (-math.inf, math.inf, ""))
            if not (least <= low and high <= most):
                raise InputError(f"{named} must lie between {words}; where it is in degrees, say so")
            if low == high and low in (least, most):
                raise InputError(f"{what} {name} is flat; give a number between {words}")
            if name == "face" and not (low == high and abs(low) == 1.0):
                raise InputError(f"{named}: give 1 or -1")

    @property
    def free(self) -> list[str]:
        """Coordinates that vary."""
        return [name for name, (low, high) in self.ranges.items() if low < high]

    def draw(self, random: Stream, count: int) -> dict[str, Array]:
        """`count` states, uniform in these coordinates; one array for each."""
        free = self.free
        unit = dict(zip(free, random.random((len(free), count)), strict=True))
        columns = {name: unit.get(name, np.empty(count)) for name in self.ranges}
        for name, (low, high) in self.ranges.items():
            if name in unit:
                columns[name] *= high - low
                columns[name] += low
            else:
                columns[name][:] = low
        return columns

    def states(self, disk: Disk, columns: Mapping[str, Array]) -> States:
        """The states with such coordinates."""
        return recognise(columns).make(disk, **columns)

    def describe(self) -> dict[str, list[float]]:
        """The entry of run.json."""
        return {name: list(span) for name, span in self.ranges.items()}


class Box(Ranges):
    """One in phi, phidot, sigma3 and sigma4, in which the measure is invariant."""

    def __init__(self, phi: Range, phidot: Range, sigma3: Range, sigma4: Range) -> None:
        super().__init__(dict(zip(COORDINATES, (phi, phidot, sigma3, sigma4), strict=True)))
        self.check("box")

    @classmethod
    def default(cls, disk: Disk) -> "Box":
        """phi = 0 and the other coordinates within two natural units sqrt(g/r)."""
        two = 2.0 * disk.rate_unit
        return cls((0.0, 0.0), (-two, two), (-two, two), (-two, two))


def box_of(disk: Disk, given: Mapping[str, Range]) -> Ranges:
    """The box of ranges in rad: of phi, phidot, sigma3 and sigma4, with defaults, or of another chart."""
    if set(given) <= set(COORDINATES):
        return Box(**{**Box.default(disk).ranges, **given})
    return Ranges.of("box", given)


def in_radians(given: Mapping[str, Range], degrees: bool) -> dict[str, Range]:
    """Ranges whose angles, and rates of angles, may be in degrees."""
    units = {name: angle_unit(name, degrees) for name in given}
    return {name: (low * units[name], high * units[name]) for name, (low, high) in given.items()}


def pair_said(name: str, first: float, second: float) -> str:
    """A range or a Gaussian of a coordinate, as messages show it: degrees have become radians by then."""
    return f"{name} = {first:g}:{second:g}" + (" (radians)" if name in ANGULAR else "")


def read_ranges(option: str, given: Any) -> dict[str, Range]:
    """{"phi": (0, 0), ...} from "phi=0,phidot=-2:2", a mapping or `Ranges`. Raises InputError."""
    return _by_coordinate(option, given, read_range, "phi=0,phidot=-2:2")


def read_gaussians(option: str, given: Any) -> dict[str, Range]:
    """{"phidot": (0.5, 0.3), ...} from "phidot=0.5:0.3" or a mapping. Raises InputError naming the option."""
    return _by_coordinate(option, given, partial(read_pair, form="MEAN:DEVIATION"), "phidot=0.5:0.3")


def _by_coordinate(option: str, given: Any, read: Callable[[str, Any], Range], example: str) -> dict[str, Range]:
    """Two numbers for each coordinate; none of None."""
    if given is None or isinstance(given, Ranges):
        given = given.describe() if given else {}
    if not isinstance(given, str | Mapping):
        raise InputError(f'{option} {shown(given)} is no text; write "{example}"')
    items = given.items() if isinstance(given, Mapping) else (part.split("=", 1) for part in given.split(","))
    ranges: dict[str, Range] = {}
    for name, *values in items:
        name = one_of(f"{option} coordinate", str(name).strip(), KNOWN)
        if name in ranges:
            raise InputError(f"{option}: {name} is there twice; write each coordinate once")
        ranges[name] = read(f"{option} {name}", values[0] if values else "")
    return ranges


def numbered_stream(seed: int, number: int) -> Stream:
    """Random stream `number`; only its uniform doubles are used, which no numpy release changes."""
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=(number,))))


def stream_of(rng: Any) -> Stream:
    """The random stream of a seed, a SeedSequence or a Generator. Raises InputError."""
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise InputError(f"rng = {shown(rng)}: give a whole number, a SeedSequence or a Generator") from None


def signs(unit: Array) -> Array:
    """1 where a uniform double is below 1/2, else -1."""
    return np.where(unit < 0.5, 1.0, -1.0)


def log_uniform(unit: Array, low: float, high: float) -> Array:
    """Map uniform doubles to a log-uniform magnitude between low and high."""
    return low * (high / low) ** unit

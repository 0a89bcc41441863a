"""Distributions of initial states as users give them: each coordinate a distribution, a range or a number."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import InputError, double_of, shown, sign, suggest
from explorer.measure.density import ANY_ENERGY, Density
from explorer.measure.sampling import Range, Stream
from explorer.phase.arguments import read_range
from explorer.phase.coordinates import Chart, angle_unit, chart_of, recognise, warn_of_degrees
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart, line_slope
from explorer.phase.states import COORDINATES, Array, States

_TILTS, _SPEEDS = ("phi", "theta", "tilt"), ("phidot", "thetadot", "tilt_rate", "energy")
# Shares of a distribution below its nodes, and by symmetry above: a third of them in its middle, the others
# where it is as thin as a tail that the falling set may need.
_MIDDLE = np.linspace(0.02, 0.98, 25)
_OF_FROZEN = "pdf", "ppf", "isf", "support"  # those of scipy.stats that are not frozen have them, too
_LARGEST = 1e60  # nodes beyond are left out: energies would overflow
_TAIL = 10.0 ** -np.geomspace(2, 300, 25)


@dataclass(frozen=True)
class Coordinate:
    """One coordinate. Values are in rad and the units of the disk; unit: what one of the user's is of these.

    law: a frozen distribution of scipy.stats, of the user's values; None where it is a number, `value`. words:
    what the user gave.
    """

    name: str
    law: Any
    value: float
    unit: float
    words: str

    @classmethod
    def of(cls, name: str, given: Any, unit: float) -> "Coordinate":
        """From a distribution, a range, a number, or text such as "norm:20:2". Raises InputError."""
        if all(hasattr(given, word) for word in _OF_FROZEN) and not hasattr(given, "freeze"):
            return cls(name, given, math.nan, unit, f"~ {_in_words(given)}")
        if isinstance(given, str) and given[:1].isalpha() and double_of(given) is None:
            return cls(name, _by_name(name, given), math.nan, unit, f"~ {given}")
        try:
            low, high = read_range(name, given)
        except InputError:
            raise InputError(
                f"{name} = {shown(given)}: give a number, a range (low, high) or LOW:HIGH, or a continuous frozen "
                "distribution, scipy.stats.norm(20, 2) or norm:20:2"
            ) from None
        if low == high:
            return cls(name, None, low * unit, unit, f"= {low:g}")
        from scipy.stats import uniform

        return cls(name, uniform(low, high - low), math.nan, unit, f"= {low:g}:{high:g}")

    @property
    def free(self) -> bool:
        """Whether it varies."""
        return self.law is not None

    def draw(self, random: Stream, count: int) -> Array:
        """Independent values, from uniform doubles alone, which are the same in every release of NumPy."""
        if not self.free:
            return np.full(count, self.value)
        return np.asarray(self.law.ppf(random.random(count)), np.float64) * self.unit

    def density(self, values: Array) -> Array:
        """Its density; 1 of a number."""
        if not self.free:
            return np.ones(np.shape(values))
        with np.errstate(all="ignore"):
            return np.nan_to_num(np.asarray(self.law.pdf(values / self.unit)) / self.unit, nan=0.0)

    @cached_property
    def spread(self) -> float:
        """Between which half of its values lie: how far from each other; 0 of a number."""
        if not self.free:
            return 0.0
        low, high = self.law.ppf([0.25, 0.75])
        return float(high - low) * self.unit

    @cached_property
    def nodes(self) -> Array:
        """Values between which its density changes little, far into its tails; the one of a number."""
        if not self.free:
            return np.array([self.value])
        with np.errstate(all="ignore"):
            parts = self.law.support(), self.law.ppf(_TAIL), self.law.ppf(_MIDDLE), self.law.isf(_TAIL)
        nodes = np.unique(np.concatenate([np.asarray(part, np.float64).ravel() for part in parts]))
        found: Array = nodes[abs(nodes) < _LARGEST] * self.unit
        if found.size < 2:
            raise InputError(f"{self.name}: {shown(self.law)} has no quantiles; check its parameters")
        return found

    def __str__(self) -> str:
        return f"{self.name} {self.words}" + ("" if self.unit == 1.0 else " in degrees")


def _in_words(law: Any) -> str:
    """The name and the parameters of a frozen distribution."""
    name = getattr(getattr(law, "dist", None), "name", type(law).__name__)
    named = [f"{word}={value}" for word, value in getattr(law, "kwds", {}).items()]
    return f"{name}({', '.join([*map(str, getattr(law, 'args', ())), *named])})"


def _by_name(name: str, text: str) -> Any:
    """A distribution of scipy.stats from "norm:20:2", its name and arguments."""
    from scipy import stats

    word, *parts = text.split(":")
    numbers = [double_of(part) for part in parts]
    if not isinstance(getattr(stats, word, None), stats.rv_continuous):
        known = [each for each in dir(stats) if isinstance(getattr(stats, each), stats.rv_continuous)]
        raise InputError(f"{name} {text}: {word!r} is no distribution of scipy.stats; {suggest(word, known)}")
    try:
        law = getattr(stats, word)(*numbers)
    except TypeError as error:
        raise InputError(f"{name} {text}: {error}; write for instance norm:MEAN:DEVIATION") from None
    if not parts or None in numbers or not np.isfinite(law.median()):
        raise InputError(f"{name} {text}: not the parameters of {word}; write for instance norm:MEAN:DEVIATION")
    return law


@dataclass(frozen=True)
class Factor:
    """A coordinate's own factor of a density, as far as a frozen distribution of scipy.stats is asked here."""

    density: Density
    name: str

    def pdf(self, values: Array) -> Array:
        low, high = self.support()
        bell = self.density.factor(self.name, values)
        return np.where((values >= low) & (values <= high), bell / self.density.factor_mass(self.name), 0.0)

    def ppf(self, share: ArrayLike) -> Array:
        return self.density.quantile(self.name, np.asarray(share))

    def isf(self, share: Array) -> Array:
        return self.ppf(1.0 - share)

    def support(self) -> Range:
        return self.density.box.ranges[self.name]


@dataclass(frozen=True)
class Distribution:
    """Independent coordinates of one chart: which tilt, which speed, and which pair stands for the spins.

    face: what the user's tilt is measured from; +1 where it is phi.
    """

    disk: Disk
    chart: Chart
    coordinates: dict[str, Coordinate]
    face: int
    density: Density | None = None

    @classmethod
    def of(cls, disk: Disk, given: Mapping[str, Any], degrees: bool) -> "Distribution":
        """From what users give by name. Raises InputError."""
        there = {name: value for name, value in given.items() if value is not None}
        chart, values = chart_of("coordinates", there, 0.0)
        face = sign("face", values.pop("face", 1))
        found = {name: Coordinate.of(name, value, angle_unit(name, degrees)) for name, value in values.items()}
        if "tilt" in found and not degrees:
            warn_of_degrees(np.atleast_1d(np.median(found["tilt"].nodes)))
        return cls(disk, chart, found, face)

    @classmethod
    def of_density(cls, disk: Disk, density: Density) -> "Distribution":
        """The factors of a density's coordinates, without what else it is times."""
        found = {
            name: Coordinate(name, Factor(density, name) if density.free(name) else None, low, 1.0, "")
            for name, (low, _) in density.box.ranges.items()
        }
        return cls(disk, recognise(found), found, 1, density)

    @property
    def tilt(self) -> Coordinate:
        """The tilt from flat, or phi."""
        return next(each for name, each in self.coordinates.items() if name in _TILTS)

    @property
    def speed(self) -> Coordinate:
        """The rate of the tilt, or the energy."""
        return next(each for name, each in self.coordinates.items() if name in _SPEEDS)

    @property
    def pair(self) -> tuple[Coordinate, Coordinate]:
        """The two that stand for the spins, in the order of the chart."""
        names = [name for name in self.chart.needed if name not in (*_TILTS, *_SPEEDS)]
        return self.coordinates[names[0]], self.coordinates[names[1]]

    def draw(self, random: Stream, count: int) -> dict[str, Array]:
        """Independent values of all coordinates."""
        return {name: each.draw(random, count) for name, each in self.coordinates.items()}

    def states(self, columns: Mapping[str, Array]) -> States:
        """The states with such coordinates."""
        face = {"face": np.full(columns[self.tilt.name].size, float(self.face))}
        given = {**columns, **face}
        return self.chart.make(self.disk, **{name: given[name] for name in self.chart.present(given)})

    @property
    def plain(self) -> bool:
        """Whether it is that of its coordinates alone."""
        density = self.density
        return density is None or (density.energy == ANY_ENERGY and density.function is None)

    def weighed(self, states: States, weight: Array) -> Array:
        """Weights of draws from the laws of the coordinates, times what else the density is."""
        if self.density is None or self.plain:
            return weight
        rows, found = np.flatnonzero(weight > 0.0), np.zeros(weight.size)
        some, (low, high) = states.at(rows), self.density.energy
        energy = some.motion.energy * self.disk.energy_unit
        some, rows = some.at(inside := np.flatnonzero((energy >= low) & (energy <= high))), rows[inside]
        found[rows] = weight[rows]
        if self.density.function is not None:
            found[rows] *= self.density.called({name: getattr(some, name) for name in COORDINATES})
        return found

    def place(self, tilt: Array) -> tuple[Array, Array]:
        """Cos phi and sin phi at these values of the tilt, which keep the digits of small ones."""
        if self.tilt.name == "phi":
            return np.cos(tilt), np.sin(tilt)
        return np.sin(tilt), self.face * np.cos(tilt)

    def phidot(self, speed: Array) -> Array:
        """The rate of phi, natural units, at these values of a rate of the tilt."""
        seen = 1.0 if self.speed.name == "phidot" else -self.face
        return seen * speed / self.disk.rate_unit

    def spins(self, q: Array, z: Array, face: int) -> Array:
        """How the pair follows from sigma3_bar and eta_hat of a face (natural units): (2, 2, n) at such places."""
        chart, slope = line_chart(self.disk, q, face * z), line_slope(self.disk)
        one, none = np.ones_like(q), np.zeros_like(q)
        names = self.pair[0].name, self.pair[1].name
        first = np.stack([chart.bar_to_sigma3, chart.eta_hat_to_sigma3])
        second = face * np.stack([chart.bar_to_sigma4, chart.eta_hat_to_sigma4])
        if names == ("precession", "spin"):
            first = first / (q * q)
        if names[0] == "sigma3_bar":
            first = np.stack([one, none])
        if names[1] == "sigma4_bar":
            second = face * np.stack([slope * one, -one])
        if names[1] == "eta_hat":
            second = np.stack([none, one]) if face == self.face else np.stack([2.0 * slope * one, -one])
        return np.stack([first, second]) * self.disk.rate_unit

    def __str__(self) -> str:
        return ", ".join(map(str, self.coordinates.values()))

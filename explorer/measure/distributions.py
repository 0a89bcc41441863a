"""Distributions of initial states: a law for each coordinate, times a weight if one is given, within energies.

A law is even between two numbers, a number, or a distribution of scipy.stats. Coordinates are independent, and
drawn from uniform doubles by the inverse of their distribution functions. What else there is, rejection obeys.
"""

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, double_of, one_of, shown, sign, suggest
from explorer.measure.sampling import BLOCK, Range, Stream
from explorer.phase.arguments import read_range, returned_numbers
from explorer.phase.coordinates import KNOWN, Chart, angle_unit, chart_of, recognise, warn_of_degrees
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart, line_slope
from explorer.phase.results import stacked
from explorer.phase.states import COORDINATES, Array, States

ANY_ENERGY: Range = (-math.inf, math.inf)
_HALF_PI = 0.5 * math.pi
# Between which numbers coordinates lie, and in words; flat itself is no state.
_ENDS = {
    "phi": (-_HALF_PI, _HALF_PI, "-pi/2 and pi/2"),
    **dict.fromkeys(("theta", "tilt"), (0.0, math.pi, "0 and pi")),
}
_TILTS, _SPEEDS = ("phi", "theta", "tilt"), ("phidot", "thetadot", "tilt_rate", "energy")
# Shares of a distribution below its nodes, and by symmetry above: a third of them in its middle, the others
# where it is as thin as a tail that the falling set may need.
_MIDDLE = np.linspace(0.02, 0.98, 25)
_TAIL = 10.0 ** -np.geomspace(2, 300, 25)
_LARGEST = 1e60  # nodes beyond are left out: energies would overflow
_OF_FROZEN = "pdf", "ppf", "isf", "support"  # those of scipy.stats that are not frozen have them, too
# Points at which a weight is looked at for its maximum, and how far it may exceed the largest value there: a
# maximum that is missed costs digits where it is assumed too large, and an InputError where too small.
_SEARCHED, _HEADROOM = 1 << 15, 1.5
# Distance from flat, over pi/2, and the share of its largest value below which it counts as zero there.
_BESIDE, _VANISHING = 1e-9, 1e-3
_SMALLEST_SHARE = 1e-4  # of draws that are kept, below which rejection gives up: it would take 10^4 times as long
_TRIED = 8  # blocks before it does
_IDENTIFYING = 256  # points at which a weight is looked at for the digest that tells it from others
# Natural units: with faster rates or a smaller inertia the lines l_+- are too steep for doubles.
_FASTEST, _LEAST = 1e4, 1e-4
Weight = Callable[..., Array]


@dataclass(frozen=True)
class Coordinate:
    """The law of one coordinate: even from low to high, a number where these are equal, or one of scipy.stats.

    low, high: in what the user gave. unit: what one of these is in rad and the units of the disk; negative in a
    mirror image. law: a frozen distribution of scipy.stats, of the user's values. text: "norm:20:2" of it; empty
    where it has none.
    """

    name: str
    low: float
    high: float
    unit: float = 1.0
    law: Any = field(default=None, compare=False)
    text: str = ""

    @classmethod
    def of(cls, name: str, given: Any, unit: float = 1.0, what: str = "") -> "Coordinate":
        """From a distribution, a range, a number, or text such as "norm:20:2". Raises InputError, with `what`."""
        named = f"{what} {name}".lstrip()
        if all(hasattr(given, word) for word in _OF_FROZEN) and not hasattr(given, "freeze"):
            if np.ndim(given.support()[0]):
                raise InputError(f"{named} = {shown(given)}: its parameters are arrays; give numbers")
            low, high = map(float, given.support())
            return cls(name, low, high, unit, given, _text_of(given))
        if isinstance(given, str) and given[:1].isalpha() and double_of(given) is None:
            return replace(cls.of(name, _by_name(named, given), unit), text=given)
        frozen = "a continuous frozen distribution, scipy.stats.norm(20, 2) or norm:20:2"
        if any(hasattr(given, word) for word in ("pdf", "rvs")) and not hasattr(given, "ppf"):
            raise InputError(f"{named} = {shown(given)}: has no ppf, by which it could be drawn; give {frozen}")
        try:
            return cls(name, *read_range(named, given), unit)
        except InputError as error:
            raise InputError(f"{error}; or a number, or {frozen}") from None

    @property
    def free(self) -> bool:
        """Whether it varies."""
        return self.low < self.high

    @cached_property
    def ends(self) -> Range:
        """Its smallest and largest value, rad and the units of the disk."""
        low, high = sorted((self.low * self.unit, self.high * self.unit))
        return low, high

    def quantile(self, share: Array) -> Array:
        """The values below which these shares of its draws lie."""
        low, high = self.ends
        with np.errstate(all="ignore"):
            found: Array = share * (high - low) + low if self.law is None else self.law.ppf(share) * self.unit
        return found

    def draw(self, random: Stream, count: int) -> Array:
        """Independent values, from uniform doubles alone, which are the same in every release of NumPy."""
        return self.quantile(random.random(count)) if self.free else np.full(count, self.ends[0])

    def between(self, low: Array, high: Array, share: Array) -> tuple[Array, Array]:
        """Draws between two bounds, made of uniform doubles, and weights, whose mean is how often one is there."""
        if self.law is not None:
            at = self.quantile(share)
            return at, np.asarray((low <= at) & (at <= high), np.float64)
        low, high = np.maximum(low, self.ends[0]), np.minimum(high, self.ends[1])
        length = np.maximum(high - low, 0.0)
        return low + length * share, length / (self.ends[1] - self.ends[0])

    def density(self, values: Array) -> Array:
        """Its density; 1 of a number."""
        low, high = self.ends
        if not self.free:
            return np.ones(np.shape(values))
        if self.law is None:
            return np.where((low <= values) & (values <= high), 1.0 / (high - low), 0.0)
        with np.errstate(all="ignore"):
            return np.nan_to_num(np.asarray(self.law.pdf(values / self.unit)) / abs(self.unit), nan=0.0)

    @cached_property
    def spread(self) -> float:
        """Between which half of its values lie: how far from each other; 0 of a number."""
        first, last = self.quantile(np.array([0.25, 0.75]))
        return float(abs(last - first))

    @cached_property
    def nodes(self) -> Array:
        """Values between which its density changes little, far into its tails; the one of a number."""
        if not self.free:
            return np.array(self.ends[:1])
        with np.errstate(all="ignore"):
            upper = self.quantile(1.0 - _TAIL) if self.law is None else self.law.isf(_TAIL) * self.unit
        nodes = np.unique(np.concatenate([self.ends, self.quantile(_TAIL), self.quantile(_MIDDLE), upper]))
        found: Array = nodes[abs(nodes) < _LARGEST]
        if found.size < 2:
            raise InputError(f"{self.name}: {shown(self.law)} has no quantiles; check its parameters")
        return found

    def check(self, what: str) -> None:
        """Raise InputError where it goes beyond what the coordinate may be."""
        named = f"{what} {self.name} = {self.text or f'{self.low:g}:{self.high:g}'}"
        least, most, words = _ENDS.get(self.name, (-math.inf, math.inf, ""))
        if self.law is None and not (least <= self.ends[0] and self.ends[1] <= most):
            raise InputError(f"{named} must lie between {words}; where it is in degrees, say so")
        if not self.free and self.ends[0] in (least, most):
            raise InputError(f"{what} {self.name} is flat; give a number between {words}")
        if self.name == "face" and (self.free or abs(self.low) != 1.0):
            raise InputError(f"{named}: give 1 or -1")

    def describe(self) -> str | list[float]:
        """The entry of run.json. Raises InputError for a law that cannot be read back."""
        if self.law is not None and not self.text:
            raise InputError(
                f"{self.name} = {shown(self.law)}: scipy.stats does not know it by name, so no run can record "
                "it; give one that it knows, or density"
            )
        return self.text or [self.low, self.high]

    def __str__(self) -> str:
        words = f"= {self.low:g}:{self.high:g}" if self.free else f"= {self.low:g}"
        words = words if self.law is None else f"~ {self.text or type(self.law).__name__}"
        return f"{self.name} {words}" + ("" if self.unit == 1.0 else " in degrees")


def _text_of(law: Any) -> str:
    """The name and the parameters of a frozen distribution of scipy.stats; empty where they do not say it."""
    from scipy import stats

    dist: Any = getattr(law, "dist", None)
    named = getattr(stats, str(getattr(dist, "name", "")), None)
    if not isinstance(named, stats.rv_continuous) or type(named) is not type(dist):
        return ""
    names = [word.strip() for word in (dist.shapes or "").split(",") if word.strip()]
    given = {"loc": 0.0, "scale": 1.0} | dict(zip([*names, "loc", "scale"], law.args, strict=False)) | law.kwds
    numbers = [double_of(given.get(word)) for word in (*names, "loc", "scale")]
    if None in numbers:
        return ""
    short = [f"{x:g}" for x in numbers]
    return ":".join([dist.name, *(y if float(y) == x else repr(x) for x, y in zip(numbers, short, strict=True))])


def _by_name(named: str, text: str) -> Any:
    """A distribution of scipy.stats from "norm:20:2", its name and arguments."""
    from scipy import stats

    word, *parts = text.split(":")
    numbers = [double_of(part) for part in parts]
    if not isinstance(getattr(stats, word, None), stats.rv_continuous):
        names = [each for each in dir(stats) if isinstance(getattr(stats, each), stats.rv_continuous)]
        raise InputError(f"{named} {text}: {word!r} is no distribution of scipy.stats; {suggest(word, names)}")
    try:
        law = getattr(stats, word)(*numbers)
        with np.errstate(all="ignore"):
            known = np.isfinite(law.median())
    except TypeError as error:
        raise InputError(f"{named} {text}: {error}; write for instance norm:MEAN:DEVIATION") from None
    if not parts or None in numbers or not known:
        raise InputError(f"{named} {text}: not the parameters of {word}; write for instance norm:MEAN:DEVIATION")
    return law


def read_given(option: str, given: Any) -> dict[str, Any]:
    """What is given by name, in "phi=0,phidot=norm:0:1" or a mapping; nothing of None. Raises InputError."""
    if not isinstance(given, str | Mapping | None):
        raise InputError(f'{option} {shown(given)} is no text; write "phi=0,phidot=-2:2"')
    pairs = [part.split("=", 1) for part in given.split(",")] if isinstance(given, str) else (given or {}).items()
    found: dict[str, Any] = {}
    for name, *values in pairs:
        name = one_of(f"{option} coordinate", str(name).strip(), KNOWN)
        if name in found:
            raise InputError(f"{option}: {name} is there twice; write each coordinate once")
        found[name] = values[0] if values else ""
    return found


def read_coordinates(what: str, given: Mapping[str, Any], degrees: bool = False) -> dict[str, Coordinate]:
    """The coordinates of a chart, in its order. Raises InputError, which says `what`, where they say no state."""
    chart, _ = chart_of(what, given, 0.0)
    units = {name: angle_unit(name, degrees) for name in chart.present(given)}
    return {name: Coordinate.of(name, given[name], unit, what) for name, unit in units.items()}


@dataclass(frozen=True)
class Distribution:
    """Independent coordinates of one chart, in these energies (units of the disk), times a weight.

    weight: called with the coordinates by their order but the face, arrays of one length in rad and the units of
    the disk; not negative.
    """

    disk: Disk
    coordinates: dict[str, Coordinate] = field(hash=False)  # a dict has no hash
    energy: Range = ANY_ENERGY
    weight: Weight | None = None

    def __post_init__(self) -> None:
        low, high = self.energy
        if not low < high:
            raise InputError(f"energy {low:g}:{high:g} is empty; give LOW:HIGH, the smaller number first")
        if self.weight is not None and not callable(self.weight):
            raise InputError(f"density = {shown(self.weight)} cannot be called; give a function of arrays")

    @classmethod
    def of(cls, disk: Disk, given: Mapping[str, Any], degrees: bool = False) -> "Distribution":
        """From what users give by name, in any chart. Raises InputError."""
        there = {name: value for name, value in given.items() if value is not None}
        if "face" in there:
            there["face"] = sign("face", there["face"])
        _, complete = chart_of("coordinates", there, 0.0)
        found = cls(disk, read_coordinates("", complete, degrees))
        if "tilt" in found.coordinates and not degrees:
            warn_of_degrees(np.atleast_1d(np.median(found.tilt.nodes)))
        return found

    @classmethod
    def box(cls, disk: Disk, given: Any = None, degrees: bool = False) -> "Distribution":
        """From text or a mapping. phi = 0 and rates within two natural units where phi and its like are left out.

        Raises InputError.
        """
        if isinstance(given, Distribution):
            return replace(given, disk=disk)
        there = read_given("box", given)
        if set(there) <= set(COORDINATES):
            two = 2.0 * disk.rate_unit
            usual = {"phi": (0.0, 0.0), **dict.fromkeys(COORDINATES[1:], (-two, two))}
            in_units = {name: [end / angle_unit(name, degrees) for end in both] for name, both in usual.items()}
            there = in_units | there
        found = read_coordinates("box", there, degrees)
        for each in found.values():
            each.check("box")
        return cls(disk, found)

    @classmethod
    def invariant(
        cls, disk: Disk, box: Any = None, energy: Any = None, density: Weight | None = None
    ) -> "Distribution":
        """In the coordinates in which the measure is invariant, from what users give. Raises InputError."""
        found = cls.box(disk, box)
        if {*found.coordinates} != {*COORDINATES}:
            raise InputError(
                f"box: give {', '.join(COORDINATES)}, in which the measure is invariant; probability takes "
                "distributions of other coordinates"
            )
        for name in COORDINATES[1:]:
            # Of a law whose tails have no end, the middle.
            if max(abs(found.coordinates[name].quantile(np.array([0.01, 0.99])))) > _FASTEST * disk.rate_unit:
                raise InputError(
                    f"box {name}: rates beyond {_FASTEST:g} sqrt(g/r) are not sampled; give a narrower range"
                )
        if max(map(abs, (phi := found.coordinates["phi"]).ends)) > _HALF_PI:
            raise InputError(f"box {phi}: goes beyond flat, phi = +-pi/2; cut it off, as truncnorm does")
        if not min(disk.body.I1, disk.body.k) >= _LEAST:
            raise InputError(
                f"disk: I1/(m r^2) = {disk.body.I1:g}, I3/I1 = {disk.body.k:g}: below {_LEAST:g} the lines of the "
                "falling set are too steep for this; give a disk with larger ones"
            )
        bounds = ANY_ENERGY if energy is None else read_range("energy", energy, unbounded=True)
        return replace(found, energy=bounds, weight=density)

    @cached_property
    def chart(self) -> Chart:
        """The chart of the coordinates."""
        return recognise(self.coordinates)

    @property
    def plain(self) -> bool:
        """Whether it is that of its coordinates alone."""
        return self.energy == ANY_ENERGY and self.weight is None

    @property
    def face(self) -> int:
        """The face from which a tilt is measured; +1 where it is phi."""
        return int(self.coordinates["face"].low) if "face" in self.coordinates else 1

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

    @property
    def why_not_near_f(self) -> str:
        """Why states as near F as one likes cannot be drawn; empty where they can."""
        first, second = self.pair
        names = f"{first.name} and {second.name}"
        if first.free or second.free:
            return f"{names}: eta_hat is fixed" if second.name == "eta_hat" and not second.free else ""
        return f"{names} are both fixed, so that the falling set is met at single tilts or not at all"

    # Draws

    def draw_laws(self, random: Stream, count: int) -> dict[str, Array]:
        """Independent values of all coordinates."""
        return {name: each.draw(random, count) for name, each in self.coordinates.items()}

    def draw(self, random: Stream, count: int) -> dict[str, Array]:
        """`count` draws, by rejection where there is more than the laws of the coordinates.

        Raises InputError where hardly a draw is kept, or where a weight turns out larger than at the points at
        which its maximum was sought.
        """
        if self.plain:
            return self.draw_laws(random, count)
        kept: list[dict[str, Array]] = []
        have = tried = 0
        while have < count:
            drawn = self.draw_laws(random, BLOCK)
            good = self._kept(drawn, random)
            kept.append({name: values[good] for name, values in drawn.items()})
            have, tried = have + int(good.sum()), tried + good.size
            if tried >= _TRIED * BLOCK and have < _SMALLEST_SHARE * tried:
                what = "energy" if self.energy != ANY_ENERGY else "density"
                raise InputError(
                    f"{what}: only {have} of {tried} draws from the box were kept; widen it or shrink the box"
                )
        return {name: values[:count] for name, values in stacked(kept).items()}

    def _kept(self, drawn: dict[str, Array], random: Stream) -> NDArray[np.bool_]:
        """Which draws from the laws rejection keeps."""
        good = np.ones(BLOCK, bool)
        if self.energy != ANY_ENERGY:
            good = self._in_energies(self.states(drawn))
        if self.weight is not None:
            values = self.called(drawn)
            if values.max() > self._bound:
                raise InputError(
                    f"density: is {values.max():g}, more than {_HEADROOM:g} times its largest value at "
                    f"{_SEARCHED} points of the box; shrink the box to where it is large"
                )
            good &= random.random(BLOCK) * self._bound < values
        return good

    def _in_energies(self, states: States) -> NDArray[np.bool_]:
        energy = states.motion.energy * self.disk.energy_unit
        inside: NDArray[np.bool_] = (energy >= self.energy[0]) & (energy <= self.energy[1])
        return inside

    def states(self, columns: Mapping[str, Array]) -> States:
        """The states with such coordinates."""
        count = next(iter(columns.values())).size
        given = {"face": np.full(count, float(self.face)), **columns}
        return self.chart.make(self.disk, **{name: given[name] for name in self.chart.present(given)})

    def weighed(self, states: States, weight: Array) -> Array:
        """Weights of draws from the laws of phi, phidot, sigma3 and sigma4, times what else there is."""
        if self.plain:
            return weight
        rows, found = np.flatnonzero(weight > 0.0), np.zeros(weight.size)
        rows = rows[self._in_energies(states.at(rows))]
        some, found[rows] = states.at(rows), weight[rows]
        if self.weight is not None:
            found[rows] *= self.called({name: getattr(some, name) for name in COORDINATES})
        return found

    # The weight

    def called(self, columns: Mapping[str, Array]) -> Array:
        """The weight at coordinates by name. Raises InputError where it is no density."""
        assert self.weight is not None
        first = next(iter(columns.values()))
        count, shape = first.size, first.shape
        copies = (np.array(column).ravel() for name, column in columns.items() if name != "face")
        given = returned_numbers("density", self.weight(*copies))
        if given.shape not in ((), (count,)):
            raise InputError(f"density: returned {shown(given)} for {count} states; return one number for each")
        values = np.full(count, given, np.float64)
        bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
        if bad.size:
            where = ", ".join(f"{name} = {column.flat[bad[0]]:.6g}" for name, column in columns.items())
            raise InputError(
                f"density: is {values[bad[0]]} at {where}; a density is finite and not negative in all of the box"
            )
        return values.reshape(shape)

    @cached_property
    def _searched(self) -> dict[str, Array]:
        """Draws from the laws at which the weight is looked at."""
        return self.draw_laws(np.random.Generator(np.random.Philox(1)), _SEARCHED)

    @cached_property
    def _bound(self) -> float:
        """A value that the weight is taken not to exceed."""
        return _HEADROOM * float(self.called(self._searched).max())

    def describe_weight(self) -> dict[str, str] | None:
        """The entry of run.json: a function is identified by its values at fixed points."""
        if self.weight is None:
            return None
        points = self.draw_laws(np.random.Generator(np.random.Philox(0)), _IDENTIFYING)
        values = self.called(points)
        if (values != self.called(points)).any():
            raise InputError("density: it changes from call to call; give a function of the state alone")
        digest = hashlib.sha256(values.astype("<f8").tobytes()).hexdigest()
        return {"function": getattr(self.weight, "__qualname__", "unnamed"), "sha256_of_values": digest}

    def describe(self) -> dict[str, Any]:
        """The entry of run.json of its coordinates, in what the user gave."""
        return {name: each.describe() for name, each in self.coordinates.items()}

    def __str__(self) -> str:
        return ", ".join(map(str, self.coordinates.values()))

    # phi, phidot, sigma3 and sigma4

    def reaches_flat(self) -> bool:
        """True where it does not vanish at flat and the energy has no bound: there is no C then."""
        phi, searched = self.coordinates["phi"], self._searched

        def density(at: Array) -> float:
            found = phi.density(at)
            if self.weight is not None and found.any():
                found = found * self.called(searched | {"phi": at})
            return float(found.max())

        flat = [np.full(_SEARCHED, end * (1.0 - _BESIDE)) for end in (-_HALF_PI, _HALF_PI)]
        bounded = not phi.free or math.isfinite(self.energy[1])
        return not bounded and max(map(density, flat)) > _VANISHING * density(searched["phi"])

    def seen_from(self, face: int) -> "Distribution":
        """In natural units, as a face sees it.

        Face -1 is the mirror image of face +1, eq. (3.2): all coordinates but sigma3 change their sign.
        """
        rate = self.disk.rate_unit
        units = dict(zip(COORDINATES, (face, face * rate, rate, face * rate), strict=True))

        def weight(*columns: Array) -> Array:
            return self.called({name: units[name] * column for name, column in zip(units, columns, strict=True)})

        low, high = self.energy
        return Distribution(
            self.disk,
            {name: replace(each, unit=each.unit / units[name]) for name, each in self.coordinates.items()},
            (low / self.disk.energy_unit, high / self.disk.energy_unit),
            None if self.weight is None else weight,
        )

    @property
    def volume(self) -> float:
        """The product of the lengths of its ranges, natural units; a law of scipy.stats has the integral 1."""
        ranges = [each.ends for each in self.seen_from(1).coordinates.values() if each.free and each.law is None]
        return math.prod(high - low for low, high in ranges)

    # Places and spins beside F

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

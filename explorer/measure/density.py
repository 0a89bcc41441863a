"""Densities on the phase space, from which initial states are drawn.

A density is a function of (phi, phidot, sigma3, sigma4) in the units of the disk, with respect to the
invariant measure dphi dphidot dsigma3 dsigma4, up to a factor: a box, optionally cut at energies, times
Gaussians, times any function that a user gives. States are drawn from one of the coordinates of any other chart,
too, with respect to these.
"""

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, shown
from explorer.measure.sampling import (
    BLOCK,
    Box,
    Range,
    Ranges,
    Stream,
    box_of,
    pair_said,
    read_gaussians,
    read_ranges,
)
from explorer.phase.arguments import read_range, returned_numbers
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array

ANY_ENERGY: Range = (-math.inf, math.inf)
# Points at which a function is looked at for its maximum, and how far it may exceed the largest value there: a
# maximum that is missed costs digits where it is assumed too large, and an InputError where too small.
_SEARCHED, _HEADROOM = 1 << 15, 1.5
# Distance from flat, over pi/2, and the share of its largest value below which it counts as zero there.
_BESIDE, _VANISHING = 1e-9, 1e-3
_SMALLEST_SHARE = 1e-4  # of draws that are kept, below which rejection gives up: it would take 10^4 times as long
_TRIED = 8  # blocks before it does
_IDENTIFYING = 256  # points at which a function is looked at for the digest that tells it from others
# Natural units: with faster rates or a smaller inertia the lines l_+- are too steep for doubles.
_FASTEST, _LEAST = 1e4, 1e-4
_THINNEST = 1e-6  # standard deviation over the range of the box; a narrower Gaussian is a fixed coordinate
# Standard deviations from the mean beyond which a Gaussian is below the rounding of its largest value, exp(-x^2/2)
# = 2e-16, and beyond which it cannot be told from nothing in doubles.
_REACH, _NOTHING = 8.5, 37.0
Function = Callable[..., Array]


@dataclass(frozen=True)
class Density:
    """A box times whatever else is given; `Density.of` reads what users write.

    energy: only states with an energy in this range, in the units of the disk.
    gaussian: pairs (coordinate, (mean, standard deviation)); cut off where the box ends.
    function: called with the coordinates of the box in their order but the face, as function(phi, phidot, sigma3,
    sigma4), arrays of one length; not negative.
    """

    box: Ranges
    energy: Range = ANY_ENERGY
    gaussian: tuple[tuple[str, Range], ...] = ()
    function: Function | None = None

    def __post_init__(self) -> None:
        if not self.energy[0] < self.energy[1]:
            low, high = self.energy
            raise InputError(f"energy {low:g}:{high:g} is empty; give LOW:HIGH, the smaller number first")
        for name, (mean, deviation) in self.gaussian:
            named = f"gaussian {pair_said(name, mean, deviation)}"
            if name not in self.box.free:
                raise InputError(f"{named}: box has no range for {name}, only for {', '.join(self.box.free)}")
            low, high = self.box.ranges[name]
            outside = max(low - mean, mean - high) > _NOTHING * deviation
            if outside or not (math.isfinite(mean) and _THINNEST * (high - low) <= deviation < math.inf):
                raise InputError(
                    f"{named}: write MEAN:DEVIATION, the deviation at least {_THINNEST:g} of the range in box, "
                    f"and the mean at most {_NOTHING:g} deviations outside of it"
                )
        if self.function is not None and not callable(self.function):
            raise InputError(f"density = {shown(self.function)} cannot be called; give a function of arrays")

    @property
    def plain(self) -> bool:
        """Whether it is uniform in its box."""
        return self.energy == ANY_ENERGY and not self.gaussian and self.function is None

    @classmethod
    def of(
        cls,
        disk: Disk,
        box: Ranges | str | Mapping[str, Any] | None = None,
        energy: Any = None,
        gaussian: str | Mapping[str, Range] | None = None,
        density: Function | None = None,
    ) -> "Density":
        """A density over the invariant measure, from what users give; the box defaults to Box.default.

        Raises InputError.
        """
        found = box if isinstance(box, Ranges) else box_of(disk, read_ranges("box", box))
        if not isinstance(found, Box):
            raise InputError(
                f"box: give {', '.join(COORDINATES)}, in which the measure is invariant; probability takes "
                "distributions of other coordinates"
            )
        for name in COORDINATES[1:]:
            if max(map(abs, found.ranges[name])) > _FASTEST * disk.rate_unit:
                raise InputError(
                    f"box {name}: rates beyond {_FASTEST:g} sqrt(g/r) are not sampled; give a narrower range"
                )
        if not min(disk.body.I1, disk.body.k) >= _LEAST:
            raise InputError(
                f"disk: I1/(m r^2) = {disk.body.I1:g}, I3/I1 = {disk.body.k:g}: below {_LEAST:g} the lines of the "
                "falling set are too steep for this; give a disk with larger ones"
            )
        bounds = ANY_ENERGY if energy is None else read_range("energy", energy, unbounded=True)
        return cls(found, bounds, tuple(read_gaussians("gaussian", gaussian).items()), density)

    def seen_from(self, disk: Disk, face: int) -> "Density":
        """The same in natural units, as a face sees it.

        Face -1 is the mirror image of face +1, eq. (3.2): all coordinates but sigma3 change their sign.
        """
        units = dict(
            zip(COORDINATES, (face, face * disk.rate_unit, disk.rate_unit, face * disk.rate_unit), strict=True)
        )
        low, high = self.energy

        def function(*columns: Array) -> Array:
            return self.called({name: units[name] * column for name, column in zip(units, columns, strict=True)})

        return Density(
            Box(**{name: _in_units(self.box.ranges[name], unit) for name, unit in units.items()}),
            (low / disk.energy_unit, high / disk.energy_unit),
            tuple((name, (mean / units[name], width / abs(units[name]))) for name, (mean, width) in self.gaussian),
            None if self.function is None else function,
        )

    def free(self, name: str) -> bool:
        """Whether a coordinate varies."""
        return name in self.box.free

    def most(self, name: str) -> float:
        """The largest size of a coordinate."""
        return max(map(abs, self.reach(name)))

    def shape(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array) -> Array:
        """The density without the ends of the box and of the energy. Raises InputError where it is no density."""
        columns = dict(zip(COORDINATES, (phi, phidot, sigma3, sigma4), strict=True))
        values = np.ones(phi.shape)
        for name, _ in self.gaussian:
            values *= self.factor(name, columns[name])
        if self.function is not None:
            values *= self.called(columns)
        return values

    def factor(self, name: str, values: Array) -> Array:
        """A coordinate's own factor: a Gaussian, or 1."""
        mean, deviation = self.bell(name) or (0.0, math.inf)
        factor: Array = np.exp(-0.5 * ((values - mean) / deviation) ** 2)
        return factor

    def called(self, columns: dict[str, Array]) -> Array:
        """The function at coordinates by name. Raises InputError where it is no density."""
        assert self.function is not None
        first = next(iter(columns.values()))
        count, shape = first.size, first.shape
        copies = (np.array(column).ravel() for name, column in columns.items() if name != "face")
        given = returned_numbers("density", self.function(*copies))
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

    def draw(self, disk: Disk, random: Stream, count: int) -> dict[str, Array]:
        """`count` states, drawn from the density by rejection; Gaussians by their inverse.

        Raises InputError where hardly a draw is kept, or where a function turns out larger than at the points
        at which its maximum was sought.
        """

        kept: list[dict[str, Array]] = []
        have = tried = 0
        while have < count:
            drawn, good = self._tried(disk, random)
            kept.append({name: values[good] for name, values in drawn.items()})
            have, tried = have + int(good.sum()), tried + good.size
            if tried >= _TRIED * BLOCK and have < _SMALLEST_SHARE * tried:
                what = "energy" if self.energy != ANY_ENERGY else "density"
                raise InputError(
                    f"{what}: only {have} of {tried} draws from the box were kept; widen it or shrink the box"
                )
        return {name: np.concatenate([part[name] for part in kept])[:count] for name in kept[0]}

    def _tried(self, disk: Disk, random: Stream) -> tuple[dict[str, Array], NDArray[np.bool_]]:
        """BLOCK states of the box, and which of them rejection keeps."""
        drawn = self.box.draw(random, BLOCK)
        for name, _ in self.gaussian:
            low, high = self.box.ranges[name]
            drawn[name] = self.quantile(name, (drawn[name] - low) / (high - low))
        good = np.ones(BLOCK, bool)
        if self.energy != ANY_ENERGY:
            energy = self.box.states(disk, drawn).motion.energy * disk.energy_unit
            good = (energy >= self.energy[0]) & (energy <= self.energy[1])
        if self.function is not None:
            values = self.called(drawn)
            if values.max() > self._bound:
                raise InputError(
                    f"density: is {values.max():g}, more than {_HEADROOM:g} times its largest value at "
                    f"{_SEARCHED} points of the box; shrink the box to where it is large"
                )
            good &= random.random(BLOCK) * self._bound < values
        return drawn, good

    def bell(self, name: str) -> Range | None:
        """Mean and standard deviation of a coordinate's own factor, if it has one."""
        return dict(self.gaussian).get(name)

    def quantile(self, name: str, share: Array) -> Array:
        """The values of a coordinate below which these shares of its own factor in the box lie."""
        low, high = map(np.array, self.box.ranges[name])
        return between(low, high, share, self.bell(name))[0]

    def factor_mass(self, name: str) -> float:
        """Integral of a coordinate's own factor over the box."""
        low, high = map(np.array, self.box.ranges[name])
        at, length = between(low, high, np.array(0.5), self.bell(name))
        return float(length * self.factor(name, at))

    def reach(self, name: str) -> Range:
        """The part of the box in which a coordinate's own factor is not zero in doubles."""
        low, high = self.box.ranges[name]
        pair = self.bell(name)
        if pair is None:
            return low, high
        mean, deviation = pair
        # Far from its mean a Gaussian is largest at an end of the box, and falls off from there.
        nearest = (min(max(mean, low), high) - mean) / deviation
        far = deviation * math.hypot(nearest, _REACH)
        return max(low, mean - far), min(high, mean + far)

    @cached_property
    def _searched(self) -> dict[str, Array]:
        """Points of the box at which the density is looked at."""
        return self.box.draw(np.random.Generator(np.random.Philox(1)), _SEARCHED)

    @cached_property
    def _bound(self) -> float:
        """A value that the function is taken not to exceed."""
        return _HEADROOM * float(self.called(self._searched).max())

    def reaches_flat(self) -> bool:
        """True where it does not vanish at flat and the energy has no bound: there is no C then."""
        if "phi" not in self.box.free or math.isfinite(self.energy[1]):
            return False
        largest = self.shape(**self._searched).max()
        flat = [
            np.full(_SEARCHED, end * (1.0 - _BESIDE))
            for end in self.box.ranges["phi"]
            if abs(end) == 0.5 * math.pi
        ]
        return any(self.shape(**self._searched | {"phi": phi}).max() > _VANISHING * largest for phi in flat)

    def describe(self) -> dict[str, Any]:
        """The entry of run.json. A function is identified by its values at fixed points of the box."""
        described: dict[str, Any] = {"box": self.box.describe()}
        if self.energy != ANY_ENERGY:
            described["energy"] = [end if math.isfinite(end) else None for end in self.energy]
        if self.gaussian:
            described["gaussian"] = {name: list(pair) for name, pair in self.gaussian}
        if self.function is not None:
            points = self.box.draw(np.random.Generator(np.random.Philox(0)), _IDENTIFYING)
            values = self.called(points)
            if (values != self.called(points)).any():
                raise InputError("density: it changes from call to call; give a function of the state alone")
            digest = hashlib.sha256(values.astype("<f8").tobytes()).hexdigest()
            described["density"] = {
                "function": getattr(self.function, "__qualname__", "unnamed"),
                "sha256_of_values": digest,
            }
        return described


def _in_units(span: Range, unit: float) -> Range:
    """A range in units of another size, the smaller end first."""
    low, high = sorted(end / unit for end in span)
    return low, high


def between(
    low: Array, high: Array, share: Array, bell: Range | tuple[Array, Array] | None
) -> tuple[Array, Array]:
    """Numbers between low and high by their share of the way, and the length for a step of 1 in the share.

    bell: mean and standard deviation of a Gaussian, in whose own measure the shares are then.
    """
    high = np.maximum(low, high)
    if bell is None:
        return low + (high - low) * share, high - low
    from scipy.special import ndtr, ndtri

    mean, deviation = bell
    # In the nearer tail: far from the middle the other one has no digits.
    sign = np.where(low > mean, -1.0, 1.0)
    first, last = (ndtr(sign * (end - mean) / deviation) for end in (low, high))
    at = np.clip(mean + sign * deviation * ndtri(first + (last - first) * share), low, high)
    density = np.exp(-0.5 * ((at - mean) / deviation) ** 2) / (math.sqrt(2.0 * math.pi) * deviation)
    return at, np.divide(abs(last - first), density, out=np.zeros(at.shape), where=density > 0.0)

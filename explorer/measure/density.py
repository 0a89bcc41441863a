"""Densities on the phase space, from which initial states are drawn.

A density is a function of (phi, phidot, sigma3, sigma4) in the units of the disk, with respect to the
invariant measure dphi dphidot dsigma3 dsigma4, up to a factor: a box, optionally cut at energies, times
Gaussians, times any function that a user gives.
"""

import hashlib
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, number, shown
from explorer.measure.sampling import BLOCK, Box, Range, Stream, gather, parse_ranges
from explorer.phase.arguments import read_range, returned_numbers
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, phi_to_states

ANY_ENERGY: Range = (-math.inf, math.inf)
# Points at which a function is looked at for its maximum, and how far it may exceed the largest value there: a
# maximum that is missed costs digits where it is assumed too large, and an InputError where too small.
_SEARCHED, _HEADROOM = 1 << 15, 1.5
_IDENTIFYING = 256  # points at which a function is looked at for the digest that tells it from others
# Natural units: with faster rates or a smaller inertia the lines l_+- are too steep for doubles.
_FASTEST, _LEAST = 1e4, 1e-4
_THINNEST = 1e-6  # standard deviation over the range of the box; a narrower Gaussian is a fixed coordinate
# Standard deviations from the mean beyond which a Gaussian is below the rounding of its largest value, exp(-x^2/2)
# = 2e-16, and beyond which it cannot be told from nothing in doubles.
_REACH, _NOTHING = 8.5, 37.0
Function = Callable[[Array, Array, Array, Array], Array]


@dataclass(frozen=True)
class Density:
    """A box times whatever else is given; `Density.of` reads what users write.

    energy: only states with an energy in this range, in the units of the disk.
    gaussian: pairs (coordinate, (mean, standard deviation)); cut off where the box ends.
    function: called as function(phi, phidot, sigma3, sigma4) with arrays of one length; not negative.
    """

    box: Box
    energy: Range = ANY_ENERGY
    gaussian: tuple[tuple[str, Range], ...] = ()
    function: Function | None = None

    def __post_init__(self) -> None:
        low, high = self.energy
        if math.isnan(low) or math.isnan(high) or not low < high:
            raise InputError(f"--energy {low:g}:{high:g} is empty; give LOW:HIGH, the smaller number first")
        for name, (mean, deviation) in self.gaussian:
            if name not in self.box.free:
                raise InputError(f"--gaussian {name}: the box fixes it; give it a range in --box")
            low, high = getattr(self.box, name)
            if math.isfinite(deviation) and 0.0 < deviation < _THINNEST * (high - low):
                raise InputError(
                    f"--gaussian {name}: a deviation of {deviation:g} is a point; fix {name} in --box"
                )
            if deviation > 0.0 and max(low - mean, mean - high) > _NOTHING * deviation:
                raise InputError(
                    f"--gaussian {name} = {mean:g}:{deviation:g}: the box lies more than {_NOTHING:g} deviations "
                    "from the mean, where nothing is left of it; move the mean or the box"
                )
            if not (math.isfinite(mean) and math.isfinite(deviation) and deviation > 0.0):
                raise InputError(
                    f"--gaussian {name} = {mean:g}:{deviation:g}; write MEAN:DEVIATION, deviation > 0"
                )
        if self.function is not None and not callable(self.function):
            raise InputError(f"density = {shown(self.function)} cannot be called; give a function of four arrays")

    @property
    def plain(self) -> bool:
        """Whether it is uniform in its box."""
        return self.energy == ANY_ENERGY and not self.gaussian and self.function is None

    @classmethod
    def of(
        cls,
        disk: Disk,
        box: "Box | str | None" = None,
        energy: Any = None,
        gaussian: str | Mapping[str, Range] | None = None,
        density: Function | None = None,
    ) -> "Density":
        """A density from what users give; the box defaults to Box.default. Raises InputError."""
        found, bells = _read_box("--box", box, disk), _bells("--gaussian", gaussian)
        for name, reach in zip(COORDINATES[1:], (found.phidot, found.sigma3, found.sigma4), strict=True):
            if max(map(abs, reach)) > _FASTEST * disk.rate_unit:
                raise InputError(f"--box {name}: rates beyond {_FASTEST:g} sqrt(g/r) are not sampled; narrow it")
        if not (disk.body.I1 >= _LEAST and disk.body.k >= _LEAST):
            raise InputError(
                f"disk: I1/(m r^2) = {disk.body.I1:g}, I3/I1 = {disk.body.k:g}: below {_LEAST:g} the lines of the "
                "falling set are too steep for this; give a disk with larger ones"
            )
        return cls(
            found,
            ANY_ENERGY if energy is None else read_range("--energy", energy, unbounded=True),
            tuple(bells.items()),
            density,
        )

    def shape(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array) -> Array:
        """The density without the ends of the box and of the energy. Raises InputError where it is no density."""
        columns = dict(zip(COORDINATES, (phi, phidot, sigma3, sigma4), strict=True))
        values = np.ones(phi.shape)
        for name, (mean, deviation) in self.gaussian:
            values *= np.exp(-0.5 * ((columns[name] - mean) / deviation) ** 2)
        if self.function is not None:
            values *= self._called(columns)
        return values

    def _called(self, columns: dict[str, Array]) -> Array:
        assert self.function is not None
        flat = {name: np.array(column).ravel() for name, column in columns.items()}
        shape = columns["phi"].shape
        given = returned_numbers("density", self.function(*(column.copy() for column in flat.values())))
        if given.shape not in ((), flat["phi"].shape):
            raise InputError(
                f"density: returned {shown(given)} for {flat['phi'].size} states; return one number for each"
            )
        values = np.broadcast_to(given, flat["phi"].shape).astype(np.float64)
        bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
        if bad.size:
            where = ", ".join(f"{name} = {column[bad[0]]:.6g}" for name, column in flat.items())
            raise InputError(
                f"density: is {values[bad[0]]} at {where}; a density is finite and not negative in all of the box"
            )
        return values.reshape(shape)

    def inside(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array, energy: Array) -> NDArray[np.bool_]:
        """True for states in the box and in the range of energy; fixed coordinates are taken for granted."""
        good = (energy >= self.energy[0]) & (energy <= self.energy[1])
        for name, column in zip(COORDINATES, (phi, phidot, sigma3, sigma4), strict=True):
            if name in self.box.free:
                low, high = getattr(self.box, name)
                good &= (column >= low) & (column <= high)
        return good

    def draw(self, disk: Disk, random: Stream, count: int) -> dict[str, Array]:
        """`count` states, drawn from the density by rejection; Gaussians by their inverse.

        Raises InputError where hardly a draw is kept, or where a function turns out larger than at the points
        at which its maximum was sought.
        """

        def block() -> tuple[dict[str, Array], NDArray[np.bool_]]:
            drawn = self.box.draw(random, BLOCK)
            for name, _ in self.gaussian:
                low, high = getattr(self.box, name)
                drawn[name] = self.quantile(name, (drawn[name] - low) / (high - low))
            good = np.ones(BLOCK, bool)
            if self.energy != ANY_ENERGY:
                energy = phi_to_states(disk, **drawn).motion.energy * disk.energy_unit
                good = (energy >= self.energy[0]) & (energy <= self.energy[1])
            if self.function is not None:
                values = self._called(drawn)
                if values.max() > self._bound:
                    raise InputError(
                        f"density: is {values.max():g}, more than {_HEADROOM:g} times its largest value at "
                        f"{_SEARCHED} points of the box; shrink the box to where it is large"
                    )
                good &= random.random(BLOCK) * self._bound < values
            return drawn, good

        what = "--energy" if self.energy != ANY_ENERGY else "density"
        return gather(block, count, what + ": only {} draws from the box were kept; widen it")

    def quantile(self, name: str, share: Array) -> Array:
        """The values of a coordinate below which these shares of its own factor in the box lie."""
        from scipy.special import ndtr, ndtri

        low, high = getattr(self.box, name)
        pair = dict(self.gaussian).get(name)
        if pair is None:
            evenly: Array = low + (high - low) * share
            return evenly
        mean, deviation = pair
        first, last = (low - mean) / deviation, (high - mean) / deviation
        # From the nearer tail: far from the middle the other one has no digits.
        sign = -1.0 if first > 0.0 else 1.0
        tails = ndtr(sign * first), ndtr(sign * last)
        values = mean + sign * deviation * ndtri(tails[0] + (tails[1] - tails[0]) * share)
        inside: Array = np.clip(values, low, high)
        return inside

    def reach(self, name: str) -> Range:
        """The part of the box in which a coordinate's own factor is not zero in doubles."""
        low, high = getattr(self.box, name)
        pair = dict(self.gaussian).get(name)
        if pair is None:
            return low, high
        mean, deviation = pair
        # Far from its mean a Gaussian is largest at an end of the box, and falls off from there.
        nearest = (min(max(mean, low), high) - mean) / deviation
        far = deviation * math.hypot(nearest, _REACH)
        return max(low, mean - far), min(high, mean + far)

    @cached_property
    def _bound(self) -> float:
        """A value that the function is taken not to exceed."""
        points = self.box.draw(np.random.Generator(np.random.Philox(1)), _SEARCHED)
        return _HEADROOM * float(self._called(points).max())

    def describe(self) -> dict[str, Any]:
        """The entry of run.json. A function is identified by its values at fixed points of the box."""
        described: dict[str, Any] = {"box": self.box.describe()}
        if self.energy != ANY_ENERGY:
            described["energy"] = [end if math.isfinite(end) else None for end in self.energy]
        if self.gaussian:
            described["gaussian"] = {name: list(pair) for name, pair in self.gaussian}
        if self.function is not None:
            points = self.box.draw(np.random.Generator(np.random.Philox(0)), _IDENTIFYING)
            values = self._called(points)
            if (values != self._called(points)).any():
                raise InputError("density: it changes from call to call; give a function of the state alone")
            digest = hashlib.sha256(values.astype("<f8").tobytes()).hexdigest()
            described["density"] = {
                "function": getattr(self.function, "__qualname__", "unnamed"),
                "sha256_of_values": digest,
            }
        return described


def _read_box(name: str, value: Any, disk: Disk) -> Box:
    """A box, or the text of one; by default that of the disk. Raises InputError."""
    if isinstance(value, Box):
        return value
    text = "" if value is None else value
    if not isinstance(text, str):
        raise InputError(f'{name} {shown(value)}: write "phi=0,sigma3=-2:2"; what is left out keeps its range')
    return Box.parse(text, Box.default(disk)) if text else Box.default(disk)


def _bells(flag: str, gaussian: Any) -> dict[str, Range]:
    """Means and deviations by coordinate, from text or a mapping. Raises InputError."""
    if gaussian is None or isinstance(gaussian, str):
        return {} if gaussian is None else parse_ranges(gaussian, flag)
    pairs: list[Any] = list(gaussian.values()) if isinstance(gaussian, Mapping) else [None]
    if not all(isinstance(pair, list | tuple) and len(pair) == 2 for pair in pairs):
        raise InputError(f'{flag} {shown(gaussian)}: write "phidot=0.5:0.1", MEAN:DEVIATION of a coordinate')
    return {
        str(name): (number(f"{flag} {name}", mean), number(f"{flag} {name}", deviation))
        for name, (mean, deviation) in gaussian.items()
    }

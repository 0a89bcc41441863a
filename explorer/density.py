"""Densities on the phase space: what initial states are weighted with.

A density is a function of (phi, phidot, sigma3, sigma4) in the units of the disk, with respect to the
invariant measure dphi dphidot dsigma3 dsigma4, up to a factor: a box, optionally cut at energies, times
Gaussians, times any function that a person gives.
"""

import hashlib
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from explorer.disk import Disk
from explorer.errors import InputError
from explorer.sampling import BLOCK, Box, Range, gather, parse_ranges
from explorer.states import COORDINATES, Array, natural_constants, phi_to_states

ANY_ENERGY: Range = (-math.inf, math.inf)
_SEARCHED = 1 << 15
Function = Callable[[Array, Array, Array, Array], Array]


@dataclass(frozen=True)
class Density:
    """A box times whatever else is given; see `Density.parse` for how people write it.

    energy: only states with an energy in this range, in the units of the disk.
    gaussian: {coordinate: (mean, standard deviation)}, as pairs; cut off where the box ends.
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
            if not (math.isfinite(mean) and math.isfinite(deviation) and deviation > 0.0):
                raise InputError(
                    f"--gaussian {name} = {mean:g}:{deviation:g}; write MEAN:DEVIATION, deviation > 0"
                )
        if self.function is not None and not callable(self.function):
            raise InputError(f"density = {self.function!r} cannot be called; give a function of four arrays")

    @classmethod
    def of(
        cls,
        disk: Disk,
        box: "Box | str | None" = None,
        energy: Any = None,
        gaussian: str | None = None,
        density: Function | None = None,
    ) -> "Density":
        """A density from what people give; the box defaults to Box.default. Raises InputError."""
        if box is None or isinstance(box, str):
            box = Box.parse(box, Box.default(disk)) if box else Box.default(disk)
        bells = tuple(parse_ranges(gaussian, "--gaussian").items()) if gaussian else ()
        return cls(box, ANY_ENERGY if energy is None else cls.parse_energy(energy), bells, density)

    @staticmethod
    def parse_energy(value: Any) -> Range:
        """(low, high) from "LOW:HIGH", ":HIGH", "LOW:" or a pair, where None is no bound. Raises InputError."""
        try:
            low, high = value.split(":") if isinstance(value, str) else value
            return (
                -math.inf if low is None or low == "" else float(low),
                math.inf if high is None or high == "" else float(high),
            )
        except (TypeError, ValueError):
            raise InputError(f"--energy {value!r} is not a range; write LOW:HIGH, :HIGH or LOW:") from None

    @property
    def flat_box(self) -> bool:
        """Whether the density is constant in the box, so that integrals of it are products."""
        return self.function is None and not self.gaussian

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
        flat = {name: np.ravel(column) for name, column in columns.items()}
        shape = columns["phi"].shape
        try:
            given = np.asarray(self.function(*flat.values()), dtype=np.float64)
            values = np.broadcast_to(given, flat["phi"].shape)
        except (TypeError, ValueError) as error:
            raise InputError(f"density: {error}; it must return one number for every state") from None
        bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0.0)))
        if bad.size:
            where = ", ".join(f"{name} = {column[bad[0]]:.6g}" for name, column in flat.items())
            raise InputError(
                f"density: is {values[bad[0]]} at {where}; a density is finite and not negative in all of the box"
            )
        return values.reshape(shape)

    def inside(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array, energy: Array) -> NDArray[np.bool_]:
        """Whether states lie in the box and in the range of energy; fixed coordinates are taken for granted."""
        good = (energy >= self.energy[0]) & (energy <= self.energy[1])
        for name, column in zip(COORDINATES, (phi, phidot, sigma3, sigma4), strict=True):
            if name in self.box.free:
                low, high = getattr(self.box, name)
                good &= (column >= low) & (column <= high)
        return good

    def draw(self, disk: Disk, random: np.random.Generator, count: int) -> dict[str, Array]:
        """`count` states, drawn from the density by rejection; Gaussians by their inverse.

        Raises InputError where hardly a draw is kept, or where a function turns out larger than at the points
        at which its maximum was sought.
        """

        def block() -> tuple[dict[str, Array], NDArray[np.bool_]]:
            drawn = self.box.draw(random, BLOCK)
            for name, (mean, deviation) in self.gaussian:
                low, high = ((end - mean) / deviation for end in getattr(self.box, name))
                unit = (drawn[name] - getattr(self.box, name)[0]) / (deviation * (high - low))
                drawn[name] = mean + deviation * ndtri(ndtr(low) + (ndtr(high) - ndtr(low)) * unit)
            good = np.ones(BLOCK, bool)
            if self.energy != ANY_ENERGY:
                energy = natural_constants(phi_to_states(disk, **drawn))[3] * disk.energy_unit
                good = (energy >= self.energy[0]) & (energy <= self.energy[1])
            if self.function is not None:
                values = self._called(drawn)
                if values.max() > self._bound:
                    raise InputError(
                        f"density: is {values.max():g}, more than 1.5 times its largest value at {_SEARCHED} "
                        "points of the box; shrink the box to where it is large"
                    )
                good &= random.random(BLOCK) * self._bound < values
            return drawn, good

        return gather(block, count, "density: {} draws from the box were kept; widen --energy")

    @cached_property
    def _bound(self) -> float:
        """What the function is taken not to exceed: half more than its largest value at many points."""
        points = self.box.draw(np.random.Generator(np.random.Philox(1)), _SEARCHED)
        return 1.5 * float(self._called(points).max())

    def describe(self) -> dict[str, Any]:
        """What run.json says. A function is identified by its values at fixed points of the box."""
        described: dict[str, Any] = {"box": self.box.describe()}
        if self.energy != ANY_ENERGY:
            described["energy"] = [end if math.isfinite(end) else None for end in self.energy]
        if self.gaussian:
            described["gaussian"] = {name: list(pair) for name, pair in self.gaussian}
        if self.function is not None:
            points = self.box.draw(np.random.Generator(np.random.Philox(0)), 256)
            digest = hashlib.sha256(self._called(points).astype("<f8").tobytes()).hexdigest()
            described["density"] = {
                "function": getattr(self.function, "__qualname__", "unnamed"),
                "sha256_of_values": digest,
            }
        return described

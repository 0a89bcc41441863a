"""Integrals of a density over its box: panels that end where the integrand has corners.

A box cut at an energy has corners where the ellipsoid of that energy leaves it. Inner integrals end there,
so that what is left is smooth and a Gauss rule converges; the outermost, over phi, is adaptive.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import cubature
from scipy.special import ndtr

from explorer.measure.density import ANY_ENERGY, Density
from explorer.measure.sampling import Range
from explorer.phase.disk import Disk
from explorer.phase.gauss import gauss
from explorer.phase.states import COORDINATES, Array

_HALF_PI = 0.5 * math.pi
# Panels are halved until the result changes by less than this, relatively, or as often as is bearable.
TOLERANCE = 1e-7
_ROUGH = 1e-4  # with this one panel does
_FINEST = 4
_NODES = 12  # of the rule on a panel
_MOST_PARTS = 100  # of the range of phi
# The density beside flat: points a side, the share of its largest value that counts as zero, distance.
_FACE, _VANISHING, _BESIDE = 13, 1e-3, 1e-9
# Distances from the middle of a Gaussian, in standard deviations, where panels end.
_BELL = (-5.0, 0.0, 5.0)


def refined(
    integral: Callable[[int], tuple[float, float]], tolerance: float, finest: int = _FINEST
) -> tuple[float, float]:
    """integral(m), m panels in place of one, for m = 1, 2, 4 ... until it settles; with its error."""
    panels, (last, error) = 1, integral(1)
    if tolerance >= _ROUGH:
        return last, error
    while True:
        panels *= 2
        value, error = integral(panels)
        change = abs(value - last)
        if change <= tolerance * abs(value) or panels >= finest:
            return value, error + change
        last = value


def difference(f: Callable[[float], tuple[float, float]], energy: Range) -> tuple[float, float]:
    """What f(E), over energies up to E, is over a range of energies."""
    low, high = energy
    upper = f(high)
    lower = f(low) if math.isfinite(low) else (0.0, 0.0)
    return upper[0] - lower[0], upper[1] + lower[1]


def along(
    f: Callable[[Array], Array], pieces: Sequence[Range], at_once: int, tolerance: float
) -> tuple[float, float]:
    """Integral of f (n) -> (n) over pieces of the range of phi; f at phi where a piece is a point.

    at_once: how many values of phi fit into memory together with all nodes of the other coordinates.
    """

    total = error = 0.0
    for low, high in pieces:
        middle, half = 0.5 * (low + high), 0.5 * (high - low)

        # Spaced like a sine: at flat there are logarithms, S ln S and the like.
        def in_parts(x: Array, middle: float = middle, half: float = half) -> Array:
            angle = x[:, 0]
            phi = middle + half * np.sin(angle)
            parts = [f(phi[i : i + at_once]) for i in range(0, phi.size, at_once)]
            return np.concatenate(parts) * half * np.cos(angle)

        if low == high:
            total += float(f(np.array([low]))[0])
            continue
        found = cubature(
            in_parts, [-_HALF_PI], [_HALF_PI], rtol=tolerance, atol=1e-300, max_subdivisions=_MOST_PARTS
        )
        total, error = total + float(found.estimate), error + float(found.error)
    return total, error


def panels_between(ends: Sequence[Array], panels: int) -> tuple[Array, Array]:
    """Nodes and weights between the first and last of `ends`, all of shape (n): two arrays (n, nodes).

    Between neighbouring ends nodes are spaced like the sine of an angle, which is cut into `panels` parts. A
    square root that vanishes at an end, as what is left of the energy does, is smooth in the angle.
    """
    low, high = ends[0], np.maximum(ends[0], ends[-1])
    inner = [np.where(np.isnan(end), low, np.clip(end, low, high)) for end in ends[1:-1]]
    edges = np.sort(np.stack(np.broadcast_arrays(low, *inner, high), axis=-1), axis=-1)[..., None]
    middle, half = 0.5 * (edges[..., 1:, :] + edges[..., :-1, :]), 0.5 * np.diff(edges, axis=-2)
    nodes, weights = gauss(_NODES)
    angle = (0.5 * math.pi / panels * (np.arange(1 - panels, panels, 2)[:, None] + nodes)).ravel()
    step = np.cos(angle) * np.tile(weights, panels) * (0.5 * math.pi / panels)
    shape = (*low.shape, -1)
    return (middle + half * np.sin(angle)).reshape(shape), (half * step).reshape(shape)


@dataclass(frozen=True)
class Frame:
    """A density in natural units."""

    disk: Disk
    density: Density
    tolerance: float = TOLERANCE

    @property
    def energy(self) -> Range:
        low, high = self.density.energy
        return low / self.disk.energy_unit, high / self.disk.energy_unit

    def unit(self, name: str) -> float:
        return 1.0 if name == "phi" else self.disk.rate_unit

    def range(self, name: str) -> Range:
        """The range of a coordinate of the box."""
        low, high = getattr(self.density.box, name)
        return low / self.unit(name), high / self.unit(name)

    def free(self, name: str) -> bool:
        return name in self.density.box.free

    def bells(self, name: str) -> list[float]:
        """Where a Gaussian factor asks for ends of panels."""
        pairs = dict(self.density.gaussian)
        mean, deviation = pairs.get(name, (0.0, math.nan))
        return [(mean + k * deviation) / self.unit(name) for k in _BELL] if name in pairs else []

    def shape(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array) -> Array:
        """The density at natural coordinates, which broadcast together."""
        unit = self.disk.rate_unit
        return self.density.shape(*np.broadcast_arrays(phi, phidot * unit, sigma3 * unit, sigma4 * unit))

    def mass(self) -> tuple[float, float]:
        """Integral of the density, and its error."""
        if self.density.function is None and self.density.energy == ANY_ENERGY:
            return math.prod(self.one(name) for name in COORDINATES if self.free(name)), 0.0
        # With a bound of the energy there are more ends of panels, and more panels to begin with.
        finest = _FINEST if self.density.energy == ANY_ENERGY else 2
        return difference(
            lambda level: refined(lambda m: self._below(level, m), self.tolerance, finest), self.energy
        )

    def one(self, name: str) -> float:
        """Integral of the factor of one coordinate over the box."""
        low, high = self.range(name)
        pairs = dict(self.density.gaussian)
        if name not in pairs:
            return high - low
        mean, deviation = (value / self.unit(name) for value in pairs[name])
        ends = (low - mean) / deviation, (high - mean) / deviation
        # Of the two tails the smaller: no cancellation far from the middle.
        share = ndtr(-ends[0]) - ndtr(-ends[1]) if ends[0] > 0.0 else ndtr(ends[1]) - ndtr(ends[0])
        return math.sqrt(2.0 * math.pi) * deviation * float(share)

    def _below(self, energy: float, panels: int) -> tuple[float, float]:
        """Integral of the density over energies up to `energy`."""
        return along(lambda phi: self._over_rates(phi, energy, panels), self.pieces([]), 1, self.tolerance)

    def pieces(self, middle: Sequence[float]) -> list[Range]:
        """The range of phi, cut at the vertical, at Gaussians' middles, and at some more."""
        low, high = self.range("phi")
        if low == high:
            return [(low, high)]
        inner = sorted({end for end in (0.0, *middle, *self.bells("phi")) if low < end < high})
        edges = [low, *inner, high]
        return list(pairwise(edges))

    def _over_rates(self, phi: Array, energy: float, panels: int) -> Array:
        """Integral over phidot, sigma3 and sigma4 at tilts phi, for energies up to `energy`."""
        b, q = self.disk.body, np.cos(phi)
        spent = {name: self._most(name) for name in ("phidot", "sigma3")}
        left = 2.0 * (energy - q)
        gyration = b.I1 / (q * q)
        # Where a corner of the rest of the box runs out of energy, an inner range changes its end.
        tilting, gyrating = b.M * spent["phidot"] ** 2, gyration * spent["sigma3"] ** 2
        s4, w4 = self._rates("sigma4", left, b.J, [tilting, gyrating, tilting + gyrating], panels)
        left = left[:, None] - b.J * s4 * s4
        s3, w3 = self._rates("sigma3", left, gyration[:, None], [tilting], panels)
        left = left[..., None] - gyration[:, None, None] * s3 * s3
        most = np.sqrt(np.maximum(left, 0.0) / b.M)
        weight = w4[..., None] * w3 * (left >= 0.0)
        columns = phi[:, None, None], s3, s4[..., None]
        return (self.over_speeds(columns, np.zeros_like(most), most, None, panels) * weight).sum(axis=(1, 2))

    def over_speeds(
        self, others: tuple[Array, Array, Array], least: Array, most: Array, rise: Array | None, panels: int
    ) -> Array:
        """Integral of the density times sqrt(phidot^2 + rise) over least <= |phidot| <= most in the box.

        others: phi, sigma3, sigma4. Without `rise` the integral of the density alone.
        """
        if self.even and self.free("phidot"):
            total = np.zeros(least.shape)
            for _, inner, outer in self._halves(least, most):
                total += outer - inner if rise is None else _root_integral(inner, outer, rise)
            return total * self.shape(others[0], np.zeros(1), *others[1:])
        bend = np.ones(least.shape) if rise is None else np.sqrt(np.maximum(abs(rise), 1e-10))
        speed, steps = self.speeds(least, most, bend, panels)
        f = self.shape(others[0][..., None], speed, others[1][..., None], others[2][..., None])
        if rise is not None:
            f = f * np.sqrt(np.maximum(speed * speed + rise[..., None], 0.0))
        return (f * steps).sum(axis=-1)

    @property
    def even(self) -> bool:
        """Whether the density does not depend on phidot."""
        return self.density.function is None and not self.bells("phidot")

    def _halves(self, least: Array, most: Array) -> list[tuple[float, Array, Array]]:
        """Direction and range of |phidot| of the two halves of what the box leaves."""
        low, high = self.range("phidot")
        halves = []
        for sign, start, end in ((1.0, max(low, 0.0), high), (-1.0, max(-high, 0.0), -low)):
            inner = np.maximum(least, start)
            halves.append((sign, inner, np.maximum(np.minimum(most, end), inner)))
        return halves

    def _most(self, name: str) -> float:
        return max(map(abs, self.range(name)))

    def _rates(
        self, name: str, left: Array, inertia: Array | float, corners: Sequence[Array | float], panels: int
    ) -> tuple[Array, Array]:
        """Nodes and weights in sigma3 or sigma4 where inertia sigma^2 <= left; a fixed one weighs 1."""
        low, high = self.range(name)
        if low == high:
            return np.full((*left.shape, 1), low), np.ones((*left.shape, 1))
        reach = np.sqrt(np.maximum(left, 0.0) / inertia)
        bounded = corners if np.isfinite(reach).all() else []
        turns = [np.sqrt(np.maximum(left - corner, 0.0) / inertia) for corner in bounded]
        first, last = np.maximum(low, -reach), np.minimum(high, reach)
        inner = [sign * turn for turn in turns for sign in (1.0, -1.0)]
        bells = [np.full_like(reach, bell) for bell in self.bells(name)]
        return panels_between([first, *inner, *bells, last], panels)

    def speeds(self, least: Array, most: Array, bend: Array, panels: int) -> tuple[Array, Array]:
        """Nodes and weights in phidot over the part of the box with least <= |phidot| <= most, on a last axis.

        Spaced like sinh in units of `bend`, over which integrands change near phidot = 0.
        """
        low = self.range("phidot")[0]
        if not self.free("phidot"):
            inside = (abs(low) >= least) & (abs(low) <= most)
            return np.full((*least.shape, 1), low), inside[..., None].astype(np.float64)
        bells = self.bells("phidot")
        speeds, steps = [], []
        for sign, inner, outer in self._halves(least, most):
            middle = [np.clip(sign * bell, inner, outer) for bell in bells]
            u, step = panels_between([np.arcsinh(end / bend) for end in (inner, *middle, outer)], panels)
            speeds.append(sign * bend[..., None] * np.sinh(u))
            steps.append(step * bend[..., None] * np.cosh(u))
        return np.concatenate(speeds, axis=-1), np.concatenate(steps, axis=-1)

    def reaches_flat(self) -> bool:
        """Whether the density at flat is positive and the energy has no bound."""
        if not self.free("phi") or math.isfinite(self.energy[1]):
            return False
        ends = [end for end in self.range("phi") if abs(end) >= _HALF_PI * (1.0 - 1e-15)]
        if not ends:
            return False
        grid = np.meshgrid(*(np.linspace(*self.range(name), _FACE) for name in COORDINATES))
        largest = float(self.shape(*(column.ravel() for column in grid)).max())
        face = np.meshgrid(*(np.linspace(*self.range(name), _FACE) for name in COORDINATES[1:]))
        rates = [column.ravel() for column in face]
        beside = [math.copysign(_HALF_PI - _BESIDE, end) for end in ends]
        return any(float(self.shape(np.full(1, phi), *rates).max()) > _VANISHING * largest for phi in beside)

    def narrowest(self) -> float:
        """The narrowest width of the density in sigma3 and sigma4; of a fixed one its distance from 0, if any."""
        widths = []
        for name in ("sigma3", "sigma4"):
            low, high = self.range(name)
            bells = [pair[1] / self.unit(name) for which, pair in self.density.gaussian if which == name]
            widths += [high - low, *bells] if self.free(name) else [abs(low) or math.inf]
        return min(widths)

    def most_energy(self) -> float:
        """An energy that few states of the box exceed: the largest there is in it at the vertical."""
        b = self.disk.body
        kinetic = sum(m * self._most(n) ** 2 for n, m in (("phidot", b.M), ("sigma3", b.I1), ("sigma4", b.J)))
        return min(1.0 + 0.5 * kinetic, self.energy[1])


def _root_integral(low: Array, high: Array, rise: Array) -> Array:
    """Integral of sqrt(x^2 + rise) from low to high, 0 <= low <= high."""
    first, last = (np.sqrt(np.maximum(x * x + rise, 0.0)) for x in (low, high))
    ratio = (high + last) / np.maximum(low + first, 1e-300)
    return 0.5 * (high * last - low * first + rise * np.log(np.maximum(ratio, 1.0)))

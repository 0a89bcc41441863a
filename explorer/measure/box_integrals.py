"""Integrals of a density over its box: panels that end where the integrand has corners.

A box cut at an energy has corners where the ellipsoid of that energy leaves it. Inner integrals end there,
so that what is left is smooth and a Gauss rule converges; the outermost, over phi, is adaptive.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from explorer.measure.density import ANY_ENERGY, Density
from explorer.measure.sampling import Range
from explorer.phase.disk import Disk
from explorer.phase.gauss import gauss
from explorer.phase.states import COORDINATES, Array

_HALF_PI = 0.5 * math.pi
TOLERANCE = 1e-7  # relative; some 10^14 independent draws would be needed to see such an error
_ROUGH = 1e-4  # where no more than this is asked for one panel does
_FINEST = 4  # panels in place of one; the time grows with their square or cube
_FINEST_CUT = 2  # the same with a bound of the energy, which already adds ends of panels
_NODES = 12  # of the rule on a panel, so of order 24
_MOST_PARTS = 100  # of the range of phi: a limit for integrands that are not smooth, whose error then says so
# Points of the phase space, beyond the first cut of each piece in two, at which the density is asked for in all;
# the part of what is left that one piece may take; and as how many a call for some tilts counts, whatever it asks
# for. Smooth densities take a tenth; all take half a minute of one core.
_MOST_POINTS, _SHARE, _CALL = 300_000_000, 0.25, 50_000
# A grid tells whether a density vanishes at flat: points a side, distance from flat (rad), and the
# share of its largest value on the grid below which it counts as zero.
_GRID, _BESIDE, _VANISHING = 13, 1e-9, 1e-3
# Distances from the mean of a Gaussian, in standard deviations, where panels end.
_BELL = (-5.0, 0.0, 5.0)
# Nodes crowd at phidot = 0 on the scale of the root of the gain, but no closer than of this one.
_LEAST_GAIN = 1e-10


class Integral(NamedTuple):
    """A value and an estimate of its absolute error."""

    value: float
    error: float


@dataclass
class Work:
    """Points of the phase space that integrals of one density have asked for; a limit for those that jump."""

    points: int = 0

    @property
    def left(self) -> int:
        return max(_MOST_POINTS - self.points, 0)


def settled(integral: Callable[[int], Integral], tolerance: float, finest: int = _FINEST) -> Integral:
    """integral(panels) for 1, 2, 4 ... panels in place of one, until its relative change is below `tolerance`.

    The change of the last doubling is added to its error; where that is still rough, the largest change.
    """
    panels, last, largest = 1, integral(1), 0.0
    if tolerance >= _ROUGH:
        return last
    while True:
        panels *= 2
        now = integral(panels)
        change = abs(now.value - last.value)
        largest = max(largest, change)
        if change <= tolerance * abs(now.value) or panels >= finest:
            rough = change > _ROUGH * abs(now.value)
            return Integral(now.value, now.error + (largest if rough else change))
        last = now


def between_energies(below: Callable[[float], Integral], energy: Range) -> Integral:
    """An integral over a range of energies from `below`, which gives that over all energies up to a bound."""
    low, high = energy
    upper = below(high)
    lower = below(low) if math.isfinite(low) else Integral(0.0, 0.0)
    return Integral(upper.value - lower.value, upper.error + lower.error)


def over_tilts(
    f: Callable[[Array], Array], pieces: Sequence[Range], at_once: int, tolerance: float, work: Work | None = None
) -> Integral:
    """Adaptive integral of f (n) -> (n) over pieces of the range of phi; of a piece that is a point, f there.

    at_once: how many values of phi fit into memory together with all nodes of the other coordinates.
    work: where f counts its points; a piece is cut no further than what is left allows, and its error says so.
    """
    from scipy.integrate import cubature

    work = work or Work()
    total = error = 0.0
    for low, high in pieces:
        if low == high:
            total += float(f(np.array([low]))[0])
            continue
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        known: dict[bytes, Array] = {}

        # Spaced like a sine: at flat there are logarithms, S ln S and the like.
        def in_parts(x: Array, middle: float = middle, half: float = half, known: Any = known) -> Array:
            angle = x[:, 0]
            name = angle.tobytes()
            if name not in known:
                phi = middle + half * np.sin(angle)
                parts = [f(phi[i : i + at_once]) for i in range(0, phi.size, at_once)]
                work.points += _CALL * len(parts)
                known[name] = np.concatenate(parts) * half * np.cos(angle)
            values: Array = known[name]
            return values

        over = partial(cubature, in_parts, [-_HALF_PI], [_HALF_PI], rtol=tolerance, atol=1e-300)
        before = work.points
        piece = over(max_subdivisions=1)
        if piece.status != "converged":
            cost = (work.points - before) * 2 // 3  # of a subdivision: the whole and its halves are known
            piece = over(max_subdivisions=min(_MOST_PARTS, int(_SHARE * work.left) // cost))
        total, error = total + float(piece.estimate), error + float(piece.error)
    return Integral(total, error)


def panels_between(ends: Sequence[Array], panels: int) -> tuple[Array, Array]:
    """Nodes and weights between the first and last of `ends`, all of shape (n): two arrays (n, nodes).

    Between neighbouring ends nodes are spaced like the sine of an angle, which is cut into `panels` parts: a
    square root that vanishes at an end, such as the speed that an energy leaves, is smooth in the angle.
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


def ends_of_bar(*limits: tuple[Array, float, float, Array | float]) -> tuple[Array, Array]:
    """Ends of sigma3_bar with low - slack <= m sigma3_bar <= high + slack for every (m, low, high, slack)."""
    low, high = np.full(limits[0][0].shape, -np.inf), np.full(limits[0][0].shape, np.inf)
    for m, first, last, slack in limits:
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = (first - slack) / m, (last + slack) / m
        low, high = np.fmax(low, np.fmin(one, other)), np.fmin(high, np.fmax(one, other))
    return low, high


def mirrored(name: str, ends: Range, face: int) -> Range:
    """The range of a coordinate as face +1 sees it: face -1 is the mirror image, eq. (3.2)."""
    return ends if face > 0 or name == "sigma3" else (-ends[1], -ends[0])


@dataclass(frozen=True)
class NaturalDensity:
    """A density in natural units: what an integral needs of it, and its own integral.

    tolerance: relative error that integrals try for. work: what they have done so far.
    """

    disk: Disk
    density: Density
    tolerance: float = TOLERANCE
    work: Work = field(default_factory=Work, compare=False)

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
        """Values at which a Gaussian factor asks for ends of panels."""
        pairs = dict(self.density.gaussian)
        mean, deviation = pairs.get(name, (0.0, math.nan))
        return [(mean + k * deviation) / self.unit(name) for k in _BELL] if name in pairs else []

    def shape(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array) -> Array:
        """The density at natural coordinates, which broadcast together."""
        unit = self.disk.rate_unit
        return self.density.shape(*np.broadcast_arrays(phi, phidot * unit, sigma3 * unit, sigma4 * unit))

    def mass(self) -> Integral:
        """Integral of the density."""
        known = self.product()
        if known is not None:
            return Integral(known, 0.0)
        unbounded = self.density.energy == ANY_ENERGY

        def below(energy: float) -> Integral:
            finest = _FINEST if unbounded else _FINEST_CUT
            return settled(lambda panels: self._below(energy, panels), self.tolerance, finest)

        return between_energies(below, self.energy)

    def product(self) -> float | None:
        """Integral of a density that is a product of factors of one coordinate; None where it is not."""
        if self.density.function is not None or self.density.energy != ANY_ENERGY:
            return None
        return math.prod(self.factor_mass(name) for name in COORDINATES if self.free(name))

    def factor_mass(self, name: str) -> float:
        """Integral of the factor of one coordinate over the box."""
        low, high = self.range(name)
        pairs = dict(self.density.gaussian)
        if name not in pairs:
            return high - low
        from scipy.special import ndtr

        mean, deviation = (value / self.unit(name) for value in pairs[name])
        ends = (low - mean) / deviation, (high - mean) / deviation
        # Of the two tails the smaller: no cancellation far from the middle.
        share = ndtr(-ends[0]) - ndtr(-ends[1]) if ends[0] > 0.0 else ndtr(ends[1]) - ndtr(ends[0])
        return math.sqrt(2.0 * math.pi) * deviation * float(share)

    def _below(self, energy: float, panels: int) -> Integral:
        """Integral of the density over energies up to `energy`."""
        return over_tilts(
            lambda phi: self._over_rates(phi, energy, panels), self.pieces([]), 1, self.tolerance, self.work
        )

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
        total: Array = (self.over_speeds(columns, np.zeros_like(most), most, None, panels) * weight).sum(
            axis=(1, 2)
        )
        return total

    def over_speeds(
        self, others: tuple[Array, Array, Array], least: Array, most: Array, gain: Array | None, panels: int
    ) -> Array:
        """Integral of the density times sqrt(phidot^2 + gain) over least <= |phidot| <= most in the box.

        others: phi, sigma3, sigma4. gain: of the square of the speed from here to flat; without it the integral
        of the density alone.
        """
        if self.even and self.free("phidot"):
            self.work.points += least.size
            total = np.zeros(least.shape)
            for _, inner, outer in self._halves(least, most):
                total += outer - inner if gain is None else _root_integral(inner, outer, gain)
            return total * self.shape(others[0], np.zeros(1), *others[1:])
        bend = np.ones(least.shape) if gain is None else np.sqrt(np.maximum(abs(gain), _LEAST_GAIN))
        speed, steps = self.speeds(least, most, bend, panels)
        self.work.points += speed.size
        f = self.shape(others[0][..., None], speed, others[1][..., None], others[2][..., None])
        if gain is not None:
            f = f * np.sqrt(np.maximum(speed * speed + gain[..., None], 0.0))
        summed: Array = (f * steps).sum(axis=-1)
        return summed

    @property
    def even(self) -> bool:
        """True where the density does not depend on phidot."""
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
        kinks = [np.sqrt(np.maximum(left - corner, 0.0) / inertia) for corner in bounded]
        first, last = np.maximum(low, -reach), np.minimum(high, reach)
        inner = [sign * kink for kink in kinks for sign in (1.0, -1.0)]
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
        """True where the density does not vanish at flat and the energy has no bound: there is no C then."""
        if not self.free("phi") or math.isfinite(self.energy[1]):
            return False
        ends = [end for end in self.range("phi") if abs(end) >= _HALF_PI * (1.0 - 1e-15)]
        if not ends:
            return False
        largest = float(self.shape(*(column.ravel() for column in self._grid(COORDINATES))).max())
        rates = [column.ravel() for column in self._grid(COORDINATES[1:])]
        beside = [math.copysign(_HALF_PI - _BESIDE, end) for end in ends]
        return any(float(self.shape(np.full(1, phi), *rates).max()) > _VANISHING * largest for phi in beside)

    def _grid(self, names: Sequence[str]) -> tuple[Array, ...]:
        return np.meshgrid(*(np.linspace(*self.range(name), _GRID) for name in names))

    def narrowest(self) -> float:
        """The narrowest width of the density in sigma3 and sigma4; of a fixed one its distance from 0, if any."""
        widths = []
        for name in ("sigma3", "sigma4"):
            low, high = self.range(name)
            bells = [pair[1] / self.unit(name) for which, pair in self.density.gaussian if which == name]
            widths += [high - low, *bells] if self.free(name) else [abs(low) or math.inf]
        return min(widths)

    def most_energy(self) -> float:
        """An energy that few states of the box exceed: the largest in it at the vertical."""
        b = self.disk.body
        kinetic = sum(m * self._most(n) ** 2 for n, m in (("phidot", b.M), ("sigma3", b.I1), ("sigma4", b.J)))
        return min(1.0 + 0.5 * kinetic, self.energy[1])


def _root_integral(low: Array, high: Array, gain: Array) -> Array:
    """Integral of sqrt(x^2 + gain) from low to high, 0 <= low <= high."""
    first, last = (np.sqrt(np.maximum(x * x + gain, 0.0)) for x in (low, high))
    ratio = (high + last) / np.maximum(low + first, 1e-300)
    return 0.5 * (high * last - low * first + gain * np.log(np.maximum(ratio, 1.0)))

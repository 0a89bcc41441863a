"""Integrals of a density over its box: adaptive over the tilt, and for each tilt by Gauss rules between corners.

A box cut at an energy has corners where the ellipsoid of that energy leaves it. Inner integrals end there, so that
what is left is smooth; a rule with fewer nodes tells what the rule misses.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from explorer.measure.density import ANY_ENERGY, Density
from explorer.measure.sampling import Range
from explorer.phase.disk import Disk
from explorer.phase.states import Array

_gauss = cache(np.polynomial.legendre.leggauss)
_HALF_PI = 0.5 * math.pi
_TOLERANCE = 1e-7  # relative, to try for; some 10^14 independent draws would be needed to see such an error
NODES = 32, 24  # of the rule between two corners, and of the one that tells its error: 1e-9 for half a Gaussian
# Points at which an integral may ask for the density, and parts of the range of phi, before it cuts that no
# further: smooth densities take a tenth; of others the error says what is lacking after some seconds.
_MOST_POINTS, _MOST_PARTS = 30_000_000, 100


class Integral(NamedTuple):
    """A value and an estimate of its absolute error."""

    value: float
    error: float


def between_energies(below: Callable[[float], Integral], energy: Range) -> Integral:
    """An integral over a range of energies from `below`, which gives that over all energies up to a bound."""
    low, high = energy
    upper = below(high)
    lower = below(low) if math.isfinite(low) else Integral(0.0, 0.0)
    return Integral(upper.value - lower.value, upper.error + lower.error)


def panels_between(ends: Sequence[Any], nodes: int) -> tuple[Array, Array]:
    """Nodes and weights between the first and last of `ends`, arrays or numbers, on one more axis.

    Between neighbouring ends there are so many nodes, spaced like the sine of an angle: a square root that
    vanishes at an end, such as the speed that an energy leaves, is smooth in the angle. NaN is no end.
    """
    low, high = ends[0], np.maximum(ends[0], ends[-1])
    inner = [np.fmin(np.fmax(end, low), high) for end in ends[1:-1]]
    edges = np.sort(np.stack(np.broadcast_arrays(low, *inner, high), axis=-1), axis=-1)
    half = 0.5 * np.diff(edges)
    used = np.flatnonzero((half > 0.0).reshape(-1, half.shape[-1]).any(axis=0))
    used = used if used.size else np.zeros(1, np.intp)
    middle, half = (0.5 * (edges[..., 1:] + edges[..., :-1]))[..., used, None], half[..., used, None]
    x, weights = _gauss(nodes)
    step = half * np.cos(_HALF_PI * x) * weights * _HALF_PI
    shape = (*low.shape, -1)
    return (middle + half * np.sin(_HALF_PI * x)).reshape(shape), step.reshape(shape)


def within_energy(
    ends: tuple[Any, Any], left: Array, inertia: Any, spent: Iterable[Any], inner: Sequence[Any], nodes: int
) -> tuple[Array, Array]:
    """Nodes and weights for x between ends where inertia x^2 <= left.

    spent: of what is left, by corners of the rest of the box: the integrand has corners there, and at `inner`.
    """
    reach = np.sqrt(np.maximum(left, 0.0) / inertia)
    with np.errstate(invalid="ignore"):  # where so much is not left
        corners = [np.sqrt((left - part) / inertia) for part in spent]
    both = [sign * corner for corner in corners for sign in (1.0, -1.0)]
    return panels_between([np.maximum(ends[0], -reach), *both, *inner, np.minimum(ends[1], reach)], nodes)


def ends_of_bar(*limits: tuple[Array, float, float]) -> tuple[Array, Array]:
    """Ends of sigma3_bar with low <= m sigma3_bar <= high for every (m, low, high)."""
    low, high = np.full(limits[0][0].shape, -np.inf), np.full(limits[0][0].shape, np.inf)
    for m, first, last in limits:
        with np.errstate(divide="ignore", invalid="ignore"):
            one, other = first / m, last / m
        low, high = np.fmax(low, np.fmin(one, other)), np.fmin(high, np.fmax(one, other))
    return low, high


@dataclass
class Integrator:
    """Integrals of a density that is given in natural units.

    asked: at how many points the density was asked for.
    """

    disk: Disk
    density: Density
    asked: int = 0

    def mass(self) -> Integral:
        """Integral of the density."""
        f = self.density
        if f.function is None and f.energy == ANY_ENERGY:
            return Integral(math.prod(f.factor_mass(name) for name in f.box.free), 0.0)
        return between_energies(
            lambda energy: self.over_tilts(lambda phi: self._over_rates(phi, energy), self.pieces(energy)),
            f.energy,
        )

    def pieces(self, energy: float, *more: float) -> list[Range]:
        """The range of phi, cut at the vertical, where the energy allows no rates, at a mean, and more."""
        low, high = self.density.reach("phi")
        if low == high:
            return [(low, high)]
        flattest = [math.acos(energy), -math.acos(energy)] if abs(energy) < 1.0 else []
        inner = sorted({end for end in (0.0, *flattest, *more, *self.density.means("phi")) if low < end < high})
        return list(pairwise([low, *inner, high]))

    def over_tilts(self, f: Callable[[Array], Array], pieces: Sequence[Range]) -> Integral:
        """Adaptive integral of f over pieces of the range of phi; of a piece that is a point, f there.

        f (n) -> (2, n): by the rules of NODES inside.
        """
        x, weights = _gauss(NODES[1])

        def rule(piece: Range, low: float, high: float) -> Array:
            # Spaced like a sine: at flat there are logarithms, S ln S and the like.
            angle = 0.5 * (low + high) + 0.5 * (high - low) * x
            phi = 0.5 * (piece[0] + piece[1]) + 0.5 * (piece[1] - piece[0]) * np.sin(angle)
            step = 0.25 * (high - low) * (piece[1] - piece[0]) * weights * np.cos(angle)
            return f(phi) @ step

        def halved(piece: Range, low: float, high: float, whole: Array) -> tuple[Any, ...]:
            middle = 0.5 * (low + high)
            halves = rule(piece, low, middle), rule(piece, middle, high)
            return -abs(sum(halves) - whole)[0], piece, (low, middle, high), halves

        points = [f(np.array(piece[:1]))[:, 0] for piece in pieces if piece[0] == piece[1]]
        wide, ends = [piece for piece in pieces if piece[0] < piece[1]], (-_HALF_PI, _HALF_PI)
        parts = [halved(piece, *ends, rule(piece, *ends)) for piece in wide]
        limit = self.asked + _MOST_POINTS
        while True:
            fine, coarse = sum([*points, *(half for part in parts for half in part[3])], np.zeros(2))
            error = -sum(part[0] for part in parts)
            if not error > _TOLERANCE * fine or self.asked > limit or len(parts) > _MOST_PARTS:
                return Integral(float(fine), float(error + abs(fine - coarse)))
            parts.sort(key=lambda part: part[0])  # the largest error first
            _, piece, (low, middle, high), halves = parts.pop(0)
            parts += [halved(piece, low, middle, halves[0]), halved(piece, middle, high, halves[1])]

    def _shape(self, *columns: Array) -> Array:
        """The density, at coordinates that broadcast together."""
        columns = np.broadcast_arrays(*columns)
        self.asked += columns[0].size
        return self.density.shape(*columns)

    def _over_rates(self, phi: Array, energy: float) -> Array:
        """Integral over phidot, sigma3 and sigma4 at tilts phi, for energies up to `energy`: (2, n)."""
        return np.array([[self._at(each, energy, nodes) for each in phi] for nodes in NODES])

    def _at(self, phi: float, energy: float, nodes: int) -> float:
        b, q = self.disk.body, math.cos(phi)
        tilting, gyration = b.M * self.density.most("phidot") ** 2, b.I1 / (q * q)
        gyrating = gyration * self.density.most("sigma3") ** 2
        # Where a corner of the rest of the box runs out of energy, an inner range changes its end.
        left = np.array(2.0 * (energy - q))
        s4, w4 = self._rates("sigma4", left, b.J, [tilting, gyrating, tilting + gyrating], nodes)
        left = left - b.J * s4 * s4
        s3, w3 = self._rates("sigma3", left, gyration, [tilting], nodes)
        left = left[:, None] - gyration * s3 * s3
        most = np.sqrt(np.maximum(left, 0.0) / b.M)
        speeds = self.over_speeds((np.array(phi), s3, s4[:, None]), np.zeros_like(most), most, None, nodes)
        return float((speeds * w4[:, None] * w3 * (left >= 0.0)).sum())

    def _rates(
        self, name: str, left: Array, inertia: float, spent: Sequence[float], nodes: int
    ) -> tuple[Array, Array]:
        """Nodes and weights in sigma3 or sigma4; a fixed one weighs 1."""
        if not self.density.free(name):
            return np.full((*left.shape, 1), self.density.reach(name)[0]), np.ones((*left.shape, 1))
        return within_energy(self.density.reach(name), left, inertia, spent, self.density.means(name), nodes)

    def over_speeds(
        self, others: tuple[Array, Array, Array], least: Array, most: Array, gain: Array | None, nodes: int
    ) -> Array:
        """Integral of the density times sqrt(phidot^2 + gain) over least <= |phidot| <= most in the box.

        others: phi, sigma3, sigma4. gain: of the square of the speed from here to flat; without it the integral
        of the density alone.
        """
        density, halves = self.density, []
        low, high = density.reach("phidot")
        for sign, start, end in ((1.0, low, high), (-1.0, -high, -low)):
            inner = np.maximum(least, start)
            halves.append((sign, inner, np.maximum(np.minimum(most, end), inner)))
        if not density.free("phidot"):
            inside = (abs(low) >= least) & (abs(low) <= most)
            speed, steps = np.full((*least.shape, 1), low), inside[..., None]
        elif density.function is None and not density.means("phidot"):
            parts = [
                outer - inner if gain is None else _root_integral(inner, outer, gain) for _, inner, outer in halves
            ]
            return sum(parts) * self._shape(others[0], np.zeros(1), *others[1:])
        else:
            panels = [
                panels_between([inner, *(sign * mean for mean in density.means("phidot")), outer], nodes)
                for sign, inner, outer in halves
            ]
            # A half that the box does not meet has no weight, but its nodes may lie outside.
            speed = np.clip(np.concatenate([panels[0][0], -panels[1][0]], axis=-1), *density.box.ranges["phidot"])
            steps = np.concatenate([panels[0][1], panels[1][1]], axis=-1)
        f = self._shape(others[0][..., None], speed, others[1][..., None], others[2][..., None])
        if gain is not None:
            f = f * np.sqrt(np.maximum(speed * speed + gain[..., None], 0.0))
        summed: Array = (f * steps).sum(axis=-1)
        return summed


def _root_integral(low: Array, high: Array, gain: Array) -> Array:
    """Integral of sqrt(x^2 + gain) from low to high, 0 <= low <= high."""
    first, last = (np.sqrt(np.maximum(x * x + gain, 0.0)) for x in (low, high))
    ratio = (high + last) / np.maximum(low + first, 1e-300)
    return 0.5 * (high * last - low * first + gain * np.log(np.maximum(ratio, 1.0)))

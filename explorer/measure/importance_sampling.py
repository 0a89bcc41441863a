"""Draws beside the falling set for a distribution of initial states: importance sampling of rare tilts.

A state near F on one face is (tilt, speed, sigma3_bar, eta_hat). eta_hat is drawn evenly within the tube of
`measure.tubes`, and all else from the user's distributions; the tilt more often where states come near F, as some
first draws tell. What lies so near flat that no tube holds it is drawn plainly.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure import laws
from explorer.measure.distributions import Distribution
from explorer.measure.laws import Estimate
from explorer.measure.sampling import Stream
from explorer.measure.tubes import TiltAndRate, counts_on, half_width
from explorer.motion.orbits import KERNELS as OF_ENDS
from explorer.motion.trajectories import finer
from explorer.motion.turning_points import smallest_tilts
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart, motion_given, other_eta_hat
from explorer.phase.states import Array, States

BLOCK = 1 << 14
KERNELS = "algebra.constants_batch", "falling.line_chart_batch", *OF_ENDS  # for `compiled.warmup`
# Tilts below this many delta are drawn plainly: above, the width of a tube settles in a few rounds. With a larger
# delta than this they would be all there are.
_NEAR_FLAT, LARGEST_DELTA = 10.0, 0.1
# Cells: their edges from 1e-13 rad on, four in a decade; into how many parts each is cut; and the draws of a part,
# which say how often the others come from it.
_TOWARDS_FLAT, _PARTS, _PILOT = 57, 2, 64
# Least share of tilts, and of pairs, that are drawn from their own distributions: no weight exceeds one over it.
# Pairs that are hardly ever come to the tube.
_OWN, _OWN_PAIR = 0.15, 0.03
# Distance from flat that an angle from elsewhere resolves to 1e-4
_RESOLVED = 1e-12


# Weights of draws and their theta_min: the mean of weight times an indicator is a probability.
Weighted = tuple[Array, Array]


@dataclass(frozen=True)
class Rare:
    """An estimate by weighted draws.

    effective: hits of equal weight that would say as much. unknown: what draws without a known tilt might add.
    """

    estimate: Estimate
    effective: float
    unknown: float


@dataclass(frozen=True)
class NearFallingSet:
    """Draws near F on either face for states with a distribution, followed for `count` approaches to flat."""

    source: Distribution
    count: int
    accuracy: float

    @property
    def why_not(self) -> str:
        """Why F cannot be approached by draws; empty where it can."""
        first, second = self.source.pair
        names = f"{first.name} and {second.name}"
        if first.free or second.free:
            return f"{names}: eta_hat is fixed" if second.name == "eta_hat" and not second.free else ""
        return f"{names} are numbers, so that the falling set is met at single tilts or not at all"

    def below(self, delta: float, random: Stream, draws: int) -> Rare:
        """P(theta_min < delta), by so many draws at each face."""
        tubes = [Tube(self.source, face, delta, _NEAR_FLAT * delta) for face in (1, -1)]
        strata = [[self._in_tube(tube, random, n) for n in _blocks(draws)] for tube in tubes if tube.own.any()]
        strata += [[self._near_flat(*end, random, n) for n in _blocks(draws // 4)] for end in self._flat(delta)]
        return _added([_sums(parts, delta) for parts in strata])

    def _in_tube(self, tube: "Tube", random: Stream, count: int) -> Weighted:
        """Draws of a tube, and where in it they come to."""
        drawn = tube.draw_near_f(random, count)
        rows = np.flatnonzero((drawn.weight > 0.0) & drawn.within)
        theta = np.full(count, np.inf)
        theta[rows] = smallest_tilts(drawn.states(self.source.disk, tube.face, rows), self.count, self.accuracy)[0]
        return drawn.weight, theta

    def _flat(self, delta: float) -> Iterator[tuple[float, float]]:
        """The ranges of the tilt that lie beside flat, where its density is not zero there."""
        ends = (-0.5 * math.pi, 0.5 * math.pi) if self.source.tilt.name == "phi" else (0.0, math.pi)
        beside, tilt = _NEAR_FLAT * delta, self.source.tilt
        for end, inward in zip(ends, (beside, -beside), strict=True):
            # Evenly spaced tilts alone would miss a narrow distribution.
            looked_at = [end + inward * np.linspace(0.0, 1.0, 17), tilt.nodes[abs(tilt.nodes - end) <= beside]]
            if tilt.free and tilt.density(np.concatenate(looked_at)).any():
                yield end, inward

    def _near_flat(self, end: float, inward: float, random: Stream, count: int) -> Weighted:
        """Plain draws with a tilt between flat and so far inward."""
        name = self.source.tilt.name
        columns = self.source.draw(random, count)
        columns[name] = end + inward * (1.0 - random.random(count))
        weight = self.source.tilt.density(columns[name]) * abs(inward)
        if end != 0.0 and abs(inward) < _NEAR_FLAT * _RESOLVED:
            return weight, np.full(count, np.nan)
        states = self.source.states(columns)
        theta, _ = smallest_tilts(states, self.count, self.accuracy)
        bad = states.status == compiled.status.Status.BAD_INPUT
        return np.where(bad, 0.0, weight), theta


@dataclass(frozen=True)
class Drawn:
    """Draws at given tilts. weight: the density of the distribution over theirs; within: those in the tube."""

    place: TiltAndRate
    bar: Array
    eta: Array
    weight: Array
    within: NDArray[np.bool_]

    def states(self, disk: Disk, face: int, rows: NDArray[np.intp]) -> States:
        """Some of them as states, whose eta_hat keeps its digits."""
        place, (s3, s4) = self.place, self.place.chart.rates(self.bar, self.eta)
        natural = np.stack([place.q, face * place.z, -place.phidot, s3 / place.q, face * s4])[:, rows]
        motion = motion_given(disk, self.bar[rows], self.eta[rows], np.full(rows.size, face > 0))
        return States(disk, np.ascontiguousarray(natural), np.zeros(rows.size, np.int8), motion)


@dataclass(frozen=True)
class Tube:
    """Where states come flatter than delta near F of a face.

    beside: tilts below are left out, rad.
    """

    source: Distribution
    face: int
    delta: float
    beside: float

    @cached_property
    def edges(self) -> Array:
        """Of the cells of the tilt, outside of what lies beside flat; twice the same where it is a number."""
        tilt = self.source.tilt
        if not tilt.free:
            return np.repeat(tilt.nodes, 2)
        low, high = (-0.5 * math.pi, 0.5 * math.pi) if tilt.name == "phi" else (0.0, math.pi)
        low, high = low + self.beside, high - self.beside
        # Towards flat cells shrink, where the density does not vanish there.
        towards = np.geomspace(max(self.beside, 1e-13), 0.1, _TOWARDS_FLAT)
        edges = np.unique(np.concatenate([np.clip(tilt.nodes, low, high), low + towards, high - towards]))
        edges = edges[(edges >= max(low, tilt.nodes[0])) & (edges <= min(high, tilt.nodes[-1]))]
        return finer(edges if edges.size > 1 else np.array([low, high]), _PARTS)

    @cached_property
    def _widths(self) -> Array:
        """Widths of the cells; 1 of a number."""
        return np.diff(self.edges) if self.source.tilt.free else np.ones(1)

    @cached_property
    def own(self) -> Array:
        """How often the tilt itself lies in its cells."""
        return self.source.tilt.density(0.5 * (self.edges[1:] + self.edges[:-1])) * self._widths

    @cached_property
    def hits(self) -> Array:
        """How often a state whose tilt lies in a cell lies in the tube, as the first draws say."""
        random, cells = np.random.default_rng(0), np.arange(self.own.size)
        drawn = self.draw(self._in_cells(np.repeat(cells, _PILOT), random), _OWN_PAIR, random)
        hits: Array = (drawn.weight * drawn.within).reshape(-1, _PILOT).mean(axis=1)
        return hits

    @cached_property
    def shares(self) -> Array:
        """How often each cell is drawn: as often as it has hits, and some as often as the tilt lies there."""
        hits = self.own * self.hits
        hits = hits if hits.any() else self.own
        shares: Array = (1.0 - _OWN) * hits / hits.sum() + _OWN * self.own / self.own.sum()
        return shares

    def draw_near_f(self, random: Stream, count: int) -> Drawn:
        """Draws of all coordinates; where most states lie in the tube, most pairs are drawn as distributed."""
        cell = np.searchsorted(np.cumsum(self.shares)[:-1], random.random(count), "right")
        tilt = self._in_cells(cell, random)
        drawn = self.draw(tilt, np.clip(self.hits, _OWN_PAIR, 1.0 - _OWN_PAIR)[cell], random)
        of_tilts = self.source.tilt.density(tilt) * self._widths[cell] / self.shares[cell]
        return replace(drawn, weight=of_tilts * drawn.weight)

    def _in_cells(self, cell: NDArray[np.intp], random: Stream) -> Array:
        """A tilt in each of these cells."""
        inside: Array = self.edges[cell] + np.diff(self.edges)[cell] * random.random(cell.size)
        return inside

    def draw(self, tilt: Array, plain: Array | float, random: Stream) -> Drawn:
        """A speed and a pair for each of these tilts.

        The speed comes from its own distribution, and in the share `plain` of the draws so does the pair. In the
        others one of the pair does, which says sigma3_bar on F, and eta_hat is even in the tube. Both together are
        a mixture, whose density is known.
        """
        source, disk, count = self.source, self.source.disk, tilt.size
        q, z = source.place(tilt)
        pair, speed = source.spins(q, z, self.face), source.speed.draw(random, count)
        given = source.speed.name == "energy"
        phidot, z = np.zeros(count) if given else source.phidot(speed), self.face * z
        place = TiltAndRate(disk.body, q, z, phidot, line_chart(disk, q, z))
        with np.errstate(all="ignore"):
            plainly, own = random.random(count) < plain, self._pair(pair, random)
            bar = np.where(plainly, own[0], self._bar_on_f(pair, random))

            def energy(eta: Array) -> Array:
                if given:
                    return speed / disk.energy_unit
                return np.nan_to_num(place.energy(self._bar_at(bar, eta, pair), eta), nan=np.inf)

            half = half_width(disk, self.delta, energy, count)
            settled = np.isfinite(half)
            evenly = np.where(settled, half, 0.0) * (2.0 * random.random(count) - 1.0)
            eta = np.where(plainly, own[1], evenly)
            bar = self._bar_at(bar, eta, pair)
            within = settled & (abs(eta) <= half)
            target = self._pair_density(pair, bar, eta)
            tube = np.where(within, self._bar_density(pair, bar) / (2.0 * half), 0.0)
            weight = np.nan_to_num(target / ((1.0 - plain) * tube + plain * target), nan=0.0, posinf=0.0)
            left = energy(eta) - place.energy(bar, eta)
        if given:
            weight = np.where(left >= 0.0, weight, 0.0)
            place = place._replace(phidot=np.sqrt(2.0 / disk.body.M * np.maximum(left, 0.0)))
        counted = counts_on(self.face, eta, other_eta_hat(disk, bar, eta)) & np.isfinite(bar) & (settled | plainly)
        return Drawn(place, bar, eta, np.where(counted, weight, 0.0), within | ~settled)

    @property
    def _fixed(self) -> int | None:
        """Which of the pair is a number: it sets sigma3_bar, and only eta_hat is drawn."""
        return next((i for i, each in enumerate(self.source.pair) if not each.free), None)

    def _pair(self, pair: Array, random: Stream) -> tuple[Array, Array]:
        """sigma3_bar and eta_hat of draws of the pair."""
        first, second = (each.draw(random, pair.shape[-1]) for each in self.source.pair)
        (m3, n3), (m4, n4) = pair
        determinant = m3 * n4 - m4 * n3
        return (n4 * first - n3 * second) / determinant, (m3 * second - m4 * first) / determinant

    def _pair_density(self, pair: Array, bar: Array, eta: Array) -> Array:
        """The density of the pair in sigma3_bar and eta_hat, or in eta_hat alone where one is a number."""
        (m3, n3), (m4, n4) = pair
        density: Array = abs(m3 * n4 - m4 * n3)
        if self._fixed is not None:
            density = density / abs(pair[self._fixed, 0])
        for each, (m, n) in zip(self.source.pair, pair, strict=True):
            density = density * each.density(m * bar + n * eta)
        return density

    def _says_bar(self, pair: Array) -> NDArray[np.bool_]:
        """Whether the first of the pair says sigma3_bar on F: where it says it more sharply than the second."""
        first, second = (one.spread / abs(pair[i, 0]) for i, one in enumerate(self.source.pair))
        sharper: NDArray[np.bool_] = first <= second
        return sharper

    def _bar_on_f(self, pair: Array, random: Stream) -> Array:
        """sigma3_bar of the states on F with draws of one of the pair."""
        each: list[Array] = [
            one.draw(random, pair.shape[-1]) / pair[i, 0] for i, one in enumerate(self.source.pair)
        ]
        return np.where(self._says_bar(pair), *each)

    def _bar_density(self, pair: Array, bar: Array) -> Array:
        """The density of these; 1 where a number of the pair sets them."""
        if self._fixed is not None:
            return np.ones(bar.size)
        each: list[Array] = [
            one.density(pair[i, 0] * bar) * abs(pair[i, 0]) for i, one in enumerate(self.source.pair)
        ]
        return np.where(self._says_bar(pair), *each)

    def _bar_at(self, bar: Array, eta: Array, pair: Array) -> Array:
        """sigma3_bar where one of the pair is a number, which sets it; else as it is."""
        if self._fixed is None:
            return bar
        set_by: Array = (self.source.pair[self._fixed].value - pair[self._fixed, 1] * eta) / pair[self._fixed, 0]
        return set_by


def _blocks(draws: int) -> list[int]:
    return [min(BLOCK, draws - first) for first in range(0, draws, BLOCK)]


def _sums(parts: list[Weighted], delta: float) -> Array:
    """Of a stratum: sum of weights of hits, of their squares, weights of what is not known, and draws."""
    rows = []
    for weight, theta_min in parts:
        hit = np.where(theta_min < delta, weight, 0.0)
        rows.append([hit.sum(), (hit * hit).sum(), weight[np.isnan(theta_min)].sum(), hit.size])
    summed: Array = np.sum(rows, axis=0)
    return summed


def _added(strata: list[Array]) -> Rare:
    sums, squares, unknown, draws = np.array(strata).T
    estimate = laws.total(laws.mean_of_draws(sums[:, None], squares[:, None], draws[:, None]))
    whole, own = (sums / draws).sum(), (squares / draws**2).sum()
    return Rare(estimate, float(whole**2 / own) if own > 0.0 else 0.0, float((unknown / draws).sum()))

"""Draws beside the falling set for a distribution of initial states: importance sampling of rare tilts.

A state beside F on one face is (tilt, speed, sigma3_bar, eta_hat). The tilt and sigma3_bar are drawn from a
table of the density on F, the speed from its own distribution, and eta_hat evenly within the tube of
`measure.tubes`. What lies so near flat that no tube holds it is drawn plainly.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure import laws
from explorer.measure.distributions import Coordinate, Distribution
from explorer.measure.laws import Estimate
from explorer.measure.sampling import Stream
from explorer.measure.tubes import TiltAndRate, counts_on, half_width
from explorer.motion.orbits import KERNELS as OF_ENDS
from explorer.motion.orbits import ends_of, smallest, tilts_on
from explorer.motion.starts import arc_starts_of, face_of, status_at_start
from explorer.phase.lines import LineChart, motion_given, other_eta_hat
from explorer.phase.states import Array, States

BLOCK = 1 << 14
KERNELS = (  # for `compiled.warmup`
    *("algebra.constants_batch", "falling.line_chart_batch"),
    *OF_ENDS,
)
# Tilts below this many delta are drawn plainly: above, the width of a tube settles in a few rounds. With a larger
# delta than this they would be all there are.
_BESIDE_FLAT, LARGEST_DELTA = 10.0, 0.1
_SPLIT = 8  # of the cells between two nodes of the tilt: the density on F may be narrower than that of the tilt
# Share of draws from the coordinates' own distributions: it bounds the weights where the table knows too little.
_OWN = 0.15
# And the share of draws whose pair is not drawn beside F: the largest where most of the distribution lies within
# the tube, the least elsewhere, for where no width of a tube settles.
_MOST_PLAIN, _LEAST_PLAIN = 0.8, 0.05
_PAIRS = 256  # by which that is known
# Distance from flat that an angle from elsewhere resolves to 1e-4
_RESOLVED = 1e-12


def smallest_tilts(states: States, count: int, accuracy: float) -> tuple[Array, NDArray[np.int8]]:
    """The smallest tilt (rad) in the next `count` approaches to flat, and the status; 0 of what falls.

    All approaches on one face are alike, so that two say all.
    """
    code, own = compiled.status.Status, face_of(states)
    status = status_at_start(states, sided=False)
    theta = np.where(status == code.FALLS, 0.0, np.nan)
    rows = np.flatnonzero(status == code.OK)
    motions = arc_starts_of(states, own).at(rows)
    ends = ends_of(states.disk, motions)
    rises = own[rows] * states.rows.p[rows] > 0.0
    tilt, error = smallest(motions, ends) if count > 1 else tilts_on(rises & ends.crosses, motions, ends)
    known = error <= accuracy
    theta[rows] = np.where(known, tilt, np.nan)
    status[rows[~known]] = code.STEP_LIMIT
    return theta, status


@dataclass(frozen=True)
class Weighted:
    """Draws with their weights: the mean of weight times an indicator is a probability."""

    weight: Array
    theta_min: Array


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
        tables = [_Table.of(self.source, face, delta) for face in (1, -1)]
        strata = [[self._on_face(table, random, n) for n in _blocks(draws)] for table in tables if table.own.any()]
        strata += [[self._beside_flat(*end, random, n) for n in _blocks(draws // 4)] for end in self._flat(delta)]
        return _added([_sums(parts, delta) for parts in strata])

    def _on_face(self, table: "_Table", random: Stream, count: int) -> Weighted:
        """Draws in the tube of a table.

        Their weight is the density of the distribution over that of the draws, which is a mixture: with the share
        `plain` of a cell the pair comes from its own distribution; else sigma3_bar comes from the table, or is set
        by a number of the pair, and eta_hat evenly from the tube.
        """
        source, disk, face = self.source, self.source.disk, table.face
        cell, tilt = table.draw_tilt(random, count)
        q, z = source.place(tilt)
        pair = source.spins(q, z, face)
        speed = source.speed.draw(random, count)
        given = source.speed.name == "energy"
        place = TiltAndRate.of(disk, q, face * z, np.zeros(count) if given else source.phidot(speed))
        bar = table.draw_bar(cell, pair, random)
        plainly = random.random(count) < table.plain[cell]
        own = table.draw_pair(pair, random)
        bar = np.where(plainly, own[0], bar)

        def energy(eta: Array) -> Array:
            if given:
                return speed / disk.energy_unit
            return np.nan_to_num(place.energy(table.bar_at(bar, eta, pair), eta), nan=np.inf)

        with np.errstate(over="ignore", invalid="ignore"):
            half, settled = half_width(disk, table.delta, energy, np.full(count, np.inf))
            half = np.where(settled, half, np.inf)
            evenly = np.where(settled, half, 0.0) * (2.0 * random.random(count) - 1.0)
            eta = np.where(plainly, own[1], evenly)
            bar = table.bar_at(bar, eta, pair)
            tilts, pairs = source.tilt.density(tilt), table.pair_density(pair, bar, eta)
            within = np.where(abs(eta) <= half, table.bar_density(cell, pair, bar) / (2.0 * half), 0.0)
            drawn = (1.0 - table.plain[cell]) * within + table.plain[cell] * pairs
            weight = np.nan_to_num(tilts * pairs / (table.tilt_density(cell) * drawn), nan=0.0, posinf=0.0)
            if given:
                left = energy(eta) - place.energy(bar, eta)
                weight = np.where(left >= 0.0, weight, 0.0)
                place = replace(place, phidot=np.sqrt(2.0 / disk.body.M * np.maximum(left, 0.0)))
        weight[~counts_on(face, eta, other_eta_hat(disk, bar, eta)) | ~np.isfinite(bar)] = 0.0
        weight[~plainly & ~settled] = 0.0  # no tube, no draw in it
        rows = np.flatnonzero((weight > 0.0) & (abs(eta) <= half))
        theta = np.full(count, np.inf)
        s3, s4 = place.chart.rates(bar, eta)
        natural = np.stack([q, z, -place.phidot, s3 / q, face * s4])[:, rows]
        motion = motion_given(disk, bar[rows], eta[rows], np.full(rows.size, face > 0))
        states = States(disk, np.ascontiguousarray(natural), np.zeros(rows.size, np.int8), motion)
        theta[rows] = smallest_tilts(states, self.count, self.accuracy)[0]
        return Weighted(weight, theta)

    def _flat(self, delta: float) -> Iterator[tuple[float, float]]:
        """The ranges of the tilt that lie beside flat, where its density is not zero there."""
        ends = (-0.5 * math.pi, 0.5 * math.pi) if self.source.tilt.name == "phi" else (0.0, math.pi)
        beside = _BESIDE_FLAT * delta
        for end, inward in zip(ends, (beside, -beside), strict=True):
            if self.source.tilt.free and self.source.tilt.density(end + inward * np.linspace(0.0, 1.0, 17)).any():
                yield end, inward

    def _beside_flat(self, end: float, inward: float, random: Stream, count: int) -> Weighted:
        """Plain draws with a tilt between flat and so far inward."""
        name = self.source.tilt.name
        columns = self.source.draw(random, count)
        columns[name] = end + inward * (1.0 - random.random(count))
        weight = self.source.tilt.density(columns[name]) * abs(inward)
        if end != 0.0 and abs(inward) < _BESIDE_FLAT * _RESOLVED:
            return Weighted(weight, np.full(count, np.nan))
        states = self.source.states(columns)
        theta, _ = smallest_tilts(states, self.count, self.accuracy)
        bad = states.status == compiled.status.Status.BAD_INPUT
        return Weighted(np.where(bad, 0.0, weight), theta)


@dataclass(frozen=True)
class _Table:
    """How often states come flatter than delta beside F of a face, by cells of the tilt and of sigma3_bar.

    edges: of the cells of the tilt (n + 1), equal where it is a number. bars: (n, k + 1) edges of those of
    sigma3_bar, k = 0 where the pair sets it. share: (n, max(k, 1)), by which sigma3_bar is drawn at a tilt.
    hits: (n) how often the pair lies in the tube, roughly; where that is mostly so, beside flat, most draws are
    of its own distribution.
    """

    source: Distribution
    face: int
    delta: float
    edges: Array
    bars: Array
    share: Array
    hits: Array

    @classmethod
    def of(cls, source: Distribution, face: int, delta: float) -> "_Table":
        disk, edges = source.disk, _cells(source.tilt, _BESIDE_FLAT * delta)
        middle = 0.5 * (edges[1:] + edges[:-1])
        pair = source.spins(*source.place(middle), face)
        with np.errstate(all="ignore"):
            bars, at = _bars(source, pair)
            step = np.diff(bars, axis=1) if bars.shape[1] else 1.0
            share = _pair_density(source, pair[..., None], at, 0.0) * step * _impact(source, middle, face, at)
        share = np.nan_to_num(share, nan=0.0, posinf=0.0)
        on_f = share.sum(axis=1) * disk.eta_to_eta_hat(2.0 * math.sqrt(2.0 * disk.body.I1)) * delta
        hits = np.minimum(np.maximum(on_f, _within(source, middle, face, delta)), 1.0)
        return cls(source, face, delta, edges, bars, share, hits)

    @property
    def plain(self) -> Array:
        """Of draws in each cell, the share whose pair comes from its own distribution."""
        return np.maximum(_LEAST_PLAIN, _MOST_PLAIN * self.hits)

    @cached_property
    def own(self) -> Array:
        """How often the tilt itself lies in its cells."""
        middle = 0.5 * (self.edges[1:] + self.edges[:-1])
        return self.source.tilt.density(middle) * _widths(self.edges)

    @cached_property
    def tilts(self) -> Array:
        """By which cells of the tilt are drawn."""
        hits = self.own * self.hits
        hits = hits if hits.any() else self.own
        drawn: Array = (1.0 - _OWN) * hits / hits.sum() + _OWN * self.own / self.own.sum()
        return drawn

    def draw_tilt(self, random: Stream, count: int) -> tuple[NDArray[np.intp], Array]:
        """Cells and tilts."""
        cell = _place_in(np.cumsum(self.tilts), random.random(count))
        return cell, self.edges[cell] + np.diff(self.edges)[cell] * random.random(count)

    def tilt_density(self, cell: NDArray[np.intp]) -> Array:
        """The density that these tilts were drawn from."""
        density: Array = self.tilts[cell] / _widths(self.edges)[cell]
        return density

    @cached_property
    def _summed(self) -> Array:
        """Running sums of the cells of sigma3_bar, row by row, each from 0 to 1 beyond the one before."""
        total = self.share.sum(axis=1, keepdims=True)
        even = np.where(total > 0.0, self.share, 1.0) / np.where(total > 0.0, total, self.share.shape[1])
        summed: Array = np.minimum(np.cumsum(even, axis=1), 1.0)
        summed[:, -1] = 1.0
        return summed

    def draw_bar(self, cell: NDArray[np.intp], pair: Array, random: Stream) -> Array:
        """sigma3_bar of these cells, some from the distribution of one of the pair; 0 where the pair sets it."""
        count = cell.size
        if not self.bars.shape[1]:
            return np.zeros(count)
        rows = np.arange(self.share.shape[0])[:, None]
        found = np.searchsorted((self._summed + rows).ravel(), cell + random.random(count), "right")
        j = np.clip(found - cell * self.share.shape[1], 0, self.share.shape[1] - 1)
        low, high = self.bars[cell, j], self.bars[cell, j + 1]
        which = random.random(count) < self._first_share
        with np.errstate(divide="ignore", invalid="ignore"):
            alone = [each.draw(random, count) / pair[i, 0] for i, each in enumerate(self.source.pair)]
        drawn = low + (high - low) * random.random(count)
        bar: Array = np.where(random.random(count) < _OWN, np.where(which, *alone), drawn)
        return bar

    def bar_density(self, cell: NDArray[np.intp], pair: Array, bar: Array) -> Array:
        """The density of `draw_bar`; 1 where it draws nothing."""
        if not self.bars.shape[1]:
            return np.ones(cell.size)
        j = np.clip((self.bars[cell] <= bar[:, None]).sum(axis=1) - 1, 0, self.share.shape[1] - 1)
        low, high = self.bars[cell, j], self.bars[cell, j + 1]
        share = self._summed[cell, j] - np.where(j > 0, self._summed[cell, j - 1], 0.0)
        with np.errstate(all="ignore"):
            table = np.nan_to_num(np.where((bar >= low) & (bar < high), share / (high - low), 0.0), nan=0.0)
            alone = [each.density(pair[i, 0] * bar) * abs(pair[i, 0]) for i, each in enumerate(self.source.pair)]
        first = self._first_share
        density: Array = (1.0 - _OWN) * table + _OWN * (first * alone[0] + (1.0 - first) * alone[1])
        return density

    @property
    def _first_share(self) -> float:
        """How often the first of the pair says sigma3_bar: always where the other does not depend on it."""
        return 1.0 if self.source.pair[1].name == "eta_hat" else 0.5

    def draw_pair(self, pair: Array, random: Stream) -> tuple[Array, Array]:
        """sigma3_bar and eta_hat of the pair's own distributions."""
        first, second = (each.draw(random, pair.shape[-1]) for each in self.source.pair)
        return _constants(pair, first, second)

    def bar_at(self, bar: Array, eta: Array, pair: Array) -> Array:
        """sigma3_bar where one of the pair is a number, which sets it; else as it is."""
        fixed = _fixed(self.source)
        if fixed is None:
            return bar
        with np.errstate(divide="ignore", invalid="ignore"):
            set_by: Array = (self.source.pair[fixed].value - pair[fixed, 1] * eta) / pair[fixed, 0]
        return set_by

    def pair_density(self, pair: Array, bar: Array, eta: Array) -> Array:
        """The density of the pair in sigma3_bar and eta_hat, or in eta_hat alone where one is a number."""
        return _pair_density(self.source, pair, bar, eta)


def _within(source: Distribution, tilt: Array, face: int, delta: float) -> Array:
    """Which share of a few pairs comes flatter, to leading order, from each of these tilts at the middle speed."""
    random, disk, n = np.random.default_rng(0), source.disk, tilt.size
    q, z = source.place(tilt)
    first, second = (each.draw(random, _PAIRS) for each in source.pair)
    with np.errstate(all="ignore"):
        bar, eta = _constants(source.spins(q, z, face)[..., None], first, second)
        speed = np.full(n, np.median(source.speed.nodes))
        given = source.speed.name == "energy"
        place = TiltAndRate.of(disk, q, face * z, np.zeros(n) if given else source.phidot(speed))
        columns = replace(place, chart=LineChart(*(column[:, None] for column in place.chart)))
        wide = replace(columns, tilting=place.tilting[:, None], inertia3=place.inertia3[:, None])
        energy = np.full_like(bar, speed[0] / disk.energy_unit) if given else wide.energy(bar, eta)
        reach = np.sqrt(2.0 * disk.body.I1 * (energy - disk.energy_at_flat(bar)))
        within: Array = (abs(eta) < disk.eta_to_eta_hat(delta * reach)).mean(axis=1)
    return within


def _constants(pair: Array, first: Array, second: Array) -> tuple[Array, Array]:
    """sigma3_bar and eta_hat from values of the pair."""
    (m3, n3), (m4, n4) = pair
    determinant = m3 * n4 - m4 * n3
    return (n4 * first - n3 * second) / determinant, (m3 * second - m4 * first) / determinant


def _fixed(source: Distribution) -> int | None:
    """Which of the pair is a number."""
    return next((i for i, each in enumerate(source.pair) if not each.free), None)


def _pair_density(source: Distribution, pair: Array, bar: Array, eta: Array | float) -> Array:
    (m3, n3), (m4, n4) = pair
    fixed = _fixed(source)
    density: Array = abs(m3 * n4 - m4 * n3)
    if fixed is not None:
        density = density / abs(pair[fixed, 0])
    for each, (m, n) in zip(source.pair, pair, strict=True):
        density = density * each.density(m * bar + n * eta)
    return density


def _bars(source: Distribution, pair: Array) -> tuple[Array, Array]:
    """Edges (n, k + 1) and middles (n, k) of cells of sigma3_bar on F; where the pair sets it, none and itself."""
    fixed = _fixed(source)
    if fixed is not None:
        return np.zeros((pair.shape[-1], 0)), (source.pair[fixed].value / pair[fixed, 0])[:, None]
    reach = [each.nodes / pair[i, 0][:, None] for i, each in enumerate(source.pair) if pair[i, 0].all()]
    bars = np.sort(np.concatenate(reach, axis=1), axis=1)
    return bars, 0.5 * (bars[:, 1:] + bars[:, :-1])


def _cells(tilt: Coordinate, beside_flat: float) -> Array:
    """Edges of the cells of the tilt, outside of what lies beside flat."""
    low, high = (-0.5 * math.pi, 0.5 * math.pi) if tilt.name == "phi" else (0.0, math.pi)
    if not tilt.free:
        return np.repeat(tilt.nodes, 2)
    low, high = low + beside_flat, high - beside_flat
    nodes = np.clip(tilt.nodes, low, high)
    # Towards flat cells shrink, where the density does not vanish there.
    towards = max(beside_flat, 1e-13) * 10.0 ** np.linspace(0.0, 14.0, 57)
    towards = towards[towards < 0.1]
    nodes = np.unique(np.concatenate([nodes, *(low + towards, high - towards)]))
    nodes = nodes[(nodes >= max(low, tilt.nodes[0])) & (nodes <= min(high, tilt.nodes[-1]))]
    if nodes.size < 2:
        nodes = np.array([low, high])
    parts = np.linspace(0.0, 1.0, _SPLIT, endpoint=False)
    edges: Array = np.unique([*(nodes[:-1, None] + np.diff(nodes)[:, None] * parts).ravel(), nodes[-1]])
    return edges


def _impact(source: Distribution, tilt: Array, face: int, bar: Array) -> Array:
    """What the width of a tube is proportional to: sqrt(E - V_0) of states on F, (n, k), 0 where none would fall.

    It is the mean over five speeds, each as likely.
    """
    disk, speed = source.disk, source.speed
    q, z = source.place(tilt)
    place = TiltAndRate.of(disk, q, face * z, np.zeros_like(q))
    # On F the energy without tilting is cos(phi) and a multiple of sigma3_bar^2.
    still = q[:, None] + (place.energy(np.ones_like(q), np.zeros_like(q)) - q)[:, None] * bar * bar
    speeds = speed.law.ppf([0.1, 0.3, 0.5, 0.7, 0.9]) * speed.unit if speed.free else speed.nodes
    if speed.name == "energy":
        energies = [np.where(each >= still, each, 0.0) for each in speeds / disk.energy_unit]
    else:
        energies = [still + 0.5 * disk.body.M * source.phidot(each) ** 2 for each in speeds]
    flat = disk.energy_at_flat(bar)
    mean: Array = np.mean([np.sqrt(np.maximum(energy - flat, 0.0)) for energy in energies], axis=0)
    return mean


def _widths(edges: Array) -> Array:
    """Widths of cells; 1 of a number."""
    return np.diff(edges) if edges[-1] > edges[0] else np.ones(1)


def _place_in(summed: Array, unit: Array) -> NDArray[np.intp]:
    """The entries in which these shares of a running sum lie."""
    found: NDArray[np.intp] = np.minimum(np.searchsorted(summed, unit * summed[-1], "right"), summed.size - 1)
    return found


def _blocks(draws: int) -> list[int]:
    return [min(BLOCK, draws - first) for first in range(0, draws, BLOCK)]


def _sums(parts: list[Weighted], delta: float) -> Array:
    """Of a stratum: sum of weights of hits, of their squares, weights of what is not known, and draws."""
    rows = []
    for part in parts:
        hit = np.where(part.theta_min < delta, part.weight, 0.0)
        rows.append([hit.sum(), (hit * hit).sum(), part.weight[np.isnan(part.theta_min)].sum(), hit.size])
    summed: Array = np.sum(rows, axis=0)
    return summed


def _added(strata: list[Array]) -> Rare:
    sums, squares, unknown, draws = np.array(strata).T
    estimate = laws.total(laws.mean_of_draws(sums[:, None], squares[:, None], draws[:, None]))
    whole, own = (sums / draws).sum(), (squares / draws**2).sum()
    return Rare(estimate, float(whole**2 / own) if own > 0.0 else 0.0, float((unknown / draws).sum()))

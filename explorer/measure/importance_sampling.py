"""Draws beside the falling set for a distribution of initial states: importance sampling of rare tilts.

A state near F on one face is (tilt, speed, sigma3_bar, eta_hat). eta_hat is drawn evenly within the tube of
`measure.tubes`, and all else from the user's distributions; the tilt more often where states come near F, as some
first draws tell. What lies so near flat that no tube holds it is drawn plainly.
"""

import math
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure import laws
from explorer.measure.distributions import Distribution
from explorer.measure.laws import Estimate, Law
from explorer.measure.sampling import Stream
from explorer.measure.tubes import TiltAndRate, counts_on, half_width
from explorer.motion.orbits import KERNELS as OF_ENDS
from explorer.motion.threads import blocks
from explorer.motion.trajectories import finer
from explorer.motion.turning_points import smallest_tilts
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart, motion_given, other_eta_hat
from explorer.phase.states import Array, States

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


# Hits, or worth of hits, with which an interval is to be trusted; and the fewest draws that tell of a law.
FEWEST, LEAST = 100, 1 << 12
# Where the law holds: decades of delta, and how far P may be off C delta.
_DELTAS = tuple(10.0**-decade for decade in range(1, 13))
_HOLDS = 0.05
_SMALL = 1e-30  # the delta at which C is found: eta_hat is a number of its own, so no digit is lost


@dataclass(frozen=True)
class Rare:
    """An estimate by weighted draws.

    effective: hits of equal weight that would say as much. unknown: what draws without a known tilt might add.
    """

    estimate: Estimate
    effective: float
    unknown: float

    @classmethod
    def of(cls, sums: Array, share: float) -> "Rare":
        """From the sums of independent strata (strata, 4), as `Weighted.sums`, over the share of all draws."""
        total, squares, unknown, draws = np.reshape(sums, (-1, 4)).T
        found = laws.total(laws.mean_of_draws(total[:, None], squares[:, None], draws[:, None]))
        whole, own = (total / draws).sum(), (squares / draws**2).sum()
        estimate = Estimate(found.value / share, found.error / share, found.dof)
        return cls(estimate, float(whole**2 / own) if own > 0.0 else 0.0, float((unknown / draws).sum() / share))


class Weighted(NamedTuple):
    """Draws of one stratum.

    weight: the mean of weight times an indicator is the probability of an event there; zero outside of the tube,
    the energies and the distribution, and where the other face is nearer. theta_min: of the whole motion (rad);
    NaN where the weight is zero, and where it is not known.
    """

    states: States
    weight: Array
    theta_min: Array
    status: NDArray[np.int8]

    def sums(self, delta: float) -> list[float]:
        """Sums of the weights of hits, of their squares and of the weights of what is not known, and draws."""
        hit = np.where(self.theta_min < delta, self.weight, 0.0)
        unknown = self.weight[np.isnan(self.theta_min)]
        return [float(hit.sum()), float((hit * hit).sum()), float(unknown.sum()), hit.size]


@dataclass(frozen=True)
class NearFallingSet:
    """Draws near F on either face for states with a distribution, followed for `count` approaches to flat.

    Probabilities are those of draws from the laws of its coordinates that are states, in its energies, and times
    its weight. Over the share of all such draws they are those of the distribution.
    """

    source: Distribution
    count: int
    accuracy: float

    def below(self, delta: float, random: Stream, draws: int, share: float = 1.0) -> Rare:
        """P(theta_min < delta), by so many draws at each face."""
        sums = []
        for face in (1, -1):
            drawn = [self.draw(face, delta, random, rows.stop - rows.start) for rows in blocks(draws)]
            sums += np.sum([[part.sums(delta) for part in block] for block in drawn], axis=0).tolist()
        return Rare.of(np.array(sums), share)

    def law(self, random: Stream, draws: int, share: float = 1.0) -> Law | None:
        """C, and from which delta on it holds; None where P is no multiple of small ones, or F is hardly met."""
        C = self.below(_SMALL, random, draws, share)
        if C.effective < FEWEST:
            return None
        relative = C.estimate.error / C.estimate.value
        # So many draws that errors are a fifth of what is asked, and at least a quarter of those of C.
        some = max(LEAST, int(draws * min(max((relative / (0.2 * _HOLDS)) ** 2, 0.25), 16.0)))

        @cache
        def off(delta: float) -> tuple[float, float]:
            """By how much P differs from C delta, relative, and the standard error of that."""
            part = self.below(delta, random, some, share)
            if part.effective < FEWEST:
                return math.inf, math.inf
            unit = C.estimate.value * (delta / _SMALL)
            return abs(part.estimate.value / unit - 1.0), math.hypot(part.estimate.error / unit, relative)

        def holds(delta: float) -> bool:
            return sum(off(delta)) <= _HOLDS

        away, error = off(_DELTAS[-1])
        if not away <= _HOLDS + 3.0 * error < math.inf:
            return None
        # One delta may agree by chance, where P crosses the law.
        below = next((high for high, low in pairwise(_DELTAS) if holds(high) and holds(low)), _DELTAS[-1])
        return Law(float(C.estimate.value / _SMALL), float(C.estimate.error / _SMALL), below)

    @cached_property
    def _tubes(self) -> dict[tuple[int, float], "Tube"]:
        """Tubes by face and tilt: their first draws serve all others."""
        return {}

    def draw(self, face: int, delta: float, random: Stream, count: int) -> list[Weighted]:
        """So many draws near F of a face, or none: in the tube, and a fifth of them beside flat where some lie."""
        source = self.source
        beside = _NEAR_FLAT * delta if source.plain and delta <= LARGEST_DELTA else 0.0
        tube = self._tubes.setdefault((face, delta), Tube(source, face, delta, beside))
        flat = max(count // 5, 2) if beside and self._lies_beside(face, beside) else 0
        parts = []
        if tube.own.any():
            drawn = tube.draw_near_f(random, count - flat)
            parts.append(self._followed(drawn.states(source.disk, face), drawn.weight, drawn.within))
        return [*parts, self._near_flat(face, beside, random, flat)] if flat else parts

    def _followed(self, states: States, weight: Array, within: NDArray[np.bool_]) -> Weighted:
        """theta_min of draws in the tube, weighted by what else the density is."""
        weight, theta = self.source.weighed(states, np.where(within, weight, 0.0)), np.full(weight.size, np.nan)
        rows, status = np.flatnonzero(weight > 0.0), np.zeros(weight.size, np.int8)
        theta[rows], status[rows] = smallest_tilts(states.at(rows), self.count, self.accuracy)
        return Weighted(states, weight, theta, status)

    def _flat_end(self, face: int) -> tuple[float, float]:
        """The tilt that is flat on a face, and the direction away from it."""
        if self.source.tilt.name == "phi":
            return face * 0.5 * math.pi, -face
        return (0.0, 1.0) if face == self.source.face else (math.pi, -1.0)

    def _lies_beside(self, face: int, beside: float) -> bool:
        """Whether some tilts lie so near flat on a face."""
        (end, inward), tilt = self._flat_end(face), self.source.tilt
        # Evenly spaced tilts alone would miss a narrow distribution.
        nodes = tilt.nodes[abs(tilt.nodes - end) <= beside]
        looked_at = [end + inward * beside * np.linspace(0.0, 1.0, 17), nodes]
        return tilt.free and bool(tilt.density(np.concatenate(looked_at)).any())

    def _near_flat(self, face: int, beside: float, random: Stream, count: int) -> Weighted:
        """Plain draws with a tilt between flat and so far from it."""
        (end, inward), name = self._flat_end(face), self.source.tilt.name
        columns = self.source.draw_laws(random, count)
        columns[name] = end + inward * beside * (1.0 - random.random(count))
        weight, states = self.source.tilt.density(columns[name]) * beside, self.source.states(columns)
        if end != 0.0 and beside < _NEAR_FLAT * _RESOLVED:
            return Weighted(states, weight, np.full(count, np.nan), states.status)
        theta, status = smallest_tilts(states, self.count, self.accuracy)
        bad = states.status == compiled.status.Status.BAD_INPUT
        return Weighted(states, np.where(bad, 0.0, weight), theta, status)


@dataclass(frozen=True)
class Draws:
    """Draws at given tilts. weight: the density of the distribution over theirs; within: those in the tube."""

    place: TiltAndRate
    bar: Array
    eta: Array
    weight: Array
    within: NDArray[np.bool_]

    def states(self, disk: Disk, face: int) -> States:
        """The states, whose eta_hat keeps its digits."""
        place, count = self.place, self.bar.size
        with np.errstate(all="ignore"):  # where the weight is zero
            s3, s4 = place.chart.rates(self.bar, self.eta)
            natural = np.stack([place.q, face * place.z, -place.phidot, s3 / place.q, face * s4])
            motion = motion_given(disk, self.bar, self.eta, np.full(count, face > 0))
        return States(disk, np.ascontiguousarray(natural), np.zeros(count, np.int8), motion)


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

    def draw_near_f(self, random: Stream, count: int) -> Draws:
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

    def draw(self, tilt: Array, plain: Array | float, random: Stream) -> Draws:
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
        return Draws(place, bar, eta, np.where(counted, weight, 0.0), within | ~settled)

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
        set_by: Array = (self.source.pair[self._fixed].ends[0] - pair[self._fixed, 1] * eta) / pair[self._fixed, 0]
        return set_by

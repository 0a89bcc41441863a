"""P(theta_min < delta) for states drawn from a density: how it is counted, and what that says of the law C delta.

Plain draws count hits. Batches of weighted draws in tubes near F add up weights and their squares, of every rung
of a ladder of delta and at each face. From these come estimates, fits, tests, and how the probability splits.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure import laws, statistics
from explorer.measure.density import Density
from explorer.measure.distributions import Distribution
from explorer.measure.falling_constant import FallingConstant, constant_of, mass_of
from explorer.measure.importance_sampling import Tube
from explorer.measure.invariance import flow_stretch, push_forward
from explorer.measure.laws import SHAPE_BINS, Estimate
from explorer.measure.sampling import Stream, numbered_stream
from explorer.measure.tubes import widest_eta
from explorer.motion.turning_points import smallest_tilts
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, phi_to_states

# The next term of the law is of order delta: 1e-4 of C here, and rungs above only measure it.
LAW_LIMIT = 1e-4
FEWEST_HITS = 50  # worth of equal weight in a rung; with fewer its interval is not to be trusted
_NEAREST_FLAT = 0.01  # share of the box's distance from flat up to which the law may be tested
_NARROWEST = 1e-3  # half-width of a tube over the narrowest width of the density, likewise
_MANY = 25  # plain hits, enough for a normal distribution
# For the invariance of the measure: states, their stream, and a time in natural units.
_FOLLOWED, _INVARIANCE, _LATER = 256, 1 << 40, 5.0

# Columns of `FallingProbability.batch`: arrays (rungs, 2 faces, batches, ...), face +1 first.
Tubes = dict[str, Array]


@dataclass(frozen=True)
class Draws:
    """States of a tube, one array entry each, in the units of the disk.

    weight: the mean of weight times an indicator, over the draws, is the probability of the event within the
    tube. Zero outside the tube, the box or the energies, and where the other face is nearer.
    theta_min: smallest tilt of the whole motion (rad); NaN where status is not OK or the weight is zero.
    """

    phi: Array
    phidot: Array
    sigma3_bar: Array
    eta_hat: Array
    energy: Array
    weight: Array
    theta_min: Array
    status: NDArray[np.int8]


@dataclass(frozen=True)
class FallingProbability:
    """P(theta_min < delta) for states of a disk drawn from a density, rung by rung.

    deltas: the rungs (rad), largest first. accuracy: relative, of theta_min. samples: plain draws.
    """

    disk: Disk
    source: Density
    deltas: Array
    accuracy: float
    samples: int
    seed: int

    @cached_property
    def law_limit(self) -> float:
        """The largest delta at which the next term of the law may be neglected."""
        b, density = self.disk.body, self.source.seen_from(self.disk, 1)
        away = 0.5 * np.pi - max(map(abs, density.box.ranges["phi"]))
        near_flat = _NEAREST_FLAT * away if away > 0.0 else LAW_LIMIT
        # Of a fixed rate its distance from 0 counts.
        widths = [high - low or abs(low) or np.inf for low, high in map(density.reach, COORDINATES[2:])]
        bells = [deviation for name, (_, deviation) in density.gaussian if name in COORDINATES[2:]]
        # Few states of the box have more energy: it is the largest in it at the vertical.
        inertias = zip(COORDINATES[1:], (b.M, b.I1, b.J), strict=True)
        energy = 1.0 + 0.5 * sum(inertia * density.most(name) ** 2 for name, inertia in inertias)
        # The half-width of a thin tube is proportional to its delta.
        tube = float(widest_eta(np.array([min(energy, density.energy[1])]), LAW_LIMIT, self.disk)[0]) / LAW_LIMIT
        return float(min(LAW_LIMIT, near_flat, _NARROWEST * min(widths + bells) / tube))

    @cached_property
    def tested(self) -> NDArray[np.bool_]:
        """The rungs at which the law is tested."""
        return self.deltas <= self.law_limit

    @cached_property
    def constant(self) -> FallingConstant:
        """C by an integral over F. Raises InputError where the density is zero in all of the box."""
        return constant_of(self.disk, self.source)

    @cached_property
    def _tubes_drawn(self) -> dict[tuple[int, float], Tube]:
        """Tubes by face and tilt: their first draws serve all others."""
        return {}

    def draw(self, face: int, delta: float, random: Stream, count: int) -> Draws:
        """Draws in the tube of tilt delta beside the line of one face."""
        source = Distribution.of_density(self.disk, self.source)
        tube = self._tubes_drawn.setdefault((face, delta), Tube(source, face, delta, 0.0))
        drawn = tube.draw_near_f(random, count)
        place, unit = drawn.place, self.disk.rate_unit
        sigma3, sigma4 = place.chart.rates(drawn.bar * unit, drawn.eta * unit)
        given = face * np.arctan2(place.z, place.q), place.phidot * unit, sigma3, face * sigma4
        energy = place.energy(drawn.bar, drawn.eta) * self.disk.energy_unit
        low, high = self.source.energy
        rows = np.flatnonzero((drawn.weight > 0.0) & drawn.within & (energy >= low) & (energy <= high))
        weight, theta, status = np.zeros(count), np.full(count, np.nan), np.zeros(count, np.int8)
        weight[rows] = self._over_factors * drawn.weight[rows]
        if self.source.function is not None:
            weight[rows] *= self.source.called(dict(zip(COORDINATES, (each[rows] for each in given), strict=True)))
        theta[rows], status[rows] = smallest_tilts(drawn.states(self.disk, face, rows), 2, self.accuracy)
        return Draws(*given[:2], drawn.bar * unit, drawn.eta * unit, energy, weight, theta, status)

    @cached_property
    def _over_factors(self) -> float:
        """The integral of the factors of the density's coordinates over that of the density."""
        density = self.source.seen_from(self.disk, 1)
        of_factors = math.prod(density.factor_mass(name) for name in density.box.free)
        return of_factors / mass_of(self.disk, self.source)

    # What is counted

    def below(self, theta_min: Array) -> NDArray[np.int64]:
        """Plain draws between neighbouring rungs, from the smallest on; last, those that are below none."""
        return np.bincount(np.searchsorted(self.deltas[::-1], theta_min, "right"), minlength=self.deltas.size + 1)

    def batch(self, rung: int, face: int, draws: Draws) -> dict[str, Any]:
        """What is kept of a batch of draws in a tube: of its hits the sums of weights, and of their squares.

        By sign of eta_hat and by tilt: (2, bins).
        """
        delta = self.deltas[rung]
        hit = draws.weight * (draws.theta_min < delta)
        rows = np.flatnonzero(hit)
        tilt = (draws.theta_min[rows] / delta * SHAPE_BINS).astype(np.int64)
        splits = {
            "sign": (draws.eta_hat[rows] > 0.0, 2),
            "tilt": (np.minimum(tilt, SHAPE_BINS - 1), SHAPE_BINS),
        }
        return {
            "rung": rung,
            "face": face,
            "draws": hit.size,
            "hits": rows.size,
            "unresolved": float(draws.weight[draws.status != compiled.status.Status.OK].sum()),
        } | {
            name: [np.bincount(where, hit[rows] ** power, bins).tolist() for power in (1, 2)]
            for name, (where, bins) in splits.items()
        }

    def _tubes(self, batches: Sequence[dict[str, Any]]) -> Tubes:
        rows = sorted(batches, key=lambda row: (row["rung"], -row["face"]))
        columns = {name: np.array([row[name] for row in rows], np.float64) for name in rows[0]}
        rungs = self.deltas.size
        return {name: values.reshape(rungs, 2, -1, *values.shape[1:]) for name, values in columns.items()}

    def _mean(self, tubes: Tubes, signs: tuple[float, float] = (1.0, 1.0)) -> Estimate:
        """P(theta_min < delta) by rung and face, states with eta_hat < 0 and > 0 with these signs."""
        sums, squares = tubes["sign"][..., 0, :] @ signs, tubes["sign"][..., 1, :].sum(axis=-1)
        return laws.mean_of_draws(sums, squares, tubes["draws"])

    # What the counts say

    def summary(self, below: NDArray[np.int64], falls: int, batches: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """The numbers of a run; without enough hits slope and constant are None, and there are no tests.

        below, batches: sums and lists of what the methods of these names give.
        """
        hits, tubes, constant = np.cumsum(below[:-1])[::-1], self._tubes(batches), self.constant
        ladder = laws.total(self._mean(tubes))
        summary: dict[str, Any] = {
            "samples": self.samples,
            "falls": falls,
            "upper_bound_95": statistics.upper_bound(falls, self.samples),
            "constant_predicted": constant.value,
            "constant_predicted_error": constant.error,
            "ladder": self._ladder(tubes, ladder, hits),
            "invariance": self._invariance(),
            "slope": None,
            "constant": None,
        }
        enough = all(row["effective_sample_size"] >= FEWEST_HITS for row in summary["ladder"])
        if not (constant.value > 0.0 and enough):
            return summary
        delta, tested = self.deltas[self.tested], ladder[self.tested]
        summary["slope"] = laws.fit_slope(delta, tested).described()
        summary["constant"] = laws.fit_constant(delta, tested).described()
        summary["law_limit"] = self.law_limit
        summary |= self._tests(delta, tested, hits[self.tested])
        summary["p_value_counts_against_tubes"] = self._agreement(ladder, hits)
        summary["splits"] = self._splits(tubes, ladder)
        summary["convergence"] = self._convergence(tubes)
        return summary

    def _ladder(self, tubes: Tubes, ladder: Estimate, hits: NDArray[np.int64]) -> list[dict[str, Any]]:
        """Counts of plain draws with exact intervals, and estimates from the tubes."""
        # A draw whose tilt is not known may be a hit or not.
        unknown = (tubes["unresolved"].sum(axis=-1) / tubes["draws"].sum(axis=-1)).sum(axis=-1)
        sums, squares = tubes["sign"].sum(axis=(1, 2, 4)).T
        wider = np.stack([np.zeros_like(unknown), unknown], axis=-1)
        together = laws.simultaneous(self.deltas.size)
        return _rows(
            delta=self.deltas,
            count=hits,
            plain=[statistics.share(count, self.samples) for count in hits.tolist()],
            estimate=ladder.value,
            error=ladder.error,
            interval_95=np.maximum(ladder.interval(), 0.0) + wider,
            interval_95_simultaneous=np.maximum(ladder.interval(together), 0.0) + wider,
            tube_draws=tubes["draws"].sum(axis=(1, 2)).astype(np.int64),
            tube_hits=tubes["hits"].sum(axis=(1, 2)).astype(np.int64),
            # Hits of equal weight that would say as much
            effective_sample_size=np.divide(sums**2, squares, out=np.zeros_like(sums), where=squares > 0.0),
            unresolved=unknown,
            predicted=self.constant.value * self.deltas,
        )

    def _invariance(self) -> dict[str, float]:
        """Whether the measure is one: the flow's determinant, and states pushed forward."""
        start = self.source.draw(self.disk, numbered_stream(self.seed, _INVARIANCE), _FOLLOWED)
        stretch = flow_stretch(phi_to_states(self.disk, **start))
        return {
            "determinant_error": float(np.nanmax(abs(stretch.determinant - 1.0))),
            "determinant_rounding": float(np.nanmax(stretch.rounding)),
            "push_forward_p_value": push_forward(self.disk, _LATER * self.disk.time_unit, rng=self.seed).p_value,
        }

    def _tests(self, delta: Array, tested: Estimate, hits: NDArray[np.int64]) -> dict[str, Any]:
        """p-values of the law and of wrong ones: from tubes, from plain counts, and the one that can tell."""
        known = laws.known_laws(self.constant.value, float(delta[0]))
        relative = self.constant.error / self.constant.value
        tubes = {name: laws.ladder_p(delta, tested, law, relative) for name, law in known.items()}
        counts = {name: laws.counts_p(delta, hits, self.samples, law) for name, law in known.items()}
        # Tubes hold what is near F. Falls anywhere else are for plain draws to find.
        headline = tubes | {"plateau": counts["plateau"]}
        return {"p_value": headline, "p_value_tubes": tubes, "p_value_counts": counts}

    def _agreement(self, ladder: Estimate, hits: NDArray[np.int64]) -> float:
        """p-value that plain counts and tubes estimate the same, whatever the law; all rungs, after Bonferroni."""
        share = np.clip(ladder.value, 1e-300, 1.0)
        spread = np.sqrt(share * (1.0 - share) / self.samples + ladder.error**2)
        many = hits >= _MANY
        away = (abs(hits / self.samples - ladder.value) / spread)[many]
        return statistics.either_p(*(2.0 * scipy.stats.norm.sf(away)).tolist()) if many.any() else 1.0

    def _splits(self, tubes: Tubes, ladder: Estimate) -> dict[str, Any]:
        """By face, sign of eta, and tilt; all shares of the rungs of the law but for the sign of eta."""
        unit = self.deltas[self.tested, None]
        faces = laws.total(self._mean(tubes)[self.tested], 1.0 / (unit * unit.size), axis=0)
        both = laws.total(faces)
        error = math.hypot(*(faces.value[::-1] * faces.error)) / both.value**2
        plus = Estimate(faces.value[0] / both.value, error, both.dof)
        return {
            "face_plus": {**plus.described(), "predicted": self.constant.plus / self.constant.value},
            "eta_positive": self._signs(tubes, ladder),
            "tilt": self._by_tilt(tubes),
        }

    def _signs(self, tubes: Tubes, ladder: Estimate) -> list[dict[str, Any]]:
        """(P(eta > 0) - P(eta < 0)) / P, rung by rung, and how much P itself is off C delta."""
        asymmetry = laws.total(self._mean(tubes, signs=(-1.0, 1.0)), 1.0 / ladder.value[:, None])
        unit = self.constant.value * self.deltas
        off = Estimate(ladder.value / unit - 1.0, ladder.error / unit)
        return _rows(
            delta=self.deltas,
            asymmetry=asymmetry.value,
            asymmetry_interval_95=asymmetry.interval(),
            correction=off.value,
            correction_interval_95=off.interval(),
        )

    def _by_tilt(self, tubes: Tubes) -> dict[str, Any]:
        """theta_min / delta of the hits: uniform, if the density of theta_min is constant near 0.

        Rungs count alike, whatever their delta. A share is a ratio: its error is that of (1 in the bin) - share.
        """
        unit = self.deltas[self.tested, None, None, None]
        bins, own = ((tubes["tilt"][self.tested, :, :, i] / unit ** (i + 1)).sum(axis=(0, 1, 2)) for i in (0, 1))
        share = bins / bins.sum()
        variance = own * (1.0 - 2.0 * share) + share**2 * own.sum()
        error = np.sqrt(np.maximum(variance, 0.0)) / bins.sum()
        expected = 1.0 / SHAPE_BINS
        away = np.divide(share - expected, error, out=np.zeros_like(share), where=error > 0.0)
        statistic = float((away**2).sum()) * (1.0 - expected)
        return {
            "share": share.tolist(),
            "error": error.tolist(),
            "predicted": expected,
            "p_value": float(scipy.stats.chi2.sf(statistic, SHAPE_BINS - 1)),
        }

    def _convergence(self, tubes: Tubes) -> list[dict[str, Any]]:
        """C from the first 1, 2, 4 ... batches of every tube."""
        batches, tested, rows = tubes["draws"].shape[2], self.tested, []
        for count in [2**j for j in range(30) if 2**j < batches] + [batches]:
            some = {name: values[tested, :, :count] for name, values in tubes.items()}
            constant = laws.fit_constant(self.deltas[tested], laws.total(self._mean(some)))
            rows.append({"draws": int(some["draws"].sum()), **constant.described()})
        return rows


def _rows(**columns: Any) -> list[dict[str, Any]]:
    """One row of a table for each entry of its columns, ready for JSON."""
    lists = [column.tolist() if isinstance(column, np.ndarray) else column for column in columns.values()]
    return [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)]

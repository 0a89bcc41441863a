"""Scene measure-zero: is falling an event of probability zero, as codimension one says?

Plain draws count how many states come flatter than delta, and how many fall. Where they have no hits, draws
in tubes near F estimate P(theta_min < delta) with weights, rung by rung of a ladder of delta. The law is
P = C delta, C by an integral over F; it is fitted, tested, and compared with laws that it is not.
"""

from collections.abc import Iterator
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, said
from explorer.measure import laws, statistics
from explorer.measure.distributions import Distribution
from explorer.measure.falling_constant import FallingConstant, constant_of
from explorer.measure.importance_sampling import FEWEST, KERNELS, NearFallingSet, Rare
from explorer.measure.laws import Estimate, Law
from explorer.measure.sampling import Range, Stream, numbered_stream
from explorer.measure.tallies import Histogram
from explorer.measure.tubes import may_come
from explorer.motion.turning_points import smallest_tilt, tilt_kernels
from explorer.phase.arguments import read_range
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.results import Columns, count_status, stacked
from explorer.phase.states import COORDINATES, Array, States, phi_to_states
from explorer.scenes.options import Reader, option, whole_from
from explorer.scenes.scene import SAMPLES, Counts, Picture
from explorer.scenes.starts import FromDensity

_BATCH = 1 << 14  # draws near F of a chunk; the last of a rung and face may have fewer
_OF_LAW = 1 << 40  # the stream that tells where the law holds
# Rungs so far below where it is within 5 % are fitted and tested: the next term of the law is of order delta.
_WELL_BELOW = 0.01


def read_ladder(name: str, value: Any) -> Range:
    """Read the smallest and the largest delta. Raises InputError."""
    low, high = read_range(name, value)
    if not 1e-100 <= low < high <= 1.0:
        raise InputError(f"{said(name, value)} must be LOW:HIGH with 1e-100 <= LOW < HIGH <= 1 (tilts in rad)")
    return low, high


class ZeroCounts(Counts):
    """Falls of plain draws, and how many lie between neighbouring rungs, from the smallest on; last, below none.

    near: of each stratum of a chunk its rung, face and number, and the sums of `Weighted.sums`.
    """

    falls: int
    below: Histogram
    near: list[Any]


class MeasureZero(FromDensity):
    """How rarely does it nearly fall? P(theta_min < delta), for delta down to 1e-15 rad, and the law C delta.

    samples: plain draws; tube: draws per rung and face; ladder: smallest and largest delta (rad).
    """

    ladder: Range = option(
        Reader(read_ladder, "LOW:HIGH", "str | tuple[float, float]"),
        "range of tilts delta in rad, in steps of a decade from the largest",
        default=(1e-15, 1e-1),
    )
    # Enough plain draws to see a probability of 1e-6, were there one
    samples: int = option(*SAMPLES, default=4_000_000)
    tube: int = option(
        whole_from(2, 10**9), "number of random states close to F, for each delta and each face", default=1 << 18
    )

    tally = ZeroCounts
    observables = ("theta_min", "face", "could_fall")
    columns = (*COORDINATES, "sigma3_bar", "eta_hat", "energy", "face", "delta", "weight", "theta_min", "status")

    says = (
        "{samples:,} states drawn, {falls} fell: the probability of falling is below {upper_bound_95:.2e} (95 %)",
        "C: predicted {constant_predicted:.6f} +- {constant_predicted_error:.0e}",
        "C, measured: {constant[value]:.6f} (95 % interval {constant[interval_95][0]:.6f} to "
        "{constant[interval_95][1]:.6f})",
        "slope of P(theta_min < delta): {slope[value]:.6f} (95 % interval {slope[interval_95][0]:.6f} to "
        "{slope[interval_95][1]:.6f})",
        "p-value of the law {p_value[law]:.2g} (draws in tubes), {p_value_counts[law]:.2g} (plain counts); "
        "that both agree {p_value_counts_against_tubes:.2g}",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.source.why_not_near_f:
            raise InputError(f"box: {self.source.why_not_near_f}; give one of them a range")
        if self.source.reaches_flat():
            raise InputError(
                "box: reaches flat (phi = +-pi/2), where the density does not vanish, and the energy has no "
                "bound, so P is of order delta ln(1/delta) and no C exists; give energy LOW:HIGH, or keep phi away"
            )

    @cached_property
    def source(self) -> Distribution:
        return Distribution.invariant(self.disk, self.box, self.energy, self.density)

    @cached_property
    def deltas(self) -> Array:
        """The rungs, largest first, a decade apart."""
        low, high = self.ladder
        count = int(np.floor(np.log10(high / low) + 1e-9)) + 1
        return np.array([float(f"{high * 10.0**-k:.12g}") for k in range(count)])

    @cached_property
    def near_f(self) -> NearFallingSet:
        """Whose draws estimate P; two approaches to flat have the smallest tilt."""
        return NearFallingSet(self.source, 2, self.accuracy)

    @cached_property
    def constant(self) -> FallingConstant:
        """C by an integral over F. Raises InputError where the density is zero in all of the box."""
        return constant_of(self.source)

    @cached_property
    def share(self) -> float:
        """Of draws from the laws of the coordinates those that the density has."""
        return 1.0 if self.source.plain else self.constant.mass / self.source.volume

    @cached_property
    def law(self) -> Law | None:
        """The law as draws of its own tell it, the same for any seed."""
        return self.near_f.law(numbered_stream(0, _OF_LAW), _BATCH, self.share)

    @property
    def tested(self) -> NDArray[np.bool_]:
        """The rungs at which the law is fitted and tested."""
        return self.deltas <= (self.law.holds_below * _WELL_BELOW if self.law else 0.0)

    # Chunks: batches of each tube, by rung and face; and then plain draws, so that a longer run keeps all chunks
    # of a shorter one.

    @property
    def _batches(self) -> int:
        """How many a tube has."""
        return -(-self.tube // _BATCH)

    @property
    def _in_tubes(self) -> int:
        return 2 * self.deltas.size * self._batches

    @property
    def chunks(self) -> int:
        return self._in_tubes + super().chunks

    def length(self, index: int) -> int:
        if index >= self._in_tubes:
            return super().length(index - self._in_tubes)
        return min(_BATCH, self.tube - index % self._batches * _BATCH)

    def streams(self, index: int, before: int = 0) -> Iterator[tuple[Stream, int, range]]:
        if index >= self._in_tubes:
            return super().streams(index - self._in_tubes, self._in_tubes)
        count = self.length(index)  # of a batch, which has a stream of its own
        return iter([(numbered_stream(self.seed, index), count, range(count))])

    def chunk(self, index: int) -> tuple[Columns, ZeroCounts]:
        table, tally = self._plain(index) if index >= self._in_tubes else self._batch(index)
        tally.status += count_status(table["status"])
        return self.kept(table), tally

    def near(self, table: Columns) -> NDArray[np.bool_]:
        """Plain draws flatter than the first rung."""
        near: NDArray[np.bool_] = np.isnan(table["delta"]) & (table["theta_min"] < self.deltas[0])
        return near

    def _batch(self, index: int) -> tuple[Columns, ZeroCounts]:
        """Draws near F. sigma3 and sigma4 are NaN: doubles do not hold such a small eta_hat as a difference."""
        place, ((random, count, _),), tally = index // self._batches, self.streams(index), ZeroCounts()
        rung, face = place // 2, 1 if place % 2 == 0 else -1
        parts, tables = self.near_f.draw(face, float(self.deltas[rung]), random, count), list[Columns]()
        for number, part in enumerate(parts):
            tally.near += [[rung, face, number, *part.sums(float(self.deltas[rung]))]]
            none = np.full(part.status.size, np.nan)
            drawn = {"phi": part.states.phi, "phidot": part.states.phidot, "sigma3": none, "sigma4": none}
            on_plus, weight = np.full(none.size, face > 0), part.weight / self.share
            tables.append(self._table(part.states, drawn, on_plus, self.deltas[rung], weight, *part[2:]))
        return stacked(tables), tally

    def _plain(self, index: int) -> tuple[Columns, ZeroCounts]:
        """Draws from the density."""
        table, tally = stacked([*map(self.observe, self.blocks(index))]), ZeroCounts()
        tally.status["not followed"] += self.length(index) - table["status"].size
        tally.falls += int((table["status"] == compiled.status.Status.FALLS).sum())
        place = np.searchsorted(self.deltas[::-1], table["theta_min"], "right")
        tally.below = Histogram(np.bincount(place, minlength=self.deltas.size + 1))
        return table, tally

    def observe(self, drawn: Columns) -> Columns:
        """Those draws that could come flatter than the first rung; theta_min is 0 for those that fall."""
        states = phi_to_states(self.disk, **drawn)
        rows = np.flatnonzero(may_come(states, self.deltas[0]))
        states, drawn = states.at(rows), {name: values[rows] for name, values in drawn.items()}
        theta, status, _ = smallest_tilt(states, self.plan)
        theta = np.where(status == compiled.status.Status.FALLS, 0.0, theta)
        on_plus = np.asarray(states.motion.nearer_plus)
        return self._table(states, drawn, on_plus, np.nan, np.ones(rows.size), theta, status)

    def _table(
        self,
        states: States,
        drawn: Columns,
        on_plus: NDArray[np.bool_],
        delta: float,
        weight: Array,
        theta_min: Array,
        status: NDArray[np.int8],
    ) -> Columns:
        """All columns of draws, near F or plain."""
        motion, disk = states.motion, self.disk
        return {
            **drawn,
            "sigma3_bar": motion.sigma3_bar * disk.rate_unit,
            "eta_hat": eta_to_eta_hat(disk.body, motion.eta(on_plus)) * disk.rate_unit,
            "energy": motion.energy * disk.energy_unit,
            "face": np.where(on_plus, 1, -1).astype(np.int8),
            "delta": np.full(weight.size, delta),
            "weight": weight,
            "theta_min": theta_min,
            "status": status.astype(np.int8),
        }

    @property
    def kernels(self) -> tuple[str, ...]:
        of_f = "falling.critical_X2_batch", "falling.barrier_batch"
        return *of_f, *KERNELS, *tilt_kernels(self.plan)

    def summarise(self, tally: ZeroCounts) -> dict[str, Any]:
        hits, constant = np.cumsum(tally.below.counts[:-1])[::-1], self.constant
        rungs = self._rungs(tally)
        ladder = Estimate(*np.array([[*vars(rung.estimate).values()] for rung in rungs]).T)
        summary = {
            **super().summarise(tally),
            "samples": self.samples,
            "falls": tally.falls,
            "upper_bound_95": statistics.upper_bound(tally.falls, self.samples),
            "constant_predicted": constant.value,
            "constant_predicted_error": constant.error,
            "ladder": self._ladder(rungs, ladder, hits),
            "slope": None,
            "constant": None,
        }
        enough = all(rung.effective >= FEWEST for rung in rungs)
        if not (self.law and constant.value > 0.0 and enough and np.count_nonzero(self.tested) > 1):
            return summary
        delta, tested, counts = self.deltas[self.tested], ladder[self.tested], hits[self.tested]
        known = laws.known_laws(constant.value, float(delta[0]))
        error = constant.error / constant.value
        tubes = {name: laws.ladder_p(delta, tested, law, error) for name, law in known.items()}
        plain = {name: laws.counts_p(delta, counts, self.samples, law) for name, law in known.items()}
        return summary | {
            "slope": laws.fit_slope(delta, tested).described(),
            "constant": laws.fit_constant(delta, tested).described(),
            "law_limit": self.law.holds_below * _WELL_BELOW,
            # Tubes hold what is near F. Falls anywhere else are for plain draws to find.
            "p_value": tubes | {"plateau": plain["plateau"]},
            "p_value_tubes": tubes,
            "p_value_counts": plain,
            "p_value_counts_against_tubes": laws.agreement_p(ladder, hits, self.samples),
        }

    def _rungs(self, tally: ZeroCounts) -> list[Rare]:
        """What the draws near F say, rung by rung."""
        sums = [dict[tuple[int, int], Array]() for _ in self.deltas]
        for rung, face, number, *counted in tally.near:
            sums[rung][face, number] = sums[rung].get((face, number), 0.0) + np.array(counted)
        return [Rare.of(np.array([*strata.values()]), self.share) for strata in sums]

    def _ladder(self, rungs: list[Rare], ladder: Estimate, hits: NDArray[np.int64]) -> list[dict[str, Any]]:
        """Counts of plain draws with exact intervals, and estimates from draws near F."""
        # A draw whose tilt is not known may be a hit or not.
        wider = np.array([[0.0, rung.unknown] for rung in rungs])
        alone, together = (
            np.maximum(ladder.interval(sure), 0.0) + wider
            for sure in (laws.CONFIDENCE, laws.simultaneous(self.deltas.size))
        )
        return [
            {
                "delta": float(delta),
                "count": int(hits[i]),
                "plain": statistics.share(int(hits[i]), self.samples),
                "estimate": float(ladder.value[i]),
                "error": float(ladder.error[i]),
                "interval_95": alone[i].tolist(),
                "interval_95_simultaneous": together[i].tolist(),
                "effective_sample_size": rungs[i].effective,
                "unresolved": rungs[i].unknown,
                "predicted": float(self.constant.value * delta),
            }
            for i, delta in enumerate(self.deltas)
        ]

    def figures(self, summary: dict[str, Any], tally: ZeroCounts) -> Iterator[tuple[str, Picture]]:
        from explorer.pictures import measure_zero

        yield "ladder", partial(measure_zero.probability, summary)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = super().headline(summary)
        if summary["constant_predicted"] == 0.0:
            return [*lines, "The box misses the falling set: C = 0, and there is no law to test."]
        if summary["constant"]:
            return lines
        fewest = min(row["effective_sample_size"] for row in summary["ladder"])
        if fewest < FEWEST:
            size = f"at one delta the effective sample size is {fewest:.0f}, below {FEWEST}"
            return [*lines, f"C was not estimated: {size}. Raise tube, or narrow box to where the density is."]
        where = f"at or below {self.law.holds_below * _WELL_BELOW:.0e}" if self.law else "below 1e-12"
        return [
            *lines,
            f"C was not estimated: the law holds {where}. Give ladder two deltas there by a smaller LOW.",
        ]

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
from explorer.measure import invariance
from explorer.measure.density import Density
from explorer.measure.falling_probability import FEWEST_HITS, FallingProbability
from explorer.measure.sampling import Range, Stream, numbered_stream
from explorer.measure.tallies import Histogram, count_status
from explorer.measure.tubes import widest_eta
from explorer.motion.turning_points import smallest_tilt, tilt_kernels
from explorer.phase.arguments import read_range
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.states import COORDINATES, Array, phi_to_states
from explorer.scenes.options import Reader, option, whole_from
from explorer.scenes.scene import SAMPLES, Counts, Picture, Table, joined
from explorer.scenes.starts import FromDensity

_BATCH = 1 << 14  # draws per batch of a tube; the last may have fewer


def read_ladder(name: str, value: Any) -> Range:
    """Read the smallest and the largest delta. Raises InputError."""
    low, high = read_range(name, value)
    if not 1e-100 <= low < high <= 1.0:
        raise InputError(f"{said(name, value)} must be LOW:HIGH with 1e-100 <= LOW < HIGH <= 1 (tilts in rad)")
    return low, high


class ZeroCounts(Counts):
    """below and batches: as FallingProbability.summary takes them."""

    falls: int
    below: Histogram
    batches: list[Any]


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
        if not {"sigma3", "sigma4"} & set(self.box.free):
            raise InputError(
                "box: sigma3 and sigma4 are both fixed, so the falling set is met at isolated tilts or not at "
                "all; give one of them a range"
            )
        if self.source.reaches_flat():
            raise InputError(
                "box: reaches flat (phi = +-pi/2), where the density does not vanish, and the energy has no "
                "bound, so P is of order delta ln(1/delta) and no C exists; give energy LOW:HIGH, or keep phi away"
            )
        if np.count_nonzero(self.probability.tested) < 2:
            low, high = self.ladder
            raise InputError(
                f"ladder {low:g}:{high:g}: needs two values of delta at or below "
                f"{self.probability.law_limit:.1e}, where the law holds for this box and disk; give a smaller LOW"
            )

    @cached_property
    def source(self) -> Density:
        return Density.of(self.disk, self.box, self.energy, self.gaussian, self.density)

    @cached_property
    def deltas(self) -> Array:
        """The rungs, largest first, a decade apart."""
        low, high = self.ladder
        count = int(np.floor(np.log10(high / low) + 1e-9)) + 1
        return np.array([float(f"{high * 10.0**-k:.12g}") for k in range(count)])

    @cached_property
    def probability(self) -> FallingProbability:
        """What is asked, and what becomes of the counts."""
        return FallingProbability(self.disk, self.source, self.deltas, self.accuracy, self.samples, self.seed)

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

    def draw(self, random: Stream, count: int) -> Table:
        return self.source.draw(self.disk, random, count)

    def chunk(self, index: int) -> tuple[Table, ZeroCounts]:
        table, tally = self._plain(index) if index >= self._in_tubes else self._batch(index)
        tally.status += count_status(table["status"])
        return self.kept(table), tally

    def near(self, table: Table) -> NDArray[np.bool_]:
        """Plain draws flatter than the first rung."""
        near: NDArray[np.bool_] = np.isnan(table["delta"]) & (table["theta_min"] < self.deltas[0])
        return near

    def _batch(self, index: int) -> tuple[Table, ZeroCounts]:
        """Draws in a tube. sigma3 and sigma4 are NaN: doubles do not hold such a small eta_hat as a difference."""
        tube, ((random, count, _),), tally = index // self._batches, self.streams(index), ZeroCounts()
        rung, face = tube // 2, 1 if tube % 2 == 0 else -1
        draws = self.probability.draw(face, float(self.deltas[rung]), random, count)
        tally.batches += [self.probability.batch(rung, face, draws)]
        table = {
            **vars(draws),
            **dict.fromkeys(("sigma3", "sigma4"), np.full(count, np.nan)),
            "face": np.full(count, face, np.int8),
            "delta": np.full(count, self.deltas[rung]),
        }
        return {name: table[name] for name in self.columns}, tally

    def _plain(self, index: int) -> tuple[Table, ZeroCounts]:
        """Draws from the density."""
        table, tally = joined([*map(self.observe, self.blocks(index))]), ZeroCounts()
        tally.status["not followed"] += self.length(index) - table["status"].size
        tally.falls += int((table["status"] == compiled.status.Status.FALLS).sum())
        tally.below = Histogram(self.probability.below(table["theta_min"]))
        return table, tally

    def observe(self, drawn: Table) -> Table:
        """Those draws that could come flatter than the first rung; theta_min is 0 for those that fall."""
        disk = self.disk
        states = phi_to_states(disk, **drawn)
        motion = states.motion
        distance = abs(eta_to_eta_hat(disk.body, motion.eta(motion.nearer_plus)))
        rows = np.flatnonzero(distance <= widest_eta(motion.energy, self.deltas[0], disk))
        states = states.at(rows)
        known = states.motion
        plus = known.nearer_plus
        theta, status, _ = smallest_tilt(states, self.plan)
        return {
            **{name: values[rows] for name, values in drawn.items()},
            "sigma3_bar": known.sigma3_bar * disk.rate_unit,
            "eta_hat": eta_to_eta_hat(disk.body, known.eta(plus)) * disk.rate_unit,
            "energy": known.energy * disk.energy_unit,
            "face": np.where(plus, 1, -1).astype(np.int8),
            "delta": np.full(plus.size, np.nan),
            "weight": np.ones(plus.size),
            "theta_min": np.where(status == compiled.status.Status.FALLS, 0.0, theta),
            "status": status.astype(np.int8),
        }

    @property
    def kernels(self) -> tuple[str, ...]:
        of_f = "falling.critical_X2_batch", "falling.barrier_batch", "falling.line_chart_batch"
        return "algebra.constants_batch", *of_f, *tilt_kernels(self.plan), *invariance.kernels()

    def summarise(self, tally: ZeroCounts) -> dict[str, Any]:
        found = self.probability.summary(tally.below.counts, tally.falls, tally.batches)
        return {**found, "status": dict(tally.status)}

    def figures(self, summary: dict[str, Any], tally: ZeroCounts) -> Iterator[tuple[str, Picture]]:
        from explorer.pictures import measure_zero

        yield "ladder", partial(measure_zero.probability, summary)
        if summary["constant"]:
            yield "convergence", partial(measure_zero.constant_convergence, summary)
            yield "tilt", partial(measure_zero.tilt_density, summary)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = super().headline(summary)
        if summary["constant_predicted"] == 0.0:
            return [*lines, "The box misses the falling set: C = 0, and there is no law to test."]
        if not summary["constant"]:
            fewest = min(row["effective_sample_size"] for row in summary["ladder"])
            size = f"at one delta the effective sample size is {fewest:.0f}, below {FEWEST_HITS}"
            return [*lines, f"C was not estimated: {size}. Raise tube, or narrow box to where the density is."]
        return lines

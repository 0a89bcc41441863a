"""Scene race-angles: by how much the contact point races round the rim beside F.

The race angle of a passage is the increase of chi from vertical to vertical less the increase
along the limit motion on F with the same sigma3_bar and energy (its fall angle). Its limit is
sgn(eta) kappa pi, whatever the initial state (Prop. 2).
"""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import RunError
from explorer.measure import statistics
from explorer.measure.log_counts import LogCounts, SignedLogCounts, count_cells, merged
from explorer.measure.sampling import Box, Range, chunk_stream, log_uniform
from explorer.motion.passages import passages
from explorer.phase.disk import require_axial_inertia
from explorer.phase.states import Array
from explorer.scenes.base import Chunks, SampledScene, Table, Tally
from explorer.scenes.beside import check_eta_hat, default_box, draw_beside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Bins of the histogram between -1.5 and 1.5 kappa pi: 0 and +-kappa pi are middles of bins, also
# where a picture joins five of them.
BINS = 585
REACH = 1.5


@dataclass(frozen=True)
class RaceAngles(SampledScene):
    """Race angles of passages with |eta_hat| log-uniform in a range, both signs, both sides."""

    box: Box | None = None
    eta_hat: Range | None = None

    name: ClassVar[str] = "race-angles"
    observables: ClassVar[tuple[str, ...]] = ("race_angle", "theta_min", "duration")
    bytes_per_sample: ClassVar[int] = 1000

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        check_eta_hat(self.span, self.disk)

    @property
    def where(self) -> Box:
        return self.box or default_box(self.disk)

    @property
    def span(self) -> Range:
        """|eta_hat| in the units of the disk; 1e-6 to 1e-2 natural units unless given."""
        unit = self.disk.rate_unit
        return self.eta_hat or (1e-6 * unit, 1e-2 * unit)

    def options(self) -> dict[str, Any]:
        box = {name: span for name, span in self.where.describe().items() if name in ("phidot", "sigma3")}
        return {**self.common_options(), "box": box, "eta_hat": list(self.span)}

    def compute(self, index: int) -> Table:
        disk, count = self.disk, self.length(index)
        random = chunk_stream(self.seed, index)
        start = draw_beside(self.where, random, count)
        eta_hat = log_uniform(random.random(count), *self.span)
        eta_hat *= np.where(random.random(count) < 0.5, 1.0, -1.0)
        found = passages(
            disk,
            start.sigma3_bar,
            eta_hat,
            start.speed,
            start.face,
            method=self.method,
            accuracy=self.accuracy,
        )
        return {
            "phidot": start.phidot,
            "sigma3_bar": start.sigma3_bar,
            "eta_hat": eta_hat,
            "face": start.face.astype(np.int8),
            "energy": found.energy,
            "race_angle": found.race_angle,
            "wrong_way": found.wrong_way,
            "delta_chi": found.delta_chi,
            "fall_angle": found.fall_angle,
            "impact_speed": found.impact_speed,
            "theta_min": found.theta_min,
            "duration": found.duration,
            "error_estimate": found.error_estimate,
            "status": found.status,
        }

    def tally(self, table: Table) -> Tally:
        race, eta_hat = table["race_angle"], table["eta_hat"]
        deviation = race - np.sign(eta_hat) * self.disk.race_limit
        decade = np.floor(np.log10(abs(eta_hat)) + 1e-12).astype(int)
        return {
            **super().tally(table),
            "wrong_way": int(table["wrong_way"].sum()),
            "plus": self._one_sign(race, deviation, eta_hat > 0.0),
            "minus": self._one_sign(race, deviation, eta_hat < 0.0),
            "decades": {
                str(exponent): LogCounts.of(abs(deviation[decade == exponent])).state()
                for exponent in sorted(set(decade.tolist()))
            },
            "cells": count_cells(abs(eta_hat), abs(deviation)),
            "impact_speed": LogCounts.of(table["impact_speed"]).state(),
            "energy": LogCounts.of(table["energy"]).state(),
            "error_estimate": LogCounts.of(table["error_estimate"]).state(),
        }

    def _edges(self) -> Array:
        limit = self.disk.race_limit
        return np.linspace(-REACH * limit, REACH * limit, BINS + 1)

    def _one_sign(self, race: Array, deviation: Array, chosen: NDArray[np.bool_]) -> dict[str, Any]:
        good = chosen & np.isfinite(race)
        values, edges = race[good], self._edges()
        counts = np.histogram(values, edges)[0]
        filled = np.flatnonzero(counts)
        return {
            "bins": filled.tolist(),
            "counts": counts[filled].tolist(),
            "outside": int((abs(values) > edges[-1]).sum()),
            "deviation": SignedLogCounts.of(deviation[good]).state(),
            "sum": math.fsum(deviation[good].tolist()),
        }

    def summarise(self, chunks: Chunks) -> dict[str, Any]:
        limit, edges = self.disk.race_limit, self._edges()
        status = statistics.add_counts(tally["status"] for tally in chunks.tallies())
        summary: dict[str, Any] = {
            "samples": self.samples,
            "limit": limit,
            "wrong_way": sum(tally["wrong_way"] for tally in chunks.tallies()),
            "failures": {name: count for name, count in status.items() if name != "ok"},
            "status": status,
        }
        histogram: dict[str, Any] = {"edges": edges.tolist()}
        for sign, name in ((1.0, "plus"), (-1.0, "minus")):
            counts, deviation = np.zeros(BINS, np.int64), SignedLogCounts()
            for tally in chunks.tallies():
                counts[np.array(tally[name]["bins"], np.int64)] += np.array(tally[name]["counts"], np.int64)
                deviation.add(SignedLogCounts(tally[name]["deviation"]))
            histogram[f"counts_{name}"] = counts.tolist()
            histogram[f"outside_{name}"] = sum(tally[name]["outside"] for tally in chunks.tallies())
            if deviation.total:
                mean = math.fsum(tally[name]["sum"] for tally in chunks.tallies()) / deviation.total
                summary[f"median_{name}"] = sign * limit + deviation.quantile(0.5)
                summary[f"mean_{name}"] = sign * limit + mean
                summary[f"width_{name}"] = deviation.half_width()
        if not any(f"median_{name}" in summary for name in ("plus", "minus")):
            raise RunError(
                f"race-angles: none of {self.samples} passages was resolved ({status}); "
                "raise --eta-hat or change --accuracy"
            )
        energy = merged(chunks, "energy")
        summary["histogram"] = histogram
        summary["by_decade"] = self._by_decade(chunks)
        summary["energy_range"] = [energy.smallest, energy.largest]
        summary["largest_error_estimate"] = merged(chunks, "error_estimate").largest
        return summary

    def _by_decade(self, chunks: Chunks) -> list[dict[str, Any]]:
        """How the deviation from the limit shrinks with |eta_hat|."""
        decades: dict[int, LogCounts] = {}
        for tally in chunks.tallies():
            for exponent, state in tally["decades"].items():
                decades.setdefault(int(exponent), LogCounts()).add(LogCounts(state))
        return [
            {
                "eta_hat_from": 10.0**exponent,
                "passages": deviation.total,
                "median_deviation": deviation.quantile(0.5),
                "largest_deviation": deviation.largest,
            }
            for exponent, deviation in sorted(decades.items())
            if deviation.total
        ]

    def figures(self, summary: dict[str, Any], chunks: Chunks) -> "Iterator[tuple[str, Figure]]":
        from explorer import plot

        yield "histogram", plot.figure_of(plot.race_histogram, summary)
        cells: Counter[tuple[int, int]] = Counter()
        for tally in chunks.tallies():
            cells.update({(i, j): count for i, j, count in tally["cells"]})
        speed = merged(chunks, "impact_speed").quantile(0.5)
        yield "deviation", plot.figure_of(plot.race_deviation, self.disk, cells, speed)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        means = ", ".join(
            f"mean {summary[f'mean_{name}']:+.4f}, median {summary[f'median_{name}']:+.6f} ({label})"
            for name, label in (("plus", "eta > 0"), ("minus", "eta < 0"))
            if f"mean_{name}" in summary
        )
        failed = ", ".join(f"{count:,} {name}" for name, count in summary["failures"].items()) or "none"
        return [
            f"{summary['samples']:,} passages of the {self.disk.name} disk; "
            f"limit +-kappa pi = {summary['limit']:.6f} rad",
            f"race angle: {means}",
            f"wrong way: {summary['wrong_way']}; failures: {failed}",
        ]

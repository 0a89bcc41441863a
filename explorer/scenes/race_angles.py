"""Scene race-angles: by how much the contact point races round the rim beside F.

The race angle of a passage is the increase of chi from vertical to vertical less the increase
along the limit motion on F with the same sigma3_bar and energy (its fall angle). Its limit is
sgn(eta) kappa pi, whatever the initial state (Prop. 2).
"""

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import RunError
from explorer.measure import statistics
from explorer.measure.log_counts import LogCounts, SignedLogCounts, count_cells
from explorer.measure.sampling import Box, Range, chunk_stream, log_uniform
from explorer.motion.passages import passages
from explorer.phase.disk import require_axial_inertia
from explorer.phase.states import Array
from explorer.scenes.base import Chunks, SampledScene, Table, Tally
from explorer.scenes.beside import BOX, box_beside, check_eta_hat, describe_beside, draw_beside, eta_hat_option
from explorer.scenes.options import Distances, Ranges

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Bins of the histogram between -1.5 and 1.5 kappa pi: 0 and +-kappa pi are middles of bins, also
# where a picture joins five of them.
BINS = 585
REACH = 1.5
_SIGNS = {"plus": 1.0, "minus": -1.0}
# What is stored of a passage, as fields of `Passages`.
_FOUND = (
    "energy",
    "race_angle",
    "wrong_way",
    "delta_chi",
    "fall_angle",
    "impact_speed",
    "theta_min",
    "duration",
    "error_estimate",
    "status",
)


@dataclass
class OneSign:
    """Race angles of one sign of eta, counted: a histogram, and deviations from the limit."""

    bins: NDArray[np.int64] = field(default_factory=lambda: np.zeros(BINS, np.int64))
    outside: int = 0
    deviation: SignedLogCounts = field(default_factory=SignedLogCounts)
    sums: list[float] = field(default_factory=list)  # of the deviations, one a chunk

    def add(self, tally: Tally) -> None:
        self.bins[np.array(tally["bins"], np.int64)] += np.array(tally["counts"], np.int64)
        self.outside += tally["outside"]
        self.deviation.add(SignedLogCounts(tally["deviation"]))
        self.sums.append(tally["sum"])


@dataclass
class RaceCounts:
    """The tallies of all chunks, added up."""

    status: dict[str, int] = field(default_factory=dict)
    wrong_way: int = 0
    signs: dict[str, OneSign] = field(default_factory=lambda: {name: OneSign() for name in _SIGNS})
    decades: dict[int, LogCounts] = field(default_factory=dict)
    cells: Counter[tuple[int, int]] = field(default_factory=Counter)
    impact_speed: LogCounts = field(default_factory=LogCounts)
    energy: LogCounts = field(default_factory=LogCounts)
    error_estimate: LogCounts = field(default_factory=LogCounts)

    def add(self, tally: Tally) -> None:
        self.status = statistics.add_counts([self.status, tally["status"]])
        self.wrong_way += tally["wrong_way"]
        for name, sign in self.signs.items():
            sign.add(tally[name])
        for exponent, state in tally["decades"].items():
            self.decades.setdefault(int(exponent), LogCounts()).add(LogCounts(state))
        self.cells.update({(i, j): count for i, j, count in tally["cells"]})
        for name in ("impact_speed", "energy", "error_estimate"):
            getattr(self, name).add(LogCounts(tally[name]))


@dataclass(frozen=True, kw_only=True)
class RaceAngles(SampledScene):
    """How far does the contact point race? Angles of passages beside the falling set, on both sides."""

    box: Box
    eta_hat: Range

    name: ClassVar[str] = "race-angles"
    observables: ClassVar[tuple[str, ...]] = ("race_angle", "theta_min", "duration")
    columns: ClassVar[tuple[str, ...]] = ("phidot", "sigma3_bar", "eta_hat", "face", *_FOUND)
    bytes_per_sample: ClassVar[int] = 1000

    class Keywords(SampledScene.Keywords, total=False):
        box: Annotated[Ranges, BOX]
        eta_hat: Annotated[Distances, eta_hat_option("1e-6:1e-2")]

    def __post_init__(self) -> None:
        super().__post_init__()
        require_axial_inertia(self.disk)
        check_eta_hat(self.eta_hat, self.disk)

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        disk = given.get("disks", cls.disks)[0]
        box = box_beside(disk, given.get("box", {}))
        return {"eta_hat": (1e-6 * disk.rate_unit, 1e-2 * disk.rate_unit), **given, "box": box}

    def options(self) -> dict[str, Any]:
        return {**super().options(), "box": describe_beside(self.box)}

    def compute(self, index: int) -> Table:
        count, random = self.length(index), chunk_stream(self.seed, index)
        start = draw_beside(self.box, random, count)
        eta_hat = log_uniform(random.random(count), *self.eta_hat)
        eta_hat *= np.where(random.random(count) < 0.5, 1.0, -1.0)
        made = passages(
            self.disk,
            start.sigma3_bar,
            eta_hat,
            start.speed,
            start.face,
            method=self.method,
            accuracy=self.accuracy,
        )
        drawn = {"phidot": start.phidot, "sigma3_bar": start.sigma3_bar, "eta_hat": eta_hat}
        return {**drawn, "face": start.face.astype(np.int8), **{name: getattr(made, name) for name in _FOUND}}

    def tally(self, index: int, table: Table) -> Tally:
        race, eta_hat = table["race_angle"], table["eta_hat"]
        deviation = race - np.sign(eta_hat) * self.disk.race_limit
        decade = np.floor(np.log10(abs(eta_hat)) + 1e-12).astype(int)
        return {
            **super().tally(index, table),
            "wrong_way": int(table["wrong_way"].sum()),
            **{name: self._one_sign(race, deviation, sign * eta_hat > 0.0) for name, sign in _SIGNS.items()},
            "decades": {
                str(exponent): LogCounts.of(abs(deviation[decade == exponent])).state()
                for exponent in sorted(set(decade.tolist()))
            },
            "cells": count_cells(abs(eta_hat), abs(deviation)),
            **{name: LogCounts.of(table[name]).state() for name in ("impact_speed", "energy", "error_estimate")},
        }

    def _edges(self) -> Array:
        limit = self.disk.race_limit
        return np.linspace(-REACH * limit, REACH * limit, BINS + 1)

    def _one_sign(self, race: Array, deviation: Array, chosen: NDArray[np.bool_]) -> Tally:
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

    def add_up(self, chunks: Chunks) -> RaceCounts:
        total = RaceCounts()
        for tally in chunks.tallies:
            total.add(tally)
        return total

    def summarise(self, total: RaceCounts) -> dict[str, Any]:
        limit = self.disk.race_limit
        if not any(sign.deviation.total for sign in total.signs.values()):
            raise RunError(
                f"race-angles: none of {self.samples} passages was resolved ({total.status}); "
                "raise --eta-hat or change --accuracy"
            )
        summary: dict[str, Any] = {
            "samples": self.samples,
            "limit": limit,
            "wrong_way": total.wrong_way,
            "failures": {name: count for name, count in total.status.items() if name != "ok"},
            "status": total.status,
        }
        histogram: dict[str, Any] = {"edges": self._edges().tolist()}
        for name, sign in total.signs.items():
            histogram[f"counts_{name}"], histogram[f"outside_{name}"] = sign.bins.tolist(), sign.outside
            if sign.deviation.total:
                mean = math.fsum(sign.sums) / sign.deviation.total
                summary[f"median_{name}"] = _SIGNS[name] * limit + sign.deviation.quantile(0.5)
                summary[f"mean_{name}"] = _SIGNS[name] * limit + mean
                summary[f"width_{name}"] = sign.deviation.half_width()
        return {
            **summary,
            "histogram": histogram,
            "by_decade": _by_decade(total.decades),
            "energy_range": [total.energy.smallest, total.energy.largest],
            "largest_error_estimate": total.error_estimate.largest,
        }

    def figures(self, summary: dict[str, Any], total: RaceCounts) -> "Iterator[tuple[str, Figure]]":
        from explorer import plot

        yield "histogram", plot.figure_of(plot.race_histogram, summary)
        speed = total.impact_speed.quantile(0.5)
        yield "deviation", plot.figure_of(plot.race_deviation, self.disk, total.cells, speed)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        means = "; ".join(
            f"{label}: mean {summary[f'mean_{name}']:+.4f}, median {summary[f'median_{name}']:+.6f}"
            for name, label in (("plus", "eta > 0"), ("minus", "eta < 0"))
            if f"mean_{name}" in summary
        )
        failed = ", ".join(f"{count:,} {name}" for name, count in summary["failures"].items()) or "none"
        return [
            f"{summary['samples']:,} passages of the {self.disk.name} disk; "
            f"the limit +-kappa pi is {summary['limit']:.6f} rad",
            f"race angle (rad), {means}",
            f"wrong way: {summary['wrong_way']}; failures: {failed}",
        ]


def _by_decade(decades: dict[int, LogCounts]) -> list[dict[str, Any]]:
    """How the deviation from the limit shrinks with |eta_hat|."""
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

"""Scene race-angles: by how much the contact point races round the rim beside F.

The race angle of a passage is the increase of chi from vertical to vertical less the increase
along the limit motion on F with the same sigma3_bar and energy (its drift). Its limit is
sgn(eta) kappa pi, whatever the initial state (Prop. 2).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from explorer import statistics
from explorer.errors import RunError
from explorer.passage import passages
from explorer.sampling import Box, Range, chunk_stream, log_uniform
from explorer.scenes.base import SampledScene, Table, Tables, column
from explorer.scenes.beside import check_eta_hat, default_box, draw_beside
from explorer.states import Array, require_axial_inertia

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
        disk, count = self.disk, self.chunk_length(index)
        random = chunk_stream(self.seed, index)
        start = draw_beside(self.where, random, count)
        eta_hat = log_uniform(random.random(count), *self.span)
        eta_hat *= np.where(random.random(count) < 0.5, 1.0, -1.0)
        found = passages(
            disk,
            start.sigma3_bar,
            eta_hat,
            start.speed,
            start.side,
            method=self.method,
            accuracy=self.accuracy,
        )
        return {
            "phidot": start.phidot,
            "sigma3_bar": start.sigma3_bar,
            "eta_hat": eta_hat,
            "side": start.side.astype(np.int8),
            "energy": found.energy,
            "race_angle": found.race_angle,
            "wrong_way": found.wrong_way,
            "delta_chi": found.delta_chi,
            "drift": found.drift,
            "impact_speed": found.impact_speed,
            "theta_min": found.theta_min,
            "duration": found.duration,
            "error_estimate": found.error_estimate,
            "status": found.status,
        }

    def summarise(self, tables: Tables) -> dict[str, Any]:
        race, eta_hat = column(tables, "race_angle"), column(tables, "eta_hat")
        limit = self.disk.race_limit
        status = statistics.count_status(table["status"] for table in tables())
        if not np.isfinite(race).any():
            raise RunError(
                f"race-angles: none of {race.size} passages was resolved ({status}); "
                "raise --eta-hat or change --accuracy"
            )
        edges = np.linspace(-REACH * limit, REACH * limit, BINS + 1)
        summary: dict[str, Any] = {
            "samples": self.samples,
            "limit": limit,
            "wrong_way": int(column(tables, "wrong_way").sum()),
            "failures": {name: count for name, count in status.items() if name != "ok"},
            "status": status,
        }
        histogram: dict[str, Any] = {"edges": edges.tolist()}
        for sign, name in ((1.0, "plus"), (-1.0, "minus")):
            values = race[(np.sign(eta_hat) == sign) & np.isfinite(race)]
            histogram[f"counts_{name}"] = np.histogram(values, edges)[0].tolist()
            histogram[f"outside_{name}"] = int((abs(values) > edges[-1]).sum())
            if values.size:
                summary[f"median_{name}"] = float(np.median(values))
                summary[f"mean_{name}"] = float(np.mean(values))
                summary[f"width_{name}"] = statistics.half_width(values)
        summary["histogram"] = histogram
        summary["by_decade"] = self._by_decade(race, eta_hat)
        energy = column(tables, "energy")
        summary["energy_range"] = [float(np.nanmin(energy)), float(np.nanmax(energy))]
        summary["largest_error_estimate"] = float(np.nanmax(column(tables, "error_estimate")))
        return summary

    def _by_decade(self, race: Array, eta_hat: Array) -> list[dict[str, Any]]:
        """How the deviation from the limit shrinks with |eta_hat|."""
        deviation = abs(race - np.sign(eta_hat) * self.disk.race_limit)
        decade = np.floor(np.log10(abs(eta_hat)) + 1e-12).astype(int)
        rows = []
        for exponent in sorted(set(decade.tolist())):
            inside = deviation[(decade == exponent) & np.isfinite(deviation)]
            if inside.size:
                rows.append(
                    {
                        "eta_hat_from": 10.0**exponent,
                        "passages": int(inside.size),
                        "median_deviation": float(np.median(inside)),
                        "largest_deviation": float(inside.max()),
                    }
                )
        return rows

    def figures(self, summary: dict[str, Any], tables: Tables) -> "Iterator[tuple[str, Figure]]":
        from explorer import plot

        yield "histogram", plot.figure_of(plot.race_histogram, summary)
        yield (
            "deviation",
            plot.figure_of(
                plot.race_deviation,
                self.disk,
                column(tables, "eta_hat"),
                column(tables, "race_angle"),
                float(np.nanmedian(column(tables, "impact_speed"))),
            ),
        )

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

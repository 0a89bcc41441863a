"""Scene falling-set: where in the phase space the disk would fall.

theta_min is the smaller tilt at the two turning points of a motion. The slices are integrated,
whatever gives the samples' theta_min, and the exact set drawn over them comes from the constants of
motion alone. The two never meet before the picture, so the valley of the one lying on the curves of
the other is a test that a person can see.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled, models, statistics
from explorer.disk import Disk
from explorer.errors import InputError
from explorer.falling import falls_of
from explorer.motions import smallest_tilt
from explorer.sampling import Box, Range, chunk_stream, draw_states, parse_ranges
from explorer.scenes.base import SampledScene, Table, Tables, column
from explorer.states import (
    COORDINATES,
    Array,
    constants_of,
    line_slope,
    natural_constants,
    phi_to_states,
    require_axial_inertia,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Cells of the map of all samples over the plane of constants of motion.
MAP_CELLS = 160
SLICE_ACCURACY = 1e-3  # of theta_min in a picture


@dataclass(frozen=True)
class Slice:
    """A two-dimensional slice of the phase space: two coordinates with a range, two fixed."""

    ranges: tuple[tuple[str, Range], ...]

    @classmethod
    def parse(cls, text: str) -> "Slice":
        """From "sigma3=-2:2,sigma4=-2:2,phi=0,phidot=1". Raises InputError."""
        ranges = parse_ranges(text, "--slice")
        free = [name for name, (low, high) in ranges.items() if low < high]
        if len(free) != 2 or set(ranges) != set(COORDINATES):
            raise InputError(
                f"--slice {text!r}: give all of {', '.join(COORDINATES)}, two as LOW:HIGH and two as numbers"
            )
        Box(**ranges)  # the same bounds hold
        return cls(tuple(sorted(ranges.items(), key=lambda item: COORDINATES.index(item[0]))))

    @classmethod
    def defaults(cls, disk: Disk) -> tuple["Slice", ...]:
        """At the vertical, where F is a pair of lines, and a curved one with an edge of could-fall."""
        unit = disk.rate_unit
        two = 2.0 * unit
        return (
            cls((("phi", (0.0, 0.0)), ("phidot", (unit, unit)), ("sigma3", (-two, two)), ("sigma4", (-two, two)))),
            cls(
                (
                    ("phi", (-1.35, 1.35)),
                    ("phidot", (0.05 * unit, 0.05 * unit)),
                    ("sigma3", (0.15 * unit, 0.15 * unit)),
                    ("sigma4", (-0.8 * unit, 0.8 * unit)),
                )
            ),
        )

    @property
    def axes(self) -> tuple[str, str]:
        first, second = (name for name, (low, high) in self.ranges if low < high)
        return first, second

    @property
    def fixed(self) -> dict[str, float]:
        return {name: low for name, (low, high) in self.ranges if low == high}

    def grid(self, points: int) -> tuple[Array, Array, dict[str, Array]]:
        """Axis values (points) of both axes, and the coordinates of the grid, second axis first."""
        box = dict(self.ranges)
        x, y = (np.linspace(*box[name], points) for name in self.axes)
        X, Y = np.meshgrid(x, y)
        columns = {name: np.full(X.size, value) for name, value in self.fixed.items()}
        columns.update({self.axes[0]: X.ravel(), self.axes[1]: Y.ravel()})
        return x, y, columns


@dataclass(frozen=True)
class SliceMap:
    """theta_min on a slice by integration, and the exact set from algebra; arrays (ny, nx)."""

    slice: Slice
    x: Array
    y: Array
    theta_min: Array
    distance_plus: Array
    distance_minus: Array
    could_fall_plus: NDArray[np.bool_]
    could_fall_minus: NDArray[np.bool_]


def map_slice(disk: Disk, where: Slice, points: int) -> SliceMap:
    """Compute a slice on points x points states, by integration."""
    x, y, columns = where.grid(points)
    states = phi_to_states(disk, **columns)
    found = natural_constants(states)
    how = models.plan(("theta_min",), SLICE_ACCURACY, "dopri5")
    theta, _status, _steps = smallest_tilt(states, how, found)
    exact = falls_of(states, found)
    shape = (points, points)
    return SliceMap(
        where,
        x,
        y,
        theta.reshape(shape),
        exact.distance_plus.reshape(shape),
        exact.distance_minus.reshape(shape),
        exact.could_fall_plus.reshape(shape),
        exact.could_fall_minus.reshape(shape),
    )


@dataclass(frozen=True)
class FallingSet(SampledScene):
    """theta_min, side of F and could-fall of states drawn from a box."""

    box: Box | None = None
    max_energy: float | None = None
    slices: tuple[Slice, ...] | None = None
    grid: int = 401

    name: ClassVar[str] = "falling-set"
    observables: ClassVar[tuple[str, ...]] = ("theta_min", "side", "could_fall")

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        if self.max_energy is not None:
            # An energy that the box does not reach is refused before anything is written.
            draw_states(self.disk, self.where, chunk_stream(self.seed, 0), 1, self.max_energy)

    @property
    def where(self) -> Box:
        return self.box or Box.default(self.disk)

    def options(self) -> dict[str, Any]:
        slices = self.slices or Slice.defaults(self.disk)
        return {
            **self.common_options(),
            "box": self.where.describe(),
            "max_energy": self.max_energy,
            "slices": [{name: list(span) for name, span in s.ranges} for s in slices],
            "grid": self.grid,
        }

    def compute(self, index: int) -> Table:
        random = chunk_stream(self.seed, index)
        columns, states = draw_states(self.disk, self.where, random, self.chunk_length(index), self.max_energy)
        found = natural_constants(states)
        exact = falls_of(states, found)
        how = models.plan(self.observables, self.accuracy, self.method)
        theta, status, steps = smallest_tilt(states, how, found)
        constants = constants_of(states, found)
        return {
            **columns,
            "sigma3_bar": constants.sigma3_bar,
            "eta_hat_plus": constants.eta_hat_plus,
            "eta_hat_minus": constants.eta_hat_minus,
            "energy": constants.energy,
            "side": exact.side,
            "could_fall": exact.could_fall,
            "theta_min": theta,
            "status": status.astype(np.int8),
            "steps": steps,
        }

    def summarise(self, tables: Tables) -> dict[str, Any]:
        sides = {f"side_{s}_eta_{e}": 0 for s in ("plus", "minus") for e in ("positive", "negative", "zero")}
        could = 0
        for table in tables():
            could += int(table["could_fall"].sum())
            for side, name in ((1, "plus"), (-1, "minus")):
                eta = table[f"eta_hat_{name}"][table["side"] == side]
                sides[f"side_{name}_eta_positive"] += int((eta > 0).sum())
                sides[f"side_{name}_eta_negative"] += int((eta < 0).sum())
                sides[f"side_{name}_eta_zero"] += int((eta == 0).sum())
        status = statistics.count_status(table["status"] for table in tables())
        fraction = statistics.share(could, self.samples)
        return {
            "samples": self.samples,
            "side_counts": sides,
            "could_fall_fraction": fraction["value"],
            "could_fall_interval_95": fraction["interval_95"],
            "theta_min_quantiles": statistics.quantiles(column(tables, "theta_min")),
            "falls": status.get("falls", 0),
            "status": status,
        }

    def figures(self, summary: dict[str, Any], tables: Tables) -> "Iterator[tuple[str, Figure]]":
        from explorer import plot

        yield "constants-plane", plot.figure_of(plot.constants_plane, self.plane(tables))
        for number, where in enumerate(self.slices or Slice.defaults(self.disk), 1):
            found = map_slice(self.disk, where, self.grid)
            yield f"slice-{number}", plot.figure_of(plot.slice_map, found)
        yield "theta-min", plot.figure_of(plot.theta_min_distribution, column(tables, "theta_min"))

    def plane(self, tables: Tables) -> "ConstantsPlane":
        """The smallest theta_min of all samples in each cell of the (sigma3_bar, sigma4_bar) plane."""
        slope = line_slope(self.disk)

        def coordinates(table: Table) -> tuple[Array, Array]:
            return table["sigma3_bar"], 0.5 * (table["eta_hat_minus"] - table["eta_hat_plus"])

        reach = np.zeros(2)
        for table in tables():
            reach = np.maximum(reach, [np.percentile(abs(c), 99.5) for c in coordinates(table)])
        edges = [np.linspace(-extent, extent, MAP_CELLS + 1) for extent in np.maximum(reach, 1e-300)]
        smallest = np.full((MAP_CELLS, MAP_CELLS), np.inf)
        for table in tables():
            i, j = (np.digitize(c, e) - 1 for c, e in zip(coordinates(table), edges, strict=True))
            inside = (i >= 0) & (i < MAP_CELLS) & (j >= 0) & (j < MAP_CELLS)
            inside &= np.isfinite(table["theta_min"])
            np.minimum.at(smallest, (j[inside], i[inside]), table["theta_min"][inside])
        smallest[np.isinf(smallest)] = np.nan
        return ConstantsPlane(self.disk, edges[0], edges[1], smallest, slope)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        low, high = summary["could_fall_interval_95"]
        quantile = summary["theta_min_quantiles"]
        ok = summary["status"].get(compiled.status.Status.OK.name.lower(), 0)
        lines = [
            f"{summary['samples']:,} states, {ok:,} computed to the accuracy asked, "
            f"{summary['falls']} exactly on the falling set",
            f"could fall, were they on it: {summary['could_fall_fraction']:.4%} (95 %: {low:.4%} to {high:.4%})",
        ]
        if quantile:
            lines.append(
                f"tilt at the flattest moment: median {quantile['0.5']:.3g} rad, smallest {quantile['0']:.3g} rad"
            )
        return lines


@dataclass(frozen=True)
class ConstantsPlane:
    """What the map of all samples shows: cell edges, smallest theta_min per cell, slope of l_+."""

    disk: Disk
    sigma3_edges: Array
    sigma4_edges: Array
    smallest: Array
    slope: float

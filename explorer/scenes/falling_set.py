"""Scene falling-set: where in the phase space the disk would fall.

theta_min is the smaller tilt at the two turning points of a motion. The slices are integrated,
whatever gives the samples' theta_min, and the exact set drawn over them comes from the constants of
motion alone. The two never meet before the picture, so the valley of the one lying on the curves of
the other is a test that users can see.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import one_of, whole
from explorer.measure import sifting, statistics
from explorer.measure.log_counts import LogCounts
from explorer.measure.sifting import Chunk, in_lanes, sift
from explorer.motion.trials import TiltTrial
from explorer.motion.turning_points import smallest_tilt, tilt_kernels
from explorer.phase import membership
from explorer.phase.constants import NaturalConstants, best_constants, constants_of
from explorer.phase.disk import require_axial_inertia
from explorer.phase.lines import line_slope
from explorer.phase.membership import could_fall, falls_of
from explorer.phase.states import COORDINATES, Array, States, phi_to_states
from explorer.portrait.slices import ConstantsPlane, Slice, slice_map
from explorer.scenes.base import Chunks, Picture, Table, Tally, joined
from explorer.scenes.falling_counts import (
    MAP_CELLS,
    NO_CODE,
    FallingCounts,
    count_faces,
    nearer,
    no_cells,
)
from explorer.scenes.given_states import Block
from explorer.scenes.of_states import BLOCK, SceneOfStates
from explorer.scenes.options import BOX, Option, Ranges, read_slices

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Near F, natural units of eta_hat: where all samples have a theta_min, and where only those near F do. Rows beyond
# are counted, not stored, unless all are asked for.
NEAR = {"all": 0.01, "near": 0.001}
# Above so many samples theta_min is computed near F only, where it is all that matters, and chunks are large:
# such runs keep few rows of each.
MOST_THETA_MIN = 10_000_000
LARGE_CHUNK = 1 << 20
_FIRST = 16_384  # states that say how far the map of all samples must reach
_WIDER = 1.0 + 1e-9  # rounding of a distance must not decide what is looked at
# The map's theta_min as integers: 3000 to the decade above 1e-20.
_DEEPEST, _CODES_PER_DECADE = -20.0, 3000.0


@dataclass(frozen=True, kw_only=True)
class FallingSet(SceneOfStates):
    """Where does the disk fall? theta_min, face and could-fall of states, drawn or given."""

    slices: tuple[Slice, ...]
    grid: int = 401
    theta_min: str

    bytes_per_sample: ClassVar[int] = 300
    name: ClassVar[str] = "falling-set"
    observables: ClassVar[tuple[str, ...]] = ("theta_min", "face", "could_fall")
    columns: ClassVar[tuple[str, ...]] = (
        *COORDINATES,
        "sigma3_bar",
        "eta_hat_plus",
        "eta_hat_minus",
        "energy",
        "face",
        "could_fall",
        "theta_min",
        "status",
        "steps",
    )
    columns_of_given: ClassVar[tuple[str, ...]] = ("row",)

    class Keywords(SceneOfStates.Keywords, total=False):
        box: Annotated[Ranges, BOX]
        theta_min: Annotated[
            str,
            Option(
                "--theta-min",
                partial(one_of, known=tuple(NEAR)),
                "WHICH",
                "states whose theta_min is computed: all, or those near the falling set (near)",
                default=f"all up to {MOST_THETA_MIN:.0e} samples",
            ),
        ]
        slice: Annotated[
            str | Slice | Sequence[str | Slice],
            Option(
                "--slice",
                read_slices,
                "SLICE",
                'a slice to draw, two ranges and two numbers: "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"',
                default="two slices",
                field="slices",
                several=True,
            ),
        ]
        grid: Annotated[int, Option("--grid", partial(whole, low=2, high=4000), "N", "points per axis of a slice")]

    def __post_init__(self) -> None:
        super().__post_init__()
        require_axial_inertia(self.disk)

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        given = cls.completed_by_source(given)
        disk = given.get("disks", cls.disks)[0]
        many = given.get("samples", cls.samples) > MOST_THETA_MIN
        return {
            "chunk_size": LARGE_CHUNK if many else cls.chunk_size,
            "theta_min": "near" if many else "all",
            "slices": Slice.defaults(disk),
            **given,
        }

    @property
    def tube(self) -> float:
        """|eta_hat| below which a sample is near F, in the units of the disk."""
        return NEAR[self.theta_min] * self.disk.rate_unit

    @property
    def kernels(self) -> tuple[str, ...]:
        return *membership.KERNELS, *(sifting.KERNELS if self._in_lanes else ()), *tilt_kernels(self.plan)

    @property
    def kernels_of_figures(self) -> tuple[str, ...]:
        return (f"batch.first_event_{self._method_of_slices}",)

    @property
    def _method_of_slices(self) -> str:
        """Pictures show the motions, not the formula that says where they turn; by what integrates here anyway."""
        return "dopri5" if self.plan.method == "quadrature" else self.plan.method

    def compute(self, index: int) -> Table:
        return joined([self._table(block) for block in self.blocks(index)])

    def trial(self) -> TiltTrial:
        states = (block.states for index in range(self.chunks()) for block in self.blocks(index))
        return TiltTrial([self._to_follow(each, best_constants(each)) for each in states])

    def _to_follow(self, states: States, natural: NaturalConstants) -> tuple[States, NaturalConstants]:
        """Those states whose theta_min is computed."""
        if self.theta_min == "all":
            return states, natural
        could, distance, _ = self._distances(states, natural)
        rows = np.flatnonzero((distance <= self.tube) & could)
        return states.at(rows), natural.at(rows)

    def process(self, index: int) -> tuple[Table, Tally]:
        if self._in_lanes:
            return self._sifted(index)
        # Block by block: what is not kept never leaves the processor's cache.
        counts, kept = FallingCounts(), []
        for block in self.blocks(index):
            if self.theta_min == "all" or self.keep == "all":
                table = self._table(block)
                of_block = self._count(table)
            else:
                of_block, table = self._sift(block)
            counts.add(of_block)
            kept.append(self.kept(index, table))
        return joined(kept), counts.tally()

    @cached_property
    def _in_lanes(self) -> bool:
        """Whether drawing, counting and sifting are one compiled pass."""
        sifted = self.theta_min == "near" and self.keep != "all"
        plain = self.box is not None and self.states is None and self.source.plain
        return sifted and plain and in_lanes(self.disk, self.source.box)

    def _sifted(self, index: int) -> tuple[Table, Tally]:
        """As `process`, in one pass."""
        n = self.length(index)
        found = sift(self.disk, self.source.box, Chunk(self.seed, index, n, BLOCK), self.tube * _WIDER)
        table = self._table(Block(phi_to_states(self.disk, **found.columns), found.columns, {}))
        counts = FallingCounts(faces=found.faces, could_fall=found.could_fall, distance=found.distance)
        good = sum(found.faces.values())
        counts.status = {"ok": good, "bad_input": n - good}
        near = nearer(table)[table["could_fall"]]
        if near.size:
            # The last digits of what cancels depend on how sums are rounded: the table says what is stored.
            counts.distance.smallest = float(near.min())
        self._add_near(counts, table)
        return self.kept(index, table), counts.tally()

    def _sift(self, block: Block) -> tuple[FallingCounts, Table]:
        """Counts of all states of a block, and all about those near F, the only ones with a theta_min."""
        natural = best_constants(block.states)
        could, distance, eta = self._distances(block.states, natural)
        near = np.flatnonzero((distance <= self.tube * _WIDER) & could)
        table = self._table(block.at(near))
        counts = FallingCounts(could_fall=int(could.sum()), distance=LogCounts.of(distance[could]))
        counts.faces = count_faces(natural.nearer_plus, eta)
        counts.status = statistics.count_status([block.states.status])
        self._add_near(counts, table)
        return counts, table

    def _distances(self, states: States, natural: NaturalConstants) -> tuple[NDArray[np.bool_], Array, Array]:
        """Whether states could fall on the nearer face, and |eta_hat| (units of the disk) and eta there."""
        near_plus = natural.nearer_plus
        eta = natural.eta(near_plus)
        could = np.where(near_plus, *could_fall(states, natural))
        return could, self.disk.eta_to_eta_hat(abs(eta)) * self.disk.rate_unit, eta

    def _add_near(self, counts: FallingCounts, table: Table) -> None:
        """What is known of those near F only, all of which are good states: on F to rounding, and theta_min."""
        found = statistics.count_status([table["status"]])
        counts.status = statistics.add_counts([counts.status, found, {"ok": -table["status"].size}])
        counts.status = {name: count for name, count in counts.status.items() if count}
        counts.theta_min, counts.plane = LogCounts.of(table["theta_min"]), self._cells(table)

    def _table(self, block: Block) -> Table:
        """Everything about a few states, so few that intermediate arrays stay in the processor's cache."""
        states = block.states
        natural = best_constants(states)
        exact = falls_of(states, natural)
        constants = constants_of(states, natural)
        table: Table = {
            "sigma3_bar": constants.sigma3_bar,
            "eta_hat_plus": constants.eta_hat_plus,
            "eta_hat_minus": constants.eta_hat_minus,
            "energy": constants.energy,
            "face": exact.face,
            "could_fall": exact.could_fall,
        }
        return block.with_results(table | self._flattest(table, states, natural, exact.status))

    def _flattest(
        self, table: Table, states: States, natural: NaturalConstants, status: NDArray[np.int8]
    ) -> Table:
        """theta_min, status and steps; where theta_min is not computed it is NaN."""
        if self.theta_min == "all":
            theta, status, steps = smallest_tilt(states, self.plan, natural, status)
            return {"theta_min": theta, "status": status.astype(np.int8), "steps": steps}
        rows = np.flatnonzero(self._is_near(table))
        n = len(states)
        flattest, code, steps = np.full(n, np.nan), status.astype(np.int8), np.zeros(n, np.int32)
        near = states.at(rows), self.plan, natural.at(rows), code[rows]
        flattest[rows], code[rows], steps[rows] = smallest_tilt(*near)
        return {"theta_min": flattest, "status": code, "steps": steps}

    def near(self, index: int, table: Table) -> NDArray[np.bool_]:
        return self._is_near(table)

    def _is_near(self, table: Table) -> NDArray[np.bool_]:
        return (nearer(table) <= self.tube) & table["could_fall"]

    def tally(self, index: int, table: Table) -> Tally:
        return self._count(table).tally()

    def _count(self, table: Table) -> FallingCounts:
        counts = FallingCounts()
        on_plus = table["face"] == 1
        counts.faces = count_faces(on_plus, np.where(on_plus, table["eta_hat_plus"], table["eta_hat_minus"]))
        counts.status = statistics.count_status([table["status"]])
        counts.could_fall = int(table["could_fall"].sum())
        counts.theta_min = LogCounts.of(table["theta_min"])
        counts.distance = LogCounts.of(nearer(table)[table["could_fall"]])
        counts.plane = self._cells(table)
        return counts

    def add_up(self, chunks: Chunks) -> FallingCounts:
        total = FallingCounts()
        for tally in chunks.tallies:
            total.add(FallingCounts.of(tally))
        return total

    def summarise(self, total: FallingCounts) -> dict[str, Any]:
        states = self.states_among(total.status)
        fraction = statistics.share(total.could_fall, states)
        near = f"samples with |eta_hat| <= {self.tube:g}"
        return {
            "samples": self.samples,
            "valid_states": states,
            "face_counts": total.faces,
            "could_fall_fraction": fraction["value"],
            "could_fall_interval_95": fraction["interval_95"],
            "theta_min_of": "all samples" if self.theta_min == "all" else near,
            "theta_min_known": total.theta_min.total,
            "theta_min_quantiles": total.theta_min.quantiles(),
            "distance_quantiles": total.distance.quantiles(),
            "falls": total.status.get("falls", 0),
            "status": total.status,
        }

    @property
    def figure_count(self) -> int:
        return 2 + len(self.slices)

    def figures(self, summary: dict[str, Any], total: FallingCounts) -> Iterator[tuple[str, Picture]]:
        from explorer import plot

        yield "constants-plane", partial(plot.constants_plane, self.plane(total.plane))
        for number, where in enumerate(self.slices, 1):
            yield f"slice-{number}", partial(self._draw_slice, where)
        yield "theta-min", partial(plot.theta_min_distribution, total.theta_min, summary["valid_states"])

    def _draw_slice(self, where: Slice, **options: Any) -> "Axes":
        from explorer import plot

        return plot.slice_map(
            slice_map(self.disk, where, points=self.grid, method=self._method_of_slices), **options
        )

    @cached_property
    def _plane_edges(self) -> tuple[Array, Array]:
        """Edges of the map of all samples: what holds 99.5 % of the first ones in each direction."""
        table = constants_of(self.first_states(_FIRST))
        sigma3, sigma4 = table.sigma3_bar, table.sigma4_bar
        good = np.isfinite(sigma3) & np.isfinite(sigma4)
        reach = [np.percentile(abs(c[good]), 99.5) if good.any() else 1.0 for c in (sigma3, sigma4)]
        sigma3_edges, sigma4_edges = (np.linspace(-r, r, MAP_CELLS + 1) for r in np.maximum(reach, 1e-300))
        return sigma3_edges, sigma4_edges

    def _cells(self, table: Table) -> NDArray[np.uint16]:
        """The smallest theta_min in each cell of the plane of constants, as a code; none is the largest."""
        known = np.flatnonzero(np.isfinite(table["theta_min"]))
        theta = table["theta_min"][known]
        sigma4_bar = 0.5 * (table["eta_hat_minus"][known] - table["eta_hat_plus"][known])
        i, j = (
            np.floor((c - e[0]) * (MAP_CELLS / (e[-1] - e[0])))
            for c, e in zip((table["sigma3_bar"][known], sigma4_bar), self._plane_edges, strict=True)
        )
        inside = (i >= 0) & (i < MAP_CELLS) & (j >= 0) & (j < MAP_CELLS)
        codes = no_cells()
        depth = np.log10(np.maximum(theta[inside], 10.0**_DEEPEST)) - _DEEPEST
        place = (j[inside] * MAP_CELLS + i[inside]).astype(np.int64)
        np.minimum.at(codes, place, np.round(depth * _CODES_PER_DECADE).astype(np.uint16))
        return codes

    def plane(self, codes: NDArray[np.uint16]) -> "ConstantsPlane":
        """The smallest theta_min of all samples in each cell of the (sigma3_bar, sigma4_bar) plane."""
        smallest = np.where(codes == NO_CODE, np.nan, 10.0 ** (codes / _CODES_PER_DECADE + _DEEPEST))
        return ConstantsPlane(
            self.disk,
            *self._plane_edges,
            smallest.reshape(MAP_CELLS, MAP_CELLS),
            line_slope(self.disk),
            self.plan.method,
        )

    def headline(self, summary: dict[str, Any]) -> list[str]:
        low, high = summary["could_fall_interval_95"]
        quantile = summary["theta_min_quantiles"]
        ok = summary["status"].get(compiled.status.Status.OK.name.lower(), 0)
        states = self.states_among(summary["status"])
        rows = summary["samples"] - states
        left = "1 row is not a state and is" if rows == 1 else f"{rows:,} rows are not states and are"
        bad = f"; {left} left out" if rows else ""
        lines = [
            f"{states:,} states, {ok:,} computed to the accuracy asked, "
            f"{summary['falls']} exactly on the falling set{bad}",
            f"would fall if eta were exactly 0: {100.0 * summary['could_fall_fraction']:.1f} % "
            f"(95 % interval {100.0 * low:.1f} % to {100.0 * high:.1f} %)",
        ]
        if quantile:
            known = f"{summary['theta_min_known']:,}"
            near = "" if self.theta_min == "all" else f" with |eta_hat| <= {self.tube:g}, the only ones computed"
            lines.append(
                f"tilt at the flattest moment of the {known} states{near}: median {quantile['0.5']:.3g} rad, "
                f"smallest {quantile['0']:.3g} rad"
            )
        return lines

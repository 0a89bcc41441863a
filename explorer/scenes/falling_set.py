"""Scene falling-set: where in the phase space the disk would fall.

theta_min is the smaller tilt at the two turning points of a motion. The slices are integrated,
whatever gives the samples' theta_min, and the exact set drawn over them comes from the constants of
motion alone. The two never meet before the picture, so the valley of the one lying on the curves of
the other is a test that users can see.
"""

from collections.abc import Iterator
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.measure import statistics
from explorer.measure.slices import ConstantsPlane, Slice, slice_map
from explorer.measure.tallies import ByName, Least, LogHistogram
from explorer.motion.turning_points import smallest_tilt, tilt_kernels
from explorer.phase import falling_set
from explorer.phase.constants import constants
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.falling_set import Location, located
from explorer.phase.linear_constants import rows_of
from explorer.phase.results import Columns, count_status, stacked
from explorer.phase.states import COORDINATES, Array, States, joined_states
from explorer.scenes.given_states import Block
from explorer.scenes.options import Reader, option, whole_from, word_of
from explorer.scenes.scene import MANY, Counts, Picture
from explorer.scenes.starts import FromStates

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Near F, natural units of eta_hat: where all samples have a theta_min, and where only those near F do. Rows beyond
# are counted, not stored, unless all are asked for.
NEAR = {"all": 0.01, "near": 0.001, "none": 0.001}
# The map of all samples over the plane of constants: cells a side, and as many first states as say how far it must
# reach; theta_min as integers, 3000 to the decade above 1e-20.
CELLS, _FIRST = 160, 16_384
_FLATTEST, _CODES_PER_DECADE = -20.0, 3000.0


class FallingCounts(Counts):
    """States by face and sign of eta, those that could fall, and the smallest theta_min by constants of motion."""

    faces: ByName[int]
    could_fall: int
    theta_min: LogHistogram
    distance: LogHistogram
    plane: Least


class FallingSet(FromStates):
    """From which states does the disk fall flat? theta_min and the nearer face of random or given states."""

    theta_min: str = option(
        word_of(*NEAR),
        "for which states to compute theta_min: all, near (those near the falling set), or none",
        words=f"all; above {MANY:.0e} samples near, as it is near F that it matters",
        follows=lambda self, given: given or ("near" if self.samples > MANY else "all"),
    )
    slice: tuple[Slice, ...] = option(
        Reader(lambda name, value: value, "SLICE", "str | Slice"),
        "a plane of the phase space to show in a picture; two coordinates are fixed and two are ranges, as in "
        '"phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2"',
        words="two slices",
        follows=lambda self, given: tuple(
            Slice.read(each, self.degrees) for each in given or Slice.defaults(self.disk)
        ),
        key="slices",
        several=True,
    )
    grid: int = option(whole_from(2, 4000), "points per axis of a slice", default=401)

    tally = FallingCounts
    observables: ClassVar[tuple[str, ...]] = ("theta_min", "face", "could_fall")
    columns = (
        *COORDINATES,
        *("sigma3_bar", "eta_hat_plus", "eta_hat_minus", "energy", "face", "could_fall"),
        *("theta_min", "status", "steps"),
    )
    columns_of_given = ("row",)
    few = ("none", "near")
    bytes_per_sample = 300
    says = (
        "{valid_states:,} of {samples:,} samples are states of the disk, {falls:,} of them exactly on the "
        "falling set",
        "would fall if eta, their distance from the falling set, were exactly 0: {could_fall_fraction:.1%} "
        "(95 % interval {could_fall_interval_95[0]:.1%} to {could_fall_interval_95[1]:.1%})",
        "tilt of {theta_min_of}, each at its flattest moment: median {theta_min_quantiles[0.5]:.3g} rad, "
        "one in a thousand below {theta_min_quantiles[0.001]:.3g} rad",
    )

    @property
    def tube(self) -> float:
        """|eta_hat| below which a sample is near F, in the units of the disk."""
        return NEAR[self.theta_min] * self.disk.rate_unit

    @property
    def kernels(self) -> tuple[str, ...]:
        tilts = () if self.theta_min == "none" else tilt_kernels(self.plan)
        return *falling_set.KERNELS, *super().kernels, *tilts, *LogHistogram.KERNELS

    # Samples

    def chunk(self, index: int) -> tuple[Columns, FallingCounts]:
        tally, tables, states = FallingCounts(), list[Columns](), list[States]()
        everything = "all" in (self.theta_min, self.keep)
        for block in self.blocks(index):
            here = located(block.states)
            distance = eta_to_eta_hat(self.disk.body, abs(here.eta)) * self.disk.rate_unit
            self._count(tally, here, distance)
            stays = np.full(distance.size, everything) | (here.could & (distance <= self.tube))
            tally.status += count_status(here.status[~stays])
            rows = np.flatnonzero(stays)
            some = block.at(rows)
            tables.append(self._table(some, rows_of(here, rows)))
            states.append(some.states)
        # Few states of a block are near F: those of a chunk are followed together.
        table = stacked(tables)
        self._follow(table, joined_states(states))
        tally.status += count_status(table["status"])
        self._count_tilts(tally, table)
        return self.kept(table), tally

    def _table(self, block: Block, here: Location) -> Columns:
        """Everything about a few states but their theta_min."""
        known, n = constants(block.states), block.states.size
        names = "sigma3_bar", "eta_hat_plus", "eta_hat_minus", "energy"
        table: Columns = {name: getattr(known, name) for name in names}
        table |= {"face": here.face, "could_fall": here.could, "theta_min": np.full(n, np.nan)}
        return block.with_results(table | {"status": here.status, "steps": np.zeros(n, np.int32)})

    def _follow(self, table: Columns, states: States) -> None:
        """theta_min, and what became of the states for which it is wanted -> table."""
        wanted = np.full(states.size, self.theta_min == "all") | (self.theta_min == "near" and self.near(table))
        rows = np.flatnonzero(wanted)
        for first in range(0, rows.size, self.block):
            some = rows[first : first + self.block]
            found = smallest_tilt(states.at(some), self.plan)
            for name, values in zip(("theta_min", "status", "steps"), found, strict=True):
                table[name][some] = values

    def near(self, table: Columns) -> NDArray[np.bool_]:
        distance = np.fmin(abs(table["eta_hat_plus"]), abs(table["eta_hat_minus"]))
        return np.asarray((distance <= self.tube) & table["could_fall"])

    # Counts

    def _count(self, tally: FallingCounts, here: Location, distance: Array) -> None:
        """Faces and signs of eta, those that could fall, and how far these are from F."""
        on_plus, eta = here.face == 1, here.eta
        for face, chosen in (("plus", on_plus), ("minus", ~on_plus)):
            for sign, there in (("positive", eta > 0.0), ("negative", eta < 0.0), ("zero", eta == 0.0)):
                tally.faces[f"face_{face}_eta_{sign}"] += int(np.count_nonzero(chosen & there))
        tally.could_fall += int(np.count_nonzero(here.could))
        tally.distance.count(distance[here.could])

    def _count_tilts(self, tally: FallingCounts, table: Columns) -> None:
        """theta_min, and the smallest one in each cell of the plane of constants, as a code."""
        known = np.flatnonzero(np.isfinite(table["theta_min"]))
        theta = table["theta_min"][known]
        tally.theta_min.count(theta)
        sigma4_bar = 0.5 * (table["eta_hat_minus"] - table["eta_hat_plus"])
        i, j = (
            np.floor((values[known] + reach) * (CELLS / (2.0 * reach)))
            for values, reach in zip((table["sigma3_bar"], sigma4_bar), self._reach, strict=True)
        )
        inside = (i >= 0) & (i < CELLS) & (j >= 0) & (j < CELLS)
        depth = np.log10(np.maximum(theta[inside], 10.0**_FLATTEST)) - _FLATTEST
        codes, place = np.full(CELLS * CELLS, Least.NONE, np.uint16), j[inside] * CELLS + i[inside]
        np.minimum.at(codes, place.astype(np.int64), np.round(depth * _CODES_PER_DECADE).astype(np.uint16))
        tally.plane += Least(codes)

    @cached_property
    def _reach(self) -> Array:
        """How far the map goes: what holds 99.5 % of the first states in each direction."""
        found = constants(self.first_states(_FIRST))
        good = np.isfinite(found.sigma3_bar) & np.isfinite(found.sigma4_bar)
        both = (found.sigma3_bar, found.sigma4_bar)
        return np.maximum([np.percentile(abs(c[good]), 99.5) if good.any() else 1.0 for c in both], 1e-300)

    # Numbers and pictures

    def summarise(self, tally: FallingCounts) -> dict[str, Any]:
        states = self.states_among(tally.status)
        fraction = statistics.share(tally.could_fall, states)
        near = f"samples with |eta_hat| <= {self.tube:g}"
        return {
            **super().summarise(tally),
            "valid_states": states,
            "face_counts": dict(tally.faces),
            "could_fall_fraction": fraction["value"],
            "could_fall_interval_95": fraction["interval_95"],
            "theta_min_of": {"all": "all samples", "near": near, "none": "no samples"}[self.theta_min],
            "theta_min_known": tally.theta_min.total,
            "theta_min_quantiles": tally.theta_min.row().quantiles(),
            "distance_quantiles": tally.distance.row().quantiles(),
            "falls": tally.status.get("falls", 0),
        }

    def figures(self, summary: dict[str, Any], tally: FallingCounts) -> Iterator[tuple[str, Picture]]:
        from explorer.pictures import falling

        known = tally.theta_min.total > 0
        if known:
            yield "constants-plane", partial(falling.constants_plane, self.plane(tally.plane))
        for number, where in enumerate(self.slice, 1):
            yield f"slice-{number}", partial(self._draw_slice, where)
        if known:
            yield "theta-min", partial(falling.theta_min, tally.theta_min, summary["valid_states"])

    def _draw_slice(self, where: Slice, **options: Any) -> "Figure":
        from explorer.pictures.slices import slice_of_tilts

        # Pictures show the motions, not the formula that says where they turn; by what integrates here anyway.
        method = "dopri5" if self.plan.method == "quadrature" else self.plan.method
        return slice_of_tilts(slice_map(self.disk, where, points=self.grid, method=method), **options)

    def plane(self, least: Least) -> ConstantsPlane:
        """The smallest theta_min of all samples in each cell of the (sigma3_bar, sigma4_bar) plane."""
        smallest = np.where(
            least.counts == Least.NONE, np.nan, 10.0 ** (least.counts / _CODES_PER_DECADE + _FLATTEST)
        )
        sigma3, sigma4 = (np.linspace(-reach, reach, CELLS + 1) for reach in self._reach)
        return ConstantsPlane(self.disk, sigma3, sigma4, smallest.reshape(CELLS, CELLS), self.plan.method)

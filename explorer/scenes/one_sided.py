"""Scene one-sided: how motions beside F approach the two limit motions, and how these differ.

From points of F drawn at the vertical, motions start at eta_hat = +-10^-k beside them and run
through several falls. Away from the impacts their distance to the limit motion of their side
shrinks like eta ln(1/eta); the two limits themselves stay 2 kappa pi mod 2 pi apart per fall.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from itertools import chain, islice
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, TypedDict

import numpy as np

from explorer.errors import InputError
from explorer.measure import statistics
from explorer.measure.sampling import Box, Range, chunk_stream
from explorer.motion import limit_motions
from explorer.motion.plan import plan
from explorer.motion.trajectories import trajectories
from explorer.motion.trials import MotionTrial, even_times
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array
from explorer.portrait.both_sides import (
    QUANTITIES,
    BothSides,
    beside,
    both_sides,
    limits_at,
    sample_times,
)
from explorer.scenes.base import Chunks, Picture, Scene, Table, Tally, joined, together
from explorer.scenes.beside import (
    BOX,
    box_beside,
    check_eta_hat,
    default_box,
    describe_beside,
    draw_beside,
    eta_hat_option,
)
from explorer.scenes.options import (
    ACCURACY,
    DISK,
    METHOD,
    SAMPLES,
    SEED,
    Disks,
    Distances,
    Ranges,
    read_disks,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BLOCK = 8  # starts per chunk
# The limits coincide where the measured gap is below this (rad); it is 1.48 and more elsewhere.
SAME = 1e-3


@dataclass(frozen=True)
class Approach:
    """What all chunks say: the rows of every disk, and how many motions ended in each status."""

    tables: dict[str, Table]
    status: dict[str, int]


@dataclass(frozen=True, kw_only=True)
class OneSided(Scene):
    """What is the limit from each side? Distance to each limit motion as eta shrinks, for several disks."""

    disks: tuple[Disk, ...] = (Disk.uniform(), Disk.hoop(), Disk.matching())
    samples: int = 32
    box: Box | None = None
    eta_hat: Range | None = None

    name: ClassVar[str] = "one-sided"
    tried: ClassVar[int] = 4
    observables: ClassVar[tuple[str, ...]] = QUANTITIES
    columns: ClassVar[tuple[str, ...]] = (
        "base",
        "sigma3_bar",
        "phidot",
        "eta_hat",
        "status",
        *(f"distance_{name}" for name in QUANTITIES),
        "distance",
        "chi_between",
    )

    class Keywords(TypedDict, total=False):
        disk: Annotated[
            Disks, replace(DISK, read=read_disks, text="disk, as for other scenes; several may be given")
        ]
        seed: Annotated[int, SEED]
        accuracy: Annotated[float, ACCURACY]
        method: Annotated[str, METHOD]
        samples: Annotated[int | float, replace(SAMPLES, text="points of the falling set per disk")]
        box: Annotated[Ranges, BOX]
        eta_hat: Annotated[Distances, eta_hat_option("1e-6:1e-1, by decades,")]

    def __post_init__(self) -> None:
        super().__post_init__()
        for disk in self.disks:
            require_axial_inertia(disk)
            check_eta_hat(self.span(disk), disk)
        if len({disk.name for disk in self.disks}) < len(self.disks):
            raise InputError("--disk: one-sided needs different names; name disks in TOML files")

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        if "box" not in given:
            return given
        return {**given, "box": box_beside(given.get("disks", cls.disks)[0], given["box"])}

    def where(self, disk: Disk) -> Box:
        return self.box or default_box(disk)

    def span(self, disk: Disk) -> Range:
        """|eta_hat| in the units of the disk; 1e-6 to 1e-1 natural units unless given."""
        return self.eta_hat or (1e-6 * disk.rate_unit, 1e-1 * disk.rate_unit)

    def ladder(self, disk: Disk) -> Array:
        """Magnitudes of eta_hat, one per decade, from the largest down."""
        low, high = self.span(disk)
        rungs = max(1, round(math.log10(high / low)) + 1)
        return np.geomspace(high, low, rungs)

    def options(self) -> dict[str, Any]:
        return {**super().options(), "box": self.box and describe_beside(self.box)}

    @property
    def blocks(self) -> int:
        """Chunks per disk."""
        return -(-self.samples // BLOCK)

    def chunks(self) -> int:
        return len(self.disks) * self.blocks

    def starts(self, index: int) -> list[dict[str, float]]:
        """Points of F of chunk `index`, each by its phidot, sigma3_bar and face at the vertical."""
        box, count = self.where(self.disks[index // self.blocks]), self._count(index)
        drawn = draw_beside(box, chunk_stream(self.seed, index), count)
        return [{name: float(values[i]) for name, values in drawn.items()} for i in range(count)]

    def _count(self, index: int) -> int:
        return min(BLOCK, self.samples - index % self.blocks * BLOCK)

    @property
    def kernels(self) -> tuple[str, ...]:
        return *limit_motions.KERNELS, *plan(QUANTITIES, self.accuracy, self.method).motions

    @property
    def kernels_of_figures(self) -> tuple[str, ...]:
        return "falling.line_chart_batch", "recording.draw_batch", "recording.at_times"

    def compute(self, index: int) -> Table:
        return self._beside_starts(index, self._count(index))

    def begin(self, index: int, parts: int) -> tuple[Table, Tally, int]:
        count = max(1, self._count(index) // parts)
        table = self._beside_starts(index, count)
        return table, self.tally(index, table), table["status"].size

    def _beside_starts(self, index: int, count: int) -> Table:
        """The motions beside the first so many starts of chunk `index`."""
        disk, starts = self.disks[index // self.blocks], self.starts(index)
        first = BLOCK * (index % self.blocks)
        return joined([self._approach(disk, first + i, start) for i, start in enumerate(starts[:count])])

    def motions(self, count: int, t_end: float | None) -> MotionTrial:
        """`count` motions beside its first starts, at the times of the scene unless `t_end` is given.

        Every start has motions at all distances, and every disk as many starts: one, or as many as `count` allows.
        """
        groups = []
        for number, disk in enumerate(self.disks):
            distances = self._distances(disk)
            chunks = range(number * self.blocks, (number + 1) * self.blocks)
            starts = chain.from_iterable(self.starts(index) for index in chunks)
            for start in islice(starts, max(1, count // (len(self.disks) * distances.size))):
                states = beside(disk, start, distances)
                times = sample_times(limits_at(disk, start)[1])[0] if t_end is None else even_times(t_end)
                groups.append((states, times))
        return MotionTrial(groups)

    def _distances(self, disk: Disk) -> Array:
        ladder = self.ladder(disk)
        return np.concatenate([ladder, -ladder])

    def _approach(self, disk: Disk, base: int, start: dict[str, float]) -> Table:
        """All rungs of the ladder, both signs, beside one point of F."""
        eta_hat = self._distances(disk)
        both = limits_at(disk, start)
        times, middle = sample_times(both[1])
        motion = trajectories(
            beside(disk, start, eta_hat),
            t_eval=times,
            observables=QUANTITIES,
            method=self.method,
            accuracy=self.accuracy,
        )
        assert motion.chi is not None
        columns: Table = {
            "base": np.full(eta_hat.size, base),
            "sigma3_bar": np.full(eta_hat.size, start["sigma3_bar"]),
            "phidot": np.full(eta_hat.size, start["phidot"]),
            "eta_hat": eta_hat,
            "status": motion.status,
        }
        for name in QUANTITIES:
            columns[f"distance_{name}"] = np.empty(eta_hat.size)
        limits = {side: both[side](times) for side in (1, -1)}  # every rung of a side has the same
        for row, value in enumerate(eta_hat):
            limit = limits[1 if value > 0 else -1]
            for name in QUANTITIES:
                difference = getattr(motion, name)[row] - getattr(limit, name)
                columns[f"distance_{name}"][row] = abs(difference).max() / _unit(disk, name)
        columns["distance"] = np.max([columns[f"distance_{name}"] for name in QUANTITIES], axis=0)
        # Between the first two impacts the two sides differ by one fall.
        columns["chi_between"] = motion.chi[:, middle]
        return columns

    def length(self, index: int) -> int:
        disk, starts = self.disks[index // self.blocks], self._count(index)
        return 2 * starts * len(self.ladder(disk))

    def add_up(self, chunks: Chunks) -> Approach:
        tables = {}
        for disk in self.disks:
            tables[disk.name] = joined(list(islice(chunks.tables, self.blocks)))
        return Approach(tables, statistics.add_counts(tally["status"] for tally in chunks.tallies))

    def together(self, others: Sequence[Scene]) -> Scene:
        return together(self, others)

    def add_up_several(self, parts: Sequence[tuple[Scene, Chunks]]) -> Approach:
        """Every run has its chunks disk by disk, so each is added up alone first."""
        totals = [scene.add_up(chunks) for scene, chunks in parts]
        tables = {name: joined([total.tables[name] for total in totals]) for name in totals[0].tables}
        return Approach(tables, statistics.add_counts(total.status for total in totals))

    def summarise(self, total: Approach) -> dict[str, Any]:
        per_disk = {disk.name: self._summarise_disk(disk, total.tables[disk.name]) for disk in self.disks}
        return {"samples": self.samples, "disks": per_disk, "status": total.status}

    def _summarise_disk(self, disk: Disk, table: Table) -> dict[str, Any]:
        rows = []
        for size in self.ladder(disk):
            row: dict[str, Any] = {"eta_hat": float(size)}
            for sign, name in ((1, "plus"), (-1, "minus")):
                chosen = table["distance"][np.isclose(table["eta_hat"], sign * size, rtol=1e-9, atol=0.0)]
                chosen = chosen[np.isfinite(chosen)]
                row[f"motions_{name}"] = int(chosen.size)
                if chosen.size:
                    row[f"median_{name}"] = float(np.median(chosen))
                    row[f"largest_{name}"] = float(chosen.max())
            rows.append(row)
        gap = self._gap(disk, table)
        measured = gap["measured"]
        return {
            "gap": gap,
            "coincide": None if measured is None else abs(math.remainder(measured, 2.0 * math.pi)) < SAME,
            "coincide_exact": min(disk.gap, 2.0 * math.pi - disk.gap) < 1e-12,
            "kappa": disk.kappa,
            "distances": rows,
            "rate_plus": fitted_rate(disk, rows, "plus"),
            "rate_minus": fitted_rate(disk, rows, "minus"),
        }

    def _gap(self, disk: Disk, table: Table) -> dict[str, Any]:
        """2 kappa pi mod 2 pi from the motions nearest to F, brought next to the exact value."""
        smallest = self.ladder(disk)[-1]
        near = np.isclose(abs(table["eta_hat"]), smallest, rtol=1e-9, atol=0.0)
        plus = table["chi_between"][near & (table["eta_hat"] > 0)]
        minus = table["chi_between"][near & (table["eta_hat"] < 0)]
        error = np.array([math.remainder(d, 2.0 * math.pi) for d in plus - minus - disk.gap if np.isfinite(d)])
        return {
            "exact": disk.gap,
            # Further from F than the limits are from each other, there is nothing to measure.
            "measured": float(disk.gap + np.median(error)) if error.size and abs(error).max() < 0.5 else None,
            "largest_error": float(abs(error).max()) if error.size else None,
            "at_eta_hat": float(smallest),
        }

    @property
    def figure_count(self) -> int:
        return 1 + 2 * len(self.disks)

    def figures(self, summary: dict[str, Any], total: Approach) -> Iterator[tuple[str, Picture]]:
        from explorer import plot

        yield "distance", partial(plot.one_sided_distance, summary)
        for index, disk in enumerate(self.disks):
            start = beside(disk, self.starts(index * self.blocks)[0], 0.0)
            computed = cache(partial(both_sides, start))
            yield f"motion-{disk.name}", partial(_draw_motion, computed)
            yield f"contact-{disk.name}", partial(_draw_contact, computed)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = []
        for name, limits in summary["disks"].items():
            gap = limits["gap"]
            measured = "not measured" if gap["measured"] is None else f"{gap['measured']:+.6f}"
            verdict = {True: "they coincide", False: "they differ", None: "start nearer to the falling set"}
            lines.append(
                f"{name}: gap between the two limits {measured} rad (exact {gap['exact']:.6f}); "
                f"{verdict[limits['coincide']]}"
            )
        return lines


def _draw_motion(computed: Callable[[], BothSides]) -> "Figure":
    from explorer import plot

    return plot.stacked(partial(plot.one_sided_phi, computed()), partial(plot.one_sided_chi, computed()))


def _draw_contact(computed: Callable[[], BothSides], **options: Any) -> "Axes":
    from explorer import plot

    return plot.contact_paths(computed(), **options)


def _unit(disk: Disk, name: str) -> float:
    return disk.r if name in ("path", "contact") else 1.0


def fitted_rate(disk: Disk, rows: list[dict[str, Any]], name: str) -> float | None:
    """Exponent p of distance = C (eta ln 1/eta)^p over the rungs below 0.02 natural units; theory: 1."""
    used = [(row["eta_hat"] / disk.rate_unit, row[f"median_{name}"]) for row in rows if f"median_{name}" in row]
    points = np.array([(eta, d) for eta, d in used if eta < 0.02 and d > 0.0])
    if len(points) < 2:
        return None
    law = np.log(points[:, 0] * np.log(1.0 / points[:, 0]))
    return float(np.polyfit(law, np.log(points[:, 1]), 1)[0])

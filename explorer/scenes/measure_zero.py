"""Scene measure-zero: is falling an event of probability zero, as codimension one says?

Plain draws count how many states come flatter than delta, and how many fall. Where they have no hits, draws
in tubes beside F estimate P(theta_min < delta) with weights, rung by rung of a ladder of delta. The law is
P = C delta, C by quadrature over F; it is fitted, tested, and compared with laws that it is not.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from explorer import compiled
from explorer.errors import InputError
from explorer.measure import statistics
from explorer.measure.box_integrals import NaturalDensity
from explorer.measure.density import Density, Function
from explorer.measure.falling_constant import FallingConstant, constant_of
from explorer.measure.laws import SHAPE_BINS
from explorer.measure.sampling import Box, Range, chunk_stream
from explorer.measure.tubes import Draws, dimensions, draw_tube, widest_eta
from explorer.motion import plan as models
from explorer.motion.turning_points import smallest_tilt, turning_points
from explorer.phase.constants import NaturalConstants, natural_constants
from explorer.phase.disk import require_axial_inertia
from explorer.phase.states import Array, phi_to_states
from explorer.scenes.base import Chunks, SampledScene, Table, Tally
from explorer.scenes.measure_zero_summary import FEWEST_HITS, summarise

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SAMPLING = ("random", "sobol")
SCRAMBLES = 16
# The next term of the law is of order delta: 1e-4 of C here, and rungs above only measure it.
LAW_LIMIT = 1e-4
_NEAREST_FLAT = 0.01  # share of the box's distance from flat up to which the law may be tested
_NARROWEST = 1e-3  # half-width of a tube over the narrowest width of the density, likewise
ENERGY_BINS = 6
_BATCH = 1 << 14
_CHECKED = 256  # hits per chunk whose race is followed by integration
_EDGE_DRAWS, _EDGE_STREAM, _EDGE_TILT = 4096, 1 << 40, 1e-8


class Piece(NamedTuple):
    """A chunk: plain draws (rung < 0), or batch `part` of a tube."""

    rung: int
    face: int
    part: int


@dataclass(frozen=True)
class MeasureZero(SampledScene):
    """P(theta_min < delta) on a ladder of delta, for states drawn from a density.

    samples: plain draws; tube: draws per rung and side of F; ladder: largest and smallest delta (rad).
    """

    box: Box | None = None
    energy: Range | None = None
    gaussian: str | None = None
    density: Function | None = None
    ladder: Range = (1e-15, 1e-1)
    samples: int = 4_000_000  # enough to see a probability of 1e-6, were there one
    tube: int = 1 << 18
    sampling: str = "random"

    name: ClassVar[str] = "measure-zero"
    observables: ClassVar[tuple[str, ...]] = ("theta_min", "face", "could_fall")
    bytes_per_sample: ClassVar[int] = 1000

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        low, high = self.ladder
        if not 1e-100 <= low < high <= 1.0:
            raise InputError(f"--ladder {low:g}:{high:g} must be LOW:HIGH within 1e-100:1 (tilts in rad)")
        if self.sampling == "sobol" and self.tube < 2 * SCRAMBLES:
            raise InputError(f"--tube {self.tube}: Sobol points come in {SCRAMBLES} scrambles; give more draws")
        if not {"sigma3", "sigma4"} & set(self.source.box.free):
            raise InputError(
                "--box: sigma3 and sigma4 are both fixed, so the falling set is met at isolated tilts or not at "
                "all, and there are no tubes; give one of them a range (falling_constant gives C in Python)"
            )
        if NaturalDensity(self.disk, self.source).reaches_flat():
            raise InputError(
                "--box reaches flat (phi = +-pi/2) where the density does not vanish and the energy has no bound: "
                "P is of order delta ln(1/delta) there, there is no C; give --energy LOW:HIGH, or keep phi away"
            )
        # What draws nothing, or is no density, is refused before anything is written.
        self.source.draw(self.disk, chunk_stream(self.seed, 0), 1)
        if np.count_nonzero(self.deltas <= self.law_limit) < 2:
            raise InputError(
                f"--ladder {low:g}:{high:g}: needs two rungs at or below {self.law_limit:.1e}, where the law "
                "holds for this box and disk; give a smaller LOW"
            )

    @cached_property
    def source(self) -> Density:
        """What states are drawn from."""
        return Density.of(self.disk, self.box, self.energy, self.gaussian, self.density)

    @cached_property
    def deltas(self) -> Array:
        """The rungs, largest first, a decade apart."""
        low, high = self.ladder
        count = int(np.floor(np.log10(high / low) + 1e-9)) + 1
        return np.array([float(f"{high * 10.0**-k:.12g}") for k in range(count)])

    @cached_property
    def law_limit(self) -> float:
        """The largest delta at which the next term of the law may be neglected."""
        frame = NaturalDensity(self.disk, self.source)
        away = 0.5 * np.pi - max(map(abs, self.source.box.phi))
        near_flat = _NEAREST_FLAT * away if away > 0.0 else LAW_LIMIT
        # The half-width of a thin tube is proportional to its delta.
        thin = 1e-9
        width = float(widest_eta(np.array([frame.most_energy()]), thin, self.disk)[0]) / thin
        return float(min(LAW_LIMIT, near_flat, _NARROWEST * frame.narrowest() / width))

    @cached_property
    def constant(self) -> FallingConstant:
        """C by quadrature."""
        return constant_of(self.disk, self.source)

    def options(self) -> dict[str, Any]:
        numbers = {"ladder": list(self.ladder), "tube": self.tube, "sampling": self.sampling}
        return {**self.common_options(), **self.source.describe(), **numbers}

    @property
    def _parts(self) -> int:
        """Batches of a tube."""
        return SCRAMBLES if self.sampling == "sobol" else -(-self.tube // _BATCH)

    def chunks(self) -> int:
        return super().chunks() + 2 * self.deltas.size * self._parts

    def piece(self, index: int) -> Piece:
        """What chunk `index` is. Plain draws come last, so that a longer run keeps all chunks of a shorter one."""
        tube, part = divmod(index, self._parts)
        if tube >= 2 * self.deltas.size:
            return Piece(-1, 0, index - 2 * self.deltas.size * self._parts)
        return Piece(tube // 2, 1 if tube % 2 == 0 else -1, part)

    def length(self, index: int) -> int:
        piece = self.piece(index)
        if piece.rung < 0:
            return super().length(piece.part)
        if self.sampling == "sobol":
            return 1 << int(np.log2(self.tube // SCRAMBLES))
        return min(_BATCH, self.tube - piece.part * _BATCH)

    def process(self, index: int) -> tuple[Table, Tally]:
        piece = self.piece(index)
        if piece.rung < 0:
            table, tally = self._plain(index)
            near = table["theta_min"] < self.deltas[0]
        else:
            table, tally = self._tube(index, piece)
            # One batch of every tube shows what the draws and weights look like.
            near = np.full(table["status"].size, piece.part == 0)
        rows = {"all": np.ones_like(near), "near": near, "none": np.zeros_like(near)}[self.keep]
        return {name: values[rows] for name, values in table.items()}, tally

    def compute(self, index: int) -> Table:
        piece = self.piece(index)
        return (self._plain(index) if piece.rung < 0 else self._tube(index, piece))[0]

    def _plain(self, index: int) -> tuple[Table, Tally]:
        """Plain draws. Those that cannot come flatter than the first rung are counted, not followed."""
        disk, count = self.disk, self.length(index)
        columns = self.source.draw(disk, chunk_stream(self.seed, index), count)
        states = phi_to_states(disk, **columns)
        natural = natural_constants(states)
        plus = natural.nearer_plus
        eta = disk.eta_to_eta_hat(natural.eta(plus))
        rows = np.flatnonzero(abs(eta) <= widest_eta(natural.energy, self.deltas[0], disk))
        near, known = states.at(rows), natural.at(rows)
        theta, status, _ = smallest_tilt(near, models.plan(self.observables, self.accuracy, self.method), known)
        theta = np.where(status == compiled.status.Status.FALLS, 0.0, theta)
        kinds = _kinds(plus[rows], eta[rows])
        hits = [[int(np.count_nonzero(theta[kind] < delta)) for kind in kinds] for delta in self.deltas]
        tally = {
            "kind": "plain",
            "draws": count,
            "hits": hits,
            "status": statistics.add_counts(
                [statistics.count_status([status.astype(np.int8)]), {"not followed": count - rows.size}]
            ),
            "race": self._race(near, known, theta, np.where(plus[rows], 1, -1), eta[rows]),
        }
        unit = disk.rate_unit
        table: Table = {name: values[rows] for name, values in columns.items()}
        table |= self._columns(known.sigma3_bar * unit, eta[rows] * unit, known.energy * disk.energy_unit)
        ones = np.ones(rows.size)
        table |= {"face": np.where(plus[rows], 1, -1).astype(np.int8), "delta": np.nan * ones, "weight": ones}
        return table | {"theta_min": theta, "status": status.astype(np.int8)}, tally

    @staticmethod
    def _columns(sigma3_bar: Array, eta_hat: Array, energy: Array) -> Table:
        return {"sigma3_bar": sigma3_bar, "eta_hat": eta_hat, "energy": energy}

    def _race(self, near: Any, known: NaturalConstants, theta: Array, face: Array, eta: Array) -> dict[str, int]:
        """Which way the contact point races at the flattest moment, by integration, against the sign of eta."""
        rows = np.flatnonzero((theta < self.deltas[0]) & (theta > 0.0))[:_CHECKED]
        how = models.plan(("race_angle",), 1e-4, "dopri5")
        counts = {"right": 0, "wrong": 0, "not_resolved": 0}
        for states in (near.at(rows), near.at(rows).reversed()):
            turn = turning_points(states, how, known.at(rows))
            here = (turn.face == face[rows]) & (abs(turn.theta / theta[rows] - 1.0) < 0.5)
            agrees = np.sign(turn.way) == np.sign(eta[rows])
            counts["right"] += int((here & agrees).sum())
            counts["wrong"] += int((here & ~agrees).sum())
            counts["not_resolved"] += int((turn.status != compiled.status.Status.OK).sum())
        return counts

    def _tube(self, index: int, piece: Piece) -> tuple[Table, Tally]:
        """A batch of draws in a tube."""
        random, count = chunk_stream(self.seed, index), self.length(index)
        size = dimensions(self.source)
        if self.sampling == "sobol":
            points = qmc.Sobol(size, scramble=True, bits=53, rng=random).random(count)
        else:
            points = random.random((count, size))
        delta = self.deltas[piece.rung]
        found = self._draw(piece.face, delta, points)
        hit = found.weight * (found.theta_min < delta)
        sums = _sums(hit, found, delta, self.energy_edges)
        tally = {
            "kind": "tube",
            "rung": piece.rung,
            "face": piece.face,
            "draws": count,
            **sums,
            "unresolved": float(found.weight[found.status != 0].sum()),
            "status": statistics.count_status([found.status]),
        }
        table: Table = {"phi": found.phi, "phidot": found.phidot}
        table |= {"sigma3": np.full(count, np.nan), "sigma4": np.full(count, np.nan)}
        table |= self._columns(found.sigma3_bar, found.eta_hat, found.energy)
        table |= {"face": np.full(count, piece.face, np.int8), "delta": np.full(count, delta)}
        return table | {"weight": found.weight, "theta_min": found.theta_min, "status": found.status}, tally

    def _draw(self, face: int, delta: float, points: Array) -> Draws:
        mass = self.constant.mass
        return draw_tube(self.disk, self.source, mass, face, float(delta), points, self.accuracy)

    @cached_property
    def energy_edges(self) -> Array:
        """Inner edges of the bins of energy: quantiles of a few states near F; empty where there are none."""
        random = chunk_stream(self.seed, _EDGE_STREAM)
        energies = []
        for face in (1, -1):
            found = self._draw(face, _EDGE_TILT, random.random((_EDGE_DRAWS, dimensions(self.source))))
            energies.append(found.energy[found.weight > 0.0])
        together = np.concatenate(energies)
        inner = np.arange(1, ENERGY_BINS) / ENERGY_BINS
        return np.quantile(together, inner) if together.size > 10 * ENERGY_BINS else np.zeros(0)

    def tally(self, table: Table) -> Tally:
        raise NotImplementedError("the chunks of measure-zero are counted where they are drawn")

    def summarise(self, chunks: Chunks) -> dict[str, Any]:
        return summarise(self, chunks)

    def figures(self, summary: dict[str, Any], chunks: Chunks) -> "Iterator[tuple[str, Figure]]":
        from explorer import plot

        if not summary["constant"]:
            yield "ladder", plot.figure_of(plot.falling_ladder, summary)
            return
        yield (
            "ladder",
            plot.stacked(
                lambda ax: plot.falling_ladder(summary, ax), lambda ax: plot.ladder_ratio(summary, ax), height=8.4
            ),
        )
        yield "convergence", plot.figure_of(plot.constant_convergence, summary)
        yield "tilt", plot.figure_of(plot.tilt_density, summary)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = [
            f"{summary['samples']:,} states drawn, {summary['falls']} fell: the probability of falling is below "
            f"{summary['upper_bound_95']:.2e} (95 %, exact)"
        ]
        if summary["constant_predicted"] == 0.0:
            return [*lines, "the box misses the falling set: C = 0, and no law to test"]
        if not summary["constant"]:
            fewest = min(row["effective_sample_size"] for row in summary["ladder"])
            few = f"C predicted {summary['constant_predicted']:.6g}; not estimated: a rung has hits worth"
            remedy = f"fewer than {FEWEST_HITS}; raise --tube, or narrow --box to where the density is"
            return [*lines, f"{few} {fewest:.0f} equal ones, {remedy}"]
        slope, constant = summary["slope"], summary["constant"]
        return [
            *lines,
            f"slope of P(theta_min < delta): {slope['value']:.6f} (95 %: {_text(slope['interval_95'], 6)})",
            f"C: {constant['value']:.5f} (95 %: {_text(constant['interval_95'], 5)}), predicted "
            f"{summary['constant_predicted']:.6f} +- {summary['constant_predicted_error']:.0e}",
            f"p-value of the law {summary['p_value']['law']:.2g} (draws in tubes), "
            f"{summary['p_value_counts']['law']:.2g} (plain counts); that both agree "
            f"{summary['p_value_counts_against_tubes']:.2g}",
        ]


def _text(interval: list[float], digits: int) -> str:
    return f"{interval[0]:.{digits}f} to {interval[1]:.{digits}f}"


def _kinds(plus: NDArray[np.bool_], eta: Array) -> list[NDArray[np.bool_]]:
    """Rows by side (+, -) and sign of eta (+, -); eta = 0 counts as +."""
    return [chosen & sign for chosen in (plus, ~plus) for sign in (eta >= 0.0, eta < 0.0)]


def _sums(hit: Array, found: Draws, delta: float, edges: Array) -> Tally:
    """Sums of weights and of their squares over the hits: all, by sign of eta, by energy, by theta_min / delta."""
    bins = {
        "energy": (np.searchsorted(edges, found.energy), edges.size + 1),
        "tilt": ((np.nan_to_num(found.theta_min) / delta * SHAPE_BINS).astype(np.int64), SHAPE_BINS),
    }
    sums: Tally = {"sum": float(hit.sum()), "squares": float((hit * hit).sum())}
    sums["sum_eta_positive"] = float(hit[found.eta_hat > 0.0].sum())
    sums["hits"] = int(np.count_nonzero(hit))
    rows = hit > 0.0
    for name, (where, size) in bins.items():
        place = np.minimum(where[rows], size - 1)
        sums[name] = np.bincount(place, hit[rows], size).tolist()
        sums[f"{name}_squares"] = np.bincount(place, hit[rows] ** 2, size).tolist()
    return sums

"""Scene measure-zero: is falling an event of probability zero, as codimension one says?

Plain draws count how many states come flatter than delta, and how many fall. Where they have no hits, draws
in tubes beside F estimate P(theta_min < delta) with weights, rung by rung of a ladder of delta. The law is
P = C delta, C by quadrature over F; it is fitted, tested, and compared with laws that it is not.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, one_of, whole
from explorer.measure import invariance
from explorer.measure.box_integrals import NaturalDensity
from explorer.measure.density import Density, Function
from explorer.measure.sampling import Box, Range, chunk_stream
from explorer.motion.plan import Plan
from explorer.motion.trials import MotionTrial, TiltTrial, through_time
from explorer.motion.turning_points import tilt_kernels
from explorer.phase import membership
from explorer.phase.arguments import read_range
from explorer.phase.disk import require_axial_inertia
from explorer.phase.states import COORDINATES, Array
from explorer.scenes.base import Chunks, Picture, SampledScene, Table, Tally, part_of
from explorer.scenes.measure_zero_draws import PlainDraws, Question, TubeDraws, checking
from explorer.scenes.measure_zero_summary import FEWEST_HITS, Counted, summarise
from explorer.scenes.options import BOX, DENSITY, ENERGY, GAUSSIAN, OpenRange, Option, Ranges

SAMPLING = ("random", "sobol")
SCRAMBLES = 16  # batches of Sobol points: enough for an error from their spread
_BATCH = 1 << 14  # independent draws per batch of a tube


@dataclass(frozen=True, kw_only=True)
class MeasureZero(SampledScene):
    """How rarely does it nearly fall? P(theta_min < delta) down to 1e-15 against the law C delta.

    samples: plain draws; tube: draws per rung and face; ladder: smallest and largest delta (rad).
    """

    box: Box
    energy: Range | None = None
    gaussian: dict[str, Range] | None = None
    density: Function | None = None
    ladder: Range = (1e-15, 1e-1)
    samples: int = 4_000_000  # enough to see a probability of 1e-6, were there one
    tube: int = 1 << 18
    sampling: str = "random"

    name: ClassVar[str] = "measure-zero"
    tried: ClassVar[int] = 1 << 15  # of which one in ten is followed
    observables: ClassVar[tuple[str, ...]] = ("theta_min", "face", "could_fall")
    columns: ClassVar[tuple[str, ...]] = (
        *COORDINATES,
        "sigma3_bar",
        "eta_hat",
        "energy",
        "face",
        "delta",
        "weight",
        "theta_min",
        "status",
    )
    bytes_per_sample: ClassVar[int] = 1000

    class Keywords(SampledScene.Keywords, total=False):
        box: Annotated[Ranges, BOX]
        energy: Annotated[OpenRange, ENERGY]
        gaussian: Annotated[Ranges, GAUSSIAN]
        density: Annotated[Function, DENSITY]
        ladder: Annotated[
            str | Range,
            Option("--ladder", read_range, "LOW:HIGH", "tilts delta in rad, from the largest down by decades"),
        ]
        tube: Annotated[
            int | float,
            Option("--tube", partial(whole, low=2, high=10**9), "N", "draws per delta and face in tubes beside F"),
        ]
        sampling: Annotated[
            str,
            Option("--sampling", partial(one_of, known=SAMPLING), "HOW", "draws in the tubes: random or sobol"),
        ]

    def __post_init__(self) -> None:
        low, high = self.ladder  # first: the rungs are counted below
        if not 1e-100 <= low < high <= 1.0:
            raise InputError(f"--ladder {low:g}:{high:g} must be LOW:HIGH within 1e-100:1 (tilts in rad)")
        super().__post_init__()
        require_axial_inertia(self.disk)
        if self.sampling == "sobol" and self.tube < 2 * SCRAMBLES:
            raise InputError(f"--tube {self.tube}: Sobol points come in {SCRAMBLES} scrambles; give more draws")
        source = self.question.source
        if not {"sigma3", "sigma4"} & set(source.box.free):
            raise InputError(
                "--box: sigma3 and sigma4 are both fixed, so the falling set is met at isolated tilts or not at "
                "all, and there are no tubes; give one of them a range (falling_constant gives C in Python)"
            )
        if NaturalDensity(self.disk, source).reaches_flat():
            raise InputError(
                "--box reaches flat (phi = +-pi/2) where the density does not vanish and the energy has no bound: "
                "P is of order delta ln(1/delta) there, there is no C; give --energy LOW:HIGH, or keep phi away"
            )
        # What draws nothing, or is no density, is refused before anything is written.
        source.draw(self.disk, chunk_stream(self.seed, 0), 1)
        if np.count_nonzero(self.question.tested) < 2:
            raise InputError(
                f"--ladder {low:g}:{high:g}: needs two rungs at or below {self.question.law_limit:.1e}, where the "
                "law holds for this box and disk; give a smaller LOW"
            )

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        disk = given.get("disks", cls.disks)[0]
        return {**given, "box": replace(Box.default(disk), **given.get("box", {}))}

    def options(self) -> dict[str, Any]:
        # A function is identified by its values.
        return {**super().options(), "density": self.question.source.describe().get("density")}

    @cached_property
    def question(self) -> Question:
        """What is asked, for those who draw and those who sum up."""
        source = Density.of(self.disk, self.box, self.energy, self.gaussian, self.density)
        scrambled = self.sampling == "sobol"
        return Question(self.disk, source, self.deltas, self.plan, self.samples, self.seed, scrambled)

    @cached_property
    def deltas(self) -> Array:
        """The rungs, largest first, a decade apart."""
        low, high = self.ladder
        count = int(np.floor(np.log10(high / low) + 1e-9)) + 1
        return np.array([float(f"{high * 10.0**-k:.12g}") for k in range(count)])

    @property
    def _parts(self) -> int:
        """Batches of a tube."""
        return SCRAMBLES if self.sampling == "sobol" else -(-self.tube // _BATCH)

    def chunks(self) -> int:
        return super().chunks() + 2 * self.deltas.size * self._parts

    def piece(self, index: int) -> PlainDraws | TubeDraws:
        """What chunk `index` is. Plain draws come last, so that a longer run keeps all chunks of a shorter one."""
        tube, part = divmod(index, self._parts)
        if tube >= 2 * self.deltas.size:
            plain = index - 2 * self.deltas.size * self._parts
            return PlainDraws(self.question, index, super().length(plain))
        count = min(_BATCH, self.tube - part * _BATCH)
        if self.sampling == "sobol":
            count = 1 << int(np.log2(self.tube // SCRAMBLES))
        return TubeDraws(self.question, index, count, tube // 2, 1 if tube % 2 == 0 else -1, part)

    def length(self, index: int) -> int:
        return self.piece(index).count

    @property
    def kernels(self) -> tuple[str, ...]:
        checked = ("falling.line_chart_batch", checking().first_event)
        return *membership.KERNELS, *checked, *tilt_kernels(self.plan), *invariance.kernels()

    @property
    def plans(self) -> tuple[Plan, ...]:
        return *super().plans, checking(), invariance.following()

    def trial(self) -> TiltTrial:
        """The plain draws that are followed; those in tubes have their tilt from a formula."""
        return TiltTrial([plain.followed()[1:] for plain in self._plain()])

    def motions(self, count: int, t_end: float | None) -> MotionTrial:
        states = next(self._plain()).followed()[1]
        return through_time(states.at(np.arange(min(count, len(states)))), t_end)

    def _plain(self) -> Iterator[PlainDraws]:
        pieces = (self.piece(index) for index in range(self.chunks()))
        return (piece for piece in pieces if isinstance(piece, PlainDraws))

    def compute(self, index: int) -> Table:
        return self.piece(index).compute()

    def begin(self, index: int, parts: int) -> tuple[Table, Tally, int]:
        piece = self.piece(index)
        piece = replace(piece, count=part_of(piece.count, parts))
        table = piece.compute()
        return self.kept(index, table), piece.tally(table), piece.count

    def tally(self, index: int, table: Table) -> Tally:
        return self.piece(index).tally(table)

    def near(self, index: int, table: Table) -> NDArray[np.bool_]:
        return self.piece(index).near(table)

    def add_up(self, chunks: Chunks) -> Counted:
        return Counted.of(self.question, list(chunks.tallies))

    def summarise(self, total: Counted) -> dict[str, Any]:
        return summarise(self.question, total)

    @property
    def figure_count(self) -> int:
        return 3

    def figures(self, summary: dict[str, Any], total: Counted) -> Iterator[tuple[str, Picture]]:
        from explorer import plot

        if not summary["constant"]:
            yield "ladder", partial(plot.falling_ladder, summary)
            return
        yield (
            "ladder",
            partial(
                plot.stacked,
                lambda ax: plot.falling_ladder(summary, ax),
                lambda ax: plot.ladder_ratio(summary, ax),
                height=8.4,
            ),
        )
        yield "convergence", partial(plot.constant_convergence, summary)
        yield "tilt", partial(plot.tilt_density, summary)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        lines = [
            f"{summary['samples']:,} states drawn, {summary['falls']} fell: the probability of falling is below "
            f"{summary['upper_bound_95']:.2e} (95 %, exact)"
        ]
        if summary["constant_predicted"] == 0.0:
            return [*lines, "The box misses the falling set: C = 0, and there is no law to test."]
        if not summary["constant"]:
            fewest = min(row["effective_sample_size"] for row in summary["ladder"])
            size = f"one rung has an effective sample size of {fewest:.0f}, below {FEWEST_HITS}"
            remedy = "Raise --tube, or narrow --box to where the density is."
            predicted = f"C is predicted to be {summary['constant_predicted']:.6g}."
            return [*lines, predicted, f"C was not estimated: {size}. {remedy}"]
        slope, constant = summary["slope"], summary["constant"]
        return [
            *lines,
            f"slope of P(theta_min < delta): {slope['value']:.6f} (95 % interval {_interval(slope, 6)})",
            f"C: {constant['value']:.5f} (95 % interval {_interval(constant, 5)}), predicted "
            f"{summary['constant_predicted']:.6f} +- {summary['constant_predicted_error']:.0e}",
            f"p-value of the law {summary['p_value']['law']:.2g} (draws in tubes), "
            f"{summary['p_value_counts']['law']:.2g} (plain counts); that both agree "
            f"{summary['p_value_counts_against_tubes']:.2g}",
        ]


def _interval(estimate: dict[str, Any], digits: int) -> str:
    low, high = estimate["interval_95"]
    return f"{low:.{digits}f} to {high:.{digits}f}"

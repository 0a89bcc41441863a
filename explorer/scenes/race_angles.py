"""Scene race-angles: by how much the contact point races round the rim beside F.

The race angle of a passage is the increase of chi from vertical to vertical less the increase
along the limit motion on F with the same sigma3_bar and energy (its fall angle). Its limit is
sgn(eta) kappa pi, whatever the initial state (Prop. 2).

Passages start at the vertical beside F; or states anywhere in the phase space, drawn or given, are followed
to their next approaches to flat.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, RunError, whole
from explorer.measure import statistics
from explorer.measure.sampling import BLOCK, LaneStream, Range, Stream, gather, log_uniform, signs
from explorer.motion.bounces import MOST, bounce_kernels, bounces
from explorer.motion.passages import Passages, passage_kernels, passages_by
from explorer.motion.trials import MotionTrial, PassageTrial, through_time
from explorer.motion.vertical import starts_at_vertical
from explorer.phase.constants import natural_constants
from explorer.phase.disk import require_axial_inertia
from explorer.phase.states import Array, constants_to_states
from explorer.portrait.races import angle_edges, law_rows, ridge_rows
from explorer.scenes import beside
from explorer.scenes.base import Chunks, NoStateError, Picture, Table, Tally, joined
from explorer.scenes.beside import box_beside, check_eta_hat, describe_beside, draw_beside, eta_hat_option
from explorer.scenes.given_states import Block
from explorer.scenes.of_states import SceneOfStates
from explorer.scenes.options import Distances, Option, Ranges
from explorer.scenes.race_columns import FOUND, OF_BOUNCE, filled, motion_constants
from explorer.scenes.race_counts import (
    AT_ONCE,
    KERNELS,
    SIGNS,
    RaceCounter,
    RaceCounts,
    count_bounces,
    count_races,
)

# Options that mean states anywhere in the phase space, and so do ranges of phi and sigma4 in the box.
_OF_STATES = ("states", "gaussian", "density", "bounces")
BOX = replace(
    beside.BOX,
    text=beside.BOX.text + "; with phi and sigma4 too, states in all of the phase space, as in falling-set",
)
BOUNCES = Option(
    "--bounces",
    partial(whole, low=1, high=MOST),
    "N",
    "how many approaches to flat of each state, where states are given or drawn in all of the phase space",
    default="1",
)


@dataclass(frozen=True, kw_only=True)
class RaceAngles(SceneOfStates):
    """How far does the contact point race? Angles of passages beside the falling set, on both sides."""

    eta_hat: Range | None = None
    bounces: int | None = None

    name: ClassVar[str] = "race-angles"
    observables: ClassVar[tuple[str, ...]] = ("race_angle", "theta_min", "duration")
    columns: ClassVar[tuple[str, ...]] = ("phidot", "sigma3_bar", "eta_hat", "face", *FOUND)
    columns_of_given: ClassVar[tuple[str, ...]] = ("row", "bounce", "phi", "sigma3", "sigma4", "side", "time")
    bytes_per_sample: ClassVar[int] = 1000

    class Keywords(SceneOfStates.Keywords, total=False):
        box: Annotated[Ranges, BOX]
        eta_hat: Annotated[Distances, eta_hat_option("1e-6:1e-2")]
        bounces: Annotated[int, BOUNCES]

    def __post_init__(self) -> None:
        require_axial_inertia(self.disk)
        if self.eta_hat is not None:
            check_eta_hat(self.eta_hat, self.disk)
        elif self.method not in ("auto", "quadrature"):
            raise InputError(f"--method {self.method}: bounces of states are by quadrature; leave it out")
        super().__post_init__()

    @classmethod
    def completed(cls, given: dict[str, Any]) -> dict[str, Any]:
        disk, box = given.get("disks", cls.disks)[0], given.get("box", {})
        why = [name for name in _OF_STATES if name in given]
        if not why and not {"phi", "sigma4"} & set(box):
            default = (1e-6 * disk.rate_unit, 1e-2 * disk.rate_unit)
            return {"eta_hat": default, **given, "box": box_beside(disk, box)}
        if "eta_hat" in given:
            raise InputError(
                f"--eta-hat: is for passages that start at the vertical beside the falling set, and "
                f"{f'--{why[0]}' if why else '--box with phi or sigma4'} gives states elsewhere; leave one out"
            )
        return {"bounces": 1, **cls.completed_by_source(given)}

    def options(self) -> dict[str, Any]:
        options = super().options()
        if self.eta_hat is None or self.box is None:
            return options
        return {**options, "box": describe_beside(self.box)}

    @property
    def kernels(self) -> tuple[str, ...]:
        if self.eta_hat is None:
            return *bounce_kernels(), *KERNELS
        some = () if self.energy is None else ("algebra.constants_batch",)
        return *some, *LaneStream.KERNELS, *passage_kernels(self.plan), *KERNELS

    def compute(self, index: int) -> Table:
        if self.eta_hat is None:
            return joined([self._bounces(block) for block in self.blocks(index)])
        return filled(self.length(index), self._blocks_beside(index))

    def process(self, index: int) -> tuple[Table, Tally]:
        if self.eta_hat is None:
            return super().process(index)
        counter, status, kept = RaceCounter(self.disk, self.length(index)), [], Table()

        def counted() -> Iterator[Table]:
            """Blocks that are counted while they are in a processor's cache."""
            for block in self._blocks_beside(index):
                counter.add(block)
                status.append(block["status"])
                yield block

        if self.keep == "none":  # then no column is made
            for block in counted():
                kept = kept or self.kept(index, block)
        else:
            kept = self.kept(index, filled(self.length(index), counted()))
        return kept, {"status": statistics.count_status(status), **counter.tally()}

    def _blocks_beside(self, index: int) -> Iterator[Table]:
        """The passages of a chunk that starts beside F, block by block."""
        random, length = LaneStream(self.seed, index), self.length(index)
        whole = None if self.energy is None else self._drawn_beside(random, length)
        for first in range(0, length, AT_ONCE):
            rows = slice(first, min(first + AT_ONCE, length))
            if whole is None:
                drawn = self._any_energy(random.of_rows(first, length), rows.stop - first)
            else:
                drawn = {name: values[rows] for name, values in whole.items()}
            made = self._passages(drawn)
            drawn["face"] = drawn["face"].astype(np.int8)
            yield {**drawn, **{name: getattr(made, name) for name in FOUND}}

    def _passages(self, drawn: Table) -> Passages:
        return passages_by(self.disk, starts_at_vertical(self.disk, *_start(drawn)), self.plan)[0]

    def trial(self) -> PassageTrial | None:
        if self.eta_hat is None:  # bounces are by quadrature only
            return None
        return PassageTrial(self.disk, starts_at_vertical(self.disk, *_start(self._first(self.samples))))

    @property
    def trial_size(self) -> int | None:
        return None if self.eta_hat is None else self.samples

    def motions(self, count: int, t_end: float | None) -> MotionTrial:
        if self.eta_hat is None:
            return super().motions(count, t_end)
        states = constants_to_states(self.disk, **self._first(min(count, self.samples)))
        return through_time(states, t_end)

    def _first(self, count: int) -> Table:
        """The first starts at the vertical, as its chunks draw them."""
        chunks = range(-(-count // self.chunk_size))
        parts = [self._drawn_beside(LaneStream(self.seed, k), self.length(k)) for k in chunks]
        return {name: values[:count] for name, values in joined(parts).items()}

    def _drawn(self, random: np.random.Generator, count: int) -> Table:
        return super()._drawn(random, count) if self.eta_hat is None else self._drawn_beside(random, count)

    def _drawn_beside(self, random: Stream, count: int) -> Table:
        """Starts at the vertical: phidot, sigma3_bar, eta_hat and face."""
        if self.energy is None:
            return self._any_energy(random, count)
        low, high = self.energy

        def block() -> tuple[dict[str, Array], NDArray[np.bool_]]:
            drawn = self._any_energy(random, BLOCK)
            states = constants_to_states(self.disk, **drawn)
            energy = natural_constants(states).energy * self.disk.energy_unit
            return drawn, (energy >= low) & (energy <= high)

        return gather(block, count, "--energy: only {} draws beside the falling set were kept; widen it")

    def _any_energy(self, random: Stream, count: int) -> Table:
        assert self.box is not None
        assert self.eta_hat is not None
        start = draw_beside(self.box, random, count)
        face = start.pop("face")
        eta_hat = log_uniform(random.random(count), *self.eta_hat)
        eta_hat *= signs(random.random(count))
        return {**start, "eta_hat": eta_hat, "face": face}

    def _bounces(self, block: Block) -> Table:
        """A row for each approach to flat of each state."""
        assert self.bounces is not None
        found = bounces(block.states, self.bounces, self.accuracy)
        constants = motion_constants(block.states, found)
        results = {name: getattr(found, name).ravel() for name in OF_BOUNCE}
        rows = np.repeat(np.arange(len(block.states)), self.bounces)
        return block.at(rows).with_results(constants | results | {"status": found.status.ravel()})

    def tally(self, index: int, table: Table) -> Tally:
        counted = count_races(table, self.disk)
        if self.eta_hat is not None:
            return {**super().tally(index, table), **counted}
        # Every bounce of a state has the state's status.
        status = statistics.count_status([table["status"][:: self.bounces]])
        return {"status": status, **counted, **count_bounces(table)}

    def add_up(self, chunks: Chunks) -> RaceCounts:
        total = RaceCounts()
        for tally in chunks.tallies:
            total.add(tally)
        return total

    def summarise(self, total: RaceCounts) -> dict[str, Any]:
        limit = self.disk.race_limit
        states = self.samples if self.eta_hat is not None else self.states_among(total.status)
        if not any(total.races(name) for name in SIGNS):
            kind = NoStateError if set(total.status) == {"bad_input"} else RunError
            raise kind(self._without_races(total))
        summary: dict[str, Any] = {
            "samples": self.samples,
            "limit": limit,
            "wrong_way": total.wrong_way,
            "failures": {name: count for name, count in total.status.items() if name != "ok"},
            "status": total.status,
        }
        if self.eta_hat is None:
            bad = (self.samples - states) * (self.bounces or 1)
            summary |= {
                "valid_states": states,
                "approaches": total.bounces - bad,
                "without_race": total.without_race,
            }
        histogram: dict[str, Any] = {"edges": angle_edges(limit).tolist()}
        for name, sign in total.signs.items():
            histogram[f"counts_{name}"], histogram[f"outside_{name}"] = sign.bins.tolist(), sign.outside
            summary[f"races_{name}"] = total.races(name)
            if total.races(name):
                mean, deviation = math.fsum(sign.sums) / total.races(name), total.deviation(name)
                summary[f"median_{name}"] = SIGNS[name] * limit + deviation.quantile(0.5)
                summary[f"mean_{name}"] = SIGNS[name] * limit + mean
                summary[f"width_{name}"] = deviation.half_width()
        return {
            **summary,
            "histogram": histogram,
            "by_decade": total.by_decade(),
            "ridges": ridge_rows(total.decades),
            "law": law_rows(self.disk, total.constants),
            "energy_range": [total.energy.smallest, total.energy.largest],
            "largest_error_estimate": total.error_estimate.largest,
        }

    def _without_races(self, total: RaceCounts) -> str:
        """Why there is nothing to sum up."""
        if self.eta_hat is None:
            return (
                f"race-angles: none of {self.samples} states has a race angle ({total.status}; of "
                f"{total.without_race} bounces the energy is too small to come flat); give other states"
            )
        told = ", ".join(f"{count:,} {name}" for name, count in total.status.items())
        if set(total.status) == {"bad_input"}:
            remedy = "in --box, give phidot of 0 or more, which leads to flat, and rates below 1e100 natural units"
        else:
            remedy = "raise --eta-hat or change --accuracy"
        return f"race-angles: none of {self.samples:,} passages was resolved ({told}); {remedy}"

    @property
    def figure_count(self) -> int:
        return 2

    def figures(self, summary: dict[str, Any], total: RaceCounts) -> Iterator[tuple[str, Picture]]:
        from explorer import plot

        yield "histogram", partial(plot.race_histogram, summary)
        yield "deviation", partial(plot.race_deviation, summary)

    def headline(self, summary: dict[str, Any]) -> list[str]:
        means = [
            f"race angle (rad) of the {summary[f'races_{name}']:,} {what} with {label}: "
            f"mean {summary[f'mean_{name}']:+.4f}, median {summary[f'median_{name}']:+.6f}"
            for what in ("passages" if self.eta_hat is not None else "bounces",)
            for name, label in (("plus", "eta > 0"), ("minus", "eta < 0"))
            if f"mean_{name}" in summary
        ]
        failed = ", ".join(f"{count:,} {name}" for name, count in summary["failures"].items()) or "none"
        limit = f"the limit +-kappa pi is {summary['limit']:.6f} rad"
        if self.eta_hat is not None:
            first = [f"{summary['samples']:,} passages of the {self.disk.name} disk; {limit}"]
        else:
            states = f"{self.states_among(summary['status']):,} states of the {self.disk.name} disk"
            first = [f"{states}, {summary['approaches']:,} bounces; {limit}", *self._nearest(summary)]
        return [*first, *means, f"wrong way: {summary['wrong_way']}; failures: {failed}"]

    def _nearest(self, summary: dict[str, Any]) -> list[str]:
        """The bounces without a race, and the medians nearest to F."""
        lines = []
        if summary["without_race"]:
            lines.append(
                f"{summary['without_race']:,} bounces have no race angle: their energy is too small to come flat"
            )
        for row in summary["by_decade"][:1]:
            lines.append(
                f"nearest to the falling set, |eta_hat| {row['eta_hat_from']:.0e} to "
                f"{10.0 * row['eta_hat_from']:.0e}: {row['passages']:,} bounces, median distance from the limit "
                f"{row['median_deviation']:.2g} rad"
            )
        return lines


def _start(drawn: Table) -> tuple[Array, Array, Array, Array]:
    """Drawn starts at the vertical as `passages` takes them."""
    face = drawn["face"]
    return drawn["sigma3_bar"], drawn["eta_hat"], face * drawn["phidot"], face

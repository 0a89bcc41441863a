"""Scene race-angles: by how much the contact point races round the rim near F.

The race angle of a passage is the increase of chi from vertical to vertical less the increase
along the limit motion on F with the same sigma3_bar and energy (its fall angle). Its limit is
sgn(eta) kappa pi, whatever the initial state (Prop. 2).

It is one question of two kinds of samples, which the option `start` chooses: upright starts near F, or states
anywhere in the phase space, drawn or given, with a row for each of their next approaches to flat.
"""

from collections.abc import Iterator
from functools import partial
from typing import Any, ClassVar

import numpy as np

from explorer.errors import InputError, RunError
from explorer.measure import tallies
from explorer.measure.distributions import Distribution
from explorer.measure.races import (
    SIDES,
    by_decade,
    count_angles,
    count_law,
    decades_and_sides,
    histogram,
    law_rows,
    ridge_rows,
)
from explorer.measure.sampling import PER_STREAM, Range, Stream, log_uniform, signs
from explorer.measure.tallies import ByName, Histogram, LogHistogram
from explorer.motion.bounces import MOST, bounce_kernels, bounces, motion_constants
from explorer.motion.passage_starts import starts_at_vertical
from explorer.motion.passages import passage_kernels, passages_by
from explorer.phase.results import Columns
from explorer.phase.states import Array
from explorer.scenes.options import BOX, RANGE, option, whole_from, word_of
from explorer.scenes.scene import Counts, Picture, SampledScene
from explorer.scenes.starts import BOX_NEAR_F, ETA_HAT, FromStates, box_near_f, eta_hat_span, starts_near_f

# What is stored of a passage and of a bounce, as fields of `Passages` and `Bounces`.
_OF_PASSAGE = (
    *("energy", "race_angle", "wrong_way", "delta_chi", "fall_angle", "impact_speed"),
    *("theta_min", "duration", "error_estimate", "status"),
)
_OF_BOUNCE = (
    *("bounce", "face", "side", "time", "race_angle", "delta_chi", "fall_angle"),
    *("theta_min", "duration", "error_estimate"),
)
_ELSEWHERE = ("states", "energy", "density")  # which say where states may be, anywhere
# What can be done where no sample has a race angle: of states anywhere, and near F
_REMEDY = (
    "give states with more energy: the others do not come flat",
    "raise eta_hat or change accuracy; in box give phidot of 0 or more, which leads to flat, and rates below 1e75 "
    "natural units",
)
KERNELS = (*tallies.KERNELS, *LogHistogram.KERNELS)  # of what is counted


class RaceCounts(Counts):
    """Race angles by side of F, and their deviations from the limit by decade of |eta_hat| and side.

    deviations (sums) and decades are by the groups of `decades_and_sides`, law, its constant, by step of |eta|.
    """

    wrong_way: int
    without_race: int
    angles: ByName[Histogram]
    deviations: ByName[float]
    decades: LogHistogram
    law: LogHistogram
    error_estimate: LogHistogram


class RaceAngles(FromStates):
    """How far does the contact point race? Angles of passages near the falling set, on both sides."""

    box: Distribution = option(
        BOX,
        f"with --start near, {BOX_NEAR_F}; with --start anywhere, as in falling-set",
        words="with near, phidot=0.5:2,sigma3=-2:2 in natural units; with anywhere, that of falling-set",
        follows=lambda self, given: self.box_of(given),
    )
    start: str = option(
        word_of("near", "anywhere"),
        "near: upright, near the falling set. anywhere: random or given states of the whole phase space, each "
        "followed to its next approaches to flat",
        words="near; but anywhere if you give states, energy, density (in Python), or a box with other "
        "coordinates than phidot and sigma3",
        follows=lambda self, given: "near" if self.starts_near(self.box) else "anywhere",
    )
    eta_hat: Range | None = option(
        RANGE,
        f"with --start near: {ETA_HAT}",
        words="1e-6:1e-2 natural units",
        follows=lambda self, given: self.eta_hat_of(given),
    )
    bounces: int = option(
        whole_from(1, MOST),
        "how many approaches to flat are followed from each state; with --start near, one",
        default=1,
    )

    tally = RaceCounts
    observables: ClassVar[tuple[str, ...]] = ("race_angle", "theta_min", "duration")
    columns = ("phidot", "sigma3_bar", "eta_hat", "face", *_OF_PASSAGE)
    columns_of_given = ("row", "bounce", "phi", "sigma3", "sigma4", "side", "time")
    says = (
        "{passages:,} passages of the {disks[0][name]} disk; the limit +-kappa pi is {limit:.6f} rad",
        "{approaches:,} bounces of {valid_states:,} states, {without_race:,} of them with too little energy to "
        "come flat; the limit +-kappa pi is {limit:.6f} rad",
        "race angle (rad) of the {races_plus:,} with eta > 0: mean {mean_plus:+.4f}, median {median_plus:+.6f}",
        "race angle (rad) of the {races_minus:,} with eta < 0: mean {mean_minus:+.4f}, median {median_minus:+.6f}",
        "wrong way: {wrong_way}",
    )

    # Samples

    def starts_near(self, box: Any) -> bool:
        """Whether samples start upright near F: as said, or as nothing says otherwise. box: as far as read."""
        if self.start:
            return self.start == "near"
        names = box.coordinates if isinstance(box, Distribution) else box or ()
        return {*names} <= {"phidot", "sigma3"} and all(getattr(self, name) is None for name in _ELSEWHERE)

    def box_of(self, given: Any) -> Any:
        if not self.starts_near(given):
            return super().box_of(given)
        usual = {"bounces": 1, "degrees": False}
        for name in (*_ELSEWHERE, *usual):
            if getattr(self, name) != usual.get(name):
                raise InputError(f"{name}: is for start anywhere; leave it out, or give start anywhere")
        return box_near_f(self.disk, given)

    def eta_hat_of(self, given: Range | None) -> Range | None:
        """The range of distances from F; None of states anywhere, which have them of themselves."""
        if self.start == "near":
            return eta_hat_span(self.disk, given, (1e-6, 1e-2))
        if given is not None:
            raise InputError(
                "eta_hat: is for start near; leave it out, or give start near (states, energy, density, and a box "
                "of more than phidot and sigma3 mean start anywhere)"
            )
        return None

    @property
    def kernels(self) -> tuple[str, ...]:
        if self.start == "near":
            return *passage_kernels(self.plan), *KERNELS
        return *super().kernels, *bounce_kernels(self.plan), *KERNELS

    @property
    def block(self) -> int:
        return PER_STREAM if self.start == "near" else super().block

    @property
    def rows(self) -> int:
        return self.bounces

    def blocks(self, index: int) -> Iterator[Any]:
        return SampledScene.blocks(self, index) if self.start == "near" else super().blocks(index)

    def draw(self, random: Stream, count: int) -> Columns:
        """States; near F, phidot, sigma3_bar, eta_hat and face of starts at the vertical."""
        if self.eta_hat is None:
            return super().draw(random, count)
        start = starts_near_f(self.box, random, count)
        eta_hat = log_uniform(random.random(count), *self.eta_hat)
        return {**start, "eta_hat": eta_hat * signs(random.random(count))}

    def observe(self, drawn: Any) -> Columns:
        if self.start == "near":
            passages = passages_by(self.disk, starts_at_vertical(self.disk, *start_of(drawn)), self.plan)[0]
            face = drawn["face"].astype(np.int8)
            return {**drawn, "face": face, **{name: getattr(passages, name) for name in _OF_PASSAGE}}
        found = bounces(drawn.states, self.rows, accuracy=self.accuracy, method=self.plan.method)
        results = motion_constants(found) | {name: getattr(found, name) for name in (*_OF_BOUNCE, "status")}
        results = {name: values.ravel() for name, values in results.items()}
        table: Columns = drawn.at(np.repeat(np.arange(drawn.states.size), self.rows)).with_results(results)
        return table

    # Counts

    def count(self, tally: RaceCounts, table: Columns) -> None:
        race, eta_hat, limit = table["race_angle"], table["eta_hat"], self.disk.race_limit
        deviation, group = race - np.sign(eta_hat) * limit, decades_and_sides(eta_hat)
        known = np.isfinite(group) & np.isfinite(deviation)  # a motion on F belongs to no decade
        for name, counts in zip(SIDES, count_angles(limit, eta_hat, race), strict=True):
            tally.angles[name] += Histogram(counts)
        if known.any():
            lowest = int(group[known].min())
            for n, total in enumerate(np.bincount(group[known].astype(int) - lowest, deviation[known]), lowest):
                tally.deviations[str(n)] += float(total)
        tally.decades.count(deviation, group)
        count_law(tally.law, self.disk, eta_hat, race, table["impact_speed"], table["error_estimate"])
        tally.error_estimate.count(table["error_estimate"])
        tally.wrong_way += int(np.count_nonzero(table["wrong_way"]))
        tally.without_race += int(np.count_nonzero(np.isnan(race) & np.isfinite(table["delta_chi"])))

    def summarise(self, tally: RaceCounts) -> dict[str, Any]:
        near = self.start == "near"
        states = self.samples if near else self.states_among(tally.status)
        if not tally.decades.total:
            ended = ", ".join(f"{count:,} {name}" for name, count in tally.status.items())
            raise RunError(
                f"{self.name}: none of {self.samples:,} samples has a race angle ({ended}); {_REMEDY[near]}"
            )
        limit, groups = self.disk.race_limit, tally.decades.groups
        summary = super().summarise(tally) | {"limit": limit, "wrong_way": tally.wrong_way}
        of_states = {"valid_states": states, "approaches": states * self.rows, "without_race": tally.without_race}
        summary |= {"passages": states} if near else of_states
        for name, side in SIDES.items():
            of_side = [group for group in groups if group % 2 == (side > 0)]
            deviation = tally.decades.part(of_side)
            races = summary[f"races_{name}"] = deviation.total
            if races:
                summary[f"median_{name}"] = side * limit + deviation.quantile(0.5)
                summary[f"mean_{name}"] = side * limit + _mean(tally, of_side)
                summary[f"width_{name}"] = deviation.half_width()
        ridges = by_decade(tally.decades)
        return {
            **summary,
            "histogram": histogram(limit, {name: tally.angles[name].counts for name in SIDES}),
            "by_decade": [self._decade(tally, n) for n in ridges],
            "ridges": ridge_rows(ridges),
            "law": law_rows(self.disk, tally.law),
            "largest_error_estimate": tally.error_estimate.quantile(1.0),
        }

    def _decade(self, tally: RaceCounts, n: int) -> dict[str, Any]:
        """How the deviation from the limit shrinks with |eta_hat|, and the mean race angles there."""
        sizes = tally.decades.part([2 * n, 2 * n + 1]).row()
        groups = {name: 2 * n + (side > 0) for name, side in SIDES.items()}
        return {
            "eta_hat_from": 10.0**n,
            "passages": sizes.total,
            "median_deviation": sizes.quantile(0.5),
            "largest_deviation": sizes.largest,
            **{
                f"mean_{name}": SIDES[name] * self.disk.race_limit + _mean(tally, [group])
                for name, group in groups.items()
                if tally.decades.part([group]).total
            },
        }

    def figures(self, summary: dict[str, Any], tally: RaceCounts) -> Iterator[tuple[str, Picture]]:
        from explorer.pictures import race

        yield "histogram", partial(race.race_histogram, summary)
        yield "deviation", partial(race.race_deviation, summary)


def _mean(tally: RaceCounts, groups: list[int]) -> float:
    """Of the deviations from the limit in some groups."""
    total: float = sum(tally.deviations[str(group)] for group in groups)
    return total / tally.decades.part(groups).total


def start_of(drawn: Columns) -> tuple[Array, Array, Array, Array]:
    """Drawn starts at the vertical as `passages` takes them."""
    face = drawn["face"]
    return drawn["sigma3_bar"], drawn["eta_hat"], face * drawn["phidot"], face

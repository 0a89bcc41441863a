"""Race angles of a chunk, counted, and the counts of all chunks added up."""

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.measure import statistics
from explorer.measure.log_counts import LogCounts, LogRows, SignedLogCounts
from explorer.phase.disk import Disk
from explorer.portrait.races import (
    ANGLE_BINS,
    SIDES,
    LawCounts,
    angle_edges,
    decades_and_sides,
    decades_of,
    sides_of_decades,
)
from explorer.scenes.base import Table, Tally

SIGNS = SIDES
KERNELS = (*statistics.KERNELS, "race_law.constant_batch")  # of what is counted, for `compiled.warmup`
AT_ONCE = 1 << 15  # passages: fewer need more calls, and columns of more do not stay in a processor's cache
_SIZES = "impact_speed", "energy", "error_estimate"
_COUNTED = ("race_angle", "eta_hat", "wrong_way", *_SIZES)


class RaceCounter:
    """Counts race angles block by block: by the sign of eta_hat, its decade, and the distance from the limit.

    most: how many may come.
    """

    def __init__(self, disk: Disk, most: int) -> None:
        self._limit, self._wrong_way = disk.race_limit, 0
        self._signs = statistics.Histograms(angle_edges(self._limit), len(SIGNS))
        self._decades, self._law = LogRows(), LawCounts(disk, most)
        self._sizes = [LogCounts() for _ in _SIZES]

    def add(self, table: Table) -> None:
        race, eta_hat = table["race_angle"], table["eta_hat"]
        deviation = race - np.sign(eta_hat) * self._limit
        self._wrong_way += int(np.count_nonzero(table["wrong_way"]))
        groups, beside = (eta_hat < 0.0).astype(np.int64), abs(eta_hat) > 0.0  # as in SIGNS
        if not beside.all():  # a motion on F has no side, and belongs to no decade
            groups[~beside] = -1
        self._signs.add(race, deviation, groups)
        self._decades.add(deviation, decades_and_sides(eta_hat))
        self._law.add(eta_hat, race, table["impact_speed"], table["error_estimate"])
        for place, name in enumerate(_SIZES):
            self._sizes[place].add(LogCounts.of(table[name]))

    def tally(self) -> Tally:
        return {
            "wrong_way": self._wrong_way,
            **{name: self._sign(group) for group, name in enumerate(SIGNS)},
            "decades": {
                str(exponent): {name: sides[side].state() for name, side in SIGNS.items()}
                for exponent, sides in sides_of_decades(self._decades.counts()).items()
            },
            "constants": {str(step): counts.state() for step, counts in self._law.counts().items()},
            **{name: counts.state() for name, counts in zip(_SIZES, self._sizes, strict=True)},
        }

    def _sign(self, group: int) -> Tally:
        """The histogram of one sign of eta_hat, and the sum of its deviations."""
        counts = self._signs.counts[group]
        filled = np.flatnonzero(counts[:ANGLE_BINS])
        return {
            "bins": filled.tolist(),
            "counts": counts[filled].tolist(),
            "outside": int(counts[ANGLE_BINS]),
            "sum": self._signs.sums[group],
        }


def count_races(table: Table, disk: Disk) -> Tally:
    """What a `RaceCounter` counts of a table."""
    size = table["race_angle"].size
    counter = RaceCounter(disk, size)
    for first in range(0, size, AT_ONCE):
        counter.add({name: table[name][first : first + AT_ONCE] for name in _COUNTED})
    return counter.tally()


def count_bounces(table: Table) -> Tally:
    """What is counted besides where any state may be: bounces, those without a race, sums by decade."""
    race, eta_hat = table["race_angle"], table["eta_hat"]
    known, decade = np.isfinite(race), np.nan_to_num(decades_of(eta_hat), neginf=-400.0).astype(np.int64)
    sums: dict[str, dict[str, list[float]]] = {}
    for exponent in sorted(set(decade[known].tolist())):
        sums[str(exponent)] = {}
        for name, sign in SIGNS.items():
            values = race[known & (decade == exponent) & (sign * eta_hat > 0.0)]
            sums[str(exponent)][name] = [values.size, math.fsum(values.tolist())]
    without = np.isnan(race) & np.isfinite(table["delta_chi"])
    return {"bounces": int(race.size), "without_race": int(without.sum()), "sums": sums}


@dataclass
class OneSign:
    """Race angles of one sign of eta, counted."""

    bins: NDArray[np.int64] = field(default_factory=lambda: np.zeros(ANGLE_BINS, np.int64))
    outside: int = 0
    sums: list[float] = field(default_factory=list)  # of the deviations, one a chunk

    def add(self, tally: Tally) -> None:
        self.bins[np.array(tally["bins"], np.int64)] += np.array(tally["counts"], np.int64)
        self.outside += tally["outside"]
        self.sums.append(tally["sum"])


@dataclass
class RaceCounts:
    """The tallies of all chunks, added up. sums: by decade and sign, how many races and their sums by chunk."""

    status: dict[str, int] = field(default_factory=dict)
    wrong_way: int = 0
    signs: dict[str, OneSign] = field(default_factory=lambda: {name: OneSign() for name in SIGNS})
    decades: dict[int, dict[int, SignedLogCounts]] = field(default_factory=dict)
    constants: dict[int, SignedLogCounts] = field(default_factory=dict)
    impact_speed: LogCounts = field(default_factory=LogCounts)
    energy: LogCounts = field(default_factory=LogCounts)
    error_estimate: LogCounts = field(default_factory=LogCounts)
    bounces: int = 0
    without_race: int = 0
    sums: dict[tuple[int, str], list[list[float]]] = field(default_factory=dict)

    def add(self, tally: Tally) -> None:
        self.status = statistics.add_counts([self.status, tally["status"]])
        self.wrong_way += tally["wrong_way"]
        for name, sign in self.signs.items():
            sign.add(tally[name])
        for exponent, states in tally["decades"].items():
            sides = self.decades.setdefault(int(exponent), {side: SignedLogCounts() for side in SIGNS.values()})
            for name, side in SIGNS.items():
                sides[side].add(SignedLogCounts(states[name]))
        for step, state in tally["constants"].items():
            self.constants.setdefault(int(step), SignedLogCounts()).add(SignedLogCounts(state))
        for name in _SIZES:
            getattr(self, name).add(LogCounts(tally[name]))
        self.bounces += tally.get("bounces", 0)
        self.without_race += tally.get("without_race", 0)
        for exponent, of_signs in tally.get("sums", {}).items():
            for name, pair in of_signs.items():
                self.sums.setdefault((int(exponent), name), []).append(pair)

    def races(self, name: str) -> int:
        """How many race angles of one sign of eta there are."""
        return sum(sides[SIGNS[name]].total for sides in self.decades.values())

    def deviation(self, name: str) -> SignedLogCounts:
        """Deviations from the limit of all race angles of one sign of eta."""
        together = SignedLogCounts()
        for sides in self.decades.values():
            together.add(sides[SIGNS[name]])
        return together

    def by_decade(self) -> list[dict[str, Any]]:
        """How the deviation from the limit shrinks with |eta_hat|, and where any state may be the means."""
        return [
            {
                "eta_hat_from": 10.0**exponent,
                "passages": deviation.total,
                "median_deviation": deviation.quantile(0.5),
                "largest_deviation": deviation.largest,
                **self._means(exponent),
            }
            for exponent, sides in sorted(self.decades.items())
            if (deviation := _sizes(sides)).total
        ]

    def _means(self, exponent: int) -> dict[str, float]:
        means = {}
        for name in SIGNS:
            counts, sums = zip(*self.sums.get((exponent, name), [[0, 0.0]]), strict=True)
            if sum(counts):
                means[f"mean_{name}"] = math.fsum(sums) / sum(counts)
        return means


def _sizes(sides: dict[int, SignedLogCounts]) -> LogCounts:
    """Deviations of both sides without their signs."""
    together = LogCounts()
    for signed in sides.values():
        together.add(signed.below)
        together.add(signed.above)
    return together

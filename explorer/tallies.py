"""Counts of many samples that can be added up: what a chunk says of samples that it does not keep."""

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.states import Array
from explorer.statistics import ONE_SIGMA, QUANTILES

PER_DECADE = 400  # bins of logarithmic counts: a quantile is good to 0.3 %


class LogCounts:
    """Counts of magnitudes in logarithmic bins, with the smallest and largest; zeros on their own.

    A magnitude v lies in bin floor(PER_DECADE log10 v). Counts are exact integers, so the order in
    which chunks are added does not matter.
    """

    def __init__(self, state: dict[str, Any] | None = None) -> None:
        self.counts: dict[int, int] = {}
        self.zeros = 0
        self.smallest, self.largest = np.inf, -np.inf
        if state is not None:
            self.counts = dict(zip(state["bins"], state["counts"], strict=True))
            self.zeros = state["zeros"]
            if state["range"]:
                self.smallest, self.largest = state["range"]

    @classmethod
    def of(cls, values: Array) -> "LogCounts":
        """Counts of the finite ones of non-negative values."""
        made = cls()
        values = values[np.isfinite(values)]
        if values.size == 0:
            return made
        made.smallest, made.largest = float(values.min()), float(values.max())
        positive = values[values > 0.0]
        made.zeros = int(values.size - positive.size)
        bins = np.floor(PER_DECADE * np.log10(positive)).astype(np.int64)
        numbers, counts = np.unique(bins, return_counts=True)
        made.counts = dict(zip(numbers.tolist(), counts.tolist(), strict=True))
        return made

    def add(self, other: "LogCounts") -> None:
        for number, count in other.counts.items():
            self.counts[number] = self.counts.get(number, 0) + count
        self.zeros += other.zeros
        self.smallest, self.largest = min(self.smallest, other.smallest), max(self.largest, other.largest)

    @property
    def total(self) -> int:
        return self.zeros + sum(self.counts.values())

    def state(self) -> dict[str, Any]:
        """Ready for JSON."""
        bins = sorted(self.counts)
        return {
            "bins": bins,
            "counts": [self.counts[number] for number in bins],
            "zeros": self.zeros,
            "range": [self.smallest, self.largest] if self.total else [],
        }

    def cumulative(self) -> tuple[Array, NDArray[np.int64]]:
        """Upper edges of the bins that hold something, and how many values lie below each."""
        bins = np.array(sorted(self.counts), dtype=np.int64)
        counts = np.array([self.counts[number] for number in bins.tolist()], dtype=np.int64)
        edges = 10.0 ** ((bins + 1) / PER_DECADE)
        return np.minimum(edges, self.largest), self.zeros + np.cumsum(counts)

    def quantile(self, q: float) -> float:
        """The value below which a share q lies, to the width of a bin; ends are exact. NaN where empty."""
        if not self.total:
            return float("nan")
        if q <= 0.0:
            return self.smallest
        if q >= 1.0:
            return self.largest
        edges, below = self.cumulative()
        wanted = q * self.total
        if wanted <= self.zeros:
            return 0.0
        i = int(np.searchsorted(below, wanted))
        before = below[i - 1] if i else self.zeros
        inside = (wanted - before) / (below[i] - before)
        value = edges[i] * 10.0 ** ((inside - 1.0) / PER_DECADE)
        return float(min(max(value, self.smallest), self.largest))

    def quantiles(self) -> dict[str, float]:
        """Named quantiles; empty where nothing was counted."""
        return {f"{q:g}": self.quantile(q) for q in QUANTILES} if self.total else {}


class SignedLogCounts:
    """Counts of signed values by logarithmic magnitude: two LogCounts."""

    def __init__(self, state: dict[str, Any] | None = None) -> None:
        self.below = LogCounts(state["below"] if state else None)
        self.above = LogCounts(state["above"] if state else None)

    @classmethod
    def of(cls, values: Array) -> "SignedLogCounts":
        made = cls()
        made.below, made.above = LogCounts.of(-values[values < 0.0]), LogCounts.of(values[values >= 0.0])
        return made

    def add(self, other: "SignedLogCounts") -> None:
        self.below.add(other.below)
        self.above.add(other.above)

    @property
    def total(self) -> int:
        return self.below.total + self.above.total

    def state(self) -> dict[str, Any]:
        return {"below": self.below.state(), "above": self.above.state()}

    def quantile(self, q: float) -> float:
        """As LogCounts.quantile."""
        if not self.total:
            return float("nan")
        share = self.below.total / self.total
        if q < share:
            return -self.below.quantile(1.0 - q / share)
        return self.above.quantile((q - share) / (1.0 - share)) if share < 1.0 else 0.0

    def half_width(self) -> float:
        """Half the width of the central 68.27 %: the standard deviation of a normal sample, robust to tails."""
        low, high = (self.quantile(percent / 100.0) for percent in ONE_SIGMA)
        return 0.5 * (high - low)


def pack(values: NDArray[np.uint16]) -> str:
    """An array of small integers as text."""
    return base64.b85encode(zlib.compress(values.astype("<u2").tobytes(), 1)).decode()


def unpack(text: str) -> NDArray[np.uint16]:
    """What `pack` was given, flat."""
    return np.frombuffer(zlib.decompress(base64.b85decode(text)), dtype="<u2")


CELLS_PER_DECADE = 12


def count_cells(x: Array, y: Array) -> list[list[int]]:
    """[i, j, count] of cells of CELLS_PER_DECADE per decade in both of two positive magnitudes."""
    good = np.isfinite(x) & np.isfinite(y) & (x > 0.0) & (y > 0.0)
    i, j = (np.floor(CELLS_PER_DECADE * np.log10(v[good])).astype(np.int64) for v in (x, y))
    cells, counts = np.unique(np.stack([i, j]), axis=1, return_counts=True)
    return np.column_stack([cells.T, counts]).tolist()


def merged(chunks: Any, name: str) -> LogCounts:
    """The LogCounts called `name` of all chunks together."""
    total = LogCounts()
    for tally in chunks.tallies():
        total.add(LogCounts(tally[name]))
    return total

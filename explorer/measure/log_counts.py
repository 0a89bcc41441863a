"""Counts of many samples that can be added up: a chunk has them of samples whose rows it does not keep."""

import binascii
import math
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure.statistics import ONE_SIGMA, QUANTILES
from explorer.phase.states import Array

PER_DECADE = 400  # bins of logarithmic counts: a quantile is good to half a bin, 0.3 %
LOWEST_BIN = -330 * PER_DECADE  # which no double reaches
# Digits of base 85, what each character stands for (-1: nothing), and what each place is worth.
_DIGITS = np.frombuffer(
    b"0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~", np.uint8
)
_VALUES = np.full(256, -1, np.int64)
_VALUES[_DIGITS] = np.arange(85)
_POWERS = 85 ** np.arange(4, -1, -1)
_WIDTHS = ("<u1", "<u2", "<u4", "<u8")
_MARGIN = PER_DECADE // 2  # bins by which rows grow further than they must
_NONE = "1"  # no numbers, as `_written` has it
_KINDS = {kind[-1]: np.dtype(kind) for kind in _WIDTHS}


class LogCounts:
    """Counts of magnitudes in logarithmic bins, with the smallest and largest; zeros on their own.

    A magnitude v lies in bin floor(PER_DECADE log10 v); counts[i] is of bin first + i. Counts are exact
    integers, so the order in which chunks are added does not matter.
    """

    def __init__(self, state: dict[str, Any] | None = None) -> None:
        self.first, self.counts = 0, np.zeros(0, np.int64)
        self.zeros = 0
        self.smallest, self.largest = np.inf, -np.inf
        if state is not None and state["range"]:
            self.zeros = state["zeros"]
            self.smallest, self.largest = state["range"]
            if "bins" in state:  # as it was written before numbers were packed
                counts, places = np.array(state["counts"], np.int64), np.array(state["bins"], np.int64)
            else:
                counts, gaps = _unpacked(state["counts"]), _unpacked(state["gaps"])
                places = state["first"] + np.concatenate([[0], gaps.cumsum(dtype=np.int64)])
            if counts.size:
                self.first = int(places[0])
                self.counts = np.zeros(int(places[-1]) - self.first + 1, np.int64)
                self.counts[places - self.first] = counts

    @classmethod
    def of(cls, values: Array) -> "LogCounts":
        """Counts of the finite ones of non-negative values."""
        made = cls()
        if not np.isfinite(np.max(values, initial=0.0)):  # of NaN too
            values = values[np.isfinite(values)]
        if values.size == 0:
            return made
        made.smallest, made.largest = float(values.min()), float(values.max())
        positive = values if made.smallest > 0.0 else values[values > 0.0]
        made.zeros = int(values.size - positive.size)
        if positive.size:
            places = np.log10(positive)
            places *= PER_DECADE
            np.floor(places, out=places)
            made.first = int(places.min())
            places -= made.first
            made.counts = np.bincount(places.astype(np.int64))
        return made

    @classmethod
    def of_row(cls, first: int, row: NDArray[np.int32], zeros: int | np.int64, ends: Array) -> "LogCounts":
        """Counts of bins from `first` on, most of which may hold nothing."""
        made, filled = cls(), np.flatnonzero(row != 0)  # of booleans: twelve times as fast
        made.zeros = int(zeros)
        made.smallest, made.largest = ends.tolist()
        if filled.size:
            made.first = int(first + filled[0])
            made.counts = row[filled[0] : filled[-1] + 1].astype(np.int64)
        return made

    def add(self, other: "LogCounts") -> None:
        self.zeros += other.zeros
        self.smallest, self.largest = min(self.smallest, other.smallest), max(self.largest, other.largest)
        if not other.counts.size:
            return
        if not self.counts.size:
            self.first = other.first
        first = min(self.first, other.first)
        end = max(self.first + self.counts.size, other.first + other.counts.size)
        if first < self.first or end > self.first + self.counts.size:
            wider = np.zeros(end - first, np.int64)
            wider[self.first - first :][: self.counts.size] = self.counts
            self.first, self.counts = first, wider
        self.counts[other.first - first :][: other.counts.size] += other.counts

    @property
    def total(self) -> int:
        return self.zeros + int(self.counts.sum())

    def state(self) -> dict[str, Any]:
        """Ready for JSON: the first bin, how far each next one is, and their counts.

        Numbers are packed: a chunk has some ten thousand bins, and as JSON they took as long as its passages.
        """
        filled = self.counts.nonzero()[0]
        return {
            "first": int(self.first + filled[0]) if filled.size else 0,
            "gaps": _written(filled[1:] - filled[:-1]),
            "counts": _written(self.counts[filled]),
            "zeros": self.zeros,
            "range": [self.smallest, self.largest] if self.total else [],
        }

    def cumulative(self) -> tuple[Array, NDArray[np.int64]]:
        """Upper edges of the bins that hold something, and how many values lie below each."""
        filled = np.flatnonzero(self.counts)
        edges = 10.0 ** ((filled + self.first + 1) / PER_DECADE)
        return np.minimum(edges, self.largest), self.zeros + np.cumsum(self.counts[filled])

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

    @classmethod
    def by_group(cls, values: Array, groups: Array) -> "dict[int, SignedLogCounts]":
        """Counts of the finite ones of values by group, a whole number; none where that is not finite."""
        rows = LogRows()
        rows.add(values, groups)
        return rows.counts()

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


class LogRows:
    """Counts of signed values by group, added block by block: a row of bins for each group and sign."""

    def __init__(self) -> None:
        self._lowest, self._first = 0, 0
        self._rows, self._zeros = np.zeros((0, 0), np.int32), np.zeros(0, np.int64)
        self._sizes = np.zeros((0, 2))

    def add(self, values: Array, groups: Array) -> None:
        """Count the finite ones of values by group, a whole number; none where that is not finite."""
        places = abs(values)
        with np.errstate(divide="ignore"):
            np.log10(places, out=places)
        places *= PER_DECADE
        self._make_room(_ends(groups), _ends(places))
        sizes, rows = compiled.counting.Sizes(values, places, groups), self._rows.reshape(-1)
        compiled.counting.log_count_batch(sizes, self._lowest, self._first, rows, self._zeros, self._sizes)

    def _make_room(self, groups: tuple[int, int], bins: tuple[int, int]) -> None:
        """Have rows of these groups, from the first to the last, and in them these bins."""
        (lowest, highest), (first, last), (count, width) = groups, bins, self._rows.shape
        if count:
            lowest, highest = min(lowest, self._lowest), max(highest, self._lowest + count // 2 - 1)
            if first < self._first or last >= self._first + width:  # the next block may go a little further
                first, last = min(first - _MARGIN, self._first), max(last + _MARGIN, self._first + width - 1)
            else:
                first, last = self._first, self._first + width - 1
        shape = 2 * (highest - lowest + 1), last - first + 1
        if shape == self._rows.shape:
            return
        rows, zeros = np.zeros(shape, np.int32), np.zeros(shape[0], np.int64)
        sizes = np.tile([np.inf, -np.inf], (shape[0], 1))
        there = slice(2 * (self._lowest - lowest), 2 * (self._lowest - lowest) + count)
        if count:
            rows[there, self._first - first :][:, :width] = self._rows
            zeros[there], sizes[there] = self._zeros, self._sizes
        self._rows, self._zeros, self._sizes, self._lowest, self._first = rows, zeros, sizes, lowest, first

    def counts(self) -> dict[int, SignedLogCounts]:
        """What was counted, by group; also of groups between the others that hold nothing."""
        rows = zip(self._rows, self._zeros, self._sizes, strict=True)
        made = [LogCounts.of_row(self._first, *row) for row in rows]
        both = {}
        for group, (below, above) in enumerate(zip(made[::2], made[1::2], strict=True), self._lowest):
            both[group] = SignedLogCounts()
            both[group].below, both[group].above = below, above
        return both


def _ends(places: Array) -> tuple[int, int]:
    """The smallest and the largest of the finite ones, rounded down; zeros where there is none."""
    low, high = np.fmin.reduce(places, initial=np.inf), np.fmax.reduce(places, initial=-np.inf)  # pass NaN over
    if not (np.isfinite(low) and np.isfinite(high)):
        known = places[np.isfinite(places)]
        low, high = (known.min(), known.max()) if known.size else (0.0, 0.0)
    return math.floor(low), math.floor(high)


def _written(values: NDArray[np.int64]) -> str:
    """Numbers that are not negative as text, in as few bytes each as the largest needs; that width comes first."""
    if not values.size:
        return _NONE
    bits = int(np.maximum.reduce(values)).bit_length()
    kind = next(width for width in _WIDTHS if bits <= 8 * int(width[-1]))
    return kind[-1] + binascii.b2a_base64(values.astype(kind).tobytes(), newline=False).decode("ascii")


def _unpacked(text: str) -> NDArray[Any]:
    """The numbers that `_written` was given."""
    return np.frombuffer(binascii.a2b_base64(text[1:]), _KINDS[text[0]])


def pack(values: NDArray[np.uint16]) -> str:
    """An array of small integers as text."""
    return _to_base_85(zlib.compress(values.astype("<u2").tobytes(), 1))


def unpack(text: str) -> NDArray[np.uint16]:
    """The array that `pack` was given, flat."""
    return np.frombuffer(zlib.decompress(_from_base_85(text)), dtype="<u2")


def _to_base_85(data: bytes) -> str:
    """As `base64.b85encode`, whose loops over words took milliseconds for each chunk of falling-set."""
    padding = -len(data) % 4
    words = np.frombuffer(data + bytes(padding), ">u4").astype(np.int64)
    text = bytes(_DIGITS[words[:, None] // _POWERS % 85])
    return text[: len(text) - padding].decode()


def _from_base_85(text: str) -> bytes:
    """As `base64.b85decode`."""
    padding = -len(text) % 5
    digits = _VALUES[np.frombuffer(text.encode() + b"~" * padding, np.uint8)].reshape(-1, 5)
    words = digits @ _POWERS
    return words.astype(">u4").tobytes()[: 4 * words.size - padding]

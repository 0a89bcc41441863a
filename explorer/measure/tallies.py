"""What is counted of samples, declared once: fields that add up, from which sums, JSON and merging follow.

    class RaceCounts(Tally):
        wrong_way: int
        angles: ByName[Histogram]
        impact_speed: LogHistogram

`RaceCounts()` is empty. Chunks are added in order, whichever was computed first, so that sums of
doubles are the same for any number of workers too.
"""

import base64
import math
import zlib
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Generic, Self, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.measure.statistics import ONE_SIGMA, QUANTILES
from explorer.phase.states import Array

K = TypeVar("K")
PER_DECADE = 400  # bins of logarithmic counts: a quantile is good to half a bin, 0.3 %
LOWEST_BIN = -330 * PER_DECADE  # which no double reaches
_MARGIN = PER_DECADE // 2  # bins by which rows grow further than they must


class Tally:
    """Counts of samples; a subclass names its fields: int, float, list, ByName or a class of this file."""

    kinds: ClassVar[dict[str, Any]] = {}

    def __init_subclass__(cls) -> None:
        hints = get_type_hints(cls)
        cls.kinds = {name: kind for name, kind in hints.items() if get_origin(kind) is not ClassVar}

    def __init__(self, **fields: Any) -> None:
        for name, kind in self.kinds.items():
            setattr(self, name, fields[name] if name in fields else _made(kind))

    def __add__(self, other: Self) -> Self:
        return type(self)(**{name: getattr(self, name) + getattr(other, name) for name in self.kinds})

    def state(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {name: _state_of(getattr(self, name)) for name in self.kinds}

    @classmethod
    def of_state(cls, state: dict[str, Any]) -> Self:
        """The tally that had this state."""
        return cls(**{name: _made(kind, state[name]) for name, kind in cls.kinds.items()})


def _made(kind: Any, *state: Any) -> Any:
    """An empty count of a kind, or the one with this state."""
    if get_origin(kind) is ByName:
        return ByName(get_args(kind)[0], *state)
    return kind.of_state(*state) if state and kind is LogHistogram else kind(*state)


def _state_of(value: Any) -> Any:
    return value if isinstance(value, int | float | list) else value.state()


class ByName(dict[str, Any], Generic[K]):
    """Counts of one kind by name; a name that is new has an empty one."""

    def __init__(self, kind: Any = int, state: Mapping[str, Any] | None = None) -> None:
        super().__init__({name: _made(kind, item) for name, item in (state or {}).items()})
        self.kind = kind

    def __missing__(self, name: str) -> Any:
        self[name] = _made(self.kind)
        return self[name]

    def __add__(self, other: Mapping[str, Any]) -> "ByName[K]":
        both: ByName[K] = ByName(self.kind)
        for name in sorted({*self, *other}):
            both[name] = self.get(name, _made(self.kind)) + other.get(name, _made(self.kind))
        return both

    def state(self) -> dict[str, Any]:
        return {name: _state_of(value) for name, value in self.items()}


class Histogram:
    """Counts (bins + 1) between edges that whoever counts knows; the last is of what lies outside."""

    def __init__(self, counts: Any = (0,)) -> None:
        known = unpacked(counts) if isinstance(counts, str) else counts
        self.counts: NDArray[np.int64] = np.asarray(known, np.int64)

    def __add__(self, other: "Histogram") -> "Histogram":
        if min(self.counts.size, other.counts.size) == 1:  # an empty one does not know how many bins there are
            return self if self.counts.size > 1 else other
        return Histogram(self.counts + other.counts)

    def state(self) -> str:
        return packed(self.counts)


class Least(Histogram):
    """The smallest code, a whole number below NONE, in each cell of a map; NONE where there is none."""

    NONE = 65535

    def __init__(self, codes: Any = (NONE,)) -> None:
        super().__init__(codes)

    def __add__(self, other: Histogram) -> "Least":
        return Least(np.minimum(self.counts, other.counts))  # an empty map is one cell


class LogRow:
    """Counts of sizes by their logarithm, bin k from 10^(k/PER_DECADE) on; with the smallest and the largest size.

    first: the bin of counts[0]. zeros: how many sizes are 0.
    """

    def __init__(self, first: int, counts: NDArray[np.int64], zeros: int, smallest: float, largest: float) -> None:
        self.first, self.counts, self.zeros = first, counts, zeros
        self.smallest, self.largest = smallest, largest
        self.total = zeros + int(counts.sum())

    def cumulative(self) -> tuple[Array, NDArray[np.int64]]:
        """Upper edges of the bins that hold something, and how many sizes lie below each."""
        filled = np.flatnonzero(self.counts)
        edges = 10.0 ** ((filled + self.first + 1) / PER_DECADE)
        return np.minimum(edges, self.largest), self.zeros + np.cumsum(self.counts[filled])

    def quantile(self, q: float) -> float:
        """The size below which a share q lies, to the width of a bin; ends are exact. NaN where empty."""
        if not self.total:
            return math.nan
        if q <= 0.0 or q >= 1.0:
            return self.smallest if q <= 0.0 else self.largest
        wanted = q * self.total
        if wanted <= self.zeros:
            return 0.0
        edges, below = self.cumulative()
        i = int(np.searchsorted(below, wanted))
        before = below[i - 1] if i else self.zeros
        inside = (wanted - before) / (below[i] - before)
        value = edges[i] * 10.0 ** ((inside - 1.0) / PER_DECADE)
        return float(min(max(value, self.smallest), self.largest))

    def quantiles(self) -> dict[str, float]:
        """Named quantiles; empty where nothing was counted."""
        return {f"{q:g}": self.quantile(q) for q in QUANTILES} if self.total else {}


class LogHistogram:
    """Counts of signed numbers by group, a whole number, and by the logarithm of their size.

    Rows 2 (g - lowest) and 2 (g - lowest) + 1 of counts (rows, bins), zeros (rows) and ends (rows, 2) are of the
    negative numbers of group g and of the others; bins as in `LogRow`, from bin `first` on.
    """

    KERNELS = ("counting.log_count_batch",)

    def __init__(
        self, lowest: int = 0, first: int = 0, counts: Any = None, zeros: Any = None, ends: Any = None
    ) -> None:
        self.lowest, self.first = lowest, first
        self.counts: NDArray[Any] = np.zeros((0, 0), np.int32) if counts is None else counts
        self.zeros: NDArray[np.int64] = np.zeros(0, np.int64) if zeros is None else zeros
        self.ends: Array = np.zeros((0, 2)) if ends is None else ends

    @classmethod
    def of_sizes(cls, first: int, counts: NDArray[Any], zeros: int, ends: Array) -> "LogHistogram":
        """Of one group and no negative number, counted elsewhere."""
        filled = np.flatnonzero(counts != 0)  # of booleans: twelve times as fast
        start, end = (int(filled[0]), int(filled[-1]) + 1) if filled.size else (0, 0)
        made = cls()._moved((0, 0), (first + start, first + end - 1), np.int64)
        made.counts[1], made.zeros[1], made.ends[1] = counts[start:end], zeros, ends
        return made

    def count(self, values: Array, groups: Array | None = None) -> None:
        """Count the finite ones of numbers; none of a group that is not finite."""
        groups = np.zeros(values.size) if groups is None else groups
        places = abs(values)
        with np.errstate(divide="ignore"):
            np.log10(places, out=places)
        places *= PER_DECADE
        self._make_room(_reach(groups), _reach(places))
        sizes = compiled.counting.Sizes(values, places, groups)
        rows = self.counts.reshape(-1)
        compiled.counting.log_count_batch(sizes, self.lowest, self.first, rows, self.zeros, self.ends)

    def _make_room(self, groups: tuple[int, int], bins: tuple[int, int]) -> None:
        """Have rows of these groups, from the first to the last, and in them these bins."""
        (low, high), (first, last), (rows, width) = groups, bins, self.counts.shape
        if rows:
            low, high = min(low, self.lowest), max(high, self.lowest + rows // 2 - 1)
            if first < self.first or last >= self.first + width:  # the next block may go a little further
                first, last = min(first - _MARGIN, self.first), max(last + _MARGIN, self.first + width - 1)
            else:
                first, last = self.first, self.first + width - 1
        if (2 * (high - low + 1), last - first + 1) != (rows, width) or self.counts.dtype != np.int32:
            vars(self).update(vars(self._moved((low, high), (first, last), np.int32)))

    def _moved(self, groups: tuple[int, int], bins: tuple[int, int], kind: Any) -> "LogHistogram":
        """The same counts with rows for these groups, and in them these bins; ends of ranges included."""
        (low, high), (first, last), (many, width) = groups, bins, self.counts.shape
        rows = 2 * (high - low + 1)
        ends = np.tile([np.inf, -np.inf], (rows, 1))
        new = LogHistogram(low, first, np.zeros((rows, last - first + 1), kind), np.zeros(rows, np.int64), ends)
        if many:
            there = slice(2 * (self.lowest - low), 2 * (self.lowest - low) + many)
            new.counts[there, self.first - first :][:, :width] = self.counts
            new.zeros[there], new.ends[there] = self.zeros, self.ends
        return new

    def __add__(self, other: "LogHistogram") -> "LogHistogram":
        if not (self.zeros.size and other.zeros.size):
            return self if self.zeros.size else other
        groups = min(self.groups[0], other.groups[0]), max(self.groups[-1], other.groups[-1])
        first = min(self.first, other.first)
        last = max(each.first + each.counts.shape[1] for each in (self, other)) - 1
        a, b = (each._moved(groups, (first, last), np.int64) for each in (self, other))
        ends = np.column_stack([np.minimum(a.ends, b.ends)[:, 0], np.maximum(a.ends, b.ends)[:, 1]])
        return LogHistogram(groups[0], first, a.counts + b.counts, a.zeros + b.zeros, ends)

    def state(self) -> list[Any]:
        bins = np.flatnonzero(self.counts.any(axis=0))  # only what holds something is written
        first, end = (int(bins[0]), int(bins[-1]) + 1) if bins.size else (0, 0)
        ends = [[None if math.isinf(end) else end for end in row] for row in self.ends.tolist()]
        return [self.lowest, self.first + first, packed(self.counts[:, first:end]), self.zeros.tolist(), ends]

    @classmethod
    def of_state(cls, state: list[Any]) -> "LogHistogram":
        lowest, first, counts, zeros, ends = state
        if not zeros:
            return cls()
        known = [[np.inf if low is None else low, -np.inf if high is None else high] for low, high in ends]
        return cls(
            lowest, first, unpacked(counts).reshape(len(zeros), -1), np.array(zeros, np.int64), np.array(known)
        )

    @property
    def total(self) -> int:
        return int(self.zeros.sum() + self.counts.sum())

    @property
    def groups(self) -> range:
        return range(self.lowest, self.lowest + self.zeros.size // 2)

    def part(self, groups: Iterable[int]) -> "LogHistogram":
        """What was counted of some groups, as of one."""
        chosen = [group - self.lowest for group in groups if group in self.groups]
        of_signs = len(self.groups), 2
        counts, zeros, ends = (
            each.reshape(*of_signs, *each.shape[1:])[chosen] for each in (self.counts, self.zeros, self.ends)
        )
        low, high = ends.min(axis=0, initial=np.inf)[:, 0], ends.max(axis=0, initial=-np.inf)[:, 1]
        return LogHistogram(
            0, self.first, counts.sum(axis=0, dtype=np.int64), zeros.sum(axis=0), np.column_stack([low, high])
        )

    def row(self, *, below: bool = True, above: bool = True) -> LogRow:
        """Sizes of the negative numbers, of the others or of both."""
        chosen = [row for row in range(self.zeros.size) if (below, above)[row % 2]]
        counts, ends = self.counts[chosen].sum(axis=0, dtype=np.int64), self.ends[chosen]
        smallest, largest = ends[:, 0].min(initial=np.inf), ends[:, 1].max(initial=-np.inf)
        return LogRow(self.first, counts, int(self.zeros[chosen].sum()), float(smallest), float(largest))

    def quantile(self, q: float) -> float:
        """The number below which a share q lies, as `LogRow.quantile`."""
        below, above = self.row(above=False), self.row(below=False)
        if not below.total + above.total:
            return math.nan
        share = below.total / (below.total + above.total)
        if q < share:
            return -below.quantile(1.0 - q / share)
        return above.quantile((q - share) / (1.0 - share)) if share < 1.0 else 0.0

    def half_width(self) -> float:
        """Half the width of the central 68.27 %: the standard deviation of a normal sample, robust to tails."""
        low, high = (self.quantile(percent / 100.0) for percent in ONE_SIGMA)
        return 0.5 * (high - low)


def _reach(places: Array) -> tuple[int, int]:
    """The smallest and the largest of the finite ones, rounded down; zeros where there is none."""
    low, high = np.fmin.reduce(places, initial=np.inf), np.fmax.reduce(places, initial=-np.inf)  # pass NaN over
    if not (np.isfinite(low) and np.isfinite(high)):
        known = places[np.isfinite(places)]
        low, high = (known.min(), known.max()) if known.size else (0.0, 0.0)
    return math.floor(low), math.floor(high)


def packed(counts: NDArray[Any]) -> str:
    """Counts as text: their width in bytes, as many as the largest needs, and then they, compressed."""
    small = np.ascontiguousarray(counts, np.min_scalar_type(int(counts.max(initial=0))))
    return f"{small.itemsize}{base64.b64encode(zlib.compress(small.tobytes(), 1)).decode()}"


def unpacked(text: str) -> NDArray[Any]:
    """The counts that `packed` was given, flat."""
    return np.frombuffer(zlib.decompress(base64.b64decode(text[1:])), f"<u{text[0]}")

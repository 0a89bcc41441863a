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
from typing import Any, ClassVar, Generic, NamedTuple, Self, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import plain_number
from explorer.phase.states import Array

K = TypeVar("K")
KERNELS = ("counting.histogram_batch",)  # of `histograms`
QUANTILES = (0.0, 0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
PER_DECADE = 400  # bins of logarithmic counts: a quantile is good to half a bin, 0.3 %
NO_ENDS = (math.inf, -math.inf)  # the smallest and the largest of nothing


class Tally:
    """Counts of samples; a subclass names its fields: int, float, list, ByName or a class of this file."""

    kinds: ClassVar[dict[str, Any]] = {}

    def __init_subclass__(cls) -> None:
        hints = get_type_hints(cls)
        cls.kinds = {name: kind for name, kind in hints.items() if get_origin(kind) is not ClassVar}
        bare = [name for name, value in vars(cls).items() if isinstance(value, int) and name not in cls.kinds]
        if bare:  # which would not add up
            raise TypeError(f"{cls.__name__}.{bare[0]} has no kind; write {bare[0]}: int")

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
    value = plain_number(value)  # a sum of NumPy
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


class LogRow(NamedTuple):
    """Counts of sizes by their logarithm, bin k from 10^(k/PER_DECADE) on; with the smallest and the largest size.

    first: the bin of counts[0]. zeros: how many sizes are 0.
    """

    first: int
    counts: NDArray[np.int64]
    zeros: int
    smallest: float
    largest: float

    @property
    def total(self) -> int:
        return self.zeros + int(self.counts.sum())

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

    counts (groups, 2, bins), zeros (groups, 2) and ends (groups, 2, 2), the smallest and the largest size, are of
    group `lowest` and those after it: of the negative numbers of each, and of the others. Bins are those of
    `LogRow`, from bin `first` on.
    """

    KERNELS = ("counting.log_count_batch",)

    def __init__(
        self, lowest: int = 0, first: int = 0, counts: Any = ((),), zeros: Any = (), ends: Any = ()
    ) -> None:
        groups = np.size(zeros) // 2
        self.lowest, self.first = lowest, first
        self.counts: NDArray[Any] = np.reshape(counts, (groups, 2, np.shape(counts)[-1]))
        self.zeros: NDArray[np.int64] = np.reshape(np.asarray(zeros, np.int64), (groups, 2))
        self.ends: Array = np.reshape(ends, (groups, 2, 2))

    def count(self, values: Array, groups: Array | None = None) -> None:
        """Count the finite ones of numbers; none of a group that is not finite."""
        with np.errstate(divide="ignore"):
            places = np.log10(abs(values))
        places *= PER_DECADE
        low, high = (0, 0) if groups is None else _reach(groups)
        first, last = _reach(places)
        missing = self.groups.start > low or self.groups.stop <= high
        if missing or self.first > first or self.first + self.counts.shape[2] <= last:
            wider = self + LogHistogram(low, first, *_empty((high - low + 1, 2), last - first + 1))
            vars(self).update(vars(wider))
        sizes = compiled.counting.Sizes(values, places, np.zeros(values.size) if groups is None else groups)
        flat = self.counts.reshape(-1), self.zeros.reshape(-1), self.ends.reshape(-1, 2)
        compiled.counting.log_count_batch(sizes, self.lowest, self.first, *flat)

    def __add__(self, other: "LogHistogram") -> "LogHistogram":
        if not (self.groups and other.groups):
            return self if self.groups else other
        lowest, first = min(self.lowest, other.lowest), min(self.first, other.first)
        groups = max(self.groups.stop, other.groups.stop) - lowest
        bins = max(each.first + each.counts.shape[2] for each in (self, other)) - first
        counts, zeros, ends = _empty((groups, 2), bins)
        for each in (self, other):
            rows = slice(each.lowest - lowest, each.groups.stop - lowest)
            counts[rows, :, each.first - first :][..., : each.counts.shape[2]] += each.counts
            zeros[rows] += each.zeros
            ends[rows, :, 0] = np.minimum(ends[rows, :, 0], each.ends[..., 0])
            ends[rows, :, 1] = np.maximum(ends[rows, :, 1], each.ends[..., 1])
        return LogHistogram(lowest, first, counts, zeros, ends)

    def state(self) -> list[Any]:
        bins = np.flatnonzero(self.counts.any(axis=(0, 1)))  # only what holds something is written
        first, end = (int(bins[0]), int(bins[-1]) + 1) if bins.size else (0, 0)
        ends = np.where(np.isinf(self.ends), None, self.ends).reshape(-1, 2)  # type: ignore[call-overload]
        counts = packed(self.counts[..., first:end])
        return [self.lowest, self.first + first, counts, self.zeros.ravel().tolist(), ends.tolist()]

    @classmethod
    def of_state(cls, state: list[Any]) -> "LogHistogram":
        lowest, first, counts, zeros, ends = state
        if not zeros:
            return cls()
        known = np.array(ends, np.float64)  # NaN for None
        return cls(
            lowest,
            first,
            unpacked(counts).reshape(len(zeros), -1),
            zeros,
            np.where(np.isnan(known), NO_ENDS, known),
        )

    @property
    def total(self) -> int:
        return int(self.zeros.sum() + self.counts.sum())

    @property
    def groups(self) -> range:
        return range(self.lowest, self.lowest + len(self.zeros))

    def part(self, groups: Iterable[int]) -> "LogHistogram":
        """What was counted of some groups, as of one."""
        chosen = [group - self.lowest for group in groups if group in self.groups]
        low, high = np.moveaxis(self.ends[chosen], -1, 0)
        ends = np.column_stack([low.min(axis=0, initial=np.inf), high.max(axis=0, initial=-np.inf)])
        counts, zeros = self.counts[chosen].sum(axis=0, dtype=np.int64), self.zeros[chosen].sum(axis=0)
        return LogHistogram(0, self.first, counts, zeros, ends)

    def row(self, *, below: bool = True, above: bool = True) -> LogRow:
        """Sizes of the negative numbers, of the others or of both."""
        signs = [sign for sign, wanted in enumerate((below, above)) if wanted]
        counts, zeros = self.counts[:, signs].sum(axis=(0, 1), dtype=np.int64), int(self.zeros[:, signs].sum())
        low, high = self.ends[:, signs, 0].min(initial=np.inf), self.ends[:, signs, 1].max(initial=-np.inf)
        return LogRow(self.first, counts, zeros, float(low), float(high))

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
        low, high = (self.quantile(0.5 + sign * 0.5 * math.erf(0.5**0.5)) for sign in (-1, 1))
        return 0.5 * (high - low)


def _empty(rows: tuple[int, int], bins: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Counts, zeros and ends of a `LogHistogram` in which there is nothing."""
    return np.zeros((*rows, bins), np.int64), np.zeros(rows, np.int64), np.tile(NO_ENDS, (*rows, 1))


def _reach(places: Array) -> tuple[int, int]:
    """The smallest and the largest of the finite ones, rounded down; zeros where there is none."""
    known = places[np.isfinite(places)]
    return (math.floor(known.min()), math.floor(known.max())) if known.size else (0, 0)


def packed(counts: NDArray[Any]) -> str:
    """Counts as text: their width in bytes, as many as the largest needs, and then they, compressed."""
    small = np.ascontiguousarray(counts, np.min_scalar_type(int(counts.max(initial=0))))
    return f"{small.itemsize}{base64.b64encode(zlib.compress(small.tobytes(), 1)).decode()}"


def unpacked(text: str) -> NDArray[Any]:
    """The counts that `packed` was given, flat."""
    return np.frombuffer(zlib.decompress(base64.b64decode(text[1:])), f"<u{text[0]}")


# Counts of a block of samples


def histograms(values: Array, groups: NDArray[np.int64], edges: Array, count: int) -> NDArray[np.int32]:
    """Histograms (count, bins + 1) of the finite ones of values by group, 0 ... count - 1; -1 belongs nowhere.

    Edges are equally spaced; what lies outside comes last in each row.
    """
    counts = np.zeros((count, edges.size), np.int32)
    compiled.counting.histogram_batch(values, groups, edges, counts.reshape(-1))
    return counts

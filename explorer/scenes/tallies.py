"""Checks of the counts of a chunk, whose footer anyone may have written: kinds, bounds and lengths."""

import sys
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

from explorer import compiled
from explorer.errors import shown
from explorer.measure.log_counts import LogCounts

_STATUSES = frozenset(code.name.lower() for code in compiled.status.Status)
_MOST_BINS = 1 << 24  # that all logarithmic counts of a chunk may span: 128 MB once they are unpacked


class CountError(ValueError):
    """A count is none; the message says which."""


@dataclass
class Counts:
    """Reads the counts of a chunk of so many rows, none of which is above that. Every method raises CountError.

    spanned: bins of the logarithmic counts read so far.
    """

    most: int
    spanned: int = field(default=0, init=False)

    def entries(self, what: str, value: Any, names: Collection[str]) -> dict[str, Any]:
        """An object with these entries and no others."""
        found = self.named(what, value)
        strange = sorted(set(found) ^ set(names))
        if strange:
            state = "unknown" if strange[0] in found else "missing"
            raise CountError(f"its {what}: {shown(strange[0])} is {state}")
        return found

    def named(self, what: str, value: Any) -> dict[str, Any]:
        """An object with any entries."""
        if not isinstance(value, dict):
            raise CountError(f"its {what} is {shown(value)}, which is no object")
        return value

    def count(self, what: str, value: Any) -> int:
        """A whole number from 0 to `most`."""
        if type(value) is not int or not 0 <= value <= self.most:
            raise CountError(f"its {what} is {shown(value)}, which is no count up to {self.most:,}")
        return value

    def counts(self, what: str, value: Any, names: Collection[str]) -> int:
        """Counts by name, whose sum is not above `most` either; the sum."""
        found = self.entries(what, value, names)
        return self.count(f"sum of {what}", sum(self.count(f"{what}: {name}", found[name]) for name in names))

    def statuses(self, value: Any, others: Collection[str] = ()) -> int:
        """Counts of statuses, by name and of those that occur; their sum."""
        found = self.named("status", value)
        for name in found:
            if name not in _STATUSES and name not in others:
                raise CountError(f"its status: {shown(name)} is none")
        return self.counts("status", found, found)

    def number(self, what: str, value: Any) -> float:
        """A finite number."""
        if type(value) not in (int, float) or not abs(value) <= sys.float_info.max:
            raise CountError(f"its {what} is {shown(value)}, which is no finite number")
        return float(value)

    def listed(self, what: str, value: Any, lengths: Collection[int]) -> list[Any]:
        """A list of one of these lengths."""
        if not isinstance(value, list) or len(value) not in lengths:
            raise CountError(f"its {what} is no list of the length that is due")
        return value

    def numbers(self, what: str, value: Any, lengths: Collection[int]) -> None:
        """A list of finite numbers."""
        for each in self.listed(what, value, lengths):
            self.number(what, each)

    def whole(self, what: str, text: str, low: int, high: int) -> int:
        """The whole number that is the name of an entry."""
        digits = text.removeprefix("-")
        if not (digits.isdecimal() and digits.isascii() and len(digits) < 9 and low <= int(text) <= high):
            raise CountError(f"its {what}: {shown(text)} is no whole number from {low} to {high}")
        return int(text)

    def log_counts(self, what: str, state: Any) -> int:
        """What `LogCounts.state` gave; how many values it counts."""
        try:
            total, bins = LogCounts.size_of(self.named(what, state))
        except CountError:
            raise
        except (KeyError, TypeError, ValueError, IndexError, OverflowError):
            raise CountError(f"its {what} is no count in logarithmic bins") from None
        self.spanned += bins
        if self.spanned > _MOST_BINS:
            raise CountError(f"its {what} and others span more than {_MOST_BINS:,} bins")
        return self.count(f"sum of {what}", total)

    def signed(self, what: str, state: Any) -> int:
        """What `SignedLogCounts.state` gave; how many values it counts."""
        found = self.entries(what, state, ("below", "above"))
        total = sum(self.log_counts(f"{what} {name}", found[name]) for name in ("below", "above"))
        return self.count(f"sum of {what}", total)

"""A statement of the paper as code: what was computed, what was expected, and how far apart they are."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from explorer.errors import InputError


@dataclass(frozen=True)
class Finding:
    """One comparison.

    computed: what, in a sentence. measured, expected: numbers or words to print. error: how far apart they
    are, a number that `tolerance` bounds; NaN fails. reason: why this tolerance.
    """

    computed: str
    measured: Any
    expected: Any
    error: float
    tolerance: float
    reason: str

    @property
    def passed(self) -> bool:
        return bool(self.error <= self.tolerance)


Check = Callable[[], Iterator[Finding]]


@dataclass(frozen=True)
class Statement:
    """A row of `nearflat paper`: its number in the list, a short name, and the statement in words."""

    number: int
    name: str
    text: str
    check: Check


STATEMENTS: dict[int, Statement] = {}


def statement(number: int, name: str, text: str) -> Callable[[Check], Check]:
    """Register a generator of Findings as a row. name: capitals, as for --only: LEMMA-5, EQ-2.19, FIG-1."""

    def register(check: Check) -> Check:
        if number in STATEMENTS or any(name == other.name for other in STATEMENTS.values()):
            raise ValueError(f"statement {number} {name} is there already")
        STATEMENTS[number] = Statement(number, name, text, check)
        return check

    return register


def chosen(only: str | None) -> list[Statement]:
    """All statements in order, or those whose name or number is `only`. Raises InputError."""
    ordered = [STATEMENTS[number] for number in sorted(STATEMENTS)]
    if only is None:
        return ordered
    wanted = only.strip().upper()
    found = [row for row in ordered if wanted in (row.name, str(row.number))]
    if not found:
        raise InputError(f"--only {only!r} is no statement; known: {', '.join(row.name for row in ordered)}")
    return found

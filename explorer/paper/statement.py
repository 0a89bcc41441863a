"""A statement of the paper as code: what was computed, what was expected, and how far apart they are."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from explorer.errors import InputError, suggest

ETA_HAT = 0.01  # of the paper's figures, in sqrt(g/r); here, so that help need not load what draws them
# A misprint is decided only if the printed form is off by this many times what the right one is allowed.
FACTOR = 100.0


@dataclass(frozen=True)
class Finding:
    """One comparison.

    computed: what was computed, in a sentence. measured, expected: numbers or words to print. error: how far
    apart they are, a number that `tolerance` bounds; NaN fails. reason: why this tolerance. printed: for every
    misprint that this comparison decides (a key of `misprints.MISPRINTS`), how far the printed form is off.
    """

    computed: str
    measured: Any
    expected: Any
    error: float
    tolerance: float
    reason: str
    printed: Mapping[str, float] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        refuted = (off > 0.0 and off >= FACTOR * self.tolerance for off in self.printed.values())
        return bool(self.error <= self.tolerance) and all(refuted)


def shown(value: Any) -> str:
    """What was measured or expected as text: words, or numbers to ten digits."""
    if isinstance(value, str | bool):
        return str(value)
    if isinstance(value, float | int):
        return f"{value:.10g}"
    return ", ".join(shown(item) for item in value)


Check = Callable[[], Iterator[Finding]]


@dataclass(frozen=True)
class Statement:
    """A row of `nearflat paper`: its number in the list, a short name, and the statement in words."""

    number: int
    name: str
    text: str
    check: Check


STATEMENTS: dict[int, Statement] = {}


def statement(number: int, name: str) -> Callable[[Check], Check]:
    """Register a generator of Findings as a row; its docstring is the statement in words.

    name: in capitals, as the user gives it to --only: LEMMA-5, EQ-2.19, FIGURES.
    """

    def register(check: Check) -> Check:
        if number in STATEMENTS or any(name == other.name for other in STATEMENTS.values()):
            raise ValueError(f"statement {number} {name} is there already")
        STATEMENTS[number] = Statement(number, name, " ".join((check.__doc__ or "").split()), check)
        return check

    return register


def chosen(only: str | None) -> list[Statement]:
    """All statements in order, or those whose name or number is `only`. Raises InputError."""
    ordered = [STATEMENTS[number] for number in sorted(STATEMENTS)]
    if only is None:
        return ordered
    wanted = only.strip().upper()
    rows = [row for row in ordered if wanted in (row.name, str(row.number))]
    if not rows:
        raise InputError(f"only {only!r} is no statement; {suggest(wanted, [row.name for row in ordered])}")
    return rows

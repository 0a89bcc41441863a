"""Speed against accuracy: `compare` at several accuracies, beside true answers."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from explorer import compiled
from explorer.motion.bounces import Bounces
from explorer.motion.compare import apart, compare
from explorer.motion.passages import OBSERVABLES, Passages
from explorer.motion.plan import INTEGRATORS
from explorer.phase.disk import Disk
from explorer.phase.states import States

METHODS = ("quadrature", *INTEGRATORS)
ASKED = tuple((10.0 ** -np.arange(2.0, 10.1, 2.0)).tolist())  # accuracies
# Errors nearer to each other than this ratio are the same: two samplings differ by a fifth, and at rounding a
# finer step gains as little.
_SAME = 1.5
ROUNDING = 1e-14  # errors below are one
_ROUNDS = 4  # in which all methods take turns; of its times the least counts, so one undisturbed round is enough
_ERROR = """Error: the largest of the errors of race angle, delta chi, delta psi (rad), duration and
theta_min (relative), against another quadrature at 1e-11, which uses none of the precomputed tables of the
methods. *nanoseconds*: for a passage."""
# The columns of the table, with their formats
_COLUMNS = {
    **{"method": "", "accuracy": ".0e", "median": ".0e", "p99": ".0e", "largest": ".0e"},
    **{"nanoseconds": ".0f", "unresolved": ".1%", "refused": ".1%", "wrong_way": "", "on_front": ""},
}


@dataclass(frozen=True)
class Measurement:
    """One method at one accuracy: its errors, and the time of a passage.

    Attributes
    ----------
    method : str
        "quadrature" or the name of an integrator.
    accuracy : float
        That was asked.
    median, p99, largest : float
        Of the errors over the passages that have an answer.
    nanoseconds : float
        For a passage, on one core.
    unresolved, refused : float
        Shares of the passages whose side is not known, and without an answer for another reason.
    wrong_way : int
        Passages that came out on the other side of F.
    on_front : bool
        Whether no other integrator is both faster and more accurate.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade(disk="hoop", samples=1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in found.rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    method: str
    accuracy: float
    median: float
    p99: float
    largest: float
    nanoseconds: float
    unresolved: float
    refused: float
    wrong_way: int
    on_front: bool = False


@dataclass(frozen=True, repr=False)
class Trade:
    """Speed against accuracy: what `trade` returns.

    Attributes
    ----------
    disk : Disk
        Whose passages were measured.
    samples, known : int
        How many there were, and how many of them have a true answer.
    rows : list of Measurement
        Every method at every accuracy.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade(disk="hoop", samples=1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in found.rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    disk: Disk
    samples: int
    known: int
    rows: list[Measurement]

    def __repr__(self) -> str:
        return f"Trade of {self.disk.name}: {self.samples:,} passages; print it for its table"

    def __str__(self) -> str:
        cells = [[format(getattr(row, name), form) for name, form in _COLUMNS.items()] for row in self.rows]
        lines = (f"| {' | '.join(line)} |" for line in ([*_COLUMNS], ["---"] * len(_COLUMNS), *cells))
        count = f"{self.samples:,} passages, {self.known:,} with a known answer. {_ERROR}"
        return "\n".join([count, "", *lines])


def measure(states: States, exact: Passages, say: Callable[[str], None] = lambda text: None) -> Trade:
    """Every method at every accuracy on passages from the vertical; exact: the true answers, where they are ok."""
    rows = list[Measurement]()
    for accuracy in ASKED:
        say(f"measuring {len(states):,} passages at accuracy {accuracy:g}")
        tries = [compare(states, METHODS, accuracy=accuracy) for _ in range(_ROUNDS)]
        for name, each in tries[0].bounces.items():
            rows.append(_row(name, accuracy, each, min(found.seconds[name] for found in tries), exact))
    rows = mark_front(sorted(rows, key=lambda row: METHODS.index(row.method)))
    return Trade(states.disk, len(states), int(exact.ok.sum()), rows)


def _row(method: str, accuracy: float, found: Bounces, seconds: float, exact: Passages) -> Measurement:
    known, status, code = exact.ok, found.status[:, 0], compiled.status.Status
    away = [apart(name, getattr(found, name)[:, 0], getattr(exact, name)) for name in OBSERVABLES]
    errors = np.max(away, axis=0)
    errors = errors[known & np.isfinite(errors)]
    median, p99, largest = np.percentile(errors, (50, 99, 100)).tolist() if errors.size else 3 * [np.nan]
    unresolved = status[known] == code.UNRESOLVED_SIDE
    return Measurement(
        method=method,
        accuracy=accuracy,
        median=median,
        p99=p99,
        largest=largest,
        nanoseconds=seconds / status.size * 1e9,
        unresolved=float(unresolved.mean()),
        refused=float(((status[known] != code.OK) & ~unresolved).mean()),
        wrong_way=int((known & (found.race_angle[:, 0] * exact.race_angle < 0.0)).sum()),
    )


def mark_front(rows: list[Measurement]) -> list[Measurement]:
    """The rows with those integrators marked that no other integrator beats in both error and time."""

    def beaten(row: Measurement) -> bool:
        as_little = _SAME * max(row.p99, ROUNDING)  # within what errors are known to
        return any(each.p99 <= as_little and each.nanoseconds < row.nanoseconds for each in integrators)

    integrators = [row for row in rows if row.method != "quadrature" and np.isfinite(row.p99)]
    return [replace(row, on_front=row in integrators and not beaten(row)) for row in rows]


def best_of(rows: list[Measurement]) -> list[Measurement]:
    """Of one method, from coarse to fine: the rows with an error that are better than all coarser ones."""
    best: list[Measurement] = []
    for row in rows:
        if np.isfinite(row.p99) and (not best or max(row.p99, ROUNDING) * _SAME < best[-1].p99):
            best.append(row)
    return best

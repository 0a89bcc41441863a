"""Speed against accuracy, measured: every method at several accuracies, on samples whose answers are known."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from explorer import compiled
from explorer.motion.plan import Plan, plan
from explorer.motion.reference_samples import ReferenceSamples

STAGES = {"rk4": 4, "rk8": 12, "dopri5": 7, "dop853": 12}
# What all methods are asked for, and quadrature at its best besides.
ASKED, FINEST = tuple((10.0 ** -np.arange(2.0, 10.1, 2.0)).tolist()), 1e-11
# Errors nearer to each other than this ratio are the same: two samplings differ by a fifth, and at rounding a
# finer step gains as little.
_SAME = 1.5
# In which all methods take turns, until one took so many seconds in all; of its times the least counts, so one
# undisturbed round is enough.
_ROUNDS, _ENOUGH = 4, 0.3
ROUNDING = 1e-14  # errors below are one


@dataclass(frozen=True)
class Row:
    """One method at one accuracy: its errors, and what a sample costs.

    Attributes
    ----------
    kind : str
        What was measured: "passages" or "motions".
    method : str
        "quadrature" or the name of an integrator.
    accuracy : float
        That was asked.
    median, p99, largest : float
        Of the errors over the samples that have an answer.
    evaluations : float
        Of the vector field, for a sample; 0 for quadrature.
    nanoseconds : float
        For a sample, on one core.
    unresolved, refused : float
        Shares of the samples whose side is not known, and without an answer for another reason.
    wrong_way : int
        Samples that came out on the other side of F.
    on_front : bool
        Whether no other integrator is both faster and more accurate.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.trade(disk="hoop", samples=1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in found.rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    kind: str
    method: str
    accuracy: float
    median: float
    p99: float
    largest: float
    evaluations: float
    nanoseconds: float
    unresolved: float
    refused: float
    wrong_way: int
    on_front: bool = False


@dataclass(frozen=True)
class Measured:
    """One kind of samples: every method at every accuracy.

    samples: how many, of which `known` have a true answer. unit, error: what cost and error are of.
    """

    kind: str
    unit: str
    error: str
    samples: int
    known: int
    rows: list[Row]


def measure(samples: ReferenceSamples, say: Callable[[str], None] = lambda text: None) -> Measured:
    """Every method at every accuracy on samples."""
    count, known = samples.exact.ok.size, int(samples.exact.ok.sum())
    rows = list[tuple[Row, Callable[[], Any]]]()
    for method in samples.methods:
        say(f"measuring {count:,} {samples.kind} by {method}")
        asked = (*ASKED, FINEST) if method == "quadrature" else ASKED
        rows += [_row(samples, plan(samples.observables, accuracy, method)) for accuracy in asked]
    say(f"timing {samples.kind}")
    seconds = _least_times([call for _, call in rows])
    timed = [replace(row, nanoseconds=t / count * 1e9) for (row, _), t in zip(rows, seconds, strict=True)]
    return Measured(samples.kind, samples.unit, samples.error, count, known, mark_front(timed))


def _least_times(calls: list[Callable[[], Any]]) -> list[float]:
    """The least time of each, one after the other, in rounds: what disturbs a machine for a while disturbs all."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(_ROUNDS):
        for call, taken in zip(calls, times, strict=True):
            if sum(taken) < _ENOUGH:
                begin = time.process_time()
                call()
                taken.append(time.process_time() - begin)
    return list(map(min, times))


def _row(samples: ReferenceSamples, how: Plan) -> tuple[Row, Callable[[], Any]]:
    """A plan: its errors, what becomes of the samples, and the call that is timed."""
    call, known, code = partial(samples.call, how), samples.exact.ok, compiled.status.Status
    tried = samples.compare(call())
    errors = tried.errors[known & np.isfinite(tried.errors)]
    median, p99, largest = np.percentile(errors, (50, 99, 100)).tolist() if errors.size else 3 * [np.nan]
    unresolved = tried.status[known] == code.UNRESOLVED_SIDE
    steps = 0.0 if tried.steps is None else float(tried.steps[known].mean())
    row = Row(
        kind=samples.kind,
        method=how.method,
        accuracy=how.accuracy,
        median=median,
        p99=p99,
        largest=largest,
        evaluations=STAGES.get(how.method, 0) * steps,
        nanoseconds=np.inf,
        unresolved=float(unresolved.mean()),
        refused=float(((tried.status[known] != code.OK) & ~unresolved).mean()),
        wrong_way=int((tried.wrong_way & known & (tried.status == code.OK)).sum()),
    )
    return row, call


def mark_front(rows: list[Row]) -> list[Row]:
    """The rows with those integrators marked that no other integrator beats in both error and time."""

    def beaten(row: Row) -> bool:
        as_little = _SAME * max(row.p99, ROUNDING)  # within what errors are known to
        return any(each.p99 <= as_little and each.nanoseconds < row.nanoseconds for each in integrators)

    integrators = [row for row in rows if row.method != "quadrature" and np.isfinite(row.p99)]
    return [replace(row, on_front=row in integrators and not beaten(row)) for row in rows]


def best_of(rows: list[Row]) -> list[Row]:
    """Of one method, from coarse to fine: the rows with an error that are better than all coarser ones."""
    best: list[Row] = []
    for row in rows:
        if np.isfinite(row.p99) and (not best or max(row.p99, ROUNDING) * _SAME < best[-1].p99):
            best.append(row)
    return best

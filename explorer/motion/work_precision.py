"""Speed against accuracy, measured: every method at every setting, on samples whose answers are known."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.calibration import SAFETY, SETTINGS
from explorer.motion.plan import LOOSEST, TIGHTEST, Plan
from explorer.motion.reference_samples import ANY_ERROR, ReferenceSamples, Tried

STAGES = {"rk4": 4, "rk8": 12, "dopri5": 7, "dop853": 12}
# What all methods are asked for, and quadrature at its best besides.
ASKED = tuple((10.0 ** -np.arange(2.0, 10.1, 2.0)).tolist())
OF_QUADRATURE = (*ASKED, 1e-11)
# Errors nearer to each other than this ratio are the same: two samplings differ by a fifth, and at rounding a
# finer setting gains as little.
_SAME = 1.5
# In which all settings take turns, until one took so many seconds in all; of its times the least counts, so one
# undisturbed round is enough.
_ROUNDS, _ENOUGH = 4, 0.3
ROUNDING = 1e-14  # errors below are one
Errors = dict[tuple[str, float], float]  # by method and setting


@dataclass(frozen=True)
class Row:
    """One method at one setting: its errors, and what a sample costs.

    Attributes
    ----------
    kind : str
        What was measured: "passages" or "motions".
    method : str
        "quadrature" or the name of an integrator.
    setting : float
        Step in units of 1/speed, or tolerance; of quadrature its accuracy.
    accuracy : float
        The accuracy at which the setting is chosen on these samples: twice the error.
    median, p99, largest : float
        Of the errors over the samples.
    evaluations : float
        Of the vector field, for a sample; 0 for quadrature.
    nanoseconds : float
        For a sample, on one core.
    unresolved, refused : float
        Shares of the samples whose side is not known at that accuracy, and without an answer for another reason.
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
    setting: float
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
    """One kind of samples: every method at every setting, and at every accuracy asked.

    rows: by setting. asked: the same at the settings that `--accuracy` chooses now; `setting` is the accuracy
    asked. samples: how many, of which `known` have a true answer. unit, error: what cost and error are of.
    """

    kind: str
    unit: str
    error: str
    samples: int
    known: int
    rows: list[Row]
    asked: list[Row]


Call = Callable[[], Any]


def measure(samples: ReferenceSamples, say: Callable[[str], None] = lambda text: None) -> Measured:
    """Every method at every setting and accuracy on samples."""
    count, known = samples.known.size, int(samples.known.sum())
    rows, asked = list[tuple[Row, Call]](), list[tuple[Row, Call]]()
    if not samples.in_time:
        rows += [_row(samples, samples.plan("quadrature", accuracy)) for accuracy in OF_QUADRATURE]
        asked += rows[: len(ASKED)]
    for method, settings in SETTINGS.items():
        say(f"measuring {count:,} {samples.kind} by {method}")
        rows += [_at_setting(samples, method, float(setting)) for setting in settings]
        asked += [_row(samples, samples.plan(method, asks)) for asks in ASKED if asks >= TIGHTEST[method]]
    say(f"timing {samples.kind}")
    seconds = _least_times([call for _, call in rows + asked])
    timed = [
        replace(row, nanoseconds=least / count * 1e9)
        for (row, _), least in zip(rows + asked, seconds, strict=True)
    ]
    return Measured(
        samples.kind, samples.unit, samples.error, count, known, mark_front(timed[: len(rows)]), timed[len(rows) :]
    )


def _least_times(calls: list[Call]) -> list[float]:
    """The least time of each, one after the other, in rounds: what disturbs a machine for a while disturbs all."""
    times: list[list[float]] = [[] for _ in calls]
    for _ in range(_ROUNDS):
        for call, taken in zip(calls, times, strict=True):
            if sum(taken) < _ENOUGH:
                begin = time.process_time()
                call()
                taken.append(time.process_time() - begin)
    return list(map(min, times))


def _without_refusals(samples: ReferenceSamples, method: str, setting: float) -> Tried:
    """What an integrator at one setting makes of the samples where none is refused for its error."""
    return samples.compare(samples.call(samples.plan(method, ANY_ERROR, setting)), ANY_ERROR)


def _at_setting(samples: ReferenceSamples, method: str, setting: float) -> tuple[Row, Call]:
    """An integrator at one setting: its errors where none is refused, and what users then meet."""
    tried = _without_refusals(samples, method, setting)
    accuracy = float(np.clip(SAFETY * _quantiles(tried, samples.known)[1], TIGHTEST[method], LOOSEST))
    return _row(samples, samples.plan(method, accuracy, setting), tried)


def _row(samples: ReferenceSamples, how: Plan, tried: Tried | None = None) -> tuple[Row, Call]:
    """A plan: its errors, or those that were tried, what becomes of the samples, and the call that is timed."""
    call, known, code = partial(samples.call, how), samples.known, compiled.status.Status
    met = samples.compare(call(), how.accuracy)
    errors = met if tried is None else tried
    median, p99, largest = _quantiles(errors, known)
    unresolved = met.status[known] == code.UNRESOLVED_SIDE
    row = Row(
        kind=samples.kind,
        method=how.method,
        setting=how.accuracy if how.setting is None else how.setting,
        accuracy=how.accuracy,
        median=median,
        p99=p99,
        largest=largest,
        evaluations=0.0 if errors.steps is None else STAGES.get(how.method, 0) * float(errors.steps[known].mean()),
        nanoseconds=np.inf,
        unresolved=float(unresolved.mean()),
        refused=float(((met.status[known] != code.OK) & ~unresolved).mean()),
        wrong_way=int((met.wrong_way & known & (met.status == code.OK)).sum()),
    )
    return row, call


def _quantiles(tried: Tried, known: NDArray[np.bool_]) -> tuple[float, float, float]:
    """Median, 99th percentile and largest error of the samples that have one; NaN where none has."""
    errors = tried.errors[known]
    errors = errors[np.isfinite(errors)]
    if errors.size == 0:
        return np.nan, np.nan, np.nan
    median, p99 = np.percentile(errors, (50, 99))
    return float(median), float(p99), float(errors.max())


def mark_front(rows: list[Row]) -> list[Row]:
    """The rows with those integrators marked that no other integrator beats in both error and time."""

    def beaten(row: Row) -> bool:
        as_little = _SAME * max(row.p99, ROUNDING)  # within what errors are known to
        return any(each.p99 <= as_little and each.nanoseconds < row.nanoseconds for each in integrators)

    integrators = [row for row in rows if row.method != "quadrature" and np.isfinite(row.p99)]
    return [replace(row, on_front=row in integrators and not beaten(row)) for row in rows]


def best_of(rows: list[Row]) -> list[Row]:
    """Of one method, from coarse to fine: the settings with an error that are better than all coarser ones."""
    best: list[Row] = []
    for row in rows:
        if np.isfinite(row.p99) and (not best or max(row.p99, ROUNDING) * _SAME < best[-1].p99):
            best.append(row)
    return best


def only_errors(samples: ReferenceSamples) -> Errors:
    """The 99th percentile of every integrator at every setting, without times."""
    return {
        (method, float(setting)): _quantiles(_without_refusals(samples, method, float(setting)), samples.known)[1]
        for method, settings in SETTINGS.items()
        for setting in settings
    }


def largest_errors(measured: Iterable[list[Row]], others: Iterable[Errors]) -> Errors:
    """The largest 99th percentile of each method at each setting, of several measurements."""
    several = [{(row.method, row.setting): row.p99 for row in rows if row.method in SETTINGS} for rows in measured]
    largest: Errors = {}
    for errors in (*several, *others):
        for key, error in errors.items():
            largest[key] = float(np.fmax(largest.get(key, np.nan), error))
    return largest


def curves(costs: Measured, errors: Errors) -> dict[str, list[tuple[float, float] | None]]:
    """The table of one kind for `calibration`: error and nanoseconds at SETTINGS, None where they gain nothing."""
    table = {}
    for method, settings in SETTINGS.items():
        rows = [
            replace(row, p99=errors.get((method, row.setting), np.nan))
            for row in costs.rows
            if row.method == method
        ]
        best = {row.setting: (row.p99, row.nanoseconds) for row in best_of(rows)}
        table[method] = [best.get(float(setting)) for setting in settings]
    return table

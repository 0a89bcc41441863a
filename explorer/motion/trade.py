"""Speed against accuracy, measured: every method at every setting, on samples whose answers are known."""

import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.calibration import SAFETY
from explorer.motion.plan import LOOSEST, TIGHTEST
from explorer.motion.trials import ANY_ERROR, Trial, Tried

# Steps in units of 1/speed and tolerances, from coarse to fine.
SETTINGS = {
    "rk4": (0.25, 0.12, 0.05, 0.02, 0.007, 0.002),
    "rk8": (1.6, 1.2, 0.8, 0.5, 0.3, 0.16, 0.08),
    "dopri5": tuple(10.0 ** -np.arange(3.5, 11.6)),
    "dop853": tuple(10.0 ** -np.arange(2.0, 13.1)),
}
STAGES = {"rk4": 4, "rk8": 12, "dopri5": 7, "dop853": 12}
# What all methods are asked for, and quadrature at its best besides.
ASKED = tuple(10.0 ** -np.arange(2.0, 10.1, 2.0))
OF_QUADRATURE = (*ASKED, 1e-11)
# Errors nearer to each other than this ratio are the same: two samplings differ by a fifth, and at rounding a
# finer setting gains as little.
_SAME = 1.5
# In which all settings take turns, until one took so many seconds in all; of its times the least counts, so one
# undisturbed round is enough.
_ROUNDS, _ENOUGH = 4, 0.3
_LEAST = 1e-16  # an error of 0 is one of rounding,
ROUNDING = 1e-14  # and below this all are
Errors = dict[tuple[str, float], float]  # by method and setting


@dataclass(frozen=True)
class Row:
    """One method at one setting: its errors, and what a sample costs.

    Attributes
    ----------
    kind : str
        What was measured: "passages", "tilts" or "motions".
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
    >>> found = ex.trade("race-angles", disk="hoop", samples=1024)  # doctest: +SKIP
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


@dataclass
class _Timed:
    """A row in the making."""

    row: Row
    call: Callable[[], Any]
    times: list[float] = field(default_factory=list)

    def again(self) -> None:
        """Repeat it; the least time counts, as others may be at work on this machine."""
        self.times.append(_seconds(self.call)[1])


def _seconds(call: Callable[[], Any]) -> tuple[Any, float]:
    """What a call returns, and how long it took."""
    begin = time.process_time()
    found = call()
    return found, time.process_time() - begin


def measure(trial: Trial, say: Callable[[str], None] = lambda text: None) -> Measured:
    """Every method at every setting and accuracy on the samples of a trial."""
    count, known = trial.known.size, int(trial.known.sum())
    rows, asked = [], []
    for method, settings in SETTINGS.items():
        say(f"measuring {count:,} {trial.kind} by {method}")
        rows += [_at_setting(trial, method, float(setting)) for setting in settings]
        asked += [_at_accuracy(trial, method, accuracy) for accuracy in ASKED if accuracy >= TIGHTEST[method]]
    if not trial.in_time:
        rows = [_at_accuracy(trial, "quadrature", accuracy) for accuracy in OF_QUADRATURE] + rows
        asked = [_at_accuracy(trial, "quadrature", accuracy) for accuracy in ASKED] + asked
    say(f"timing {trial.kind}")
    _time([*rows, *asked])
    done = [
        [replace(timed.row, nanoseconds=min(timed.times) / count * 1e9) for timed in each]
        for each in (rows, asked)
    ]
    return Measured(trial.kind, trial.unit, trial.error, count, known, mark_front(done[0]), done[1])


def _time(timed: list[_Timed]) -> None:
    """Time all, one after the other, in rounds: what disturbs a machine for a while disturbs all alike."""
    for _ in range(_ROUNDS):
        for each in timed:
            if sum(each.times) < _ENOUGH:
                each.again()


def _at_setting(trial: Trial, method: str, setting: float) -> _Timed:
    """An integrator at one setting: its errors where none is refused, and what users then meet."""
    loose = trial.plan(method, ANY_ERROR, setting)
    tried = trial.compare(trial.call(loose), ANY_ERROR)
    errors = _quantiles(tried, trial.known)
    accuracy = float(np.clip(SAFETY * errors[1], TIGHTEST[method], LOOSEST))
    how = trial.plan(method, accuracy, setting)
    # The call before has compiled what this one needs: a long one need not be made again to be timed.
    found, seconds = _seconds(lambda: trial.call(how))
    tried_and_met = tried, trial.compare(found, accuracy)
    return _Timed(_row(trial, how.method, (setting, accuracy), tried_and_met), lambda: trial.call(how), [seconds])


def _at_accuracy(trial: Trial, method: str, accuracy: float) -> _Timed:
    """A method as `--accuracy` sets it; an integrator after its settings, by which it is compiled."""
    how = trial.plan(method, float(accuracy))
    found, seconds = _seconds(lambda: trial.call(how))
    met = trial.compare(found, accuracy)
    row = _row(trial, method, (float(accuracy), float(accuracy)), (met, met))
    return _Timed(row, lambda: trial.call(how), [seconds] if method in SETTINGS else [])


def _row(trial: Trial, method: str, setting_and_accuracy: tuple[float, float], tried: tuple[Tried, Tried]) -> Row:
    """The row of what was tried: errors from the first, what became of the samples from the second."""
    errors, met, code = tried[0], tried[1], compiled.status.Status
    known = trial.known
    steps = 0.0 if errors.steps is None else STAGES.get(method, 0) * float(errors.steps[known].mean())
    unresolved = met.status[known] == code.UNRESOLVED_SIDE
    refused = (met.status[known] != code.OK) & ~unresolved
    return Row(
        trial.kind,
        method,
        *setting_and_accuracy,
        *_quantiles(errors, known),
        steps,
        np.inf,
        float(unresolved.mean()),
        float(refused.mean()),
        int((met.wrong_way & known & (met.status == code.OK)).sum()),
    )


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
    integrators = [row for row in rows if row.method != "quadrature"]
    return [
        replace(
            row,
            on_front=row in integrators
            and np.isfinite(row.p99)
            and not any(_beats(other, row) for other in integrators),
        )
        for row in rows
    ]


def _beats(other: Row, row: Row) -> bool:
    """Whether another is faster and errs as little, within what the errors are known to."""
    return other.p99 <= _SAME * max(row.p99, ROUNDING) and other.nanoseconds < row.nanoseconds


def best_of(rows: list[Row]) -> list[Row]:
    """Of one method, from coarse to fine: the settings with an error that are better than all coarser ones."""
    best: list[Row] = []
    for row in rows:
        if np.isfinite(row.p99) and (not best or max(row.p99, ROUNDING) * _SAME < best[-1].p99):
            best.append(row)
    return best


def only_errors(trial: Trial) -> Errors:
    """The 99th percentile of every integrator at every setting, without times."""
    found = {}
    for method, settings in SETTINGS.items():
        for setting in map(float, settings):
            tried = trial.compare(trial.call(trial.plan(method, ANY_ERROR, setting)), ANY_ERROR)
            found[method, setting] = _quantiles(tried, trial.known)[1]
    return found


def largest_errors(measured: Iterable[list[Row]], others: Iterable[Errors]) -> Errors:
    """The largest 99th percentile of each method at each setting, of several measurements."""
    rows = [row for each in measured for row in each if row.method in SETTINGS]
    several = [{(row.method, row.setting): row.p99} for row in rows]
    largest: Errors = {}
    for errors in (*several, *others):
        for key, error in errors.items():
            if np.isfinite(error):
                largest[key] = max(largest.get(key, _LEAST), error)
    return largest


def curves(costs: Measured, errors: Errors) -> dict[str, list[list[float]]]:
    """The table of one kind for `calibration`: setting, error and nanoseconds, by method.

    Settings finer than the last that gains are left out: there the error is one of rounding.
    """
    table = {}
    for method in SETTINGS:
        rows = [
            replace(row, p99=errors[method, row.setting])
            for row in costs.rows
            if row.method == method and (method, row.setting) in errors
        ]
        last = rows.index(best_of(rows)[-1]) if best_of(rows) else -1
        table[method] = [[row.setting, row.p99, row.nanoseconds] for row in rows[: last + 1]]
    return table

"""`nearflat trade`: speed against accuracy, measured: every method at every setting, on passages of a body."""

import argparse
import json
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from explorer import compiled
from explorer.commands.common import add_json
from explorer.commands.made_by import leave_page
from explorer.errors import InputError, note, whole
from explorer.motion import calibration
from explorer.motion.passages import passages
from explorer.motion.turning_points import followed
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states

# Steps in units of 1/speed and tolerances, from coarse to fine.
SETTINGS = {
    "rk4": (0.5, 0.35, 0.25, 0.18, 0.12, 0.08, 0.05, 0.03, 0.02, 0.012, 0.007, 0.004, 0.002),
    "rk8": (1.6, 1.4, 1.2, 1.0, 0.8, 0.65, 0.5, 0.4, 0.3, 0.22, 0.16, 0.12, 0.08, 0.05),
    "dopri5": tuple(10.0 ** -np.arange(2.5, 11.6, 0.5)),
    "dop853": tuple(10.0 ** -np.arange(1.0, 15.1, 0.5)),
}
# Of |eta_hat|, natural units.
DECADES = (-8.0, 0.0)
FEWEST, MOST = 1024, 1_000_000  # samples; with fewer, overheads are measured
STAGES = {"rk4": 4, "rk8": 12, "dopri5": 7, "dop853": 12}
_MOST_STEPS, _ANY_ERROR = 200_000, 1.0  # errors are what is measured, so no sample is refused for its own
# Errors are calibrated on all of these, so that they hold for bodies nobody measured.
BODIES = (Disk.uniform(), Disk.hoop(), Disk(I1=0.02, I3=0.04), Disk(I1=0.5, I3=0.3))

Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Row:
    """One method at one setting: its errors, and what a passage costs.

    Attributes
    ----------
    method : str
        "quadrature" or the name of an integrator.
    setting : float
        Step in units of 1/speed, or tolerance.
    median, p99 : float
        Quantiles of the error (rad; of times, relative).
    evaluations : float
        Of the vector field, for a passage.
    nanoseconds : float
        For a passage, on one core.
    unresolved : float
        Share of the samples.
    on_front : bool
        Whether no other integrator is both faster and more accurate.

    Examples
    --------
    >>> import explorer as ex
    >>> rows = ex.trade(ex.Disk.uniform(), 1024)  # doctest: +SKIP
    >>> print(min(row.nanoseconds for row in rows if row.p99 < 1e-6))  # doctest: +SKIP
    """

    method: str
    setting: float
    median: float
    p99: float
    evaluations: float
    nanoseconds: float
    unresolved: float  # share of samples
    on_front: bool = False


def trade(disk: Disk, samples: int = 4096, seed: int = 0, say: Any = lambda text: None) -> list[Row]:
    """Measure error and cost of every method over its range of settings, on passages of a body; some ten seconds.

    Starts are as race-angles draws them, |eta_hat| from 1e-8 to 1. Errors are the largest of delta chi, delta psi
    (rad), duration and theta_min (relative), against quadrature at 1e-11. Compile time is not counted.

    Parameters
    ----------
    disk : Disk
        The body.
    samples : int
        Passages, 1024 to a million.
    seed : int
        Of the random starts.
    say : callable, optional
        Called with a line of progress for each method.

    Returns
    -------
    list of Row
        For `explorer.plot.work_precision`.

    Raises
    ------
    InputError
        For another number of samples, and for a body whose exact answers are not known.

    Examples
    --------
    >>> import explorer as ex
    >>> rows = ex.trade(ex.Disk.uniform(), 1024)  # doctest: +SKIP
    """
    work = Work(disk, whole("--samples", samples, FEWEST, MOST), whole("--seed", seed))
    if not (work.exact.status == compiled.status.Status.OK).mean() > 0.99:
        raise InputError(
            f"--disk {disk.name}: quadrature does not reach 1e-11 for this body; nothing to compare with"
        )
    rows = [work.quadrature()]
    for method, settings in SETTINGS.items():
        say(f"measuring {method}")
        rows += [work.measure(method, setting) for setting in settings]
    return mark_front(rows)


def mark_front(rows: list[Row]) -> list[Row]:
    """The rows with those integrators marked that no other integrator beats in both error and time."""
    integrators = [row for row in rows if row.method != "quadrature"]
    return [
        replace(row, on_front=row in integrators and not any(_beats(other, row) for other in integrators))
        for row in rows
    ]


def _beats(other: Row, row: Row) -> bool:
    as_good = other.p99 <= row.p99 and other.nanoseconds <= row.nanoseconds
    return as_good and (other.p99 < row.p99 or other.nanoseconds < row.nanoseconds)


def calibrate(rows: list[Row], samples: int = 1024) -> dict[str, Any]:
    """The table for `calibration`: costs as measured in `rows`, errors the largest over BODIES too."""
    errors = {(row.method, row.setting): row.p99 for row in rows}
    for number, disk in enumerate(BODIES):
        work = Work(disk, samples, number)
        for method, settings in SETTINGS.items():
            for setting in settings:
                row = work.measure(method, setting, repeats=1)
                errors[method, setting] = max(errors[method, setting], row.p99)
    methods = {
        name: [
            [row.setting, max(errors[row.method, row.setting], 1e-16), row.evaluations, row.nanoseconds]
            for row in rows
            if row.method == name
        ]
        for name in SETTINGS
    }
    quadrature = next(row.nanoseconds for row in rows if row.method == "quadrature")
    return {"kernels": compiled.source_digest(), "quadrature": quadrature, "methods": methods}


class Work:
    """A body's passages, drawn once, with their exact answers."""

    def __init__(self, disk: Disk, samples: int, seed: int) -> None:
        rng = np.random.default_rng(seed)
        unit = disk.rate_unit
        eta_hat = rng.choice([-1.0, 1.0], samples) * 10.0 ** rng.uniform(*DECADES, samples)
        self.disk = disk
        self.start = (rng.uniform(-2, 2, samples) * unit, eta_hat * unit, rng.uniform(0.5, 2, samples) * unit)
        self.states = constants_to_states(disk, *self.start, 1.0)
        self.exact = passages(disk, *self.start, accuracy=1e-11)

    def quadrature(self) -> Row:
        """Quadrature; its error is what it says of itself."""
        best, _ = _fastest(lambda: passages(self.disk, *self.start, accuracy=1e-11), 5)
        errors = self.exact.error_estimate
        median, p99 = np.nanpercentile(errors, (50, 99))
        count = len(self.exact)
        unresolved = float(np.mean(self.exact.status != compiled.status.Status.OK))
        return Row("quadrature", 1e-11, float(median), float(p99), 0.0, best / count * 1e9, unresolved)

    def measure(self, method: str, setting: float, repeats: int = 3) -> Row:
        """An integrator at one setting, to the turning point and doubled."""
        best, (out, outcome) = _fastest(lambda: self.solve(method, setting), repeats)
        median, p99 = np.nanpercentile(self.errors(out), (50, 99))
        evaluations = STAGES[method] * float(outcome.steps.mean())
        unresolved = float(np.mean(outcome.status != compiled.status.Status.OK))
        return Row(
            method,
            float(setting),
            float(median),
            float(p99),
            evaluations,
            best / len(self.exact) * 1e9,
            unresolved,
        )

    def solve(self, method: str, setting: float) -> "tuple[Array, compiled.attempt.Outcome]":
        """Every sample at its turning point, by one method at one setting."""
        n, number = len(self.exact), int(getattr(compiled.attempt, method.upper()))
        how = compiled.attempt.Integration(
            number, compiled.field.ANGLES, np.full(n, setting), _MOST_STEPS, _ANY_ERROR
        )
        assert self.states.exact is not None  # made from constants
        return followed(self.states, how, np.zeros(n, np.int8), np.stack(self.states.exact))

    def errors(self, out: Array) -> Array:
        """Largest error of delta chi, delta psi (rad), duration and theta_min (relative) of every sample."""
        exact, unit, row = self.exact, self.disk.time_unit, compiled.field.ROW
        errors = (
            2.0 * out[row.chi] - exact.delta_chi,
            2.0 * out[row.psi] - exact.delta_psi,
            2.0 * out[row.t] * unit / exact.duration - 1.0,
            np.arctan2(out[row.q], abs(out[row.z])) / exact.theta_min - 1.0,
        )
        largest: Array = np.max(np.abs(errors), axis=0)
        return largest


def _fastest(call: Callable[[], Answer], repeats: int) -> tuple[float, Answer]:
    """Least processor time (s) of several runs after one that compiles and warms, and what that one returned."""
    answer = call()
    best = np.inf
    for _ in range(repeats):
        begin = time.thread_time()  # others may be at work on this machine
        call()
        best = min(best, time.thread_time() - begin)
    return best, answer


def table(rows: list[Row]) -> list[str]:
    """The rows as a Markdown table, from accurate to coarse in each method; the front is marked."""
    lines = [
        "| method | setting | median error | 99th percentile | evaluations | ns per passage | unresolved | * |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        evaluations = f"{row.evaluations:.0f}" if row.evaluations else "-"
        lines.append(
            f"| {row.method} | {row.setting:.2g} | {row.median:.0e} | {row.p99:.0e} | {evaluations} "
            f"| {row.nanoseconds:.0f} | {row.unresolved:.1%} | {'*' if row.on_front else ''} |"
        )
    return lines


def folder_for(out: Path) -> Path:
    """The folder for a report, made now rather than after the measurement. Raises InputError."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out {out}: cannot be written ({error.strerror}); give a folder that can") from None
    return out


def report(disk: Disk, rows: list[Row], out: Path, command: str, where: Path | None) -> None:
    """README.md and trade.png in the folder `out`."""
    from explorer.plot import figure_of, save, work_precision

    lines = [
        f"# Speed against accuracy: {disk.name}",
        "",
        f"Made by `{command}` on {platform.machine()}, {platform.system()}.",
        "Passages from vertical to vertical as race-angles draws them, |eta_hat| from 1e-8 to 1. Error: the",
        "largest of delta chi, delta psi (rad), duration and theta_min (relative) against quadrature; for",
        "quadrature its own estimate. Integrators are held to sigma3_bar and eta, go to the turning point and",
        "double. Processor time of one core, without compile time. Rows marked * are the Pareto front of the",
        "integrators: none beats them in both error and time. Quadrature gives",
        "passages and periods only; where the motion in time is asked for, an integrator must follow it. Compare",
        "times within this table only.",
        "",
        *table(rows),
        "",
        "![error and time of all methods](trade.png)",
    ]
    if where is not None:
        lines += ["", "Stored for this machine; `--accuracy` and `--method auto` read it."]
    save(figure_of(work_precision, rows), out / "trade.png")
    leave_page(out, lines, command)


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the options of `nearflat trade`."""
    command.add_argument("--disk", default="uniform", metavar="DISK", help="as for run (default uniform)")
    command.add_argument("--samples", default=4096, metavar="N", help="passages (default 4096)")
    command.add_argument("--seed", default=0, metavar="S", help="seed of the random streams (default 0)")
    command.add_argument("--out", default="results/trade", metavar="DIR", help="folder (default results/trade)")
    command.add_argument("--no-store", action="store_true", help="do not keep the result for this machine")
    add_json(command)


def call(options: argparse.Namespace) -> int:
    disk, out = Disk.parse(options.disk), folder_for(Path(options.out))
    samples, seed = whole("--samples", options.samples, FEWEST, MOST), whole("--seed", options.seed)
    rows = trade(disk, samples, seed, lambda text: note(text, options.quiet))
    command = f"nearflat trade --disk {options.disk} --samples {samples} --seed {seed}"
    where = None if options.no_store else calibration.stored_at()
    report(disk, rows, out, command, where)
    if where is not None:
        calibration.store(calibrate(rows))
    if options.json:
        print(json.dumps({"disk": disk.describe(), "rows": [vars(row) for row in rows]}))
        return 0
    print("\n".join(table(rows)))
    print(f"Table and picture are in {options.out}." + (f" Calibration kept in {where}." if where else ""))
    return 0

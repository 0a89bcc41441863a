"""Writes results/scaling/: time and memory against the number of samples, jobs, and distance from F.

    python tests/tools/report_scaling.py      # some minutes on two cores

Every row is measured in a process of its own, after warming up, so that memory is the row's.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import joblib
import numpy as np
import second_job
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from explorer.pictures.register import Caption, Question, add_caption, save
from explorer.pictures.style import DARK, SERIES, SIZE, dress, legend_below
from explorer.pictures.style import METHODS as LOOKS

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from processor import processor

OUT = Path(__file__).parents[2] / "results" / "scaling"
PASSAGES = (10**3, 10**4, 10**5, 10**6, 10**7)
STATES = (10**3, 10**4, 10**5, 10**6, 10**7, 10**8, 10**9)
EXPONENTS = (1, 2, 3, 6, 9, 12, 15, 30, 100, 300)
METHODS = ("quadrature", "rk4", "rk8", "dopri5", "dop853")
BOTH_JOBS = 4_000_000  # samples on which the second job is measured


def stored(scene, samples, jobs, **options):
    """How many samples a run stood for that was stored and summarised, without its pictures."""
    import explorer as ex

    asked = {"samples": samples, "jobs": jobs, "figures": False, "progress": False, **options}
    with tempfile.TemporaryDirectory() as folder:
        run = ex.run(scene, out=Path(folder) / "run", **asked)
    return run.summary["samples"]


WORKS = {
    "states": partial(stored, "falling-set", theta_min="near", keep="none"),
    "passages": partial(stored, "race-angles", keep="all"),
}


def measure(name, samples, jobs):
    """Seconds and peak memory (MB) of one row, in a process of its own."""
    done = subprocess.run(
        [sys.executable, __file__, name, str(samples), str(jobs)], capture_output=True, text=True, check=True
    )
    return json.loads(done.stdout.splitlines()[-1])


def child(name, samples, jobs):
    work = WORKS[name]
    work(1000, 1)
    start = time.perf_counter()
    work(samples, jobs)
    seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps([seconds, peak]))


def against_eta(samples=20_000, rounds=5):
    """Microseconds per passage of `explorer.passages` at each |eta_hat|, by method; None where unresolved.

    Processor time, the least of several rounds in which all take turns.
    """
    import explorer as ex

    disk, rng = ex.Disk.uniform(), np.random.default_rng(0)
    s3, speed = rng.uniform(-2.0, 2.0, samples), rng.uniform(0.5, 2.0, samples)
    best = {}
    for _ in range(rounds):
        for exponent in EXPONENTS:
            for method in METHODS:
                begin = time.process_time()
                got = ex.passages(disk, s3, 10.0**-exponent, speed, method=method, accuracy=1e-2)
                passed = time.process_time() - begin if (got.status == ex.Status.OK).mean() > 0.99 else np.inf
                best[exponent, method] = min(best.get((exponent, method), np.inf), passed)
    micro = {place: seconds / samples * 1e6 if seconds < np.inf else None for place, seconds in best.items()}
    return [(exponent, [micro[exponent, method] for method in METHODS]) for exponent in EXPONENTS]


def eta_lines(rows):
    """The table of `against_eta`."""
    yield "| abs(eta_hat) | " + " | ".join(METHODS) + " |"
    yield "|---|" + "---|" * len(METHODS)
    for exponent, row in rows:
        cells = ("-" if cell is None else f"{cell:.2f}" for cell in row)
        yield f"| 1e-{exponent} | " + " | ".join(cells) + " |"


OF_SIZES = Caption(
    Question.HOW_GOOD,
    "Time against the number of samples, for states that are drawn, examined and counted, and for passages that "
    "are computed and stored. Small runs take as long as starting takes; beyond the bend the time grows in "
    "proportion to the number of samples, along the dotted line. Above ten million, states are drawn in larger "
    "chunks and take less time each. A second worker is worth while from a hundred thousand passages on, and "
    "from a hundred million states on.",
)


def draw(rows):
    """Time, for both kinds of work and one and two jobs; memory is in the table."""
    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.subplots()
    works = {"states": ("states, drawn and judged", SERIES[1]), "passages": ("passages, all stored", DARK)}
    for name, (_told, colour) in works.items():
        for jobs, marker, style in ((1, "o", "--"), (2, "s", "-")):
            chosen = [(n, s) for what, n, j, s, _ in rows if what == name and j == jobs]
            if not chosen:
                continue
            samples, seconds = zip(*chosen, strict=True)
            ax.loglog(samples, seconds, style, marker=marker, ms=5, color=colour)
            if jobs == 1:
                end = np.array([max(samples) / 1e3, max(samples)])
                ax.plot(end, seconds[-1] * end / end[-1], ":", color=colour, lw=1.4)
    for told, colour in works.values():
        ax.plot([], [], color=colour, lw=4, label=told)
    ax.plot([], [], "o--", color="0.5", ms=5, label="1 job")
    ax.plot([], [], "s-", color="0.5", ms=5, label="2 jobs")
    ax.plot([], [], ":", color="0.5", lw=1.4, label=r"$\propto$ samples")
    legend_below(ax, ncols=2)
    dress(ax, "samples", "time (s)", "Small runs cost their start, large ones their samples", grid=True)
    add_caption(figure, OF_SIZES)
    return figure


OF_DISTANCES = Caption(
    Question.HOW_GOOD,
    "Time of one passage against the distance from F, from a tenth down to 1e-300, at an accuracy of 1e-2. "
    "Quadrature costs the same at any distance. Integrators answer at any distance too, because each step is "
    "put back onto the constants of motion. They take longer the closer to F: the number of steps into the race "
    "and out of it grows like the logarithm of the distance.",
)


def draw_cost(rows: list[tuple[int, list[float | None]]]) -> Figure:
    """Microseconds per passage against the exponent of 1/|eta_hat|; rows as of `against_eta`."""
    figure = Figure(figsize=SIZE, layout="constrained")
    ax = figure.subplots()
    for place, method in enumerate(METHODS):
        colour, marker = LOOKS[method]
        known = [(exponent, row[place]) for exponent, row in rows if row[place] is not None]
        exponents, times = zip(*known, strict=True)
        size = 12 if method == "quadrature" else 6
        ax.loglog(exponents, times, color=colour, label=method, marker=marker, ms=size)
        if len(known) < len(rows):
            ax.plot(exponents[-1], times[-1], "x", color=colour, ms=15, mew=2.0)
    if any(None in row for _, row in rows):
        ax.plot([], [], "x", color=DARK, ms=9, mew=2.0, label="beyond, the side is not known")
    shown = (1, 3, 6, 12, 30, 100, 300)
    ax.set_xticks(shown, [f"$10^{{-{exponent}}}$" for exponent in shown])
    ax.xaxis.set_minor_locator(NullLocator())
    ax.set_ylim(bottom=0.3)
    legend_below(ax, ncols=3)
    x = r"$|\hat\eta|$ ($\sqrt{g/r}$) towards $F$, decades on a logarithmic axis"
    title = "Quadrature costs the same at any distance from $F$"
    dress(ax, x, "time per passage (µs), one core", title, grid=True)
    add_caption(figure, OF_DISTANCES)
    return figure


def sizes():
    """The part of the page about numbers of samples, with its picture."""
    rows = []
    for name, sizes in (("states", STATES), ("passages", PASSAGES)):
        for samples in sizes:
            for jobs in (1, 2) if joblib.cpu_count() > 1 else (1,):
                rows.append((name, samples, jobs, *measure(name, samples, jobs)))
                print(rows[-1], flush=True)
    save(draw(rows), OUT / "scaling.png")
    lines = [
        "# Time and memory against the number of samples",
        "",
        "Made by `python tests/tools/report_scaling.py`, on an " + processor() + ".",
        "*States*: the scene falling-set. It draws states, and finds their side of the falling set F, their",
        "distance from F and whether they could fall. No rows are stored. *Passages*: the scene race-angles, with",
        "all rows stored on disk. Both times include the summary, but no pictures. Memory is the peak of the",
        "process.",
        "",
        "| work | samples | jobs | samples per second | memory (MB) | faster than one job |",
        "|---|---|---|---|---|---|",
    ]
    single = {(name, n): s for name, n, jobs, s, _ in rows if jobs == 1}
    for name, n, jobs, seconds, memory in rows:
        gain = f"{single[name, n] / seconds:.2f}" if jobs > 1 else ""
        lines.append(f"| {name} | {n:,} | {jobs} | {n / seconds:,.0f} | {memory:.0f} | {gain} |")
    return [*lines, "", "![time against the number of samples](scaling.png)", ""]


def cost():
    """The part of the page about the distance from F, with its picture."""
    rows = against_eta()
    save(draw_cost(rows), OUT / "cost.png")
    return [
        "Microseconds per passage against the distance from F,",
        "at an accuracy of 1e-2, by one job. A dash would mean that the side was unresolved for more",
        "than 1 % of the passages.",
        "",
        "![time of a passage against the distance from F](cost.png)",
        "",
        *eta_lines(rows),
    ]


def main():
    """The whole page."""
    OUT.mkdir(parents=True, exist_ok=True)
    jobs = second_job.lines(BOTH_JOBS, second_job.measure(BOTH_JOBS))
    lines = [*sizes(), *cost(), "", "## What the second job is worth", "", *jobs]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        child(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
    else:
        main()

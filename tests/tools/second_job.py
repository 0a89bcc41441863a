"""What a second job is worth: runs with one job and with two, and what kept their processors from working.

Amdahl's law tells the gain from the share of a run that one process does alone; a machine may give less, where two
processors share a core, its caches or its memory. Both are measured: the run itself with one job and with two, and
two runs of half the samples side by side, which share nothing but the machine.
"""

import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROUNDS = 5
WARM = 1000  # samples of the run before the measured one, which loads the kernels
ONE, BESIDE = "one job", "two runs side by side"
BACKENDS = {"two jobs, threads": "threads", "two jobs, processes": "processes"}
COLUMNS = ("samples per second", "slowest - fastest round", "time (s)", "work (s)", "idle (s)")


class Cost(NamedTuple):
    """Of one measurement, in seconds: what passed, and what all its processors worked."""

    wall: float
    work: float


def worked():
    """Processor time (s) of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def run(samples, jobs, backend):
    """The scene race-angles with all its rows, stored and summarised: its cost."""
    from joblib.externals.loky import get_reusable_executor

    import explorer as ex

    how = {"keep": "all", "figures": False, "progress": False}
    with tempfile.TemporaryDirectory() as folder:
        ex.run("race-angles", samples=WARM, jobs=1, out=Path(folder) / "warm", **how)
        work, begin = worked(), time.perf_counter()
        ex.run("race-angles", samples=samples, jobs=jobs, backend=backend, out=Path(folder) / "run", **how)
        wall = time.perf_counter() - begin
        if backend == "processes":
            get_reusable_executor().shutdown(wait=True)  # workers are counted when they have ended
    return Cost(wall, worked() - work)


def started(samples, jobs=1, backend="threads"):
    """A process that measures one run."""
    command = [sys.executable, __file__, str(samples), str(jobs), backend]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def told(*processes):
    """What such processes, side by side, measured: the longest time, and the work of all."""
    said = [process.communicate()[0] for process in processes]
    if any(process.returncode for process in processes):
        raise RuntimeError("a run failed")
    walls, works = zip(*(json.loads(each.splitlines()[-1]) for each in said), strict=True)
    return Cost(max(walls), sum(works))


def measure(samples, rounds=ROUNDS):
    """Costs of each way, round by round, so that what disturbs the machine disturbs all alike."""
    found = {way: [] for way in (ONE, *BACKENDS, BESIDE)}
    for _ in range(rounds):
        found[ONE].append(told(started(samples)))
        for way, backend in BACKENDS.items():
            found[way].append(told(started(samples, 2, backend)))
        found[BESIDE].append(told(started(samples // 2), started(samples // 2)))
    return found


def lines(samples, found):
    """The part of the page about the second job."""
    best = {way: min(costs) for way, costs in found.items()}  # the least disturbed of several rounds
    yield f"The scene race-angles with {samples:,} samples, all rows stored and summarised. Pictures are left"
    yield "out: one processor draws them at the end, in a second or two for any number of samples. A row is the"
    yield f"fastest of {len(found[ONE])} rounds. *Work* is the processor time of all processes of the run. *Idle*"
    yield "is the rest of the time of two processors."
    yield ""
    yield f"| how | {' | '.join(COLUMNS)} |"
    yield "|---|" + "---|" * len(COLUMNS)
    for way, (wall, work) in best.items():
        rates = sorted(samples / each.wall for each in found[way])
        cells = [f"{samples / wall:,.0f}", f"{rates[0]:,.0f} - {rates[-1]:,.0f}"]
        cells += [f"{seconds:.2f}" for seconds in (wall, work, 2.0 * wall - work)]
        yield f"| {way} | {' | '.join(cells)} |"
    yield ""
    one = best[ONE]
    for way in BACKENDS:
        gain, more = one.wall / best[way].wall, best[way].work - one.work
        alone = min(max(2.0 / gain - 1.0, 0.0), 1.0)
        yield f"With {way.replace(', ', ' as ')}, a run is {gain:.2f} times as fast as with one job,"
        yield f"and its work is {more:+.2f} s more."
        yield f"By Amdahl's law, {100.0 * alone:.0f} % of the work is then not shared:"
        yield "one processor is idle meanwhile."
    most = one.wall / best[BESIDE].wall
    yield f"Two runs that share nothing but the machine are {most:.2f} times as fast as one after the other."
    yield "With two jobs, a run can gain no more than that."


if __name__ == "__main__":
    print(json.dumps(run(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])))

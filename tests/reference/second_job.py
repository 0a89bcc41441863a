"""What a second job is worth: runs with one job and with two, and what kept their processors from working.

Amdahl's law tells the gain from the share of a run that one process does alone; a machine may give less, where two
processors share a core, its caches or its memory. Both are measured: the run itself with one job and with two, and
two runs of half the samples side by side, which share nothing but the machine.
"""

import json
import os
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
WAYS = (ONE, *BACKENDS, BESIDE)
# What the kernel counts of waiting, in microseconds: that some process had no processor, no data from the disk, or
# no memory. For all processes of the machine, since boot.
PRESSURE = Path("/proc/pressure")
STALLS = ("cpu", "io", "memory")
TICKS = Path("/proc/stat")
COLUMNS = (
    "samples per second",
    "slowest - fastest round",
    "time (s)",
    "work (s)",
    "idle (s)",
    "pauses",
    "no processor (s)",
    "disk (s)",
    "memory (s)",
    "stolen (s)",
)
_STOLEN = 8  # its place in the first line: time in which another machine on the same hardware had the processor


class Cost(NamedTuple):
    """Of one measurement, in seconds: what passed, what processors worked, and what stood in the way.

    pauses: how often a thread let go of its processor by itself, for a lock, for data, for another's result.
    waited: by STALLS, None where the system does not tell. stolen: likewise.
    """

    wall: float
    work: float
    pauses: int
    waited: dict[str, float | None]
    stolen: float | None


def waited():
    """Seconds since boot in which some process waited, by what it waited for; None where there is no saying."""
    found = {}
    for name in STALLS:
        try:
            first = (PRESSURE / name).read_text().splitlines()[0]
        except OSError:
            found[name] = None
        else:
            found[name] = int(first.rpartition("total=")[2]) / 1e6
    return found


def stolen():
    """Seconds since boot that other machines took from this one; None where there is no saying."""
    try:
        return int(TICKS.read_text().split()[_STOLEN]) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError, ValueError):
        return None


def gone(after, before):
    """The difference of two numbers, None where one is not known."""
    return None if after is None or before is None else after - before


def worked():
    """Processor time (s) and pauses of this process and of its children that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used), sum(each.ru_nvcsw for each in used)


def run(samples, jobs, backend):
    """The scene race-angles with all its rows, stored and summarised: its cost."""
    from joblib.externals.loky import get_reusable_executor

    import explorer as ex

    with tempfile.TemporaryDirectory() as folder:
        ex.run("race-angles", samples=WARM, jobs=1, keep="all", out=Path(folder) / "warm", progress=False)
        asked = {
            "samples": samples,
            "jobs": jobs,
            "backend": backend,
            "keep": "all",
            "figures": False,
            "progress": False,
        }
        kept, taken, (work, pauses) = waited(), stolen(), worked()
        begin = time.perf_counter()
        ex.run("race-angles", out=Path(folder) / "run", **asked)
        wall = time.perf_counter() - begin
        now, taken_now = waited(), stolen()
        if backend == "processes":
            get_reusable_executor().shutdown(wait=True)  # workers are counted when they have ended
        work_now, pauses_now = worked()
    stalls = {name: gone(now[name], kept[name]) for name in STALLS}
    return Cost(wall, work_now - work, pauses_now - pauses, stalls, gone(taken_now, taken))


def started(samples, jobs=1, backend="threads"):
    """A process that measures one run."""
    command = [sys.executable, __file__, str(samples), str(jobs), backend]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def told(process):
    """What such a process measured."""
    said, _ = process.communicate()
    if process.returncode:
        raise RuntimeError(f"a run ended with code {process.returncode}")
    return Cost(**json.loads(said.splitlines()[-1]))


def together(costs):
    """The cost of runs side by side: the longest, and what all of them did."""
    longest = max(costs, key=lambda cost: cost.wall)
    return longest._replace(work=sum(cost.work for cost in costs), pauses=sum(cost.pauses for cost in costs))


def measure(samples, rounds=ROUNDS):
    """Costs of each way (WAYS), round by round, so that what disturbs the machine disturbs all alike."""
    found = {way: [] for way in WAYS}
    for _ in range(rounds):
        found[ONE].append(told(started(samples)))
        for way, backend in BACKENDS.items():
            found[way].append(told(started(samples, 2, backend)))
        beside = [started(samples // 2) for _ in range(2)]
        found[BESIDE].append(together([told(process) for process in beside]))
    return found


def fastest(costs):
    """The least disturbed of several rounds."""
    return min(costs, key=lambda cost: cost.wall)


def alone(gain):
    """The share of a run that one process does alone, by Amdahl's law from the gain by two; 0 to 1."""
    return min(max(2.0 / gain - 1.0, 0.0), 1.0)


def lines(samples, found):
    """The part of the page about the second job."""
    best = {way: fastest(costs) for way, costs in found.items()}
    yield f"The scene race-angles with {samples:,} samples, all rows stored and summarised. Pictures are left"
    yield "out: one processor draws them at the end, in a second or two for any number of samples. A row is the"
    yield f"fastest of {len(found[ONE])} rounds. *Work* is the processor time of all processes of the run. *Idle*"
    yield "is the rest of the time of two processors. *Pauses* is how often a thread waited for a lock or for"
    yield "data. The last four columns describe the whole machine: seconds in which some process waited for a"
    yield "processor, for the disk or for memory, and seconds taken by other machines on the same hardware."
    yield ""
    yield f"| how | {' | '.join(COLUMNS)} |"
    yield "|---|" + "---|" * len(COLUMNS)
    for way, cost in best.items():
        rates = sorted(samples / each.wall for each in found[way])
        waits = ("not told" if s is None else f"{s:.2f}" for s in (*cost.waited.values(), cost.stolen))
        cells = [f"{samples / cost.wall:,.0f}", f"{rates[0]:,.0f} - {rates[-1]:,.0f}"]
        cells += [f"{s:.2f}" for s in (cost.wall, cost.work, 2.0 * cost.wall - cost.work)]
        yield f"| {way} | {' | '.join([*cells, f'{cost.pauses:,}', *waits])} |"
    yield ""
    one = best[ONE]
    for way in BACKENDS:
        gain, more = one.wall / best[way].wall, best[way].work - one.work
        yield f"With {way.replace(', ', ' as ')}, a run is {gain:.2f} times as fast as with one job,"
        yield f"and does {more:+.2f} s more work."
        yield f"By Amdahl's law, one processor is then idle during {100.0 * alone(gain):.0f} % of the work."
    most = one.wall / best[BESIDE].wall
    yield f"Two runs that share nothing but the machine are {most:.2f} times as fast as one after the other."
    yield "No run can gain more on this machine."


if __name__ == "__main__":
    print(json.dumps(run(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])._asdict()))

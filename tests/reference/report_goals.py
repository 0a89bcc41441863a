"""Writes results/scaling/goals.md: what a user calls against what is aimed for, on the machine at hand.

    python tests/reference/report_goals.py               # about ten minutes on two quiet cores
    python tests/reference/report_goals.py races memory  # some parts only; the others stay as they are

Commands are run as a user types them, each in a process of its own. What is compared takes turns, and the least of
several rounds counts.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tests"))

from processor import processor  # noqa: E402

OUT = ROOT / "results" / "scaling"
NAME = "goals.md"
NEARFLAT = Path(sys.executable).parent / "nearflat"
ROUNDS = 3
SHORT_ROUNDS = 8  # of commands of less than a second
RACES, CHUNK = 10_000_000, 65_536
STATES = 1_000_000_000
INTEGRATED = 8_000_000
METHODS = ("rk4", "rk8", "dopri5", "dop853")


class Cost(NamedTuple):
    """Of a command: seconds that passed, seconds of processors, peak memory (MB)."""

    wall: float
    work: float
    peak: float


def command(*words: object, cache: Path | None = None) -> Cost:
    """Run `nearflat` with these arguments; cache: where compiled kernels are kept, else as the caller has it."""
    return measured([str(NEARFLAT), *map(str, words)], cache)


def measured(words: list[str], cache: Path | None = None) -> Cost:
    """The cost of a process, which must end well."""
    surroundings = os.environ | ({"NUMBA_CACHE_DIR": str(cache)} if cache else {})
    with tempfile.TemporaryFile("w+") as said:
        begin = time.perf_counter()
        process = subprocess.Popen(words, stdout=said, stderr=said, env=surroundings)
        _, state, used = os.wait4(process.pid, 0)
        wall = time.perf_counter() - begin
        process.returncode = os.waitstatus_to_exitcode(state)
        if process.returncode:
            said.seek(0)
            raise RuntimeError(f"{' '.join(words)}: ended with code {process.returncode}\n{said.read()}")
    return Cost(wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0)


def run(scene: str, samples: int, *options: object) -> Cost:
    """The cost of `nearflat run`, whose folder is deleted afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        return command("run", scene, "--samples", samples, "--out", Path(folder) / "run", *options)


def short(count: int) -> str:
    """A power of ten, or a few of them, as users type it."""
    return f"{count:.0e}".replace("e+0", "e").replace("e+", "e")


def least(ways: dict[str, Callable[[], Cost]], rounds: int = ROUNDS) -> dict[str, Cost]:
    """The quickest of several rounds of each, in turns; one call of each goes before, and compiles."""
    for way in ways.values():
        way()
    found: dict[str, list[Cost]] = {name: [] for name in ways}
    for _ in range(rounds):
        for name, way in ways.items():
            found[name].append(way())
    return {name: Cost(*map(min, zip(*costs, strict=True))) for name, costs in found.items()}


def itself(part: str, *words: object) -> Cost:
    """The cost that a process of this file prints: what it computes, without its start."""
    said = subprocess.run(
        [sys.executable, __file__, f"--{part}", *map(str, words)], capture_output=True, text=True, check=True
    )
    return Cost(*json.loads(said.stdout.splitlines()[-1]))


def clocked(work: Callable[[], object]) -> Cost:
    """The cost of a call in this process; its memory is not told."""
    begin, used = time.perf_counter(), time.process_time()
    work()
    return Cost(time.perf_counter() - begin, time.process_time() - used, 0.0)


def drawn(count: int, decades: tuple[float, float] = (-6.0, -2.0)) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """sigma3_bar, eta_hat and phidot, drawn as the scene race-angles draws them."""
    random = np.random.default_rng(0)
    eta_hat = random.choice([-1.0, 1.0], count) * 10.0 ** random.uniform(*decades, count)
    return random.uniform(-2.0, 2.0, count), eta_hat, random.uniform(0.5, 2.0, count)


def child_passages(samples: str, size: str) -> Cost:
    """`explorer.passages` on as many samples, so many in a call."""
    import explorer as ex

    disk, starts, step = ex.Disk.uniform(), drawn(int(samples)), int(size)
    ex.passages(disk, *(start[:step] for start in starts), accuracy=1e-6)

    def every() -> None:
        for first in range(0, int(samples), step):
            ex.passages(disk, *(start[first : first + step] for start in starts), accuracy=1e-6)

    return clocked(every)


def child_sift(samples: str, jobs: str) -> Cost:
    """Draw, judge and sift as many states in the chunks of the scene falling-set; nothing is stored."""
    from joblib import Parallel, delayed

    from explorer.measure.sifting import Chunk, sift
    from explorer.scenes.falling_set import FallingSet

    scene = FallingSet(samples=int(samples))

    def one(index: int) -> int:
        return sift(
            scene.disk, scene.box, Chunk(0, index, scene.length(index), scene.block), scene.tube
        ).could_fall

    one(0)
    return clocked(lambda: Parallel(n_jobs=int(jobs), backend="threading")(map(delayed(one), range(scene.chunks))))


def child_trade(low: str, high: str, disk: str, count: str) -> Cost:
    """Quadrature at 1e-3 against itself at 1e-11: the quickest call of each, as wall and work of the answer."""
    import explorer as ex

    body, starts = getattr(ex.Disk, disk)(), drawn(int(count), (float(low), float(high)))
    best = dict.fromkeys((1e-3, 1e-11), np.inf)
    for _ in range(max(12, 4_000_000 // int(count))):
        for accuracy in best:
            work = clocked(lambda asked=accuracy: ex.passages(body, *starts, accuracy=asked)).work
            best[accuracy] = min(best[accuracy], work)
    return Cost(best[1e-11], best[1e-3], 0.0)


def table(heads: str, rows: list[list[str]]) -> Iterator[str]:
    """A table; heads are separated by bars."""
    yield f"| {heads} |"
    yield "|---" * (heads.count("|") + 1) + "|"
    for row in rows:
        yield f"| {' | '.join(row)} |"
    yield ""


def trade() -> Iterator[str]:
    """Quadrature against itself."""
    yield '`explorer.passages(..., method="quadrature")`, processor time at 1e-11 over that at 1e-3. Goal: 3.'
    yield ""
    rows = []
    for disk in ("uniform", "hoop"):
        for decades in ((-6.0, -1.0), (-8.0, 0.0)):
            for count in (20_480, 1_000_000):
                cost = itself("trade", *decades, disk, count)
                within = f"1e{decades[0]:.0f} to 1e{decades[1]:.0f}"
                rows.append([disk, within, f"{count:,}", f"{cost.wall / cost.work:.2f}"])
    yield from table("disk | abs(eta_hat) | samples in a call | times as fast", rows)


def races() -> Iterator[str]:
    """The scene race-angles against its passages."""
    options = ("--jobs", 1)
    cost = least(
        {
            "passages, one call": lambda: itself("passages", RACES, RACES),
            f"passages, calls of {CHUNK:,}": lambda: itself("passages", RACES, CHUNK),
            "--keep none --no-figures": lambda: run(
                "race-angles", RACES, "--keep", "none", "--no-figures", *options
            ),
            "--keep none": lambda: run("race-angles", RACES, "--keep", "none", *options),
            "--keep all --no-figures": lambda: run(
                "race-angles", RACES, "--keep", "all", "--no-figures", *options
            ),
            "--keep all": lambda: run("race-angles", RACES, "--keep", "all", *options),
        }
    )
    calls = list(cost)[:2]
    yield f"`nearflat run race-angles --samples {short(RACES)} --jobs 1`, the whole command, against"
    yield "`explorer.passages` on as many samples in a process that has started. Time on the clock."
    yield "Goals: 1.5 with `--keep none`, 3 with `--keep all`."
    yield ""
    rows = [
        [name, *(f"{cost[name].wall / cost[call].wall:.2f}" for call in calls)]
        for name in cost
        if name not in calls
    ]
    yield from table(f"options | times {calls[0]} | times {calls[1]}", rows)


def sifting() -> Iterator[str]:
    """The scene falling-set against drawing and sifting alone, and how many states in a second."""
    seen = {}
    for jobs in (1, 2):
        asked = ("--jobs", jobs)
        seen |= {
            (jobs, "sifting"): lambda jobs=jobs: itself("sift", STATES, jobs),
            (jobs, "--keep none"): lambda asked=asked: run("falling-set", STATES, "--keep", "none", *asked),
            (jobs, "--keep near"): lambda asked=asked: run("falling-set", STATES, "--keep", "near", *asked),
        }
    cost = {name: min(way() for _ in range(2)) for name, way in seen.items()}
    yield f"`nearflat run falling-set --samples {short(STATES)}`, the whole command with its pictures, against"
    yield "drawing and sifting alone in a process that has started. Time on the clock. Goals: 1.5 with"
    yield "`--keep near`; all drawn and classified by two jobs in 8 s, which is 125 million states a second."
    yield ""
    rows = [
        [
            str(jobs),
            name,
            f"{each.wall / cost[jobs, 'sifting'].wall:.2f}",
            f"{STATES / each.wall / 1e6:.0f}",
            f"{cost[1, name].wall / each.wall:.2f}" if jobs > 1 else "",
        ]
        for (jobs, name), each in cost.items()
    ]
    yield from table("jobs | what | times sifting | million states a second | faster than one job", rows)


def integrated() -> Iterator[str]:
    """theta_min by Runge-Kutta for every state."""
    asked = ("--accuracy", "1e-3", "--theta-min", "all", "--keep", "none", "--jobs", 2)
    ways = {
        name: lambda name=name: run("falling-set", INTEGRATED, "--method", name, *asked)
        for name in (*METHODS, "quadrature")
    }
    cost = least(ways, rounds=2)
    yield f"`nearflat run falling-set --samples {short(INTEGRATED)} --method ... {' '.join(map(str, asked))}`,"
    yield "theta_min of every state, the whole command with its pictures. Goal: 1 million states a second."
    yield ""
    rows = [[name, f"{INTEGRATED / each.wall / 1e6:.2f}"] for name, each in cost.items()]
    yield from table("method | million states a second", rows)


def second_job() -> Iterator[str]:
    """Whole commands with one job and with two."""
    yield "`nearflat run race-angles --keep none`, the whole command: one job's time over two jobs'. Goal: 1.8"
    yield "from a million samples on. What waits where is told in [README.md](README.md)."
    yield ""
    rows = []
    for samples in (10**6, 10**7):
        for figures in ((), ("--no-figures",)):
            ways = {
                jobs: lambda jobs=jobs, n=samples, f=figures: run(
                    "race-angles", n, "--keep", "none", "--jobs", jobs, *f
                )
                for jobs in (1, 2)
            }
            cost = least(ways)
            pictures = "no" if figures else "yes"
            rows.append([f"{samples:,}", pictures, f"{cost[1].wall / cost[2].wall:.2f}"])
    yield from table("samples | pictures | times as fast", rows)


WARM = {
    "nearflat --help": ("--help",),
    "nearflat plan falling-set --samples 1e9": ("plan", "falling-set", "--samples", "1e9"),
    "nearflat plan race-angles --samples 1e7": ("plan", "race-angles", "--samples", "1e7"),
    "nearflat passage": ("passage", "--disk", "hoop", "--sigma3-bar", 1, "--eta-hat", "-1e-6", "--phidot", 1),
}


def starts() -> Iterator[str]:
    """What commands take when their kernels are compiled, and when nothing is."""
    warm = least({name: lambda words=words: command(*words) for name, words in WARM.items()}, SHORT_ROUNDS)
    goals = (0.2, 0.8, 0.8, 0.8)
    yield "Kernels compiled before: processor time. Nothing compiled: time on the clock of two processors."
    yield ""
    rows = [
        [f"`{name}`", "warm", f"{each.work:.2f}", f"{goal}"]
        for (name, each), goal in zip(warm.items(), goals, strict=True)
    ]
    for name, words, goal in (
        ("nearflat passage", WARM["nearflat passage"], 12),
        ("nearflat demo", ("demo",), 45),
    ):
        with tempfile.TemporaryDirectory() as cache:
            out = ("--out", Path(cache) / "out") if name.endswith("demo") else ()
            cost = command(*words, *out, cache=Path(cache) / "kernels")
        rows.append([f"`{name}`", "nothing compiled", f"{cost.wall:.1f}", str(goal)])
    yield from table("command | state | seconds | goal", rows)


def memory() -> Iterator[str]:
    """Peaks of memory against the number of samples."""
    yield "Peak memory of the whole command, two jobs (MB). Goal: the same for any number of samples."
    yield ""
    rows = []
    for scene, keep, sizes in (
        ("race-angles", "none", (10**6, 10**7)),
        ("race-angles", "all", (10**6, 10**7)),
        ("falling-set", "near", (10**7, 10**8, 10**9)),
    ):
        for samples in sizes:
            peak = run(scene, samples, "--keep", keep, "--jobs", 2).peak
            rows.append([f"{scene} --keep {keep}", f"{samples:,}", f"{peak:.0f}"])
    yield from table("command | samples | peak memory", rows)


PARTS = {
    "trade": ("Quadrature at 1e-3 against itself at 1e-11", trade),
    "races": ("A stored run against its passages", races),
    "second": ("The second job", second_job),
    "sifting": ("A billion states", sifting),
    "integrated": ("The smallest tilt by Runge-Kutta", integrated),
    "starts": ("Starting", starts),
    "memory": ("Memory", memory),
}
HEAD = """# What a user calls, against what is aimed for

Made by `python tests/reference/report_goals.py` on an {on}. All through the commands and
functions that users call, quickest of several rounds. Ratios are of one part of one run; machines
differ. Integrators and quadrature against other packages: [peers](../peers/README.md); accuracy asked and
paid for: [shares](../trade/shares.md)."""


def page(made: dict[str, list[str]]) -> str:
    """The page, its parts in order; those that are not made anew stay as they are."""
    file = OUT / NAME
    before = file.read_text("utf-8").split("\n## ")[1:] if file.exists() else []
    told = {part.partition("\n")[0]: part.partition("\n")[2].strip("\n") for part in before}
    sections = [HEAD.format(on=processor())]
    for name, (title, _) in PARTS.items():
        text = "\n".join(made[name]).strip("\n") if name in made else told.get(title)
        if text:
            sections.append(f"## {title}\n\n{text}")
    return "\n\n".join(sections) + "\n"


def main(names: list[str]) -> None:
    """Make the parts that are named, all where none is."""
    for name in names or PARTS:
        lines = list(PARTS[name][1]())
        print("\n".join(lines), flush=True)
        (OUT / NAME).write_text(page({name: lines}), encoding="utf-8")


CHILDREN = {"--passages": child_passages, "--sift": child_sift, "--trade": child_trade}

if __name__ == "__main__":
    if sys.argv[1:2] and sys.argv[1] in CHILDREN:
        print(json.dumps(CHILDREN[sys.argv[1]](*sys.argv[2:])))
    else:
        main(sys.argv[1:])

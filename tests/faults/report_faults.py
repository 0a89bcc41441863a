"""Writes results/faults/: what was broken, how often, and what became of it.

    python tests/faults/report_faults.py        # some minutes; Linux

Runs are killed, their workers are killed, files are spoilt, disks are filled; then they are continued
and must end with the digest of a run that nothing happened to.
"""

import itertools
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import psutil

import explorer as ex

OUT = Path(__file__).parents[2] / "results" / "faults"
KILLS, WORKER_KILLS, SPOILT = 32, 10, 200
OPTIONS = {"samples": 400_000, "eta_hat": "1e-6:1e-2", "chunk_size": 8192, "keep": "all"}
CHUNKS = -(-OPTIONS["samples"] // OPTIONS["chunk_size"])

# A run in a process of its own. Every start of a chunk is written down; a fault may be built in.
CHILD = """
import errno, os, signal, sys
from pathlib import Path
import explorer as ex
from explorer.runs import store
from explorer.scenes.scene import SampledScene
folder, jobs, backend, resume, point, number, options = eval(sys.argv[1])
calls = 0
def trip(name):
    global calls
    calls += name == point
    if name == point and calls == number:
        os.kill(os.getpid(), signal.SIGKILL)
def wrap(owner, attribute, before, after):
    inner = getattr(owner, attribute)
    def outer(*a, **k):
        trip(before)
        got = inner(*a, **k)
        trip(after)
        return got
    setattr(owner, attribute, outer)
if point and not point.startswith("error"):
    wrap(store, "_write_parquet", "before write", "after write")
    wrap(os, "fsync", "before fsync", "after fsync")
    wrap(Path, "replace", "before rename", "after rename")
if point.startswith("error"):
    target = {"close": (os, "fsync"), "rename": (Path, "replace")}
    owner, attribute = target[point.split()[1]]
    inner = getattr(owner, attribute)
    def failing(*a, **k):
        global calls
        calls += 1
        if calls > number:
            code = errno.EDQUOT if number % 2 else errno.ENOSPC
            raise OSError(code, os.strerror(code))
        return inner(*a, **k)
    setattr(owner, attribute, failing)
plain = SampledScene.blocks
def noted(scene, index):
    with open(str(folder) + ".started", "a") as log:
        print(index, file=log)
    return plain(scene, index)
if backend == "threads":
    SampledScene.blocks = noted
how = {"jobs": jobs, "backend": backend, "exist": "resume" if resume else "error", "progress": False}
try:
    done = ex.run("race-angles", out=folder, figures=False, **how, **options)
except Exception as error:
    sys.exit(f"{type(error).__name__}: {error}")
print(done.summary["digest"])
"""


def start(folder, *, jobs=2, backend="threads", resume=False, point="", number=0, options=OPTIONS):
    arguments = repr((str(folder), jobs, backend, resume, point, number, options))
    return subprocess.Popen(
        [sys.executable, "-c", CHILD, arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def finish(folder, **options):
    """The digest at the end, or a raised error with what the run said."""
    run = start(folder, **options)
    out, err = run.communicate(timeout=300)
    if run.returncode != 0:
        raise RuntimeError(err)
    return out.split()[-1]


def chunk_files(folder):
    """The chunk files of a run by number."""
    return {int(path.name[6:12]): path for path in folder.glob("chunks/chunk-*.parquet")}


def wait_for(run, folder, chunks):
    """Until so many chunks are there or the run has ended."""
    while run.poll() is None and len(chunk_files(folder)) < chunks:
        time.sleep(0.002)


def started(folder):
    log = Path(f"{folder}.started")
    return len(log.read_text().split()) if log.exists() else 0


def kills(place, digest):
    """kill -9 of a run, half of them at a random number of chunks, half at given points of a write."""
    draw = random.Random(1)
    points = [f"{when} {what}" for what in ("write", "fsync", "rename") for when in ("before", "after")]
    same = extra = 0
    for trial in range(KILLS):
        folder = place / f"kill-{trial}"
        if trial % 2:
            point = points[trial // 2 % len(points)]
            run = start(folder, point=point, number=draw.randint(3, CHUNKS))
            run.communicate()
            assert run.returncode == -signal.SIGKILL, point
        else:
            run = start(folder)
            wait_for(run, folder, draw.randint(0, CHUNKS - 10))
            time.sleep(draw.uniform(0.0, 0.01))
            run.kill()
            run.communicate()
        same += finish(folder, resume=(folder / "run.json").exists()) == digest
        extra = max(extra, started(folder) - CHUNKS)
    return f"{same}/{KILLS} resumed to the same digest; at most {extra} chunks computed twice, with 2 workers"


def worker_kills(place, digest, backend):
    """A cluster goes on with other workers; processes end with a sentence, and are resumed."""
    draw = random.Random(2)
    same = killed = alone = told = 0
    for trial in range(WORKER_KILLS):
        folder = place / f"{backend}-{trial}"
        run = start(folder, backend=backend)
        wait_for(run, folder, draw.randint(2, CHUNKS - 20))
        workers = [
            child
            for child in psutil.Process(run.pid).children(recursive=True)
            if "resource_tracker" not in " ".join(child.cmdline())
        ]
        victims = [w for w in workers if not w.children()]
        if victims and run.poll() is None:
            draw.choice(victims).kill()
            killed += 1
        out, err = run.communicate(timeout=300)
        alone += run.returncode == 0
        told += run.returncode == 1 and len(err.strip().splitlines()) == 1 and "continue with" in err
        same += (out.split()[-1] if run.returncode == 0 else finish(folder, resume=True)) == digest
    return (
        f"{killed} workers killed; {alone} of {WORKER_KILLS} runs went on to their end, {told} stopped with a "
        f"message and were resumed; {same}/{WORKER_KILLS} with the same digest"
    )


def spoil(place, digest):
    """Single flipped bits, truncations, swapped and foreign chunks."""
    whole, other = place / "whole", place / "other"
    finish(other, options={**OPTIONS, "seed": 1})
    draw = random.Random(3)
    mine, theirs = chunk_files(whole), chunk_files(other)
    found = 0
    for trial in range(SPOILT):
        path = mine[draw.randrange(CHUNKS)]
        content = path.read_bytes()
        kind = ("bit", "bit", "cut", "swap", "foreign")[trial % 5]
        if kind == "bit":
            broken = bytearray(content)
            broken[draw.randrange(len(broken))] ^= 1 << draw.randrange(8)
        elif kind == "cut":
            broken = content[: draw.randrange(len(content))]
        else:
            source = mine if kind == "swap" else theirs
            broken = source[draw.choice([i for i in source if source[i].name != path.name])].read_bytes()
        path.write_bytes(broken)
        faults = ex.open(whole).verify()
        found += len(faults) == 1 and path.name in faults[0]
        path.write_bytes(content)
    spoilt = draw.sample(range(CHUNKS), 20)
    for index in spoilt:
        mine[index].write_bytes(mine[index].read_bytes()[:-1])
    before = started(whole)
    same = finish(whole, resume=True) == digest
    again = started(whole) - before
    return (
        f"{found}/{SPOILT} found by verify, each by name; 20 spoilt at once: resume computed {again} chunks, "
        f"same digest: {'yes' if same else 'no'}"
    )


def full_disk(place, digest):
    """A small tmpfs where one may be mounted, and errors at each step of a write."""
    lines = []
    disk = place / "disk"
    disk.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=20m", "tmpfs", str(disk)], capture_output=True, check=False
    )
    if mounted.returncode == 0:
        try:
            run = start(disk / "run")
            _, err = run.communicate(timeout=300)
            intact = len(chunk_files(disk / "run"))
            told = err.strip().splitlines()[-1]
            subprocess.run(["mount", "-o", "remount,size=500m", str(disk)], check=True)
            same = finish(disk / "run", resume=True) == digest
            lines.append(
                f"tmpfs of 20 MB is full: one line says so ({told[:60]}...), {intact} chunks intact, same digest "
                f"after resuming: {'yes' if same else 'no'}"
            )
        finally:
            subprocess.run(["umount", str(disk)], check=True)
    else:
        lines.append("tmpfs: could not be mounted here")
    same = one_line = trials = 0
    for step, number in itertools.product(("close", "rename"), (20, 31)):
        folder = place / f"error-{step}-{number}"
        run = start(folder, point=f"error {step}", number=number)
        _, err = run.communicate(timeout=300)
        one_line += len(err.strip().splitlines()) == 1 and str(folder) in err
        same += finish(folder, resume=True) == digest
        trials += 1
    lines.append(
        f"no space or quota when a file is closed or renamed: {one_line}/{trials} stopped with one line that "
        f"names the path, {same}/{trials} resumed to the same digest"
    )
    return "; ".join(lines)


def main():
    OUT.mkdir(parents=True, exist_ok=True)
    rows = []
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        digest = finish(place / "whole")
        faults = (
            ("kill -9 of the run", lambda: kills(place, digest)),
            ("kill -9 of a worker, processes", lambda: worker_kills(place, digest, "processes")),
            ("kill -9 of a worker, dask", lambda: worker_kills(place, digest, "dask")),
            ("flipped bits, truncations, swapped and foreign chunks", lambda: spoil(place, digest)),
            ("full disk, quota, write errors", lambda: full_disk(place, digest)),
        )
        for fault, make in faults:
            rows.append((fault, make().replace(str(place), "")))
            print(*rows[-1], sep=": ", flush=True)
    lines = [
        "# Faults",
        "",
        "Made by `python tests/faults/report_faults.py`. The run is race-angles, with "
        f"{OPTIONS['samples']:,} samples in {CHUNKS} chunks, all kept,",
        "and 2 workers. Every digest is compared with that of an undisturbed run.",
        "",
        "| fault | what happened |",
        "|---|---|",
        *(f"| {fault} | {found} |" for fault, found in rows),
        "",
        "[moments.md](moments.md) has runs that were stopped by signals, for each backend. `fuzz.json` has the",
        "results of random calls, command lines and edited folders (`nox -s fuzz`).",
    ]
    (OUT / "README.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

"""Runs that are stopped at random moments, and whether they keep their promises. One JSON line for each.

    python tests/tools/moments.py FOLDER BACKEND COUNT SEED [SAMPLES] >> LINES    # Linux
    python tests/tools/moments.py --table LINES    # writes results/faults/README.md

BACKEND is serial, threads, processes or dask.

Every run is a fork of this process, which has loaded and compiled everything: a moment costs one to two seconds.
Promised are the exit status (once all is done a signal may end the program as it ends any); silence about anything
but the stop; that no process is left after 30 s; that every chunk which is there is whole; and that going on ends
with the digest of an undisturbed run.
"""

import fcntl
import json
import os
import pty
import random
import shutil
import signal
import sys
import termios
import time
from collections import Counter
from pathlib import Path

import pandas  # noqa: F401 - these are loaded before the fork
import psutil
import pyarrow.parquet  # noqa: F401
import scipy.stats  # noqa: F401

from explorer import compiled
from explorer.commands import runs  # noqa: F401 - before the fork
from explorer.commands.main import main
from explorer.scenes.scene import scene_class

# How a run is stopped, and the exit statuses that are promised; all may also be done before, with status 0.
PROMISED = {
    "SIGINT": 130,
    "SIGTERM": 130,
    "SIGHUP": 130,
    "SIGINT, then SIGTERM": 130,
    "SIGINT twice, to the group": 130,
    "stdout closed": 141,
    "stderr closed": 141,
    "terminal closed": 130,
    "SIGKILL": -signal.SIGKILL,
}
OUT = Path(__file__).parents[2] / "results" / "faults" / "README.md"
# By a slow method, so that most of a run is the making of chunks and not its beginning and its end.
METHOD = {"method": "rk4", "accuracy": 1e-7}
CHUNKS = 10
OPTIONS = {"scene": "race-angles", "samples": CHUNKS * 2048, "chunk_size": 2048, "keep": "all", **METHOD}
_UGLY = ("Traceback", "Fatal Python", "Exception ignored", "terminate called", "Warning", "leaked")
_ORPHANS, _ENDS = 30.0, 60.0  # seconds


class Child(BaseException):
    """Leads from a fork to the end of this file, with the words of the command."""


class Fork:
    """The command in a session of its own, with its streams in a pipe each or on a terminal."""

    def __init__(self, words, terminal=False):
        if terminal:
            outer, inner = pty.openpty()
            self.readers, writers = {0: outer}, (inner, inner)
        else:
            (first, out), (second, err) = os.pipe(), os.pipe()
            self.readers, writers = {1: first, 2: second}, (out, err)
        self.pid = os.fork()
        if self.pid == 0:
            os.setsid()
            if terminal:
                fcntl.ioctl(inner, termios.TIOCSCTTY, 0)
                os.dup2(inner, 0)
            for number, writer in enumerate(writers, 1):
                os.dup2(writer, number)
            for handle in {*writers, *self.readers.values()}:
                os.close(handle)
            # A shell's background job, or nohup, ignores these, and so would all that begins here.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.signal(signal.SIGHUP, signal.SIG_DFL)
            raise Child(list(map(str, words)))
        for writer in set(writers):
            os.close(writer)
        self.status, self.text = None, {1: b"", 2: b"", 0: b""}
        for handle in self.readers.values():
            os.set_blocking(handle, False)

    def ended(self):
        """Whether it has ended; what it said so far is read."""
        for number, handle in self.readers.items():
            try:
                while piece := os.read(handle, 1 << 16):
                    self.text[number] += piece
            except OSError:  # nothing there, or no terminal any more
                pass
        if self.status is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = os.waitstatus_to_exitcode(status)
        return self.status is not None

    def began(self):
        """Whether the command handles signals: SIGTERM has a handler."""
        for line in Path(f"/proc/{self.pid}/status").read_text().splitlines():
            if line.startswith("SigCgt"):
                return bool(int(line.split()[1], 16) >> (signal.SIGTERM - 1) & 1)
        return False

    def wait(self, seconds):
        limit = time.monotonic() + seconds
        while not self.ended() and time.monotonic() < limit:
            time.sleep(0.002)
        return self.status

    def close(self, *numbers):
        for number in numbers or list(self.readers):
            os.close(self.readers.pop(number))

    def stop(self, how):
        """Do what `how` says."""
        if how.endswith("closed"):
            self.close({"terminal": 0, "stdout": 1, "stderr": 2}[how.split()[0]])
        elif "," in how:
            os.killpg(self.pid, signal.SIGINT) if "group" in how else os.kill(self.pid, signal.SIGINT)
            time.sleep(0.02)
            if not self.ended():
                os.killpg(self.pid, signal.SIGINT) if "group" in how else os.kill(self.pid, signal.SIGTERM)
        else:
            os.kill(self.pid, getattr(signal, how))


def to_the_end(*words):
    """Exit status, stdout and stderr of a command."""
    fork = Fork(words)
    status = fork.wait(300.0)
    fork.close()
    return status, fork.text[1].decode(), fork.text[2].decode()


def is_finished(folder):
    """Whether the run in a folder has nothing left to do."""
    record = folder / "run.json"
    return record.exists() and "finished" in json.loads(record.read_text())


def stopped(words, folder, how, moment, chunks):
    """Start a run, stop it so many seconds after the command began and that many chunks were there.

    Returns the exit status, whether it had ended before, and every broken promise.
    """
    fork = Fork(words, terminal=how.startswith("terminal"))
    while not fork.ended() and not fork.began():
        time.sleep(0.001)
    while not fork.ended() and len(list(folder.glob("chunks/chunk-*.parquet"))) < chunks:
        time.sleep(0.002)
    fork.wait(moment)
    before, family = fork.status is not None, []
    if not before:
        family = psutil.Process(fork.pid).children(recursive=True)
        fork.stop(how)
    status = fork.wait(_ENDS)
    said = b"".join(fork.text.values()).decode()
    fork.close()
    broken = []
    if status is None:
        broken.append(f"it did not end within {_ENDS:.0f} s")
        os.kill(fork.pid, signal.SIGKILL)
        os.waitpid(fork.pid, 0)
    elif status not in (0, PROMISED[how]) and not (status < 0 and is_finished(folder)):
        broken.append(f"exit status {status}")
    broken += [f"it said: {said[-400:]}" for text in _UGLY if text in said]
    _, alive = psutil.wait_procs(family, timeout=_ORPHANS)
    broken += [f"still alive: {' '.join(each.cmdline())[:80]}" for each in alive]
    return status, before, broken


def look(words, folder, digest):
    """Broken promises about what a stopped run left, and of going on with it."""
    broken = []
    status, said, complaint = to_the_end(*words, "--json")
    if status != 0 or json.loads(said)["digest"] != digest:
        broken.append(f"resumed: {complaint or said}"[:300])
    if "put aside" in complaint:
        broken.append(complaint[:300])
    broken += [f"left behind: {path.name}" for path in folder.rglob("*.tmp")]
    return broken


def moments(place, backend, count, seed, chunk_size):
    """Stop `count` runs of a backend at random moments; a line for each."""
    place.mkdir(parents=True, exist_ok=True)
    scene = place / "races.toml"
    options = {**OPTIONS, "samples": CHUNKS * chunk_size, "chunk_size": chunk_size}
    scene.write_text("".join(f"{key} = {value!r}\n" for key, value in options.items()))
    asked = ["run", scene, "--no-figures", "--resume", "--out"]
    by = ["--backend", "threads", "--jobs", 1] if backend == "serial" else ["--backend", backend]
    for name in ("first", "whole"):  # the first takes longer than those that follow
        began = time.monotonic()
        digest = json.loads(to_the_end(*asked, place / name, "--json", *by)[1])["digest"]
    longest, draw = time.monotonic() - began, random.Random(seed)
    for trial in range(count):
        how = list(PROMISED)[(seed + trial) % len(PROMISED)]
        # Half of them while chunks are made, half at any time, since a run has a beginning and an end, too.
        least, moment = 0, draw.uniform(0.0, longest)
        if trial % 2:
            least, moment = draw.randrange(CHUNKS), draw.uniform(0.0, 0.02)
        folder = place / f"{backend}-{trial}"
        words = [*asked, folder]
        status, before, broken = stopped([*words, *by], folder, how, moment, least)
        chunks = len(list(folder.glob("chunks/chunk-*.parquet")))
        if status == 0 and chunks < CHUNKS:
            broken.append(f"it ended well with {chunks} chunks")
        broken += look(words, folder, digest)
        shutil.rmtree(folder, ignore_errors=True)
        row = {
            "backend": backend,
            "how": how,
            "moment": round(moment, 3),
            "status": status,
            "before": before,
            "chunks": chunks,
        }
        print(json.dumps({**row, "broken": broken}), flush=True)


def table(lines):
    """A row for each backend and way to stop: how many runs, how they ended, and broken promises."""
    found = [json.loads(line) for line in lines.read_text(encoding="utf-8").splitlines()]
    what = "race-angles by {method} at {accuracy}, {samples:,} samples in chunks of {chunk_size:,}"
    text = [
        "# Runs stopped at random moments",
        "",
        "Made by `python tests/tools/moments.py`. Each run is stopped at a random moment and then continued.",
        f"Half of them are stopped while chunks are made. The run: {what.format(**OPTIONS)}. A promise is broken",
        "in any of these cases: the exit status is neither the promised one nor 0; a traceback or the like is",
        f"printed; a process is alive after {_ORPHANS:.0f} s; a file is left that is not a chunk; the continued",
        "run has another digest.",
        "",
        "| backend | stopped by | runs | ended before | exit status | promised | chunks left | promises broken |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for backend in dict.fromkeys(row["backend"] for row in found):
        for how, promised in PROMISED.items():
            rows = [row for row in found if (row["backend"], row["how"]) == (backend, how)]
            if not rows:
                continue
            ends = Counter(row["status"] for row in rows)
            ends = ", ".join(f"{status} ({count})" for status, count in sorted(ends.items(), key=str))
            chunks = sorted(row["chunks"] for row in rows)
            before, broken = (sum(bool(row[name]) for row in rows) for name in ("before", "broken"))
            cells = (backend, how, len(rows), before, ends, promised, f"{chunks[0]} to {chunks[-1]}", broken)
            text.append("| " + " | ".join(map(str, cells)) + " |")
    text += [
        "",
        "Damaged files, failing system calls, lost workers and full disks are tests: `tests/explorer/runs/`.",
        "`fuzz.json` has the results of random calls, command lines and edited folders (`nox -s fuzz`).",
    ]
    OUT.write_text("\n".join(text) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1] == "--table":
        sys.exit(table(Path(sys.argv[2])))
    compiled.warmup(scene_class("race-angles").of(METHOD).kernels)
    try:
        count, seed, chunk_size = map(int, (*sys.argv[3:], OPTIONS["chunk_size"])[:3])
        moments(Path(sys.argv[1]), sys.argv[2], count, seed, chunk_size)
    except Child as child:
        sys.argv = ["nearflat", *child.args[0]]
        sys.exit(main())

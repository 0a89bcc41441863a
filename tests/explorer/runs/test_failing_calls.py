"""Every call on the folder of a run fails once: one sentence, never a wrong answer, and the run goes on."""

import builtins
import contextlib
import errno
import io
import json
import os
import shutil
import threading
from pathlib import Path

import pyarrow as pa
import pytest
from coins import Coins

import explorer as ex
from explorer.commands.main import main

ASKED = {"samples": 700, "seed": 5, "chunk_size": 512, "jobs": 1, "progress": False}  # two chunks
CALLS = [
    (builtins, "open"),
    (io, "open"),
    (os, "open"),
    (os, "fsync"),
    (os, "replace"),
    (os, "mkdir"),
    (os, "listdir"),
]
CALLS += [(os, "scandir"), (os, "unlink"), (pa, "OSFile")]


class Failing:
    """Counts calls on a folder, and has one of them fail."""

    def __init__(self, folder, number):
        self.folder, self.left, self.lock = str(folder), number, threading.Lock()

    def __call__(self, about):
        """Raise an error where it is the turn of this call. about: a path, or the number of an open file."""
        with self.lock:
            if isinstance(about, int) or os.fspath(about).startswith(self.folder):
                self.left -= 1
                if self.left == 0:
                    code = errno.ENOSPC if os.getpid() % 2 else errno.EIO
                    raise OSError(code, os.strerror(code))


class Stream(io.BufferedWriter):
    """A file that is written, whose disk may be full."""

    def write(self, content):
        self.fails(self.raw.name)
        return super().write(content)


@contextlib.contextmanager
def failing(folder, number, monkeypatch):
    """Of the calls on the folder, the one with this number fails."""
    fails = Failing(folder, number)

    def wrapped(call):
        def outer(about, *rest, **more):
            fails(about)
            if call is io.open and rest[:1] == ("wb",):
                stream = Stream(io.FileIO(about, "w"))
                stream.fails = fails
                return stream
            return call(about, *rest, **more)

        return outer

    with monkeypatch.context() as patch:
        for owner, name in CALLS:
            patch.setattr(owner, name, wrapped(getattr(owner, name)))
        yield fails


STORED, DRAWN = ("", {"figures": False}, 40), ("figures", {"format": "svg"}, 3)


@pytest.mark.parametrize(("place", "how", "least"), [STORED, DRAWN], ids=["stored", "drawn"])
def test_each_call_of_a_run_may_fail_once_and_the_run_goes_on(place, how, least, tmp_path, monkeypatch):
    folder, digest = tmp_path / "run", ex.run(Coins, **ASKED).summary["digest"]
    for number in range(1, 1000):
        told = str(folder)
        with failing(folder / place, number, monkeypatch) as fails:
            try:
                assert ex.run(Coins, out=folder, **how, **ASKED).summary["digest"] == digest
            except (ex.RunError, ex.InputError) as error:
                told = str(error)
        assert str(folder) in told, number
        run = ex.run(Coins, out=folder, **how, **ASKED)
        assert (run.summary["digest"], run.status.missing, run.verify()) == (digest, (), []), number
        assert not [*folder.rglob("*.tmp"), *folder.glob("bad/*"), *folder.glob("figures/.*")]
        shutil.rmtree(folder)
        if fails.left > 0:
            break
    assert least < number < 1000


@pytest.mark.parametrize("command", ["status", "verify", "summary", "resume"])
def test_each_call_of_a_command_that_looks_at_a_run_may_fail_once(command, finished, monkeypatch, capsys):
    digest = finished.summary["digest"]
    before = {path: path.read_bytes() for path in Path(finished.folder).rglob("*") if path.is_file()}
    assert main([command, str(finished.folder), "--json"]) == 0
    right = capsys.readouterr().out
    for number in range(1, 1000):
        with failing(finished.folder, number, monkeypatch) as fails:
            status = main([command, str(finished.folder), "--json", "--quiet"])
        out, err = capsys.readouterr()
        if status:
            assert (status in (1, 2), len(err.splitlines()) == 1 or command == "verify") == (True, True), err
        else:  # of a chunk that cannot be read it is said that it is not there
            assert out == right or (command == "status" and "chunks" in json.loads(out)["missing"]), number
        if fails.left > 0:
            break
    assert 3 < number < 1000
    assert ex.open(finished.folder).summary["digest"] == digest
    assert {path: path.read_bytes() for path in before if path.name != "run.json"} == {
        path: content for path, content in before.items() if path.name != "run.json"
    }

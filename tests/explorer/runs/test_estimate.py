"""What a run will cost, from a few of its chunks."""

import time

import coins
import joblib
import numpy as np
import psutil
import pytest
from coins import SMALL, Coins

from explorer.runs.estimate import estimate
from explorer.runs.settings import asked


def test_an_estimate_is_that_of_the_run(finished, tmp_path, monkeypatch):
    """By a clock that only chunks move, by two seconds each."""
    clock = [0.0]
    monkeypatch.setattr(time, "process_time", lambda: clock[0])
    monkeypatch.setattr(coins, "wait", lambda: clock.__setitem__(0, clock[0] + 2.0))
    chunks = sum(len(chunk.data()) for chunk in finished.chunks)
    for jobs in (1, 2):
        found = estimate(*asked(Coins, {**SMALL, "out": tmp_path / "planned", "jobs": jobs}))
        assert (found.chunks, found.samples, found.probed) == (5, 2500, 1)
        assert found.seconds == 10.0 / min(jobs, joblib.cpu_count())
        assert found.disk == pytest.approx(chunks, rel=0.2)
        assert 1e8 < found.memory < 1e10
        assert found.free > 0
        assert not (tmp_path / "planned").exists()


def test_a_run_in_memory_takes_no_room_on_the_disk():
    found = estimate(*asked(Coins, SMALL))
    assert (found.disk, found.free) == (0.0, None)


def test_chunks_that_differ_are_tried_at_both_ends_and_in_the_middle(tmp_path):
    """The first ones are states close to the falling set, the last one is of plain draws."""
    given = {"samples": 1000, "tube": 100, "ladder": (1e-7, 1e-1), "out": tmp_path / "run"}
    found = estimate(*asked("measure-zero", given))
    assert (found.samples, found.probed) == (2 * 7 * 100 + 1000, 3)


def test_an_estimate_counts_every_sample_of_very_many_chunks(tmp_path):
    found = estimate(*asked(Coins, {"samples": 10**10, "out": tmp_path / "run"}))
    assert (found.samples, found.chunks) == (10**10, -(-(10**10) // 65_536))


def test_the_memory_of_an_estimate_covers_what_the_process_has_already(tmp_path):
    """States that a user gives are read by then."""
    states = {name: np.zeros(4_000_000) for name in ("phi", "phidot", "sigma3", "sigma4")}
    before = psutil.Process().memory_info().rss
    found = estimate(*asked("falling-set", {"states": states, "theta_min": "none", "out": tmp_path / "run"}))
    assert found.memory > max(before, sum(each.nbytes for each in states.values()))

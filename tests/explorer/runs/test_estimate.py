"""What a run will cost, from a few of its chunks."""

import time

from coins import SMALL, Coins

from explorer.runs.estimate import estimate
from explorer.runs.settings import asked


def test_an_estimate_is_that_of_the_run(finished, tmp_path, monkeypatch):
    monkeypatch.setattr(time, "sleep", lambda _: sum(range(200_000)))  # work, which a processor's clock sees
    monkeypatch.setenv("COINS_SECONDS", "1")
    scene, settings = asked(Coins, {**SMALL, "out": tmp_path / "planned", "jobs": 1})
    began = time.process_time()
    for index in range(5):
        scene.chunk(index)
    spent = time.process_time() - began
    found = estimate(scene, settings)
    chunks = sum(len(chunk.data()) for chunk in finished.chunks)
    assert (found.chunks, found.samples, found.probed) == (5, 2500, 1)
    assert 0.5 < found.disk / chunks < 3.0
    assert 0.3 < found.seconds / spent < 3.0
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

"""What a run will cost, from a few of its chunks; how well it holds was measured on whole runs."""

import time

import pytest
from small_runs import SMALL_RACES

from explorer.runs import probes
from explorer.runs.estimate import estimate
from explorer.runs.settings import asked


def test_an_estimate_is_that_of_the_run(finished, tmp_path):
    """Within a factor of two for the room that samples take; time is compared with that of the same chunks."""
    made = asked("race-angles", {**SMALL_RACES, "out": tmp_path / "planned", "figures": False, "jobs": 1})
    made.scene.process(0)
    began = time.process_time()
    for index in range(5):
        made.scene.process(index)
    spent = time.process_time() - began
    found = estimate(made)
    chunks = sum(path.stat().st_size for path in (finished.folder / "chunks").iterdir())
    assert (found.chunks, found.samples) == (5, 3000)
    assert 0.5 < found.disk / chunks < 2.0
    assert 0.2 < found.seconds / spent < 10.0  # it includes the writing, and both are short
    assert 1e8 < found.memory < 1e10
    assert not (tmp_path / "planned").exists()


def test_a_run_in_memory_takes_no_room_on_the_disk(monkeypatch):
    monkeypatch.setattr(probes, "_SECONDS", 0.0)
    found = estimate(asked("race-angles", SMALL_RACES))
    assert (found.disk, found.free, found.seconds_for_figures, found.probed) == (0.0, None, 0.0, 1)


@pytest.mark.parametrize("samples", [65_536 * 100_001 + 1, 10**10])
def test_an_estimate_counts_every_sample_of_very_many_chunks(samples, tmp_path):
    found = estimate(asked("race-angles", {"samples": samples, "out": tmp_path / "run"}))
    assert (found.samples, found.chunks) == (samples, -(-samples // 65_536))
    few = estimate(asked("race-angles", {"samples": 10**7, "out": tmp_path / "run", "figures": False}))
    assert found.disk / few.disk == pytest.approx(samples / 10**7, rel=0.1)

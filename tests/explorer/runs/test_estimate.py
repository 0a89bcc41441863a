"""What a run will cost, from a few of its chunks; how well it holds was measured on whole runs."""

import time

import pytest
from small_runs import SMALL_RACES

from explorer.runs import estimate as estimates
from explorer.runs.estimate import estimate
from explorer.runs.settings import asked


def test_probes_are_chunks_from_all_over_the_run():
    assert list(estimates._spread(1)) == [0]
    assert sorted(estimates._spread(7)) == list(range(7))
    first = list(estimates._spread(1000))[:7]
    assert sorted(first) == [125, 250, 375, 500, 625, 750, 875]


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
    monkeypatch.setattr(estimates, "_SECONDS", 0.0)
    found = estimate(asked("race-angles", SMALL_RACES))
    assert (found.disk, found.seconds_for_figures, found.probed) == (0.0, 0.0, 1)


@pytest.mark.parametrize("scene", ["race-angles", "falling-set", "measure-zero"])
def test_a_part_of_a_chunk_stands_for_the_chunk(scene):
    """It has a sixteenth of the samples, fewer rows, and the columns and counts of the whole."""
    made = asked(scene, {"samples": 2 << 16, "keep": "all"}).scene
    index = made.chunks() - 1
    rows, tally, length = made.begin(index, 16)
    assert length == made.length(index) // 16
    assert sum(tally["status"].values()) == length
    few, all_tally = made.process(index)
    assert (rows.keys(), tally.keys()) == (few.keys(), all_tally.keys())
    assert len(rows["status"]) == pytest.approx(len(few["status"]) / 16, rel=0.2)

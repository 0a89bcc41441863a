"""What a run will cost, from a few of its chunks."""

import time

import pytest
from coins import SMALL, Coins

from explorer.runs.amounts import duration, size
from explorer.runs.estimate import estimate
from explorer.runs.settings import asked


def test_an_estimate_is_that_of_the_run(finished, tmp_path, monkeypatch):
    monkeypatch.setattr(time, "sleep", lambda _: sum(range(200_000)))  # work, which a processor's clock sees
    monkeypatch.setenv("COINS_SECONDS", "1")
    made = asked(Coins, {**SMALL, "out": tmp_path / "planned", "jobs": 1})
    began = time.process_time()
    for index in range(5):
        made.scene.chunk(index)
    spent = time.process_time() - began
    found = estimate(made)
    chunks = sum(len(chunk.data()) for chunk in finished.chunks)
    assert (found.chunks, found.samples, found.probed) == (5, 3000, 1)
    assert 0.5 < found.disk / chunks < 3.0
    assert 0.3 < found.seconds / spent < 3.0
    assert 1e8 < found.memory < 1e10
    assert found.free > 0
    assert not (tmp_path / "planned").exists()


def test_a_run_in_memory_takes_no_room_on_the_disk():
    found = estimate(asked(Coins, SMALL))
    assert (found.disk, found.free) == (0.0, None)


class Uneven(Coins):
    """Its last chunks are larger."""

    def length(self, index):
        return 100 if index < 3 else 1000


def test_chunks_that_differ_are_tried_at_both_ends_and_in_the_middle(tmp_path):
    found = estimate(asked(Uneven, {**SMALL, "out": tmp_path / "run"}))
    assert (found.samples, found.probed) == (2300, 3)


def test_an_estimate_counts_every_sample_of_very_many_chunks(tmp_path):
    found = estimate(asked(Coins, {"samples": 10**10, "out": tmp_path / "run"}))
    assert (found.samples, found.chunks) == (10**10, -(-(10**10) // 65_536))


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 B"), (950, "950 B"), (999_600, "1 MB"), (83.6e12, "83.6 TB"), (5e18, "5e+03 PB")]
)
def test_sizes_have_three_digits_and_a_unit(count, text):
    assert size(count) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(1.25, "1.2 s"), (600, "10 min"), (30_000, "8 h"), (953_236, "11 days"), (1e9, "11,574 days")],
)
def test_times_are_in_seconds_to_days(seconds, text):
    assert duration(seconds) == text

"""What a run will take: parts of its chunks stand for the whole, and what does not fit on the disk is refused."""

import shutil
from typing import NamedTuple

import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.runs import probes
from explorer.runs.settings import asked

MANY = {"samples": 2_000_000, "eta_hat": "1e-4:1e-2", "figures": False}


class Room(NamedTuple):
    total: int
    used: int
    free: int


@pytest.fixture
def nearly_full(monkeypatch):
    """Every disk has 20 MB left; a run of two million passages takes some 170."""
    monkeypatch.setattr(shutil, "disk_usage", lambda place: Room(10**12, 10**12 - 20_000_000, 20_000_000))


def test_probes_are_chunks_from_all_over_the_run():
    assert list(probes._spread(1)) == [0]
    assert sorted(probes._spread(7)) == list(range(7))
    first = list(probes._spread(1000))[:7]
    assert sorted(first) == [125, 250, 375, 500, 625, 750, 875]


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


def test_a_run_that_does_not_fit_on_the_disk_is_refused_before_it_begins(nearly_full, tmp_path):
    with pytest.raises(
        ex.InputError, match=r"the run needs about 1\d\d MB, and 20 MB are free there; give keep none"
    ):
        ex.run("race-angles", out=tmp_path / "run", **MANY)
    assert not (tmp_path / "run").exists()


def test_a_run_that_fits_or_is_small_is_not_refused(nearly_full, tmp_path):
    assert ex.run("race-angles", out=tmp_path / "none", keep="none", **MANY).summary["samples"] == 2_000_000
    few = ex.run("race-angles", out=tmp_path / "few", **{**MANY, "samples": 300_000})
    assert few.summary["samples"] == 300_000


def test_a_longer_run_that_does_not_fit_leaves_the_shorter_one_to_be_resumed(nearly_full, tmp_path):
    before = ex.run("race-angles", out=tmp_path / "run", **{**MANY, "samples": 200_000}).summary
    with pytest.raises(ex.RunError, match="20 MB are free there"):
        ex.run("race-angles", out=tmp_path / "run", **MANY)
    assert ex.open(tmp_path / "run").resume().summary == before
    assert ex.open(tmp_path / "run").verify() == []


def test_a_plan_says_where_there_is_too_little_room(nearly_full, tmp_path, capsys):
    words = ["plan", "race-angles", "--samples", "2e6", "--no-figures", "--out", str(tmp_path / "a" / "b")]
    assert main(words) == 0
    assert "MB, more than the 20 MB free" in capsys.readouterr().out.splitlines()[-1]
    assert main([*words, "--keep", "none"]) == 0
    assert "free" not in capsys.readouterr().out


def test_a_disk_that_does_not_say_how_full_it_is_refuses_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr(shutil, "disk_usage", lambda place: Room(0, 0, 0))
    assert probes.free_bytes(tmp_path) is None

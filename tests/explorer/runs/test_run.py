"""A run from start to end: what it leaves, and that its numbers depend on its options alone."""

import json

import numpy as np
import pyarrow.dataset
import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.runs import store


def text(run):
    return (run.folder / "summary.json").read_text()


def spoil(path, place=None):
    content = bytearray(path.read_bytes())
    content[len(content) // 3 if place is None else place] ^= 4
    path.write_bytes(content)


@pytest.mark.rendered
def test_a_run_leaves_everything_it_promises(finished):
    folder = finished.folder
    record = json.loads((folder / "run.json").read_text())
    assert record["finished"] >= record["started"]
    assert record["identity"]["options"]["seed"] == 5
    assert record["versions"]["numba"]
    assert len(record["identity"]["kernels"]) == 64
    assert len(list((folder / "chunks").glob("*.parquet"))) == 5
    names = {path.name for path in (folder / "figures").iterdir()}
    assert names == {"histogram.png", "histogram.svg", "deviation.png", "deviation.svg"}
    assert json.loads(text(finished)) == finished.summary
    assert not list(folder.rglob("*.tmp"))


@pytest.mark.parametrize("options", [{"jobs": 1}, {"jobs": 3}, {"jobs": 2, "backend": "processes"}])
def test_the_summary_is_the_same_bytes_however_it_was_computed(finished, tmp_path, options):
    other = ex.run("race-angles", out=tmp_path / "other", **options, **SMALL_RACES)
    assert text(other) == text(finished)


def test_another_seed_gives_other_numbers(finished, tmp_path):
    other = ex.run("race-angles", out=tmp_path / "other", **{**SMALL_RACES, "seed": 6})
    assert other.summary["digest"] != finished.summary["digest"]


@pytest.mark.parametrize("scene", ["falling-set", "one-sided"])
def test_every_scene_gives_the_same_summary_with_one_and_two_jobs(scene, tmp_path):
    options = (
        {"samples": 10, "disk": ["hoop", "matching"]}
        if scene == "one-sided"
        else {"samples": 2000, "grid": 21, "chunk_size": 700}
    )
    one, two = (ex.run(scene, out=tmp_path / str(jobs), jobs=jobs, **options) for jobs in (1, 2))
    assert text(one) == text(two)


def test_resume_computes_only_what_is_missing_or_damaged(finished, capsys):
    before, folder = text(finished), finished.folder
    paths = store.found_chunks(folder)
    untouched = paths[0].stat().st_mtime_ns
    paths[1].unlink()
    spoil(paths[3])
    again = ex.run("race-angles", out=folder, resume=True, quiet=False, **SMALL_RACES)
    assert text(again) == before
    assert json.loads((folder / "run.json").read_text())["chunks_computed"] == 2
    assert paths[0].stat().st_mtime_ns == untouched
    assert f"{paths[3].name}: its bytes are not those that were written" in capsys.readouterr().err
    assert len(list((folder / "bad").iterdir())) == 1


def test_samples_can_be_added_to_a_finished_run(finished, tmp_path):
    whole = ex.run("race-angles", out=tmp_path / "whole", **{**SMALL_RACES, "samples": 5000})
    longer = ex.run("race-angles", out=finished.folder, resume=True, **{**SMALL_RACES, "samples": 5000})
    assert text(longer) == text(whole)
    # Four full chunks stayed; the fifth was shorter.
    assert json.loads((finished.folder / "run.json").read_text())["chunks_computed"] == 4
    with pytest.raises(ex.InputError, match="give as many, or more"):
        ex.run("race-angles", out=finished.folder, resume=True, **SMALL_RACES)


def test_samples_can_be_read_as_one_parquet_dataset(finished):
    table = pyarrow.dataset.dataset(finished.folder / "chunks").to_table()
    assert table.num_rows == 3000
    assert np.median(np.abs(table["race_angle"])) == pytest.approx(finished.summary["limit"], abs=0.01)
    assert sum(len(table["race_angle"]) for table in finished.tables()) == 3000

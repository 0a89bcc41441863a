import json

import numpy as np
import pyarrow.dataset
import pytest

import explorer as ex
from explorer.runs import store

SMALL = {"samples": 3000, "seed": 5, "eta_hat": "1e-4:1e-2", "chunk_size": 700}


@pytest.fixture
def finished(tmp_path):
    return ex.run("race-angles", out=tmp_path / "run", jobs=2, **SMALL)


def text(run):
    return (run.folder / "summary.json").read_text()


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
    other = ex.run("race-angles", out=tmp_path / "other", **options, **SMALL)
    assert text(other) == text(finished)


def test_another_seed_gives_other_numbers(finished, tmp_path):
    other = ex.run("race-angles", out=tmp_path / "other", **{**SMALL, "seed": 6})
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


def test_resume_computes_only_what_is_missing_or_damaged(finished):
    before, folder = text(finished), finished.folder
    untouched = store.chunk_path(folder, 0).stat().st_mtime_ns
    store.chunk_path(folder, 1).unlink()
    damaged = store.chunk_path(folder, 3)
    content = bytearray(damaged.read_bytes())
    content[len(content) // 3] ^= 4
    damaged.write_bytes(content)
    again = ex.run("race-angles", out=folder, resume=True, **SMALL)
    assert text(again) == before
    assert json.loads((folder / "run.json").read_text())["chunks_computed"] == 2
    assert store.chunk_path(folder, 0).stat().st_mtime_ns == untouched


def test_random_bit_flips_in_a_chunk_are_noticed(finished):
    rng = np.random.default_rng(0)
    path = store.chunk_path(finished.folder, 2)
    content = path.read_bytes()
    good = store.read_chunk(path)
    for _ in range(60):
        broken = bytearray(content)
        place = int(rng.integers(len(content)))
        broken[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        if store.is_intact(path):  # a flip in a part that carries no data
            got = store.read_chunk(path)
            assert all(np.array_equal(got[k], good[k], equal_nan=True) for k in good)


def test_resume_refuses_other_options_and_other_kernels(finished):
    with pytest.raises(ex.InputError, match="seed = 5, now seed = 9"):
        ex.run("race-angles", out=finished.folder, resume=True, **{**SMALL, "seed": 9})
    record = finished.folder / "run.json"
    content = json.loads(record.read_text())
    content["identity"]["kernels"] = "0" * 64
    record.write_text(json.dumps(content))
    with pytest.raises(ex.InputError, match="another version of the kernels"):
        ex.run("race-angles", out=finished.folder, resume=True, **SMALL)


def test_a_folder_with_a_run_or_with_something_else_is_left_alone(finished, tmp_path):
    before = text(finished)
    with pytest.raises(ex.InputError, match="holds a run already; add --resume or give another folder"):
        ex.run("race-angles", out=finished.folder, **SMALL)
    assert text(finished) == before
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "chapter.tex").write_text("do not lose me")
    with pytest.raises(ex.InputError, match="is not empty"):
        ex.run("race-angles", out=tmp_path / "thesis", **SMALL)
    assert [p.name for p in (tmp_path / "thesis").iterdir()] == ["chapter.tex"]
    with pytest.raises(ex.InputError, match="holds no run"):
        ex.run("race-angles", out=tmp_path / "nowhere", resume=True, **SMALL)


def test_a_folder_that_cannot_be_made_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ex.InputError, match="cannot be written"):
        ex.run("race-angles", out=tmp_path / "file" / "run", **SMALL)


@pytest.mark.parametrize(
    ("options", "message"), [({"jobs": 0}, "--jobs 0"), ({"backend": "gpu"}, "--backend 'gpu'")]
)
def test_workers_that_cannot_be_are_refused_before_anything_is_written(options, message, tmp_path):
    with pytest.raises(ex.InputError, match=message):
        ex.run("race-angles", out=tmp_path / "run", **options, **SMALL)
    assert not (tmp_path / "run").exists()


def test_samples_can_be_read_as_one_parquet_dataset(finished):
    table = pyarrow.dataset.dataset(finished.folder / "chunks").to_table()
    assert table.num_rows == 3000
    assert np.median(np.abs(table["race_angle"])) == pytest.approx(finished.summary["limit"], abs=0.01)
    assert sum(len(table["race_angle"]) for table in finished.tables()) == 3000

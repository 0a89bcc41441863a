import json

import numpy as np
import pyarrow.dataset
import pyarrow.parquet
import pytest

import explorer as ex
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.inspect import summary, verify
from explorer.runs.lock import only_one
from explorer.scenes import falling_set

SMALL = {"samples": 3000, "seed": 5, "eta_hat": "1e-4:1e-2", "chunk_size": 700}


@pytest.fixture
def finished(tmp_path):
    return ex.run("race-angles", out=tmp_path / "run", jobs=2, **SMALL)


def text(run):
    return (run.folder / "summary.json").read_text()


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


def spoil(path, place=None):
    content = bytearray(path.read_bytes())
    content[len(content) // 3 if place is None else place] ^= 4
    path.write_bytes(content)


def test_resume_computes_only_what_is_missing_or_damaged(finished, capsys):
    before, folder = text(finished), finished.folder
    paths = store.found_chunks(folder)
    untouched = paths[0].stat().st_mtime_ns
    paths[1].unlink()
    spoil(paths[3])
    again = ex.run("race-angles", out=folder, resume=True, quiet=False, **SMALL)
    assert text(again) == before
    assert json.loads((folder / "run.json").read_text())["chunks_computed"] == 2
    assert paths[0].stat().st_mtime_ns == untouched
    assert f"{paths[3].name}: its bytes are not those that were written" in capsys.readouterr().err
    assert len(list((folder / "bad").iterdir())) == 1


def test_any_flipped_bit_of_a_chunk_is_noticed(finished):
    rng = np.random.default_rng(0)
    path = store.found_chunks(finished.folder)[2]
    content = path.read_bytes()
    assert verify(finished.folder) == []
    for _ in range(40):
        broken = bytearray(content)
        broken[int(rng.integers(len(content)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        (fault,) = verify(finished.folder)
        assert path.name in fault
    path.write_bytes(content[:-100])
    assert len(verify(finished.folder)) == 1


def test_swapped_and_foreign_chunks_are_noticed(finished, tmp_path):
    other = ex.run("race-angles", out=tmp_path / "other", **{**SMALL, "seed": 6})
    mine, theirs = store.found_chunks(finished.folder), store.found_chunks(other.folder)
    content = [mine[i].read_bytes() for i in range(2)]
    mine[0].write_bytes(content[1])
    mine[1].write_bytes(content[0])
    assert len(verify(finished.folder)) == 2
    mine[0].write_bytes(content[0])
    mine[1].write_bytes(content[1])
    # Renamed as well, so that the bytes agree with the name.
    mine[2].unlink()
    (mine[2].parent / theirs[2].name).write_bytes(theirs[2].read_bytes())
    (fault,) = verify(finished.folder)
    assert "it belongs to another run" in fault
    (mine[2].parent / theirs[2].name).unlink()
    moved = mine[3].name.replace("000003", "000002")
    (mine[2].parent / moved).write_bytes(mine[3].read_bytes())
    (fault,) = verify(finished.folder)
    assert "it is chunk 3" in fault


def test_strangers_among_the_chunks_are_put_aside(finished, capsys):
    before, chunks = text(finished), finished.folder / "chunks"
    for name in ("x.parquet", "chunk-000001-0000000000000000.parquet", "chunk-000001-ffffffffffffffff.parquet"):
        (chunks / name).write_bytes(store.found_chunks(finished.folder)[2].read_bytes())
    assert len(verify(finished.folder)) >= 3
    again = ex.run("race-angles", out=finished.folder, resume=True, quiet=False, **SMALL)
    assert text(again) == before
    assert verify(finished.folder) == []
    assert len(list((finished.folder / "bad").iterdir())) == 3
    assert pyarrow.dataset.dataset(chunks).to_table().num_rows == 3000
    assert "x.parquet: is no chunk of a run" in capsys.readouterr().err
    assert json.loads((finished.folder / "run.json").read_text())["chunks_computed"] == 0


def test_samples_can_be_added_to_a_finished_run(finished, tmp_path):
    whole = ex.run("race-angles", out=tmp_path / "whole", **{**SMALL, "samples": 5000})
    longer = ex.run("race-angles", out=finished.folder, resume=True, **{**SMALL, "samples": 5000})
    assert text(longer) == text(whole)
    # Four full chunks stayed; the fifth was shorter.
    assert json.loads((finished.folder / "run.json").read_text())["chunks_computed"] == 4
    with pytest.raises(ex.InputError, match="give as many, or more"):
        ex.run("race-angles", out=finished.folder, resume=True, **SMALL)


@pytest.mark.parametrize(
    ("scene", "options"),
    [
        ("race-angles", SMALL),
        ("falling-set", {"samples": 3000, "chunk_size": 900, "grid": 5, "box": "phi=0.1:0.4", "max_energy": 3.0}),
        ("falling-set", {"samples": 900, "grid": 5, "slices": ["phi=0:1,phidot=0.1,sigma3=0:1,sigma4=0.3"]}),
        ("one-sided", {"samples": 3, "disk": ["hoop", "m=1,r=1,g=1,I1=0.3,I3=0.5"]}),
    ],
)
def test_the_record_of_a_run_is_enough_to_continue_it(scene, options, tmp_path):
    run = ex.run(scene, out=tmp_path / "run", **options)
    again = folders.scene_of(run.folder)
    assert again.options() == run.scene.options()
    assert folders.identity(again) == folders.identity(run.scene)


@pytest.mark.parametrize("keep", ["none", "near", "all"])
def test_counts_are_complete_whatever_is_kept(keep, tmp_path):
    options = {"samples": 4000, "grid": 5, "chunk_size": 1500}
    every = ex.run("falling-set", out=tmp_path / "all", keep="all", **options)
    run = ex.run("falling-set", out=tmp_path / "run", keep=keep, **options)
    for key in ("side_counts", "theta_min_quantiles", "distance_quantiles", "status"):
        assert run.summary[key] == every.summary[key]
    rows = sum(len(table["status"]) for table in run.tables())
    near = sum(int(run.scene.near(table).sum()) for table in every.tables())
    assert rows == {"none": 0, "near": near, "all": 4000}[keep]
    assert near > 0


def test_beyond_ten_million_states_theta_min_is_computed_near_f_only(tmp_path, monkeypatch):
    options = {"samples": 4000, "grid": 5, "keep": "all"}
    every = ex.run("falling-set", out=tmp_path / "all", **options)
    monkeypatch.setattr(falling_set, "MOST_THETA_MIN", 100)
    run = ex.run("falling-set", out=tmp_path / "run", **options)
    for whole, part in zip(every.tables(), run.tables(), strict=True):
        near = run.scene.near(whole)
        np.testing.assert_array_equal(part["theta_min"][near], whole["theta_min"][near])
        assert np.isnan(part["theta_min"][~near]).all()
        assert near.any()
    assert run.summary["side_counts"] == every.summary["side_counts"]
    sifted = ex.run("falling-set", out=tmp_path / "near", **{**options, "keep": "near"})
    for key in ("side_counts", "could_fall_fraction", "distance_quantiles", "theta_min_quantiles", "status"):
        assert sifted.summary[key] == run.summary[key]
    for part, table in zip(sifted.tables(), run.tables(), strict=True):
        near = run.scene.near(table)
        for name, values in part.items():
            np.testing.assert_array_equal(values, table[name][near])


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_lives(finished):
    with only_one(finished.folder), pytest.raises(ex.InputError, match="another run is at work"):
        ex.run("race-angles", out=finished.folder, resume=True, **SMALL)
    ex.run("race-angles", out=finished.folder, resume=True, **SMALL)


def test_a_budget_decides_the_size_of_chunks_or_is_refused(tmp_path, capsys):
    run = ex.run("race-angles", out=tmp_path / "run", memory="1GB", samples=1000, quiet=False)
    size = json.loads((run.folder / "run.json").read_text())["identity"]["options"]["chunk_size"]
    assert f"chunks of {size:,} samples" in capsys.readouterr().err
    assert 2 * size * run.scene.bytes_per_sample < 1e9
    with pytest.raises(ex.InputError, match="needs at least 4"):
        ex.run("race-angles", out=tmp_path / "small", memory="10MB")
    for wrong in ("much", "nan", "inf", "1e400", "-1GB", 0):
        with pytest.raises(ex.InputError, match="is no amount"):
            ex.run("race-angles", out=tmp_path / "small", memory=wrong)
    one, two = (ex.run("race-angles", out=tmp_path / str(n), memory="1GB", jobs=n, samples=1000) for n in (1, 2))
    assert one.summary["digest"] == two.summary["digest"]


def test_a_summary_is_not_made_of_another_run_s_chunks(finished):
    record = finished.folder / "run.json"
    content = json.loads(record.read_text())
    content["identity"]["options"]["seed"] = 7
    record.write_text(json.dumps(content))
    with pytest.raises(ex.RunError, match="not those that"):
        summary(finished.folder)


def test_given_states_are_taken_and_bad_ones_flagged(tmp_path):
    rng = np.random.default_rng(3)
    columns = {name: rng.uniform(-1, 1, 500) for name in ("phi", "phidot", "sigma3", "sigma4")}
    clean, spoilt = tmp_path / "clean.parquet", tmp_path / "spoilt.parquet"
    pyarrow.parquet.write_table(pyarrow.table(columns), clean)
    bad = rng.choice(500, 5, replace=False)
    for row, value in zip(bad, (np.nan, np.inf, -np.inf, 1e300, 7.0), strict=True):
        columns["phi" if value == 7.0 else "sigma3"][row] = value
    pyarrow.parquet.write_table(pyarrow.table(columns), spoilt)
    options = {"grid": 5, "keep": "all", "chunk_size": 128}
    good = ex.run("falling-set", states=clean, out=tmp_path / "good", **options)
    run = ex.run("falling-set", states=spoilt, out=tmp_path / "run", **options)
    one, other = (
        {name: np.concatenate([table[name] for table in done.tables()]) for name in ("status", "theta_min")}
        for done in (good, run)
    )
    assert set(np.flatnonzero(other["status"] == ex.Status.BAD_INPUT)) == set(bad)
    kept = np.setdiff1d(np.arange(500), bad)
    np.testing.assert_array_equal(one["theta_min"][kept], other["theta_min"][kept])
    assert folders.scene_of(run.folder).options() == run.scene.options()
    pyarrow.parquet.write_table(pyarrow.table(columns).slice(1), spoilt)
    with pytest.raises(ex.InputError, match="is not the file of states that the run began with"):
        folders.scene_of(run.folder)
    for wrong, message in ((tmp_path / "none.parquet", "cannot be read"), (spoilt, "leave it out")):
        with pytest.raises(ex.InputError, match=message):
            ex.run("falling-set", states=wrong, box="phi=0", out=tmp_path / "no")


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

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
    again = ex.run("race-angles", out=folder, **SMALL_RACES)
    assert text(again) == before
    assert json.loads((folder / "run.json").read_text())["chunks_computed"] == 2
    assert paths[0].stat().st_mtime_ns == untouched
    assert f"{paths[3].name}: its bytes are not those that were written" in capsys.readouterr().err
    assert len(list((folder / "bad").iterdir())) == 1


def test_samples_can_be_added_to_a_finished_run(finished, tmp_path):
    whole = ex.run("race-angles", out=tmp_path / "whole", **{**SMALL_RACES, "samples": 5000})
    longer = ex.run("race-angles", out=finished.folder, **{**SMALL_RACES, "samples": 5000})
    assert text(longer) == text(whole)
    # Four full chunks stayed; the fifth was shorter.
    assert json.loads((finished.folder / "run.json").read_text())["chunks_computed"] == 4
    with pytest.raises(ex.InputError, match="give as many, or more"):
        ex.run("race-angles", out=finished.folder, **SMALL_RACES)


def test_samples_can_be_read_as_one_parquet_dataset(finished):
    table = pyarrow.dataset.dataset(finished.folder / "chunks").to_table()
    assert table.num_rows == 3000
    assert np.median(np.abs(table["race_angle"])) == pytest.approx(finished.summary["limit"], abs=0.01)
    assert sum(len(table["race_angle"]) for table in finished.tables()) == 3000


def test_a_cell_that_runs_again_finds_its_run(finished):
    """And a different question in its folder is an error that says so."""
    files = {path: path.stat().st_mtime_ns for path in finished.folder.rglob("*.p*") if path.is_file()}
    again = ex.run("race-angles", out=finished.folder, **SMALL_RACES)
    assert again.summary == finished.summary
    assert {path: path.stat().st_mtime_ns for path in files} == files
    other = {**SMALL_RACES, "seed": 8, "samples": 700}
    with pytest.raises(ex.InputError, match=r'seed = 5, now seed = 8; .*, or exist="replace"'):
        ex.run("race-angles", out=finished.folder, **other)
    replaced = ex.run("race-angles", out=finished.folder, exist="replace", format="pdf", **other)
    assert replaced.summary == ex.run("race-angles", **other).summary
    assert {path.name for path in (finished.folder / "figures").iterdir()} == {"histogram.pdf", "deviation.pdf"}


def test_a_stored_run_is_opened_mended_and_asked_again(finished):
    opened = ex.open(str(finished.folder))
    assert (opened.summary, opened.verify()) == (finished.summary, [])
    assert opened.status.missing == ()
    store.found_chunks(finished.folder)[3].unlink()
    (finished.folder / "summary.json").unlink()
    (finished.folder / "figures" / "deviation.svg").unlink()
    opened = ex.open(finished.folder)
    assert opened.status.missing == ("chunks", "summary", "figures")
    assert len(opened.verify()) == 1
    assert "resume() computes the others" in repr(opened)
    assert opened.resume().verify() == []
    assert opened.status.missing == ()
    assert ex.run(**opened.options).summary == finished.summary == opened.summary


def test_samples_are_tables_with_status_by_name(finished):
    frame = finished.frame(["race_angle", "status"])
    assert list(frame) == ["race_angle", "status"]
    assert len(frame) == 3000
    assert set(frame["status"]) == {"ok"}
    table = finished.arrow()
    assert table.schema.field("race_angle").metadata[b"unit"] == b"rad"
    assert table.num_rows == 3000
    with pytest.raises(ex.InputError, match=r"'race_angel' is not known; did you mean 'race_angle'\?"):
        finished.arrow(["race_angel"])


def test_what_is_no_part_no_column_and_no_picture_of_a_run_is_refused(computed_once):
    for wrong in (None, [], "races", [1]):
        with pytest.raises(ex.InputError, match=r"run\(...\), open\(folder\) and merge\(...\) make runs"):
            ex.Run(wrong)
    for wrong in (1, "theta_min", [1], {"theta_min": [1]}.values()):
        for read in (computed_once.arrow, computed_once.frame, computed_once.tables):
            with pytest.raises(ex.InputError, match=r"columns = .*: give a list of"):
                read(wrong)
    with pytest.raises(ex.InputError, match="column 'theta' is not known; did you mean 'theta_min'"):
        computed_once.tables(["theta"])
    with pytest.raises(ex.InputError, match="figure = None is no picture of this run"):
        computed_once.figure(None)


def test_a_run_describes_itself_in_a_few_lines(finished):
    assert len(repr(finished)) < 600
    assert repr(finished).startswith(f"Run of race-angles, stored in {finished.folder}")
    assert "<li>wrong way: 0; failures: none</li>" in finished._repr_html_()


@pytest.mark.parametrize("there", [False, True], ids=["new folder", "empty folder"])
def test_a_run_whose_states_are_none_leaves_nothing(tmp_path, there):
    folder = tmp_path / "results" / "races"
    if there:
        folder.mkdir(parents=True)
    wrong = {"phi": [5.0, 6.0], "phidot": 1.0, "sigma3": 1.0, "sigma4": 0.5}
    with pytest.raises(ex.InputError, match="none of the 2 rows"):
        ex.run("race-angles", states=wrong, out=folder, figures=False)
    assert [path.name for path in tmp_path.iterdir()] == (["results"] if there else [])
    right = {**wrong, "phi": [0.5, 0.6]}
    assert ex.run("race-angles", states=right, out=folder, exist="error", figures=False).summary["samples"] == 2


def test_a_run_that_is_refused_takes_no_other_away(tmp_path):
    """A finished run, and one that somebody else is computing, stay as they are."""
    from explorer.runs.lock import only_one

    small = {"samples": 10, "out": tmp_path / "run", "figures": False}
    before = ex.run("race-angles", **small).summary
    with only_one(tmp_path / "run"), pytest.raises(ex.InputError, match="another run is at work"):
        ex.run("race-angles", **small, exist="replace")
    assert ex.open(tmp_path / "run").summary == before


def test_a_run_stopped_while_it_draws_says_the_folder_to_continue_with(tmp_path, monkeypatch):
    def stop(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("explorer.runs.pictures.save_all", stop)
    with pytest.raises(ex.Interrupted) as told:
        ex.run("race-angles", samples=100, out=tmp_path / "run", progress=False)
    assert str(told.value).endswith(f'all samples are stored; continue with: ex.open("{tmp_path}/run").resume()')

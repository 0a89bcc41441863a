"""What a stored run says of itself."""

import json

import pytest

import explorer as ex
from explorer.runs import store
from explorer.runs.inspect import status, summary, verify


def test_a_summary_is_not_made_of_another_run_s_chunks(finished):
    record = finished.folder / "run.json"
    content = json.loads(record.read_text())
    content["identity"]["options"]["seed"] = 7
    record.write_text(json.dumps(content))
    with pytest.raises(ex.RunError, match="not those that"):
        summary(finished.folder)


def test_status_counts_what_is_there(finished):
    store.found_chunks(finished.folder)[1].unlink()
    far = status(finished.folder)
    assert (far.scene, far.chunks, far.chunks_done, far.samples_done) == ("race-angles", 5, 4, 2300)
    assert sum(far.status.values()) == 2300


def test_a_summary_of_other_chunks_is_a_fault(finished):
    path = finished.folder / "summary.json"
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "digest": "0" * 64}))
    assert verify(finished.folder) == ["summary.json: does not belong to these chunks; run `nearflat summary`"]
    assert summary(finished.folder) == finished.summary
    assert verify(finished.folder) == []


def test_a_changed_number_of_a_summary_is_found_and_not_believed(finished):
    path = finished.folder / "summary.json"
    content = json.loads(path.read_text())
    path.write_text(json.dumps({**content, "wrong_way": 7}))
    assert verify(finished.folder) == [
        "summary.json: its bytes are not those that were written; run `nearflat summary`"
    ]
    assert ex.open(finished.folder).summary == finished.summary
    summary(finished.folder)
    assert verify(finished.folder) == []


@pytest.mark.parametrize("name", ["race-angles", "falling-set", "one-sided", "portrait"])
def test_a_summary_that_says_the_same_is_not_written_again(name, tmp_path):
    """So that one may look at a finished run where nothing can be written."""
    few = {} if name == "portrait" else {"samples": 4}
    run = ex.run(name, out=tmp_path / "run", figures=False, **few)
    path = run.folder / "summary.json"
    before = path.stat().st_mtime_ns
    assert json.loads(json.dumps(summary(run.folder))) == ex.open(run.folder).summary
    assert path.stat().st_mtime_ns == before


def test_of_many_missing_chunks_the_first_are_named_and_the_others_counted(finished):
    for number in (0, 2):
        store.found_chunks(finished.folder)[number].unlink()
    assert verify(finished.folder) == ["chunk 0: is missing", "chunk 2: is missing"]
    record = finished.folder / "run.json"
    content = json.loads(record.read_text())
    content["identity"]["options"]["samples"] = 700 * 400
    record.write_text(json.dumps(content))
    faults = [fault for fault in verify(finished.folder) if "missing" in fault]
    assert faults[:2] + faults[9:] == [
        "chunk 0: is missing",
        "chunk 2: is missing",
        "chunk 12: is missing",
        "chunks: 387 more are missing, 397 of 400 in all",
    ]

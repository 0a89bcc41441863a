"""`nearflat status`, `verify`, `resume` and `summary` on a stored run."""

import json

import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.runs import store


@pytest.fixture
def run(tmp_path):
    return ex.run("race-angles", out=tmp_path / "run", samples=5000, chunk_size=1000)


def test_status_and_verify_give_objects_too(run, capsys):
    assert main(["status", str(run.folder), "--json"]) == 0
    far = json.loads(capsys.readouterr().out)
    assert (far["scene"], far["chunks"], far["chunks_done"], far["samples_done"]) == ("race-angles", 5, 5, 5000)
    store.found_chunks(run.folder)[2].unlink()
    assert main(["verify", str(run.folder), "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"intact": False, "faults": ["chunk 2: is missing"]}


def test_resume_and_summary_give_the_same_object_as_the_run(run, capsys):
    store.found_chunks(run.folder)[2].unlink()
    assert main(["resume", str(run.folder), "--jobs", "1", "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary
    assert main(["summary", str(run.folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary

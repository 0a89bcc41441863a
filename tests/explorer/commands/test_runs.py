"""`nearflat status`, `verify`, `resume` and `summary` on a stored run."""

import json

import pytest

import explorer as ex
from explorer.commands.main import main


@pytest.fixture
def run(tmp_path):
    return ex.run("race-angles", out=tmp_path / "run", samples=5000, chunk_size=1000)


def test_status_and_verify_give_objects_too(run, capsys):
    assert main(["status", str(run.folder), "--json"]) == 0
    far = json.loads(capsys.readouterr().out)
    assert (far["scene"], far["chunks"], far["chunks_done"], far["samples_done"]) == ("race-angles", 5, 5, 5000)
    next((run.folder / "chunks").glob("chunk-000002-*")).unlink()
    assert main(["verify", str(run.folder), "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"intact": False, "faults": ["1 of 5 chunks are missing: 2"]}


def test_resume_and_summary_give_the_same_object_as_the_run(run, capsys):
    next((run.folder / "chunks").glob("chunk-000002-*")).unlink()
    assert main(["resume", str(run.folder), "--jobs", "1", "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary
    assert main(["summary", str(run.folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary


def test_runs_are_merged_in_any_order_and_may_keep_other_rows(run, capsys, tmp_path):
    ex.run("race-angles", out=tmp_path / "other", samples=5000, seed=1, keep="none")
    folders = [str(run.folder), str(tmp_path / "other")]
    said = []
    for words in (["merge", *folders], ["merge", *folders[::-1]], ["summary", *folders]):
        assert main([*words, "--json"]) == 0
        said.append(json.loads(capsys.readouterr().out))
    assert said[0] == said[1] == said[2]
    assert (said[0]["samples"], said[0]["seed"]) == (10_000, [0, 1])

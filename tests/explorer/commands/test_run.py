"""`nearflat run` and `ex.run`: options, help, and how a run is made."""

import json

import pytest
from told import said

import explorer as ex
from explorer.commands.main import main


def test_help_for_a_scene_shows_its_options_and_those_of_no_other(capsys):
    status, out, _ = said(capsys, "run", "measure-zero", "--help")
    assert status == 0
    for flag in ("--ladder LOW:HIGH", "--tube N", "--energy LOW:HIGH", "--jobs N", "--chunk-size N", "--resume"):
        assert flag in out
    assert "--eta-hat" not in out
    assert "How rarely does it nearly fall?" in out
    assert "example: nearflat run" in out


def test_help_without_a_scene_names_the_scenes(capsys):
    status, out, _ = said(capsys, "run", "--help")
    assert status == 0
    assert "falling-set,measure-zero,one-sided,race-angles" in "".join(out.split())
    assert "--jobs N" in out


@pytest.mark.parametrize(
    ("words", "key", "value"),
    [
        (("falling-set", "--samples", "50", "--grid", "5", "--energy", "-1:2"), "energy", [-1.0, 2.0]),
        (
            ("race-angles", "--samples", "50", "--box", "sigma3=-1:1"),
            "box",
            {"phidot": [0.5, 2.0], "sigma3": [-1.0, 1.0]},
        ),
    ],
)
def test_numbers_below_zero_are_values_and_not_flags(words, key, value, capsys, tmp_path):
    status, out, err = said(capsys, "run", *words, "--no-figures", "--out", tmp_path / "run", "--json", "--quiet")
    assert status == 0, err
    assert json.loads(out)[key] == value


def test_the_record_has_a_format_its_options_and_the_command_line(capsys, tmp_path):
    words = ("run", "race-angles", "--samples", "100", "--eta-hat", "1e-4:1e-3", "--no-figures", "--out")
    assert said(capsys, *words, tmp_path / "run")[0] == 0
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert record["format"] == 3
    assert record["command"] == " ".join(["nearflat", *words, str(tmp_path / "run")])
    options = record["options"]
    again = ex.run(options.pop("scene"), **options)
    assert again.summary == json.loads((tmp_path / "run" / "summary.json").read_text())


def test_settings_of_a_run_may_stand_in_a_scene_file(capsys, tmp_path):
    (tmp_path / "scene.toml").write_text(
        f"""scene = "race-angles"
samples = 50
backend = "processes"
jobs = 1
format = "pdf"
out = '{tmp_path / "run"}'
"""
    )
    status, _, _err = said(capsys, "run", tmp_path / "scene.toml")
    assert status == 0
    record = json.loads((tmp_path / "run" / "run.json").read_text())
    assert (record["jobs"], record["backend"], record["formats"]) == (1, "processes", ["pdf"])
    assert said(capsys, "run", tmp_path / "scene.toml", "--resume")[0] == 0


@pytest.fixture
def run(tmp_path):
    return ex.run("race-angles", out=tmp_path / "run", samples=5000, chunk_size=1024, figures=False)


def test_status_and_verify_give_objects_too(run, capsys):
    assert main(["status", str(run.folder), "--json"]) == 0
    far = json.loads(capsys.readouterr().out)
    assert (far["scene"], far["chunks"], far["chunks_done"], far["samples_done"]) == ("race-angles", 5, 5, 5000)
    next((run.folder / "chunks").glob("chunk-000002-*")).unlink()
    assert main(["verify", str(run.folder), "--json"]) == 1
    assert json.loads(capsys.readouterr().out) == {"intact": False, "faults": ["1 of 5 chunks are missing: 2"]}


def test_resume_and_summary_give_the_same_object_as_the_run(run, capsys):
    next((run.folder / "chunks").glob("chunk-000002-*")).unlink()
    assert main(["resume", str(run.folder), "--no-figures", "--jobs", "1", "--json", "--quiet"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary
    assert main(["summary", str(run.folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == run.summary


def test_runs_are_merged_in_any_order_and_may_keep_other_rows(run, capsys, tmp_path):
    ex.run("race-angles", out=tmp_path / "other", samples=5000, seed=1, keep="none", figures=False)
    folders = [str(run.folder), str(tmp_path / "other")]
    said = []
    for words in (["merge", *folders], ["merge", *folders[::-1]], ["summary", *folders]):
        assert main([*words, "--json"]) == 0
        said.append(json.loads(capsys.readouterr().out))
    assert said[0] == said[1] == said[2]
    assert (said[0]["samples"], said[0]["seed"]) == (10_000, [0, 1])


def test_the_scene_comes_before_its_options(capsys):
    status, _, err = said(capsys, "run", "--out", "falling-set", "race-angles")
    assert status == 2
    assert "scene: comes before its options; write nearflat run SCENE --out ..." in err


def test_the_command_line_wins_over_a_scene_file_that_uses_the_names_of_run_json(capsys, tmp_path):
    (tmp_path / "a.toml").write_text('scene = "race-angles"\ndisks = ["hoop"]\nsamples = 50\n')
    words = ("--disk", "uniform", "--no-figures", "--quiet", "--out", tmp_path / "run", "--json")
    status, out, err = said(capsys, "run", tmp_path / "a.toml", *words)
    assert status == 0, err
    assert json.loads(out)["disks"][0]["name"] == "uniform"


def test_a_key_that_a_scene_file_has_in_two_spellings_is_refused(capsys, tmp_path):
    (tmp_path / "a.toml").write_text('scene = "race-angles"\n"eta-hat" = "1e-5:1e-3"\neta_hat = "1e-4:1e-3"\n')
    status, _, err = said(capsys, "run", tmp_path / "a.toml")
    assert status == 2
    assert "eta_hat is given twice, with - and with _; leave one out" in err


def test_a_scene_file_deletes_no_run(capsys, tmp_path):
    out = tmp_path / "victim"
    (tmp_path / "a.toml").write_text(f"scene = 'race-angles'\nout = '{out}'\nexist = 'replace'\nsamples = 50\n")
    assert said(capsys, "run", "race-angles", "--samples", "60", "--out", out, "--no-figures")[0] == 0
    status, _, err = said(capsys, "run", tmp_path / "a.toml")
    assert (status, "exist is no option of a file; give --resume or --replace" in err) == (2, True)
    assert json.loads((out / "summary.json").read_text())["samples"] == 60


def test_an_option_that_a_scene_file_has_by_both_of_its_names_is_refused(capsys, tmp_path):
    (tmp_path / "a.toml").write_text('scene = "race-angles"\ndisk = "hoop"\ndisks = ["uniform"]\n')
    status, _, err = said(capsys, "run", tmp_path / "a.toml", "--out", tmp_path / "run")
    assert status == 2
    assert "disk and disks are the same option; leave one out" in err

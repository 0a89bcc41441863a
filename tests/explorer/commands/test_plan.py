"""`nearflat plan`: what `run` would choose."""

import json

import pytest

from explorer.commands.main import main
from explorer.scenes.scene import NAMES, scene_class


def test_the_cost_of_a_run_is_said_for_its_own_options(capsys, tmp_path):
    words = ["race-angles", "--samples", "1e6", "--out", str(tmp_path / "run"), "--no-figures", "--jobs", "2"]
    assert main(["plan", *words]) == 0
    out = capsys.readouterr().out
    assert "samples      1,000,000 in 16 chunks" in out
    assert "measured on " in out
    assert "MB" in out.splitlines()[-1]
    assert main(["plan", *words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["estimate"]["chunks"] == 16


@pytest.mark.parametrize("name", NAMES)
def test_the_plan_is_the_one_that_the_scene_uses(name, capsys):
    few = ["--samples", "2" if name == "one-sided" else "2000"]
    assert main(["plan", name, "--json", "--accuracy", "1e-5", *few]) == 0
    answer = json.loads(capsys.readouterr().out)
    used = scene_class(name).of({"accuracy": 1e-5}).plan
    assert (answer["model"], answer["method"], answer["reason"]) == (used.level, used.method, used.reason)
    assert answer["accuracy"] == 1e-5
    assert answer["observables"] == list(scene_class(name).observables)


def test_a_scene_file_is_planned_as_it_would_run(tmp_path, capsys):
    (tmp_path / "scene.toml").write_text('scene = "race-angles"\nmethod = "dop853"\naccuracy = 1e-4\n')
    assert main(["plan", str(tmp_path / "scene.toml")]) == 0
    out = capsys.readouterr().out
    assert "method       dop853" in out
    assert "accuracy     0.0001" in out


@pytest.mark.parametrize("line", ['eta_hat = "1e-2:1e-6"', "colour = 1", "samples = 0"])
def test_a_scene_file_that_would_not_run_is_refused(line, tmp_path, capsys):
    file = tmp_path / "scene.toml"
    file.write_text(f'scene = "race-angles"\njobs = 1\nout = "there"\n{line}\n')
    assert main(["plan", str(file)]) == main(["run", str(file)]) == 2
    planned, ran = capsys.readouterr().err.splitlines()
    assert planned.replace("plan", "run") == ran

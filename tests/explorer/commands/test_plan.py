"""`nearflat plan`: what `run` would choose."""

import json

import pytest

from explorer.commands.main import main
from explorer.scenes.registry import SCENES, build_scene


@pytest.mark.parametrize("name", SCENES)
def test_the_plan_is_the_one_that_the_scene_uses(name, capsys):
    assert main(["plan", name, "--json", "--accuracy", "1e-5"]) == 0
    answer = json.loads(capsys.readouterr().out)
    used = build_scene(name, accuracy=1e-5).plan
    assert (answer["model"], answer["method"], answer["reason"]) == (used.rung, used.method, used.reason)
    assert answer["accuracy"] == 1e-5
    assert answer["observables"] == list(SCENES[name].observables)


def test_a_scene_file_is_planned_as_it_would_run(tmp_path, capsys):
    (tmp_path / "scene.toml").write_text('scene = "race-angles"\nmethod = "dop853"\naccuracy = 1e-4\n')
    assert main(["plan", str(tmp_path / "scene.toml")]) == 0
    out = capsys.readouterr().out
    assert "method       dop853" in out
    assert "accuracy     0.0001" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["race-angels"], "did you mean 'race-angles'"),
        (["race-angles", "--accuracy", "much"], "--accuracy much is not a number"),
        (["race-angles", "--method", "euler"], "--method 'euler'"),
    ],
)
def test_what_cannot_be_planned_is_named(words, message, capsys):
    assert main(["plan", *words]) == 2
    assert message in capsys.readouterr().err

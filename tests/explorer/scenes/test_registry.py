"""Scenes by name: what makes no sense is refused, and a new scene is one file and one line."""

import json
import runpy
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from told import said

import explorer as ex
from explorer.runs import folder as folders
from explorer.runs.folder import scene_of
from explorer.scenes import registry
from explorer.scenes.base import SampledScene
from explorer.scenes.registry import SCENES, build_scene, read_scene_file, scene_class


@pytest.fixture
def periods():
    """The documented scene of a user; what a test registers is forgotten."""
    known = dict(SCENES)
    example = Path(__file__).parents[3] / "docs" / "examples" / "own_scene.py"
    yield runpy.run_path(str(example))["Periods"]
    SCENES.clear()
    SCENES.update(known)


def test_a_new_scene_has_its_help_on_the_command_line(periods, capsys):
    status, out, _ = said(capsys, "run", "periods", "--help")
    assert status == 0
    text = " ".join(out.split())
    assert "How long is a period? Of motions that start at the vertical with speeds below a limit." in text
    assert "--speed X largest speed at the vertical (default 2)" in text
    assert "--samples N" in text
    assert "--ladder" not in text
    assert "periods: largest speed" in " ".join(said(capsys, "run", "--help")[1].split())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--speed", "-1"], "--speed -1 must be a finite number, 0.1 or more"),
        (["--speed", "fast"], "--speed fast is not a number"),
        (["--ladder", "1:2"], "--ladder: periods takes no such option"),
        (["--samples", "0"], "--samples 0"),
    ],
)
def test_a_new_scene_has_its_values_checked(periods, words, message, capsys, tmp_path):
    status, _, err = said(capsys, "run", "periods", *words, "--out", tmp_path / "run")
    assert status == 2
    assert message in err
    assert not (tmp_path / "run").exists()


def test_a_new_scene_has_its_chunks_its_record_and_its_resume(periods, capsys, tmp_path):
    words = ("run", "periods", "--samples", "1e3", "--speed", "2", "--seed", "4", "--out", tmp_path / "run")
    assert said(capsys, *words)[0] == 0
    chunks = sorted((tmp_path / "run" / "chunks").glob("*.parquet"))
    assert len(chunks) == 1
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["speed"] == 2.0
    assert summary["known"] == 1000
    assert scene_of(tmp_path / "run") == build_scene("periods", samples=1000, speed=2, seed=4)
    chunks[0].unlink()
    assert said(capsys, "resume", tmp_path / "run")[0] == 0
    assert json.loads((tmp_path / "run" / "summary.json").read_text()) == summary
    longer = ex.run("periods", samples=2000, speed="2", seed=4, chunk_size=65536, out=tmp_path / "run")
    assert sum(table["period"].size for table in longer.tables()) == 2000


def test_a_new_scene_may_be_named_in_a_scene_file(periods, capsys, tmp_path):
    (tmp_path / "scene.toml").write_text('scene = "periods"\nspeed = 3\nsamples = 10\n')
    status, out, _ = said(capsys, "run", tmp_path / "scene.toml", "--out", tmp_path / "run", "--json", "--quiet")
    assert status == 0
    assert json.loads(out)["speed"] == 3.0


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        ("race-angels", {}, "did you mean 'race-angles'"),
        ("falling-set", {"samples": 0}, "samples = 0"),
        ("falling-set", {"samples": "1e400"}, "finite"),
        ("falling-set", {"samples": 1.5}, "whole number"),
        ("falling-set", {"samples": "many"}, "not a number"),
        ("falling-set", {"eta_hat": "1e-3:1e-2"}, "takes no such option"),
        ("falling-set", {"slices": "phi=0,phidot=1"}, "slice"),
        ("falling-set", {"energy": ":nan"}, "finite"),
        ("falling-set", {"energy": ":0"}, "widen it or shrink the box"),
        ("falling-set", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("one-sided", {"eta_hat": "1:1e10"}, "eta_hat"),
        ("race-angles", {"eta_hat": "1e-320:1e-310"}, "eta_hat"),
        ("one-sided", {"box": "sigma4=1:2"}, "box sigma4"),
        ("one-sided", {"box": "phi=0.2"}, "box phi"),
        ("race-angles", {"box": "phi=0.2", "eta_hat": "1e-3:1e-2"}, "eta_hat: is for passages"),
        ("race-angles", {"box": "phidot=-2:2"}, "towards flat"),
        ("race-angles", {"eta_hat": "0:1"}, "eta_hat"),
        ("race-angles", {"eta_hat": "1e-2:1e-3"}, "eta_hat"),
        ("race-angles", {"method": "rk45"}, "method"),
        ("race-angles", {"accuracy": "1e-40"}, "accuracy"),
        ("race-angles", {"seed": -1}, "seed"),
        ("race-angles", {"disk": ["hoop", "uniform"]}, "one disk"),
        ("race-angles", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("one-sided", {"disk": ["hoop", "hoop"]}, "different names"),
    ],
)
def test_options_that_make_no_sense_are_refused_by_name(scene, options, message):
    with pytest.raises(ex.InputError, match=message):
        build_scene(scene, **options)


@pytest.mark.parametrize("name", ["falling", 5, None, ["falling-set"]])
def test_what_is_no_scene_is_answered_with_the_known_ones(name):
    with pytest.raises(ex.InputError, match="known: falling-set, measure-zero, one-sided, portrait, race-angles"):
        scene_class(name)


def test_dashes_and_underscores_are_the_same_in_a_scene_file(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text('scene = "race-angles"\neta-hat = "1e-3:1e-2"\n')
    assert read_scene_file(path) == {"scene": "race-angles", "eta_hat": "1e-3:1e-2"}


def test_a_registered_scene_is_known_and_what_is_none_is_refused(periods):
    assert ex.register(periods) is periods
    assert scene_class("periods") is scene_class(periods) is periods
    named = type("Named", (periods,), {"name": "race-angles"})
    for wrong, message in (
        (3, "is no scene"),
        (type("Bare", (periods,), {"name": "My scene"}), "give a name such as"),
        (named, "is a scene of nearflat"),
        (type("Empty", (SampledScene,), {"name": "empty"}), "lacks compute, summarise"),
    ):
        with pytest.raises(ex.InputError, match=message):
            ex.register(wrong)


def test_scenes_of_installed_packages_are_loaded_and_a_broken_one_harms_no_other(periods, monkeypatch):
    class Entry(NamedTuple):
        name: str
        load: Callable[[], type]

    def broken():
        raise ImportError("no module named 'missing'")

    monkeypatch.delitem(SCENES, "periods")
    entries = [Entry("broken", broken), Entry("periods", lambda: periods)]
    monkeypatch.setattr(registry, "entry_points", lambda group: entries if group == "nearflat.scenes" else [])
    monkeypatch.setattr(registry, "_unloadable", {})
    registry._load_installed()
    assert scene_class("periods") is periods
    with pytest.raises(ex.InputError, match=r"cannot be loaded .*no module named 'missing'"):
        scene_class("broken")


def test_a_run_of_other_code_of_a_scene_is_not_continued(periods, monkeypatch, tmp_path):
    """Its chunks would not be those of one question."""
    monkeypatch.setattr(folders, "_code_of", lambda kind: "before")
    ex.run("periods", samples=10, out=tmp_path / "run")
    monkeypatch.setattr(folders, "_code_of", lambda kind: "after")
    with pytest.raises(ex.InputError, match='other code of scene periods; give another folder or exist="replace"'):
        ex.run("periods", samples=10, out=tmp_path / "run")
    assert ex.open(tmp_path / "run").verify() == [
        "run.json: other code than these computed the run; it cannot be resumed with them"
    ]

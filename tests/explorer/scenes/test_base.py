"""Scenes in general: chunks, and the memory that they take."""

import json

import pytest

import explorer as ex
from explorer.runs.run import Manner, execute
from explorer.runs.workers import Workers
from explorer.scenes.base import LARGEST_CHUNK, chunk_size_for, read_memory
from explorer.scenes.race_angles import RaceAngles
from explorer.scenes.registry import SCENES, build_scene
from kernels._jit import Kernel


def test_a_budget_decides_the_size_of_chunks_or_is_refused(tmp_path, capsys):
    run = ex.run("race-angles", out=tmp_path / "run", memory="1GB", samples=1000)
    size = json.loads((run.folder / "run.json").read_text())["identity"]["options"]["chunk_size"]
    assert f"chunks of {size:,} samples" in capsys.readouterr().err
    assert 2 * size * run.scene.bytes_per_sample < 1e9
    with pytest.raises(ex.InputError, match="needs at least 4"):
        ex.run("race-angles", out=tmp_path / "small", memory="10MB")
    for wrong in ("much", "nan", "inf", "1e400", "-1GB", 0, -(10**400)):
        with pytest.raises(ex.InputError, match="is no amount"):
            ex.run("race-angles", out=tmp_path / "small", memory=wrong)
    one, two = (ex.run("race-angles", out=tmp_path / str(n), memory="1GB", jobs=n, samples=1000) for n in (1, 2))
    assert one.summary["digest"] == two.summary["digest"]


@pytest.mark.parametrize("name", SCENES)
def test_chunks_cover_all_samples_once(name):
    options = {"samples": 100_001} if name in ("falling-set", "race-angles") else {}
    scene = build_scene(name, **options)
    lengths = [scene.length(index) for index in range(scene.chunks())]
    assert min(lengths) > 0
    if options:
        assert sum(lengths) == 100_001


@pytest.mark.parametrize("size", ["2GB", 2e9, "2000 MB", "2e6k"])
def test_memory_is_read_with_its_unit(size):
    assert read_memory("--memory", size) == 2e9


def test_no_budget_makes_chunks_larger_than_a_kernel_call_should_be():
    assert chunk_size_for(RaceAngles, "100TB", 1) == LARGEST_CHUNK


def test_memory_is_refused_for_scenes_without_such_chunks_by_the_names_of_those_that_have_them(tmp_path):
    with pytest.raises(ex.InputError, match="falling-set, measure-zero, race-angles, one-sided has none"):
        ex.run("one-sided", memory="1GB", out=tmp_path / "run")
    with pytest.raises(ex.InputError, match="sets chunk_size, which is given too"):
        ex.run("measure-zero", memory="1GB", chunk_size=100, out=tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_an_option_of_another_scene_is_refused_by_name():
    with pytest.raises(ex.InputError, match="ladder: race-angles takes no such option"):
        build_scene("race-angles", ladder="1e-3:1e-1")


def test_the_plan_of_a_scene_is_made_once_and_kept():
    scene = build_scene("race-angles", method="dop853", accuracy="1e-4")
    assert scene.plan is scene.plan
    assert (scene.plan.method, scene.plan.accuracy) == ("dop853", 1e-4)


# Scenes in the ways that call different kernels, small.
WAYS = {
    "falling-set": {"samples": 300, "grid": 9},
    "falling-set, in one pass": {"samples": 300, "grid": 9, "theta_min": "near"},
    "falling-set, integrated": {"samples": 300, "grid": 9, "method": "dop853", "accuracy": 1e-3},
    "race-angles": {"samples": 300},
    "race-angles, integrated": {"samples": 300, "method": "dop853", "accuracy": 1e-3},
    "race-angles, energy": {"samples": 300, "energy": "1:5"},
    # so exact that some states need the adaptive rules
    "race-angles, states": {"samples": 300, "box": "phi=-0.5:0.5", "accuracy": 1e-11},
    "one-sided": {"samples": 1},
    "portrait": {},
    "measure-zero": {"samples": 300, "tube": 512},
}


@pytest.mark.parametrize("way", WAYS)
def test_a_scene_names_the_kernels_that_it_calls_and_no_others(way, monkeypatch):
    """They are compiled before the first chunk, so one too many costs as long as one too few."""
    called, call = set(), Kernel.__call__

    def noted(kernel, *arguments):
        called.add(kernel.name)
        call(kernel, *arguments)

    monkeypatch.setattr(Kernel, "__call__", noted)
    disk = ex.Disk(I1=0.3, I3=0.5, name=way)  # what is kept of other bodies has been computed
    scene = build_scene(way.partition(",")[0], disk=disk, **WAYS[way])
    run = execute(scene, None, Manner(Workers(1)))
    assert called == set(scene.kernels)
    called.clear()
    for name in run.pictures:
        run.figure(name)
    assert set(scene.kernels_of_figures) <= called <= {*scene.kernels, *scene.kernels_of_figures}


@pytest.mark.parametrize(("word", "shown"), [("A b", "'A b'"), ("sampels", "sampels")])
def test_a_word_that_is_no_option_is_shown_as_it_was_written(word, shown):
    with pytest.raises(ex.InputError, match=f"^{shown}: race-angles takes no such option"):
        ex.run("race-angles", **{word: 1})

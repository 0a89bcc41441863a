"""Scenes in general: chunks, and what they call."""

import pytest

import explorer as ex
from explorer.scenes.scene import NAMES, scene_class
from kernels._jit import Kernel


@pytest.mark.parametrize("name", NAMES)
def test_chunks_cover_all_samples_once(name):
    options = {"samples": 100_001} if name in ("falling-set", "race-angles") else {}
    scene = scene_class(name).of(options)
    lengths = [scene.length(index) for index in range(scene.chunks)]
    assert min(lengths) > 0
    if options:
        assert sum(lengths) == 100_001


# Scenes in the ways that call different kernels, small.
WAYS = {
    "falling-set": {"samples": 300},
    "falling-set, in one pass": {"samples": 30_000, "theta_min": "near"},
    "falling-set, integrated": {"samples": 300, "method": "dop853", "accuracy": 1e-3},
    "falling-set, given": {"states": {"phi": [0.1], "phidot": [0.3], "sigma3": [0.4], "sigma4": [0.5]}},
    "race-angles": {"samples": 300},
    "race-angles, integrated": {"samples": 300, "method": "dop853", "accuracy": 1e-3},
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
    scene = scene_class(way.partition(",")[0]).of({"disk": disk, **WAYS[way]})
    tally = sum((scene.chunk(index)[1] for index in range(scene.chunks)), scene.tally())
    scene.summarise(tally)
    assert called == set(scene.kernels)

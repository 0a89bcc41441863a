"""Scenes in general: chunks, and what they call."""

import numpy as np
import pandas as pd
import pytest

import explorer as ex
from explorer.scenes import Counts, SampledScene
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.measure_zero import MeasureZero
from explorer.scenes.race_angles import RaceAngles
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


class DoubleCounts(Counts):
    low: int


class Doubles(SampledScene):
    """A user's, which draws two columns and counts one."""

    tally = DoubleCounts

    def draw(self, random, count):
        return {"one": random.random(count), "two": random.random(count)}

    def observe(self, drawn):
        return {**drawn, "status": np.zeros(drawn["one"].size, np.int8)}

    def count(self, tally, table):
        tally.low += int((table["two"] < 0.3).sum())


# Scenes whose samples are drawn in all ways that there are: in one pass, by rejection, column by column.
DRAWN = {
    "races": (RaceAngles, {}),
    "bounces": (RaceAngles, {"start": "anywhere", "bounces": 2}),
    "states near F": (FallingSet, {"theta_min": "near"}),
    "states": (FallingSet, {"keep": "all"}),
    "states of an energy": (FallingSet, {"theta_min": "near", "energy": "1:3"}),
    "a law of tilts": (FallingSet, {"box": "tilt=norm:0.5:0.1,precession=-1:1,spin=0:1"}),
    "a function": (FallingSet, {"theta_min": "near", "density": lambda phi, phidot, *_: 1.0 + phidot**2}),
    "rare falls": (MeasureZero, {"tube": 100, "ladder": "1e-8:1e-1"}),
    "a user's": (Doubles, {}),
}


@pytest.mark.parametrize("way", DRAWN)
def test_samples_and_counts_do_not_depend_on_the_size_of_chunks(way):
    """Sums are rounded otherwise where they are of other parts, and what is drawn in one pass to a few units."""
    (kind, options), found = DRAWN[way], []
    for chunk_size in (1024, 1 << 16, 1 << 20):
        run = ex.run(kind, progress=False, **options, samples=70_000, seed=3, chunk_size=chunk_size)
        found.append((run.frame(), run.summary))
    assert len(found[0][0]) > 0
    for rows, summary in found[1:]:
        pd.testing.assert_frame_equal(rows, found[0][0], check_exact=True)
        assert_alike(summary, found[0][1])


def assert_alike(one, other):
    """Equal numbers, but for the last digits of what is no whole number."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for name in one.keys() - {"chunk_size", "digest"}:
            assert_alike(one[name], other[name])
    elif isinstance(one, list):
        assert len(one) == len(other)
        for each, same in zip(one, other, strict=True):
            assert_alike(each, same)
    else:
        assert one == (pytest.approx(other, rel=1e-10, abs=1e-12) if isinstance(other, float) else other)


def test_a_longer_run_has_the_samples_of_a_shorter_one_where_a_stream_is_used_up():
    short, long = (RaceAngles(samples=samples, keep="all").chunk(0)[0] for samples in (65_536, 70_000))
    assert short.keys() == long.keys()
    for name, values in short.items():
        np.testing.assert_array_equal(values, long[name])


@pytest.mark.parametrize(
    ("given", "nearest"), [(1000, 1024), (777, 1024), (3, 4), (70_000, 65_536), (1e6, 983_040)]
)
def test_a_size_of_chunks_that_cuts_streams_unevenly_is_refused_with_the_nearest_that_does_not(given, nearest):
    with pytest.raises(ex.InputError, match=f"chunk_size = .*; give {nearest}$"):
        FallingSet(chunk_size=given)
    assert FallingSet(chunk_size=nearest).chunk_size == nearest


@pytest.mark.parametrize("kind", [RaceAngles, FallingSet, MeasureZero, Doubles])
def test_a_large_run_without_rows_has_few_files(kind):
    assert kind(samples=10**9, keep="none").chunk_size == 1 << 20
    assert kind(samples=10**6, keep="none").chunk_size == kind(samples=10**9, keep="all").chunk_size == 1 << 16


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

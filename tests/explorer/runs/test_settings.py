"""What is said about a run beside its question changes no number, and is refused in words."""

import os
from pathlib import Path

import numpy as np
import pytest
from coins import Coins

import explorer as ex
from explorer.commands.demo import Demo
from explorer.commands.paper import Paper
from explorer.runs.machine import machine
from explorer.runs.settings import asked


def test_keywords_are_those_of_the_scene_and_those_of_the_run():
    scene, settings = asked(Coins, {"samples": 10, "bias": "0.25", "jobs": "3", "format": "PDF,png", "out": None})
    assert (scene.samples, scene.bias) == (10, 0.25)
    assert (settings.jobs, settings.format, settings.out) == (3, ("pdf", "png"), None)
    assert (settings.exist, asked(Coins, {"exist": "error"})[1].exist) == ("resume", "error")


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="the system binds no process to a core")
def test_by_default_there_are_as_many_workers_as_cores_that_the_process_may_use():
    """What a batch system leaves to a job, and not what the machine has."""
    allowed = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, {min(allowed)})
        assert (asked(Coins, {})[1].jobs, Demo().jobs, Paper().jobs) == (1, 1, 1)
        assert asked(Coins, {"jobs": 3})[1].jobs == 3
        assert machine()["cores"] == 1
    finally:
        os.sched_setaffinity(0, allowed)


def test_large_runs_and_those_of_the_command_line_have_a_folder_of_their_own(capsys):
    assert asked(Coins, {"samples": 10**6})[1].out is None
    named = Path("results/coins-uniform-4")
    for given, command in (({"samples": 10**6 + 1, "seed": 4}, None), ({"seed": 4}, "nearflat run coins")):
        assert asked(Coins, given, command)[1].out == named
    assert not named.exists()
    assert capsys.readouterr().err == ""  # nothing ran, so nothing is claimed to be there


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"jobs": 0}, "jobs = 0"),
        ({"backend": "gpu"}, "'gpu' is not known; known: threads, processes, dask"),
        ({"scheduler": "tcp://1.2.3.4:5"}, "is for backend dask; give both"),
        ({"format": "png,jpg"}, "'jpg' is not known"),
        ({"rng": 1, "seed": 2}, "seed and rng are the same option; leave one out"),
        ({"rng": "dice"}, "seed = dice"),
        ({"out": ""}, "out"),
        ({"progress": 1}, "progress = 1 must be true or false"),
        ({"bais": 0.5}, "did you mean 'bias'"),
        ({"disk": "hoop", "disks": ["uniform"]}, "disk and disks are the same option; leave one out"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_written(given, message, tmp_path):
    with pytest.raises(ex.InputError, match=message):
        ex.run(Coins, **{"out": tmp_path / "run", **given})
    assert not (tmp_path / "run").exists()


def test_rng_is_a_seed_from_what_numpy_has():
    seeds = [
        asked(Coins, {"rng": rng})[0].seed
        for rng in (7, np.random.SeedSequence(7), np.random.SeedSequence(7).spawn(1)[0], np.random.default_rng(7))
    ]
    assert seeds[:2] == [7, 7]
    assert len({*seeds}) == 3
    assert max(seeds) < 2**128


@pytest.mark.parametrize("scene", ["race-angles", "falling-set", "measure-zero"])
def test_more_chunks_than_can_be_held_are_refused_with_a_size_that_works(scene):
    """Nothing is counted one by one until the number of chunks is known to be small."""
    for samples in (10**6 + 1, 10**9, 10**12):
        for ask in (ex.plan, ex.run):
            with pytest.raises(ex.InputError, match="at most 1,000,000 are held; give chunk_size") as refused:
                ask(scene, samples=samples, chunk_size=1)
        size = str(refused.value).partition("chunk_size ")[2].split()[0]
        assert asked(scene, {"samples": samples, "chunk_size": size})[0].chunks <= 1_000_000


def test_more_starts_than_can_be_held_are_refused():
    with pytest.raises(ex.InputError, match="at most 1,000,000 are held; give fewer samples"):
        ex.plan("one-sided", samples=1e12)

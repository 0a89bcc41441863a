"""Several runs of one question add up to one, and no sample is counted twice."""

import json
from dataclasses import replace

import numpy as np
import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.commands.main import main
from explorer.scenes.registry import build_scene


@pytest.fixture(scope="module")
def other():
    return ex.run("race-angles", **{**SMALL_RACES, "seed": 6, "samples": 2000, "chunk_size": 500})


def test_merged_runs_count_the_samples_of_both(computed_once, other):
    both = ex.merge(computed_once, other)
    assert (both.summary["samples"], both.summary["seed"]) == (5000, [5, 6])
    assert both.summary == ex.merge(other, computed_once).summary
    races = np.concatenate([run.frame()["race_angle"] for run in (computed_once, other)])
    assert both.frame()["race_angle"].tolist() == races.tolist()
    for name, sign in (("plus", 1.0), ("minus", -1.0)):
        assert both.summary[f"mean_{name}"] == pytest.approx(races[sign * races > 0.0].mean(), rel=1e-13)
        counts = [np.array(run.summary["histogram"][f"counts_{name}"]) for run in (both, computed_once, other)]
        assert np.array_equal(counts[0], counts[1] + counts[2])
    assert both.verify() == []
    assert both.figure("histogram").axes


def test_runs_that_share_samples_or_ask_something_else_are_refused(computed_once, other):
    longer = ex.run("race-angles", **{**SMALL_RACES, "samples": 100})
    for runs, message in (
        ((computed_once, longer), "both have seed 5, so one repeats samples of the other"),
        ((computed_once, computed_once), "both have seed 5"),
        ((other, ex.run("race-angles", samples=10)), "has eta_hat = "),
        ((ex.run("portrait"), ex.run("portrait", rng=1)), "draws no samples"),
        ((computed_once,), "two runs or more"),
        ((computed_once, "results/races"), "is no run"),
    ):
        with pytest.raises(ex.InputError, match=message):
            ex.merge(*runs)


@pytest.mark.parametrize("name", ["falling-set", "one-sided", "measure-zero"])
def test_what_is_counted_does_not_depend_on_the_seed_so_that_it_can_be_added(name):
    """Edges of bins and maps are the same in all runs of a question."""
    one, two = (build_scene(name, seed=seed) for seed in (1, 2))
    if name == "falling-set":
        assert all(map(np.array_equal, one._plane_edges, two._plane_edges))
    if name == "measure-zero":
        assert np.array_equal(one.question.energy_edges, two.question.energy_edges)
    assert one.together([replace(two, samples=7)]) == replace(one, samples=one.samples + 7)


def test_the_parts_of_a_scene_of_several_disks_are_put_together_disk_by_disk():
    runs = [ex.run("one-sided", samples=1, disk=["hoop", "matching"], eta_hat="1e-4:1e-2", rng=i) for i in (1, 2)]
    both = ex.merge(*runs)
    for name in ("hoop", "matching"):
        whole, *parts = (run.summary["disks"][name]["distances"] for run in (both, *runs))
        for row, *others in zip(whole, *parts, strict=True):
            assert row["largest_plus"] == max(other["largest_plus"] for other in others)


def test_the_command_adds_up_folders(finished, tmp_path, capsys):
    second = ex.run("race-angles", out=tmp_path / "second", figures=False, **{**SMALL_RACES, "seed": 6})
    assert main(["summary", str(finished.folder), str(second.folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == ex.merge(finished, second).summary
    assert main(["summary", str(finished.folder), str(finished.folder)]) == 2
    assert "both have seed 5" in capsys.readouterr().err

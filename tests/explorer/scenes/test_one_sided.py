"""Scene one-sided: distances to the limit motions shrink, and the limits differ by the gap."""

import itertools
import json
import math

import numpy as np
import pytest
from conftest import computed

import explorer as ex
from explorer.scenes.one_sided import Approach, OneSided
from explorer.scenes.scene import scene_of


@pytest.fixture(scope="module")
def scene():
    return OneSided(samples=6)


@pytest.fixture(scope="module")
def tally(scene):
    return computed(scene)


def test_the_two_sides_differ_by_the_published_gap_and_agree_for_the_matching_body(scene, tally):
    found = scene.summarise(tally)
    for name, gap in (("uniform", 1.483259), ("hoop", 4.599611), ("matching", 0.0)):
        disk = found["disks"][name]
        assert disk["gap"]["measured"] == pytest.approx(gap, abs=1e-4)
        assert disk["gap"]["exact"] == pytest.approx(gap, abs=1e-6)
        assert disk["coincide"] is (name == "matching")
        for side in ("plus", "minus"):
            medians = [row[f"median_{side}"] for row in disk["distances"]]
            assert all(b < 0.25 * a for a, b in itertools.pairwise(medians))  # as eta ln(1/eta) does
            assert medians[-1] < 1e-4
        assert [round(math.log10(row["eta_hat"])) for row in disk["distances"]] == [-1, -2, -3, -4, -5, -6]
    assert len(scene.headline(found)) == 3


def test_the_tally_holds_the_distances_of_the_rows(scene, tally):
    table, _ = scene.chunk(0)
    np.testing.assert_array_equal(np.ravel(tally.distances["uniform"]), table["distance"])
    assert table["status"].size == scene.length(0) == 6 * 2 * 6


@pytest.mark.parametrize("method", ["auto", "rk4", "dopri5"])
def test_distances_are_those_of_far_more_accurate_motions(method):
    asked = {"samples": 16, "seed": 4, "disk": "matching", "eta_hat": "1e-6:1e-5"}
    found, exact = (OneSided(**asked, **how).chunk(1)[0] for how in ({"method": method}, {"accuracy": 1e-11}))
    np.testing.assert_allclose(found["distance"], exact["distance"], rtol=1e-3)


def test_the_accuracy_follows_the_smallest_distance_as_far_as_the_method_can():
    assert OneSided().accuracy == pytest.approx(1e-9)
    assert OneSided(eta_hat="1e-4:1e-2").accuracy == pytest.approx(1e-7)
    assert OneSided(eta_hat="1e-12:1e-2").accuracy == 1e-11
    assert OneSided(accuracy="1e-6").accuracy == 1e-6
    disk = ex.Disk.uniform(m=1.0, r=0.01, g=9.81)
    assert OneSided(disk=disk).accuracy == pytest.approx(1e-9)


def test_a_motion_that_failed_is_left_out_of_the_distances():
    scene, tally = OneSided(samples=1, disk="hoop", eta_hat="1e-3:1e-2"), Approach()
    tally.distances["hoop"] += [[[0.2, None], [0.3, 0.1]]]
    tally.apart["hoop"] += [None]
    found = scene.summarise(tally)
    rows, gap = (found["disks"]["hoop"][name] for name in ("distances", "gap"))
    assert [(row["motions_plus"], row["motions_minus"]) for row in rows] == [(1, 1), (0, 1)]
    assert rows[0]["median_plus"] == rows[0]["largest_plus"] == 0.2
    assert "median_plus" not in rows[1]
    assert gap["measured"] is None is found["disks"]["hoop"]["coincide"]
    assert "not measured" in scene.headline(found)[0]


def test_runs_with_other_seeds_add_up(scene):
    runs = [ex.run(**{**scene.options, "disks": ["hoop"], "seed": seed}, progress=False) for seed in (0, 1)]
    with pytest.raises(ex.InputError, match="one run has disks = "):
        ex.merge(runs[0], ex.run(**{**scene.options, "samples": 1, "seed": 2}, progress=False))
    found = ex.merge(*runs).summary
    assert found["samples"] == 12 == found["disks"]["hoop"]["distances"][0]["motions_plus"]


def test_options_come_back_from_json():
    scene = OneSided(disk=["hoop", "uniform"], box="phidot=1:1.5", eta_hat="1e-9:1e-6")
    assert scene_of(json.loads(json.dumps(scene.options))) == scene
    assert [disk["name"] for disk in scene.options["disks"]] == ["hoop", "uniform"]
    assert scene.label == "hoop+uniform"
    assert scene.ladder(scene.disk[0]) == pytest.approx([1e-6, 1e-7, 1e-8, 1e-9])
    assert OneSided().options["box"] is None


def test_a_box_that_is_given_holds_for_every_disk_and_the_default_one_is_in_natural_units():
    heavy = ex.Disk.parse("m=1,r=1,g=400,I1=0.25,I3=0.5")
    default, given = (OneSided(disk=["hoop", heavy], **box) for box in ({}, {"box": "phidot=1:1.5"}))
    fast = [
        [abs(start["phidot"]) for start in default.starts(index)]
        for index in (0, default.chunks // len(default.disk))
    ]
    assert 0.5 < min(fast[0]) < max(fast[0]) < 2.0 < 10.0 < min(fast[1]) < max(fast[1]) < 40.0
    for index in (0, given.chunks // len(given.disk)):
        assert all(1.0 < abs(start["phidot"]) < 1.5 for start in given.starts(index))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"disk": ["hoop", "hoop"]}, "different names"),
        ({"disk": "m=1,r=1,g=1,I1=0.5,I3=0"}, "I3"),
        ({"eta_hat": "1e-6:100"}, "eta_hat"),
        ({"box": "sigma4=0:1"}, "box sigma4"),
        ({"box": "phidot=-1:1"}, "box phidot"),
    ],
)
def test_bad_input_gets_a_sentence(options, words):
    with pytest.raises(ex.InputError, match=words):
        OneSided(**options)

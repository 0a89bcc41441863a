"""Scene one-sided: distances to the limit motions shrink, and the limits differ by the gap."""

import itertools
import math

import pytest
from conftest import computed

import explorer as ex
from explorer.scenes.registry import build_scene


def test_the_two_sides_differ_by_the_published_gap_and_agree_for_the_matching_body():
    scene = build_scene("one-sided", samples=6)
    found = scene.summarise(computed(scene))
    for name, gap in (("uniform", 1.483259), ("hoop", 4.599611), ("matching", 0.0)):
        disk = found["disks"][name]
        assert disk["gap"]["measured"] == pytest.approx(gap, abs=1e-4)
        assert disk["gap"]["exact"] == pytest.approx(gap, abs=1e-6)
        assert disk["coincide"] is disk["coincide_exact"] is (name == "matching")
        assert disk["rate_plus"] == pytest.approx(1.0, abs=0.15)
        assert disk["rate_minus"] == pytest.approx(1.0, abs=0.15)
        medians = [row["median_plus"] for row in disk["distances"]]
        assert all(b < a for a, b in itertools.pairwise(medians))
        assert medians[-1] < 1e-4
        assert [round(math.log10(row["eta_hat"])) for row in disk["distances"]] == [-1, -2, -3, -4, -5, -6]
    assert len(scene.headline(found)) == 3


def test_a_range_of_distances_is_cut_into_decades():
    scene = build_scene("one-sided", disk="hoop", eta_hat="1e-9:1e-6")
    assert scene.ladder(scene.disk) == pytest.approx([1e-6, 1e-7, 1e-8, 1e-9])
    assert scene.options()["box"] is None


def test_a_box_that_is_given_holds_for_every_disk_and_the_default_one_is_in_natural_units():
    heavy = ex.Disk.parse("m=1,r=1,g=400,I1=0.25,I3=0.5")
    default = build_scene("one-sided", disk=["hoop", heavy])
    assert default.where(heavy).phidot == pytest.approx((10.0, 40.0))
    given = build_scene("one-sided", disk=["hoop", heavy], box="phidot=1:1.5")
    assert given.where(heavy).phidot == given.where(given.disk).phidot == (1.0, 1.5)

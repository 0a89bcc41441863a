import itertools
import math

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.portrait.slices import Slice, map_slice
from explorer.scenes.options import build_scene


def summary_of(name, **options):
    scene = build_scene(name, **options)
    return scene, scene.summarise(computed(scene))


@pytest.mark.parametrize("disk", ["uniform", "hoop", "matching"])
def test_race_angles_pile_up_at_kappa_pi(disk):
    """Prop. 2 at |eta_hat| about 1e-6: the mean within 1e-3 of +-kappa pi, and no race the wrong way."""
    _, found = summary_of("race-angles", disk=disk, samples=4000, eta_hat="1e-6:1.1e-6")
    limit = BODIES[disk].race_limit
    assert found["limit"] == limit
    for name, sign in (("plus", 1), ("minus", -1)):
        assert abs(found[f"mean_{name}"] - sign * limit) < 1e-3
        assert abs(found[f"median_{name}"] - sign * limit) < 1e-4
        assert found[f"width_{name}"] < 1e-4
    assert found["wrong_way"] == 0
    assert found["failures"] == {}


def test_a_hundred_thousand_races_over_eight_decades_go_no_wrong_way():
    """Every one is right or says that it does not know."""
    scene, found = summary_of("race-angles", samples=100_000, eta_hat="1e-10:1e-2", accuracy=1e-3)
    assert found["wrong_way"] == 0
    assert found["status"]["ok"] + found["failures"].get("unresolved_side", 0) == 100_000
    assert found["status"]["ok"] > 95_000
    counts = found["histogram"]
    assert sum(counts["counts_plus"]) + counts["outside_plus"] == pytest.approx(50_000, rel=0.05)
    deviations = [row["median_deviation"] for row in found["by_decade"]]
    assert all(a < b for a, b in itertools.pairwise(deviations[3:]))
    assert found["energy_range"][1] > 3 * found["energy_range"][0]
    assert scene.headline(found)[-1].startswith("wrong way: 0")


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_no_method_guesses_below_its_resolution(method):
    _, found = summary_of("race-angles", samples=3000, eta_hat="1e-15:1e-5", accuracy=1e-2, method=method, seed=4)
    assert found["wrong_way"] == 0
    assert found["failures"]["unresolved_side"] > 100
    assert found["status"]["ok"] > 100


def test_races_that_nothing_resolves_are_an_error_in_words():
    scene = build_scene("race-angles", samples=100, eta_hat="1e-20:1e-19", method="dopri5")
    with pytest.raises(ex.RunError, match="none of 100 passages was resolved"):
        scene.summarise(computed(scene))


def test_the_race_angle_follows_its_law():
    """Delta chi - fall angle - kappa pi = 2 m g r eta ln(1/|eta|) / (I1 M A^3) + O(eta)."""
    disk = BODIES["hoop"]
    scene = build_scene(
        "race-angles", disk="hoop", samples=2000, box="phidot=1,sigma3=1", eta_hat="1e-6:1e-4", accuracy=1e-9
    )
    table = scene.compute(0)
    eta = table["eta_hat"] * disk.body.I3 * disk.body.r0
    A = table["impact_speed"]
    rest = table["race_angle"] - np.sign(eta) * disk.race_limit
    law = 2.0 * eta * np.log(1 / abs(eta)) / (disk.body.I1 * disk.body.M * A**3)
    coefficient, constant = np.linalg.lstsq(np.column_stack([law, eta]), rest, rcond=None)[0]
    assert coefficient == pytest.approx(1.0, abs=0.02)
    assert abs(constant) < 20


def test_the_two_sides_differ_by_the_published_gap_and_agree_for_the_matching_body():
    scene, found = summary_of("one-sided", samples=6)
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


def test_the_falling_set_summary_adds_up():
    _, found = summary_of("falling-set", samples=20_000, box="phi=-1:1")
    assert sum(found["side_counts"].values()) == found["samples"] == 20_000
    assert sum(found["status"].values()) == 20_000
    low, high = found["could_fall_interval_95"]
    assert 0 < low < found["could_fall_fraction"] < high < 1
    assert found["falls"] == 0
    assert found["status"]["ok"] > 19_900


def test_the_share_of_nearly_flat_motions_is_proportional_to_the_tilt():
    """P(theta_min < delta) = C delta with C = 1.46927 for this box (mathematics, section 4)."""
    _, found = summary_of("falling-set", samples=300_000)
    assert found["theta_min_quantiles"]["0.01"] == pytest.approx(0.01 / 1.46927, rel=0.05)


def test_the_integrated_valley_lies_on_the_exact_curve():
    """On a slice at the vertical and on a curved one: theta_min is smallest where eta changes sign."""
    disk = BODIES["uniform"]
    for text in ("phi=0,phidot=1,sigma3=0.2:2,sigma4=0:1.6", "phi=0.2:0.9,phidot=0.3,sigma3=0.4,sigma4=0.1:1.2"):
        found = map_slice(disk, Slice.parse(text), 201, "dopri5")
        inside = 0
        for row, column in enumerate(np.argmin(found.theta_min, axis=1)):
            if found.theta_min[row, column] > 0.02 or not 2 < column < 198:
                continue
            around = found.distance_plus[row, column - 2 : column + 3]
            assert around.min() < 0 < around.max()
            assert found.could_fall_plus[row, column]
            inside += 1
        assert inside > 50


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        ("race-angels", {}, "did you mean 'race-angles'"),
        ("falling-set", {"samples": 0}, "--samples 0"),
        ("falling-set", {"samples": "1e400"}, "finite"),
        ("falling-set", {"samples": 1.5}, "whole number"),
        ("falling-set", {"samples": "many"}, "not a number"),
        ("falling-set", {"eta_hat": "1e-3:1e-2"}, "takes no such option"),
        ("falling-set", {"slices": "phi=0,phidot=1"}, "--slice"),
        ("falling-set", {"max_energy": "nan"}, "finite"),
        ("falling-set", {"max_energy": 0.0}, "raise it or shrink the box"),
        ("falling-set", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("one-sided", {"eta_hat": "1:1e10"}, "--eta-hat"),
        ("race-angles", {"eta_hat": "1e-320:1e-310"}, "--eta-hat"),
        ("race-angles", {"box": "sigma4=1:2"}, "--box sigma4"),
        ("race-angles", {"box": "phi=0.2"}, "--box phi"),
        ("race-angles", {"box": "phidot=-2:2"}, "towards flat"),
        ("race-angles", {"eta_hat": "0:1"}, "--eta-hat"),
        ("race-angles", {"eta_hat": "1e-2:1e-3"}, "--eta-hat"),
        ("race-angles", {"method": "rk45"}, "--method"),
        ("race-angles", {"accuracy": "1e-40"}, "--accuracy"),
        ("race-angles", {"seed": -1}, "--seed"),
        ("race-angles", {"disk": ["hoop", "uniform"]}, "one disk"),
        ("race-angles", {"disk": ex.Disk(I1=0.3, I3=0.0)}, "I3 = 0"),
        ("one-sided", {"disk": ["hoop", "hoop"]}, "different names"),
    ],
)
def test_options_that_make_no_sense_are_refused_by_name(scene, options, message):
    with pytest.raises(ex.InputError, match=message):
        build_scene(scene, **options)

"""Scene race-angles: the race angle tends to +-kappa pi, and nothing guesses where it does not know."""

import itertools
import json

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.scenes.registry import build_scene


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
    scene, found = summary_of("race-angles", samples=100_000, eta_hat="1e-10:1e-2", accuracy=1e-8)
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
def test_the_coarsest_integrator_knows_every_side_down_to_1e_minus_300(method):
    """Its error is a percent; it carries eta by itself and holds it, and so loses no side to rounding."""
    _, found = summary_of("race-angles", samples=3000, eta_hat="1e-300:1e-5", accuracy=1e-2, method=method, seed=4)
    assert found["wrong_way"] == 0
    assert found["status"] == {"ok": 3000}


@pytest.mark.parametrize("options", [{}, {"energy": "1.5:2"}, {"eta_hat": "1e-300:1", "method": "rk4"}])
def test_what_is_counted_block_by_block_is_what_the_columns_hold(options):
    """Rows and counts to the last digit, whatever is kept; a chunk is of a block and a part of one."""
    scenes = {keep: build_scene("race-angles", samples=40_000, keep=keep, **options) for keep in ("none", "all")}
    table = scenes["all"].compute(0)
    counts = scenes["all"].tally(0, table)
    for keep, scene in scenes.items():
        kept, tally = scene.process(0)
        assert list(kept) == list(table)
        assert json.dumps(tally) == json.dumps(counts)
        for name, values in kept.items():
            assert values.dtype == table[name].dtype
            np.testing.assert_array_equal(values, table[name] if keep == "all" else table[name][:0])


def test_races_that_nothing_resolves_are_an_error_in_words():
    scene = build_scene("race-angles", samples=100, box="phidot=1,sigma3=1e120")  # beyond what is computed
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


def test_every_figure_that_is_foreseen_is_drawn():
    scene = build_scene("race-angles", samples=500)
    total = computed(scene)
    assert len(list(scene.figures(scene.summarise(total), total))) == scene.figure_count == 2


@pytest.fixture(scope="module")
def wobbling():
    """Tilt, precession and spin of a coin in SI, all within a degree of flat, and a column of the user's."""
    random, count = np.random.default_rng(3), 4000
    return {
        "tilt": random.uniform(0.1, 1.0, count),
        "tilt_rate": np.degrees(random.normal(0.0, 5.0, count)),
        "precession": np.degrees(random.normal(0.0, 60.0, count)),
        "spin": np.degrees(random.normal(0.0, 1.0, count)),
        "coin": np.arange(count) % 7,
    }


def test_the_races_of_a_wobbling_coin_tend_to_kappa_pi_by_decade(wobbling, tmp_path):
    """From a table to the histogram; the mean tends to +-kappa pi, and the same for any number of jobs."""
    path = tmp_path / "coin.csv"
    np.savetxt(
        path, np.column_stack(list(wobbling.values())), "%.17g", ",", header=",".join(wobbling), comments=""
    )
    options = {"disk": BODIES["coin"], "degrees": True, "chunk_size": 700}
    run = ex.run("race-angles", states=wobbling, out=tmp_path / "one", jobs=1, **options)
    other = ex.run("race-angles", states=path, out=tmp_path / "two", jobs=2, **options)
    assert run.summary["digest"] == other.summary["digest"]
    assert run.summary["status"] == {"ok": 4000}
    limit = BODIES["coin"].race_limit
    away = [
        max(abs(row["mean_plus"] - limit), abs(row["mean_minus"] + limit))
        for row in run.summary["by_decade"]
        if row["passages"] > 100
    ]
    assert all(a < 0.6 * b for a, b in itertools.pairwise(away))
    assert away[0] < 0.05
    lines = run.scene.headline(run.summary)
    assert f"of the {run.summary['races_plus']:,} bounces with eta > 0" in " ".join(lines)
    rows = np.concatenate([table["row"] for table in run.tables()])
    coins = np.concatenate([table["coin"] for table in run.tables()])
    np.testing.assert_array_equal(coins, wobbling["coin"][rows])


def test_several_bounces_have_a_row_each_and_one_bad_row_ends_nothing(wobbling):
    some = {name: values[:50].copy() for name, values in wobbling.items()}
    some["tilt"][7] = np.nan
    scene, found = summary_of("race-angles", states=some, degrees=True, bounces=3, disk=BODIES["coin"])
    table = scene.compute(0)
    np.testing.assert_array_equal(table["row"], np.repeat(np.arange(50), 3))
    np.testing.assert_array_equal(table["bounce"], np.tile(np.arange(3), 50))
    assert (table["row"][table["status"] == ex.Status.BAD_INPUT] == 7).all()
    assert found["status"] == {"ok": 49, "bad_input": 1}
    assert found["approaches"] == 147


def test_an_energy_cuts_the_starts_beside_f():
    scene = build_scene("race-angles", samples=1000, energy="1.5:2")
    energy = scene.compute(0)["energy"]
    assert (energy >= 1.5).all()
    assert (energy <= 2.0).all()
    assert np.ptp(energy) > 0.4


def test_states_and_starts_beside_f_exclude_each_other():
    with pytest.raises(ex.InputError, match="leave one out"):
        build_scene("race-angles", bounces=2, eta_hat="1e-3:1e-2")
    with pytest.raises(ex.InputError, match="bounces of states are by quadrature"):
        build_scene("race-angles", bounces=2, method="rk4")
    with pytest.raises(ex.RunError, match="too small to come flat"):
        summary_of("race-angles", states={"phi": [-1.2543], "phidot": -0.0647, "sigma3": 1.056, "sigma4": -2.2335})


def test_starts_that_are_none_are_answered_with_what_can_be_done_about_them():
    with pytest.raises(ex.RunError, match=r"none of 10 passages was resolved \(10 bad_input\); in box"):
        ex.run("race-angles", samples=10, box="sigma3=1e120:1e121")

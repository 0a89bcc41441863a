"""Scene race-angles: the race angle tends to +-kappa pi, and nothing guesses where it does not know."""

import itertools

import numpy as np
import pytest
from conftest import BODIES, computed

import explorer as ex
from explorer.scenes.race_angles import RaceAngles, RaceCounts


def summary_of(**options):
    scene = RaceAngles.of(options)
    return scene, scene.summarise(computed(scene))


@pytest.mark.parametrize("disk", ["uniform", "hoop", "matching"])
def test_race_angles_pile_up_at_kappa_pi(disk):
    """Prop. 2 at |eta_hat| about 1e-6: the mean within 1e-3 of +-kappa pi, and no race the wrong way."""
    _, found = summary_of(disk=disk, samples=4000, eta_hat="1e-6:1.1e-6")
    limit = BODIES[disk].race_limit
    assert found["limit"] == limit
    for name, sign in (("plus", 1), ("minus", -1)):
        assert abs(found[f"mean_{name}"] - sign * limit) < 1e-3
        assert abs(found[f"median_{name}"] - sign * limit) < 1e-4
        assert found[f"width_{name}"] < 1e-4
    assert found["wrong_way"] == 0


def test_a_hundred_thousand_races_over_eight_decades_go_no_wrong_way():
    """Every one is right or says that it does not know."""
    scene, found = summary_of(samples=100_000, eta_hat="1e-10:1e-2", accuracy=1e-8)
    assert found["wrong_way"] == 0
    assert found["status"]["ok"] + found["status"].get("unresolved_side", 0) == 100_000
    assert found["status"]["ok"] > 95_000
    counts = found["histogram"]
    assert sum(counts["counts_plus"]) + counts["outside_plus"] == found["races_plus"]
    assert found["races_plus"] == pytest.approx(50_000, rel=0.05)
    deviations = [row["median_deviation"] for row in found["by_decade"]]
    assert all(a < b for a, b in itertools.pairwise(deviations[3:]))
    assert "wrong way: 0" in scene.headline(found)


@pytest.mark.parametrize("method", ["rk4", "dopri5"])
def test_the_coarsest_integrator_knows_every_side_down_to_1e_minus_300(method):
    """Its error is a percent; it carries eta by itself and holds it, and so loses no side to rounding."""
    _, found = summary_of(samples=3000, eta_hat="1e-300:1e-5", accuracy=1e-2, method=method, seed=4)
    assert found["wrong_way"] == 0
    assert found["status"] == {"ok": 3000}


@pytest.mark.parametrize(
    ("samples", "options"), [(40_000, {}), (5000, {"eta_hat": "1e-300:1", "method": "rk4", "accuracy": 1e-2})]
)
def test_counts_are_of_all_samples_and_those_of_the_columns(samples, options):
    """Whatever is kept; the first chunk is of a block and a part of one."""
    scenes = {keep: RaceAngles.of(dict(samples=samples, keep=keep, **options)) for keep in ("none", "all")}
    (nothing, counts), (table, tally) = (scene.chunk(0) for scene in scenes.values())
    assert counts.state() == tally.state()
    assert {name: values.dtype for name, values in nothing.items()} == {n: v.dtype for n, v in table.items()}
    assert (nothing["status"].size, table["status"].size) == (0, samples)
    found = scenes["all"].summarise(tally)
    for name, side in (("plus", 1.0), ("minus", -1.0)):
        race = table["race_angle"][(side * table["eta_hat"] > 0.0) & np.isfinite(table["race_angle"])]
        assert found[f"races_{name}"] == race.size
        assert found[f"mean_{name}"] == pytest.approx(race.mean(), rel=1e-12)
        assert found[f"median_{name}"] == pytest.approx(np.median(race), abs=1e-3)
        np.testing.assert_array_equal(
            found["histogram"][f"counts_{name}"], np.histogram(race, found["histogram"]["edges"])[0]
        )


def made_up(seed, count=500):
    """Rows of races that are further from their limit by eta_hat, with some on F and some that nobody knows."""
    random = np.random.default_rng(seed)
    eta_hat = 10.0 ** random.uniform(-4, -1, count) * random.choice([1.0, -1.0], count)
    race, ones = np.sign(eta_hat) * BODIES["uniform"].race_limit + eta_hat, np.ones(count)
    race[::50], eta_hat[::100], eta_hat[1::100] = np.nan, np.nan, 0.0
    names = ("delta_chi", "impact_speed", "energy", "error_estimate")
    return {"race_angle": race, "eta_hat": eta_hat, "wrong_way": ones > 2.0, **dict.fromkeys(names, ones)}


def test_races_are_counted_by_decade_and_side_and_those_on_f_in_none():
    table, tally = made_up(3), RaceCounts(status={"ok": 500})
    scene = RaceAngles.of({"samples": 500})
    scene.count(tally, table)
    found = scene.summarise(tally)
    race, eta_hat = table["race_angle"], table["eta_hat"]
    known = np.isfinite(race) & (abs(eta_hat) > 0.0)
    assert (tally.without_race, found["races_plus"] + found["races_minus"]) == (10, known.sum())
    assert found["races_plus"] == (known & (eta_hat > 0.0)).sum()
    assert [row["eta_hat_from"] for row in found["by_decade"]] == pytest.approx([1e-4, 1e-3, 1e-2])
    for row in found["by_decade"]:
        of_decade = known & (abs(eta_hat) >= row["eta_hat_from"]) & (abs(eta_hat) < 10.0 * row["eta_hat_from"])
        assert row["passages"] == of_decade.sum()
        assert row["largest_deviation"] == pytest.approx(abs(eta_hat[of_decade]).max(), rel=1e-12)
        assert row["mean_plus"] == pytest.approx(race[of_decade & (eta_hat > 0.0)].mean(), rel=1e-12)
        assert row["mean_minus"] == pytest.approx(race[of_decade & (eta_hat < 0.0)].mean(), rel=1e-12)


def test_the_race_angle_follows_its_law():
    """Delta chi - fall angle - kappa pi = 2 m g r eta ln(1/|eta|) / (I1 M A^3) + O(eta)."""
    disk = BODIES["hoop"]
    scene = RaceAngles.of(
        {"disk": "hoop", "samples": 2000, "box": "phidot=1,sigma3=1", "eta_hat": "1e-6:1e-4", "accuracy": 1e-9}
    )
    table = scene.chunk(0)[0]
    eta = table["eta_hat"] * disk.body.I3 * disk.body.r0
    A = table["impact_speed"]
    rest = table["race_angle"] - np.sign(eta) * disk.race_limit
    law = 2.0 * eta * np.log(1 / abs(eta)) / (disk.body.I1 * disk.body.M * A**3)
    coefficient, constant = np.linalg.lstsq(np.column_stack([law, eta]), rest, rcond=None)[0]
    assert coefficient == pytest.approx(1.0, abs=0.02)
    assert abs(constant) < 20


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
    columns = np.column_stack(list(wobbling.values()))
    np.savetxt(path, columns, "%.17g", ",", header=",".join(wobbling), comments="")
    options = {"disk": BODIES["coin"], "degrees": True, "chunk_size": 512, "figures": False}
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
    assert f"of the {run.summary['races_plus']:,} with eta > 0" in repr(run)
    frame = run.frame(columns=["row", "coin"])
    np.testing.assert_array_equal(frame["coin"], wobbling["coin"][frame["row"]])


def test_several_bounces_have_a_row_each_and_one_bad_row_ends_nothing(wobbling):
    some = {name: values[:50].copy() for name, values in wobbling.items()}
    some["tilt"][7] = np.nan
    scene, found = summary_of(states=some, degrees=True, bounces=3, disk=BODIES["coin"])
    table = scene.chunk(0)[0]
    np.testing.assert_array_equal(table["row"], np.repeat(np.arange(50), 3))
    np.testing.assert_array_equal(table["bounce"], np.tile(np.arange(3), 50))
    assert (table["row"][table["status"] == ex.Status.BAD_INPUT] == 7).all()
    assert found["status"] == {"ok": 49, "bad_input": 1}
    assert found["approaches"] == 147


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"box": "phidot=1,sigma3=1e120"}, r"none of 10 samples has a race angle \(10 bad_input\); .*in box"),
        (
            {"states": {"phi": [-1.2543], "phidot": [-0.0647], "sigma3": [1.056], "sigma4": [-2.2335]}},
            "give states with more energy",
        ),
    ],
)
def test_where_there_is_no_race_the_run_says_what_can_be_done_about_it(options, message):
    with pytest.raises(ex.RunError, match=message):
        ex.run("race-angles", **({} if "states" in options else {"samples": 10}), **options)


def test_the_figures_of_a_run_are_drawn():
    run = ex.run("race-angles", samples=500)
    assert [bool(run.figure(name).axes) for name in run.pictures] == [True, True]

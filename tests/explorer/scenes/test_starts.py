"""Where samples come from: a density, states of the user's, or the neighbourhood of F; what cannot be combined."""

import json

import numpy as np
import pandas as pd
import pytest
from conftest import BODIES
from scipy.stats import kstest, norm

import explorer as ex
from explorer.measure.sampling import numbered_stream
from explorer.scenes.falling_set import FallingSet
from explorer.scenes.race_angles import RaceAngles
from explorer.scenes.scene import scene_of
from explorer.scenes.starts import box_near_f, eta_hat_span, starts_near_f

GIVEN = pd.DataFrame(
    {"phi": np.linspace(-1.0, 1.0, 7), "phidot": 0.3, "sigma3": 0.5, "sigma4": 0.2, "energy": "mine"}
)
ROWS = pd.DataFrame({"phi": [0.1, np.nan, 0.2], "phidot": 1.0, "sigma3": 1.0, "sigma4": [0.5, 2.0, 1.0]})
BOTH = pytest.mark.parametrize("kind", [FallingSet, RaceAngles])


def rows_of(scene):
    tables = [scene.chunk(index)[0] for index in range(scene.chunks)]
    return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}


@BOTH
def test_both_scenes_take_states_from_one_source(kind):
    table = rows_of(kind.of({"states": GIVEN, "chunk_size": 4, "keep": "all"}))
    np.testing.assert_array_equal(table["row"], np.arange(7))
    np.testing.assert_array_equal(table["phi"], GIVEN["phi"])
    assert set(table["given_energy"]) == {"mine"}
    assert table["energy"].dtype == float


@BOTH
def test_a_law_a_density_and_an_energy_draw_the_same_states_in_both_scenes(kind):
    def density(phi, phidot, sigma3, sigma4):
        return np.where(sigma4 > 0.0, 1.0, 0.0)

    options = {"box": "phi=-1:1,sigma3=norm:0.5:0.01", "density": density, "energy": ":3"}
    scene = kind.of(dict(samples=2000, keep="all", **options))
    table = rows_of(scene)
    assert abs(table["sigma3"].mean() - 0.5) < 0.001
    assert table["sigma3"].std() == pytest.approx(0.01, rel=0.1)
    assert (table["sigma4"] > 0.0).all()
    assert np.nanmax(table["energy"]) <= 3.0
    np.testing.assert_array_equal(table["phi"], rows_of(FallingSet(samples=2000, keep="all", **options))["phi"])
    assert scene.options["density"]["function"].endswith("density")
    with pytest.raises(ex.InputError, match="given in Python"):
        scene_of(scene.options)


CLOUD = {"box": "tilt=10:60,tilt_rate=-20:20,precession=-90:90,spin=30", "degrees": True}


@BOTH
def test_a_box_in_tilt_precession_and_spin_is_what_a_table_of_such_states_is(kind):
    scene = kind.of(dict(samples=3000, keep="all", **CLOUD))
    table = rows_of(scene)
    for name, low, high in (("tilt", 10, 60), ("tilt_rate", -20, 20), ("precession", -90, 90)):
        assert kstest(np.degrees(table[name]), "uniform", args=(low, high - low)).pvalue > 1e-4
    np.testing.assert_allclose(np.degrees(table["spin"]), 30.0)
    given = {name: np.degrees(table[name]) for name in ("tilt", "tilt_rate", "precession", "spin")}
    again = rows_of(kind.of({"states": given, "degrees": True, "keep": "all"}))
    for name in ("phi", "phidot", "sigma3", "sigma4", "theta_min", "energy"):
        np.testing.assert_allclose(table[name], again[name], rtol=1e-6, atol=1e-12)


@BOTH
def test_a_record_of_a_box_in_degrees_draws_the_same_states_again(kind):
    def steep(tilt, precession, spin):
        return np.where(tilt > np.radians(20), 1.0, 0.0)

    laws = {"box": "tilt=norm:40:5,tilt_rate=-20:20,precession=norm:0:10,spin=30", "degrees": True}
    scene = kind.of(dict(samples=500, keep="all", energy=":1", **laws))
    table, again = rows_of(scene), rows_of(scene_of(json.loads(json.dumps(scene.options))))
    np.testing.assert_array_equal(table["tilt"], again["tilt"])
    assert abs(np.degrees(table["tilt"]).mean() - 40) < 2
    assert table["energy"].max() <= 1
    at_rest = {"box": "tilt=10:60,precession=-90:90,spin=30", "degrees": True, "density": steep}
    assert np.degrees(rows_of(kind.of({"samples": 500, "keep": "all", **at_rest}))["tilt"]).min() > 20


@BOTH
def test_a_law_of_scipy_draws_what_its_text_draws_and_what_the_record_does(kind):
    given = {"tilt": norm(30, 5), "precession": (-90, 90), "spin": 30}
    words = "tilt=norm:30:5,precession=-90:90,spin=30"
    scenes = [kind.of({"samples": 200, "keep": "all", "degrees": True, "box": box}) for box in (given, words)]
    scenes.append(scene_of(json.loads(json.dumps(scenes[0].options))))
    assert scenes[0] == scenes[1] == scenes[2]
    tilts = [rows_of(scene)["tilt"] for scene in scenes]
    np.testing.assert_array_equal(*tilts[:2])
    np.testing.assert_array_equal(*tilts[1:])
    assert kstest(np.degrees(tilts[0]), norm(30, 5).cdf).pvalue > 1e-4


def test_ranges_of_a_box_are_those_that_probability_takes():
    """A range is an even distribution in both; the shares agree within their errors."""
    cloud = {"tilt": (0.3, 1.2), "precession": (-1.0, 1.0), "spin": (-1.0, 1.0)}
    found = rows_of(FallingSet(samples=20_000, keep="all", box=cloud))
    share = np.mean(found["theta_min"] < 0.02)
    asked = ex.probability(ex.Disk.uniform(), ("theta_min", 0.02), samples=100_000, count=2, **cloud)
    assert share > 0.005
    assert abs(share - asked.estimate) < 4 * np.sqrt(share / 20_000) + asked.interval[1] - asked.interval[0]


def test_an_energy_cut_changes_which_states_are_drawn_and_nothing_else():
    """The kept states are the first of the box's own draws that lie below the energy."""
    scene = FallingSet(samples=3000, box="phi=-1:1", energy=":2", keep="all", seed=3)
    drawn = scene.box.draw(numbered_stream(3, 0), 8192)
    energy = ex.constants(ex.phi_to_states(scene.disk, **drawn)).energy
    np.testing.assert_array_equal(rows_of(scene)["phi"][:100], drawn["phi"][energy <= 2.0][:100])
    assert (energy > 2.0).any()


def test_states_bring_their_disk():
    states = ex.phi_to_states(ex.Disk.hoop(), 0.2, 0.3, 0.4, [0.5, 0.6])
    assert RaceAngles.of({"states": states}).disk == ex.Disk.hoop()
    with pytest.raises(ex.InputError, match="made for the disk 'hoop', not for 'uniform'"):
        RaceAngles.of({"states": states, "disk": "uniform"})


def test_a_record_says_that_its_states_were_given_in_python():
    record = json.loads(json.dumps(FallingSet(states=GIVEN).options, default=dict))
    again = scene_of(record)
    assert again.options == record
    with pytest.raises(ex.InputError, match="given in Python; go on with"):
        again.chunk(0)


@BOTH
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"states": GIVEN, "box": "phi=0"}, "cannot be combined with states"),
        ({"states": GIVEN, "samples": 8}, "holds 7"),
        ({"box": {"phi": (-1, 1), "phidot": object()}}, "box phidot .* or a continuous frozen distribution"),
        ({"box": "tilt=20:40,precession=1,spin=1"}, "where it is in degrees, say so"),
        ({"box": "tilt=0.1:0.2,sigma4=1"}, "add precession and spin"),
        ({"energy": ":1e-3"}, "widen it or shrink the box"),
    ],
)
def test_what_does_not_go_together_is_refused(kind, options, message):
    with pytest.raises(ex.InputError, match=message):
        kind.of(options)


def test_rows_of_a_csv_file_that_are_no_states_are_lines_as_an_editor_counts_them(tmp_path):
    path = tmp_path / "states.csv"
    path.write_text("phi,phidot,sigma3,sigma4\n0,1,1,1\n0,1,1,\n0,1,2,3\n")
    run = ex.run("falling-set", states=path)
    assert "for instance, counted from 0: row 1" in run.scene.headline(run.summary)[-1]


@BOTH
def test_a_row_that_is_no_state_is_in_no_statistic_and_counted_apart(kind):
    """Numbers are those of the same table without the row."""
    whole, good = (ex.run(kind.name, states=rows, keep="all") for rows in (ROWS, ROWS.loc[[0, 2]]))
    assert "for instance, counted from 0: row 1" in whole.scene.headline(whole.summary)[-1]
    assert "rows" not in good.scene.headline(good.summary)[-1]
    assert (whole.summary["samples"], whole.summary["valid_states"]) == (3, 2)
    assert whole.summary["status"] == {"bad_input": 1, "ok": 2}
    differing = {key for key in good.summary if whole.summary[key] != good.summary[key]}
    assert differing <= {"samples", "states", "status", "digest"}


@BOTH
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"states": ROWS.loc[[1]]}, "none of 1 samples is a state; give finite numbers"),
        (
            {"samples": 10, "box": "phi=0:1,sigma3=1e200:1e201"},
            "none of 10 samples is a state; give finite numbers, rates below",
        ),
    ],
)
def test_where_no_row_is_a_state_the_run_says_so(kind, options, message):
    with pytest.raises(ex.InputError, match=f"{kind.name}: {message}"):
        ex.run(kind.name, **options)


def test_what_has_no_tilt_says_where_to_ask():
    with pytest.raises(ex.InputError, match="probability takes distributions of other"):
        ex.run("measure-zero", **CLOUD)
    with pytest.raises(ex.InputError, match="degrees: is for start anywhere"):
        RaceAngles.of({"degrees": True})


def test_starts_near_f_lie_in_the_box_and_on_both_faces_alike(body):
    box = box_near_f(body, {})
    start = starts_near_f(box, numbered_stream(1, 0), 4000)
    for values, span in (
        (start["face"] * start["phidot"], box.coordinates["phidot"].ends),
        (start["sigma3_bar"], box.coordinates["sigma3"].ends),
    ):
        assert (values >= span[0]).all()
        assert (values <= span[1]).all()
    assert set(start["face"]) == {-1.0, 1.0}
    assert abs(start["face"].mean()) < 0.1


def test_only_what_is_given_differs_from_the_default_box_near_f():
    disk = BODIES["coin"]
    box = box_near_f(disk, {"sigma3": (0.0, 1.0)})
    assert box.describe() == box_near_f(disk, {}).describe() | {"sigma3": [0.0, 1.0]}
    assert box_near_f(disk, box.describe()) == box


@pytest.mark.parametrize(
    ("ranges", "message"),
    [
        ({"sigma4": (0.0, 0.0)}, "sets sigma4 by eta_hat"),
        ({"phi": (0.0, 1.0)}, "starts at the vertical"),
        ({"phidot": (-1.0, 1.0)}, "speed towards flat"),
    ],
)
def test_a_box_that_describes_no_start_near_f_is_refused(ranges, message):
    with pytest.raises(ex.InputError, match=message):
        box_near_f(BODIES["hoop"], ranges)


@pytest.mark.parametrize("span", [(0.0, 1.0), (1e-2, 1e-3), (1e-3, 11.0), (1e-310, 1e-3)])
def test_distances_that_are_no_longer_near_f_are_refused(span):
    with pytest.raises(ex.InputError, match="eta_hat"):
        eta_hat_span(BODIES["hoop"], span, (1e-6, 1e-2))


def test_a_default_that_is_said_changes_nothing_about_where_motions_start():
    said = ex.run("race-angles", samples=500, bounces=1, start="near").summary
    assert said == ex.run("race-angles", samples=500, box="phidot=0.5:2").summary
    assert (said["start"], said["bounces"]) == ("near", 1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"start": "near", "states": GIVEN}, "states: is for start anywhere"),
        ({"start": "near", "energy": ":3"}, "energy: is for start anywhere"),
        ({"start": "near", "box": {"sigma4": 0.0}}, "box sigma4"),
        ({"start": "anywhere", "eta_hat": "1e-3:1e-2"}, "eta_hat: is for start near"),
        ({"bounces": 2}, "bounces: is for start anywhere"),
    ],
)
def test_what_belongs_to_the_other_start_is_refused(options, message):
    with pytest.raises(ex.InputError, match=message):
        RaceAngles.of(options)


@pytest.mark.parametrize("options", [{"start": "anywhere"}, {"states": GIVEN}, {"energy": ":3"}])
def test_race_angles_are_of_bounces_where_states_may_be_anywhere(options):
    assert RaceAngles.of(options).start == "anywhere"
    with pytest.raises(ex.InputError, match="leave it out, or give start near"):
        RaceAngles.of(dict(**options, eta_hat="1e-3:1e-2"))
    exact, found = (rows_of(RaceAngles.of(dict(**{"samples": 7} | options, method=by))) for by in ("auto", "rk4"))
    np.testing.assert_allclose(found["delta_chi"], exact["delta_chi"], atol=1e-5)

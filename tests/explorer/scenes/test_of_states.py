"""Scenes of states anywhere: where the states come from, and what cannot be combined."""

import numpy as np
import pytest

import explorer as ex
from explorer.scenes.registry import build_scene

GIVEN = {"phi": np.linspace(-1.0, 1.0, 7), "phidot": 0.3, "sigma3": 0.5, "sigma4": 0.2, "energy": "mine"}


@pytest.mark.parametrize("name", ["falling-set", "race-angles"])
def test_both_scenes_take_states_from_one_source(name):
    scene = build_scene(name, states=GIVEN, chunk_size=4, keep="all")
    tables = [scene.process(index)[0] for index in range(scene.chunks())]
    joined = {key: np.concatenate([table[key] for table in tables]) for key in tables[0]}
    np.testing.assert_array_equal(joined["row"], np.arange(7))
    np.testing.assert_array_equal(joined["phi"], GIVEN["phi"])
    assert set(joined["given_energy"]) == {"mine"}
    assert joined["energy"].dtype == float


@pytest.mark.parametrize("name", ["falling-set", "race-angles"])
def test_a_gaussian_and_a_density_draw_the_same_states_in_both_scenes(name):
    def density(phi, phidot, sigma3, sigma4):
        return np.where(sigma4 > 0.0, 1.0, 0.0)

    options = {"box": "phi=-1:1", "gaussian": "sigma3=0.5:0.01", "density": density, "energy": ":3"}
    scene = build_scene(name, samples=2000, keep="all", **options)
    table = scene.compute(0)
    assert abs(table["sigma3"].mean() - 0.5) < 0.001
    assert table["sigma3"].std() == pytest.approx(0.01, rel=0.1)
    assert (table["sigma4"] > 0.0).all()
    assert np.nanmax(table["energy"]) <= 3.0
    other = build_scene("falling-set", samples=2000, keep="all", **options).compute(0)
    np.testing.assert_array_equal(table["phi"], other["phi"])
    assert scene.options()["density"]["function"].endswith("density")


def test_states_bring_their_disk():
    states = ex.phi_to_states(ex.Disk.hoop(), 0.2, 0.3, 0.4, [0.5, 0.6])
    assert build_scene("race-angles", states=states).disk == ex.Disk.hoop()
    with pytest.raises(ex.InputError, match="made for the disk 'hoop', used with 'uniform'"):
        build_scene("race-angles", states=states, disk="uniform")


def test_a_stored_run_says_that_its_states_were_given_in_python():
    record = build_scene("falling-set", states=GIVEN).options()
    again = build_scene("falling-set", **{key: value for key, value in record.items() if key != "scene"})
    assert again.options() == record
    with pytest.raises(ex.InputError, match="given in Python; go on with"):
        again.compute(0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"states": GIVEN, "box": "phi=0"}, "the states come from"),
        ({"states": GIVEN, "gaussian": "phi=0:1"}, "the states come from"),
        ({"states": GIVEN, "samples": 8}, "holds 7"),
        ({"degrees": True}, "says how"),
        ({"states": ex.phi_to_states(ex.Disk.uniform(), 0.1, 0.1, 0.1, 0.1), "degrees": True}, "radians already"),
        ({"gaussian": "phi=0:1"}, "the box fixes it"),
    ],
)
def test_what_does_not_go_together_is_refused(options, message):
    for name in ("falling-set", "race-angles"):
        if name == "race-angles" and "phi" in options.get("gaussian", "") and "states" not in options:
            continue
        with pytest.raises(ex.InputError, match=message):
            build_scene(name, **options)


NAMES = ("phi", "phidot", "sigma3", "sigma4")
ROWS = np.array([[0.1, 1.0, 1.0, 0.5], [np.nan, 1.0, 1.0, 2.0], [0.2, 1.0, 1.0, 1.0]])


@pytest.mark.parametrize("name", ["falling-set", "race-angles"])
def test_a_row_that_is_no_state_is_in_no_statistic_and_counted_apart(name):
    """Numbers are those of the same table without the row."""
    whole = ex.run(name, states=ROWS, keep="all")
    good = ex.run(name, states=ROWS[[0, 2]], keep="all")
    assert (whole.summary["samples"], whole.summary["valid_states"]) == (3, 2)
    assert whole.summary["status"] == {"bad_input": 1, "ok": 2}
    differing = {key for key in good.summary if whole.summary[key] != good.summary[key]}
    assert differing <= {"samples", "states", "status", "failures", "digest"}
    assert {name: whole.summary[name] for name in whole.options} == whole.options


def test_the_share_that_would_fall_is_of_the_states(tmp_path):
    (tmp_path / "states.csv").write_text("\n".join([",".join(NAMES), *(",".join(map(str, row)) for row in ROWS)]))
    run = ex.run("falling-set", states=tmp_path / "states.csv")
    assert run.summary["could_fall_fraction"] == 1.0
    assert "would fall if eta were exactly 0: 100.0 %" in repr(run)
    assert "2 states, 2 computed to the accuracy asked" in repr(run)
    assert "1 row is not a state and is left out" in repr(run)
    assert run.figure("theta-min").axes[0].lines[0].get_ydata()[-1] == 1.0


@pytest.mark.parametrize("name", ["falling-set", "race-angles"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"states": ROWS[[1]]}, "none of the 1 rows of states is a state; give finite numbers"),
        ({"samples": 10, "box": "phi=0:1,sigma3=1e200:1e201"}, "none of 10 draws is a state; in box"),
    ],
)
def test_where_no_row_is_a_state_the_run_says_so(name, options, message):
    with pytest.raises(ex.RunError, match=f"{name}: {message}"):
        ex.run(name, **options)

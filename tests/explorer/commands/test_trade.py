"""The trade of a scene: on the very samples that the scene draws; stored, it decides what an accuracy means."""

import json

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.commands import main as cli
from explorer.commands import trade, trade_report
from explorer.motion import calibration
from explorer.motion.plan import plan
from explorer.motion.work_precision import ASKED
from explorer.scenes.scene import scene_class


@pytest.fixture
def private(private, monkeypatch):
    """A calibration file of the test's own, and only few samples of other bodies."""
    monkeypatch.setattr(trade, "BODIES", (BODIES["uniform"],))
    monkeypatch.setattr(trade, "_OF_EACH_BODY", (64, 2))
    return private


def test_passages_of_a_trade_are_those_of_the_run():
    given = {"disk": "hoop", "samples": 500, "seed": 3, "eta_hat": "1e-7:1e-1", "box": "phidot=0.3:1"}
    samples = trade.scene_for("race-angles", given).reference_samples(1, None)[0]
    run = ex.run("race-angles", keep="all", **given).frame()
    found, _ = samples.call(samples.plan("quadrature", 1e-6))
    assert np.array_equal(found.eta_hat, run["eta_hat"])
    assert np.array_equal(found.face * found.phidot, run["phidot"])
    assert np.array_equal(found.race_angle, run["race_angle"])


@pytest.mark.parametrize("more", [{}, {"theta_min": "near", "keep": "near"}])
def test_tilts_of_a_trade_are_those_of_the_run(more):
    given = {"disk": "hoop", "samples": 2000, "seed": 3, "gaussian": "phidot=1:0.3"} | more
    samples = trade.scene_for("falling-set", given).reference_samples(1, None)[0]
    run = ex.run("falling-set", **{"keep": "all"} | given).frame()
    theta, _, _ = samples.call(samples.plan("quadrature", 1e-6))
    assert theta.size > 0
    assert np.array_equal(theta, run["theta_min"], equal_nan=True)


def test_tilts_of_measure_zero_are_those_of_its_plain_draws():
    scene = scene_class("measure-zero").of({"samples": 3000, "seed": 5, "keep": "all"})
    samples = scene.reference_samples(1, None)[0]
    theta, _, _ = samples.call(samples.plan("quadrature", 1e-6))
    table, _ = scene.chunk(scene.chunks - 1)
    assert np.array_equal(theta, table["theta_min"])


def test_motions_of_a_trade_are_those_of_the_scene():
    scene = scene_class("one-sided").of({"disk": ["uniform", "hoop"], "samples": 2, "eta_hat": "1e-4:1e-2"})
    samples = scene.reference_samples(24, None)[-1]
    found = samples.call(samples.plan("dop853", scene.accuracy))
    tables = [scene.chunk(index)[0] for index in range(scene.chunks)]
    for table, both in zip(tables, (found[:2], found[2:]), strict=True):
        assert np.array_equal(table["status"], np.concatenate([motion.status for motion in both]))
        sigma3_bar = np.concatenate([ex.constants(motion.states).sigma3_bar for motion in both])
        assert sigma3_bar == pytest.approx(table["sigma3_bar"])
        middle = [motion.chi[row] for motion in both for row in range(len(motion))]
        assert all(chi in line for chi, line in zip(table["chi_between"], middle, strict=True))


@pytest.mark.parametrize(("count", "starts"), [(1, 1), (23, 1), (24, 2), (1000, 20)])
def test_so_many_motions_of_a_trade_go_to_all_bodies(count, starts):
    """Six motions beside each start, and two bodies: as many starts of both as the number allows."""
    scene = scene_class("one-sided").of({"disk": ["uniform", "hoop"], "samples": 20, "eta_hat": "1e-4:1e-2"})
    groups = scene.reference_samples(count, None)[0].groups
    names = [states.disk.name for states, _ in groups]
    assert names == ["uniform"] * starts + ["hoop"] * starts
    assert {len(states) for states, _ in groups} == {6}


def test_states_of_the_user_are_measured(tmp_path):
    rng = np.random.default_rng(1)
    states = ex.phi_to_states(BODIES["hoop"], *rng.uniform(-1, 1, (4, 700)))
    scene = trade.scene_for("falling-set", {"states": states})
    assert scene.samples == 700
    assert np.array_equal(scene.reference_samples(1, None)[0].blocks[0].natural, states.natural)
    assert np.array_equal(scene.reference_samples(5, None)[1].groups[0][0].natural, states.natural[:, :5])


def test_without_a_scene_passages_at_all_distances_are_measured():
    scene = trade.scene_for(None, {"disk": "uniform:m=5.67e-3,r=12.1e-3,g=9.81"})
    assert (scene.name, scene.samples) == ("race-angles", 4096)
    assert scene.eta_hat == pytest.approx((1e-8 * scene.disk.rate_unit, scene.disk.rate_unit))
    assert trade.scene_for(None, {"eta_hat": "1e-3:1e-2"}).eta_hat == (1e-3, 1e-2)


def test_a_stored_trade_decides_what_an_accuracy_means(private, traded):
    before = {kind: plan((kind,), 1e-6, "rk8").control for kind in ("race_angle", "chi")}
    start = {"sigma3_bar": 1.0, "eta_hat": [1e-3, -1e-6], "phidot": 1.0}
    found = ex.passages(BODIES["hoop"], **start, method="rk8")
    table = trade.calibrate(traded)
    # a machine on which every setting errs a thousand times more
    for rows in table["methods"].values():
        rows[:] = [entry and (1e3 * entry[0], entry[1]) for entry in rows]
    assert calibration.store(table) == private
    assert "this machine" in plan(("chi",), 1e-6).reason
    assert plan(("race_angle",), 1e-6, "rk8").control < 0.6 * before["race_angle"]
    finer = ex.passages(BODIES["hoop"], **start, method="rk8")
    assert (found.race_angle != finer.race_angle).all()
    assert np.allclose(found.race_angle, finer.race_angle, rtol=0.0, atol=1e-6)


def test_a_stored_trade_decides_which_method_is_chosen(private, traded):
    table = trade.calibrate(traded)
    rows = table["methods"]["dop853"]
    # a machine on which order eight is absurdly dear, and one on which it is cheap
    rows[:] = [entry and (entry[0], 1e6 * entry[1]) for entry in rows]
    calibration.store(table)
    assert plan(("chi",), 1e-9).method == "dopri5"
    rows[:] = [entry and (entry[0], 1e-9 * entry[1]) for entry in rows]
    calibration.store(table)
    assert plan(("chi",), 1e-3).method == "dop853"


def test_a_calibration_says_what_it_was_measured_on(private, traded):
    traded.store()
    stored = json.loads(private.read_text())
    assert stored["measured_on"]["scene"] == "race-angles"


def test_samples_on_which_errors_do_not_fall_calibrate_nothing(private, traded):
    from dataclasses import replace

    passages, motions = traded.parts
    stuck = replace(passages, rows=[replace(row, p99=0.1) for row in passages.rows])
    with pytest.raises(ex.InputError, match="cannot calibrate"):
        replace(traded, parts=[stuck, motions]).store()
    assert not private.exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--samples", "3"], "3 of 3 passages have a known answer, and 256 are needed"),
        (["measure-zero", "--samples", "1000"], "tilts have a known answer, and 256 are needed"),
        (["portrait"], "portrait: no method is chosen in this scene"),
        (["one-sided", "--motions", "0"], "leave motions = 0 out"),
        (["race-angles", "--method", "rk4"], "method = rk4: trade measures all of them"),
        (["race-angles", "--grid", "3"], "unrecognized arguments: --grid 3"),
    ],
)
def test_bad_arguments_are_named_before_anything_is_measured(private, arguments, message, capsys, tmp_path):
    out = tmp_path / "t"
    assert cli.main(["trade", *arguments, "--no-store", "--out", str(out), "--quiet"]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_that_cannot_be_written_is_named(private, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert cli.main(["trade", "--samples", "300", "--no-store", "--out", str(tmp_path / "file")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_too_few_states_are_refused_by_their_number():
    states = ex.phi_to_states(BODIES["hoop"], *np.full((4, 3), 0.5))
    with pytest.raises(ex.InputError, match="3 of 3 tilts have a known answer"):
        ex.trade("falling-set", states=states)


@pytest.mark.rendered
def test_the_command_prints_writes_and_stores(private, tmp_path, capsys):
    out = tmp_path / "out"
    common = ["trade", "race-angles", "--samples", "300", "--motions", "64", "--out", str(out), "--quiet"]
    assert cli.main([*common, "--disk", "hoop", "--json"]) == 0
    assert private.exists()
    printed = json.loads(capsys.readouterr().out)
    assert printed["scene"]["disks"][0]["name"] == "hoop"
    assert [part["kind"] for part in printed["parts"]] == ["passages", "motions"]
    assert len(printed["parts"][0]["asked"]) == 5 * len(ASKED)
    assert (out / "trade.png").stat().st_size > 10_000
    assert "Stored for this machine" in (out / "README.md").read_text("utf-8")


def test_the_page_says_what_was_measured_and_by_which_command(traded, tmp_path):
    trade_report.write(traded.scene, traded.parts, tmp_path, "nearflat trade race-angles", None)
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "Made by `nearflat trade race-angles`" in page
    assert page.count("\n## ") == 2
    assert "Stored for this machine" not in page
    assert (tmp_path / "trade.png").exists()
    assert str(traded) in page
    assert repr(traded) == "Trade of race-angles, hoop: 300 passages, 64 motions; print it for its tables"

"""The trade of a scene is measured on the very samples that the scene draws."""

import json

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.commands import main as cli
from explorer.commands import trade, trade_report
from explorer.motion.work_precision import ASKED
from explorer.scenes.scene import scene_class


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
def test_bad_arguments_are_named_before_anything_is_measured(arguments, message, capsys, tmp_path):
    out = tmp_path / "t"
    assert cli.main(["trade", *arguments, "--out", str(out), "--quiet"]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


def test_a_folder_that_cannot_be_written_is_named(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert cli.main(["trade", "--samples", "300", "--out", str(tmp_path / "file")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_too_few_states_are_refused_by_their_number():
    states = ex.phi_to_states(BODIES["hoop"], *np.full((4, 3), 0.5))
    with pytest.raises(ex.InputError, match="3 of 3 tilts have a known answer"):
        ex.trade("falling-set", states=states)


@pytest.mark.rendered
def test_the_command_prints_and_writes(tmp_path, capsys):
    out = tmp_path / "out"
    common = ["trade", "race-angles", "--samples", "300", "--motions", "64", "--out", str(out), "--quiet"]
    assert cli.main([*common, "--disk", "hoop", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["scene"]["disks"][0]["name"] == "hoop"
    assert [part["kind"] for part in printed["parts"]] == ["passages", "motions"]
    assert len(printed["parts"][0]["rows"]) == 5 * len(ASKED) + 1
    assert (out / "trade.png").stat().st_size > 10_000


def test_the_page_says_what_was_measured_and_by_which_command(traded, tmp_path):
    trade_report.write(traded.scene, traded.parts, tmp_path, "nearflat trade race-angles")
    page = (tmp_path / "README.md").read_text("utf-8")
    assert "Made by `nearflat trade race-angles`" in page
    assert page.count("\n## ") == 2
    assert (tmp_path / "trade.png").exists()
    assert str(traded) in page
    assert repr(traded) == "Trade of race-angles, hoop: 300 passages, 64 motions; print it for its tables"

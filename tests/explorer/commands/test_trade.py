"""The trade: on the very samples that race-angles draws; stored, it decides what an accuracy means."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.commands import main as cli
from explorer.commands import trade
from explorer.motion import calibration
from explorer.motion.plan import plan
from explorer.motion.work_precision import ASKED


def test_passages_of_a_trade_are_those_of_the_run():
    given = {"disk": "hoop", "samples": 500, "seed": 3, "eta_hat": "1e-7:1e-1", "box": "phidot=0.3:1"}
    samples, motions = trade.Trading(motions=5, **given).reference_samples()
    run = ex.run("race-angles", keep="all", **given).frame()
    found, _ = samples.call(samples.plan("quadrature", 1e-6))
    assert np.array_equal(found.eta_hat, run["eta_hat"])
    assert np.array_equal(found.face * found.phidot, run["phidot"])
    assert np.array_equal(found.race_angle, run["race_angle"])
    ((states, _),) = motions.groups
    np.testing.assert_allclose(ex.constants(states).sigma3_bar, run["sigma3_bar"][:5], rtol=1e-12)


def test_passages_at_all_distances_are_measured_unless_it_is_said():
    asked = trade.Trading.of({"disk": "uniform:m=5.67e-3,r=12.1e-3,g=9.81"})
    assert asked.scene.samples == 4096
    assert asked.scene.eta_hat == pytest.approx((1e-8 * asked.disk.rate_unit, asked.disk.rate_unit))
    assert trade.Trading.of({"eta_hat": "1e-3:1e-2"}).scene.eta_hat == (1e-3, 1e-2)


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
    passages, motions = traded.parts
    stuck = replace(passages, rows=[replace(row, p99=0.1) for row in passages.rows])
    with pytest.raises(ex.InputError, match="cannot calibrate"):
        replace(traded, parts=[stuck, motions]).store()
    assert not private.exists()


def test_errors_that_are_stored_hold_for_other_bodies_too(private, traded):
    """Costs are those of this machine; an error is never below the one that comes with nearflat."""
    traded.store()
    shipped, own = calibration.shipped_errors(), json.loads(private.read_text())
    for method, rows in own["methods"].items():
        for setting, row in zip(own["settings"][method], rows, strict=True):
            assert row is None or row[0] >= shipped.get((method, setting), 0.0)
    measured = {(row.method, row.setting): row.nanoseconds for row in traded.parts[0].rows}
    assert own["methods"]["rk8"][3][1] == measured["rk8", 0.5]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--samples", "3"], "samples = 3 must be a whole number, 256 or more"),
        (["--method", "rk4"], "unrecognized arguments: --method rk4"),
    ],
)
def test_bad_arguments_are_named(private, arguments, message, capsys, tmp_path):
    assert cli.main(["trade", *arguments, "--no-store", "--out", str(tmp_path), "--quiet"]) == 2
    assert message in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]


def test_a_folder_that_cannot_be_written_is_named(private, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert cli.main(["trade", "--samples", "300", "--no-store", "--out", str(tmp_path / "file")]) == 2
    assert "cannot be written" in capsys.readouterr().err


@pytest.mark.rendered
def test_the_command_prints_writes_and_stores(private, traded, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(trade, "measured", lambda asked: traded)
    out = tmp_path / "out"
    assert cli.main(["trade", "--disk", "hoop", "--out", str(out), "--quiet", "--json"]) == 0
    assert private.exists()
    printed = json.loads(capsys.readouterr().out)
    assert printed["scene"]["disks"][0]["name"] == "hoop"
    assert [part["kind"] for part in printed["parts"]] == ["passages", "motions"]
    assert len(printed["parts"][0]["asked"]) == 5 * len(ASKED)
    assert (out / "trade.png").stat().st_size > 10_000
    page = (out / "README.md").read_text("utf-8")
    assert page.startswith(
        f"# Speed against accuracy, hoop disk\n\nMade by `nearflat trade --disk hoop --out {out}"
    )
    assert page.count("\n## ") == 3
    for text in str(traded).split("\n\n"):
        assert text in page
    assert repr(traded) == "Trade of race-angles, hoop: 300 passages, 64 motions; print it for its tables"

"""The trade is measured on the very samples that race-angles draws."""

import json

import numpy as np
import pytest

import explorer as ex
from explorer.commands import main as cli
from explorer.commands import trade
from explorer.motion.work_precision import ASKED


def test_passages_of_a_trade_are_those_of_the_run():
    given = {"disk": "hoop", "samples": 500, "seed": 3, "eta_hat": "1e-7:1e-1", "box": "phidot=0.3:1"}
    states, exact = trade.TradeOptions(**given).drawn()
    run = ex.run("race-angles", keep="all", **given).frame()
    assert exact.ok.all()
    np.testing.assert_allclose(exact.race_angle, run["race_angle"], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(ex.constants(states).sigma3_bar, run["sigma3_bar"], rtol=1e-12)


def test_passages_of_which_none_is_known_are_refused():
    with pytest.raises(ex.InputError, match="box: none of these passages is known; give phidot above 0"):
        ex.trade(samples=256, box="phidot=0,sigma3=0", progress=False)


def test_the_seed_of_a_trade_may_be_any_that_a_run_takes():
    asked = [trade.TradeOptions.of({"rng": rng}).seed for rng in (5, np.random.SeedSequence(5))]
    assert asked == [trade.TradeOptions.of({"seed": 5}).seed] * 2


def test_passages_at_all_distances_are_measured_unless_it_is_said():
    asked = trade.TradeOptions.of({"disk": "uniform:m=5.67e-3,r=12.1e-3,g=9.81"})
    assert asked.scene.samples == 4096
    assert asked.scene.eta_hat == pytest.approx((1e-8 * asked.disk.rate_unit, asked.disk.rate_unit))
    assert trade.TradeOptions.of({"eta_hat": "1e-3:1e-2"}).scene.eta_hat == (1e-3, 1e-2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--samples", "3"], "samples = 3 must be a whole number, 256 or more"),
        (["--method", "rk4"], "unrecognized arguments: --method rk4"),
    ],
)
def test_bad_arguments_are_named(arguments, message, capsys, tmp_path):
    assert cli.main(["trade", *arguments, "--out", str(tmp_path), "--quiet"]) == 2
    assert message in capsys.readouterr().err
    assert not [*tmp_path.iterdir()]


def test_a_file_that_stands_where_the_folder_should_be_is_named(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert cli.main(["trade", "--samples", "300", "--out", str(tmp_path / "file")]) == 2
    assert "give another name" in capsys.readouterr().err


@pytest.mark.rendered
def test_the_command_prints_and_writes(traded, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(trade, "measured", lambda asked: traded)
    out = tmp_path / "out"
    assert cli.main(["trade", "--disk", "hoop", "--out", str(out), "--quiet", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["scene"]["disks"][0]["name"] == "hoop"
    assert printed["known"] == 300
    assert len(printed["rows"]) == 5 * len(ASKED)
    assert (out / "trade.png").stat().st_size > 10_000
    page = (out / "README.md").read_text("utf-8")
    assert page.startswith(
        f"# Speed against accuracy, hoop disk\n\nMade by `nearflat trade --disk hoop --out {out}"
    )
    assert page.count("\n## ") == 2
    assert str(traded) in page
    assert repr(traded) == "Trade of hoop: 300 passages; print it for its table"

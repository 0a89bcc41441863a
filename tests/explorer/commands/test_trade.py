"""The measured trade of speed for accuracy, and what is chosen from it."""

import json

import numpy as np
import pytest
from conftest import BODIES

from explorer.commands import main as cli
from explorer.commands import trade
from explorer.motion import calibration
from explorer.motion.plan import plan
from explorer.plot import work_precision


@pytest.fixture
def private(tmp_path, monkeypatch):
    """A calibration file of the test's own, which does not exist yet."""
    path = tmp_path / "calibration.json"
    monkeypatch.setenv("NEARFLAT_CALIBRATION", str(path))
    calibration.current.cache_clear()
    yield path
    calibration.current.cache_clear()


@pytest.fixture
def rows(traded):
    return traded


def test_every_method_is_measured_over_many_decades(rows):
    for method in trade.SETTINGS:
        errors = [row.p99 for row in rows if row.method == method]
        assert min(errors) < 1e-9 < 1e-5 < max(errors)


def test_finer_settings_cost_more_evaluations_and_err_less(rows):
    for method in trade.SETTINGS:
        chosen = [row for row in rows if row.method == method]
        evaluations = [row.evaluations for row in chosen]
        assert evaluations == sorted(evaluations)
        errors = np.array([row.p99 for row in chosen])
        coarse = errors > 1e-12
        assert (np.diff(np.log(errors[coarse])) < 0.05).all()


def test_field_evaluations_are_exactly_reproducible(rows):
    again = trade.trade(BODIES["hoop"], 1024)
    assert [row.evaluations for row in again] == [row.evaluations for row in rows]
    assert [row.p99 for row in again] == [row.p99 for row in rows]


def test_the_front_holds_what_nothing_beats():
    def row(method, p99, nanoseconds):
        return trade.Row(method, 1.0, p99, p99, 1.0, nanoseconds, 0.0)

    rows = [
        row("rk4", 1e-3, 100.0),
        row("rk8", 1e-6, 200.0),
        row("rk8", 1e-4, 250.0),
        row("quadrature", 1e-9, 1.0),
    ]
    assert [found.on_front for found in trade.mark_front(rows)] == [True, True, False, False]


def test_a_stored_table_is_read_back_and_decides(private, rows):
    table = trade.calibrate(rows, samples=64)
    assert calibration.store(table) == private
    assert "this machine" in plan(("chi",), 1e-6).reason
    # a machine on which order eight is absurdly dear
    for entry in table["methods"]["dop853"]:
        entry[3] *= 1e6
    calibration.store(table)
    assert plan(("chi",), 1e-9).method == "dopri5"
    for entry in table["methods"]["dop853"]:
        entry[3] /= 1e9
    calibration.store(table)
    assert plan(("chi",), 1e-3).method == "dop853"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--seed", "-1"], "--seed -1"),
        (["--disk", "m=1,r=1,g=1,I1=0.5,I3=1e-9"], "--disk"),
        (["--samples", "x"], "--samples"),
    ],
)
def test_bad_arguments_are_named_before_anything_is_measured(private, arguments, message, capsys, tmp_path):
    assert cli.main(["trade", "--no-store", "--out", str(tmp_path / "t"), "--quiet", *arguments]) == 2
    assert message in capsys.readouterr().err
    (tmp_path / "file").write_text("")
    assert cli.main(["trade", "--no-store", "--out", str(tmp_path / "file")]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_the_picture_shows_every_method_and_the_front(rows):
    ax = work_precision(rows)
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["best integrators", "quadrature", *trade.SETTINGS]
    drawn = {line.get_label(): line.get_xydata() for line in ax.get_lines()}
    rk8 = [(row.p99, row.nanoseconds) for row in rows if row.method == "rk8"]
    assert np.array_equal(drawn["rk8"], rk8)


@pytest.mark.rendered
def test_the_command_prints_writes_and_stores(private, tmp_path, capsys):
    out = tmp_path / "out"
    common = ["trade", "--samples", "1024", "--out", str(out), "--quiet"]
    assert cli.main([*common, "--disk", "hoop", "--no-store"]) == 0
    assert not private.exists()
    assert "| rk8 |" in capsys.readouterr().out
    assert (out / "trade.png").stat().st_size > 10_000
    assert "Pareto" in (out / "README.md").read_text()
    assert cli.main([*common, "--json"]) == 0
    assert private.exists()
    assert json.loads(capsys.readouterr().out)["disk"]["name"] == "uniform"


def test_too_few_samples_are_refused(capsys):
    assert cli.main(["trade", "--samples", "3"]) == 2
    assert "--samples 3" in capsys.readouterr().err

"""The measured trade of speed for accuracy, and what is chosen from it."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer import compiled
from explorer.commands import main as cli
from explorer.commands import trade
from explorer.motion import calibration
from explorer.motion.plan import plan
from explorer.motion.turning_points import turning_points
from explorer.phase.constants import natural_constants
from explorer.phase.states import constants_to_states
from explorer.plot import work_precision


@pytest.fixture
def private(tmp_path, monkeypatch):
    """A calibration file of the test's own, which does not exist yet."""
    path = tmp_path / "calibration.json"
    monkeypatch.setenv("NEARFLAT_CALIBRATION", str(path))
    calibration.current.cache_clear()
    yield path
    calibration.current.cache_clear()


@pytest.fixture(scope="module")
def rows():
    return trade.trade(BODIES["hoop"], 1024)


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


def test_the_shipped_table_is_used_and_named_where_nothing_was_measured(private):
    assert "shipped" in calibration.current().origin
    assert "shipped" in plan(("chi",), 1e-6).reason
    assert "shipped" in plan(("chi",), 1e-6).cost


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


def shipped():
    table = json.loads((Path(calibration.__file__).parent / "calibration.json").read_text())
    return {**table, "kernels": compiled.source_digest()}


@pytest.mark.parametrize(
    "spoil",
    [
        lambda table: {},
        lambda table: [1],
        lambda table: {**table, "methods": {"rk4": table["methods"]["rk4"]}},
        lambda table: {**table, "methods": []},
        lambda table: {**table, "quadrature": float("nan")},
        lambda table: {**table, "methods": {k: [[1, 2, 3]] for k in table["methods"]}},
        lambda table: {**table, "methods": {k: rows[:1] for k, rows in table["methods"].items()}},
        lambda table: {**table, "methods": {k: rows[::-1] for k, rows in table["methods"].items()}},
        lambda table: {**table, "methods": {k: [rows[0]] * 5 for k, rows in table["methods"].items()}},
    ],
)
def test_a_damaged_table_is_named_not_used(private, spoil):
    private.write_text(json.dumps(spoil(shipped())))
    with pytest.raises(ex.InputError, match="calibration"):
        plan(("chi",), 1e-6)


def test_a_table_of_other_kernels_is_not_used(private):
    private.write_text(json.dumps({**shipped(), "kernels": "0" * 64}))
    assert "measured with other kernels" in plan(("chi",), 1e-6).reason


def test_settings_are_monotone_in_the_accuracy(private):
    targets = 10.0 ** -np.arange(1.0, 12.0)
    for curve in calibration.current().curves.values():
        settings = curve.at(targets)
        assert (np.diff(settings) <= 0).all()
        assert (settings > 0).all()
        costs = [curve.cost(t)[1] for t in targets]
        assert (np.diff(costs) >= 0).all()


@pytest.mark.parametrize("exponent", range(2, 12))
@pytest.mark.parametrize("method", ["quadrature", "rk8", "dop853", "dopri5", "rk4"])
def test_the_accuracy_asked_is_met_by_work_nobody_calibrated_on(private, method, exponent):
    """99th percentile over random bodies and boxes, |eta_hat| from 1e-4, of angles, times and tilts."""
    if method == "rk4" and exponent > 8:
        pytest.skip("thousands of steps of order four per passage; order eight is there for that")
    accuracy = 10.0**-exponent
    rng = np.random.default_rng(exponent)
    for _ in range(3):
        I1 = 10.0 ** rng.uniform(-1.5, 0.5)
        disk = ex.Disk(I1=I1, I3=I1 * rng.uniform(0.4, 2.0))
        n, box = 400, rng.uniform(0.5, 3.0)
        eta_hat = 10 ** rng.uniform(-4, -1, n) * rng.choice([-1, 1], n)
        start = rng.uniform(-box, box, n), eta_hat, rng.uniform(0.3, 3.0, n)
        exact = ex.passages(disk, *start, accuracy=1e-11)
        if method == "quadrature":
            got = ex.passages(disk, *start, accuracy=accuracy)
            errors = (got.delta_chi - exact.delta_chi, got.delta_psi - exact.delta_psi)
            ratios = (got.duration / exact.duration, got.theta_min / exact.theta_min)
            status, known = got.status, True
        else:
            states = constants_to_states(disk, *start)
            constants = natural_constants(states)
            found = turning_points(states, plan(("chi", "psi", "theta_min"), accuracy, method), constants)
            # A state in doubles knows eta, and with it theta_min, only so well.
            known = constants.rounding_plus / abs(constants.eta_plus) < 0.02 * accuracy
            errors = (2 * found.chi - exact.delta_chi, 2 * found.psi - exact.delta_psi)
            ratios = (2 * found.time / exact.duration, found.theta / exact.theta_min)
            status = found.status
        ok = (status == 0) & (exact.status == 0)
        assert ok.mean() > 0.97
        for error in (*errors, ratios[0] - 1):
            assert np.percentile(abs(error[ok]), 99) <= accuracy
        tilt = abs(ratios[1] - 1)[ok & known]
        assert tilt.size == 0 or np.percentile(tilt, 99) <= accuracy


@pytest.mark.parametrize("exponent", range(2, 11))
@pytest.mark.parametrize("method", ["auto", "rk8", "dopri5"])
def test_motions_in_time_meet_the_accuracy_too(private, method, exponent):
    """A whole passage followed in time, against quadrature."""
    rng = np.random.default_rng(100 + exponent)
    errors = []
    for disk in (ex.Disk.uniform(), ex.Disk(I1=0.3, I3=0.25)):
        start = (
            rng.uniform(-2, 2, 60),
            rng.choice([-1, 1], 60) * 10 ** rng.uniform(-3, -1, 60),
            rng.uniform(0.5, 2, 60),
        )
        exact = ex.passages(disk, *start, accuracy=1e-11)
        for i in np.flatnonzero(exact.status == 0):
            state = constants_to_states(disk, *(column[i : i + 1] for column in start))
            got = ex.simulate(
                disk,
                state,
                t_eval=exact.duration[i : i + 1],
                observables=("chi", "psi"),
                method=method,
                accuracy=10.0**-exponent,
            )
            errors += [abs(got.chi[0, 0] - exact.delta_chi[i]), abs(got.psi[0, 0] - exact.delta_psi[i])]
    assert np.percentile(errors, 99) <= 10.0**-exponent


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
    assert labels == ["front of the integrators", "quadrature", *trade.SETTINGS]
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

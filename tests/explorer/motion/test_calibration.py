"""The table of costs and errors: which is used, and that settings taken from it meet the accuracy."""

import json
from pathlib import Path

import numpy as np
import pytest

import explorer as ex
from explorer import compiled
from explorer.motion import calibration
from explorer.motion.plan import plan
from explorer.motion.turning_points import turning_points
from explorer.phase.states import constants_to_states


def shipped():
    table = json.loads((Path(calibration.__file__).parent / "calibration.json").read_text())
    return {**table, "kernels": compiled.source_digest()}


def test_the_shipped_errors_are_those_of_the_shipped_table():
    errors = calibration.shipped_errors()
    assert {method for method, _ in errors} == set(calibration.SETTINGS)
    assert errors["rk8", 0.5] == shipped()["methods"]["rk8"][3][0]


def test_the_shipped_table_is_used_and_named_where_nothing_was_measured(private):
    assert "shipped" in calibration.current().origin
    assert "shipped" in plan(("chi",), 1e-6).reason
    assert "shipped" in plan(("chi",), 1e-6).cost


@pytest.mark.parametrize(
    "spoil",
    [
        lambda table: {},
        lambda table: [1],
        lambda table: {**table, "methods": {"rk4": table["methods"]["rk4"]}},
        lambda table: {**table, "methods": []},
        lambda table: {name: value for name, value in table.items() if name != "kernels"},
        lambda table: {**table, "methods": dict.fromkeys(table["methods"], "rows")},
        lambda table: {**table, "quadrature": float("nan")},
        lambda table: {**table, "methods": {k: [[1, 2, 3]] * len(rows) for k, rows in table["methods"].items()}},
        lambda table: {**table, "settings": {"rk4": calibration.SETTINGS["rk4"]}},
        lambda table: {**table, "methods": {k: rows[:1] for k, rows in table["methods"].items()}},
        lambda table: {**table, "methods": {k: rows[::-1] for k, rows in table["methods"].items()}},
        lambda table: {**table, "methods": {k: [rows[0]] * len(rows) for k, rows in table["methods"].items()}},
    ],
)
def test_a_damaged_table_is_named_not_used(private, spoil):
    private.write_text(json.dumps(spoil(shipped())))
    check_that_it_is_named(private)


def check_that_it_is_named(path):
    """By one sentence with a remedy, in which nothing of Python's is read."""
    with pytest.raises(ex.InputError, match="cannot be used") as told:
        plan(("chi",), 1e-6)
    assert f"calibration {path}" in str(told.value)
    assert str(told.value).endswith("; delete it, then nearflat trade")
    for words in ("Error", "sys.", "NoneType", "indices"):
        assert words not in str(told.value)


@pytest.mark.parametrize("text", ["", "{", "[1]"])
def test_text_that_is_no_table_is_named_not_used(private, text):
    private.write_text(text)
    check_that_it_is_named(private)


def test_a_table_may_be_a_link_to_another_file(private, tmp_path):
    (tmp_path / "elsewhere.json").write_text(json.dumps(shipped()))
    private.symlink_to(tmp_path / "elsewhere.json")
    assert "measured on this machine" in calibration.current().origin


@pytest.mark.parametrize(
    ("system", "place"),
    [
        ("linux", ".local/share/nearflat"),
        ("darwin", "Library/Application Support/nearflat"),
        ("win32", "AppData/Local/nearflat"),
    ],
)
def test_a_machine_keeps_its_table_where_its_system_keeps_data(system, place, tmp_path, monkeypatch):
    for name in ("NEARFLAT_CALIBRATION", "XDG_DATA_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(calibration.sys, "platform", system)
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    assert calibration.stored_at().parent == tmp_path / place
    if system == "linux":
        monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
        assert calibration.stored_at().parent == tmp_path / "data" / "nearflat"


def test_a_table_of_other_kernels_is_not_used(private):
    private.write_text(json.dumps({**shipped(), "kernels": "0" * 64}))
    assert "measured with other kernels" in plan(("chi",), 1e-6).reason


def test_settings_are_monotone_in_the_accuracy(private):
    targets = 10.0 ** -np.arange(1.0, 12.0)
    for curve in calibration.current().curves.values():
        settings = curve.at(targets)
        assert (np.diff(settings) <= 0).all()
        assert (settings > 0).all()
        assert curve.cost(1e-11) > 2.0 * curve.cost(1e-1)


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
            constants = states.motion
            found = turning_points(states, plan(("chi", "psi", "theta_min"), accuracy, method))
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

"""`nearflat passage`: one passage, as text and as JSON."""

import json

import numpy as np
import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.commands.passage import PassageOptions, passage_report

UNIFORM = ex.Disk.uniform()
WORDS = ["passage", "--sigma3-bar", "1", "--phidot", "1", "--eta-hat"]


def test_the_report_has_the_numbers_of_the_public_function():
    report = passage_report(PassageOptions(sigma3_bar=0.3, eta_hat=-1e-6, phidot=0.8, face=-1))
    made = ex.passages(UNIFORM, 0.3, -1e-6, 0.8, -1)
    assert report["status"] == "ok"
    assert report["face"] == -1
    for name in ("race_angle", "delta_chi", "theta_min", "duration", "energy", "impact_speed"):
        assert report[name] == getattr(made, name)
    assert report["fall_time"] is None or np.isfinite(report["fall_time"])


def test_a_fall_has_both_limits_as_text_too(capsys):
    assert main([*WORDS, "0"]) == 0
    assert "limit, eta > 0     race_angle +7.0" in capsys.readouterr().out


def test_the_report_of_a_fall_has_its_published_time_and_no_passage():
    hoop = ex.Disk.hoop()
    report = passage_report(PassageOptions(disk=hoop, sigma3_bar=0.0, eta_hat=0.0, phidot=1.0))
    assert report["status"] == "falls"
    assert report["fall_time"] == pytest.approx(1.325324, abs=5e-7)
    assert report["duration"] is None
    limits = report["limits"]
    assert limits["plus"]["race_angle"] == -limits["minus"]["race_angle"] == hoop.race_limit
    assert json.loads(json.dumps(report)) == report


@pytest.mark.parametrize(("disk", "least"), [(UNIFORM, -0.97), (ex.Disk.hoop(), -0.89)])
def test_the_report_says_when_a_real_disk_would_lift_off(disk, least):
    """Section 8: the normal force of the paper's own scenes, in m g."""
    report = passage_report(PassageOptions(disk=disk, sigma3_bar=1.0, eta_hat=0.01, phidot=1.0))
    assert report["min_normal_force"] == pytest.approx(least, abs=0.01)
    assert "lift off" in report["warnings"][0]


@pytest.mark.parametrize("value", ["-1e-3", "-.5e-3", "-1", "1e-200"])
def test_a_number_below_zero_needs_no_equals_sign(value, capsys):
    main([*WORDS, value, "--json", "--quiet"])
    report = json.loads(capsys.readouterr().out)
    assert report["race_angle"] is None or np.sign(report["race_angle"]) == np.sign(float(value))


def test_bad_numbers_are_named(capsys):
    assert main([*WORDS, "far"]) == 2
    assert "eta_hat = far is not a number" in capsys.readouterr().err


def test_what_is_needed_is_asked_for(capsys):
    assert main(["passage", "--sigma3-bar", "1"]) == 2
    assert "eta_hat: is needed; distance" in capsys.readouterr().err

"""Columns of a table that say where a disk is."""

import numpy as np
import pytest

import explorer as ex
from explorer.phase.columns import COLUMNS
from explorer.phase.coordinates import CHARTS, recognise

DISK = ex.Disk.hoop()
STATES = ex.phi_to_states(DISK, [0.3, 0.7, 1.1], [0.2, 0.4, 0.1], [0.5, -0.3, 0.2], [0.1, 0.6, -0.2])


def columns_of(chart):
    """The same three states as columns of a chart."""
    known = ex.constants(STATES)
    values = {
        "theta": 0.5 * np.pi - STATES.phi,
        "thetadot": -STATES.phidot,
        "tilt": 0.5 * np.pi - STATES.phi,
        "tilt_rate": -STATES.phidot,
        "precession": STATES.sigma3 / np.cos(STATES.phi) ** 2,
        "spin": STATES.sigma4,
        "eta_hat": known.eta_hat_plus,
        "face": np.ones(3),
    }
    for name in ("phi", "phidot", "sigma3", "sigma4"):
        values[name] = getattr(STATES, name)
    for name in ("sigma3_bar", "sigma4_bar", "energy"):
        values[name] = getattr(known, name)
    return {name: values[name] for name in (*chart.needed, *chart.optional)}


@pytest.mark.parametrize("chart", CHARTS, ids=lambda chart: "-".join(chart.needed))
def test_every_chart_gives_the_same_states(chart):
    columns = columns_of(chart)
    assert recognise([*columns, "note"]).needed == chart.needed
    np.testing.assert_allclose(chart.states(DISK, columns).natural, STATES.natural, rtol=1e-11, atol=1e-13)
    assert set(columns) <= set(COLUMNS)


def test_an_energy_is_never_in_degrees():
    chart = recognise(["energy", "sigma3_bar", "eta_hat"])
    columns = {"energy": np.array([3.0]), "sigma3_bar": np.degrees([0.5]), "eta_hat": np.degrees([1e-3])}
    states = chart.states(DISK, columns, degrees=True)
    direct = ex.coordinates_to_states(DISK, energy=3.0, sigma3_bar=0.5, eta_hat=1e-3)
    np.testing.assert_allclose(states.natural, direct.natural, rtol=1e-14)


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["phi", "phidot", "sigma3"], "do not determine a state; add sigma4"),
        (["Tilt", "precession", "spin"], "add tilt"),
        (["a", "b"], "states: a, b: they do not determine a state"),
        ([], "states: none were given; give one of these sets"),
    ],
)
def test_columns_that_say_no_state_are_refused_with_what_is_missing(names, message):
    with pytest.raises(ex.InputError, match=message):
        recognise(names)


@pytest.mark.parametrize("column", ["tiltrate", "Tilt_Rate", "tilt rate"])
def test_a_misspelt_optional_column_is_refused_and_not_taken_for_zero(column):
    with pytest.raises(ex.InputError, match=f"column '{column}' looks like 'tilt_rate'"):
        recognise(["tilt", column, "precession", "spin"])
    assert recognise(["tilt", column, "tilt_rate", "precession", "spin"])

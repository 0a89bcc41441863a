"""The measure is invariant under the flow, and the tests of it can fail."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.measure import invariance


@pytest.mark.parametrize("name", ["uniform", "hoop", "matching", "thick"])
@pytest.mark.parametrize("steps", [20, 200, 800])
def test_the_flow_has_determinant_one(name, steps):
    """|det - 1| < 1e-10 along motions through many passages: the measure is invariant."""
    disk = BODIES[name]
    draw = np.random.default_rng(steps).uniform
    given = draw(-1.3, 1.3, 300), *(disk.rate_unit * draw(-2.0, 2.0, (3, 300)))
    known = ex.constants(ex.phi_to_states(disk, *given))
    away = np.fmin(abs(known.eta_hat_plus), abs(known.eta_hat_minus)) > 0.05 * disk.rate_unit
    found = ex.flow_stretch(ex.phi_to_states(disk, *(column[away] for column in given)), steps=steps)
    assert away.sum() > 150
    assert found.time.max() > 0.03 * steps * disk.time_unit
    assert abs(found.determinant - 1.0).max() < 1e-10
    largest = abs(found.matrix).max(axis=(1, 2))
    np.testing.assert_allclose(found.rounding, np.finfo(float).eps * steps * largest, rtol=0.02)


@pytest.mark.parametrize("eta_hat", [1e-2, -1e-3, 1e-4, -1e-5, 1e-6])
@pytest.mark.parametrize("steps", [100, 250, 400])
def test_the_determinant_stays_one_beside_f_to_the_rounding_of_its_stretch(eta_hat, steps):
    """Beside F the flow stretches by 1/eta, and so does rounding; nothing else does."""
    states = ex.constants_to_states(ex.Disk.uniform(), 1.0, eta_hat, 1.0)
    found = ex.flow_stretch(states, steps=steps)
    assert abs(found.determinant - 1.0) < 1e-12 + 1e-14 / abs(eta_hat)


def test_states_of_the_measure_are_distributed_as_before_and_others_are_not(monkeypatch):
    disk = ex.Disk.hoop()
    good = ex.push_forward(disk, 4.0, 20_000, rng=2)
    assert good.failed == 0
    assert good.p_value > 0.01
    # The measure times cos(phi) is not invariant.
    right = invariance.energy_density
    wrong = partial(replace, weight=lambda phi, *_: np.cos(phi))
    monkeypatch.setattr(invariance, "energy_density", lambda *given: wrong(right(*given)))
    bad = ex.push_forward(disk, 4.0, 20_000, rng=2)
    assert bad.p_value < 1e-6


def test_p_values_of_the_invariant_measure_are_spread_evenly():
    """Eleven independent tests: neither all small nor all large."""
    disk = ex.Disk.uniform(m=2.0, r=0.3, g=9.81)
    time = 3.0 * disk.time_unit
    found = [ex.push_forward(disk, time, 4000, rng=s).p_values["sigma4"] for s in range(11)]
    assert min(found) > 1e-3
    assert 0.1 < np.median(found) < 0.9


def test_bad_input_is_named():
    disk = ex.Disk.uniform()
    with pytest.raises(ex.InputError, match="an upright disk"):
        ex.push_forward(disk, 1.0, energy=0.5)
    with pytest.raises(ex.InputError, match="steps = 0 must be a whole number from 1"):
        ex.flow_stretch(ex.phi_to_states(disk, 0.0, 1.0, 1.0, 1.0), steps=0)


def test_motions_are_pushed_forward_over_any_time_at_which_they_are_known():
    disk = BODIES["uniform"]
    late = ex.push_forward(disk, 1e4, 2000)
    assert late.failed == 0
    assert late.p_value > 1e-3
    with pytest.raises(ex.InputError, match="give a shorter time"):
        ex.push_forward(disk, 1e20, 2000)

"""Legs as `bounces` and `periods` ask for them: near flat by tables of passages, else by rules of their own."""

import numpy as np
import pytest
from conftest import BODIES

import explorer as ex
from explorer.motion.legs import falls_of_energy, first_rule, leg_kernels, legs_of
from explorer.motion.passages_by_quadrature import energy_on_f, fall_from_vertical
from explorer.motion.starts import held_constants, orbit_starts
from explorer.phase.constants import natural_constants
from kernels._jit import Kernel


def test_near_flat_a_leg_from_the_vertical_is_the_passage():
    disk, eta = BODIES["uniform"], np.array([1e-3, -1e-200])
    states = ex.constants_to_states(disk, 1.0, eta, 1.0)
    status, linear = held_constants(states, natural_constants(states))
    ends, legs, _upright = legs_of(disk, orbit_starts(states, linear), status, 1e-6, 3)
    passages = ex.passages(disk, 1.0, eta, 1.0)
    np.testing.assert_allclose(legs[0, :2], passages.delta_chi, rtol=1e-12)
    np.testing.assert_allclose(legs[2, :2], passages.duration, rtol=1e-12)
    np.testing.assert_allclose(2.0 * np.arcsin(0.5 * ends.here), passages.theta_min, rtol=1e-12)
    # From the vertical there is no way from the state that is not half a passage.
    assert np.isnan(legs[:, 4:]).all()


@pytest.mark.parametrize("accuracy", [1e-2, 1e-5, 1e-6, 1e-11])
def test_legs_call_the_kernels_that_are_named_and_no_others(accuracy, monkeypatch):
    called, call = set(), Kernel.__call__

    def noted(kernel, *arguments):
        called.add(kernel.name)
        call(kernel, *arguments)

    states = ex.constants_to_states(BODIES["uniform"], 1.0, [1e-3, 1.0], 1.0)
    status, linear = held_constants(states, natural_constants(states))
    monkeypatch.setattr(Kernel, "__call__", noted)
    legs_of(BODIES["uniform"], orbit_starts(states, linear), status, accuracy, 2)
    assert called == set(leg_kernels(accuracy))


def test_a_coarser_accuracy_begins_with_a_smaller_rule():
    rules = [
        first_rule(BODIES["uniform"], accuracy) for accuracy in (0.1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-13)
    ]
    assert rules == sorted(rules)
    assert rules[0] < rules[-1]


def test_falls_from_the_vertical_and_from_rest_meet_the_accuracy():
    disk = BODIES["hoop"]
    bar = np.array([0.6, 0.6, 0.2, 0.6])
    energy = energy_on_f(disk, bar, np.full(4, 0.8))
    energy[1:3] = energy_on_f(disk, bar, np.zeros(4))[1:3] - 0.3  # below the vertical
    energy[3] = np.nan
    best = fall_from_vertical(disk, bar, energy)
    for accuracy in (1e-2, 1e-6, 1e-10):
        found = falls_of_energy(disk, bar, energy, accuracy)
        np.testing.assert_allclose(found.chi[:3], best.chi[:3], atol=0.5 * accuracy)
        np.testing.assert_allclose(found.time[:3], best.time[:3], rtol=accuracy)
        assert np.isnan(found.chi[3])


def test_a_race_of_many_turns_is_known_as_well_as_it_says():
    """Of a body with kappa = 316, at once back from the one face. By dop853: 996.06696698 and 0.00281386."""
    body = ex.Disk(I1=1e-5, I3=2e-5)
    state = ex.constants_to_states(body, 1.302064474326873, 5.132887124718588e-08, 0.001513399969955084, -1)
    for accuracy in (1e-4, 1e-5, 1e-6, 1e-7):
        found = ex.periods(state, accuracy=accuracy)
        assert found.error_estimate[0] <= accuracy
        assert abs(found.chi[0] - 996.06978084) <= 3.0 * found.error_estimate[0] + 1e-8

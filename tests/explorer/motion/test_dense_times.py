"""Times that are dense where the contact point races."""

import numpy as np
import pytest

import explorer as ex
from explorer.motion.dense_times import dense_times
from explorer.phase.states import constants_to_states


@pytest.mark.parametrize("eta_hat", [0.1, 1e-3, -1e-5])
def test_no_step_of_chi_is_larger_than_asked_for(body, eta_hat):
    unit = body.rate_unit
    states = constants_to_states(body, 0.8 * unit, eta_hat * unit, unit)
    t = dense_times(states, 6.0 * body.time_unit, 0.15)
    assert t[0] == 0.0
    assert t[-1] == 6.0 * body.time_unit
    assert (np.diff(t) > 0.0).all()
    chi = ex.simulate(states, t_eval=t, observables=("chi",)).chi
    assert abs(np.diff(chi)).max() <= 0.15 + 1e-5
    assert np.ptp(chi) > 0.9 * body.race_limit


def test_times_that_are_given_are_kept_and_serve_all_motions_at_once():
    disk = ex.Disk.hoop()
    states = constants_to_states(disk, [0.8, -0.5], [1e-3, -1e-2], 1.0)
    given = np.array([0.25, 1.0, 3.0, 5.5])
    t = dense_times(states, given)
    assert np.isin(given, t).all()
    chi = ex.simulate(states, t_eval=t, observables=("chi",)).chi
    assert abs(np.diff(chi)).max() <= 0.2 + 1e-5


def test_few_times_serve_a_race_that_takes_a_millionth_of_the_motion():
    disk = ex.Disk.uniform()
    states = constants_to_states(disk, 0.8, 1e-6, 1.0)
    t = dense_times(states, 6.0)
    assert np.diff(t).min() < 1e-6
    assert t.size < 600


def test_a_motion_that_falls_asks_for_no_times():
    disk = ex.Disk.uniform()
    falling = constants_to_states(disk, 0.8, 0.0, 1.0)
    assert dense_times(falling, [0.0, 1.0, 2.0]).tolist() == [0.0, 1.0, 2.0]

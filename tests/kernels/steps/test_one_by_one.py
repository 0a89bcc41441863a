"""One trajectory after another: what the lanes are compared with, and what only they do."""

import numpy as np
import pytest
from one_by_one import in_turn
from steppers import CASES, NAMES, UNIFORM, random_states, run_batch

from kernels.disk.constants import constants_of
from kernels.disk.falling import potential_at_flat
from kernels.disk.field import ANGLES, ROW, State, column
from kernels.status import Status
from kernels.steps.attempt import DOP853, RK4, Integration, Outcome
from kernels.steps.events import TIME, TURNING_POINT, Stops


def follow(states, how, values, event=TURNING_POINT, pinned=None):
    n = states.shape[1]
    out, errors = np.empty((n, values.size, 10)), np.empty((3, n))
    status, steps = np.zeros(n, np.int8), np.zeros(n, np.int32)
    full = np.zeros((10, n))
    full[:8] = states
    free = np.full((3, n), np.nan) if pinned is None else pinned
    outcome = Outcome(status, steps, errors)
    in_turn(how, Stops(event, values), full, free, UNIFORM.natural, out, outcome)
    return out, status, steps, errors


@pytest.mark.parametrize(
    ("method", "control", "count"),
    [*((*case, 333) for case in CASES), (RK4, 0.5, 2)],
    ids=[*NAMES, "a few long steps"],
)
def test_lanes_give_bit_for_bit_what_one_trajectory_after_another_gives(method, control, count):
    states = random_states(count)
    fast = run_batch(method, ANGLES, states, control)
    n = states.shape[1]
    how = Integration(method, ANGLES, np.full(n, control), 100_000, 1e-2)
    slow, _status, steps, _errors = follow(states, how, np.zeros(1))
    reached = fast[1] == Status.OK
    assert reached.mean() > 0.9
    np.testing.assert_array_equal(fast[0][:, reached].T, slow[reached, 0, :8])
    np.testing.assert_array_equal(fast[2], steps)


def test_equal_stops_are_met_one_after_the_other_and_different_ones_may_share_a_step():
    states = random_states(5)
    how = Integration(DOP853, ANGLES, np.full(5, 1e-10), 10_000, 1e-3)
    turns = follow(states, how, np.array([0.0, 0.0, 0.01]))[0][:, :, ROW.t]
    assert (np.diff(turns[:, :2]) > 0.1).all()
    times = np.linspace(1.0, 1.01, 20)
    there = follow(states, how, times, TIME)[0][:, :, ROW.t]
    np.testing.assert_allclose(there, np.tile(times, (5, 1)), atol=1e-14)


def test_a_held_trajectory_keeps_an_eta_far_below_what_its_states_show():
    """theta_min is |eta| / sqrt(2 I1 (E - V_0)) to leading order; rounding alone would leave 1e-16."""
    b = UNIFORM.body
    states = np.zeros((8, 1))
    states[:5, 0] = 1.0, 0.0, -1.0, 1.0, b.I1 * b.dr0 / (b.I3 * b.r0)
    how = Integration(DOP853, ANGLES, np.full(1, 1e-8), 10_000, 1e-3)
    above_flat = constants_of(column(states, 0), UNIFORM.natural).energy - potential_at_flat(1.0 / b.r0, b)
    for eta in (1e-30, -1e-200):
        pinned = np.array([[1.0], [eta], [2.0 * b.I1 * b.dr0 - eta]])
        out, status, _, errors = follow(states, how, np.zeros(1), pinned=pinned)
        assert status[0] == Status.OK
        turn = State(*out[0, 0])
        assert np.sign(turn.rho) == np.sign(eta)
        assert turn.q == pytest.approx(abs(eta) / np.sqrt(2.0 * b.I1 * above_flat), rel=1e-6)
        assert abs(errors[0, 0]) < 1e-6


def test_a_trajectory_that_meets_its_stop_too_late_is_cut_off():
    how = Integration(DOP853, ANGLES, np.full(3, 1e-8), 4, 1e-3)
    out, status, steps, _ = follow(random_states(3), how, np.array([100.0]), TIME)
    assert (status == Status.STEP_LIMIT).all()
    assert (steps == 4).all()
    assert np.isnan(out).all()

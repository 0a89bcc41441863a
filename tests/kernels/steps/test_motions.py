"""Motions in lanes: at their times, independent of each other, with a status for every failure."""

import math

import numpy as np
import pytest
from steppers import CASES, NAMES, UNIFORM, random_states, run_batch

from kernels.disk.algebra import constants_batch
from kernels.disk.field import ANGLES, PATH, ROW
from kernels.status import Status
from kernels.steps import motions
from kernels.steps.attempt import DOP853, Integration, Outcome
from kernels.steps.trail import COLUMNS, Curve, Trail

NO_TRAIL = Trail(Curve(0.0, 0.0), np.empty((0, COLUMNS)), np.zeros(1, np.int64), 0)
TIMES = np.array([0.3, 0.31, 0.9, 2.0, 5.0])


def starts(n, seed=1):
    states = np.zeros((10, n))
    states[:8] = random_states(n, seed)
    return states


def constants(states):
    found = np.empty((6, states.shape[1]))
    constants_batch(states[:5].copy(), UNIFORM.whole, UNIFORM.natural, found)
    return found


def work(how, states, pinned, times=TIMES, status=None):
    n = states.shape[1]
    before = np.zeros(n, np.int8) if status is None else status
    outcome = Outcome(before, np.ones(n, np.int32), np.empty((3, n)))
    out, last = np.empty((n, times.size, 10)), np.empty((10, n))
    return motions.Motions(how, times, states, pinned, out, last, np.empty((3, n)), outcome)


def in_lanes(how, states, pinned, **given):
    made = work(how, states, pinned, **given)
    motions.MOTIONS[how.method, how.depth](made, NO_TRAIL, UNIFORM.natural, UNIFORM.whole)
    motions.judge_batch(made, constants(states), constants(made.last), UNIFORM.natural)
    return made.out, made.outcome


def free(n):
    return np.full((3, n), np.nan)


def setting(method, control, depth, n, max_steps=100_000):
    return Integration(method, depth, np.full(n, control), max_steps, 1e-2)


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_motion_does_not_feel_its_neighbours(method, control):
    states, among = starts(64), starts(64)
    pinned = constants(states)[:3].copy()
    among[:, 6], among[:, 8] = np.nan, np.inf
    how = setting(method, control, PATH, 64)
    alone, _ = in_lanes(setting(method, control, PATH, 1), states[:, 7:8].copy(), pinned[:, 7:8].copy())
    together, outcome = in_lanes(how, among, pinned)
    np.testing.assert_array_equal(alone[0], together[7])
    bad = np.isin(np.arange(64), [6, 8])
    assert not np.isin(outcome.status[bad], [Status.OK, Status.FALLS]).any()
    assert (outcome.status[~bad] == Status.OK).all()


def test_times_within_one_step_are_met_one_by_one_and_more_than_a_group_of_them():
    times = np.linspace(1.0, 1.01, 40)
    out, outcome = in_lanes(setting(DOP853, 1e-9, ANGLES, 3), starts(3), free(3), times=times)
    assert (outcome.status == Status.OK).all()
    np.testing.assert_allclose(out[..., ROW.t], np.tile(times, (3, 1)), atol=1e-14)
    assert (np.diff(out[..., ROW.psi], axis=1) != 0.0).all()


def test_a_motion_without_steps_left_is_cut_off_and_the_others_arrive():
    states = starts(40)
    how = setting(DOP853, 1e-9, ANGLES, 40, max_steps=12)
    _, outcome = in_lanes(how, states, free(40), times=np.array([0.5, 2.5]))
    cut = outcome.status == Status.STEP_LIMIT
    assert 0 < cut.sum() < 40
    assert (outcome.steps[cut] == 12).all()
    assert (outcome.steps[~cut] <= 12).all()
    assert (outcome.status[~cut] == Status.OK).all()


def test_a_tolerance_below_rounding_and_motions_that_are_skipped_have_their_status():
    states = starts(20)
    marked = np.tile(np.array([Status.BAD_INPUT, Status.OK], np.int8), 10)
    _, outcome = in_lanes(setting(DOP853, 1e-30, ANGLES, 20), states, free(20), status=marked)
    assert (outcome.status[::2] == Status.BAD_INPUT).all()
    assert (outcome.status[1::2] == Status.STEP_TOO_SMALL).all()
    assert (outcome.steps[::2] == 0).all()
    assert np.isnan(outcome.errors[:, ::2]).all()


def test_a_time_deep_in_a_race_is_found_where_a_cubic_through_the_step_does_not_find_it():
    """theta_min is 1e-9 there: dt/ds nearly vanishes in the middle of a step."""
    b = UNIFORM.body
    states = starts(32)
    states[:5] = np.array([1.0, 0.0, -1.0, 1.0, b.I1 * b.dr0 / (b.I3 * b.r0)])[:, None]
    eta = np.tile([1e-9, -1e-9], 16)
    pinned = np.stack([np.ones(32), eta, 2.0 * b.I1 * b.dr0 - eta])
    how = setting(DOP853, 1e-9, ANGLES, 32)
    middle = run_batch(DOP853, ANGLES, states[:8], 1e-9, pinned=pinned)[0][ROW.t, 0]
    times = np.append(middle + np.linspace(-1e-8, 1e-8, 41), middle + 0.1)
    out, outcome = in_lanes(how, states, pinned, times=times)
    assert (outcome.status == Status.OK).all()
    np.testing.assert_allclose(out[..., ROW.t], np.tile(times, (32, 1)), atol=1e-15)
    assert (np.diff(out[::2, :-1, ROW.chi]) > 0.0).all()
    turned = out[:2, -1, ROW.chi] - out[:2, 0, ROW.chi]
    assert turned[0] - turned[1] == pytest.approx(2.0 * math.pi * b.kappa, abs=1.5)


def test_what_holding_takes_shrinks_with_the_tolerance_and_is_of_held_motions_only():
    states = starts(40)
    pinned, taken = constants(states)[:3].copy(), []
    pinned[:, 0] = np.nan
    for tolerance in (1e-4, 1e-7):
        made = work(setting(DOP853, tolerance, ANGLES, 40), states, pinned)
        motions.MOTIONS[DOP853, ANGLES](made, NO_TRAIL, UNIFORM.natural, UNIFORM.whole)
        taken.append(made.taken)
        assert np.isnan(made.taken[:, 0]).tolist() == [False, False, True]
        assert (made.taken[0, 0], made.taken[1, 0]) == (0.0, 0.0)
        energy = constants(states)[3]
        assert (abs(made.taken[0]) <= made.taken[1] * energy * (1.0 + 1e-12)).all()
    coarse, fine = taken[0][2, 1:], taken[1][2, 1:]
    assert (fine < coarse).all()
    assert np.median(fine / coarse) < 0.1

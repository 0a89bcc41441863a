"""Trails of motions: every accepted step once, in order, and no longer than its interpolation allows."""

import numpy as np
import pytest
from steppers import CASES, NAMES, UNIFORM, random_states

from kernels.disk.field import ANGLES, ROW, column
from kernels.steps import motions
from kernels.steps.attempt import DOP853, RK4, RK8, Integration, Outcome, partial_step
from kernels.steps.trail import COLUMNS, LENGTH, SAMPLE, Curve, Trail

LOOSE = Curve(1e6, 1e6)
N = 40


def followed(method, control, curve=LOOSE, room=100_000, most=100_000):
    """The trail of motions that run free, and their outcome."""
    states = np.zeros((10, N))
    states[:8] = random_states(N)
    outcome = Outcome(np.zeros(N, np.int8), np.zeros(N, np.int32), np.zeros((3, N)))
    how = Integration(method, ANGLES, np.full(N, control), 10_000, 1.0)
    out, last, free = np.empty((N, 1, 10)), np.empty((10, N)), np.full((3, N), np.nan)
    work = motions.Motions(how, np.array([3.0]), states, free, out, last, np.empty((3, N)), outcome)
    trail = Trail(curve, np.full((room, COLUMNS), np.nan), np.zeros(1, np.int64), most)
    motions.MOTIONS[method, ANGLES](work, trail, UNIFORM.natural, UNIFORM.whole)
    return trail, work


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_trail_is_every_accepted_step_of_each_motion_in_order(method, control):
    trail, work = followed(method, control)
    rows = trail.rows[: trail.used[0]]
    for j in (0, 7, N - 1):
        own = rows[rows[:, SAMPLE] == j]
        assert 3 < len(own) <= work.outcome.steps[j]
        np.testing.assert_array_equal(own[0, :5], work.states[:5, j])
        states = np.column_stack([own[:, :10].T, work.last[:, j]])
        for i in range(len(own)):
            there = partial_step(method, column(states, i), own[i, LENGTH], UNIFORM.body)
            np.testing.assert_array_equal(there[:8], states[:8, i + 1])
        assert states[ROW.t, -2] < 3.0 <= states[ROW.t, -1]


@pytest.mark.parametrize(("method", "control"), [(RK8, 1.0), (DOP853, 1e-3)])
def test_long_steps_of_order_eight_that_are_cut_are_shorter_and_no_shorter_than_one_piece(method, control):
    whole, cut, fine = (
        followed(method, control, curve)[0].used[0] for curve in (LOOSE, Curve(0.2, 0.1), Curve(1e-9, 1e-9))
    )
    assert 1.15 * whole < cut <= fine < 1.4 * whole


@pytest.mark.parametrize(("method", "control"), [(RK8, 0.25), (DOP853, 1e-11)])
def test_short_steps_of_order_eight_are_as_long_as_ever(method, control):
    curve = Curve(1e-9, 1e-9)
    assert followed(method, control)[0].used[0] == followed(method, control, curve)[0].used[0]


def test_steps_of_order_four_are_as_long_as_ever():
    assert followed(RK4, 0.2)[0].used[0] == followed(RK4, 0.2, Curve(1e-3, 1e-3))[0].used[0]


def test_steps_without_room_are_counted_and_beyond_the_most_nothing_is_followed():
    whole, _ = followed(RK4, 0.2)
    short, _ = followed(RK4, 0.2, room=30)
    assert short.used[0] == whole.used[0]
    np.testing.assert_array_equal(short.rows, whole.rows[:30])
    assert 50 <= followed(RK4, 0.2, most=50)[0].used[0] < 50 + motions.LANES


def test_without_a_trail_nothing_is_kept_and_steps_are_as_long_as_they_were():
    trail, work = followed(RK8, 1.0, Curve(1e-3, 1e-3), most=0)
    assert trail.used[0] == 0
    np.testing.assert_array_equal(work.outcome.steps, followed(RK8, 1.0)[1].outcome.steps)

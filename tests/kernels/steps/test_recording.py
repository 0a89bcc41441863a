"""Curves from the steps of motions: as dense as asked, on the motion, and right between their points."""

import numpy as np
import pytest
from steppers import UNIFORM, random_states

from kernels.disk.field import ANGLES, PATH, ROW, column, field
from kernels.status import Status
from kernels.steps import motions, recording
from kernels.steps.attempt import DOP853, RK4, Integration, Outcome, partial_step
from kernels.steps.trail import COLUMNS, LENGTH, SAMPLE, Curve, Trail

T_END = 3.0


def setting(number, control, n, depth=ANGLES):
    return Integration(number, depth, np.full(n, control), 10_000, 1.0)


def course(states, how, curve):
    """What motions that run free did, up to T_END."""
    n = states.shape[1]
    starts, nan = np.zeros((10, n)), np.full((3, n), np.nan)
    starts[:8] = states
    outcome = Outcome(np.zeros(n, np.int8), np.zeros(n, np.int32), np.zeros((3, n)))
    out, last = np.empty((n, 1, 10)), np.empty((10, n))
    work = motions.Motions(how, np.array([T_END]), starts, nan, out, last, np.empty((3, n)), outcome)
    trail = Trail(curve, np.empty((1000 * n, COLUMNS)), np.zeros(1, np.int64), 1000 * n)
    motions.MOTIONS[how.method, how.depth](work, trail, UNIFORM.natural, UNIFORM.whole)
    rows = trail.rows[: trail.used[0]]
    return recording.Course(curve, rows, last, out, outcome.status, T_END, how.method, how.depth, 1000 * n)


def draw(found, room=100_000):
    drawing = recording.Drawing(np.empty((recording.ROWS, room)), np.empty(found.status.size + 1, np.int64))
    recording.draw_batch(found, drawing, UNIFORM.natural)
    return drawing


def curves(drawing):
    return np.split(drawing.points[:, : drawing.first[-1]], drawing.first[1:-1], axis=1)


@pytest.mark.parametrize(("number", "control"), [(DOP853, 1e-9), (DOP853, 0.1), (RK4, 0.5)])
def test_no_piece_is_longer_than_the_curve_allows(number, control):
    how = setting(number, control, 20)
    drawn = curves(draw(course(random_states(20), how, Curve(0.1, 0.2))))
    assert len(drawn) == 20
    for points in drawn:
        assert abs(np.diff(points[ROW.chi])).max() <= 0.1
        assert points[ROW.t, -1] == T_END
        assert (np.diff(points[ROW.t]) > 0.0).all()
        # The way in s from point to point; the last step goes on past the end.
        way = np.trapezoid(1.0 / points[ROW.q], points[ROW.t])
        assert points[10, :-2].sum() < way < 1.02 * points[10].sum()


@pytest.mark.parametrize(("number", "control"), [(DOP853, 0.01), (RK4, 0.2)])
def test_points_within_steps_lie_on_the_motion(number, control):
    """What the constants of motion and the circle say of points that no step ends at."""
    how = setting(number, control, 20, PATH)
    found = course(random_states(20), how, Curve(0.05, 0.05))
    points = draw(found)
    points = points.points[:, : points.first[-1]]
    assert points.shape[1] > 3 * len(found.rows)
    np.testing.assert_allclose(points[ROW.q] ** 2 + points[ROW.z] ** 2, 1.0, atol=1e-3)
    fine = draw(course(random_states(20), setting(DOP853, 1e-13, 20, PATH), Curve(0.05, 0.05)))
    for ours, theirs in zip(curves(draw(found)), curves(fine), strict=True):
        for row in (ROW.q, ROW.chi, ROW.psi, ROW.a1, ROW.a2):
            np.testing.assert_allclose(ours[row], np.interp(ours[ROW.t], theirs[ROW.t], theirs[row]), atol=4e-3)


def test_a_curve_that_is_too_long_is_given_up_where_it_gets_too_long():
    found = course(random_states(3), setting(DOP853, 0.01, 3), Curve(1e-3, 1e-3))
    drawing = draw(found)
    whole, short = drawing.first, draw(found._replace(most=500)).first
    assert (np.diff(whole) > 1000).all()
    longest_step = 0
    for j, points in enumerate(curves(drawing)):
        begins = np.searchsorted(points[ROW.t], found.rows[found.rows[:, SAMPLE] == j][:, ROW.t])
        longest_step = max(longest_step, np.diff([*begins, points.shape[1]]).max())
    assert (np.diff(short) > 500).all()
    assert (np.diff(short) < 500 + longest_step).all()


def test_the_polynomial_has_the_states_and_slopes_of_its_nodes():
    found = course(random_states(1), setting(DOP853, 0.01, 1, PATH), Curve(9.0, 9.0))
    n, b = len(found.rows), UNIFORM.body
    ends = np.empty((n + 3, 21))
    recording.gather(found.rows, np.arange(n), column(found.last, 0), (DOP853, PATH), ends, b)
    np.testing.assert_array_equal(ends[1:-2, :10], found.rows[:, :10])
    np.testing.assert_array_equal(ends[3, 10:20], field(column(ends[:, :10].T.copy(), 3), b))
    W = np.empty(100)
    s = np.concatenate([[0.0], np.cumsum(ends[:-1, 20])])
    for i, known in ((1, range(6)), (2, range(6)), (4, range(2, 8)), (n, range(n - 3, n + 3))):
        nodes = recording.choose(ends, i, n + 3, W)
        assert nodes == (i, known.start, 6)
        for k in known:
            values = []
            for shift in (0.0, 1e-5, -1e-5):
                recording.evaluate(ends, nodes, W, s[k] - s[i] + shift)
                values.append(W[24:34].copy())
            np.testing.assert_allclose(values[0], ends[k, :10], rtol=0.0, atol=1e-13)
            np.testing.assert_allclose((values[1] - values[2]) / 2e-5, ends[k, 10:20], rtol=0.0, atol=1e-7)


def test_the_ends_of_a_motion_are_continued_by_a_step_of_its_method():
    found = course(random_states(1), setting(DOP853, 0.01, 1, PATH), Curve(9.0, 9.0))
    n, b = len(found.rows), UNIFORM.body
    ends = np.empty((n + 3, 21))
    recording.gather(found.rows, np.arange(n), column(found.last, 0), (DOP853, PATH), ends, b)
    states = ends[:, :10].T.copy()
    back = partial_step(DOP853, column(states, 0), ends[0, 20], b)
    np.testing.assert_allclose(back, states[:, 1], rtol=0.0, atol=1e-8)
    on = partial_step(DOP853, column(states, n + 1), found.rows[-1, LENGTH], b)
    np.testing.assert_array_equal(on, states[:, n + 2])


def test_a_motion_of_few_steps_is_interpolated_from_those_there_are():
    """By two ends with slopes a cubic is found again."""
    ends, W = np.zeros((2, 21)), np.empty(100)
    ends[0, 20], ends[1, :10], ends[:, 10:20] = 2.0, 8.0, [[0.0] * 10, [12.0] * 10]
    nodes = recording.choose(ends, 0, 2, W)
    assert nodes == (0, 0, 2)
    recording.evaluate(ends, nodes, W, 0.5)
    np.testing.assert_allclose(W[24:34], 0.125, rtol=1e-15)


def test_motions_that_failed_have_no_points_and_rows_may_come_in_any_order():
    found = course(random_states(5), setting(RK4, 0.1, 5), Curve(0.2, 0.2))
    whole = curves(draw(found))
    found.status[2] = Status.STEP_LIMIT
    by_sample = found.rows[np.argsort(found.rows[:, SAMPLE], kind="stable")]
    drawing = draw(found._replace(rows=by_sample))
    assert (np.diff(drawing.first) > 0).tolist() == [True, True, False, True, True]
    for one, other in zip(curves(drawing), [*whole[:2], np.empty((11, 0)), *whole[3:]], strict=True):
        np.testing.assert_array_equal(one, other)


def test_where_there_is_no_room_points_are_counted_and_nothing_else_is_written():
    found = course(random_states(4), setting(RK4, 0.1, 4), Curve(0.2, 0.2))
    whole = draw(found)
    np.testing.assert_array_equal(draw(found, 0).first, whole.first)
    room = int(whole.first[2]) + 3
    np.testing.assert_array_equal(draw(found, room).points, whole.points[:, :room])


def test_a_curve_gives_back_its_own_states_and_those_between():
    how = setting(DOP853, 1e-12, 3)
    coarse, fine = (draw(course(random_states(3), how, Curve(size, size))) for size in (0.2, 0.01))
    b = UNIFORM.natural
    for j, (own, points) in enumerate(zip(curves(coarse), curves(fine), strict=True)):
        for times, want, close in ((own[ROW.t], own, 0.0), (points[ROW.t], points, 1e-10)):
            out = np.empty((3, times.size, 10))
            moments = recording.Moments(times.copy(), 1.0, 1.0)
            recording.at_times(how, coarse, moments, b, out)
            np.testing.assert_allclose(out[j].T, want[:10], rtol=0.0, atol=close)


def test_there_are_no_states_of_a_motion_without_points():
    found = course(random_states(2), setting(RK4, 0.1, 2), Curve(0.2, 0.2))
    found.status[0] = Status.STEP_LIMIT
    out = np.empty((2, 1, 10))
    recording.at_times(
        setting(RK4, 0.1, 2), draw(found), recording.Moments(np.array([1.0]), 1.0, 1.0), UNIFORM.natural, out
    )
    assert np.isnan(out[0]).all()
    assert out[1, 0, ROW.t] == pytest.approx(1.0, abs=1e-14)
    assert found.rows[0, LENGTH] > 0.0

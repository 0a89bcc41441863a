"""One trajectory recorded at its own steps, by kernels that are told little."""

import numpy as np
import pytest
from steppers import UNIFORM, random_states

from kernels.disk.field import ANGLES, ROW
from kernels.status import Status
from kernels.steps import recording
from kernels.steps.attempt import DOP853, RK4, Integration, Outcome


def record(state, how, curve, rows=1000):
    start = recording.Start(np.zeros((10, 1)), np.full((3, 1), np.nan))
    start.x[:8, 0] = state
    going = recording.Going(np.zeros((10, 1)), *np.zeros((4, 1)), *np.zeros((3, 1), np.int64))
    out = np.full((rows, 11), np.nan)
    outcome = Outcome(np.zeros(1, np.int8), np.zeros(1, np.int32), np.zeros((3, 1)))
    recording.record_piece(how, curve, start, UNIFORM.natural, going, out, outcome)
    return out[: going.rows[0]], going, outcome


def method(number, control, max_steps=10_000):
    return Integration(number, ANGLES, np.array([control]), max_steps, 1.0)


@pytest.mark.parametrize(("number", "control"), [(DOP853, 1e-9), (RK4, 0.5)])
def test_no_step_is_longer_than_the_curve_allows(number, control):
    for state in random_states(20).T:
        rows, going, outcome = record(state, method(number, control), recording.Curve(0.1, 0.2, 3.0))
        assert going.stage[0] == recording.ENDED
        assert outcome.status[0] in (Status.OK, Status.INVARIANT_DRIFT)
        assert abs(np.diff(rows[:, ROW.chi])).max() <= 0.1
        assert rows[-1, ROW.t] == pytest.approx(3.0, abs=1e-14)
        assert (np.diff(rows[:, ROW.t]) > 0.0).all()


def test_a_fixed_step_is_shortened_where_it_must_be_and_only_there():
    state = random_states(1)[:, 0]
    loose, _, _ = record(state, method(RK4, 0.05), recording.Curve(10.0, 10.0, 2.0))
    assert np.ptp(loose[:-1, recording.STEP]) == 0.0
    tight, _, _ = record(state, method(RK4, 0.05), recording.Curve(0.02, 10.0, 2.0))
    assert np.ptp(tight[:-1, recording.STEP]) > 0.0
    assert tight[:-1, recording.STEP].max() <= loose[0, recording.STEP]


def test_a_full_buffer_is_no_end_and_a_step_limit_is():
    state = random_states(1)[:, 0]
    rows, going, _ = record(state, method(DOP853, 1e-9), recording.Curve(0.1, 0.1, 3.0), rows=5)
    assert (len(rows), going.stage[0]) == (4, recording.UNDERWAY)
    _, going, outcome = record(state, method(DOP853, 1e-9, 3), recording.Curve(0.1, 0.1, 3.0))
    assert (going.stage[0], outcome.status[0]) == (recording.ENDED, Status.STEP_LIMIT)


def test_a_record_gives_back_its_own_states_and_those_between():
    state = random_states(1)[:, 0]
    how = method(DOP853, 1e-12)
    rows, _, _ = record(state, how, recording.Curve(0.2, 0.2, 2.0))
    fine, _, _ = record(state, how, recording.Curve(0.01, 0.01, 2.0))
    times = np.ascontiguousarray(fine[:, ROW.t])
    out = np.empty((10, times.size))
    places = np.searchsorted(rows[:, ROW.t], times, side="right") - 1
    recording.at_times(how, rows, places, times, UNIFORM.natural, out)
    np.testing.assert_allclose(out.T, fine[:, :10], atol=1e-10)

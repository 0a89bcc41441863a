"""The promises of the lanes: packed, independent of each other, bounded work, a status for every failure."""

import re

import numba
import numpy as np
import pytest
from steppers import CASES, NAMES, UNIFORM, random_states, run_batch

from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.disk.field import ANGLES, REDUCED
from kernels.status import Status
from kernels.steps import lanes
from kernels.steps.attempt import DOPRI5, RK4, dop853_attempt, dopri5_attempt, rk4_attempt, rk8_attempt
from kernels.steps.events import Stop
from kernels.types import Vector


@pytest.mark.parametrize("attempt_by", [rk4_attempt, rk8_attempt, dopri5_attempt, dop853_attempt])
def test_the_lanes_of_every_method_are_packed(attempt_by):
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Stop, Body)))

    @numba.njit(signature, error_model="numpy")
    def step_all(W, stop, b):
        lanes.sweep(attempt_by, W, stop, b)

    (assembly,) = step_all.inspect_asm().values()
    found = re.findall(r"^\s+v?(?:add|sub|mul)(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 5 * found.count("sd")


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_the_reduced_motion_is_the_same_at_every_depth(method, control):
    states = random_states(100)
    shallow, deep = run_batch(method, REDUCED, states, control), run_batch(method, ANGLES, states, control)
    np.testing.assert_array_equal(shallow[0][:5], deep[0][:5])
    assert (shallow[0][5:] == 0.0).all()


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_sample_does_not_feel_its_neighbours(method, control):
    states = random_states(64)
    alone = run_batch(method, ANGLES, states[:, 7:8].copy(), control)
    poisoned = states.copy()
    poisoned[:, 6], poisoned[:, 8] = np.nan, np.inf
    among = run_batch(method, ANGLES, poisoned, control)
    np.testing.assert_array_equal(alone[0][:, 0], among[0][:, 7])
    assert alone[1][0] == among[1][7] == Status.OK
    assert not np.isin(among[1][[6, 8]], [Status.OK, Status.FALLS]).any()
    assert np.isnan(among[0][:, [6, 8]]).all()
    assert set(among[1][np.setdiff1d(np.arange(64), [6, 8])]) <= {Status.OK}


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_work_is_bounded_at_an_equilibrium_and_the_other_samples_finish(method, control):
    states = random_states(40)
    states[:, 3] = [1.0, 0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0]  # straight rolling: never turns
    _, status, steps, _ = run_batch(method, ANGLES, states, control, max_steps=2_000)
    assert status[3] == Status.STEP_LIMIT
    assert steps[3] == 2_000
    assert (np.delete(status, 3) == Status.OK).all()


def test_no_sample_goes_on_when_its_steps_are_spent_though_no_other_is_through():
    out, status, steps, _ = run_batch(RK4, ANGLES, random_states(3), 0.05, max_steps=4)
    assert (status == Status.STEP_LIMIT).all()
    assert (steps == 4).all()
    assert np.isnan(out).all()


def test_a_tolerance_below_rounding_ends_with_its_own_status():
    _, status, _, _ = run_batch(DOPRI5, ANGLES, random_states(5), 1e-30)
    assert (status == Status.STEP_TOO_SMALL).all()


def test_a_step_far_too_large_is_only_ok_where_it_was_cut_short_by_the_event():
    states = random_states(400)
    coarse, status, steps, _ = run_batch(RK4, ANGLES, states, 3.0, constants_bound=1e-6)
    fine, _, _, _ = run_batch(DOPRI5, ANGLES, states, 1e-11)
    ok = status == Status.OK
    assert (steps[ok] == 1).all()
    assert ok.sum() < 10
    np.testing.assert_allclose(coarse[:, ok], fine[:, ok], atol=1e-5)


def test_an_eta_below_the_methods_error_is_unresolved_not_guessed():
    b = UNIFORM.body
    states = np.zeros((8, 40))
    states[0], states[2], states[3] = 1.0, -1.0, 1.0
    eta_hat = np.tile([1e-9, -1e-9], 20)
    states[4] = b.I1 * b.dr0 / (b.I3 * b.r0) - eta_hat
    _, status, _, _ = run_batch(DOPRI5, ANGLES, states, 1e-6)
    assert (status == Status.UNRESOLVED_SIDE).all()
    out, status, _, _ = run_batch(DOPRI5, ANGLES, states, 1e-13)
    assert (status == Status.OK).all()
    assert (np.sign(out[6] - 1.0) == np.sign(eta_hat)).all()


def test_samples_marked_beforehand_are_skipped_and_keep_their_status():
    states = random_states(20)
    marked = np.tile([Status.BAD_INPUT, Status.OK], 10)
    _, status, steps, _ = run_batch(DOPRI5, ANGLES, states, 1e-6, max_steps=1000, before=marked)
    assert (status[::2] == Status.BAD_INPUT).all()
    assert (status[1::2] == Status.OK).all()
    assert (steps[::2] == 0).all()


def test_drift_of_the_constants_shrinks_with_the_tolerance(paper_body):
    states = random_states(200, seed=4)
    sizes = []
    for tolerance in (1e-5, 1e-7, 1e-9, 1e-11):
        constants_error = run_batch(DOPRI5, ANGLES, states, tolerance, constants_bound=1.0)[3]
        sizes.append(np.nanpercentile(abs(constants_error), 99, axis=1))
    sizes = np.array(sizes)
    assert (sizes[1:] < 0.05 * sizes[:-1]).all()
    assert (sizes[-1] < 1e-10).all()

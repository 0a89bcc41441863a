"""Orders of both methods, events, and the promises of the batches."""

import re

import numba
import numpy as np
import pytest
from conftest import BODIES

from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.disk.field import ANGLES, PATH, REDUCED, State, energy, speed
from kernels.status import Status
from kernels.steps import batch, events, trajectory
from kernels.steps.adaptive import GROW, SHRINK, dopri5_step, error_norm, step_factor
from kernels.steps.attempt import DOP853, DOPRI5, RK4, RK8, Integration, Outcome, locate
from kernels.steps.eighth import eighth_order_step
from kernels.steps.events import Stop, Stops
from kernels.steps.fixed import rk4_step
from kernels.types import Vector

UNIFORM = BODIES["uniform"]


@numba.njit(error_model="numpy")
def march(method, x, h, steps, b):
    for _ in range(steps):
        if method == RK4:
            x = rk4_step(x, h, b)
        elif method == DOPRI5:
            x, _error = dopri5_step(x, h, b)
        else:
            x, _fifth, _third = eighth_order_step(x, h, b)
    return x


def start(sigma4=0.65, chi=0.3):
    return State(1.0, 0.0, -1.0, 1.0, sigma4, 0.0, chi, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("method", [RK4, RK8, DOPRI5, DOP853])
def test_the_lanes_of_every_method_are_packed(method):
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Stop, Body)))

    @numba.njit(signature, error_model="numpy")
    def step_all(W, stop, b):
        batch.sweep(method, ANGLES, W, stop, b)

    (assembly,) = step_all.inspect_asm().values()
    found = re.findall(r"^\s+v?(?:add|sub|mul)(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 5 * found.count("sd")


def summed_errors(method, counts, length, starts, b):
    """Errors (2, 10) with both numbers of steps, summed over starts: for a single one a leading
    coefficient may happen to be small."""
    errors = np.zeros((2, 10))
    for column in random_states(starts, seed=8).T:
        x = State(*column, 0.0, 0.0)
        exact = np.array(march(DOPRI5, x, length / 4096, 4096, b))
        errors += [abs(np.array(march(method, x, length / n, n, b)) - exact) for n in counts]
    # every start brings a few 1e-15 of rounding
    assert errors.min() > 7e-14 * starts, "errors must be above rounding for an order to mean anything"
    return errors


@pytest.mark.parametrize(("method", "order"), [(RK4, 4), (DOPRI5, 5)], ids=["rk4", "dopri5"])
@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_each_method_converges_with_its_order_in_every_component(method, order, name):
    errors = summed_errors(method, (160, 320), 3.0, 30, BODIES[name].body)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), order, atol=0.2)


@pytest.mark.parametrize("name", ["uniform", "hoop", "thick"])
def test_the_eighth_order_method_converges_with_its_order(name):
    """The sum over components: single ones reach rounding before they settle."""
    errors = summed_errors(RK8, (10, 20), 1.5, 100, BODIES[name].body).sum(axis=1)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(8, abs=0.25)


def test_the_error_estimate_bounds_the_error_of_the_embedded_solution():
    b = UNIFORM.body
    for h in (0.05, 0.1, 0.2):
        y, e = dopri5_step(start(), h, b)
        fine = march(DOPRI5, start(), h / 256, 256, b)
        true = error_norm(start(), State(*(np.array(y) - np.array(fine))), speed(start(), b), b)
        assert true <= error_norm(start(), e, speed(start(), b), b)


@pytest.mark.parametrize(("error", "factor"), [(np.nan, SHRINK), (np.inf, SHRINK), (0.0, GROW), (1.0, 0.9)])
def test_step_control_shrinks_on_nan_and_never_leaves_its_bounds(error, factor):
    assert step_factor(error) == pytest.approx(factor)


def test_the_error_norm_keeps_a_nan_wherever_it_stands():
    x = start()
    for name in ("q", "z", "p", "rho", "sigma4", "chi"):
        e = State(*np.zeros(10))._replace(**{name: np.nan})
        assert np.isnan(error_norm(x, e, 1.0, UNIFORM.body)), name


@pytest.mark.parametrize("method", [RK4, DOPRI5, RK8])
@pytest.mark.parametrize(
    ("event", "target"),
    [
        (events.VERTICAL, 0.05),
        (events.Event(1.0, 0.0, 0.0, 0.0), 0.9),
        (events.TURNING_POINT, -1.05),
        (events.TIME, 0.11),
    ],
    ids=["vertical", "window", "p", "time"],
)
def test_events_are_located_to_rounding(method, event, target):
    b, x = UNIFORM.body, start(sigma4=0.2)
    h = 0.2
    end = rk4_step(x, h, b)
    low, high = sorted((events.level(x, event), events.level(end, event)))
    if not low < target < high:
        target = 0.5 * (low + high)
    y = locate(method, x, end, h, Stop(event, target), b)
    assert events.level(y, event) == pytest.approx(target, abs=5e-16)


def run_batch(method, depth, states, control, max_steps=100_000, constants_bound=1e-2, before=Status.OK):
    n = states.shape[1]
    out, constants_error = np.empty((8, n)), np.empty((3, n))
    # The steps are counted from 0, whatever is in the array.
    status, steps = np.full(n, before, np.int8), np.ones(n, np.int32)
    how = Integration(method, depth, np.full(n, control), max_steps, constants_bound)
    stop, outcome = Stop(events.TURNING_POINT, 0.0), Outcome(status, steps, constants_error)
    batch.first_event_batch(how, stop, states, UNIFORM.natural, out, outcome)
    return out, status, steps, constants_error


def random_states(n, seed=1):
    rng = np.random.default_rng(seed)
    phi = rng.uniform(-1.2, 1.2, n)
    states = np.zeros((8, n))
    states[0], states[1] = np.cos(phi), np.sin(phi)
    states[2:5] = rng.uniform(-2, 2, (3, n))
    return states


CASES = [(RK4, 0.05), (DOPRI5, 1e-7), (RK8, 0.3), (DOP853, 1e-9)]


@pytest.mark.parametrize(("method", "control"), CASES, ids=["rk4", "dopri5", "rk8", "dop853"])
def test_lanes_give_bit_for_bit_what_one_trajectory_after_another_gives(method, control):
    states = random_states(333)
    fast = run_batch(method, ANGLES, states, control)
    n = states.shape[1]
    slow = np.empty((n, 1, 10))
    status, steps, constants_error = np.zeros(n, np.int8), np.zeros(n, np.int32), np.empty((3, n))
    full = np.zeros((10, n))
    full[:8] = states
    how, stops = (
        Integration(method, ANGLES, np.full(n, control), 100_000, 1e-2),
        Stops(events.TURNING_POINT, np.zeros(1)),
    )
    outcome, free = Outcome(status, steps, constants_error), np.full((3, n), np.nan)
    trajectory.trajectory_batch(how, stops, full, free, UNIFORM.natural, slow, outcome)
    reached = fast[1] == Status.OK
    assert reached.sum() > 300
    np.testing.assert_array_equal(fast[0][:, reached].T, slow[reached, 0, :8])
    np.testing.assert_array_equal(fast[2], steps)


@pytest.mark.parametrize(("method", "control"), CASES, ids=["rk4", "dopri5", "rk8", "dop853"])
def test_the_reduced_motion_is_the_same_at_every_depth(method, control):
    states = random_states(100)
    shallow, deep = run_batch(method, REDUCED, states, control), run_batch(method, ANGLES, states, control)
    np.testing.assert_array_equal(shallow[0][:5], deep[0][:5])
    assert (shallow[0][5:] == 0.0).all()


@pytest.mark.parametrize(("method", "control"), CASES, ids=["rk4", "dopri5", "rk8", "dop853"])
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


@pytest.mark.parametrize(("method", "control"), CASES, ids=["rk4", "dopri5", "rk8", "dop853"])
def test_work_is_bounded_at_an_equilibrium_and_the_other_samples_finish(method, control):
    states = random_states(40)
    states[:, 3] = [1.0, 0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0]  # straight rolling: never turns
    _, status, steps, _ = run_batch(method, ANGLES, states, control, max_steps=2_000)
    assert status[3] == Status.STEP_LIMIT
    assert steps[3] == 2_000
    assert (np.delete(status, 3) == Status.OK).all()


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


def test_the_path_depth_adds_the_centre_and_leaves_the_rest_close():
    b = UNIFORM.body
    x = start()
    full = np.array(march(DOPRI5, x, 0.01, 200, b))
    assert abs(full[8:]).max() > 0.1
    assert energy(State(*full), b) == pytest.approx(energy(x, b), rel=1e-11)
    assert PATH > ANGLES > REDUCED

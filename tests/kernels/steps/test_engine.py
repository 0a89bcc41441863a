"""The promises of the engine: lanes packed and independent, work bounded, a status for every failure."""

import math
import re

import numba
import numpy as np
import pytest
from steppers import CASES, DOPRI5, NAMES, UNIFORM, follow, linear, random_states

from kernels._jit import numba_type
from kernels.disk.body import Body
from kernels.disk.falling import potential_at_flat
from kernels.disk.field import ANGLES, PATH, ROW, column, energy
from kernels.status import Status
from kernels.steps import engine, lanes
from kernels.steps.attempt import DOP853
from kernels.steps.events import TIME, Event
from kernels.types import Vector

TIMES = np.array([0.3, 0.31, 0.9, 2.0, 5.0])


@pytest.mark.parametrize("method", engine.ATTEMPTS)
def test_the_lanes_of_every_method_are_packed(method):
    """Packed arithmetic outnumbers scalar many times; a change that stops the vectoriser shows here."""
    signature = numba.void(*map(numba_type, (Vector, Event, Body)))
    attempt_by = engine.at_depth(method, PATH)

    @numba.njit(signature, error_model="numpy")
    def step_all(W, event, b):
        lanes.sweep(attempt_by, W, event, b)

    (assembly,) = step_all.inspect_asm().values()
    found = re.findall(r"^\s+v?(?:add|sub|mul)(pd|sd)\s", assembly, re.MULTILINE)
    if "pd" not in found:
        pytest.skip("this machine has no packed double arithmetic")
    assert found.count("pd") > 5 * found.count("sd")


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_sample_does_not_feel_its_neighbours(method, control, held):
    states = random_states(64)
    to = linear(states) if held else np.full((3, 64), np.nan)
    alone = follow(method, PATH, states[:, 7:8].copy(), control, TIME, TIMES, to[:, 7:8].copy())
    among = states.copy()
    among[:, 6], among[:, 8] = np.nan, np.inf
    together = follow(method, PATH, among, control, TIME, TIMES, to)
    np.testing.assert_array_equal(alone.out[0], together.out[7])
    bad = np.isin(np.arange(64), [6, 8])
    assert not np.isin(together.status[bad], [Status.OK, Status.FALLS]).any()
    assert (together.status[~bad] == Status.OK).all()
    assert np.isnan(together.out[bad][:, -1]).all()


@pytest.mark.parametrize("count", [1, 17])
@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_every_sample_comes_to_its_turning_point(method, control, count):
    work = follow(method, ANGLES, random_states(count), control)
    assert (work.status == Status.OK).all()
    assert (work.steps > 0).all()
    assert (abs(work.out[:, 0, ROW.p]) <= 1e-14).all()
    assert (abs(work.out[:, 0, ROW.q] ** 2 + work.out[:, 0, ROW.z] ** 2 - 1.0) < 1e-4).all()


def test_times_within_one_step_are_met_one_by_one_and_more_than_a_group_of_them():
    times = np.linspace(1.0, 1.01, 40)
    work = follow(DOP853, ANGLES, random_states(3), 1e-9, TIME, times)
    assert (work.status == Status.OK).all()
    np.testing.assert_allclose(work.out[..., ROW.t], np.tile(times, (3, 1)), atol=1e-14)
    assert (np.diff(work.out[..., ROW.psi], axis=1) != 0.0).all()


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_work_is_bounded_at_an_equilibrium_and_the_other_samples_finish(method, control):
    states = random_states(40)
    states[:, 3] = [1.0, 0.0, 0.0, 0.0, 0.7, 0.0, 0.0, 0.0, 0.0, 0.0]  # straight rolling: never turns
    work = follow(method, ANGLES, states, control, max_steps=2_000)
    assert work.status[3] == Status.STEP_LIMIT
    assert work.steps[3] == 2_000
    assert (np.delete(work.status, 3) == Status.OK).all()


def test_a_tolerance_below_rounding_and_samples_that_are_skipped_have_their_status():
    marked = np.tile(np.array([Status.BAD_INPUT, Status.OK], np.int8), 10)
    work = follow(DOPRI5, ANGLES, random_states(20), 1e-30, status=marked)
    assert (work.status[::2] == Status.BAD_INPUT).all()
    assert (work.status[1::2] == Status.STEP_TOO_SMALL).all()
    assert (work.steps[::2] == 0).all()
    assert np.isnan(work.moved[:, ::2]).all()


def test_a_time_deep_in_a_race_is_found_where_a_cubic_through_the_step_does_not_find_it():
    """theta_min is 1e-9 there: dt/ds nearly vanishes in the middle of a step."""
    b = UNIFORM.body
    states = random_states(32)
    states[:5] = np.array([1.0, 0.0, -1.0, 1.0, b.I1 * b.dr0 / (b.I3 * b.r0)])[:, None]
    eta = np.tile([1e-9, -1e-9], 16)
    held = np.stack([np.ones(32), eta, 2.0 * b.I1 * b.dr0 - eta])
    middle = follow(DOP853, ANGLES, states, 1e-9, linear=held).out[0, 0, ROW.t]
    times = np.append(middle + np.linspace(-1e-8, 1e-8, 41), middle + 0.1)
    work = follow(DOP853, ANGLES, states, 1e-9, TIME, times, held)
    assert (work.status == Status.OK).all()
    np.testing.assert_allclose(work.out[..., ROW.t], np.tile(times, (32, 1)), atol=1e-15)
    assert (np.diff(work.out[::2, :-1, ROW.chi]) > 0.0).all()
    turned = work.out[:2, -1, ROW.chi] - work.out[:2, 0, ROW.chi]
    assert turned[0] - turned[1] == pytest.approx(2.0 * math.pi * b.kappa, abs=1.5)


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_held_sample_keeps_an_eta_far_below_what_its_state_shows(method, control):
    """theta_min is |eta| / sqrt(2 I1 (E - V_0)) to leading order; rounding alone would leave 1e-16."""
    b = UNIFORM.body
    eta = np.array([1e-8, -1e-30, 1e-200])
    states = np.zeros((10, 3))
    states[0], states[2], states[3], states[4] = 1.0, -1.0, 1.0, b.I1 * b.dr0 / (b.I3 * b.r0)
    excess = energy(column(states, 0), b) - potential_at_flat(1.0 / b.r0, b)
    held = np.stack([np.ones(3), eta, 2.0 * b.I1 * b.dr0 - eta])
    work = follow(method, ANGLES, states, control, linear=held)
    out = work.out[:, 0].T
    assert (work.status == Status.OK).all()
    np.testing.assert_array_equal(np.sign(out[ROW.rho]), np.sign(eta))
    np.testing.assert_allclose(out[ROW.q], abs(eta) / np.sqrt(2.0 * b.I1 * excess), rtol=1e-5)

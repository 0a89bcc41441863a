"""After every step samples that are held go back onto their constants, and what that moves is counted."""

import numpy as np
import pytest
from steppers import CASES, NAMES, UNIFORM, random_states, run_batch

from kernels.disk.constants import constants_of
from kernels.disk.falling import potential_at_flat
from kernels.disk.field import ANGLES, ROW, column
from kernels.status import Status


def pinned(states):
    """The constants of each state, rows as Pinned."""
    return np.array(
        [constants_of(column(states, j), UNIFORM.natural)[:3] for j in range(states.shape[1])]
    ).T.copy()


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_a_held_sample_keeps_an_eta_far_below_what_its_state_shows(method, control):
    """theta_min is |eta| / sqrt(2 I1 (E - V_0)) to leading order; rounding alone would leave 1e-16."""
    b = UNIFORM.body
    eta = np.array([1e-8, -1e-30, 1e-200])
    states = np.zeros((8, 3))
    states[0], states[2], states[3], states[4] = 1.0, -1.0, 1.0, b.I1 * b.dr0 / (b.I3 * b.r0)
    excess = constants_of(column(states, 0), UNIFORM.natural).energy - potential_at_flat(1.0 / b.r0, b)
    held = np.stack([np.ones(3), eta, 2.0 * b.I1 * b.dr0 - eta])
    out, status, _, moved = run_batch(method, ANGLES, states, control, pinned=held)
    assert (status == Status.OK).all()
    np.testing.assert_array_equal(np.sign(out[ROW.rho]), np.sign(eta))
    np.testing.assert_allclose(out[ROW.q], abs(eta) / np.sqrt(2.0 * b.I1 * excess), rtol=1e-5)
    assert (moved[:2] > 0.0).all()


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_held_and_free_motions_agree_where_nothing_is_lost(method, control):
    states = random_states(200)
    free = run_batch(method, ANGLES, states, control)
    held = run_batch(method, ANGLES, states, control, pinned=pinned(states))
    ok = (free[1] == Status.OK) & (held[1] == Status.OK)
    assert ok.mean() > 0.97
    apart = abs(held[0] - free[0])[:, ok].max(axis=0)
    assert np.percentile(apart, 99) < 1e-4
    assert (np.median(apart) > 0.0) & (held[3][1] > 0.0).all()


@pytest.mark.parametrize(("method", "control"), CASES, ids=NAMES)
def test_what_holding_moves_is_in_proportion_to_the_error(method, control):
    """Two settings: both fall alike, by the order of the method."""
    states = random_states(100, seed=3)
    exact = run_batch(3, ANGLES, states, 1e-14, pinned=pinned(states))[0]
    share = []
    for finer in (1.0, 0.5 if control > 1e-3 else 1e-2):
        out, _, _, moved = run_batch(method, ANGLES, states, control * finer, pinned=pinned(states))
        share.append(np.nanmedian(abs(out[ROW.chi] - exact[ROW.chi]) / (moved[0] + moved[1])))
    assert max(share) < 15.0
    assert max(share) < 20.0 * min(share)


def test_a_held_sample_does_not_feel_its_neighbours():
    states = random_states(40)
    held = pinned(states)
    among = run_batch(3, ANGLES, states, 1e-9, pinned=held)[0]
    alone = run_batch(3, ANGLES, states[:, 7:8].copy(), 1e-9, pinned=held[:, 7:8].copy())[0]
    np.testing.assert_array_equal(among[:, 7], alone[:, 0])

"""What tests of the integrators share: states drawn at random, plain marches, and batches to the turning point."""

import numba
import numpy as np
from conftest import BODIES

from kernels.disk.algebra import constants_batch
from kernels.disk.field import State
from kernels.status import Status
from kernels.steps import attempt, engine
from kernels.steps.adaptive import dopri5_step
from kernels.steps.eighth import eighth_order_step
from kernels.steps.events import TURNING_POINT
from kernels.steps.fixed import rk4_step

UNIFORM = BODIES["uniform"]
RK4, DOPRI5 = attempt.RK4, attempt.DOPRI5
CASES = [(RK4, 0.05), (DOPRI5, 1e-7), (attempt.RK8, 0.3), (attempt.DOP853, 1e-9)]
NAMES = ["rk4", "dopri5", "rk8", "dop853"]


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


def random_states(n, seed=1):
    rng = np.random.default_rng(seed)
    phi = rng.uniform(-1.2, 1.2, n)
    states = np.zeros((10, n))
    states[0], states[1] = np.cos(phi), np.sin(phi)
    states[2:5] = rng.uniform(-2, 2, (3, n))
    return states


def summed_errors(method, counts, length, starts, b):
    """Errors (2, 10) with both numbers of steps, summed over starts: for a single one a leading
    coefficient may happen to be small."""
    errors = np.zeros((2, 10))
    for column in random_states(starts, seed=8).T:
        x = State(*column)
        exact = np.array(march(DOPRI5, x, length / 4096, 4096, b))
        errors += [abs(np.array(march(method, x, length / n, n, b)) - exact) for n in counts]
    # every start brings a few 1e-15 of rounding
    assert errors.min() > 7e-14 * starts, "errors must be above rounding for an order to mean anything"
    return errors


def follow(method, depth, states, control, event=TURNING_POINT, values=(0.0,), linear=None, **given):
    """What the engine makes of states (10, n)."""
    n = states.shape[1]
    work = engine.Work(
        method,
        given.get("max_steps", 100_000),
        event,
        np.array(values, float),
        np.full(n, control),
        states,
        np.full((3, n), np.nan) if linear is None else linear,
        np.array(np.broadcast_to(given.get("status", Status.OK), n), np.int8),
        np.full((n, len(values), 10), np.nan),
        np.zeros(n, np.int32),
        np.full((3, n), np.nan),
    )
    engine.FOLLOW[method, depth](work, UNIFORM.natural)
    return work


def linear(states):
    """The constants of each state, sigma3_bar, eta_plus and eta_minus."""
    found = np.empty((6, states.shape[1]))
    constants_batch(states[:5].copy(), UNIFORM.natural, found)
    return found[:3].copy()

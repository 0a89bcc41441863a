"""One trajectory after another, recorded at a list of events. The plain reference of `batch`."""

import math
from typing import NamedTuple

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.constants import constants_of, onto_constants, onto_energy
from kernels.disk.field import ANGLES, PATH, State, energy, speed
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    DOP853,
    DOPRI5,
    RK4,
    RK8,
    all_finite,
    attempt,
    constants_error,
    first_step,
    locate,
    to_depth,
    verdict,
)
from kernels.steps.events import Event, crossed, level
from kernels.types import Codes, Counts, Matrix, Table, Vector

_OK = int(Status.OK)
_DRIFT = int(Status.INVARIANT_DRIFT)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)


@subroutine
def attempt_any(method, depth, x, h, control, unit, b):
    """attempt() with method and depth only known at run time."""
    if method == RK4:
        return attempt_at_depth(RK4, depth, x, h, control, unit, b)
    if method == RK8:
        return attempt_at_depth(RK8, depth, x, h, control, unit, b)
    if method == DOP853:
        return attempt_at_depth(DOP853, depth, x, h, control, unit, b)
    return attempt_at_depth(DOPRI5, depth, x, h, control, unit, b)


@device
def attempt_at_depth(method, depth, x, h, control, unit, b):
    """attempt() with the depth only known at run time."""
    if depth == PATH:
        return attempt(method, PATH, x, h, control, unit, b)
    return attempt(method, ANGLES, x, h, control, unit, b)


@subroutine
def record(y, row):
    """Write a state into one row of output, in the order of State."""
    row[0], row[1], row[2], row[3], row[4] = y.q, y.z, y.p, y.rho, y.sigma4
    row[5], row[6], row[7], row[8], row[9] = y.t, y.chi, y.psi, y.a1, y.a2


class Pinned(NamedTuple):
    """Constants of motion that a trajectory is held to; NaN in sigma3_bar: it runs free."""

    sigma3_bar: float
    eta_plus: float
    eta_minus: float


@subroutine
def trajectory(method, depth, x, pinned, control, event, targets, max_steps, b, series, out):
    """Follow one motion until `event` has taken each value of `targets` in turn.

    out (len(targets), 10) receives the states there, in the order of State. Returns status, the
    number of attempted steps, the last state reached and the energy taken out on the way.
    """
    held = not math.isnan(pinned.sigma3_bar)
    removed = 0.0
    if held:
        x = onto_constants(x, pinned.sigma3_bar, pinned.eta_plus, pinned.eta_minus, b, series)
    total = energy(x, b)
    unit = speed(x, b)
    if depth == PATH:
        unit *= b.kappa  # sin chi turns at up to kappa times the speed
    h = first_step(method, control, unit)
    done = 0
    for step in range(max_steps):
        y, accepted, following = attempt_any(method, depth, x, h, control, unit, b)
        if accepted:
            if not all_finite(y):
                return _NOT_FINITE, step + 1, x, removed
            before, after = level(x, event), level(y, event)
            while done < targets.size and crossed(before, after, targets[done]):
                record(to_depth(locate(method, x, y, h, event, targets[done], b), depth), out[done])
                # Two equal targets are two crossings; different ones may share a step.
                again = done + 1 < targets.size and targets[done + 1] == targets[done]
                done += 1
                if again:
                    break
            if held:
                y = onto_constants(y, pinned.sigma3_bar, pinned.eta_plus, pinned.eta_minus, b, series)
                y, excess = onto_energy(y, total, b)
                removed += excess
            x = y
            if done == targets.size:
                return _OK, step + 1, x, removed
        elif not following * unit > SHORTEST_STEP:
            return _TOO_SMALL, step + 1, x, removed
        h = following
    return _STEP_LIMIT, max_steps, x, removed


@kernel
def trajectory_batch(
    method: int,
    depth: int,
    states: Matrix,
    pinned: Matrix,
    control: Vector,
    event: Event,
    targets: Vector,
    max_steps: int,
    constants_bound: float,
    b: Body,
    series: Matrix,
    out: Table,
    status: Codes,
    steps: Counts,
    errors: Matrix,
) -> None:
    """Every column of states (10, n) through `trajectory`, recorded in out (n, len(targets), 10).

    pinned (3, n): rows as Pinned. status (n): samples that come in as not OK are skipped. errors (3, n):
    as attempt.ConstantsError, of the energy what was taken out on the way included.
    """
    for i in range(states.shape[1]):
        out[i, :, :] = math.nan
        steps[i] = 0
        errors[:, i] = math.nan
        if status[i] != _OK:
            continue
        x = State(
            states[0, i],
            states[1, i],
            states[2, i],
            states[3, i],
            states[4, i],
            states[5, i],
            states[6, i],
            states[7, i],
            states[8, i],
            states[9, i],
        )
        hold = Pinned(pinned[0, i], pinned[1, i], pinned[2, i])
        begin = constants_of(x, b, series)
        code, steps[i], last, removed = trajectory(
            method, depth, x, hold, control[i], event, targets, max_steps, b, series, out[i]
        )
        end = constants_of(last, b, series)
        # Whichever side is nearer decides whether the direction of its races is known.
        near_plus = abs(begin.eta_plus) <= abs(begin.eta_minus)
        moved = constants_error(begin, end, near_plus)
        energy_error = moved.energy + removed / begin.energy
        errors[0, i], errors[1, i], errors[2, i] = (
            energy_error,
            moved.sigma3_bar,
            moved.eta,
        )
        if code == _OK and not math.isnan(hold.sigma3_bar):
            # The accuracy is per passage, which takes about two units of time; errors add up.
            code = _OK if abs(energy_error) <= constants_bound * max(1.0, 0.5 * last.t) else _DRIFT
        elif code == _OK:
            eta = begin.eta_plus if near_plus else begin.eta_minus
            code = verdict(moved, eta, math.sqrt(2.0 * begin.energy / b.I1), constants_bound)
        status[i] = code

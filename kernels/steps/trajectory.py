"""One trajectory after another, recorded at a list of events. The plain reference of `batch`."""

import math

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.constants import Pinned, constants_of, nearer_plus, onto_constants, onto_energy
from kernels.disk.field import ANGLES, PATH, State, column, energy, speed
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    ConstantsError,
    Integration,
    Outcome,
    all_finite,
    attempt,
    constants_error,
    first_step,
    locate,
    to_depth,
    verdict,
)
from kernels.steps.events import Stop, Stops, crossed, level
from kernels.types import Matrix, Table

_OK = int(Status.OK)
_DRIFT = int(Status.INVARIANT_DRIFT)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)


@subroutine
def attempt_any(
    method: int, depth: int, x: State, h: float, control: float, unit: float, b: Body
) -> tuple[State, bool, float]:
    """attempt() with method and depth only known at run time."""
    if depth == PATH:
        return attempt(method, PATH, x, h, control, unit, b)
    return attempt(method, ANGLES, x, h, control, unit, b)


@subroutine
def trajectory(
    how: Integration, stops: Stops, x: State, pinned: Pinned[float], control: float, disk: Disk, out: Matrix
) -> tuple[int, int, State, float]:
    """Follow one motion until it has come to each of the stops in turn.

    out (stops, 10) receives the states there, in the order of State. Returns status, the
    number of attempted steps, the last state reached and the energy taken out on the way.
    """
    b, values = disk.body, stops.values
    held = not math.isnan(pinned.sigma3_bar)
    removed = 0.0
    if held:
        x = onto_constants(x, pinned, disk)
    total = energy(x, b)
    unit = speed(x, b)
    if how.depth == PATH:
        unit *= b.kappa  # sin chi turns at up to kappa times the speed
    h = first_step(how.method, control, unit)
    done = 0
    for step in range(how.max_steps):
        y, accepted, following = attempt_any(how.method, how.depth, x, h, control, unit, b)
        if accepted:
            if not all_finite(y):
                return _NOT_FINITE, step + 1, x, removed
            before, after = level(x, stops.event), level(y, stops.event)
            while done < values.size and crossed(before, after, values[done]):
                there = to_depth(locate(how.method, x, y, h, Stop(stops.event, values[done]), b), how.depth)
                for component in range(out.shape[1]):
                    out[done, component] = there[component]
                # Two equal values are two crossings; different ones may share a step.
                again = done + 1 < values.size and values[done + 1] == values[done]
                done += 1
                if again:
                    break
            if held:
                y, excess = onto_energy(onto_constants(y, pinned, disk), total, b)
                removed += excess
            x = y
            if done == values.size:
                return _OK, step + 1, x, removed
        elif not following * unit > SHORTEST_STEP:
            return _TOO_SMALL, step + 1, x, removed
        h = following
    return _STEP_LIMIT, how.max_steps, x, removed


@kernel
def trajectory_batch(
    how: Integration, stops: Stops, states: Matrix, pinned: Matrix, disk: Disk, out: Table, outcome: Outcome
) -> None:
    """Every column of states (10, n) through `trajectory`, recorded in out (n, stops, 10), NaN where it failed.

    pinned (3, n): rows as Pinned. The error of the energy includes what was taken out on the way.
    """
    status, bound = outcome.status, how.constants_bound
    for i in range(states.shape[1]):
        out[i, :, :] = math.nan
        outcome.steps[i] = 0
        outcome.errors[:, i] = math.nan
        if status[i] != _OK:
            continue
        x, hold = column(states, i), Pinned(pinned[0, i], pinned[1, i], pinned[2, i])
        begin = constants_of(x, disk)
        code, outcome.steps[i], last, removed = trajectory(how, stops, x, hold, how.control[i], disk, out[i])
        end = constants_of(last, disk)
        # It may come to both faces; whichever is nearer decides whether the direction of its races is known.
        plus = nearer_plus(begin.eta_plus, begin.eta_minus)
        moved = constants_error(begin, end, plus)
        energy_error = moved.energy + removed / begin.energy
        put(ConstantsError(energy_error, moved.sigma3_bar, moved.eta), outcome.errors, i)
        if code == _OK and not math.isnan(hold.sigma3_bar):
            # The accuracy is per passage, which takes about two units of time; errors add up.
            code = _OK if abs(energy_error) <= bound * max(1.0, 0.5 * last.t) else _DRIFT
        elif code == _OK:
            eta = begin.eta_plus if plus else begin.eta_minus
            code = verdict(moved, eta, math.sqrt(2.0 * begin.energy / disk.body.I1), bound)
        status[i] = code

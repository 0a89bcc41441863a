"""One trajectory after another, recorded at a list of events: the plain reference of the lanes.

What is slow to compile is kept in the cache, as kernels are.
"""

import math

from kernels._jit import Kernel, subroutine
from kernels.disk import chaplygin
from kernels.disk.body import Body, Disk
from kernels.disk.constants import Pinned, constants_of, depth_below_vertical, fastest_within, onto_energy
from kernels.disk.field import ANGLES, PATH, State, column, energy, pace, with_reduced
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import (
    Ending,
    Integration,
    Outcome,
    all_finite,
    attempt,
    first_step,
    judge,
    locate,
    to_depth,
)
from kernels.steps.events import Stop, Stops, crossed, level
from kernels.types import Matrix, Table

_OK = int(Status.OK)
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
def onto_constants(x: State, pinned: Pinned[float], disk: Disk) -> State:
    """x with q^2 + z^2 = 1 restored and rho, sigma4 set to what the constants say at its tilt.

    The saddle beside flat amplifies an error in rho by 1/theta_min. Set anew after every step, rho
    never carries one: eta stays what it was given as, down to 1e-300. Needs I3 > 0.
    """
    b = disk.body
    face = 1.0 if x.z >= 0.0 else -1.0
    q, z = x.q, x.z
    if q < abs(z):
        z = face * math.sqrt((1.0 - q) * (1.0 + q))
    else:
        q = math.sqrt((1.0 - z) * (1.0 + z))
    S, log_S = depth_below_vertical(q, z)
    f = chaplygin.solutions(S, log_S, b.c, disk.series)
    X = pinned.sigma3_bar / b.r0
    Y = (pinned.eta_plus if face > 0.0 else pinned.eta_minus) / b.I1
    _sigma3, sigma4 = chaplygin.sigma_from_constants(face, X, Y, f, b.k)
    # sigma3/q written so that S may underflow
    rho = X * f.rho_over_S * (q / (1.0 + abs(z))) + Y * (f.D / q)
    return with_reduced(x, q, z, x.p, rho, sigma4)


@subroutine
def begin(x: State, pinned: Pinned[float], disk: Disk) -> State:
    """The state at the start, on the constants that the motion is held to."""
    return x if math.isnan(pinned.sigma3_bar) else onto_constants(x, pinned, disk)


@subroutine
def hold(x: State, y: State, pinned: Pinned[float], total: float, disk: Disk) -> tuple[State, float]:
    """The state y after a step from x, put back onto its constants, and what was taken out of its energy.

    The energy is put back once in each swing, at its fastest: what a step does to the energy on the way down is
    mostly undone on the way up, and p would take up an error of the tilt.
    """
    if math.isnan(pinned.sigma3_bar):
        return y, 0.0
    y = onto_constants(y, pinned, disk)
    if fastest_within(x, y, disk.body):
        return onto_energy(y, total, disk.body)
    return y, 0.0


@subroutine
def trajectory(
    how: Integration, stops: Stops, x: State, pinned: Pinned[float], control: float, disk: Disk, out: Matrix
) -> tuple[int, int, State, float]:
    """Follow one motion until it has come to each of the stops in turn.

    out (stops, 10) receives the states there, in the order of State. Returns status, the
    number of attempted steps, the last state reached and the energy taken out on the way.
    """
    b, values = disk.body, stops.values
    removed = 0.0
    x = begin(x, pinned, disk)
    total = energy(x, b)
    unit = pace(x, b)
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
            x, excess = hold(x, y, pinned, total, disk)
            removed += excess
            if done == values.size:
                return _OK, step + 1, x, removed
        elif not following * unit > SHORTEST_STEP:
            return _TOO_SMALL, step + 1, x, removed
        h = following
    return _STEP_LIMIT, how.max_steps, x, removed


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
        x, to = column(states, i), Pinned(pinned[0, i], pinned[1, i], pinned[2, i])
        start, held = constants_of(x, disk), not math.isnan(to.sigma3_bar)
        code, outcome.steps[i], last, removed = trajectory(how, stops, x, to, how.control[i], disk, out[i])
        end = Ending(code, last.t, removed, held, bound)
        status[i], errors = judge(end, start, constants_of(last, disk), disk.body)
        put(errors, outcome.errors, i)


# Not among the kernels of the package.
in_turn = Kernel(trajectory_batch)

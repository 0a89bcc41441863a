"""What all integrators share: one attempted step, event location, limits, and the verdict."""

import math
from typing import Generic, NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.constants import Constants, nearer_plus
from kernels.disk.field import ANGLES, REDUCED, State, field, shift
from kernels.disk.rows import Entry
from kernels.status import Status
from kernels.steps.adaptive import LONGEST_STEP, dopri5_step, error_norm, path_error_norm, step_factor
from kernels.steps.eighth import combined_error, eighth_order_step, eighth_step_factor, longest_step
from kernels.steps.events import Stop, level, level_rate
from kernels.steps.fixed import rk4_step
from kernels.types import Codes, Counts, Matrix, Vector

RK4, DOPRI5, RK8, DOP853 = range(4)  # RK8: the steps of DOP853 at a fixed length

_OK = int(Status.OK)
_DRIFT = int(Status.INVARIANT_DRIFT)
_UNRESOLVED = int(Status.UNRESOLVED_SIDE)

# An error in eta above this share of |eta| makes the direction of the race doubtful. Ten times
# stricter than the sign needs: the error is only seen where the motion is checked.
RESOLVED_SHARE = 0.1
# Newton's method on the partial step converges in 2 or 3 steps; bisection guards the rest.
LOCATE_LIMIT = 60
_CUBIC_STEPS = 3  # on the cubic, which is itself off by the fourth power of the step: more would be too good
# Shares of a step whose fifth power, third power and square are rounding.
_SHORT, _SHORTER, _LAST = 1e-3, 1e-5, 1e-8


class Integration(NamedTuple):
    """How motions are integrated: RK4 ...; REDUCED, ANGLES or PATH; and when to give up.

    control (n): step in units of 1/speed (RK4, RK8) or tolerance (DOPRI5, DOP853) of every sample.
    max_steps: attempts, refused ones included. constants_bound: how far constants of motion may move.
    """

    method: int
    depth: int
    control: Vector
    max_steps: int
    constants_bound: float


class Outcome(NamedTuple):
    """What became of every sample.

    status (n): samples that come in as not OK are skipped; steps (n): attempted ones; errors (3, n): rows
    as ConstantsError.
    """

    status: Codes
    steps: Counts
    errors: Matrix


class ConstantsError(NamedTuple, Generic[Entry]):
    """How far the constants of motion moved: relative energy; sigma3_bar and eta of one face."""

    energy: Entry
    sigma3_bar: Entry
    eta: Entry


@device
def first_step(method: int, control: float, unit: float) -> float:
    """Step to begin with. `control` is the step in units of 1/unit, or the tolerance."""
    if method in (RK4, RK8):
        return control / unit
    return 0.1 / unit


@device
def to_depth(x: State, depth: int) -> State:
    """x without what the depth does not carry."""
    return State(
        x.q,
        x.z,
        x.p,
        x.rho,
        x.sigma4,
        x.t if depth > REDUCED else 0.0,
        x.chi if depth > REDUCED else 0.0,
        x.psi if depth > REDUCED else 0.0,
        x.a1 if depth > ANGLES else 0.0,
        x.a2 if depth > ANGLES else 0.0,
    )


@device
def rk4_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    """One step: the state after it, whether it is accepted, and the step to try next; alike below.

    Call with constant depth: the compiler then drops what the depth does not need. `control` is not used here.
    """
    return to_depth(rk4_step(x, h, b), depth), True, h


@device
def rk8_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    y, _fifth, _third = eighth_order_step(x, h, b)
    return to_depth(y, depth), True, h


@device
def dop853_attempt(
    depth: int, x: State, h: float, control: float, unit: float, b: Body
) -> tuple[State, bool, float]:
    y, fifth, third = eighth_order_step(x, h, b)
    error = combined_error(norm(x, fifth, unit, b, depth), norm(x, third, unit, b, depth)) / control
    return to_depth(y, depth), error <= 1.0, limited(h * eighth_step_factor(error), longest_step(control) / unit)


@device
def dopri5_attempt(
    depth: int, x: State, h: float, control: float, unit: float, b: Body
) -> tuple[State, bool, float]:
    y, e = dopri5_step(x, h, b)
    error = norm(x, e, unit, b, depth) / control
    return to_depth(y, depth), error <= 1.0, limited(h * step_factor(error), LONGEST_STEP / unit)


@device
def limited(step: float, longest: float) -> float:
    """The step to try next, no longer than any may be."""
    return step if step < longest else longest


@device
def norm(x: State, e: State, unit: float, b: Body, depth: int) -> float:
    """Size of a local error at the depth carried."""
    if depth > ANGLES:
        return path_error_norm(x, e, unit, b)
    return error_norm(x, e, unit, b)


@subroutine
def partial_step(method: int, x: State, h: float, b: Body) -> State:
    """The state a fraction of an accepted step later, by the same method."""
    if method == RK4:
        return rk4_step(x, h, b)
    if method == DOPRI5:
        return dopri5_step(x, h, b)[0]
    return eighth_order_step(x, h, b)[0]


@device
def first_guess(x: State, end: State, h: float, stop: Stop, b: Body) -> float:
    """Length at which the cubic through both ends of a step, with their slopes, takes the value."""
    start, last = level(x, stop.event) - stop.value, level(end, stop.event) - stop.value
    leave, arrive = h * level_rate(x, stop.event, b), h * level_rate(end, stop.event, b)
    low, high = 0.0, 1.0
    u = start / (start - last) if start != last else 1.0
    for _ in range(_CUBIC_STEPS):
        v = 1.0 - u
        value = v * v * ((1.0 + 2.0 * u) * start + u * leave) + u * u * ((1.0 + 2.0 * v) * last - v * arrive)
        slope = 6.0 * u * v * (last - start) + v * (1.0 - 3.0 * u) * leave + u * (3.0 * u - 2.0) * arrive
        before = (value < 0.0) == (start < 0.0)
        low, high = u if before else low, high if before else u
        guess = u - value / slope
        # A slope of zero makes it infinite or NaN, which is not between.
        u = guess if (low <= guess) & (guess <= high) else 0.5 * (low + high)
    return h * u


@device
def approach(y: State, stop: Stop, b: Body) -> tuple[State, float]:
    """(y moved by a short step of order four to where the event takes its value by its slope, that step)."""
    left = (stop.value - level(y, stop.event)) / level_rate(y, stop.event, b)
    return rk4_step(y, left, b), left


@device
def land(y: State, h: float, stop: Stop, b: Body) -> tuple[State, bool]:
    """(the state at the event near y, found), which lies within a step of length h."""
    y, first = approach(y, stop, b)
    y, _second = approach(y, stop, b)
    y, third = approach(y, stop, b)
    # The error of the last one is below rounding.
    return y, (abs(first) <= h) & (abs(third) <= _SHORT * h)


@subroutine
def locate(method: int, x: State, end: State, h: float, stop: Stop, b: Body) -> State:
    """The state where the event takes its value within the step of length h from x to `end`, to rounding."""
    length = first_guess(x, end, h, stop, b)
    y = partial_step(method, x, length, b)
    there, found = land(y, h, stop, b)
    if found:
        return there
    return settle(method, x, h, length, stop, b)


@subroutine
def settle(method: int, x: State, h: float, length: float, stop: Stop, b: Body) -> State:
    """The state where the event takes its value, about a partial step of `length` after x, within a step of h.

    Newton's method. What is left to go is so short that a lower order adds less than rounding, so the
    located state has the accuracy of the method itself, with no interpolation error.
    """
    y = partial_step(method, x, length, b)
    low, high = 0.0, h
    below = level(x, stop.event) < stop.value
    for _ in range(LOCATE_LIMIT):
        gap = level(y, stop.event) - stop.value
        slope = level_rate(y, stop.event, b)
        left = -gap / slope
        if abs(left) <= _LAST * h:
            return shift(y, left, field(y, b))
        if (gap < 0.0) == below:
            low = length
        else:
            high = length
        guess = length + left
        if not (low < guess < high):
            guess = 0.5 * (low + high)
        left = guess - length
        if abs(left) <= _SHORTER * h:
            y = shift(y, left, field(shift(y, 0.5 * left, field(y, b)), b))
        elif abs(left) <= _SHORT * h:
            y = rk4_step(y, left, b)
        else:
            y = partial_step(method, x, guess, b)
        length = guess
    return y


@device
def constants_error(before: Constants[float], after: Constants[float], plus: bool) -> ConstantsError[float]:
    """Change of the constants of motion between two states of one motion; eta of face +1 if `plus`."""
    eta = after.eta_plus - before.eta_plus if plus else after.eta_minus - before.eta_minus
    energy = (after.energy - before.energy) / before.energy
    return ConstantsError(energy, after.sigma3_bar - before.sigma3_bar, eta)


@device
def verdict(moved: ConstantsError[float], eta: float, spin_scale: float, constants_bound: float) -> int:
    """Status of a finished sample from the change of its constants; `eta` is its exact value.

    spin_scale is sqrt(2E/I1), a bound of sigma3.
    """
    if not (abs(moved.energy) <= constants_bound and abs(moved.sigma3_bar) <= constants_bound * spin_scale):
        return _DRIFT
    if not abs(moved.eta) <= RESOLVED_SHARE * abs(eta):
        return _UNRESOLVED
    return _OK


class Ending(NamedTuple):
    """How a motion ended: its status so far, its time, the energy taken out on the way, whether it was held to
    its constants, and how far these may move."""

    code: int
    t: float
    removed: float
    held: bool
    bound: float


@subroutine
def judge(
    end: Ending, start: Constants[float], last: Constants[float], b: Body
) -> tuple[int, ConstantsError[float]]:
    """The status of a motion with these constants at its start and at its end, and their errors."""
    # It may come to both faces; whichever is nearer decides whether the direction of its races is known.
    plus, code = nearer_plus(start.eta_plus, start.eta_minus), end.code
    moved = constants_error(start, last, plus)
    energy_error = moved.energy + end.removed / start.energy
    if code == _OK and end.held:
        # The accuracy is per passage, which takes about two units of time; errors add up.
        code = _OK if abs(energy_error) <= end.bound * max(1.0, 0.5 * end.t) else _DRIFT
    elif code == _OK:
        eta = start.eta_plus if plus else start.eta_minus
        code = verdict(moved, eta, math.sqrt(2.0 * start.energy / b.I1), end.bound)
    return code, ConstantsError(energy_error, moved.sigma3_bar, moved.eta)


@device
def all_finite(x: State) -> bool:
    """False if any component is NaN or infinite."""
    total = x.q + x.z + x.p + x.rho + x.sigma4 + x.t + x.chi + x.psi + x.a1 + x.a2
    return abs(total) < math.inf

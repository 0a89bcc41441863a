"""Events: where a linear function of (q, z, p, t) takes a value, and where within a step that is.

The vertical is z = 0, a turning point p = 0, a window q = q_w, a time t = t_k. One linear form
serves them all, so lanes test for an event with four multiply-adds and no branch.
"""

from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.field import State, angles, field, reduced, shift
from kernels.steps.attempt import partial_step
from kernels.steps.fixed import rk4_step

# Newton's method on the partial step converges in 2 or 3 steps; bisection guards the rest.
LOCATE_LIMIT = 60
_CUBIC_STEPS = 3  # on the cubic, which is itself off by the fourth power of the step: more would be too good
# Shares of a step whose fifth power, third power and square are rounding.
_SHORT, _SHORTER, _LAST = 1e-3, 1e-5, 1e-8


class Event(NamedTuple):
    """Coefficients of the linear form whose value is watched."""

    q: float
    z: float
    p: float
    t: float


class Stop(NamedTuple):
    """Where the event takes a value."""

    event: Event
    value: float


TURNING_POINT = Event(0.0, 0.0, 1.0, 0.0)
TIME = Event(0.0, 0.0, 0.0, 1.0)


@device
def level(x: State, event: Event) -> float:
    """The value watched."""
    return event.q * x.q + event.z * x.z + event.p * x.p + event.t * x.t


@device
def level_rate(x: State, event: Event, b: Body) -> float:
    """Its derivative along the motion, d/ds."""
    dq, dz, dp, _drho, _dsigma4 = reduced(x, b)
    dt, _dchi, _dpsi = angles(x)
    return event.q * dq + event.z * dz + event.p * dp + event.t * dt


@device
def crossed(before: float, after: float, value: float) -> bool:
    """True where the value was reached in a step; starting on it does not count."""
    # Without `and`/`or`: lanes need straight-line code.
    return ((before - value) * (after - value) < 0.0) | ((after == value) & (before != value))


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
def step_to_event(y: State, stop: Stop, b: Body) -> tuple[State, float]:
    """(y moved by a short step of order four to where the event takes its value by its slope, that step)."""
    left = (stop.value - level(y, stop.event)) / level_rate(y, stop.event, b)
    return rk4_step(y, left, b), left


@device
def locate(y: State, h: float, stop: Stop, b: Body) -> tuple[State, bool]:
    """(the state at the event near y, found), which lies within a step of length h."""
    y, first = step_to_event(y, stop, b)
    y, _second = step_to_event(y, stop, b)
    y, third = step_to_event(y, stop, b)
    # The error of the last one is below rounding.
    return y, (abs(first) <= h) & (abs(third) <= _SHORT * h)


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
        left = -gap / level_rate(y, stop.event, b)
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

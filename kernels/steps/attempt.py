"""One attempted step of each method: the state after it, whether it is accepted, and the step to try next."""

import math
from collections.abc import Callable
from typing import Any

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.field import ANGLES, REDUCED, State
from kernels.steps.adaptive import LONGEST_STEP, dopri5_step, error_norm, step_factor
from kernels.steps.eighth import combined_error, eighth_order_step, eighth_step_factor, longest_step
from kernels.steps.fixed import rk4_step

Attempt = tuple[State, bool, float]
RK4, DOPRI5, RK8, DOP853 = range(4)  # RK8: the steps of DOP853 at a fixed length
# rad of chi in a step of a motion with its path, which chi turns: much beyond two turns errors need not fall with
# shorter steps.
MOST_TURNED = 5.0 * math.pi


@device
def first_step(method: int, control: float, unit: float) -> tuple[float, float]:
    """What attempts take as control, and the first step, from a step in units of 1/unit or a tolerance."""
    if method in (RK4, RK8):
        return control / unit, control / unit
    return control, 0.1 / unit


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
def rk4_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> Attempt:
    """One step; alike below. control: the step, or the tolerance.

    Call with constant depth: the compiler then drops what the depth does not need.
    """
    return to_depth(rk4_step(x, h, b), depth), True, control


@device
def rk8_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> Attempt:
    y, _fifth, _third = eighth_order_step(x, h, b)
    return to_depth(y, depth), True, control


@device
def dop853_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> Attempt:
    y, fifth, third = eighth_order_step(x, h, b)
    error = combined_error(error_norm(x, fifth, unit, b, depth), error_norm(x, third, unit, b, depth)) / control
    following = limited(h * eighth_step_factor(error), longest_step(control), depth, unit, b)
    return to_depth(y, depth), error <= 1.0, following


@device
def dopri5_attempt(depth: int, x: State, h: float, control: float, unit: float, b: Body) -> Attempt:
    y, e = dopri5_step(x, h, b)
    error = error_norm(x, e, unit, b, depth) / control
    return to_depth(y, depth), error <= 1.0, limited(h * step_factor(error), LONGEST_STEP, depth, unit, b)


@device
def limited(step: float, longest: float, depth: int, unit: float, b: Body) -> float:
    """The step to try next, no longer than any may be (in units of 1/unit)."""
    if depth > ANGLES:
        longest = min(longest, MOST_TURNED / b.kappa)
    return step if step < longest / unit else longest / unit


ATTEMPTS: dict[int, Callable[..., Any]] = {
    RK4: rk4_attempt,
    DOPRI5: dopri5_attempt,
    RK8: rk8_attempt,
    DOP853: dop853_attempt,
}
NAMES = {RK4: "rk4", DOPRI5: "dopri5", RK8: "rk8", DOP853: "dop853"}


@subroutine
def partial_step(method: int, x: State, h: float, b: Body) -> State:
    """The state a fraction of an accepted step later, by the same method."""
    if method == RK4:
        return rk4_step(x, h, b)
    if method == DOPRI5:
        return dopri5_step(x, h, b)[0]
    return eighth_order_step(x, h, b)[0]

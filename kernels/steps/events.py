"""Events: where a linear function of (q, z, p, t) takes a value.

The vertical is z = 0, a turning point p = 0, a window q = q_w, a time t = t_k. One linear form
serves them all, so lanes test for an event with four multiply-adds and no branch.
"""

from typing import NamedTuple

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.field import State, angles, reduced


class Event(NamedTuple):
    """Coefficients of the linear form whose value is watched."""

    q: float
    z: float
    p: float
    t: float


class Stop(NamedTuple):
    """Where a motion ends: the first time that the event takes the value."""

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

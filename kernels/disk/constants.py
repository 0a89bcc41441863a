"""Constants of motion of a state, eqs (3.5), (6.2), (2.19): algebra, no integration."""

import math
from typing import Any, Generic, NamedTuple

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.chaplygin import Solutions
from kernels.disk.elementary import EPSILON, SMALLEST, log_ratio, logarithm
from kernels.disk.field import State
from kernels.records import Entry


class MotionConstants(NamedTuple, Generic[Entry]):
    """Constants of one motion in natural units.

    rounding_plus and rounding_minus bound the rounding error of eta_plus and eta_minus: each eta is
    a difference, and below this bound a state given in doubles lies on F as far as it can tell.
    """

    sigma3_bar: Entry
    eta_plus: Entry
    eta_minus: Entry
    energy: Entry
    rounding_plus: Entry
    rounding_minus: Entry


# A dozen operations per term and the series, each half a unit in the last place.
_ULPS = 6 * EPSILON
_LN2 = math.log(2.0)
_ROOT_HALF = math.sqrt(0.5)
_SCALE, _LOG_SCALE = 2.0**54, 54.0 * _LN2  # it takes the smallest numbers to where their exponents have bits


def nearer_minus(eta_plus: Any, eta_minus: Any) -> Any:
    """True where the face of the smaller |eta| is -1; ties and NaN count as +1. Of numbers, or of arrays."""
    return abs(eta_minus) < abs(eta_plus)


@device
def depth_below_vertical(q: float, z: float) -> tuple[float, float]:
    """(S, ln S) with S = 1 - |z|, from q and z without cancellation and beyond underflow; q > 0."""
    larger, small = 1.0 + abs(z), q < SMALLEST
    log_q = logarithm(q * _SCALE if small else q) - (_LOG_SCALE if small else 0.0)
    # larger is 1 ... 2: ln(larger) = ln(larger / sqrt 2) + ln 2 / 2
    s = (larger * _ROOT_HALF - 1.0) / (larger * _ROOT_HALF + 1.0)
    return q * (q / larger), 2.0 * log_q - log_ratio(s) - 0.5 * _LN2


@device
def from_solutions(x: State, f: Solutions, E: float, b: Body) -> MotionConstants[float]:
    """Constants of the state x with energy E, f the solutions at its tilt.

    On the hemisphere of the state eta is found directly; the other one follows from
    eta_+ + eta_- = 2 I1 r'(0) sigma3_bar.
    """
    north = x.z >= 0.0
    sigma3, spin = x.q * x.rho, b.k * (x.sigma4 if north else -x.sigma4)
    sigma3_bar = b.r0 * (spin * f.D - sigma3 * f.dD)
    near = b.I1 * (sigma3 * f.drho - spin * f.rho)
    both = 2.0 * b.I1 * b.dr0 * sigma3_bar
    far = both - near
    near_rounding = _ULPS * b.I1 * (abs(sigma3 * f.drho) + abs(spin * f.rho))
    far_rounding = near_rounding + _ULPS * (abs(both) + abs(near))
    return MotionConstants(
        sigma3_bar,
        near if north else far,
        far if north else near,
        E,
        near_rounding if north else far_rounding,
        far_rounding if north else near_rounding,
    )

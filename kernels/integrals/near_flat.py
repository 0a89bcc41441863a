"""Formulas of a motion below the handover, in lanes: the potential, the turning point, the closed forms.

Here h = h_m cosh y, where h_m is the turning point. With tau = h_m sinh y and the angle gd = atan(tau / h_m),
the integrals over y of

    1/h                      gd / h_m                           the race itself
    h / (h + h_m)            y - tau / (h + h_m)                gravity's pull on it
    h ln(h/h_m) / tau^2      gd / h_m - ln(h/h_m) / tau         the spin's
    h, h ln h                tau, tau ln h - tau + h_m gd       the rest of the motion

are what the terms of first order give; the nodes of a panel bring the rest.
"""

import math
from typing import NamedTuple

from kernels._jit import contracted_device
from kernels.disk.body import Body
from kernels.disk.constants import Motion
from kernels.disk.elementary import (
    ATANH,
    ATANH_SHORT,
    EXP_SHORT,
    arctan,
    exp_fall_at_once,
    exp_fall_by,
    inverse_root,
    log_ratio_at_once,
)
from kernels.disk.falling import contracted_potential_above_flat
from kernels.disk.polynomials import horner
from kernels.integrals.tables import HANDOVER, SHORT_DEGREE, Series

_LN2 = math.log(2.0)
_LOG_HANDOVER = math.log(HANDOVER)
_LONGEST = 0.25  # step of Newton's method, in ln h


class Near(NamedTuple):
    """The motion at h <= HANDOVER: n = sigma3/q cos(theta/2) = smooth + Y D/h.

    rise: of sigma4 above its value at flat; V: amended potential above V_0; shape: cos(theta/2); shape2: its
    square.
    """

    smooth: float
    D: float
    n: float
    rise: float
    V: float
    inv_h: float
    shape2: float
    shape: float
    inv_shape: float


class Closed(NamedTuple):
    """Factors of the closed forms.

    cap: (HANDOVER + tau)/2 there; width: in y, down to the turning point or as deep as nodes go; turn2: (h_m/2)^2;
    race, pull, spin: of the first three integrals; slow: of time; rest0, rest1: of the last two.
    """

    cap: float
    log_cap: float
    width: float
    turn2: float
    race: float
    pull: float
    spin: float
    slow: float
    rest0: float
    rest1: float


class Integrals(NamedTuple):
    """Increase of chi, chi less psi, and time; or what a node adds to them."""

    chi: float
    rest: float
    time: float


class Smooth(NamedTuple):
    """Chaplygin's series at one tilt, as `chaplygin.make_series`; and 1/cos(theta/2)."""

    g: float
    drho: float
    v: float
    dv: float
    excess: float
    inv_shape: float


@contracted_device
def fall_off(d: float, low: Series) -> float:
    """exp(-d), to the digits of the series."""
    return exp_fall_by(EXP_SHORT, d) if len(low.v) == SHORT_DEGREE + 1 else exp_fall_at_once(d)


@contracted_device
def log_of_ratio(s: float, low: Series) -> float:
    """ln((1 + s)/(1 - s)), to the digits of the series."""
    if len(low.v) == SHORT_DEGREE + 1:
        return log_ratio_at_once(ATANH_SHORT, s)
    return log_ratio_at_once(ATANH, s)


@contracted_device
def tilt_of(h: float, low: Series) -> float:
    """theta of h = 2 sin(theta/2), to the digits of the series; of few digits only where h is small."""
    if len(low.v) == SHORT_DEGREE + 1:
        square = 0.25 * h * h
        return h * (1.0 + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (5.0 / 112.0))))
    return 2.0 * math.asin(0.5 * h)


@contracted_device
def joined(h: float, inv_h: float, log_h: float, f: Smooth, motion: Motion, b: Body) -> Near:
    """The motion at h from the series there."""
    x, y = motion.X, motion.Y
    S = 0.5 * h * h
    log_S = 2.0 * log_h - _LN2
    half_c, inv_k = 0.5 * b.c, 1.0 / b.k
    D = half_c * S * f.g * log_S + f.v
    dD = half_c * (f.drho * log_S + f.g) + f.dv
    rise = (x * S * f.excess + y * dD) * inv_k
    smooth = 0.5 * x * f.g * h
    n = smooth + y * inv_h * D
    shape2 = 1.0 - 0.5 * S
    shape, ratio = shape2 * f.inv_shape, n * f.inv_shape
    V, _spin = contracted_potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * x * inv_k, h * shape, b)
    return Near(smooth, D, n, rise, V, inv_h, shape2, shape, f.inv_shape)


@contracted_device
def near_flat(h: float, log_h: float, motion: Motion, b: Body, low: Series) -> Near:
    """The motion at h."""
    return near_flat_at(h, 1.0 / h, log_h, motion, b, low)


@contracted_device
def near_flat_at(h: float, inv_h: float, log_h: float, motion: Motion, b: Body, low: Series) -> Near:
    """The same where 1/h is known."""
    S = 0.5 * h * h
    t = low.per_S * S - 1.0
    excess = horner(low.excess, t)
    f = Smooth(
        g=horner(low.rho_over_S, t),
        drho=1.0 + S * excess,
        v=horner(low.v, t),
        dv=horner(low.dv, t),
        excess=excess,
        inv_shape=horner(low.inv_shape, t),
    )
    return joined(h, inv_h, log_h, f, motion, b)


@contracted_device
def slope_of(h: float, at: Near, x: float, b: Body) -> float:
    """h dV/dh."""
    z = 1.0 - 0.5 * h * h
    spin = x / b.k + at.rise
    ratio, inv_shape2 = at.n * at.inv_shape, at.inv_shape * at.inv_shape
    return h * at.inv_shape * (b.J * ratio * spin + z) - b.I1 * z * ratio * ratio * inv_shape2


@contracted_device
def newton(h: float, log_h: float, motion: Motion, b: Body, low: Series) -> tuple[float, float, float]:
    """(h, ln h, step) after one step of Newton's method in ln h towards the turning point."""
    at = near_flat(h, log_h, motion, b, low)
    step = (motion.level - at.V) / slope_of(h, at, motion.X, b)
    step = max(min(step, _LONGEST), -_LONGEST)
    return h + h * step, log_h + log_of_ratio(step / (2.0 + step), low), step


@contracted_device
def closed_forms(
    h: float, log_h: float, at: Near, slope: float, motion: Motion, b: Body, low: Series
) -> tuple[Closed, Integrals]:
    """What is known in closed form between the turning point h and the handover; slope = -h dV/dh there."""
    x, y, inv_k = motion.X, motion.Y, 1.0 / b.k
    slow = at.inv_shape * at.inv_shape * at.inv_shape / math.sqrt(slope * b.inv_M)
    race = at.D * slow
    tau = math.sqrt(HANDOVER * HANDOVER - h * h)
    # ln((HANDOVER + tau)/2) is ln(HANDOVER) + ln(1 - s) with a small s.
    s = 0.5 * (HANDOVER - tau) / HANDOVER
    cap = 0.5 * (HANDOVER + tau)
    log_cap = _LOG_HANDOVER + log_of_ratio(-s / (2.0 - s), low)
    gd = 0.5 * math.pi - arctan(h / tau)
    y_end = log_cap + _LN2 - log_h
    # M theta-dot^2 = slope tanh^2 y less 2 (h - h_m) and 2 spin ln(h/h_m), to first order
    spin = b.J * (x * inv_k + at.rise) * b.c * y * inv_k
    pull = y * race / slope
    rest0 = (x + y * (0.5 * b.c * (1.0 - _LN2) + horner(low.dv, -1.0))) * inv_k
    rest1 = y * b.c * inv_k
    fraction = _LOG_HANDOVER - log_h
    chi = (
        race * y * at.inv_h * gd
        + pull * (y_end - tau / (h + HANDOVER) - 0.5 * gd)
        + pull * spin * (0.5 * gd * at.inv_h - fraction / tau)
        + 0.5 * x * slow * tau
    )
    rest = slow * (rest0 * tau + rest1 * (tau * _LOG_HANDOVER - tau + h * gd))
    factors = Closed(cap, log_cap, y_end, 0.25 * h * h, race, pull, pull * spin, slow, rest0, rest1)
    return factors, Integrals(chi, rest, slow * tau)


class Place(NamedTuple):
    """Where a node stands, and tau there."""

    h: float
    tau: float
    log_h: float
    inv_h: float
    inv_tau2: float


@contracted_device
def place_of_node(d: float, fallen: float, known: Closed, low: Series) -> Place:
    """The node at d, in y, below the handover. fallen: exp(-d)."""
    rising = known.cap * fallen
    # h and tau are the sum and the difference of h_m e^y / 2, which is rising, and h_m e^-y / 2.
    square = rising * rising
    plus, minus, double = square + known.turn2, square - known.turn2, 2.0 * square + known.turn2
    # A division takes as long as some ten products, so four numbers share one.
    even, odd = rising * plus, minus * double
    inv = 1.0 / (even * odd)
    inv_even, inv_odd = odd * inv, even * inv
    inv_rising, inv_tau = plus * inv_even, rising * (double * inv_odd)
    log_h = known.log_cap - d + log_of_ratio(known.turn2 * (minus * inv_odd), low)
    return Place(plus * inv_rising, minus * inv_rising, log_h, rising * (rising * inv_even), inv_tau * inv_tau)


class Moving(NamedTuple):
    """The motion at a node, as `Near`; root: 1/theta-dot."""

    smooth: float
    D: float
    n: float
    spin: float
    inv_shape: float
    root: float


@contracted_device
def motion_at_node(place: Place, motion: Motion, b: Body, low: Series) -> Moving:
    """The motion at a node."""
    at = near_flat_at(place.h, place.inv_h, place.log_h, motion, b, low)
    root = inverse_root(2.0 * b.inv_M * (motion.level - at.V))
    return Moving(at.smooth, at.D, at.n, motion.X * (1.0 / b.k) + at.rise, at.inv_shape, root)


@contracted_device
def left_at_node(
    place: Place, at: Moving, motion: Motion, h_turn: float, log_turn: float, known: Closed
) -> Integrals:
    """What the closed forms leave of the integrands at a node."""
    x, y = motion.X, motion.Y
    h, tau, log_h, inv_h, inv_tau2 = place
    inv_shape2 = at.inv_shape * at.inv_shape
    w = tau * inv_h * inv_shape2 * at.inv_shape * at.root
    dt = h * w * (1.0 - 0.25 * h * h)
    log_rise = log_h - log_turn
    chi = (
        at.smooth * w
        - 0.5 * x * h * known.slow
        + y * inv_h * (at.D * w - known.race)
        - known.pull * (h * (h - h_turn) * inv_tau2 - 0.5 * h_turn * inv_h)
        - known.spin * (log_rise * h * inv_tau2 - 0.5 * inv_h)
    )
    rest = dt * (0.5 * h * at.n * inv_shape2 + at.spin) - known.slow * h * (known.rest0 + known.rest1 * log_h)
    return Integrals(chi, rest, dt - known.slow * h)

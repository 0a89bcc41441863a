"""Formulas of a motion below the handover, in lanes: the potential, the turning point, the closed forms.

Here h = h_m cosh y, where h_m is the turning point. With tau = h_m sinh y and the angle gd = atan(tau / h_m),
the integrals over y of

    1/h                      gd / h_m                           the race itself
    h / (h + h_m)            y - tau / (h + h_m)                gravity's pull on it
    h ln(h/h_m) / tau^2      gd / h_m - ln(h/h_m) / tau         the spin's
    h, h ln h                tau, tau ln h - tau + h_m gd       the rest of the motion

are what the terms of first order give; the nodes of a rule bring the rest. That falls from the handover down like
e^-2y times polynomials of y, which are smooth in v = e^(y/5) down to v = 0, however deep the motion goes.
"""

import math
from typing import NamedTuple

from kernels._jit import device
from kernels.disk.body import Body
from kernels.disk.elementary import arctan, exponential, inverse_root, log_ratio, logarithm
from kernels.disk.falling import potential_above_flat
from kernels.disk.polynomials import horner
from kernels.near_flat.tables import HANDOVER, Low

_LN2 = math.log(2.0)
_LOG_HANDOVER = math.log(HANDOVER)
_LONGEST = 0.25  # step of Newton's method, in ln h


class PassageConstants(NamedTuple):
    """Constants of one motion: X = sigma3_bar / r(0), Y = eta_+ / I1, and level = E - V_0."""

    X: float
    Y: float
    level: float


class Near(NamedTuple):
    """The motion at h <= HANDOVER: n = sigma3/q cos(theta/2) = smooth + Y D/h.

    rise: of sigma4 above its value at flat; V: amended potential above V_0; inv_shape: 1/cos(theta/2).
    """

    smooth: float
    D: float
    n: float
    rise: float
    V: float
    inv_shape: float


class Closed(NamedTuple):
    """Factors of the closed forms.

    cap: (HANDOVER + tau)/2 there; lowest: v at the turning point, of 1 there; turn2: (h_m/2)^2; race, pull, spin:
    of the first three integrals; slow: of time; rest0, rest1: of the last two.
    """

    cap: float
    log_cap: float
    lowest: float
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


@device
def near_flat(h: float, inv_h: float, log_h: float, motion: PassageConstants, b: Body, low: Low) -> Near:
    """The motion at h, from the series there."""
    x, y = motion.X, motion.Y
    S = 0.5 * h * h
    t, log_S = low.per_S * S - 1.0, 2.0 * log_h - _LN2
    g, excess, inv_shape = horner(low.rho_over_S, t), horner(low.excess, t), horner(low.inv_shape, t)
    half_c, inv_k = 0.5 * b.c, 1.0 / b.k
    D = half_c * S * g * log_S + horner(low.v, t)
    dD = half_c * ((1.0 + S * excess) * log_S + g) + horner(low.dv, t)
    rise = (x * S * excess + y * dD) * inv_k
    smooth = 0.5 * x * g * h
    n = smooth + y * inv_h * D
    q, ratio = h * (1.0 - 0.5 * S) * inv_shape, n * inv_shape
    V, _spin = potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * x * inv_k, q, b)
    return Near(smooth, D, n, rise, V, inv_shape)


@device
def slope_of(h: float, at: Near, x: float, b: Body) -> float:
    """h dV/dh."""
    z = 1.0 - 0.5 * h * h
    spin = x / b.k + at.rise
    ratio, inv_shape2 = at.n * at.inv_shape, at.inv_shape * at.inv_shape
    return h * at.inv_shape * (b.J * ratio * spin + z) - b.I1 * z * ratio * ratio * inv_shape2


@device
def newton(h: float, log_h: float, motion: PassageConstants, b: Body, low: Low) -> tuple[float, float, float]:
    """(h, ln h, step in ln h) after a step of Newton's method in 1/h^2, in which the wall of V is straight."""
    at = near_flat(h, 1.0 / h, log_h, motion, b, low)
    step = (motion.level - at.V) / slope_of(h, at, motion.X, b)
    step = max(min(step, _LONGEST), -_LONGEST)
    return h * inverse_root(1.0 - 2.0 * step), log_h - 0.5 * log_ratio(-step / (1.0 - step)), step


@device
def closed_forms(
    h: float, log_h: float, at: Near, slope: float, motion: PassageConstants, b: Body, low: Low
) -> tuple[Closed, Integrals]:
    """What is known in closed form between the turning point h and the handover; slope = -h dV/dh there."""
    x, y, inv_k = motion.X, motion.Y, 1.0 / b.k
    slow = at.inv_shape * at.inv_shape * at.inv_shape / math.sqrt(slope * b.inv_M)
    race = at.D * slow
    tau = math.sqrt(HANDOVER * HANDOVER - h * h)
    # ln((HANDOVER + tau)/2) is ln(HANDOVER) + ln(1 - s) with a small s.
    s = 0.5 * (HANDOVER - tau) / HANDOVER
    cap = 0.5 * (HANDOVER + tau)
    log_cap = _LOG_HANDOVER + log_ratio(-s / (2.0 - s))
    gd = 0.5 * math.pi - arctan(h / tau)
    y_end = log_cap + _LN2 - log_h
    # M theta-dot^2 = slope tanh^2 y less 2 (h - h_m) and 2 spin ln(h/h_m), to first order
    spin = b.J * (x * inv_k + at.rise) * b.c * y * inv_k
    pull = y * race / slope
    rest0 = (x + y * (0.5 * b.c * (1.0 - _LN2) + horner(low.dv, -1.0))) * inv_k
    rest1 = y * b.c * inv_k
    fraction = _LOG_HANDOVER - log_h
    chi = (
        race * y * gd / h
        + pull * (y_end - tau / (h + HANDOVER) - 0.5 * gd)
        + pull * spin * (0.5 * gd / h - fraction / tau)
        + 0.5 * x * slow * tau
    )
    rest = slow * (rest0 * tau + rest1 * (tau * _LOG_HANDOVER - tau + h * gd))
    lowest, _less = exponential(-0.2 * y_end)
    factors = Closed(cap, log_cap, lowest, 0.25 * h * h, race, pull, pull * spin, slow, rest0, rest1)
    return factors, Integrals(chi, rest, slow * tau)


@device
def left_over(
    v: float, h_turn: float, log_turn: float, known: Closed, motion: PassageConstants, b: Body, low: Low
) -> Integrals:
    """What the closed forms leave of the integrands where y is 5 ln(1/v) less than at the handover."""
    # h and tau are the sum and the difference of h_m e^y / 2, which is rising, and h_m e^-y / 2.
    square = v * v
    rising = known.cap * v * (square * square)
    square = rising * rising
    plus, minus, double = square + known.turn2, square - known.turn2, 2.0 * square + known.turn2
    # A division takes as long as some ten products, so four numbers share one.
    even, odd = rising * plus, minus * double
    inv = 1.0 / (even * odd)
    inv_even, inv_odd = odd * inv, even * inv
    inv_rising, inv_tau = plus * inv_even, rising * (double * inv_odd)
    h, tau, inv_h = plus * inv_rising, minus * inv_rising, rising * (rising * inv_even)
    log_h = known.log_cap + 5.0 * logarithm(v) + log_ratio(known.turn2 * (minus * inv_odd))
    at = near_flat(h, inv_h, log_h, motion, b, low)
    inv_speed = inverse_root(2.0 * b.inv_M * (motion.level - at.V))
    inv_shape2, inv_tau2 = at.inv_shape * at.inv_shape, inv_tau * inv_tau
    w = tau * inv_h * inv_shape2 * at.inv_shape * inv_speed
    dt = h * w * (1.0 - 0.25 * h * h)
    chi = (
        at.smooth * w
        - 0.5 * motion.X * h * known.slow
        + motion.Y * inv_h * (at.D * w - known.race)
        - known.pull * (h * (h - h_turn) * inv_tau2 - 0.5 * h_turn * inv_h)
        - known.spin * ((log_h - log_turn) * h * inv_tau2 - 0.5 * inv_h)
    )
    spin = motion.X * (1.0 / b.k) + at.rise
    rest = dt * (0.5 * h * at.n * inv_shape2 + spin) - known.slow * h * (known.rest0 + known.rest1 * log_h)
    return Integrals(chi, rest, dt - known.slow * h)

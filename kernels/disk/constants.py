"""Constants of motion of a state, eqs (3.5), (6.2), (2.19): algebra, no integration."""

import math
from typing import NamedTuple

from kernels._jit import device, subroutine
from kernels.disk import chaplygin
from kernels.disk.field import State, energy


class Constants(NamedTuple):
    """Constants of one motion in natural units.

    rounding_plus and rounding_minus bound the rounding error of eta_plus and eta_minus: each eta is
    a difference, and below this bound a state given in doubles lies on F as far as it can tell.
    """

    sigma3_bar: float
    eta_plus: float
    eta_minus: float
    energy: float
    rounding_plus: float
    rounding_minus: float


# A dozen operations per term and the series, each half a unit in the last place.
ULPS = 6 * 2.2e-16


@device
def depth_below_vertical(q, z):
    """(S, ln S) with S = 1 - |z|, from q and z without cancellation and beyond underflow."""
    larger = 1.0 + abs(z)
    return q * (q / larger), 2.0 * math.log(q) - math.log(larger)


@subroutine
def constants_of(x, b, series):
    """Constants of the state x, to full relative accuracy near both flat states.

    On the hemisphere of the state eta is found directly; the other one follows from
    eta_+ + eta_- = 2 I1 r'(0) sigma3_bar.
    """
    face = 1.0 if x.z >= 0.0 else -1.0
    S, log_S = depth_below_vertical(x.q, x.z)
    f = chaplygin.solutions(S, log_S, b.c, series)
    sigma3 = x.q * x.rho
    X, Y = chaplygin.constants_from_sigma(face, sigma3, x.sigma4, f, b.k)
    sigma3_bar = b.r0 * X
    near = b.I1 * Y
    both = 2.0 * b.I1 * b.dr0 * sigma3_bar
    far = both - near
    near_rounding = ULPS * b.I1 * (abs(sigma3 * f.drho) + abs(b.k * x.sigma4 * f.rho))
    far_rounding = near_rounding + ULPS * (abs(both) + abs(near))
    if face > 0.0:
        return Constants(sigma3_bar, near, far, energy(x, b), near_rounding, far_rounding)
    return Constants(sigma3_bar, far, near, energy(x, b), far_rounding, near_rounding)


# Shares of the energy: kinetic energy below which p is left alone, and the most that p is corrected by.
_MOVING, _SMALL = 0.01, 0.01


@device
def onto_energy(x, total, b):
    """(x with p set so that the energy is `total`, what was in excess); for x on its other constants.

    An energy that drifts makes the error of time and angles grow like the square of the time; held, like
    the time. (So does a symmetric method: Gauss's with two stages kept the energy to 1e-13, for 6 to 9
    times the evaluations of rk4 at the same step.) Near a turning point p cannot take the correction up;
    it waits for a later step.
    """
    excess = energy(x, b) - total
    kinetic = 0.5 * b.M * x.p * x.p
    if not (kinetic > _MOVING * total and abs(excess) < _SMALL * kinetic):
        return x, 0.0
    p = x.p * math.sqrt(1.0 - excess / kinetic)
    return State(x.q, x.z, p, x.rho, x.sigma4, x.t, x.chi, x.psi, x.a1, x.a2), excess


@subroutine
def onto_constants(x, sigma3_bar, eta_plus, eta_minus, b, series):
    """x with q^2 + z^2 = 1 restored and rho, sigma4 set to what the constants say at its tilt.

    The saddle beside flat amplifies an error in rho by 1/theta_min. Set anew after every step, rho
    never carries one: eta stays what it was given as, down to 1e-300. Needs I3 > 0.
    """
    face = 1.0 if x.z >= 0.0 else -1.0
    q, z = x.q, x.z
    if q < abs(z):
        z = face * math.sqrt((1.0 - q) * (1.0 + q))
    else:
        q = math.sqrt((1.0 - z) * (1.0 + z))
    S, log_S = depth_below_vertical(q, z)
    f = chaplygin.solutions(S, log_S, b.c, series)
    X = sigma3_bar / b.r0
    Y = (eta_plus if face > 0.0 else eta_minus) / b.I1
    _sigma3, sigma4 = chaplygin.sigma_from_constants(face, X, Y, f, b.k)
    # sigma3/q written so that S may underflow
    rho = X * f.rho_over_S * (q / (1.0 + abs(z))) + Y * (f.D / q)
    return State(q, z, x.p, rho, sigma4, x.t, x.chi, x.psi, x.a1, x.a2)

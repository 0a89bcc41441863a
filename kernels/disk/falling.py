"""The falling set F: the potential on it, and who belongs to it.

On l_+ the amended potential V(phi) of eq. (3.8) extends analytically to flat (Lemma 4). With
eta_+ = 0 the constants leave one number, X = sigma3_bar / r(0), and V = X^2 U(phi) + cos phi.
Face -1 is the mirror image (sigma1, sigma3, sigma4) -> (-sigma1, sigma3, -sigma4), eq. (3.2).
"""

import math
from typing import NamedTuple

from kernels._jit import device, kernel, subroutine
from kernels.disk import chaplygin
from kernels.disk.body import Body
from kernels.disk.constants import depth_below_vertical
from kernels.types import Matrix, Vector

# Bisection to rounding on an interval of length pi/2.
BISECTIONS = 60
_ROUNDING = 8 * 2.2e-16


class OnF(NamedTuple):
    """One point of a motion on F (face +1): sigma3/q^2, sigma4, V, dV/dphi."""

    turn: float
    sigma4: float
    V: float
    dV: float


@subroutine
def on_f(q, z, X, b, series):
    """The motion with eta_+ = 0 where cos phi = q, sin phi = z. Needs I3 > 0. Eqs (3.8), (5.9)."""
    S, log_S = depth_below_vertical(q, z)
    f = chaplygin.solutions(S, log_S, b.c, series)
    if z >= 0.0:
        turn = X * f.rho_over_S / (1.0 + z)
        sigma4 = X * f.drho / b.k
    else:
        # eta_- = 2 I1 r'(0) sigma3_bar where eta_+ = 0
        sigma3, sigma4 = chaplygin.sigma_from_constants(-1.0, X, 2.0 * b.dr0 * b.r0 * X, f, b.k)
        turn = sigma3 / (q * q)
    gyration = b.I1 * turn * turn * q
    V = 0.5 * gyration * q + 0.5 * b.J * sigma4 * sigma4 + q
    dV = gyration * z - b.J * turn * q * sigma4 - z
    return OnF(turn, sigma4, V, dV)


@device
def potential_at_flat(X, b):
    """V_0 = V(pi/2), eq. (6.9)."""
    spin = X / b.k
    return 0.5 * b.J * spin * spin


@subroutine
def critical_X2(phi, b, series):
    """The X^2 for which V has a critical point at phi < 0 (its other hemisphere)."""
    q, z = math.cos(phi), math.sin(phi)
    return z / (on_f(q, z, 1.0, b, series).dV + z)


@subroutine
def barrier_angle(X, well_phi, b, series):
    """phi of the local maximum of V between a non-falling well and the vertical; NaN if there is none.

    well_phi is where critical_X2 peaks: the well and the barrier merge there.
    """
    X2 = X * X
    if not critical_X2(well_phi, b, series) > X2:
        return math.nan
    low, high = well_phi, 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if critical_X2(middle, b, series) > X2:
            low = middle
        else:
            high = middle
    return low


@device
def reaches_flat(q, z, U, dU, energy, X, well_phi, b, series):
    """True if the component of {V < energy} that contains phi reaches phi = +pi/2, for eta_+ = 0.

    V = X^2 U + q there and dV = X^2 dU - z. From the vertical to flat V only decreases; beyond the vertical
    a barrier may stand between.
    """
    V, dV = X * X * U + q, X * X * dU - z
    # A start from rest has E = V up to rounding; it falls if V falls towards flat.
    at_rest = abs(energy - V) <= _ROUNDING * V and dV < -_ROUNDING
    if not (energy > potential_at_flat(X, b) and (energy > V or at_rest)):
        return False
    if z >= 0.0:
        return True
    phi = barrier_angle(X, well_phi, b, series)
    if not z < math.sin(phi):
        return True
    return energy > on_f(math.cos(phi), math.sin(phi), X, b, series).V


@kernel
def falls_batch(states: Matrix, constants: Matrix, well_phi: float, b: Body, series: Matrix, out: Matrix) -> None:
    """Could these states fall, were eta on that side zero?

    states (5, n) as State; constants (6, n) as Constants -> out (3, n): 1 or 0 for face +1, the same
    for face -1, and E - V_0.
    """
    q = z = math.nan
    here = there = OnF(math.nan, math.nan, math.nan, math.nan)
    for i in range(states.shape[1]):
        X = constants[0, i] / b.r0
        E = constants[3, i]
        if not (states[0, i] == q and states[1, i] == z):
            # Many draws share one tilt, the vertical above all.
            q, z = states[0, i], states[1, i]
            here, there = on_f(q, z, 1.0, b, series), on_f(q, -z, 1.0, b, series)
        plus = reaches_flat(q, z, here.V - q, here.dV + z, E, X, well_phi, b, series)
        minus = reaches_flat(q, -z, there.V - q, there.dV - z, E, X, well_phi, b, series)
        out[0, i] = 1.0 if plus else 0.0
        out[1, i] = 1.0 if minus else 0.0
        out[2, i] = E - potential_at_flat(X, b)


@kernel
def critical_X2_batch(phi: Vector, b: Body, series: Matrix, out: Vector) -> None:
    """critical_X2 at every phi < 0."""
    for i in range(phi.size):
        out[i] = critical_X2(phi[i], b, series)


@kernel
def on_f_batch(theta: Vector, X: float, b: Body, series: Matrix, out: Matrix) -> None:
    """theta (n) in (0, pi) -> out (4, n): sigma3/q^2, sigma4, V, dV/dphi on the motion with eta_+ = 0."""
    for i in range(theta.size):
        f = on_f(math.sin(theta[i]), math.cos(theta[i]), X, b, series)
        out[0, i], out[1, i], out[2, i], out[3, i] = f.turn, f.sigma4, f.V, f.dV


@kernel
def line_chart_batch(q: Vector, z: Vector, b: Body, series: Matrix, out: Matrix) -> None:
    """The linear map from (sigma3_bar, eta_hat_+) to (sigma3, sigma4) where cos phi = q, sin phi = z.

    out (4, n): sigma3 = out[0] sigma3_bar + out[1] eta_hat, sigma4 = out[2] sigma3_bar + out[3] eta_hat. Its
    determinant is -1 at every tilt: dsigma3 dsigma4 = dsigma3_bar deta_hat. Needs I3 > 0. Eqs (3.5), (6.2).
    """
    for i in range(q.size):
        S, log_S = depth_below_vertical(q[i], z[i])
        f = chaplygin.solutions(S, log_S, b.c, series)
        if z[i] >= 0.0:
            out[0, i], out[1, i] = f.rho / b.r0, b.k * b.r0 * f.D
            out[2, i], out[3, i] = f.drho / (b.k * b.r0), b.r0 * f.dD
        else:
            # Seen from the other hemisphere eta_- = 2 I1 r'(0) sigma3_bar - eta_+
            out[0, i], out[1, i] = f.rho / b.r0 + 2.0 * b.dr0 * f.D, -b.k * b.r0 * f.D
            out[2, i], out[3, i] = -(f.drho / b.r0 + 2.0 * b.dr0 * f.dD) / b.k, b.r0 * f.dD


@kernel
def barrier_batch(sigma3_bar: Vector, well_phi: float, b: Body, series: Matrix, out: Matrix) -> None:
    """out (2, n): phi and V of the barrier between the non-falling well and the vertical; NaN if none."""
    for i in range(sigma3_bar.size):
        X = sigma3_bar[i] / b.r0
        phi = barrier_angle(X, well_phi, b, series)
        out[0, i], out[1, i] = phi, math.nan
        if phi < 0.0:
            out[1, i] = on_f(math.cos(phi), math.sin(phi), X, b, series).V

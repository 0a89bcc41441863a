"""The falling set F: the potential on it, and who belongs to it.

On l_+ the amended potential V(phi) of eq. (3.8) extends analytically to flat (Lemma 4). With
eta_+ = 0 the constants leave one number, X = sigma3_bar / r(0), and V = X^2 U(phi) + cos phi.
Face -1 is the mirror image (sigma1, sigma3, sigma4) -> (-sigma1, sigma3, -sigma4), eq. (3.2).
"""

import math
from typing import Annotated, Any, Generic, NamedTuple

from numba import float64
from numba import types as nb

from kernels._jit import device, kernel, subroutine
from kernels.disk import chaplygin
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.chaplygin import Solutions
from kernels.disk.constants import depth_below_vertical
from kernels.disk.elementary import EPSILON
from kernels.disk.polynomials import horner
from kernels.records import Entry, put
from kernels.types import Matrix, Vector

# Bisection to rounding on an interval of length pi/2.
BISECTIONS = 60
_ROUNDING = 8 * EPSILON
# Of the barrier's series, at which its coefficients are at rounding.
BARRIER_DEGREE = 24
# |sigma3_bar| / sigma3_bar* this close to 1 is bisected: the series there is the square root of what is left.
_MERGING = 1e-7
# Whether a barrier is passed.
FALLS_BACK, PASSES, UNDECIDED = 0, 1, 2


class OnF(NamedTuple):
    """One point of a motion on F (face +1): sigma3/q^2, sigma4, V, dV/dphi."""

    turn: float
    sigma4: float
    V: float
    dV: float


class Tilt(NamedTuple):
    """A tilt as all motions on F see it: V = X^2 U + q and dV/dphi = X^2 dU - z there."""

    q: float
    z: float
    U: float
    dU: float


class LineChart(NamedTuple, Generic[Entry]):
    """The linear map from (sigma3_bar, eta_hat_+) to (sigma3, sigma4) at one tilt, eqs (3.5), (6.2).

    Its determinant is -1 at every tilt, so that dsigma3 dsigma4 = dsigma3_bar deta_hat.
    """

    bar_to_sigma3: Entry
    eta_hat_to_sigma3: Entry
    bar_to_sigma4: Entry
    eta_hat_to_sigma4: Entry

    def rates(self, sigma3_bar: Any, eta_hat: Any) -> tuple[Entry, Entry]:
        """sigma3 and sigma4, in natural units if the arguments are."""
        return (
            self.bar_to_sigma3 * sigma3_bar + self.eta_hat_to_sigma3 * eta_hat,
            self.bar_to_sigma4 * sigma3_bar + self.eta_hat_to_sigma4 * eta_hat,
        )


class Barrier(NamedTuple, Generic[Entry]):
    """phi and V of the barrier between the non-falling well and the vertical; NaN if there is none."""

    phi: Entry
    V: Entry


Powers = Annotated[tuple[float, ...], nb.UniTuple(float64, BARRIER_DEGREE + 1)]


class Obstacle(NamedTuple):
    """The barriers of one disk, for all sigma3_bar.

    well_phi: where critical_X2 peaks. X: sigma3_bar*/r(0), above which there is no barrier. sine, V: ascending
    powers of 2 u - 1 for sin phi and V of the barrier, u = sqrt(1 - |X| / X*). slack: a bound of their errors,
    in V relative; what lies within is bisected.
    """

    well_phi: float
    X: float
    slack: float
    sine: Powers
    V: Powers


@device
def potential_above_flat(
    gyration: float, rise: float, twice_flat: float, q: float, b: Body
) -> tuple[float, float]:
    """(V - V_0, the part of the spin in it), eq. (3.8): gyration + 1/2 J (sigma4^2 - flat^2) + q.

    gyration = 1/2 I1 (sigma3/q)^2; sigma4 = flat + rise. From the difference itself: near flat V - V_0
    is all there is. With flat = 0 it is V.
    """
    spin = 0.5 * b.J * rise * (twice_flat + rise)
    return gyration + spin + q, spin


@device
def potential_at_flat(X: float, b: Body) -> float:
    """V_0 = V(pi/2), eq. (6.9)."""
    V, _spin = potential_above_flat(0.0, X / b.k, 0.0, 0.0, b)
    return V


@device
def rates_on_f(X: float, q: float, z: float, f: Solutions, b: Body) -> tuple[float, float]:
    """(sigma3/q^2, sigma4) with eta_+ = 0 where cos phi = q, sin phi = z; f: the solutions there. Eq. (5.9)."""
    # eta_- = 2 I1 r'(0) sigma3_bar where eta_+ = 0
    sigma3, sigma4 = chaplygin.sigma_from_constants(-1.0, X, 2.0 * b.dr0 * b.r0 * X, f, b.k)
    north = z >= 0.0
    return X * f.rho_over_S / (1.0 + z) if north else sigma3 / (q * q), X * f.drho / b.k if north else sigma4


@device
def on_f(q: float, z: float, X: float, disk: NaturalDisk) -> OnF:
    """The motion with eta_+ = 0 where cos phi = q, sin phi = z. Needs I3 > 0. Eqs (3.8), (5.9)."""
    b = disk.body
    S, log_S = depth_below_vertical(q, z)
    turn, sigma4 = rates_on_f(X, q, z, chaplygin.solutions(S, log_S, b.c, disk.series), b)
    gyration = b.I1 * turn * turn * q
    V, _spin = potential_above_flat(0.5 * gyration * q, sigma4, 0.0, q, b)
    dV = gyration * z - b.J * turn * q * sigma4 - z
    return OnF(turn, sigma4, V, dV)


@subroutine
def tilt(q: float, z: float, disk: NaturalDisk) -> Tilt:
    """The tilt where cos phi = q, sin phi = z."""
    one = on_f(q, z, 1.0, disk)
    return Tilt(q, z, one.V - q, one.dV + z)


@subroutine
def critical_X2(phi: float, disk: NaturalDisk) -> float:
    """The X^2 for which V has a critical point at phi < 0 (its other hemisphere)."""
    q, z = math.cos(phi), math.sin(phi)
    return z / tilt(q, z, disk).dU


@subroutine
def barrier_angle(X: float, well_phi: float, disk: NaturalDisk) -> float:
    """phi of the local maximum of V between a non-falling well and the vertical; NaN if there is none.

    well_phi is where critical_X2 peaks: the well and the barrier merge there.
    """
    X2 = X * X
    if not critical_X2(well_phi, disk) > X2:
        return math.nan
    low, high = well_phi, 0.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if critical_X2(middle, disk) > X2:
            low = middle
        else:
            high = middle
    return low


@device
def passes_barrier(z: float, energy: float, X: float, o: Obstacle) -> int:
    """Whether a start at sin phi = z < 0 is beyond the barrier, or passes over it: by its series, in lanes too."""
    share = abs(X) / o.X
    t = 2.0 * math.sqrt(max(1.0 - share, 0.0)) - 1.0
    behind, V = z - horner(o.sine, t), horner(o.V, t)
    there = share < 1.0 - _MERGING
    beyond = share > 1.0 + _MERGING or (there and behind > o.slack)
    decided = there and behind < -o.slack and abs(energy - V) > o.slack * V
    return PASSES if beyond or (decided and energy > V) else FALLS_BACK if decided else UNDECIDED


@device
def reaches_flat(at: Tilt, energy: float, X: float, o: Obstacle, disk: NaturalDisk) -> bool:
    """True if the component of {V < energy} that contains the tilt reaches phi = +pi/2, for eta_+ = 0.

    From the vertical to flat V only decreases; beyond the vertical a barrier may stand between.
    """
    V, dV = X * X * at.U + at.q, X * X * at.dU - at.z
    # A start from rest has E = V up to rounding; it falls if V falls towards flat.
    at_rest = abs(energy - V) <= _ROUNDING * V and dV < -_ROUNDING
    if not (energy > potential_at_flat(X, disk.body) and (energy > V or at_rest)):
        return False
    if at.z >= 0.0:
        return True
    passes = passes_barrier(at.z, energy, X, o)
    if passes != UNDECIDED:
        return passes == PASSES
    return passes_bisected(at.z, energy, X, o.well_phi, disk)


@subroutine
def passes_bisected(z: float, energy: float, X: float, well_phi: float, disk: NaturalDisk) -> bool:
    """As `passes_barrier`, by bisection for the barrier."""
    phi = barrier_angle(X, well_phi, disk)
    if not z < math.sin(phi):
        return True
    return energy > on_f(math.cos(phi), math.sin(phi), X, disk).V


@kernel
def critical_X2_batch(phi: Vector, disk: NaturalDisk, out: Vector) -> None:
    """critical_X2 at every phi < 0."""
    for i in range(phi.size):
        out[i] = critical_X2(phi[i], disk)


@device
def line_chart(q: float, z: float, disk: NaturalDisk) -> LineChart[float]:
    """The chart where cos phi = q, sin phi = z. Needs I3 > 0. Eqs (3.5), (6.2)."""
    b = disk.body
    S, log_S = depth_below_vertical(q, z)
    f = chaplygin.solutions(S, log_S, b.c, disk.series)
    if z >= 0.0:
        return LineChart(f.rho / b.r0, b.k * b.r0 * f.D, f.drho / (b.k * b.r0), b.r0 * f.dD)
    # Seen from the other hemisphere eta_- = 2 I1 r'(0) sigma3_bar - eta_+
    return LineChart(
        f.rho / b.r0 + 2.0 * b.dr0 * f.D,
        -b.k * b.r0 * f.D,
        -(f.drho / b.r0 + 2.0 * b.dr0 * f.dD) / b.k,
        b.r0 * f.dD,
    )


@kernel
def line_chart_batch(q: Vector, z: Vector, disk: NaturalDisk, out: Matrix) -> None:
    """q = cos phi, z = sin phi (n) -> out (4, n), rows as LineChart."""
    for i in range(q.size):
        put(line_chart(q[i], z[i], disk), out, i)


@kernel
def barrier_batch(sigma3_bar: Vector, well_phi: float, disk: NaturalDisk, out: Matrix) -> None:
    """sigma3_bar (n) -> out (2, n), rows as Barrier."""
    for i in range(sigma3_bar.size):
        X = sigma3_bar[i] / disk.body.r0
        phi = barrier_angle(X, well_phi, disk)
        V = on_f(math.cos(phi), math.sin(phi), X, disk).V if phi < 0.0 else math.nan
        put(Barrier(phi, V), out, i)

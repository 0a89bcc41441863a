"""The regularised vector field: the flat state blown up, polynomial and bounded.

With rho = sigma3/q and dt = q ds the reduced equations (2.15)-(2.18) lose their singularity at
flat: their right-hand side becomes polynomial in (q, z, p, rho, sigma4). Time and the angles of
contact (2.22), (2.31) ride along as quadratures, and the path (2.33) on top of those.

The three depths share one State. What a caller drops (time and angles, or the path with its
sines) is dead code that the compiler removes, so a shallower model costs nothing extra.
"""

import math
from typing import Any, NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.elementary import sine_cosine
from kernels.types import Matrix


class State(NamedTuple):
    """A point of the phase space and what is carried along it, natural units.

    q, z, p, rho, sigma4: reduced motion; t, chi, psi: time and angles (rad); a1, a2: the centre.
    """

    q: float
    z: float
    p: float
    rho: float
    sigma4: float
    t: float
    chi: float
    psi: float
    a1: float
    a2: float


REDUCED, ANGLES, PATH = 5, 8, 10  # components of State that each depth needs
ROW: Any = State(*range(10))  # the row of each component in an array of states
ORIGIN = State(*(0.0,) * 10)


@device
def reduced_state(q: float, z: float, p: float, rho: float, sigma4: float) -> State:
    """The state at the start of its time, its angles and its path."""
    return State(q, z, p, rho, sigma4, 0.0, 0.0, 0.0, 0.0, 0.0)


@device
def with_reduced(x: State, q: float, z: float, p: float, rho: float, sigma4: float) -> State:
    """x with another reduced motion."""
    return State(q, z, p, rho, sigma4, x.t, x.chi, x.psi, x.a1, x.a2)


@subroutine
def column(states: Matrix, i: int) -> State:
    """The state in column i of an array with as many rows as a depth needs; what it lacks is 0."""
    depth = states.shape[0]
    return State(
        states[0, i],
        states[1, i],
        states[2, i],
        states[3, i],
        states[4, i],
        states[5, i] if depth > REDUCED else 0.0,
        states[6, i] if depth > REDUCED else 0.0,
        states[7, i] if depth > REDUCED else 0.0,
        states[8, i] if depth > ANGLES else 0.0,
        states[9, i] if depth > ANGLES else 0.0,
    )


@device
def reduced(x: State, b: Body) -> tuple[float, float, float, float, float]:
    """d/ds of (q, z, p, rho, sigma4): eqs (2.15)-(2.18), regularised."""
    qp = x.q * x.p
    return (
        x.z * qp,
        -x.q * qp,
        x.z * (x.rho * x.rho) * b.inv_kappa2 - x.q * (b.J_over_M * (x.rho * x.sigma4) + b.inv_M * x.z),
        b.k * (qp * x.sigma4) - x.z * (x.rho * x.p),
        b.inv_J * (qp * x.rho),
    )


@device
def angles(x: State) -> tuple[float, float, float]:
    """d/ds of (t, chi, psi): dt = q ds, eqs (2.31) and (2.22)."""
    return x.q, x.rho, x.z * x.rho - x.q * x.sigma4


@device
def path(x: State) -> tuple[float, float]:
    """d/ds of (a1, a2): eq. (2.33)."""
    sine, cosine = sine_cosine(x.chi)
    slide = x.p * x.q
    return (x.q * (x.sigma4 * sine + slide * cosine), x.q * (slide * sine - x.sigma4 * cosine))


@device
def field(x: State, b: Body) -> State:
    """d/ds of the whole state."""
    dq, dz, dp, drho, dsigma4 = reduced(x, b)
    dt, dchi, dpsi = angles(x)
    da1, da2 = path(x)
    return State(dq, dz, dp, drho, dsigma4, dt, dchi, dpsi, da1, da2)


@device
def shift(x: State, h: float, k: State) -> State:
    """x + h k, component by component."""
    return State(
        x.q + h * k.q,
        x.z + h * k.z,
        x.p + h * k.p,
        x.rho + h * k.rho,
        x.sigma4 + h * k.sigma4,
        x.t + h * k.t,
        x.chi + h * k.chi,
        x.psi + h * k.psi,
        x.a1 + h * k.a1,
        x.a2 + h * k.a2,
    )


@device
def energy(x: State, b: Body) -> float:
    """Total energy, eq. (2.19), in units of m g r."""
    return 0.5 * b.M * (x.p * x.p + x.rho * x.rho * b.inv_kappa2) + 0.5 * b.J * x.sigma4 * x.sigma4 + x.q


@device
def speed(x: State, b: Body) -> float:
    """sqrt(2E/M): no rate of the reduced field exceeds it by more than a factor of order one.

    Tilting moves at |p| <= speed, gyration at sqrt(I3/I1) speed or less, and where the energy is
    low q is too: gravity's rate sqrt(q/M) is below it. Steps are measured in its inverse.
    """
    return math.sqrt(2.0 * energy(x, b) * b.inv_M)


@device
def pace(x: State, b: Body) -> float:
    """A bound of rates as `speed`, which the energy of sigma4 does not raise where it cannot turn into another.

    Where I3 < I1 sigma4 turns p and rho at sqrt(I3/I1) of what its energy would give. A body with little I3 has
    most of its energy there, and steps in units of 1/speed would be several times too short.
    """
    total, spin = energy(x, b), 0.5 * b.J * x.sigma4 * x.sigma4
    within_reach = total - (1.0 - b.k) * spin + abs(x.q * x.rho * x.sigma4)
    return math.sqrt(2.0 * min(total, within_reach) * b.inv_M)

"""The rolling disk as the paper first writes it: 8 dimensions, nothing reduced or regularised.

Slow and obvious, on purpose: eqs (2.1), (2.11), (2.12) with the last term corrected to m g s x u,
and (2.13), as plain NumPy for SciPy's DOP853. It shares no code with what it checks.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PlainMotion:
    """Samples of a motion: rotation A (nt, 3, 3), centre a (nt, 3), angular velocity omega (nt, 3)."""

    disk: Any
    t: Array
    A: Array
    a: Array
    omega: Array

    @property
    def u(self) -> Array:
        """A^-1 e3, eq. (2.8)."""
        return self.A[:, 2, :]

    @property
    def v(self) -> Array:
        """A e3, eq. (2.23)."""
        return self.A[:, :, 2]

    @property
    def sigma(self) -> Array:
        """(nt, 4) by eq. (2.14)."""
        u, w = self.u, self.omega
        return np.stack(
            [u[:, 2], u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0], u[:, 0] * w[:, 0] + u[:, 1] * w[:, 1], w[:, 2]],
            axis=1,
        )

    @property
    def nu(self) -> Array:
        """The angular velocity in space, A omega."""
        turned: Array = np.einsum("nij,nj->ni", self.A, self.omega)
        return turned

    @property
    def chi(self) -> Array:
        """The angle of v, without jumps."""
        return np.unwrap(np.arctan2(self.v[:, 1], self.v[:, 0]))

    @property
    def psi(self) -> Array:
        """The angle of u, without jumps."""
        return np.unwrap(np.arctan2(self.u[:, 1], self.u[:, 0]))

    @property
    def contact(self) -> Array:
        """A s(u) + a, the lowest point of the rim."""
        return np.array([A @ rim_point(self.disk, A[2]) + a for A, a in zip(self.A, self.a, strict=True)])


def cross(a: Array, b: Array) -> Array:
    """a x b of two vectors; the same numbers as numpy's, which is made for stacks of them and ten times slower."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rim_point(disk: Any, u: Array) -> Array:
    """s(u), eq. (2.9)."""
    flat = np.array([u[0], u[1], 0.0])
    lowest: Array = -disk.r * flat / np.linalg.norm(flat)
    return lowest


def rim_velocity(disk: Any, u: Array, udot: Array) -> Array:
    """ds/dt."""
    flat, flatdot = np.array([u[0], u[1], 0.0]), np.array([udot[0], udot[1], 0.0])
    size = np.linalg.norm(flat)
    rate: Array = -disk.r * (flatdot / size - flat * (flat @ flatdot) / size**3)
    return rate


def angular_acceleration(disk: Any, u: Array, omega: Array) -> Array:
    """omega-dot from eq. (2.12), last term corrected."""
    inertia = np.array([disk.I1, disk.I1, disk.I3])
    s, udot = rim_point(disk, u), cross(u, omega)
    spin = rim_velocity(disk, u, udot) + cross(omega, s)
    right = cross(inertia * omega, omega) + disk.m * ((s @ omega) * spin + disk.g * cross(s, u))
    # The matrix is diagonal but for -m s s^T: inverted by the formula of Sherman and Morrison
    diagonal = inertia + disk.m * disk.r**2
    freely, leaning = right / diagonal, s / diagonal
    acceleration: Array = freely + disk.m * (s @ freely) / (1.0 - disk.m * (s @ leaning)) * leaning
    return acceleration


def full_energy(disk: Any, u: Array, omega: Array) -> float:
    """T + V of eqs (2.2), (2.7), the velocity of the centre from eq. (2.11)."""
    s = rim_point(disk, u)
    velocity = cross(omega, s)
    height = -s @ u
    turning = disk.I1 * (omega[0] ** 2 + omega[1] ** 2) + disk.I3 * omega[2] ** 2
    return float(0.5 * turning + 0.5 * disk.m * velocity @ velocity + disk.m * disk.g * height)


def sigma_rates(disk: Any, u: Array, omega: Array) -> Array:
    """Rates of eq. (2.14) by the chain rule from eqs (2.12), (2.13)."""
    udot, wdot = cross(u, omega), angular_acceleration(disk, u, omega)
    s2dot = udot[0] * omega[1] + u[0] * wdot[1] - udot[1] * omega[0] - u[1] * wdot[0]
    s3dot = udot[:2] @ omega[:2] + u[:2] @ wdot[:2]
    return np.array([udot[2], s2dot, s3dot, wdot[2]])


def tilting(disk: Any, state: Any) -> float:
    """The second derivative of phi at (phi, phidot, sigma3, sigma4)."""
    A, omega = start(*state)
    s2dot = sigma_rates(disk, A[2], omega)[1]
    return float((s2dot + state[1] ** 2 * np.sin(state[0])) / np.cos(state[0]))


def turn(axis: int, angle: float) -> Array:
    """The rotation about e2 or e3 by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    if axis == 2:
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation(phi: float, chi: float, psi: float) -> Array:
    """A by eq. (2.32), with the angle corrected to pi/2 - phi."""
    return turn(3, chi) @ turn(2, 0.5 * np.pi - phi) @ turn(3, -psi - np.pi)


def start(
    phi: float, phidot: float, sigma3: float, sigma4: float, chi: float = 0.0, psi: float = 0.0
) -> tuple[Array, Array]:
    """(A, omega) from the reduced state, eqs (2.20) and (2.32)."""
    A = rotation(phi, chi, psi)
    u = A[2]
    q2, sigma2 = np.cos(phi) ** 2, phidot * np.cos(phi)
    omega = np.array([(-u[1] * sigma2 + u[0] * sigma3) / q2, (u[0] * sigma2 + u[1] * sigma3) / q2, sigma4])
    return A, omega


def packed(A: Array, a: Array, omega: Array) -> Array:
    """A point of the phase space as a row of 15 numbers: A by rows, a, omega."""
    return np.concatenate([np.ravel(A), a, omega])


def rates(disk: Any, y: Array) -> Array:
    """Eqs (2.1), (2.11), (2.12) for a packed point."""
    A, omega = y[:9].reshape(3, 3), y[12:]
    u = A[2]
    adot = -A @ cross(omega, rim_point(disk, u))  # eq. (2.11): the contact point is at rest
    turning = np.stack([cross(row, omega) for row in A])
    return packed(turning, adot, angular_acceleration(disk, u, omega))


def follow(disk: Any, y0: Array, times: Array, tolerance: float = 1e-12) -> PlainMotion:
    """The motion from any packed point, by DOP853."""
    run = solve_ivp(
        lambda _t, y: rates(disk, y), (0.0, times[-1]), y0, "DOP853", times, rtol=tolerance, atol=tolerance
    )
    assert run.success
    y = run.y.T
    return PlainMotion(disk, times, y[:, :9].reshape(-1, 3, 3), y[:, 9:12], y[:, 12:])


def integrate(disk: Any, state: Any, times: Array, tolerance: float = 1e-12) -> PlainMotion:
    """The motion from (phi, phidot, sigma3, sigma4) at chi = psi = 0, centre above the origin."""
    A, omega = start(*state)
    height = np.array([0.0, 0.0, disk.r * np.cos(state[0])])
    return follow(disk, packed(A, height, omega), times, tolerance)

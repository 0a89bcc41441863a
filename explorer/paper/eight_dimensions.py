"""The rolling disk as the paper first writes it: 8 dimensions, nothing reduced or regularised.

Slow and obvious, on purpose: eqs (2.1), (2.11), (2.12) with the last term corrected to m g s x u,
and (2.13), as plain NumPy for SciPy's DOP853. It shares no code with what it checks.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp


@dataclass(frozen=True)
class PlainMotion:
    """Samples of a motion: rotation A (nt, 3, 3), centre a (nt, 3), angular velocity omega (nt, 3)."""

    disk: object
    t: np.ndarray
    A: np.ndarray
    a: np.ndarray
    omega: np.ndarray

    @property
    def u(self):
        return self.A[:, 2, :]  # A^-1 e3, eq. (2.8)

    @property
    def v(self):
        return self.A[:, :, 2]  # A e3, eq. (2.23)

    @property
    def sigma(self):
        """(nt, 4) by eq. (2.14)."""
        u, w = self.u, self.omega
        return np.stack(
            [u[:, 2], u[:, 0] * w[:, 1] - u[:, 1] * w[:, 0], u[:, 0] * w[:, 0] + u[:, 1] * w[:, 1], w[:, 2]],
            axis=1,
        )

    @property
    def chi(self):
        return np.unwrap(np.arctan2(self.v[:, 1], self.v[:, 0]))

    @property
    def psi(self):
        return np.unwrap(np.arctan2(self.u[:, 1], self.u[:, 0]))

    @property
    def contact(self):
        """A s(u) + a, the lowest point of the rim."""
        return np.array([A @ rim_point(self.disk, A[2]) + a for A, a in zip(self.A, self.a, strict=True)])


def rim_point(disk, u):
    """s(u), eq. (2.9)."""
    flat = np.array([u[0], u[1], 0.0])
    return -disk.r * flat / np.linalg.norm(flat)


def rim_velocity(disk, u, udot):
    """ds/dt."""
    flat, flatdot = np.array([u[0], u[1], 0.0]), np.array([udot[0], udot[1], 0.0])
    size = np.linalg.norm(flat)
    return -disk.r * (flatdot / size - flat * (flat @ flatdot) / size**3)


def angular_acceleration(disk, u, omega):
    """omega-dot from eq. (2.12), last term corrected."""
    inertia = np.diag([disk.I1, disk.I1, disk.I3])
    s, udot = rim_point(disk, u), np.cross(u, omega)
    sdot = rim_velocity(disk, u, udot)
    matrix = inertia + disk.m * disk.r**2 * np.eye(3) - disk.m * np.outer(s, s)
    right = (
        np.cross(inertia @ omega, omega)
        + disk.m * (s @ omega) * sdot
        + disk.m * (omega @ s) * np.cross(omega, s)
        + disk.m * disk.g * np.cross(s, u)
    )
    return np.linalg.solve(matrix, right)


def hat(w):
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def turn(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    if axis == 2:
        return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def start(phi, phidot, sigma3, sigma4, chi=0.0, psi=0.0):
    """(A, omega) from the reduced state, eqs (2.20) and (2.32) with the angle corrected to pi/2 - phi."""
    A = turn(3, chi) @ turn(2, 0.5 * np.pi - phi) @ turn(3, -psi - np.pi)
    u = A[2]
    q2, sigma2 = np.cos(phi) ** 2, phidot * np.cos(phi)
    omega = np.array([(-u[1] * sigma2 + u[0] * sigma3) / q2, (u[0] * sigma2 + u[1] * sigma3) / q2, sigma4])
    return A, omega


def integrate(disk, state, times, tolerance=1e-12):
    """The motion from (phi, phidot, sigma3, sigma4) at chi = psi = 0, centre above the origin."""
    A, omega = start(*state)
    a = np.array([0.0, 0.0, disk.r * np.cos(state[0])])

    def rate(_t, y):
        A, omega = y[:9].reshape(3, 3), y[12:]
        u = A[2]
        adot = -A @ np.cross(omega, rim_point(disk, u))  # eq. (2.11): the contact point is at rest
        return np.concatenate([(A @ hat(omega)).ravel(), adot, angular_acceleration(disk, u, omega)])

    y0 = np.concatenate([A.ravel(), a, omega])
    found = solve_ivp(rate, (0.0, times[-1]), y0, "DOP853", times, rtol=tolerance, atol=tolerance)
    assert found.success
    y = found.y.T
    return PlainMotion(disk, times, y[:, :9].reshape(-1, 3, 3), y[:, 9:12], y[:, 12:])

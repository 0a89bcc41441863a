"""What decides the misprints of the paper's sections 2 to 4: both forms against the plain motion."""

from dataclasses import dataclass
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from explorer.paper import eight_dimensions as plain
from explorer.phase.disk import Disk
from explorer.phase.states import Array

UNIFORM = Disk.uniform()
E1, E3 = np.eye(3)[0], np.eye(3)[2]
FACTOR = 100.0  # by which the printed form must be further off than the right one may be


@dataclass(frozen=True)
class Evidence:
    """Numbers that decide between two forms.

    compared: what is computed, in words. printed, right: by how much either form is off (both of the same
    quantity). bound: what the right form's may be at most, from the errors of the computation or of a limit.
    """

    compared: str
    printed: float
    right: float
    bound: float

    @property
    def decides(self) -> bool:
        return bool(self.right <= self.bound and self.printed >= FACTOR * self.bound)


def worst(values: Any) -> float:
    """Largest size."""
    return float(np.max(np.abs(values)))


@lru_cache(maxsize=1)
def tumble() -> plain.PlainMotion:
    """A motion of the uniform disk by the plain equations, 0 <= t <= 2, from upright."""
    return plain.integrate(UNIFORM, (0.0, 1.0, 1.0, 0.7), np.linspace(0.0, 2.0, 201))


@lru_cache(maxsize=1)
def keeling() -> plain.PlainMotion:
    """The fall with sigma3 = sigma4 = 0, chi = 0, psi = pi of section 3.4, stopped before flat."""
    return plain.integrate(UNIFORM, (0.2, 1.0, 0.0, 0.0, 0.0, np.pi), np.linspace(0.0, 0.8, 81))


def gravity_term() -> Evidence:
    draw = np.random.default_rng(1)
    rates: dict[float, list[float]] = {1.0: [], -1.0: []}
    for _ in range(50):
        z, angle = draw.uniform(-0.9, 0.9), draw.uniform(0.0, 2.0 * np.pi)
        q = np.sqrt(1.0 - z * z)
        u, omega = np.array([q * np.cos(angle), q * np.sin(angle), z]), draw.normal(size=3)
        for sign, found in rates.items():
            # The sign of g is the sign of the last term: it occurs nowhere else.
            pull = SimpleNamespace(m=1.0, r=1.0, g=sign, I1=UNIFORM.I1, I3=UNIFORM.I3)
            found.append(_energy_rate(u, omega, plain.angular_acceleration(pull, u, omega)))
    return Evidence(
        "largest |dE/dt| by eq. (2.12) over 50 random states, E from eqs (2.2), (2.7); m = g = r = 1",
        worst(rates[-1.0]),
        worst(rates[1.0]),
        1e-12,
    )


def _energy_rate(u: Array, omega: Array, omegadot: Array) -> float:
    inertia = np.array([UNIFORM.I1, UNIFORM.I1, UNIFORM.I3])
    udot, s = np.cross(u, omega), plain.rim_point(UNIFORM, u)
    sdot = plain.rim_velocity(UNIFORM, u, udot)
    slide = np.cross(omega, s)
    turning = (inertia * omega) @ omegadot
    moving = slide @ (np.cross(omegadot, s) + np.cross(omega, sdot))
    return float(turning + moving - sdot @ u - s @ udot)


def euler_angle() -> Evidence:
    draw = np.random.default_rng(2)
    off: dict[float, list[float]] = {1.0: [], -1.0: []}
    for _ in range(50):
        phi, chi, psi = draw.uniform(-1.4, 1.4), *draw.uniform(-np.pi, np.pi, 2)
        v = np.array([np.cos(phi) * np.cos(chi), np.cos(phi) * np.sin(chi), np.sin(phi)])
        u = np.array([np.cos(phi) * np.cos(psi), np.cos(phi) * np.sin(psi), np.sin(phi)])
        for sign, found in off.items():
            A = plain.turn(3, chi) @ plain.turn(2, 0.5 * np.pi + sign * phi) @ plain.turn(3, -psi - np.pi)
            found.append(max(worst(A @ E3 - v), worst(A.T @ E3 - u)))
    return Evidence(
        "A built from the angles: largest difference of A e3 from v and of A^-1 e3 from u, eqs (2.30), (2.21)",
        worst(off[1.0]),
        worst(off[-1.0]),
        1e-14,
    )


def contact_point() -> Evidence:
    here = tumble()
    z, q = here.sigma[:, 0, None], np.sqrt(1.0 - here.sigma[:, 0, None] ** 2)
    return Evidence(
        "contact point against A s(u) + a, eq. (2.34), along a motion by the plain equations (radii)",
        worst(z * here.v / q + here.a - here.contact),
        worst((z * here.v - E3) / q + here.a - here.contact),
        1e-8,
    )


def excluded_attitudes() -> Evidence:
    """s(u), eq. (2.9), must have one value near every attitude that is let in."""
    small, draw = 1e-9, np.random.default_rng(3)

    def jump(u: Array) -> float:
        one, other = (plain.rim_point(UNIFORM, u + small * np.eye(3)[axis]) for axis in (0, 1))
        return worst(one - other)

    z, angle = draw.uniform(-0.999, 0.999, 50), draw.uniform(0.0, 2.0 * np.pi, 50)
    q = np.sqrt(1.0 - z * z)
    others = np.stack([q * np.cos(angle), q * np.sin(angle), z], axis=1)
    return Evidence(
        "jump of s(u) within 1e-9: at A e3 = -e3, which is let in, and largest of 50 other attitudes (radii)",
        jump(-E3),
        max(jump(u) for u in others),
        1e-6,
    )


def special_sigma1() -> Evidence:
    """V = m g a3 is m g r cos phi by either; a3 is that of the motion."""
    fall = keeling()
    sigma1, height = fall.u[:, 2], fall.a[:, 2]
    return Evidence(
        "height a3 of the fall with sigma3 = sigma4 = 0 by the plain equations against r cos phi, where "
        "cos phi = sigma1, or sin phi = sigma1 (radii)",
        worst(height - sigma1),
        worst(height - np.sqrt(1.0 - sigma1**2)),
        1e-10,
    )


def special_contact() -> Evidence:
    fall = keeling()
    lever = fall.A[0] @ E1
    return Evidence(
        "p(t) of the fall with sigma3 = sigma4 = 0 by the plain equations against -+ r A(0) e1 + a(0) (radii)",
        worst(fall.contact - (fall.a[0] - lever)),
        worst(fall.contact - (fall.a[0] + lever)),
        1e-10,
    )


def special_centre() -> Evidence:
    fall = keeling()
    centre, lever = fall.a - fall.contact[0], fall.A @ E1
    return Evidence(
        "a(t) of the same fall, contact point moved to 0, against +- r A(t) e1 (radii)",
        worst(centre - lever),
        worst(centre + lever),
        1e-10,
    )


def field_C() -> Evidence:
    """Along solutions of eq. (4.2), by central differences of fourth order."""
    c, d, h, off = 4.0 / 3.0, 2.0 / 3.0, 5e-4, {"printed": [0.0], "right": [0.0]}
    for z, x, y in ((0.3, 0.8, -0.5), (-0.5, 0.4, 0.9), (0.7, -1.1, 0.2)):
        rate = sum(weight * _W_at(c, d, (z, x, y), k * h) for k, weight in ((1, 8), (-1, -8), (2, -1), (-2, 1)))
        q2 = 1.0 - z * z
        common = d * x * x * z / q2**2 - z / np.sqrt(q2) + d * x * y / q2
        off["printed"].append(common + c / q2 * y - rate / (12.0 * h))
        off["right"].append(common + c / q2 * x * y - rate / (12.0 * h))
    return Evidence(
        "C W against the derivative of W along solutions of eq. (4.2), at three points",
        worst(off["printed"]),
        worst(off["right"]),
        1e-8,
    )


def _W_at(c: float, d: float, point: tuple[float, float, float], step: float) -> float:
    z, x, y = point
    found = solve_ivp(
        lambda z, w: (w[1], c * w[0] / (1.0 - z * z)), (z, z + step), (x, y), "DOP853", rtol=1e-13, atol=1e-14
    )
    (x, y), q2 = found.y[:, -1], 1.0 - (z + step) ** 2
    return float(0.5 * d * x * x / q2 + 0.5 * y * y + np.sqrt(q2))


def energy_of_phi() -> Evidence:
    """Proposition 1's E, with V the rest of eq. (2.19)."""
    here = tumble()
    z, sigma2, sigma3, sigma4 = here.sigma.T
    q2 = 1.0 - z * z
    phidot2, V = sigma2**2 / q2, 0.5 * UNIFORM.I1 * sigma3**2 / q2 + 0.5 * 1.5 * sigma4**2 + np.sqrt(q2)
    printed, right = 0.5 * phidot2 + V, 0.5 * (UNIFORM.I1 + 1.0) * phidot2 + V
    return Evidence(
        "change of E along a motion by the plain equations, uniform disk, m = g = r = 1",
        float(np.ptp(printed)),
        float(np.ptp(right)),
        1e-8,
    )


def contact_angle() -> Evidence:
    """Angle of p - a while phi > 0, which has a limit at flat."""
    here = tumble()
    upper = here.u[:, 2] > 0.1
    arm = (here.contact - here.a)[upper]
    turned = np.exp(1j * (np.arctan2(arm[:, 1], arm[:, 0]) - here.chi[upper]))
    return Evidence(
        "angle of p - a less chi + pi, or less chi, while phi > 0, by the plain equations (rad)",
        float(np.min(abs(np.angle(-turned)))),
        worst(np.angle(turned)),
        1e-9,
    )

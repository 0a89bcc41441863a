"""Section 2 of the paper: the equations of motion, their symmetries, and the reconstruction.

The eight-dimensional equations, the explorer's integrators and algebra check each other.
"""

from collections.abc import Iterator
from functools import lru_cache
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.legendre import leggauss
from scipy.spatial.transform import Rotation

from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import (
    HOOP,
    MATCHING,
    OF_BODIES,
    ROUNDING,
    SOLVER,
    UNIFORM,
    WITH_UNITS,
    at_most,
    distance,
    followed,
    largest,
    near,
    random_ones,
    sample,
    worst,
)
from explorer.paper.four_dimensions import sigma_at, sigma_energy, sigma_rates
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.states import Array


@lru_cache
def tumble(disk: Disk) -> tuple[plain.PlainMotion, SimpleNamespace]:
    """One motion by the plain equations and by the explorer, 2.5 units of time long."""
    times = np.linspace(0.0, 2.5 * disk.time_unit, 26)
    return plain.integrate(disk, sample(disk), times), followed(disk, sample(disk), times)


def inertia_tensor(points: Array, masses: Array) -> Array:
    """Moments of inertia of point masses; points (n, 3)."""
    squares = (points * points).sum(axis=1)
    inertia: Array = (masses * squares).sum() * np.eye(3) - np.einsum("n,ni,nj->ij", masses, points, points)
    return inertia


def rings(radii: Array, heights: Array, masses: Array) -> tuple[Array, Array]:
    """Points and masses of a body of revolution made of rings; eight points stand for a ring exactly."""
    angle = 0.25 * np.pi * np.arange(8)[None, :] + 0.1
    columns = radii[:, None] * np.cos(angle), radii[:, None] * np.sin(angle), heights[:, None] + 0.0 * angle
    return np.stack(columns, axis=-1).reshape(-1, 3), np.repeat(masses / 8.0, 8)


@statement(1, "EQ-2.3")
def inertia() -> Iterator[Finding]:
    """(2.2)–(2.6): 0 ≤ I₃ ≤ 2I₁ with equality for planar bodies only; uniform 1/4, 1/2; hoop 1/2, 1."""
    x, w = leggauss(8)
    for disk, inner in ((UNIFORM, 0.0), (HOOP, 1.0), (MATCHING, 3.0**-0.5)):
        radii = inner + 0.5 * (1.0 - inner) * (1.0 + x)
        masses = w * radii / (w * radii).sum()
        tensor = inertia_tensor(*rings(radii, 0.0 * radii, masses))
        text = f"I₁, I₃ of the {disk.name} body, mass summed over rings from {inner:.4f} r to r"
        yield near(text, np.diag(tensor)[[0, 2]], [disk.I1, disk.I3], 1e-14, ROUNDING)
        off = distance(tensor, np.diag([disk.I1, disk.I1, disk.I3]))
        yield near("all of this tensor less diag(I₁, I₁, I₃)", off, 0.0, 1e-14, ROUNDING)
    rng = np.random.default_rng(1)
    excess: tuple[list[float], list[float]] = ([], [])
    for _ in range(200):
        radii, heights, masses = rng.uniform(0.0, 1.0, (3, 5))
        for z, kept in zip((heights - 0.5, 0.0 * heights), excess, strict=True):
            tensor = inertia_tensor(*rings(radii, z, masses))
            kept.append(tensor[2, 2] / tensor[0, 0] - 2.0)
    yield at_most("largest I₃/I₁ − 2 of 200 thick bodies of revolution", np.max(excess[0]), 0.0, "a sign")
    furthest = max(excess[1], key=abs)
    yield near("I₃/I₁ of the same bodies pressed flat, furthest from 2", 2.0 + furthest, 2.0, 1e-14, ROUNDING)


@statement(2, "EQ-2.11")
def constraints() -> Iterator[Finding]:
    """(2.10), (2.11): along a motion a₃ = r cos φ, and the point of the disk in contact is at rest."""

    def gaps(disk: Disk) -> tuple[float, float]:
        end = 1.5 * disk.time_unit
        times = 0.5 * end * (1.0 + chebpts1(40))
        full, path = plain.integrate(disk, sample(disk), times), followed(disk, sample(disk), times).path
        height = distance(full.a[:, 2], disk.r * np.sqrt(1.0 - full.u[:, 2] ** 2)) / disk.r
        columns = [Chebyshev.fit(times, column, 39, domain=[0.0, end]) for column in path.T]
        velocity = np.stack([column.deriv()(times) for column in columns], axis=1)
        rows = zip(full.A, full.omega, strict=True)
        rim = np.array([A @ np.cross(omega, plain.rim_point(disk, A[2])) for A, omega in rows])
        return height, distance(velocity, -rim) / (disk.r * disk.rate_unit)

    height, speed = worst(gaps)
    why = "relative tolerance 1e-12 over some hundred steps"
    yield near(f"|a₃ − r cos φ|/r along motions in 8 dimensions, {OF_BODIES}", height, 0.0, 1e-10, why)
    text = "speed of the body point in contact: path of the explorer, differentiated; rotation by (2.12)"
    why = "a derivative of degree 39 multiplies the path's 1e-11 by less than 39²"
    yield near(text, speed, 0.0, 1e-8, why)
    rng = np.random.default_rng(3)
    z, angle = rng.uniform(-0.999, 0.999, 50), rng.uniform(0.0, 2.0 * np.pi, 50)
    others = np.sqrt(1.0 - z * z)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    jumps = largest(_jump(np.array([*u, height])) for u, height in zip(others, z, strict=True))
    text = "jump of s(u), (2.9), in radii, between attitudes 1e-9 apart; as printed, A e₃ = −e₃ is admitted too"
    yield at_most(text, jumps, 1e-6, "1e-9 over cos φ", {"2.2, 2.4": _jump(np.array([0.0, 0.0, -1.0]))})


def _jump(u: Array) -> float:
    """How far two values of s are apart, each 1e-9 from u."""
    one, other = (plain.rim_point(UNIFORM, u + 1e-9 * np.eye(3)[axis]) for axis in (0, 1))
    return distance(one, other)


@statement(3, "EQ-2.12")
def reduction() -> Iterator[Finding]:
    """(2.12) [corrected: m g s×u] gives the reduced equations (2.15)–(2.18)."""
    apart = []
    for disk, _state, A, omega in random_ones(3, 200, 1.4):
        u = A[2]
        sigma = np.array([u[2], u[0] * omega[1] - u[1] * omega[0], u[:2] @ omega[:2], omega[2]])
        wanted = sigma_rates(disk, sigma)
        apart.append(distance(plain.sigma_rates(disk, u, omega), wanted) / np.abs(wanted).max())
    text = "relative distance of the rates of σ₁ to σ₄, 200 random bodies and states"
    yield near(text, np.max(apart), 0.0, 1e-13, "rounding; near flat 1 − σ₁² loses up to two digits")


@statement(4, "EQ-2.19")
def energy() -> Iterator[Finding]:
    """(2.19) is the energy T + V, and it is conserved."""
    apart = [
        plain.full_energy(disk, A[2], omega) / sigma_energy(disk, sigma_at(*state)) - 1.0
        for disk, state, A, omega in random_ones(4, 100)
    ]
    yield near("(2.19) over T + V of (2.2), (2.7), less 1, 100 states", distance(apart, 0.0), 0.0, 1e-13, ROUNDING)

    def constants_error(disk: Disk, full: plain.PlainMotion) -> float:
        values = sigma_energy(disk, full.sigma.T)
        return distance(values / values[0], 1.0)

    relative = worst(lambda disk: constants_error(disk, tumble(disk)[0]))
    lifted = plain.integrate(_lifted(UNIFORM), sample(UNIFORM), tumble(UNIFORM)[0].t)
    text = f"relative change of E along motions in 8 dimensions, {OF_BODIES}; as printed, gravity pulls up"
    yield near(text, relative, 0.0, 1e-10, "rtol 1e-12", {"(2.12), last term": constants_error(UNIFORM, lifted)})


def _lifted(disk: Disk) -> Any:
    """The disk as eq. (2.12) has it in print: the sign of g is that of the last term, where alone it occurs."""
    return SimpleNamespace(m=disk.m, r=disk.r, g=-disk.g, I1=disk.I1, I3=disk.I3)


@statement(5, "EQUIVARIANCE")
def equivariance() -> Iterator[Finding]:
    """2.3: motions go to motions under E(2) in space and under rotations S¹ of the body."""
    B, C, b = plain.turn(3, 2.3), plain.turn(3, -1.1), np.array([0.7, -1.9, 0.0])

    def moved(y: Array, shift: Array = b) -> Array:
        return plain.packed(B @ y[:9].reshape(3, 3) @ C.T, B @ y[9:12] + shift, C @ y[12:])

    def gaps(disk: Disk) -> tuple[float, float]:
        A, omega = plain.start(*[*sample(disk), 0.4, -0.9])
        y = plain.packed(A, np.array([0.1, 0.2, disk.r * np.cos(sample(disk)[0])]), omega)
        carried = moved(plain.rates(disk, y), 0.0 * b)
        runs = [plain.follow(disk, start, np.array([0.0, 2.0 * disk.time_unit])) for start in (y, moved(y))]
        ends = [plain.packed(run.A[-1], run.a[-1], run.omega[-1]) for run in runs]
        fields = distance(plain.rates(disk, moved(y)), carried) / disk.rate_unit**2
        return fields, distance(moved(ends[0]), ends[1]) / max(1.0, disk.rate_unit)

    fields, ends = worst(gaps)
    text = f"the vector field before and after a motion of plane and body, {OF_BODIES}"
    yield near(text, fields, 0.0, 1e-13, ROUNDING)
    yield near("states after two units of time", ends, 0.0, 1e-9, "two integrations at 1e-12, errors grown")
    times, turn = np.linspace(0.0, 2.0, 9), plain.turn(3, 0.8)
    first, turned = (followed(UNIFORM, sample(UNIFORM), times, chi0=chi).path for chi in (0.0, 0.8))
    text = "the explorer's path with χ(0) = 0.8 less the turned path"
    yield near(text, distance(first @ turn.T, turned), 0.0, 1e-12, ROUNDING)


def spherical(first: Any, angle: Any) -> Array:
    """Unit vectors of eqs (2.21), (2.30), (n, 3)."""
    return np.stack([np.cos(first) * np.cos(angle), np.cos(first) * np.sin(angle), np.sin(first)], axis=-1)


def space_velocity(v: Array, sigma: Array) -> Array:
    """nu by eqs (2.27), (2.29); v (n, 3), sigma (n, 4)."""
    s1, s2, s3, s4 = sigma.T
    q2 = 1.0 - s1 * s1
    a, b = s4 - s1 * s3 / q2, s2 / q2
    return np.stack([a * v[:, 0] + b * v[:, 1], -b * v[:, 0] + a * v[:, 1], s3 + s1 * s4], axis=1)


def body_velocity(u: Array, sigma: Array) -> Array:
    """omega by eq. (2.20)."""
    s1, s2, s3, s4 = sigma.T
    q2 = 1.0 - s1 * s1
    return np.stack([(-u[:, 1] * s2 + u[:, 0] * s3) / q2, (u[:, 0] * s2 + u[:, 1] * s3) / q2, s4], axis=1)


@statement(6, "EQ-2.20")
def reconstruction() -> Iterator[Finding]:
    """(2.20), (2.22), (2.27)–(2.29), (2.31), (2.33): σ and integrals of it give the whole motion back."""

    def gaps(disk: Disk) -> dict[str, float]:
        full, run = tumble(disk)
        unit = disk.rate_unit
        sigma = sigma_at(run.phi, run.phidot, run.sigma3, run.sigma4).T
        u, v = spherical(run.phi, run.psi), spherical(run.phi, run.chi)
        return {
            "u by (2.21), ψ from (2.22)": distance(u, full.u),
            "v by (2.30), χ from (2.31)": distance(v, full.v),
            "ω by (2.20)": distance(body_velocity(u, sigma), full.omega) / unit,
            "ν by (2.27), (2.29)": distance(space_velocity(v, sigma), full.nu) / unit,
            "⟨ν, v⟩ − σ₄, (2.28)": distance((full.nu * full.v).sum(axis=1), sigma[:, 3]) / unit,
            "centre by (2.33)": distance(run.path, full.a) / disk.r,
            "contact point": distance(run.contact, full.contact) / disk.r,
        }

    found = [gaps(disk) for disk in WITH_UNITS]
    for name in found[0]:
        text = f"{name}, the explorer against the motion in 8 dimensions"
        yield near(text, largest(each[name] for each in found), 0.0, 1e-9, SOLVER)


def euler_rotation(chi: Array, tilt: Array, psi: Array) -> Array:
    """About e3 by -psi - pi, then e2 by tilt, then e3 by chi, (n, 3, 3); by SciPy."""
    turn: Array = Rotation.from_euler("ZYZ", np.stack([chi, tilt, -psi - np.pi], axis=1)).as_matrix()
    return turn


@statement(7, "EQ-2.32")
def euler_angles() -> Iterator[Finding]:
    """(2.32) [corrected: π/2 − φ]: −ψ − π, π/2 − φ and χ are Euler angles of A."""
    rng = np.random.default_rng(7)
    phi, chi, psi = rng.uniform(-1.5, 1.5, 500), rng.uniform(-3, 3, 500), rng.uniform(-3, 3, 500)
    A, printed = (euler_rotation(chi, 0.5 * np.pi + sign * phi, psi) for sign in (-1.0, 1.0))
    v, u, why = spherical(phi, chi), spherical(phi, psi), "rounding of three rotations"
    apart, off = (distance(B[:, :, 2], v) for B in (A, printed))
    text = "A e₃ minus v of (2.30), at 500 random angles; as printed, with the rotation by φ + π/2"
    yield near(text, apart, 0.0, 2e-15, why, {"(2.32) and end of 3.4": off})
    yield near("A⁻¹ e₃ less u of (2.21), 500 random angles", distance(A[:, 2, :], u), 0.0, 2e-15, why)

    def gap(disk: Disk) -> float:
        full, run = tumble(disk)
        return distance(euler_rotation(run.chi, 0.5 * np.pi - run.phi, run.psi), full.A)

    yield near("A from the explorer's angles minus A of the motion in 8 dimensions", worst(gap), 0.0, 1e-9, SOLVER)


def contact_from_normal(disk: Disk, v: Array, a: Array) -> Array:
    """Eq. (2.35) corrected, (n, 3)."""
    q = np.sqrt(1.0 - v[:, 2] ** 2)
    contact: Array = disk.r * (v[:, 2:] * v - np.array([0.0, 0.0, 1.0])) / q[:, None] + a
    return contact


@statement(8, "EQ-2.35")
def contact_point() -> Iterator[Finding]:
    """(2.34), (2.35) [corrected: σ₁v − e₃] both give the point of contact, at height 0."""
    rng = np.random.default_rng(8)
    disk = WITH_UNITS[3]
    A = Rotation.random(500, random_state=8).as_matrix()
    A = A[abs(A[:, 2, 2]) < 0.999]
    q = np.hypot(A[:, 2, 0], A[:, 2, 1])
    a = np.column_stack([rng.uniform(-1, 1, (len(A), 2)), disk.r * q])
    first = np.array([B @ plain.rim_point(disk, B[2]) for B in A]) + a
    second = contact_from_normal(disk, A[:, :, 2], a)
    printed = second + disk.r * np.outer(1.0 / q, [0.0, 0.0, 1.0])
    gap, off = (distance(first, other) / disk.r for other in (second, printed))
    text = "(2.34) minus (2.35), random rotations, in r; as printed, without e₃"
    why = "rounding over cos² φ, which is 0.002 at the least"
    yield near(text, gap, 0.0, 5e-13, why, {"(2.35)": off})
    yield near("height by (2.34) in r", distance(first[:, 2], 0.0) / disk.r, 0.0, 5e-13, why)

    def depth(disk: Disk) -> float:
        """How far the rim reaches below the contact point, all round, along a motion."""
        full, _ = tumble(disk)
        angle = np.linspace(0.0, 2.0 * np.pi, 721)
        rim = disk.r * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        height = np.einsum("nj,jk->nk", full.A[:, 2, :], rim) + full.a[:, 2:]
        return float(np.max(contact_from_normal(disk, full.v, full.a)[:, 2] - height.min(axis=1))) / disk.r

    yield at_most("depth of the rim below the contact point, in r", worst(depth), 1e-10, "rtol 1e-12")

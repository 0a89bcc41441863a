"""Section 2 of the paper as code: the equations of motion, their symmetries, and the reconstruction.

The eight-dimensional equations (`plain`), the integrators (`ex.simulate`) and algebra check each other.
"""

from collections.abc import Iterator

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import explorer as ex
from explorer.paper import eight_dimensions as plain
from explorer.paper.equations import (
    BODIES,
    OF_BODIES,
    ROUNDING,
    SOLVER,
    body_velocity,
    both,
    far,
    followed,
    full_energy,
    full_motion,
    full_rates,
    largest,
    plain_sigma_rates,
    random_body,
    random_state,
    sample,
    sigma_at,
    sigma_energy,
    sigma_rates,
    space_velocity,
    spherical,
    worst,
)
from explorer.paper.statement import Finding, statement

_Array = NDArray[np.float64]


def inertia_tensor(points: _Array, masses: _Array) -> _Array:
    """Moments of inertia of point masses; points (n, 3)."""
    squares = (points * points).sum(axis=1)
    return (masses * squares).sum() * np.eye(3) - np.einsum("n,ni,nj->ij", masses, points, points)


def rings(radii: _Array, heights: _Array, masses: _Array) -> tuple[_Array, _Array]:
    """Points and masses of a body of revolution made of rings; eight points stand for a ring exactly."""
    angle = 0.25 * np.pi * np.arange(8)[None, :] + 0.1
    columns = radii[:, None] * np.cos(angle), radii[:, None] * np.sin(angle), heights[:, None] + 0.0 * angle
    return np.stack(columns, axis=-1).reshape(-1, 3), np.repeat(masses / 8.0, 8)


@statement(
    1, "EQ-2.3", "(2.2)-(2.6): 0 <= I3 <= 2 I1 with equality for planar bodies only; uniform 1/4, 1/2; hoop 1/2, 1"
)
def inertia() -> Iterator[Finding]:
    x, w = leggauss(8)
    for disk, inner in ((BODIES[0], 0.0), (BODIES[1], 1.0), (BODIES[2], 3.0**-0.5)):
        half = 0.5 * (1.0 - inner)
        radii = inner + half * (1.0 + x)
        masses = w * radii / (w * radii).sum()
        tensor = inertia_tensor(*rings(radii, 0.0 * radii, masses))
        wanted = np.diag([disk.I1, disk.I1, disk.I3])
        yield Finding(
            f"I1, I3 of the {disk.name} body, mass summed over rings from {inner:.4f} r to r",
            (float(tensor[0, 0]), float(tensor[2, 2])),
            (disk.I1, disk.I3),
            far(tensor, wanted),
            1e-14,
            ROUNDING,
        )
    rng = np.random.default_rng(1)
    excess: list[float] = []
    planar: list[float] = []
    for _ in range(200):
        radii, heights, masses = rng.uniform(0.0, 1.0, (3, 5))
        for z, kept in ((heights - 0.5, excess), (0.0 * heights, planar)):
            tensor = inertia_tensor(*rings(radii, z, masses))
            kept.append(tensor[2, 2] / tensor[0, 0] - 2.0)
    yield Finding(
        "largest I3/I1 - 2 of 200 thick bodies of revolution",
        largest(excess),
        "< 0",
        largest(excess),
        0.0,
        "strict",
    )
    yield Finding(
        "I3/I1 of the same bodies pressed flat", 2.0 + largest(planar), 2.0, far(planar, 0.0), 1e-14, ROUNDING
    )


@statement(
    2, "EQ-2.11", "(2.10), (2.11): along a motion a3 = r cos phi, and the point of the disk in contact is at rest"
)
def constraints() -> Iterator[Finding]:
    def gaps(disk: ex.Disk) -> tuple[float, float]:
        end = 1.5 * disk.time_unit
        times = 0.5 * end * (1.0 + chebpts1(40))
        full, run = both(disk, sample(disk), times)
        height = far(full.a[:, 2], disk.r * np.sqrt(1.0 - full.u[:, 2] ** 2)) / disk.r
        columns = [Chebyshev.fit(times, column, 39, domain=[0.0, end]) for column in run.path[0].T]
        velocity = np.stack([column.deriv()(times) for column in columns], axis=1)
        rows = zip(full.A, full.omega, strict=True)
        rim = np.array([A @ np.cross(omega, plain.rim_point(disk, A[2])) for A, omega in rows])
        return height, far(velocity + rim, 0.0) / (disk.r * disk.rate_unit)

    found = np.array([gaps(disk) for disk in BODIES]).max(axis=0)
    yield Finding(
        f"|a3 - r cos phi|/r along the eight-dimensional motion: {OF_BODIES}",
        found[0],
        0.0,
        found[0],
        1e-10,
        "relative tolerance 1e-12 over some hundred steps",
    )
    yield Finding(
        "speed of the body point in contact: centre's path by ex.simulate, differentiated; rotation by (2.12)",
        found[1],
        0.0,
        found[1],
        1e-8,
        "a derivative of degree 39 multiplies the path's 1e-11 by less than 39^2",
    )


@statement(3, "EQ-2.12", "(2.12) [corrected: m g s x u] gives the reduced equations (2.15)-(2.18)")
def reduction() -> Iterator[Finding]:
    rng = np.random.default_rng(3)
    apart = []
    for _ in range(200):
        disk = random_body(rng)
        state = random_state(rng, disk, 1.4)
        A, omega = plain.start(*[*state, *rng.uniform(-3.0, 3.0, 2)])
        u = A[2]
        sigma = np.array([u[2], u[0] * omega[1] - u[1] * omega[0], u[:2] @ omega[:2], omega[2]])
        one, other = plain_sigma_rates(disk, u, omega), sigma_rates(disk, sigma)
        apart.append(far(one, other) / np.abs(other).max())
    yield Finding(
        "relative distance of the rates of sigma_1..4, 200 random bodies and states",
        largest(apart),
        0.0,
        largest(apart),
        1e-13,
        "rounding; near flat 1 - sigma_1^2 loses up to two digits",
    )


@statement(4, "EQ-2.19", "(2.19) is the energy T + V, and it is conserved")
def energy() -> Iterator[Finding]:
    rng = np.random.default_rng(4)
    apart = []
    for _ in range(100):
        disk = random_body(rng)
        state = random_state(rng, disk)
        A, omega = plain.start(*state)
        sigma = sigma_at(*state)
        apart.append(far(full_energy(disk, A[2], omega) / sigma_energy(disk, sigma), 1.0))
    yield Finding(
        "(2.19) over T + V of (2.2), (2.7), 100 states", largest(apart), 0.0, largest(apart), 1e-13, ROUNDING
    )

    def drift(disk: ex.Disk) -> float:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 2.5 * disk.time_unit, 26))
        values = sigma_energy(disk, full.sigma.T)
        return far(values / values[0], 1.0)

    found = worst(drift)
    yield Finding(
        f"relative drift along the eight-dimensional motion: {OF_BODIES}", found, 0.0, found, 1e-10, "rtol 1e-12"
    )
    steps = 2.0 / np.array([25, 50, 100, 200, 400])
    drifts = [_runge_kutta_drift(BODIES[0], h) for h in steps]
    order = float(np.polyfit(np.log(steps[1:]), np.log(drifts[1:]), 1)[0])
    yield Finding(
        "order of the drift in the step of the classical Runge-Kutta method, steps 0.04 to 0.005",
        order,
        4.0,
        abs(order - 4.0),
        0.15,
        "terms of the next order at the largest step",
    )


def _runge_kutta_drift(disk: ex.Disk, h: float) -> float:
    x = sigma_at(*sample(disk))
    begin, most = sigma_energy(disk, x), 0.0
    for _ in range(round(2.0 / h)):
        k1 = sigma_rates(disk, x)
        k2 = sigma_rates(disk, x + 0.5 * h * k1)
        k3 = sigma_rates(disk, x + 0.5 * h * k2)
        k4 = sigma_rates(disk, x + h * k3)
        x = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        most = largest([most, abs(sigma_energy(disk, x) - begin)])
    return most


@statement(5, "EQUIVARIANCE", "2.3: motions go to motions under E(2) in space and under rotations S^1 of the body")
def equivariance() -> Iterator[Finding]:
    B, C, b = plain.turn(3, 2.3), plain.turn(3, -1.1), np.array([0.7, -1.9, 0.0])

    def moved(y: _Array) -> _Array:
        A, a, omega = y[:9].reshape(3, 3), y[9:12], y[12:]
        return np.concatenate([(B @ A @ C.T).ravel(), B @ a + b, C @ omega])

    def carried(y: _Array) -> _Array:
        return moved(y) - moved(0.0 * y)

    def starts(disk: ex.Disk) -> _Array:
        A, omega = plain.start(*[*sample(disk), 0.4, -0.9])
        return np.concatenate([A.ravel(), [0.1, 0.2, disk.r * np.cos(sample(disk)[0])], omega])

    def fields(disk: ex.Disk) -> float:
        y = starts(disk)
        return far(full_rates(disk, moved(y)), carried(full_rates(disk, y))) / disk.rate_unit**2

    def ends(disk: ex.Disk) -> float:
        y, times = starts(disk), np.array([0.0, 2.0 * disk.time_unit])
        one, other = full_motion(disk, y, times), full_motion(disk, moved(y), times)
        packed = [np.concatenate([run.A[-1].ravel(), run.a[-1], run.omega[-1]]) for run in (one, other)]
        return far(moved(packed[0]), packed[1]) / max(1.0, disk.rate_unit)

    found = worst(fields)
    yield Finding(
        f"the vector field before and after a motion of plane and body: {OF_BODIES}",
        found,
        0.0,
        found,
        1e-13,
        ROUNDING,
    )
    found = worst(ends)
    yield Finding(
        "states after two time units", found, 0.0, found, 1e-9, "two integrations at 1e-12, errors grown"
    )
    times, turn = np.linspace(0.0, 2.0, 9), plain.turn(3, 0.8)
    runs = [followed(BODIES[0], sample(BODIES[0]), times, chi0=chi) for chi in (0.0, 0.8)]
    found = far(runs[0].path[0] @ turn.T, runs[1].path[0])
    yield Finding("path by ex.simulate with chi(0) = 0.8 less the turned path", found, 0.0, found, 1e-12, ROUNDING)


@statement(
    6,
    "EQ-2.20",
    "(2.20), (2.22), (2.27)-(2.29), (2.31), (2.33): sigma and integrals of it give the whole motion back",
)
def reconstruction() -> Iterator[Finding]:
    names = (
        "u by (2.21), psi from (2.22)",
        "v by (2.30), chi from (2.31)",
        "omega by (2.20)",
        "nu by (2.27), (2.29)",
        "<nu, v> - sigma_4, (2.28)",
        "centre by (2.33)",
        "contact point",
    )

    def gaps(disk: ex.Disk) -> list[float]:
        full, run = both(disk, sample(disk), np.linspace(0.0, 2.5 * disk.time_unit, 26))
        phi, phidot, unit = run.phi[0], run.phidot[0], disk.rate_unit
        sigma = sigma_at(phi, phidot, run.sigma3[0], run.sigma4[0]).T
        u, v = spherical(phi, run.psi[0]), spherical(phi, run.chi[0])
        nu = np.einsum("nij,nj->ni", full.A, full.omega)
        return [
            far(u, full.u),
            far(v, full.v),
            far(body_velocity(u, sigma), full.omega) / unit,
            far(space_velocity(v, sigma), nu) / unit,
            far((nu * full.v).sum(axis=1), sigma[:, 3]) / unit,
            far(run.path[0], full.a) / disk.r,
            far(run.contact[0], full.contact) / disk.r,
        ]

    found = np.array([gaps(disk) for disk in BODIES]).max(axis=0)
    for name, gap in zip(names, found, strict=True):
        yield Finding(f"{name}, ex.simulate against the eight-dimensional motion", gap, 0.0, gap, 1e-9, SOLVER)


def euler_rotation(chi: _Array, tilt: _Array, psi: _Array) -> _Array:
    """About e3 by -psi - pi, then e2 by tilt, then e3 by chi, (n, 3, 3); by SciPy."""
    angles = np.stack([chi, tilt, -psi - np.pi], axis=1)
    return Rotation.from_euler("ZYZ", angles).as_matrix()


@statement(7, "EQ-2.32", "(2.32) [corrected: pi/2 - phi] (-psi - pi, pi/2 - phi, chi) are Euler angles of A")
def euler_angles() -> Iterator[Finding]:
    rng = np.random.default_rng(7)
    phi, chi, psi = rng.uniform(-1.5, 1.5, 500), rng.uniform(-3, 3, 500), rng.uniform(-3, 3, 500)
    A = euler_rotation(chi, 0.5 * np.pi - phi, psi)
    for name, found, wanted in (
        ("A e3 less v of (2.30)", A[:, :, 2], spherical(phi, chi)),
        ("A^-1 e3 less u of (2.21)", A[:, 2, :], spherical(phi, psi)),
    ):
        gap = far(found, wanted)
        yield Finding(f"{name}, 500 random angles", gap, 0.0, gap, 2e-15, "rounding of three rotations")
    printed = euler_rotation(chi, 0.5 * np.pi + phi, psi)[:, :, 2] - spherical(phi, chi)
    size = np.linalg.norm(printed, axis=1)
    yield Finding(
        "largest |A e3 - v| with the printed phi + pi/2",
        float(size.max()),
        "2 |sin phi|, it mirrors v",
        far(size, 2.0 * abs(np.sin(phi))),
        2e-15,
        "rounding",
    )

    def followed(disk: ex.Disk) -> float:
        full, run = both(disk, sample(disk), np.linspace(0.0, 2.5 * disk.time_unit, 26))
        return far(euler_rotation(run.chi[0], 0.5 * np.pi - run.phi[0], run.psi[0]), full.A)

    gap = worst(followed)
    yield Finding("A from the angles of ex.simulate less A of the plain motion", gap, 0.0, gap, 1e-9, SOLVER)


def contact_from_normal(disk: ex.Disk, v: _Array, a: _Array) -> _Array:
    """Eq. (2.35) corrected, (n, 3)."""
    q = np.sqrt(1.0 - v[:, 2] ** 2)
    return disk.r * (v[:, 2:] * v - np.array([0.0, 0.0, 1.0])) / q[:, None] + a


@statement(8, "EQ-2.35", "(2.34), (2.35) [corrected: sigma_1 v - e3] both give the point of contact, at height 0")
def contact_point() -> Iterator[Finding]:
    rng = np.random.default_rng(8)
    disk, n = BODIES[3], 500
    A = Rotation.random(n, random_state=8).as_matrix()
    A = A[abs(A[:, 2, 2]) < 0.999]
    heights = disk.r * np.hypot(A[:, 2, 0], A[:, 2, 1])
    a = np.column_stack([rng.uniform(-1, 1, (len(A), 2)), heights])
    first = np.array([B @ plain.rim_point(disk, B[2]) for B in A]) + a
    second = contact_from_normal(disk, A[:, :, 2], a)
    gap = far(first, second) / disk.r
    reason = "rounding over cos^2 phi, which is 0.002 at the least"
    yield Finding("(2.34) less (2.35), random rotations, in r", gap, 0.0, gap, 5e-13, reason)
    gap = far(first[:, 2], 0.0) / disk.r
    yield Finding("height by (2.34) in r", gap, 0.0, gap, 5e-13, reason)
    q = heights / disk.r
    printed = (disk.r * A[:, 2, 2] ** 2 / q + heights) / disk.r
    yield Finding(
        "least height by (2.35) as printed, in r",
        float(printed.min()),
        "1/cos phi",
        far(printed * q, 1.0),
        1e-13,
        reason,
    )

    def lowest(disk: ex.Disk) -> float:
        """How far the rim reaches below the contact point, all round, along a motion."""
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 2.5 * disk.time_unit, 26))
        angle = np.linspace(0.0, 2.0 * np.pi, 721)
        rim = disk.r * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle])
        height = np.einsum("nj,jk->nk", full.A[:, 2, :], rim) + full.a[:, 2:]
        return float(np.max(contact_from_normal(disk, full.v, full.a)[:, 2] - height.min(axis=1))) / disk.r

    gap = worst(lowest)
    yield Finding("depth of the rim below the contact point, in r", gap, "<= 0", gap, 1e-10, "rtol 1e-12")

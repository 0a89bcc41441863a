"""The paper's formulas as they stand in it, corrected where it errs, and the bodies that rows are tried on.

Written for reading, in the disk's own units. Only `followed` calls the explorer, whose motions they judge.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import rgamma

import explorer as ex
from explorer.paper import eight_dimensions as plain

_Array = NDArray[np.float64]
ALL = ("phi", "phidot", "sigma3", "sigma4", "chi", "psi", "path", "contact")
# The thick body has units of its own, so that a forgotten m, r or g shows.
BODIES = (
    ex.Disk.uniform(),
    ex.Disk.hoop(),
    ex.Disk.matching(),
    ex.Disk(m=2.0, r=0.5, g=9.81, I1=0.25, I3=0.15, name="thick"),
)
OF_BODIES = "uniform, hoop, m r^2/I1 = 3, thick"
ROUNDING = "rounding of some dozen operations"
SOLVER = "two integrations at relative tolerance 1e-11 and 1e-12"


def far(found: Any, wanted: Any) -> float:
    """The largest distance of two arrays, entry by entry; NaN if there is one."""
    return float(np.max(np.abs(np.asarray(found) - np.asarray(wanted))))


def largest(values: Any) -> float:
    """The largest of some numbers; NaN if there is one, where Python's max might pass it over."""
    return float(np.max(values))


def worst(measure: Callable[[ex.Disk], float]) -> float:
    """The largest of a distance over the bodies; NaN if there is one."""
    return largest([measure(disk) for disk in BODIES])


def sample(disk: ex.Disk) -> _Array:
    """A state (phi, phidot, sigma3, sigma4) that is nowhere special, in the units of the disk."""
    return np.array([0.3, *(np.array([0.8, 0.6, -0.5]) * disk.rate_unit)])


def random_body(rng: np.random.Generator) -> ex.Disk:
    """A body with random m, r, g and moments that eq. (2.3) allows."""
    m, r, g = rng.uniform(0.2, 3.0, 3)
    I1 = m * r * r * rng.uniform(0.1, 1.0)
    return ex.Disk(m, r, g, I1, I1 * rng.uniform(0.2, 2.0))


def random_state(rng: np.random.Generator, disk: ex.Disk, steepest: float = 1.2) -> _Array:
    """A random (phi, phidot, sigma3, sigma4) with |phi| < steepest."""
    return np.array([rng.uniform(-steepest, steepest), *(rng.uniform(-1.5, 1.5, 3) * disk.rate_unit)])


def sigma_rates(disk: ex.Disk, sigma: _Array) -> _Array:
    """Eqs (2.15)-(2.18)."""
    s1, s2, s3, s4 = sigma
    q2, inertia = 1.0 - s1 * s1, disk.m * disk.r**2
    M, J = disk.I1 + inertia, disk.I3 + inertia
    weight = disk.m * disk.g * disk.r * s1 * np.sqrt(q2)
    s2dot = (-s1 * (M * s2**2 + disk.I1 * s3**2) / q2 + J * s3 * s4 + weight) / M
    return np.array([s2, s2dot, -disk.I3 * s2 * s4 / disk.I1, -inertia * s2 * s3 / (q2 * J)])


def sigma_energy(disk: ex.Disk, sigma: _Array) -> Any:
    """Eq. (2.19); sigma (4,) or (4, n)."""
    s1, s2, s3, s4 = sigma
    q2, inertia = 1.0 - s1 * s1, disk.m * disk.r**2
    moving = ((disk.I1 + inertia) * s2**2 + disk.I1 * s3**2) / q2 + (disk.I3 + inertia) * s4**2
    return 0.5 * moving + disk.m * disk.g * disk.r * np.sqrt(q2)


def full_energy(disk: ex.Disk, u: _Array, omega: _Array) -> float:
    """T + V of eqs (2.2), (2.7), the velocity of the centre from eq. (2.11)."""
    s = plain.rim_point(disk, u)
    velocity = np.cross(omega, s)
    height = -s @ u
    turning = disk.I1 * (omega[0] ** 2 + omega[1] ** 2) + disk.I3 * omega[2] ** 2
    return float(0.5 * turning + 0.5 * disk.m * velocity @ velocity + disk.m * disk.g * height)


def plain_sigma_rates(disk: ex.Disk, u: _Array, omega: _Array) -> _Array:
    """Rates of eq. (2.14) by the chain rule from eqs (2.12), (2.13)."""
    udot, wdot = np.cross(u, omega), plain.angular_acceleration(disk, u, omega)
    s2dot = udot[0] * omega[1] + u[0] * wdot[1] - udot[1] * omega[0] - u[1] * wdot[0]
    s3dot = udot[:2] @ omega[:2] + u[:2] @ wdot[:2]
    return np.array([udot[2], s2dot, s3dot, wdot[2]])


def full_rates(disk: ex.Disk, y: _Array) -> _Array:
    """Eqs (2.1), (2.11), (2.12) for y = (A by rows, a, omega)."""
    A, omega = y[:9].reshape(3, 3), y[12:]
    u = A[2]
    adot = -A @ np.cross(omega, plain.rim_point(disk, u))
    return np.concatenate([(A @ plain.hat(omega)).ravel(), adot, plain.angular_acceleration(disk, u, omega)])


def full_motion(disk: ex.Disk, start: _Array, times: _Array) -> plain.PlainMotion:
    """The eight-dimensional motion from any (A, a, omega), by DOP853 at 1e-12."""
    run = solve_ivp(
        lambda _t, y: full_rates(disk, y), (0.0, times[-1]), start, "DOP853", times, rtol=1e-12, atol=1e-12
    )
    y = run.y.T
    return plain.PlainMotion(disk, times, y[:, :9].reshape(-1, 3, 3), y[:, 9:12], y[:, 12:])


def followed(disk: ex.Disk, state: Any, times: Any, accuracy: float = 1e-11, chi0: float = 0.0) -> Any:
    """The motion by ex.simulate, with all observables."""
    return ex.simulate(disk, state, t_eval=times, observables=ALL, accuracy=accuracy, chi0=chi0)


def both(disk: ex.Disk, state: _Array, times: _Array) -> tuple[plain.PlainMotion, Any]:
    """One motion by the plain equations and by ex.simulate."""
    return plain.integrate(disk, state, times), followed(disk, state, times)


def spherical(first: Any, angle: Any) -> _Array:
    """Unit vectors of eqs (2.21), (2.30), (n, 3)."""
    return np.stack([np.cos(first) * np.cos(angle), np.cos(first) * np.sin(angle), np.sin(first)], axis=-1)


def space_velocity(v: _Array, sigma: _Array) -> _Array:
    """nu by eqs (2.27), (2.29); v (n, 3), sigma (n, 4)."""
    s1, s2, s3, s4 = sigma.T
    q2 = 1.0 - s1 * s1
    a, b = s4 - s1 * s3 / q2, s2 / q2
    return np.stack([a * v[:, 0] + b * v[:, 1], -b * v[:, 0] + a * v[:, 1], s3 + s1 * s4], axis=1)


def body_velocity(u: _Array, sigma: _Array) -> _Array:
    """omega by eq. (2.20)."""
    s1, s2, s3, s4 = sigma.T
    q2 = 1.0 - s1 * s1
    return np.stack([(-u[:, 1] * s2 + u[:, 0] * s3) / q2, (u[:, 0] * s2 + u[:, 1] * s3) / q2, s4], axis=1)


def basis(c: float, z: Any) -> tuple[Any, Any, Any, Any]:
    """Even and odd solution of eq. (4.4) and their derivatives: series about the vertical; z may be complex.

    All coefficients are positive for c > 0, so nothing cancels; radius 1.
    """
    terms = int(min(20_000, 40.0 / -np.log(max(0.05, float(np.max(np.abs(z)))))))
    coefficients = np.zeros(terms + 2)
    coefficients[:2] = 1.0
    for n in range(terms):
        coefficients[n + 2] = (n * (n - 1) + c) / ((n + 1) * (n + 2)) * coefficients[n]
    even, odd = coefficients[::2], coefficients[1::2]
    z2 = z * z
    slopes = even[1:] * np.arange(2, 2 * even.size, 2), odd * np.arange(1, 2 * odd.size, 2)
    return polyval(z2, even), z * polyval(z2, slopes[0]), z * polyval(z2, odd), polyval(z2, slopes[1])


def parameters(disk: ex.Disk) -> tuple[float, float, float]:
    """c, d, b of eqs (4.3), (4.7), (4.5)."""
    inertia = disk.m * disk.r**2
    J = disk.I3 + inertia
    c, d = inertia * disk.I3 / (J * disk.I1), disk.I3**2 / (disk.I1 * J)
    return c, d, float(np.sqrt(disk.m * disk.g * disk.r / J))


def chaplygin(disk: ex.Disk, bar3: Any, bar4: Any, z: Any) -> tuple[Any, Any]:
    """sigma_3, sigma_4 at sigma_1 = z of the solution (3.3) of Chaplygin's equations. Needs I3 > 0."""
    even, deven, odd, dodd = basis(parameters(disk)[0], z)
    k = disk.I3 / disk.I1
    return bar3 * even - k * bar4 * odd, bar4 * dodd - bar3 * deven / k


def bars(disk: ex.Disk, z: Any, s3: Any, s4: Any) -> tuple[Any, Any]:
    """The constants (3.5) of a state: the inverse of `chaplygin`, whose determinant is 1."""
    even, deven, odd, dodd = basis(parameters(disk)[0], z)
    k = disk.I3 / disk.I1
    return dodd * s3 + k * odd * s4, deven * s3 / k + even * s4


def amended(disk: ex.Disk, bar3: Any, bar4: Any, z: Any) -> Any:
    """V of eq. (3.8) at sigma_1 = z."""
    s3, s4 = chaplygin(disk, bar3, bar4, z)
    q2, J = 1.0 - z * z, disk.I3 + disk.m * disk.r**2
    return 0.5 * (disk.I1 * s3 * s3 / q2 + J * s4 * s4) + disk.m * disk.g * disk.r * np.sqrt(q2)


def sigma_at(phi: Any, phidot: Any, s3: Any, s4: Any) -> _Array:
    """(sigma_1 .. sigma_4), (4,) or (4, n)."""
    return np.array([np.sin(phi), phidot * np.cos(phi), s3, s4])


def tilting(disk: ex.Disk, state: _Array) -> float:
    """Second derivative of phi by the plain equations."""
    A, omega = plain.start(*state)
    s2dot = plain_sigma_rates(disk, A[2], omega)[1]
    return float((s2dot + state[1] ** 2 * np.sin(state[0])) / np.cos(state[0]))


class Swing:
    """The motion of phi as section 3.3 has it: turning points and times from V alone."""

    def __init__(self, disk: ex.Disk, state: _Array) -> None:
        self.disk, self.M = disk, disk.I1 + disk.m * disk.r**2
        self.bars = bars(disk, np.sin(state[0]), state[2], state[3])
        self.E = float(sigma_energy(disk, sigma_at(*state)))
        self.low, self.high = self._end(state[0], -0.02), self._end(state[0], 0.02)

    def V(self, phi: Any) -> Any:
        return amended(self.disk, *self.bars, np.sin(phi))

    def _end(self, phi: float, step: float) -> float:
        while self.V(phi + step) < self.E:
            phi += step
        return float(brentq(lambda x: self.V(x) - self.E, phi, phi + step, xtol=1e-15))

    def time(self, first: float, last: float) -> float:
        """(3.12) between two angles inside the swing, by Gauss's rule."""
        x, w = leggauss(60)
        phi = first + 0.5 * (last - first) * (1.0 + x)
        return float(0.5 * (last - first) * (w / np.sqrt(2.0 / self.M * (self.E - self.V(phi)))).sum())

    def period(self, nodes: int = 128) -> float:
        """(3.13); phi = middle + half sin t makes the integrand periodic, so equal steps converge fast."""
        t = np.pi * ((np.arange(nodes) + 0.5) / nodes - 0.5)
        half = 0.5 * (self.high - self.low)
        phi = 0.5 * (self.high + self.low) + half * np.sin(t)
        speed = np.sqrt(2.0 / self.M * (self.E - self.V(phi)))
        return float(2.0 * np.pi / nodes * (half * np.cos(t) / speed).sum())


def turns(disk: ex.Disk, state: _Array, end: float) -> _Array:
    """Times of the turning points of (2.15)-(2.18) up to `end`."""

    def still(_t: float, x: _Array) -> float:
        return float(x[1])

    run = solve_ivp(
        lambda _t, x: sigma_rates(disk, x),
        (0.0, end),
        sigma_at(*state),
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
        events=still,
    )
    return np.asarray(run.t_events[0])


def scaled(c: float, d: float, X: Any, Y: Any, z: Any) -> tuple[Any, Any, Any]:
    """x, y of eq. (4.2) with x(0) = X, y(0) = Y, and W of eqs (4.6), (4.8)."""
    even, deven, odd, dodd = basis(c, z)
    x, y = X * even + Y * odd, X * deven + Y * dodd
    return x, y, 0.5 * d * x * x / (1.0 - z * z) + 0.5 * y * y + np.sqrt(1.0 - z * z)


def scaled_slope(c: float, d: float, X: Any, Y: Any, z: Any) -> Any:
    """dW/dz by eq. (4.10)."""
    x, y, _W = scaled(c, d, X, Y, z)
    q2 = 1.0 - z * z
    return d * z * x * x / q2**2 + (d + c) * x * y / q2 - z / np.sqrt(q2)


def coefficients(c: float, terms: int) -> _Array:
    """2^n r_n for n = 0 .. terms, eqs (5.2), (5.3), so that no power overflows."""
    n = np.arange(1, terms)
    return np.concatenate([[0.0, 2.0], 2.0 * np.cumprod((c + n * (n - 1.0)) / (n * (n + 1.0)))])


def recessive(c: float, z: Any, terms: int = 120) -> tuple[Any, Any]:
    """r and r' by eq. (5.1); 120 terms are at rounding for z <= 0.4."""
    scaled = coefficients(c, terms)
    x = 0.5 * (1.0 + z)
    return polyval(x, scaled), 0.5 * polyval(x, scaled[1:] * np.arange(1, terms + 1))


def at_vertical(c: Any) -> tuple[Any, Any]:
    """r(0), r'(0) by eqs (5.11), (5.12); c may be complex."""
    root = np.sqrt(1.0 - 4.0 * np.asarray(c, dtype=complex)) / 4.0
    r0 = 0.5 * np.sqrt(np.pi) * rgamma(1.25 - root) * rgamma(1.25 + root)
    return r0, np.sqrt(np.pi) * rgamma(0.75 - root) * rgamma(0.75 + root)

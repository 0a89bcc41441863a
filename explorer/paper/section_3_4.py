"""Sections 3 and 4 of the paper: Chaplygin's equations, the amended potential, and scaling.

The potential comes from a series about the vertical, the motions from the plain equations and from the
explorer's integrators, periods and falls from its quadrature.
"""

from collections.abc import Iterator

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.integrate import quad
from scipy.optimize import brentq

from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import (
    HOOP,
    OF_BODIES,
    PLANAR,
    ROUNDING,
    SOLVER,
    UNIFORM,
    WITH_UNITS,
    distance,
    followed,
    largest,
    near,
    random_ones,
    sample,
    worst,
)
from explorer.paper.closed_forms import amended, bars, chaplygin, parameters, scaled
from explorer.paper.four_dimensions import sigma_at, sigma_energy, solved, turns
from explorer.paper.statement import Finding, statement
from explorer.phase.constants import constants
from explorer.phase.disk import Disk
from explorer.phase.states import Array, phi_to_states

_STEP = 1e-30  # of complex-step derivatives, which have no cancellation


def chaplygin_rates(disk: Disk, z: float, y: Array) -> Array:
    """Eq. (3.1)."""
    inertia = disk.m * disk.r**2
    return np.array([-disk.I3 / disk.I1 * y[1], -inertia / (disk.I3 + inertia) * y[0] / (1.0 - z * z)])


def _along(disk: Disk, z: Array, y: Array) -> Array:
    """(3.1) integrated from z[0] to z[-1], (2, n)."""
    return solved(lambda s, x: chaplygin_rates(disk, s, x), y, z, z[0], 1e-13)


@statement(9, "EQ-3.1")
def chaplygin_equations() -> Iterator[Finding]:
    """(3.1), (3.2): Chaplygin's equations hold along motions, and have four symmetries."""

    def gap(disk: Disk) -> float:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 0.6 * disk.time_unit, 13))
        z, s3, s4 = full.sigma[:, 0], full.sigma[:, 2], full.sigma[:, 3]
        assert np.all(np.diff(z) > 0.0)  # one leg, so sigma_1 may be the variable
        return distance(_along(disk, z, np.array([s3[0], s4[0]])), [s3, s4]) / disk.rate_unit

    text = f"(3.1) integrated in σ₁, minus σ₃, σ₄ of the motion in 8 dimensions, {OF_BODIES}"
    yield near(text, worst(gap), 0.0, 1e-10, SOLVER)
    z, y = np.linspace(-0.3, 0.9, 13), np.array([0.7, -0.4])
    solution = _along(UNIFORM, z, y)
    for signs in ((-1, -1, 1), (-1, 1, -1), (1, -1, -1)):
        image = np.array(signs[1:])
        apart = distance(_along(UNIFORM, signs[0] * z, image * y), image[:, None] * solution)
        yield near(f"image of a solution under {signs} less a solution", apart, 0.0, 0.0, "exact")
    phi, s2, s3, s4 = np.random.default_rng(9).uniform(-1.4, 1.4, (4, 200))
    one, other = (
        constants(phi_to_states(UNIFORM, phi, s2, s3, s4)),
        constants(phi_to_states(UNIFORM, -phi, s2, s3, -s4)),
    )
    here = [one.sigma3_bar, one.sigma4_bar, one.eta_plus, one.energy]
    there = [other.sigma3_bar, -other.sigma4_bar, other.eta_minus, other.energy]
    text = "the explorer's constants of 200 mirrored states"
    yield near(text, distance(here, there), 0.0, 1e-14, ROUNDING)


@statement(10, "EQ-3.5")
def constants_of_motion() -> Iterator[Finding]:
    """(3.5): σ₃, σ₄ continued to the vertical are constants of motion."""

    def errors(disk: Disk) -> tuple[float, float]:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 3.0 * disk.time_unit, 31))
        z, s2, s3, s4 = full.sigma.T
        phi = np.arcsin(z)
        given = constants(phi_to_states(disk, phi, s2 / np.cos(phi), s3, s4))
        columns = np.array([given.sigma3_bar, given.sigma4_bar]) / disk.rate_unit
        start = _along(disk, np.array([z[0], 0.0]), full.sigma[0, 2:])[:, -1] / disk.rate_unit
        return distance(columns, columns[:, :1]), distance(columns[:, 0], start)

    moved, apart = worst(errors)
    text = f"constants error of the explorer along the motion in 8 dimensions, {OF_BODIES}"
    yield near(text, moved, 0.0, 1e-10, "rtol 1e-12 over some hundred steps")
    text = "the explorer's constants of a state less (3.1) integrated to σ₁ = 0"
    yield near(text, apart, 0.0, 1e-12, "rtol 1e-13 over some ten steps")


@statement(11, "EQ-3.8")
def amended_potential() -> Iterator[Finding]:
    """(3.6)–(3.11): E = Mφ̇²/2 + V(φ), and Mφ̈ = −V′(φ)."""
    energies, forces = [], []
    for disk, state, A, omega in random_ones(11, 60, 1.1):
        M = disk.I1 + disk.m * disk.r**2
        given = constants(phi_to_states(disk, *state))
        bar3, bar4, z = given.sigma3_bar, given.sigma4_bar, np.sin(state[0])
        E = plain.full_energy(disk, A[2], omega)
        energies.append((0.5 * M * state[1] ** 2 + amended(disk, bar3, bar4, z)) / E - 1.0)
        slope = amended(disk, bar3, bar4, z + 1j * _STEP).imag / _STEP * np.cos(state[0])
        forces.append((M * plain.tilting(disk, state) + slope) / E)
    text = "Mφ̇²/2 + V with the explorer's constants over T + V of the plain equations, less 1, 60 states"
    yield near(text, distance(energies, 0.0), 0.0, 1e-13, "rounding of the two series")
    text = "(Mφ̈ of the plain equations + V′)/E, V′ by a complex step, 60 states"
    yield near(text, distance(forces, 0.0), 0.0, 1e-12, "rounding, grown near flat")


class Swing:
    """The motion of phi as section 3.3 has it: turning points and times from V alone."""

    def __init__(self, disk: Disk, state: Array) -> None:
        self.disk, self.M = disk, disk.I1 + disk.m * disk.r**2
        self.bars = bars(disk, np.sin(state[0]), state[2], state[3])
        self.E = float(sigma_energy(disk, sigma_at(*state)))
        self.low, self.high = self._end(state[0], -0.02), self._end(state[0], 0.02)

    def _excess(self, phi: Array | float) -> Array:
        """E - V."""
        left: Array = self.E - amended(self.disk, *self.bars, np.sin(phi))
        return left

    def _end(self, phi: float, step: float) -> float:
        while self._excess(phi + step) > 0.0:
            phi += step
        return float(brentq(self._excess, phi, phi + step, xtol=1e-15))

    def time(self, first: float, last: float) -> float:
        """(3.12) between two angles inside the swing, by Gauss's rule."""
        x, w = leggauss(60)
        phi = first + 0.5 * (last - first) * (1.0 + x)
        return float(0.5 * (last - first) * (w / np.sqrt(2.0 / self.M * self._excess(phi))).sum())

    def period(self, nodes: int = 128) -> float:
        """(3.13); phi = middle + half sin t makes the integrand periodic, so equal steps converge fast."""
        t = np.pi * ((np.arange(nodes) + 0.5) / nodes - 0.5)
        half = 0.5 * (self.high - self.low)
        speed = np.sqrt(2.0 / self.M * self._excess(0.5 * (self.high + self.low) + half * np.sin(t)))
        return float(2.0 * np.pi / nodes * (half * np.cos(t) / speed).sum())


@statement(12, "EQ-3.13")
def period() -> Iterator[Finding]:
    """(3.12), (3.13): times and the period are integrals over ((2/M)(E − V))^(−1/2)."""

    def gaps(disk: Disk) -> list[float]:
        state, unit = sample(disk), disk.time_unit
        swing = Swing(disk, state)
        tau = swing.period()
        moments = turns(disk, state, 1.6 * tau)
        by_explorer = periods(phi_to_states(disk, *state), accuracy=1e-12).period
        times = np.linspace(0.0, 0.6 * unit, 5)
        phi = followed(disk, state, times).phi
        found = [swing.time(phi[0], angle) for angle in phi]
        swung = abs(moments[2] - moments[0] - tau) / tau
        return [swung, abs(by_explorer / tau - 1.0), distance(found, times) / unit]

    swung, whole, found = worst(gaps)
    text = f"(3.13) less the time between turning points of (2.15)–(2.18), relative, {OF_BODIES}"
    yield near(text, swung, 0.0, 1e-10, "rtol 1e-12, events located in its interpolant")
    text = "(3.13) less the explorer's period, relative"
    yield near(text, whole, 0.0, 1e-11, "E − V cancels by three digits at the outer nodes")
    yield near("(3.12) less the times of the explorer's motion", found, 0.0, 1e-10, "its accuracy 1e-11")


@statement(13, "PERIODIC")
def periodic() -> Iterator[Finding]:
    """3.3: generic motions of φ are periodic (Vierkandt), and φ(2t₊ − t) = φ(t)."""

    def gaps(disk: Disk) -> tuple[float, float]:
        state = sample(disk)
        tau = Swing(disk, state).period()
        sigma = plain.integrate(disk, state, np.array([0.0, tau])).sigma
        t_plus = float(turns(disk, state, tau)[0])
        offsets = np.linspace(0.05, 1.0, 12) * t_plus
        times = np.concatenate([t_plus - offsets[::-1], t_plus + offsets])
        phi = followed(disk, state, np.fmax(times, 0.0)).phi
        return distance(sigma[1], sigma[0]) / max(1.0, disk.rate_unit), distance(phi, phi[::-1])

    later, mirrored = worst(gaps)
    text = f"σ of the motion in 8 dimensions one period (3.13) later, {OF_BODIES}"
    yield near(text, later, 0.0, 1e-9, "rtol 1e-12, grown over one period")
    text = "φ(t₊ + s) − φ(t₊ − s) of the explorer's motion, t₊ from (2.15)–(2.18)"
    yield near(text, mirrored, 0.0, 1e-9, "accuracy 1e-11, time of the turn known to 1e-11")


@statement(14, "ASYMPTOTIC")
def asymptotic() -> Iterator[Finding]:
    """3.3: where V′(φ₊) = 0 the motion never reaches φ₊; beside it periods grow like −ln|E − E_c|/λ."""
    for disk in (UNIFORM, WITH_UNITS[3]):
        yield from _beside_the_barrier(disk)
    spin, z = 0.3, np.sin(0.3)
    rate, M = growth(UNIFORM, spin), UNIFORM.I1 + 1.0
    drop = float(amended(UNIFORM, 0.0, spin, 0.0) - amended(UNIFORM, 0.0, spin, z))
    times = np.linspace(0.0, 9.0 / rate, 19)
    start = [0.3, -np.sqrt(2.0 / M * drop), *chaplygin(UNIFORM, 0.0, spin, z)]
    phi = followed(UNIFORM, start, times).phi
    rates = -np.diff(np.log(phi)) / np.diff(times)
    text = "rate at which φ decays on E = E_c, by the explorer, φ from 0.3 to 4e-5"
    reason = "the error 1e-11 of the start grows by e⁹ while φ falls by as much"
    yield near(text, rates[-1], rate, 2e-3 * rate, reason)


def _beside_the_barrier(disk: Disk) -> Iterator[Finding]:
    """Straight rolling too slow to be stable: V has a maximum at the vertical, where sigma3_bar = 0."""
    spin, M = 0.3 * disk.rate_unit, disk.I1 + disk.m * disk.r**2
    rate = growth(disk, spin)
    speeds = 10.0 ** np.arange(-1.0, -4.1, -0.5) * disk.rate_unit
    above = periods(phi_to_states(disk, 0.0, speeds, 0.0, spin), accuracy=1e-5).period
    # Twice past the vertical in one period; E - E_c = M phidot^2/2 there, with no cancellation.
    excess = np.log(0.5 * M * speeds**2 / (disk.m * disk.g * disk.r))
    slope = -2.0 / np.polyfit(excess[2:], above[2:], 1)[0]
    text = f"λ from dτ/d ln(E − E_c) above the barrier, {disk.name} body, E − E_c over four decades"
    why = "periods to 1e-5, and terms (E − E_c) ln(E − E_c)"
    yield near(text, slope, rate, 5e-4 * rate, why)
    angles = speeds / rate
    states = phi_to_states(disk, angles, 0.0, *chaplygin(disk, 0.0, spin, np.sin(angles)))
    slope = -1.0 / np.polyfit(excess[2:], periods(states, accuracy=1e-4).period[2:], 1)[0]
    text = f"the same below the barrier, {disk.name} body, turning at {angles[2]:.0e} to {angles[-1]:.0e} rad"
    yield near(text, slope, rate, 5e-4 * rate, why)


def growth(disk: Disk, spin: float) -> float:
    """lambda of phi'' = lambda^2 phi at the vertical with sigma3_bar = 0, from the plain equations."""

    def force(angle: float) -> float:
        return plain.tilting(disk, [angle, 0.0, *chaplygin(disk, 0.0, spin, np.sin(angle))]) / angle

    return float(np.sqrt((4.0 * force(5e-4) - force(1e-3)) / 3.0))


@statement(15, "PENDULUM")
def pendulum() -> Iterator[Finding]:
    """3.4 [corrected: p = rAe₁ + a]: where σ₃ = σ₄ = 0 the disk falls as a pendulum; p, ψ, χ rest."""
    for disk, expected in ((UNIFORM, (1.293920, 1.612452)), (HOOP, (1.325324, 1.527525))):
        times = [_falling_time(disk, end) for end in (0.5 * np.pi, 1.5)]
        fall = passages(disk, 0.0, 0.0, 1.0, accuracy=1e-11)
        ours = np.array([fall.fall_time, fall.impact_speed])
        text = f"time of the fall and speed of impact from φ = 0, φ̇ = 1, {disk.name}, by the explorer"
        yield near(text, ours, expected, 5e-7, "half a unit of the last decimal given")
        gap = distance(ours, [times[0], _pace(0.5 * np.pi, disk)])
        yield near("the same less (3.12) by SciPy's quad", gap, 0.0, 1e-11, "accuracy 1e-11")
        full = plain.integrate(disk, (0.0, 1.0, 0.0, 0.0, 0.0, np.pi), np.linspace(0.0, times[1], 21))
        gap = abs(float(np.arcsin(full.u[-1, 2])) - 1.5)
        text = f"φ of the motion in 8 dimensions at the time (3.12) for 1.5 rad, minus 1.5, {disk.name}"
        yield near(text, gap, 0.0, 1e-9, "rtol 1e-12, 1/cos 1.5 = 14")
        yield from _resting(disk, full)


def _pace(phi: float, disk: Disk) -> float:
    """phidot of a fall from the vertical with phidot = 1 and sigma3 = sigma4 = 0."""
    return float(np.sqrt(1.0 + 2.0 / (disk.I1 + 1.0) * (1.0 - np.cos(phi))))


def _falling_time(disk: Disk, end: float) -> float:
    """(3.12) from the vertical to an angle."""
    return float(quad(lambda phi: 1.0 / _pace(phi, disk), 0.0, end, epsabs=1e-13)[0])


def _resting(disk: Disk, full: plain.PlainMotion) -> Iterator[Finding]:
    """What section 3.4 says of the hinge, where chi = 0 and psi = pi; three misprints."""
    lever, why = disk.r * full.A[:, :, 0], "rtol 1e-12 over some hundred steps"
    p = full.a + lever
    pairs = (p, p[0]), (full.contact, p[0]), (full.chi, 0.0), (full.psi, np.pi)
    gap = largest(distance(*pair) for pair in pairs)
    yield near("change of p = rAe₁ + a, of χ and ψ along the motion in 8 dimensions", gap, 0.0, 1e-10, why)
    height, s1 = full.a[:, 2], full.u[:, 2]
    gap, off = distance(np.sqrt(1.0 - s1**2), height), distance(s1, height)
    text = "r cos φ with sin φ = σ₁ (as printed, with cos φ = σ₁) minus the height a₃ in 8 dimensions, in radii"
    yield near(text, gap, 0.0, 1e-10, why, {"3.4, substitution": off})
    gap, off = (distance(full.a[0] + sign * lever[0], full.contact) for sign in (1.0, -1.0))
    text = "rA(0)e₁ + a(0) (as printed, −rA(0)e₁ + a(0)) minus the contact point in 8 dimensions, in radii"
    yield near(text, gap, 0.0, 1e-10, why, {"3.4, contact point": off})
    gap, off = (distance(sign * lever, full.a - full.contact[0]) for sign in (-1.0, 1.0))
    text = "−rA(t)e₁ (as printed, rA(t)e₁) minus a(t), where a is measured from the contact point, in radii"
    yield near(text, gap, 0.0, 1e-10, why, {"3.4, centre of mass": off})


@statement(16, "EQ-4.3")
def two_parameters() -> Iterator[Finding]:
    """(4.3), (4.7): c = mr²I₃/(JI₁), d = I₃²/(JI₁), c + d = I₃/I₁; uniform 4/3, 2/3; hoop 1, 1."""
    for disk, wanted in zip(PLANAR, ((4 / 3, 2 / 3), (1.0, 1.0), (6 / 5, 4 / 5)), strict=True):
        yield near(f"c, d of the {disk.name} body", parameters(disk)[:2], wanted, 1e-15, "rounding")
    slopes, sums = [], []
    for disk, state, A, omega in random_ones(16, 100):
        s2, _s2dot, s3dot, s4dot = plain.sigma_rates(disk, A[2], omega)
        c, d, _b = parameters(disk)
        slopes.append(np.cos(state[0]) ** 2 * s3dot * s4dot / (s2 * s2 * state[2] * state[3] * c) - 1.0)
        sums.append(c + d - disk.I3 / disk.I1)
    text = "c over the product of both slopes of (3.1), from the plain equations, less 1, 100 random bodies"
    yield near(text, distance(slopes, 0.0), 0.0, 1e-12, "rounding over rates as small as 1e-3")
    yield near("c + d − I₃/I₁ of the same bodies", distance(sums, 0.0), 0.0, 1e-14, ROUNDING)


def _scaled(disk: Disk, state: Array) -> tuple[float, ...]:
    """(c, d, X, Y, z) of a state, constants by the explorer and eq. (4.9)."""
    c, d, b = parameters(disk)
    given = constants(phi_to_states(disk, *state))
    X, Y = -disk.I1 * float(given.sigma3_bar) / (disk.I3 * b), float(given.sigma4_bar) / b
    return c, d, X, Y, float(np.sin(state[0]))


@statement(17, "EQ-4.6")
def scaling() -> Iterator[Finding]:
    """(4.1)–(4.9): scaling leaves c and d only, V = mgr W(X, Y; z)."""
    potentials, momenta = [], []
    for disk, state, A, omega in random_ones(17, 100, 1.1):
        x, y, W = scaled(*_scaled(disk, state))
        V = plain.full_energy(disk, A[2], omega) - 0.5 * (disk.I1 + disk.m * disk.r**2) * state[1] ** 2
        b = parameters(disk).b
        potentials.append(disk.m * disk.g * disk.r * W / V - 1.0)
        momenta.append(distance([-disk.I3 / disk.I1 * b * x, b * y], state[2:]) / disk.rate_unit)
    text = "mgr W over E − Mφ̇²/2 of the plain equations, less 1, 100 random bodies and states"
    yield near(text, distance(potentials, 0.0), 0.0, 1e-13, ROUNDING)
    yield near("σ₃, σ₄ by (4.1) less those of the state", np.max(momenta), 0.0, 1e-13, ROUNDING)


def scaled_slope(c: float, d: float, x: float, y: float, z: float, printed: bool = False) -> float:
    """CW by eq. (4.10), and with the vector field C as the paper prints it, without the factor x."""
    q2 = 1.0 - z * z
    turning = c * (1.0 if printed else x) * y + d * x * y
    return float(d * z * x * x / q2**2 + turning / q2 - z / np.sqrt(q2))


@statement(18, "EQ-4.10")
def slope_of_potential() -> Iterator[Finding]:
    """(4.10): dW/dz = d zx²/(1−z²)² + (c+d) xy/(1−z²) − z (1−z²)^(−1/2)."""
    derivatives, printed, forces = [], [], []
    for disk, state, _A, _omega in random_ones(18, 60, 1.1):
        c, d, X, Y, z = _scaled(disk, state)
        x, y, W = scaled(c, d, X, Y, z)
        slope = scaled_slope(c, d, x, y, z)
        derivative = scaled(c, d, X, Y, z + 1j * _STEP)[2].imag / _STEP
        derivatives.append((derivative - slope) / W)
        printed.append((derivative - scaled_slope(c, d, x, y, z, printed=True)) / W)
        M, unit = disk.I1 + disk.m * disk.r**2, disk.m * disk.g * disk.r
        forces.append((M * plain.tilting(disk, state) / (unit * np.cos(state[0])) + slope) / W)
    text = (
        "(4.10): CW minus a complex-step derivative of W, divided by W, 60 random states; as printed, C lacks an x"
    )
    off = {"4, vector field C": distance(printed, 0.0)}
    yield near(text, distance(derivatives, 0.0), 0.0, 1e-12, ROUNDING, off)
    text = "(4.10) less the force on φ by the plain equations, over W"
    yield near(text, distance(forces, 0.0), 0.0, 1e-12, "rounding, grown near flat")

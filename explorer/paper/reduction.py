"""Sections 3 and 4 of the paper as code: Chaplygin's equations, the amended potential, and scaling.

The potential comes from a series about the vertical, the motions from the plain equations and from
`ex.simulate`, periods and falls from `ex.periods` and `ex.passages`.
"""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp

import explorer as ex
from explorer.paper import eight_dimensions as plain
from explorer.paper.equations import (
    BODIES,
    OF_BODIES,
    ROUNDING,
    SOLVER,
    Swing,
    amended,
    chaplygin,
    far,
    followed,
    full_energy,
    full_motion,
    largest,
    parameters,
    plain_sigma_rates,
    random_body,
    random_state,
    sample,
    scaled,
    scaled_slope,
    tilting,
    turns,
    worst,
)
from explorer.paper.statement import Finding, statement

_Array = NDArray[np.float64]
_STEP = 1e-30  # of complex-step derivatives, which have no cancellation


def _chaplygin_rates(disk: ex.Disk, z: float, y: _Array) -> _Array:
    """Eq. (3.1)."""
    inertia = disk.m * disk.r**2
    return np.array([-disk.I3 / disk.I1 * y[1], -inertia / (disk.I3 + inertia) * y[0] / (1.0 - z * z)])


def _along(disk: ex.Disk, z: _Array, y: _Array) -> _Array:
    """(3.1) integrated from z[0] to z[-1], (2, n)."""
    run = solve_ivp(
        lambda s, x: _chaplygin_rates(disk, s, x), (z[0], z[-1]), y, "DOP853", z, rtol=1e-13, atol=1e-14
    )
    return np.asarray(run.y)


@statement(9, "EQ-3.1", "(3.1), (3.2): Chaplygin's equations hold along motions, and have four symmetries")
def chaplygin_equations() -> Iterator[Finding]:
    def gap(disk: ex.Disk) -> float:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 0.6 * disk.time_unit, 13))
        z, s3, s4 = full.sigma[:, 0], full.sigma[:, 2], full.sigma[:, 3]
        assert np.all(np.diff(z) > 0.0)  # one leg, so sigma_1 may be the variable
        return far(_along(disk, z, np.array([s3[0], s4[0]])), [s3, s4]) / disk.rate_unit

    found = worst(gap)
    text = f"(3.1) integrated in sigma_1 less sigma_3, sigma_4 of the plain motion: {OF_BODIES}"
    yield Finding(text, found, 0.0, found, 1e-10, SOLVER)
    disk, z = BODIES[0], np.linspace(-0.3, 0.9, 13)
    y = np.array([0.7, -0.4])
    solution = _along(disk, z, y)
    for signs in ((-1, -1, 1), (-1, 1, -1), (1, -1, -1)):
        image = np.array(signs[1:])
        gap_of = far(_along(disk, signs[0] * z, image * y), image[:, None] * solution)
        yield Finding(f"image of a solution under {signs} less a solution", gap_of, 0.0, gap_of, 0.0, "exact")
    rng = np.random.default_rng(9)
    phi, s2, s3, s4 = rng.uniform(-1.4, 1.4, (4, 200))
    one, other = ex.constants(disk, phi, s2, s3, s4), ex.constants(disk, -phi, s2, s3, -s4)
    gap_of = largest(
        [
            far(one.sigma3_bar, other.sigma3_bar),
            far(one.sigma4_bar, -other.sigma4_bar),
            far(one.eta_plus, other.eta_minus),
            far(one.energy, other.energy),
        ]
    )
    yield Finding("constants of 200 mirrored states, by ex.constants", gap_of, 0.0, gap_of, 1e-14, ROUNDING)


@statement(10, "EQ-3.5", "(3.5): sigma_3, sigma_4 continued to the vertical are constants of motion")
def constants() -> Iterator[Finding]:
    def drifts(disk: ex.Disk) -> tuple[float, float]:
        full = plain.integrate(disk, sample(disk), np.linspace(0.0, 3.0 * disk.time_unit, 31))
        phi = np.arcsin(full.sigma[:, 0])
        found = ex.constants(disk, phi, full.sigma[:, 1] / np.cos(phi), full.sigma[:, 2], full.sigma[:, 3])
        columns = np.array([found.sigma3_bar, found.sigma4_bar]) / disk.rate_unit
        z = full.sigma[0, 0]
        path = np.array([z, 0.0])
        start = _along(disk, path, full.sigma[0, 2:])[:, -1] / disk.rate_unit
        return far(columns, columns[:, :1]), far(columns[:, 0], start)

    found = np.array([drifts(disk) for disk in BODIES]).max(axis=0)
    text = f"drift of ex.constants along the plain motion: {OF_BODIES}"
    yield Finding(text, found[0], 0.0, found[0], 1e-10, "rtol 1e-12 over some hundred steps")
    text = "ex.constants of a state less (3.1) integrated to sigma_1 = 0"
    yield Finding(text, found[1], 0.0, found[1], 1e-12, "rtol 1e-13 over some ten steps")


@statement(11, "EQ-3.8", "(3.6)-(3.11): E = M phidot^2/2 + V(phi), and M phi'' = -V'(phi)")
def amended_potential() -> Iterator[Finding]:
    rng = np.random.default_rng(11)
    energies, forces = [], []
    for _ in range(60):
        disk = random_body(rng)
        state = random_state(rng, disk, 1.1)
        M = disk.I1 + disk.m * disk.r**2
        found = ex.constants(disk, *state)
        bar3, bar4, z = found.sigma3_bar[0], found.sigma4_bar[0], np.sin(state[0])
        A, omega = plain.start(*state)
        E = full_energy(disk, A[2], omega)
        energies.append(far((0.5 * M * state[1] ** 2 + amended(disk, bar3, bar4, z)) / E, 1.0))
        slope = amended(disk, bar3, bar4, z + 1j * _STEP).imag / _STEP * np.cos(state[0])
        forces.append(abs(M * tilting(disk, state) + slope) / E)
    text = "T + V of the plain equations over M phidot^2/2 + V with constants of ex.constants, 60 states"
    yield Finding(text, largest(energies), 0.0, largest(energies), 1e-13, "rounding of the two series")
    text = "(M phi'' of the plain equations + V')/E, V' by a complex step, 60 states"
    yield Finding(text, largest(forces), 0.0, largest(forces), 1e-12, "rounding, grown near flat")


@statement(12, "EQ-3.13", "(3.12), (3.13): times and the period are integrals over ((2/M)(E - V))^(-1/2)")
def period() -> Iterator[Finding]:
    gaps = []
    for disk in BODIES:
        state, unit = sample(disk), disk.time_unit
        swing = Swing(disk, state)
        tau = swing.period()
        moments = turns(disk, state, 1.6 * tau)
        of_explorer = ex.periods(ex.phi_to_states(disk, *state), accuracy=1e-12).period[0]
        times = np.linspace(0.0, 0.6 * unit, 5)
        phi = followed(disk, state, times, 1e-11).phi[0]
        legs = [swing.time(phi[0], angle) for angle in phi]
        swung = abs(moments[2] - moments[0] - tau) / tau
        gaps.append([swung, abs(of_explorer / tau - 1.0), far(legs, times) / unit])
    found = np.max(gaps, axis=0)
    text = f"(3.13) less the time between turning points of (2.15)-(2.18), relative: {OF_BODIES}"
    yield Finding(text, found[0], 0.0, found[0], 1e-10, "rtol 1e-12, events located in its interpolant")
    text = "(3.13) less ex.periods, relative"
    yield Finding(text, found[1], 0.0, found[1], 1e-11, "E - V cancels by three digits at the outer nodes")
    yield Finding("(3.12) less the times of ex.simulate", found[2], 0.0, found[2], 1e-10, "its accuracy 1e-11")


@statement(13, "PERIODIC", "3.3: generic motions of phi are periodic (Vierkandt), and phi(2 t+ - t) = phi(t)")
def periodic() -> Iterator[Finding]:
    def gaps(disk: ex.Disk) -> tuple[float, float]:
        state = sample(disk)
        tau = Swing(disk, state).period()
        full = plain.integrate(disk, state, np.array([0.0, tau]))
        t_plus = float(turns(disk, state, tau)[0])
        offsets = np.linspace(0.05, 1.0, 12) * t_plus
        times = np.concatenate([t_plus - offsets[::-1], t_plus + offsets])
        run = followed(disk, state, np.fmax(times, 0.0), 1e-11)
        return far(full.sigma[1], full.sigma[0]) / max(1.0, disk.rate_unit), far(run.phi[0], run.phi[0][::-1])

    found = np.array([gaps(disk) for disk in BODIES]).max(axis=0)
    text = f"sigma of the plain motion one period (3.13) later: {OF_BODIES}"
    yield Finding(text, found[0], 0.0, found[0], 1e-9, "rtol 1e-12, grown over one period")
    text = "phi(t+ + s) - phi(t+ - s) by ex.simulate, t+ from (2.15)-(2.18)"
    yield Finding(text, found[1], 0.0, found[1], 1e-9, "accuracy 1e-11, time of the turn known to 1e-11")
    rng, disk = np.random.default_rng(13), BODIES[0]
    states = np.array([random_state(rng, disk, 1.0) for _ in range(24)])
    tau = ex.periods(ex.phi_to_states(disk, *states.T), accuracy=1e-7).period
    apart = []
    for state, time in zip(states, tau, strict=True):
        run = followed(disk, state, [time], 1e-10)
        end = [run.phi[0][0], run.phidot[0][0], run.sigma3[0][0], run.sigma4[0][0]]
        apart.append(far(end, state))
    text = "24 random states, one period of ex.periods later by ex.simulate"
    yield Finding(text, largest(apart), 0.0, largest(apart), 1e-6, "periods to 1e-7")


@statement(
    14,
    "ASYMPTOTIC",
    "3.3: where V'(phi+) = 0 the motion never reaches phi+; beside it periods grow like -ln|E - Ec|/lambda",
)
def asymptotic() -> Iterator[Finding]:
    for disk in (BODIES[0], BODIES[3]):
        # Straight rolling too slow to be stable: V has a maximum at the vertical, where sigma3_bar = 0.
        spin, M = 0.3 * disk.rate_unit, disk.I1 + disk.m * disk.r**2
        growth = _growth(disk, spin)
        speeds = 10.0 ** np.arange(-1.0, -4.1, -0.5) * disk.rate_unit
        above = ex.periods(ex.phi_to_states(disk, 0.0, speeds, 0.0, spin), accuracy=1e-5).period
        # Twice past the vertical in one period; E - Ec = M phidot^2/2 there, with no cancellation.
        excess = np.log(0.5 * M * speeds**2 / (disk.m * disk.g * disk.r))
        slope = -2.0 / np.polyfit(excess[2:], above[2:], 1)[0]
        text = f"lambda from d tau/d ln(E - Ec) above the barrier, {disk.name} body, E - Ec over four decades"
        reason = "periods to 1e-5, and terms (E - Ec) ln(E - Ec)"
        yield Finding(text, float(slope), growth, abs(slope / growth - 1.0), 5e-4, reason)
        wrong = -np.diff(excess) / np.diff(above) * 2.0 / growth - 1.0
        order = float(np.polyfit(np.log(speeds[:4]), np.log(abs(wrong[:4]) / -excess[:4]), 1)[0])
        text = "order in phidot, a logarithm taken out, of what steps of half a decade are off by"
        yield Finding(text, order, 2, abs(order - 2.0), 0.2, "phidot^2 beside phidot^2 ln phidot")
        angles = speeds / growth
        s3, s4 = chaplygin(disk, 0.0, spin, np.sin(angles))
        states = ex.phi_to_states(disk, angles, 0.0, s3, s4)
        below = ex.periods(states, accuracy=1e-4).period
        slope = -1.0 / np.polyfit(excess[2:], below[2:], 1)[0]
        text = f"the same below the barrier, {disk.name} body, turning at {angles[2]:.0e} to {angles[-1]:.0e} rad"
        yield Finding(text, float(slope), growth, abs(slope / growth - 1.0), 5e-4, reason)
    disk, spin = BODIES[0], 0.3
    growth = _growth(disk, spin)
    M, z = disk.I1 + disk.m * disk.r**2, np.sin(0.3)
    drop = float(amended(disk, 0.0, spin, 0.0) - amended(disk, 0.0, spin, z))
    s3, s4 = chaplygin(disk, 0.0, spin, z)
    times = np.linspace(0.0, 9.0 / growth, 19)
    run = followed(disk, [0.3, -np.sqrt(2.0 / M * drop), s3, s4], times, 1e-11)
    rates = -np.diff(np.log(run.phi[0])) / np.diff(times)
    text = "rate at which phi decays on E = Ec, ex.simulate, phi from 0.3 to 4e-5"
    reason = "the error 1e-11 of the start grows by e^9 while phi falls by as much"
    yield Finding(text, float(rates[-1]), growth, abs(rates[-1] / growth - 1.0), 2e-3, reason)


def _growth(disk: ex.Disk, spin: float) -> float:
    """lambda of phi'' = lambda^2 phi at the vertical with sigma3_bar = 0, from the plain equations."""

    def force(angle: float) -> float:
        s3, s4 = chaplygin(disk, 0.0, spin, np.sin(angle))
        return tilting(disk, np.array([angle, 0.0, s3, s4])) / angle

    return float(np.sqrt((4.0 * force(5e-4) - force(1e-3)) / 3.0))


@statement(
    15,
    "PENDULUM",
    "3.4 [corrected: p = r A e1 + a]: where sigma_3 = sigma_4 = 0 the disk falls as a pendulum; p, psi, chi rest",
)
def pendulum() -> Iterator[Finding]:
    expected = {"uniform": (1.293920, 1.612452), "hoop": (1.325324, 1.527525)}
    for disk in BODIES[:2]:
        M = disk.I1 + disk.m * disk.r**2

        def pace(phi: float, M: float = M) -> float:
            return float(np.sqrt(1.0 + 2.0 / M * (1.0 - np.cos(phi))))

        got = ex.passages(disk, 0.0, 0.0, 1.0, accuracy=1e-11)
        time = quad(lambda phi: 1.0 / pace(phi), 0.0, 0.5 * np.pi, epsabs=1e-13)[0]
        found = np.array([got.fall_time[0], got.impact_speed[0]])
        text = f"time of the fall and speed of impact from phi = 0, phidot = 1, {disk.name}, by ex.passages"
        rows = tuple(float(value) for value in found)
        wanted = expected[disk.name]
        yield Finding(text, rows, wanted, far(found, wanted), 5e-7, "half a unit of the last decimal given")
        gap = far(found, [time, pace(0.5 * np.pi)])
        yield Finding("the same less (3.12) by SciPy's quad", gap, 0.0, gap, 1e-11, "accuracy 1e-11")
        start, omega = plain.start(0.0, 1.0, 0.0, 0.0, chi=0.0, psi=np.pi)
        y = np.concatenate([start.ravel(), [0.0, 0.0, disk.r], omega])
        until = quad(lambda phi: 1.0 / pace(phi), 0.0, 1.5, epsabs=1e-13)[0]
        full = full_motion(disk, y, np.linspace(0.0, until, 21))
        gap = abs(float(np.arcsin(full.u[-1, 2])) - 1.5)
        text = f"phi of the plain motion at the time (3.12) for 1.5 rad, less 1.5, {disk.name}"
        yield Finding(text, gap, 0.0, gap, 1e-9, "rtol 1e-12, 1/cos 1.5 = 14")
        p = full.a + disk.r * full.A[:, :, 0]
        gap = largest([far(p, p[0]), far(full.contact, p[0]), far(full.chi, 0.0), far(full.psi, np.pi)])
        text = "change of p = r A e1 + a, of chi and psi along the plain motion"
        yield Finding(text, gap, 0.0, gap, 1e-10, "rtol 1e-12 over some hundred steps")


@statement(
    16,
    "EQ-4.3",
    "(4.3), (4.7): c = m r^2 I3/(J I1), d = I3^2/(J I1), c + d = I3/I1; uniform 4/3, 2/3; hoop 1, 1",
)
def two_parameters() -> Iterator[Finding]:
    wanted = ("4/3", "2/3"), ("1", "1"), ("6/5", "4/5")
    for disk, (c, d) in zip(BODIES, wanted, strict=False):
        gap = far(parameters(disk)[:2], [float(Fraction(c)), float(Fraction(d))])
        rows = tuple(float(value) for value in parameters(disk)[:2])
        yield Finding(f"c, d of the {disk.name} body", rows, (c, d), gap, 1e-15, "rounding")
    rng = np.random.default_rng(16)
    slopes, sums = [], []
    for _ in range(100):
        disk = random_body(rng)
        state = random_state(rng, disk)
        A, omega = plain.start(*state)
        s2, _s2dot, s3dot, s4dot = plain_sigma_rates(disk, A[2], omega)
        q2 = np.cos(state[0]) ** 2
        slopes.append(q2 * s3dot * s4dot / (s2 * s2 * state[2] * state[3] * parameters(disk)[0]) - 1.0)
        sums.append(sum(parameters(disk)[:2]) - disk.I3 / disk.I1)
    text = "c over the product of both slopes of (3.1), from the plain equations, 100 random bodies"
    yield Finding(
        text, 1.0 + largest(slopes), 1.0, far(slopes, 0.0), 1e-12, "rounding over rates as small as 1e-3"
    )
    yield Finding("c + d - I3/I1 of the same bodies", far(sums, 0.0), 0.0, far(sums, 0.0), 1e-14, ROUNDING)


def _random_scaled(rng: np.random.Generator) -> tuple[ex.Disk, _Array, tuple[float, ...]]:
    """A disk, a state, and its (c, d, X, Y, z) with constants from ex.constants and eq. (4.9)."""
    disk = random_body(rng)
    state = random_state(rng, disk, 1.1)
    c, d, b = parameters(disk)
    found = ex.constants(disk, *state)
    X, Y = -disk.I1 * found.sigma3_bar[0] / (disk.I3 * b), found.sigma4_bar[0] / b
    return disk, state, (c, d, X, Y, float(np.sin(state[0])))


@statement(17, "EQ-4.6", "(4.1)-(4.9): scaling leaves c and d only, V = m g r W(X, Y; z)")
def scaling() -> Iterator[Finding]:
    rng = np.random.default_rng(17)
    potentials, momenta = [], []
    for _ in range(100):
        disk, state, given = _random_scaled(rng)
        x, y, W = scaled(*given)
        A, omega = plain.start(*state)
        V = full_energy(disk, A[2], omega) - 0.5 * (disk.I1 + disk.m * disk.r**2) * state[1] ** 2
        b = parameters(disk)[2]
        potentials.append(disk.m * disk.g * disk.r * W / V - 1.0)
        momenta.append(far([-disk.I3 / disk.I1 * b * x, b * y], state[2:]) / disk.rate_unit)
    text = "m g r W over E - M phidot^2/2 of the plain equations, 100 random bodies and states"
    yield Finding(text, 1.0 + largest(potentials), 1.0, far(potentials, 0.0), 1e-13, ROUNDING)
    gap = largest(momenta)
    yield Finding("sigma_3, sigma_4 by (4.1) less those of the state", gap, 0.0, gap, 1e-13, ROUNDING)


@statement(18, "EQ-4.10", "(4.10): dW/dz = d z x^2/(1-z^2)^2 + (c+d) x y/(1-z^2) - z (1-z^2)^(-1/2)")
def slope_of_potential() -> Iterator[Finding]:
    rng = np.random.default_rng(18)
    derivatives, forces = [], []
    for _ in range(60):
        disk, state, (c, d, X, Y, z) = _random_scaled(rng)
        slope = scaled_slope(c, d, X, Y, z)
        W = scaled(c, d, X, Y, z)[2]
        derivatives.append((scaled(c, d, X, Y, z + 1j * _STEP)[2].imag / _STEP - slope) / W)
        M, unit = disk.I1 + disk.m * disk.r**2, disk.m * disk.g * disk.r
        forces.append((M * tilting(disk, state) / (unit * np.cos(state[0])) + slope) / W)
    text = "(4.10) less a complex-step derivative of W, over W, 60 random bodies and states"
    yield Finding(text, far(derivatives, 0.0), 0.0, far(derivatives, 0.0), 1e-12, ROUNDING)
    text = "(4.10) less the force on phi by the plain equations, over W"
    yield Finding(text, far(forces, 0.0), 0.0, far(forces, 0.0), 1e-12, "rounding, grown near flat")

"""What decides the misprints of the paper's sections 5 to 7: orders and limits near flat, measured."""

import numpy as np
from scipy.integrate import quad, solve_ivp

from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.motion.trajectories import simulate
from explorer.paper import eight_dimensions as plain
from explorer.paper.chaplygin_series import Chaplygin
from explorer.paper.misprint_evidence import UNIFORM, Evidence, worst
from explorer.phase.constants import constants
from explorer.phase.disk import Disk
from explorer.phase.lines import line_slope
from explorer.phase.states import Array, constants_to_states, theta_to_states

SERIES = Chaplygin.of(UNIFORM)
M = UNIFORM.I1 + 1.0  # m = r = g = 1 here and below
J = UNIFORM.I3 + 1.0
R0, DR0 = (float(value) for value in SERIES.recessive(1.0))


def lemma_2() -> tuple[float, float, float]:
    """x(-0.6) for X = 0.7, Y = 0.4: from the printed u~, from the right one, from the equation itself."""
    X, Y, z = 0.7, 0.4, -0.6
    w, half = Y * R0 - X * DR0, 0.5 * SERIES.c

    def u(at: float) -> float:
        return float(SERIES.recessive(1.0 + at)[0]) ** -2 - (1.0 + at) ** -2 + half / (1.0 + at)

    r, integral = float(SERIES.recessive(1.0 + z)[0]), quad(u, 0.0, z, epsabs=1e-13)[0]
    right, printed = (
        X / R0 * r + w * r * (constant + integral - 1.0 / (1.0 + z) - half * np.log(1.0 + z))
        for constant in (1.0, 0.0)
    )
    found = solve_ivp(
        lambda at, x: (x[1], SERIES.c * x[0] / (1.0 - at * at)), (0.0, z), (X, Y), "DOP853", rtol=1e-13, atol=1e-14
    )
    return printed, right, float(found.y[0, -1])


def regular_part() -> Evidence:
    printed, right, truth = lemma_2()
    return Evidence(
        f"x(-0.6) for X = 0.7, Y = 0.4, c = 4/3: {printed:.4f} printed, {right:.4f} right, "
        f"{truth:.4f} by integrating eq. (4.4)",
        abs(printed - truth),
        abs(right - truth),
        1e-10,
    )


def lemma_3_end() -> Evidence:
    S, epsilon = 1e-8, 0.5
    x, y, _ = SERIES.near_flat(0.8, epsilon, S)
    slope, eta = float(SERIES.slope_of_W(x, y, S)), epsilon * UNIFORM.I3 / np.sqrt(J)
    leading = eta**2 / (4.0 * UNIFORM.I1)
    return Evidence(
        "V' from eq. (6.8) over the right side of (6.3), or of (6.4), less 1; at 1 - sigma1 = 1e-8",
        abs(slope / (leading / S) - 1.0),
        abs(slope / (leading / S**2) - 1.0),
        1e-4,
    )


def remainder_of_W() -> Evidence:
    """W less its two printed terms, against ln(1 - z): eq. (6.7) says no growth."""
    a, epsilon, S = 0.8, 0.5, np.geomspace(1e-9, 1e-7, 21)
    W = SERIES.near_flat(a, epsilon, S)[2]
    logs, half = np.log(S), 0.5 * SERIES.c
    rest = W - SERIES.d * epsilon**2 / (4.0 * S) - 0.5 * (epsilon * half * logs) ** 2
    grows = float(np.polyfit(logs, rest, 1)[0])
    # y = -(a + epsilon (c/2) (ln S + 1) + epsilon v1 + ...): its square has this multiple of ln S.
    expected = epsilon * half * (a + epsilon * half + epsilon * SERIES.v1) + 0.5 * SERIES.d * half * epsilon**2
    return Evidence(
        f"slope of W less its first two terms in ln(1 - z), {grows:.4f}, "
        f"less that of the printed O(1), 0, and of the logarithm in W, {expected:.4f}",
        abs(grows),
        abs(grows - expected),
        1e-3,
    )


def order_of_gravity() -> Evidence:
    """The last term of (4.10), by subtracting the first two from a difference quotient of W on l+."""
    S = np.geomspace(1e-6, 1e-4, 11)
    step = 1e-3 * S
    after, before = (SERIES.near_flat(0.8, 0.0, S - sign * step) for sign in (1.0, -1.0))
    x, y, _ = SERIES.near_flat(0.8, 0.0, S)
    q2 = S * (2.0 - S)
    smooth = SERIES.d * (1.0 - S) * x * x / q2**2 + (SERIES.c + SERIES.d) * x * y / q2
    term = (after[2] - before[2]) / (2.0 * step) - smooth
    exponent = float(np.polyfit(np.log(S), np.log(abs(term)), 1)[0])
    return Evidence(
        f"fitted exponent of the last term of (6.8) in 1 - z, {exponent:.4f}, less 1/2 or -1/2",
        abs(exponent - 0.5),
        abs(exponent + 0.5),
        1e-3,
    )


def lemma_4_end() -> Evidence:
    """On l+: a = X/r(0), epsilon = 0 at z = 1, and epsilon = 2 X r'(0) at z = -1."""
    X, S = 0.7, 1e-7
    here, there = (float(SERIES.near_flat(X / R0, epsilon, S)[2]) for epsilon in (0.0, 2.0 * X * DR0))
    limit = X**2 / (2.0 * R0**2)
    return Evidence(
        "W on l+ at 1e-7 from z = -1 (printed), or from z = 1, less X^2/2r(0)^2",
        abs(there - limit),
        abs(here - limit),
        1e-3,
    )


def lemma_4_minimum() -> Evidence:
    """The extension through phi = pi/2: W less its cosine is even there, the cosine odd."""
    X, delta = 0.7, 1e-3
    S = 2.0 * np.sin(0.5 * delta) ** 2
    inside = float(SERIES.near_flat(X / R0, 0.0, S)[2])
    outside, flat = inside - 2.0 * np.sin(delta), X**2 / (2.0 * R0**2)
    return Evidence(
        "how far the extension of W on l+ falls below its value at phi = pi/2, 0.001 beyond or before it",
        max(0.0, flat - outside),
        max(0.0, flat - inside),
        1e-6,
    )


def derivative_near_flat() -> Evidence:
    epsilon = 1e-5
    cosine = 1.5 * epsilon
    S = 2.0 * np.sin(0.5 * np.arcsin(cosine)) ** 2
    x, y, _ = SERIES.near_flat(0.8, epsilon, S)
    slope = cosine * float(SERIES.slope_of_W(x, y, S))
    form = SERIES.d * epsilon**2
    return Evidence(
        "1 - right side of (7.6) over cos(phi) W', at epsilon = 1e-5, cos phi = 1.5e-5",
        abs(1.0 - form * cosine**3 / slope),
        abs(1.0 - form / cosine**3 / slope),
        1e-3,
    )


def on_line(disk: Disk, theta: float, sigma3_bar: float) -> tuple[float, float]:
    """(sigma3, sigma4) on l+ at a tilt from flat, from the recessive solution, section 6.3."""
    series = Chaplygin.of(disk)
    r0 = float(series.recessive(1.0)[0])
    r, dr = series.recessive(2.0 * np.sin(0.5 * theta) ** 2)
    return float(sigma3_bar / r0 * r), float(disk.I1 * sigma3_bar / (disk.I3 * r0) * dr)


def acceleration_near_flat() -> Evidence:
    """phi-double-dot at rest by the plain equations: d/dt of sigma2 = phidot cos phi."""
    theta = 1e-5
    A, omega = plain.start(0.5 * np.pi - theta, 0.0, *on_line(UNIFORM, theta, 1.0))
    u = A[2]
    turning, udot = plain.angular_acceleration(UNIFORM, u, omega), np.cross(u, omega)
    sigma2dot = u[0] * turning[1] - u[1] * turning[0] + udot[0] * omega[1] - udot[1] * omega[0]
    found = float(sigma2dot / np.sin(theta))
    return Evidence(
        f"phi'' on l+ at rest 1e-5 from flat by the plain equations, {found:.5f}, less m g r or mgr/(I1 + m r^2)",
        abs(found - 1.0),
        abs(found - 1.0 / M),
        1e-3,
    )


def period_in_the_well() -> Evidence:
    """Small bounces on l+ for bodies of different I1 + m r^2: first eta, then E - V_0 small."""
    masses, times, theta = [], [], 1e-5
    for I1 in (0.02, 0.25, 0.5, 1.0, 2.0):
        disk = Disk(I1=I1, I3=1.5 * I1)
        state = theta_to_states(disk, theta, 0.0, *on_line(disk, theta, 1.0))
        period = float(periods(state, 1e-9, eta_hat=1e-14).period[0])
        # Next to flat E - V_0 is m g r theta: V' is -m g r there, eq. (6.10).
        masses.append(disk.I1 + 1.0)
        times.append(period / (2.0**1.5 * np.sqrt(theta)))
    exponent = float(np.polyfit(np.log(masses), np.log(times), 1)[0])
    return Evidence(
        f"fitted exponent of I1 + m r^2 in the period of small bounces, {exponent:.4f}, less -1/2 or 1/2",
        abs(exponent + 0.5),
        abs(exponent - 0.5),
        1e-3,
    )


def energy_near_flat() -> Evidence:
    """E - M phidot^2/2 just before the race, which is V_q at one of the ends."""
    eta_hat, before, S = 1e-8, 1e-4, 1e-9
    state = constants_to_states(UNIFORM, 1.0, eta_hat, 1.0)
    passage = passages(UNIFORM, 1.0, eta_hat, 1.0, accuracy=1e-9)
    t = 0.5 * float(passage.duration[0]) - before
    speed = simulate(UNIFORM, state, t_eval=[t], observables=("phidot",), accuracy=1e-9).phidot
    assert speed is not None
    potential = float(passage.energy[0]) - 0.5 * M * float(speed[0, 0]) ** 2
    X = -UNIFORM.I1 / UNIFORM.I3 * np.sqrt(J)  # eq. (4.9) for sigma3_bar = 1
    here, there = (float(SERIES.near_flat(X / R0, epsilon, S)[2]) for epsilon in (0.0, 2.0 * X * DR0))
    return Evidence(
        "E - (M/2) phidot^2 just before the race on face +1, less V_q at 1e-9 from sigma1 = -1 or from sigma1 = 1",
        abs(potential - there),
        abs(potential - here),
        1e-3,
    )


def orders_of_rates() -> Evidence:
    """Rates of chi and psi at the flattest moment on face -1, over 2 (E - V_0)/eta_-, their limit."""
    eta_hat = 1e-6
    state = constants_to_states(UNIFORM, 1.0, eta_hat, -1.0, face=-1)
    passage = passages(UNIFORM, 1.0, eta_hat, 1.0, face=-1, accuracy=1e-9)
    step = 1e-3 * float(passage.theta_min[0] / passage.impact_speed[0])
    t = 0.5 * float(passage.duration[0]) + step * np.array([-1.0, 1.0])
    found = simulate(UNIFORM, state, t_eval=t, observables=("chi", "psi"), accuracy=1e-9)
    assert found.chi is not None
    assert found.psi is not None
    largest = M * float(passage.impact_speed[0]) ** 2 / (eta_hat * UNIFORM.I3 * R0)
    chi, psi = (float(np.diff(angle[0])[0] / np.diff(t)[0] / largest) for angle in (found.chi, found.psi))
    return Evidence(
        f"on face -1 the rates of chi and psi are {chi:+.4f} and {psi:+.4f} times 2(E - V_0)/eta_-; "
        "distance to (-1, +1) as printed, to (+1, -1)",
        max(abs(chi + 1.0), abs(psi - 1.0)),
        max(abs(chi - 1.0), abs(psi + 1.0)),
        1e-3,
    )


def small_quantity() -> Evidence:
    """Lemma 7's stretch, where sigma4 has its limit (7.20) already and the race is not on."""
    eta_hat = 1e-8
    state = constants_to_states(UNIFORM, 1.0, eta_hat, 1.0)
    flat = 0.5 * float(passages(UNIFORM, 1.0, eta_hat, 1.0, accuracy=1e-9).duration[0])
    times = flat - np.geomspace(2e-2, 2e-3, 20)
    found = simulate(UNIFORM, state, t_eval=times, observables=("phi", "sigma4"), accuracy=1e-9)
    assert found.phi is not None
    assert found.sigma4 is not None
    limit = UNIFORM.I1 / (UNIFORM.I3 * R0)
    settled: Array = np.sin(found.phi[0][abs(found.sigma4[0] - limit) < 1e-2])
    return Evidence(
        "1 + sigma1 (printed as small), or 1 - sigma1, least and largest on the way down where sigma4 is "
        "within 0.01 of (7.20), face +1",
        float(np.min(1.0 + settled)),
        worst(1.0 - settled),
        1e-2,
    )


def eta_of_right_panels() -> Evidence:
    """The text's second start, sigma4 = (I1 r'(0))/(I3 r(0)) + 0.01: its eta_+/(I3 r(0))."""
    bodies = (UNIFORM, Disk.hoop())
    eta = [float(constants(disk, 0.0, 1.0, 1.0, line_slope(disk) + 0.01).eta_hat_plus[0]) for disk in bodies]
    return Evidence(
        "eta_+/(I3 r(0)) of the second start that the text gives, less 0.01 or -0.01, both bodies",
        worst(np.array(eta) - 0.01),
        worst(np.array(eta) + 0.01),
        1e-12,
    )

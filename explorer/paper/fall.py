"""Statements 27 to 39: who falls flat, and how a fall ends (section 6 of the paper).

All bodies have m = r = g = 1. Tilt is the angle from the flat state of one side (+1 or -1). What is
checked against the exact layer is integrated here from eqs (2.15)-(2.18) and (3.1) as they stand, by
SciPy, without the kernels' series or variables.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import gamma

from explorer import compiled
from explorer.measure import laws
from explorer.measure.density import Density
from explorer.measure.falling_constant import falling_constant
from explorer.measure.sampling import Box
from explorer.measure.tubes import dimensions, draw_tube, widest_eta
from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.motion.plan import plan
from explorer.motion.trajectories import simulate
from explorer.motion.turning_points import smallest_tilt
from explorer.paper import eight_dimensions as plain
from explorer.paper.statement import Finding, statement
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import line_chart, line_slope
from explorer.phase.membership import falls_of
from explorer.phase.states import Array, phi_to_states

UNIFORM, HOOP, MATCHING = Disk.uniform(), Disk.hoop(), Disk.matching()
THICK = Disk(I1=0.5, I3=0.3, name="thick")  # I3 < 2 I1: not planar
PLANAR = (UNIFORM, HOOP, MATCHING)
BODIES = (*PLANAR, THICK)
_TIGHT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}


def near(computed: str, measured: Any, expected: Any, tolerance: float, reason: str) -> Finding:
    """A Finding whose error is the largest absolute difference of numbers or arrays."""
    error = float(np.max(abs(np.asarray(measured, dtype=float) - expected)))
    return Finding(computed, _shown(measured), _shown(expected), error, tolerance, reason)


def at_most(computed: str, value: float, bound: float, reason: str) -> Finding:
    """A Finding for a number that must not exceed a bound."""
    return Finding(computed, float(value), f"at most {bound:g}", float(value), bound, reason)


def _shown(values: Any) -> Any:
    array = np.asarray(values, dtype=float)
    return float(array) if array.ndim == 0 else ", ".join(f"{v:.9g}" for v in array.ravel()[:6])


def exponent(x: Any, y: Any) -> float:
    """The slope of ln|y| against ln|x|, least squares."""
    return float(np.polyfit(np.log(abs(np.asarray(x))), np.log(abs(np.asarray(y))), 1)[0])


def closed_form(disk: Disk) -> tuple[float, float]:
    """(r(0), r'(0)) by gamma functions, eqs (5.11), (5.12)."""
    c = disk.I3 / (disk.I1 * (disk.I3 + 1.0))
    root = np.sqrt(complex(1.0 - 4.0 * c)) / 4.0
    r0 = gamma(1.5) / (gamma(1.25 - root) * gamma(1.25 + root))
    return float(r0.real), float((gamma(0.5) / (gamma(0.75 - root) * gamma(0.75 + root))).real)


def rates_down(
    disk: Disk, sigma3_bar: float, sigma4_bar: float, face: int, tilts: Sequence[float] | Array
) -> Array:
    """(sigma3, sigma4), (2, n), at falling tilts below pi/2 from their values at the vertical: eq. (3.1)."""
    k, h = disk.I3 / disk.I1, 1.0 / (disk.I3 + 1.0)

    def rate(y: float, s: Array) -> list[float]:
        tilt = np.exp(y)
        return [face * k * s[1] * np.sin(tilt) * tilt, face * h * s[0] * tilt / np.sin(tilt)]

    ends = float(np.log(0.5 * np.pi)), float(np.log(tilts[-1]))
    return solve_ivp(rate, ends, [sigma3_bar, sigma4_bar], t_eval=np.log(tilts), **_TIGHT).y


def potential(disk: Disk, tilts: Any, sigma: Array) -> Array:
    """The amended potential, eq. (3.8)."""
    q = np.sin(tilts)
    return 0.5 * disk.I1 * (sigma[0] / q) ** 2 + 0.5 * (disk.I3 + 1.0) * sigma[1] ** 2 + q


@lru_cache
def shot_slope(disk: Disk) -> float:
    """sigma4_bar/sigma3_bar for which sigma3 vanishes at flat on face +1, by shooting."""
    end = [rates_down(disk, *start, 1, [1e-9])[0, -1] for start in ((1.0, 0.0), (0.0, 1.0))]
    return float(-end[0] / end[1])


def reduced(disk: Disk, face: int, start: Sequence[float], t_end: float, events: Any = None) -> Any:
    """Eqs (2.15)-(2.18), (2.22), (2.31) from (tilt, its rate, sigma3, sigma4) up to an event, by SciPy.

    Rows of y: tilt, rate, sigma3, sigma4, chi, psi.
    """
    k, h, M = disk.I3 / disk.I1, 1.0 / (disk.I3 + 1.0), disk.I1 + 1.0

    def rate(_t: float, y: Array) -> list[float]:
        tilt, speed, s3, s4 = y[:4]
        q, z, p = np.sin(tilt), face * np.cos(tilt), face * speed
        turn = s3 / (q * q)
        pull = (z * disk.I1 * turn * s3 / q - s3 * s4 / (h * q) - z) / M
        return [speed, face * pull, k * q * s4 * p, h * p * s3 / q, turn, z * turn - s4]

    y0 = [*start, 0.0, 0.0]
    return solve_ivp(rate, (0.0, t_end), y0, events=events, dense_output=True, max_step=0.25, **_TIGHT)


def observed(disk: Disk, start: Any, times: Array, *names: str) -> list[Any]:
    """Observables of integrated motions, each (n, times, ...)."""
    run = simulate(disk, start, t_eval=times, observables=names, method="dop853", accuracy=1e-11)
    return [getattr(run, name) for name in names]


@statement(27, "EQ-6.1", "(6.1) l± are the lines on which σ₃ vanishes at flat: σ̄₄/σ̄₃ = ±(I₁/I₃) r′(0)/r(0).")
def lines() -> Iterator[Finding]:
    for disk in BODIES:
        r0, dr0 = closed_form(disk)
        want, why = disk.I1 * dr0 / (disk.I3 * r0), "eq. (3.1) is integrated to 1e-13"
        yield near(f"{disk.name}: slope by shooting", shot_slope(disk), want, 1e-11, why)
        yield near(f"{disk.name}: slope by the series", line_slope(disk), want, 1e-14, "rounding")
        flat = rates_down(disk, 1.0, -want, -1, [1e-3])[:, -1]
        yield near(f"{disk.name}: σ₃ near flat on l₋", flat[0], 0.0, 1e-6, "σ₃ is of order tilt² = 1e-6 there")


@statement(28, "LEMMA-3", "Lemma 3, (6.3), (6.4): off l± V ~ η²/4I₁(1∓σ₁), V′ ~ ±η²/4I₁(1∓σ₁)²; rest [corrected].")
def barrier_off_lines() -> Iterator[Finding]:
    step, coarse = 1e-4, np.geomspace(0.03, 1e-3, 12)
    for disk, face in ((UNIFORM, 1), (HOOP, -1), (THICK, 1), (THICK, -1)):
        r0, dr0 = closed_form(disk)
        eta = disk.I1 * dr0 - face * disk.I3 * r0 * 0.3
        tilts = np.ravel([[t * (1.0 + step), t, t * (1.0 - step)] for t in (1e-2, 1e-3, 1e-4, 1e-5)])
        V = potential(disk, tilts, rates_down(disk, 1.0, 0.3, face, tilts)).reshape(4, 3)
        S = 2.0 * np.sin(0.5 * tilts[1::3]) ** 2
        ratio = V[:, 1] * 4.0 * disk.I1 * S / eta**2
        slope = (V[:, 0] - V[:, 2]) / (2.0 * step * tilts[1::3]) / -np.sin(tilts[1::3])
        where = f"{disk.name}, side {face:+d}:"
        why = "at tilt 1e-5; the next term is θ² ln²θ = 1e-8 of it"
        yield near(f"{where} V·4I₁(1∓σ₁)/η², tilts 1e-2 to 1e-5", ratio[-1], 1.0, 1e-6, why)
        dV = slope[-1] * 4.0 * disk.I1 * S[-1] ** 2 / eta**2
        yield near(f"{where} ±V′·4I₁(1∓σ₁)²/η²", dV, 1.0, 1e-6, why + "; a difference quotient")
        V = potential(disk, coarse, rates_down(disk, 1.0, 0.3, face, coarse))
        S = 2.0 * np.sin(0.5 * coarse) ** 2
        rest = np.polyfit(np.log(S), V - eta**2 / (4.0 * disk.I1 * S), 2)[0]
        c = disk.I3 / (disk.I1 * (disk.I3 + 1.0))
        want = 0.5 * (disk.I3 + 1.0) * (eta * c / (2.0 * disk.I3)) ** 2
        why = "terms S ln²S that the fit leaves out"
        yield near(f"{where} coefficient of ln²(1∓σ₁) in the rest, over ½J(cη/2I₃)²", rest / want, 1.0, 0.05, why)


@statement(29, "SEC-6.1", "6.1: off l± the disk never falls flat, and its motions exist for all time.")
def no_fall_off_lines() -> Iterator[Finding]:
    random = np.random.Generator(np.random.Philox(29))
    low, high = np.array([[-1.5, -2.0, -2.0, -2.0], [1.5, 2.0, 2.0, 2.0]])
    for disk in BODIES:
        rows = random.uniform(low, high, (4000, 4))
        states = phi_to_states(disk, *rows.T)
        theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-8, "quadrature"))
        natural = natural_constants(states)
        stuck = int((status != 0).sum() + (~(theta > 0.0)).sum())
        yield near(f"{disk.name}: of 4000 plain draws, falls or zero tilts", stuck, 0, 0.0, "a count")
        eta = np.fmin(abs(natural.eta_plus), abs(natural.eta_minus)) / (disk.I3 * closed_form(disk)[0])
        bound = np.array([widest_eta(natural.energy[i : i + 1], theta[i], disk)[0] for i in range(400)])
        share = float((eta[:400] / bound).max())
        yield at_most(f"{disk.name}: largest η, over what the energy allows at θ_min", share, 1.0, "a bound")
        phi = observed(disk, rows[:12], np.linspace(0.0, 60.0, 400), "phi")[0]
        lower = 1.0 - float((np.cos(phi).min(axis=1) / np.sin(theta[:12])).min())
        why = "the accuracy 1e-8 of θ_min, 1e-11 a passage of the motion; NaN where one ends"
        yield at_most(f"{disk.name}: 12 motions to t = 60, how far below sin θ_min they come", lower, 1e-7, why)


@statement(30, "EQUILIBRIA", "6.1: for fixed (σ̄₃,σ̄₄) ∉ l± none near flat; as η → 0 one at θ₀ ~ (η²/I₁mgr)^⅓.")
def equilibria_near_flat() -> Iterator[Finding]:
    for disk in (UNIFORM, HOOP, THICK):

        def down(log_tilt: float, eta_hat: float, disk: Disk = disk) -> tuple[float, Array]:
            """(dV/dφ, (σ₃, σ₄)) by the exact layer, eq. (4.10)."""
            tilt = np.exp(log_tilt)
            q, z = np.sin([tilt]), np.cos([tilt])
            s3, s4 = line_chart(disk, q, z).rates(0.3, eta_hat)
            slope = disk.I1 * s3 * s3 * z / q**3 - (disk.I3 + 1.0) * s3 * s4 / q - z
            return float(slope[0]), np.array([s3[0], s4[0]])

        etas, eta_unit = 10.0 ** -np.arange(6.0, 15.0), disk.I3 * closed_form(disk)[0]
        want = (etas * etas * eta_unit**2 / disk.I1) ** (1.0 / 3.0)
        root = [
            brentq(lambda y, e=e: down(y, e)[0], np.log(0.2 * t), np.log(5.0 * t), xtol=1e-14)
            for e, t in zip(etas, want, strict=True)
        ]
        theta = np.exp(root)
        why = "corrections are of order η^⅓, 1e-2 to 1e-5 here"
        yield near(f"{disk.name}: exponent of θ₀ in η", exponent(etas[3:], theta[3:]), 2.0 / 3.0, 1e-3, why)
        yield near(f"{disk.name}: θ₀ over (η²/I₁mgr)^⅓ at η̂ = 1e-14", theta[-1] / want[-1], 1.0, 1e-3, why)
        least = min(down(y, 0.2)[0] for y in np.linspace(np.log(1e-8), np.log(0.02), 400))
        why = "V′ points away from flat, so there is no equilibrium"
        yield at_most(f"{disk.name}: η̂ = 0.2, the largest −V′ at tilts below 0.02", -least, 0.0, why)
        rest = reduced(disk, 1, (theta[0], 0.0, *down(root[0], etas[0])[1]), 20.0 * np.sqrt(theta[0]))
        moved, why = float(abs(rest.y[0] / theta[0] - 1.0).max()), "SciPy at 1e-13; η to 1e-9"
        yield near(f"{disk.name}: released at rest at θ₀ (η̂ = 1e-6) it moves by", moved, 0.0, 1e-8, why)


@lru_cache
def on_line(disk: Disk, face: int) -> Chebyshev:
    """V on l_side with σ̄₃ = 1 as a polynomial in the tilt, from tilts 0.01 to 1: it knows nothing of flat."""

    def V(tilts: Array) -> Array:
        falling = np.sort(tilts)[::-1]
        values = potential(disk, falling, rates_down(disk, 1.0, face * shot_slope(disk), face, falling))
        return values[np.argsort(np.argsort(-tilts))]

    return Chebyshev.interpolate(V, 18, domain=[0.01, 1.0])


_FIT = "extrapolated from tilts above 0.01; the fit's tail is 1e-12 and grows a hundredfold"


@statement(31, "LEMMA-4", "Lemma 4, (6.9): on l± V(φ) extends analytically to flat, V(±π/2) = I₁²J σ̄₃²/2I₃²r(0)².")
def potential_at_flat() -> Iterator[Finding]:
    for disk in BODIES:
        want = disk.I1**2 * (disk.I3 + 1.0) / (2.0 * disk.I3**2 * closed_form(disk)[0] ** 2)
        for face in (1, -1):
            V = on_line(disk, face)
            yield near(f"{disk.name}, side {face:+d}: V(±π/2)/σ̄₃²", float(V(0.0)), want, 1e-11, _FIT)
        rate = float(np.polyfit(np.arange(14), np.log(abs(V.coef[2:16])), 1)[0])
        why = "a logarithm or root at flat would give algebraic decay, ratio above 0.8"
        yield at_most(f"{disk.name}: ratio of successive Chebyshev coefficients", float(np.exp(rate)), 0.5, why)


@statement(32, "EQ-6.10", "(6.10): on l± V′(±π/2) = ∓mgr: V has a strict one-sided minimum at flat [corrected].")
def slope_at_flat() -> Iterator[Finding]:
    for disk in BODIES:
        for face in (1, -1):
            V = on_line(disk, face)
            slope = -face * float(V.deriv()(0.0))  # φ = side (π/2 - tilt)
            yield near(f"{disk.name}, side {face:+d}: V′(±π/2)", slope, -face, 1e-9, _FIT)
            tilts = np.linspace(1e-3, 0.2, 60)
            least = float(((V(tilts) - V(0.0)) / tilts).min())
            yield at_most(f"{disk.name}, side {face:+d}: largest (V₀ − V)/θ up to tilt 0.2", -least, 0.0, "a sign")


@statement(35, "CODIM-1", "6.2: F has codimension one: P(θ_min < δ) ~ Cδ; no state drawn plainly lies on it.")
def codimension_one() -> Iterator[Finding]:
    deltas, draws = np.array([1e-3, 1e-5, 1e-7]), 6000
    random = np.random.Generator(np.random.Philox(35))
    for disk in (UNIFORM, HOOP, THICK):
        density = Density.of(disk)
        C = falling_constant(disk)
        value, error = np.zeros(3), np.zeros(3)
        for i, delta in enumerate(deltas):
            for face in (1, -1):
                found = draw_tube(disk, density, C.mass, face, delta, random.random((draws, dimensions(density))))
                hit = np.where(found.theta_min < delta, found.weight, 0.0)
                value[i] += hit.mean()
                error[i] = np.hypot(error[i], hit.std() / np.sqrt(draws))
        ladder = laws.Ladder(deltas, value, error, np.full(3, 2.0 * draws))
        slope, constant = laws.fit_slope(ladder), laws.fit_constant(ladder)
        why = f"four standard errors of {draws} draws per δ and side"
        yield near(f"{disk.name}: slope of ln P in ln δ, δ = 1e-3 to 1e-7", slope.value, 1.0, 4 * slope.error, why)
        yield near(f"{disk.name}: C by draws beside F", constant.value, C.value, 4 * constant.error, why)
        lot = Box.default(disk).draw(random, 100_000)
        hits = int((falls_of(phi_to_states(disk, **lot)).status == compiled.status.Status.FALLS).sum())
        yield near(f"{disk.name}: exact falls in 10⁵ plain draws (so P < 3e-5)", hits, 0, 0.0, "a count")
    yield near("uniform: C", falling_constant(UNIFORM).value, 1.46927, 6e-6, "digits of the earlier quadrature")


@lru_cache
def ending(disk: Disk, face: int) -> tuple[Array, plain.PlainMotion]:
    """The 8-dimensional motion at times 0.01 to 0.3 before it falls from the vertical with speed and σ̄₃ of 1."""
    tau = 0.155 + 0.145 * np.cos(np.pi * (np.arange(14) + 0.5) / 14)
    impact = passages(disk, 1.0, 0.0, 1.0, face).fall_time[0]
    start = 0.0, float(face), 1.0, face * shot_slope(disk)
    return tau, plain.integrate(disk, start, impact - tau)


def at_impact(tau: Array, values: Any, order: int = 0) -> Any:
    """The limit at the impact of values (n,) or (n, k), or of their rate of change, by a polynomial."""
    flat = np.reshape(values, (tau.size, -1))
    found = np.polynomial.polynomial.polyfit(tau / 0.3, flat, 11)[order] / (-0.3) ** order
    return found.reshape(np.shape(values)[1:])


def approach(tau: Array, values: Any) -> float:
    """The exponent of the distance to the limit in t* - t, from the five times nearest to the impact."""
    away = np.reshape(values - at_impact(tau, values), (tau.size, -1))[-5:]
    return exponent(tau[-5:], np.linalg.norm(away, axis=1))


_LIMIT = "8-dimensional motion at 1e-12, extrapolated from t* − t ≥ 0.01"
_RATE = "the next power of t* − t, 0.01 to 0.1 here"
_CASES = [(disk, face, f"{disk.name}, side {face:+d}:") for disk in (UNIFORM, HOOP, THICK) for face in (1, -1)]


@statement(36, "PROP-1", "Prop. 1, (6.12), (6.13): it falls with a bang: φ̇ → ±A = ±√(2(E − V₀)/M) [corrected].")
def bang() -> Iterator[Finding]:
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        phidot = motion.sigma[:, 1] / np.hypot(*motion.u.T[:2])
        r0, J = closed_form(disk)[0], disk.I3 + 1.0
        V0 = J * disk.I1**2 / (2.0 * disk.I3**2 * r0**2)
        E = 0.5 * (disk.I1 + 1.0) + 0.5 * disk.I1 + 0.5 * J * shot_slope(disk) ** 2 + 1.0
        A = np.sqrt(2.0 * (E - V0) / (disk.I1 + 1.0))
        yield near(f"{where} φ̇ at flat", at_impact(tau, phidot), face * A, 1e-8, _LIMIT)
        yield near(f"{where} exponent of the approach", approach(tau, phidot), 1.0, 0.1, _RATE)
    for disk, A in ((UNIFORM, 1.816042), (HOOP, 1.758017)):
        speed = passages(disk, 1.0, 0.0, 1.0).impact_speed[0]
        yield near(f"{disk.name}: A by quadrature for the data of the figures", speed, A, 6e-7, "digits given")


@statement(37, "EQ-6.14", "(6.14), (6.15): at flat σ₃/(1∓σ₁) → σ̄₃/r(0) and σ₄ → ±I₁σ̄₃/(I₃ r(0)).")
def momenta_at_flat() -> Iterator[Finding]:
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        s1, _, s3, s4 = motion.sigma.T
        r0 = closed_form(disk)[0]
        ratio = s3 * (1.0 + face * s1) / (motion.u[:, :2] ** 2).sum(axis=1)  # 1 - σ₁² without cancellation
        yield near(f"{where} σ₃/(1∓σ₁)", at_impact(tau, ratio), 1.0 / r0, 1e-7, _LIMIT)
        yield near(f"{where} σ₄", at_impact(tau, s4), face * disk.I1 / (disk.I3 * r0), 1e-8, _LIMIT)
        both = [approach(tau, ratio), approach(tau, s4)]
        yield near(f"{where} exponents of both (analytic in 1∓σ₁)", both, 2.0, 0.05, _RATE)


@statement(38, "EQ-6.16", "(6.16): ψ̇ → ∓(−½ + I₁/I₃) σ̄₃/r(0) at flat, zero for planar bodies.")
def spin_of_psi() -> Iterator[Finding]:
    for disk in BODIES:
        for face in (1, -1):
            tau, motion = ending(disk, face)
            want = -face * (-0.5 + disk.I1 / disk.I3) / closed_form(disk)[0]
            rate = at_impact(tau, motion.psi, 1)
            yield near(f"{disk.name}, side {face:+d}: rate of the angle ψ", rate, want, 1e-6, _LIMIT)


@statement(39, "EQ-6.17", "(6.17)–(6.19): u̇, ω and the point of contact converge at flat, at a rate O(t* − t).")
def vectors_at_flat() -> Iterator[Finding]:
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        psi, speed = at_impact(tau, motion.psi), face * passages(disk, 1.0, 0.0, 1.0, face).impact_speed[0]
        spin = face * disk.I1 / (disk.I3 * closed_form(disk)[0])
        hinge = np.array([np.cos(psi), np.sin(psi), 0.0])
        udot = np.cross(motion.u, motion.omega)
        yield near(f"{where} u̇", at_impact(tau, motion.u, 1), -face * speed * hinge, 1e-6, _LIMIT)
        want = np.array([-speed * hinge[1], speed * hinge[0], spin])
        yield near(f"{where} ω", at_impact(tau, motion.omega), want, 1e-7, _LIMIT)
        limit = limit_motion(disk, (0.0, float(face), 1.0, face * shot_slope(disk)))
        point = limit(limit.impacts(5.0)[0] * (1.0 - 1e-14)).contact
        yield near(f"{where} point of contact", at_impact(tau, motion.contact), point, 1e-7, _LIMIT)
        rates = [approach(tau, v) for v in (udot, motion.omega, motion.contact)]
        want = np.array([1.0, 1.0, 1.0 if disk is THICK else 3.0])  # p moves at rψ̇, which (6.16) makes O((t*-t)²)
        yield near(f"{where} exponents of u̇, ω, p", rates, want, 0.05, _RATE)

"""Statements 40 to 49: the bounce near flat and the race of the contact point (sections 7.1 to 7.3 of the paper).

Limits eta -> 0 are taken along sequences of eta_hat. Three ways to one passage check each other: SciPy on the
reduced equations as they stand (`reduced`), the integrators on the regularised ones, and quadrature.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyfit

from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.motion.passages_by_quadrature import fall_from_vertical
from explorer.motion.periods import periods
from explorer.paper import eight_dimensions as plain
from explorer.paper.fall import (
    BODIES,
    HOOP,
    THICK,
    UNIFORM,
    at_most,
    closed_form,
    exponent,
    near,
    observed,
    potential,
    rates_down,
    reduced,
    shot_slope,
)
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states, theta_to_states

_LOG = "the next term is of order η ln(1/η)"


@dataclass(frozen=True)
class Passage:
    """One passage by SciPy from the vertical with speed and sigma3_bar of 1.

    eta, energy, V0 (eq. 6.9), A (7.1); middle: the time of the smallest tilt theta_min; at: tilt, rate, sigma3,
    sigma4, chi, psi at times from 0 to beyond 2 middle.
    """

    eta: float
    energy: float
    V0: float
    A: float
    middle: float
    theta_min: float
    at: Callable[[Any], Array]


@lru_cache
def passage(disk: Disk, eta_hat: float, face: int = 1) -> Passage:
    """See Passage; eta_hat is that of `face`."""
    r0, J, M = closed_form(disk)[0], disk.I3 + 1.0, disk.I1 + 1.0
    s4 = face * (shot_slope(disk) - eta_hat)
    V0 = 0.5 * J * (disk.I1 / (disk.I3 * r0)) ** 2

    def turning(_t: float, y: Array) -> float:
        return y[1]

    turning.direction = 1.0  # type: ignore[attr-defined]
    motion = reduced(disk, face, (0.5 * np.pi, -1.0, 1.0, s4), 2.6, turning)
    energy = 0.5 * M + 0.5 * disk.I1 + 0.5 * J * s4 * s4 + 1.0
    middle, tilt = float(motion.t_events[0][0]), float(motion.y_events[0][0][0])
    A = float(np.sqrt(2.0 * (energy - V0) / M))
    return Passage(disk.I3 * r0 * eta_hat, energy, V0, A, middle, tilt, motion.sol)


def level(found: Passage, share: float) -> tuple[float, float]:
    """The times beside the middle at which V - V0 is a share of E - V0: phidot = ±A sqrt(1 - share)."""
    speed = found.A * np.sqrt(1.0 - share)
    width = found.theta_min / found.A * np.sqrt((1.0 - share) / share)
    ends = []
    for sign in (-1.0, 1.0):
        near_, far = 0.0, 3.0 * width
        for _ in range(60):
            half = 0.5 * (near_ + far)
            if abs(found.at(found.middle + sign * half)[1]) < speed:
                near_ = half
            else:
                far = half
        ends.append(found.middle + sign * half)
    return ends[0], ends[1]


def logarithmic(eta: Array, away: Array) -> tuple[float, float]:
    """(a, relative size of what is left) of the fit away = a eta ln(1/|eta|) + b eta."""
    terms = np.stack([eta * np.log(1.0 / abs(eta)), eta], axis=1) / abs(eta[:, None])
    scaled = away / abs(eta)
    found = np.linalg.lstsq(terms, scaled, rcond=None)[0]
    return float(found[0]), float(abs(terms @ found - scaled).max() / abs(scaled).max())


ETAS = (1e-2, 1e-3, 1e-4, 1e-5)


@statement(40, "LEMMA-5", "Lemma 5: near flat cos φ and the duration are O(|η|), φ̇ goes steadily from A to −A.")
def bounce() -> Iterator[Finding]:
    for disk in (UNIFORM, HOOP, THICK):
        runs = [passage(disk, eta) for eta in ETAS]
        eta = np.array([run.eta for run in runs])
        theta = np.array([run.theta_min for run in runs])
        excess = np.array([run.energy - run.V0 for run in runs])
        lead = theta * np.sqrt(2.0 * disk.I1 * excess) / eta
        yield near(f"{disk.name}: exponent of θ_min in η, 1e-2 to 1e-5", exponent(eta, theta), 1.0, 0.02, _LOG)
        left = logarithmic(eta[1:], lead[1:] - 1.0)[1]
        yield at_most(f"{disk.name}: θ_min√(2I₁(E−V₀))/η − 1, misfit of η ln(1/η) and η", left, 0.05, "η² ln²η")
        tiny = passages(disk, 1.0, [1e-8, -1e-8, 1e-12, -1e-12], 1.0)
        unit = disk.I3 * closed_form(disk)[0] * np.array([1e-8, 1e-8, 1e-12, 1e-12])
        lead = tiny.theta_min * tiny.impact_speed * np.sqrt(disk.I1 * (disk.I1 + 1.0)) / unit
        yield near(f"{disk.name}: θ_min√(2I₁(E−V₀))/η at ±1e-8, ±1e-12 by quadrature", lead, 1.0, 1e-6, _LOG)
        times = np.array([np.diff(level(run, 0.5))[0] for run in runs])
        run, rate = runs[-1], exponent(eta, times)
        yield near(f"{disk.name}: exponent in η of the time with V−V₀ > ½(E−V₀)", rate, 1.0, 0.02, _LOG)
        width = times[-1] * run.A / (2.0 * run.theta_min)
        yield near(f"{disk.name}: that time over 2θ_min/A, η̂ = 1e-5", width, 1.0, 1e-3, _LOG)
        rates = runs[2].at(runs[2].middle + np.linspace(-8.0, 8.0, 400) * runs[2].theta_min / runs[2].A)[1]
        rise = -float(np.diff(rates).min() / runs[2].A)
        yield at_most(f"{disk.name}: largest fall of tilt's rate while it goes from −A to A", rise, 0.0, "a sign")
        step = 1e-3 * run.theta_min / run.A
        speeding = np.diff(run.at(run.middle + np.array([-step, step]))[1])[0] / (2.0 * step)
        push = float((disk.I1 + 1.0) * speeding * disk.I1 * run.theta_min**3 / run.eta**2)
        yield near(f"{disk.name}: ±V′ over η²/I₁cos³φ at θ_m, (7.6) [corrected]", push, 1.0, 1e-3, _LOG)
        ends = rates[[0, -1]] / runs[2].A
        want, why = 8.0 / np.sqrt(65.0) * np.array([-1.0, 1.0]), "η ln(1/η) and gravity"
        yield near(f"{disk.name}: its rate 8 θ_m/A before and after, over A", ends, want, 1e-3, why)


@statement(41, "PERIOD", "After Lemma 5: η → 0, then E ↓ V₀: period ~ 2^(3/2) M^(+1/2) √(E−V₀)/mgr [corrected].")
def short_periods() -> Iterator[Finding]:
    tilts = np.geomspace(0.1, 0.001, 5)  # on l_+, with a kinetic energy of half of mgr times the tilt
    for disk in BODIES:
        V0 = 0.5 * (disk.I3 + 1.0) * (disk.I1 / (disk.I3 * closed_form(disk)[0])) ** 2
        sigma, speeds = rates_down(disk, 1.0, shot_slope(disk), 1, tilts), np.sqrt(tilts / (disk.I1 + 1.0))
        excess = potential(disk, tilts, sigma) + 0.5 * (disk.I1 + 1.0) * speeds**2 - V0
        starts = [theta_to_states(disk, *row) for row in np.stack([tilts, speeds, *sigma]).T]
        found = np.array([periods(start, 1e-10, eta_hat=1e-14).period[0] for start in starts])
        ratio, want = found / np.sqrt(excess), 2.0**1.5 * np.sqrt(disk.I1 + 1.0)
        at_flat = polyfit(excess, ratio, 4)[0]
        why = "extrapolated from E−V₀ = 1.5e-3 to 0.15 mgr"
        yield near(f"{disk.name}: period/√(E−V₀) at η̂ = 1e-14, E ↓ V₀", at_flat, want, 1e-7, why)
        order = exponent(excess[2:], ratio[2:] - want)
        yield near(f"{disk.name}: exponent of the next term in E−V₀", order, 1.0, 0.05, "the term after that")
        limit = np.array([limit_motion(disk, start).period for start in starts[:2]])
        why = "η ln(1/η) = 1e-12; rounding of the limit motion's Chebyshev series"
        yield near(f"{disk.name}: period of the limit motion, over it", limit / found[:2], 1.0, 1e-7, why)


@statement(42, "REFLECTION", "7.1: as η → 0 φ(t) converges to the motion on F with elastic reflections at flat.")
def elastic_reflection() -> Iterator[Finding]:
    etas = np.array([1e-3, 1e-4, 1e-5, 1e-6])
    for disk, face, sign in ((UNIFORM, 1, 1), (HOOP, -1, 1), (THICK, 1, -1)):
        limit = limit_motion(disk, constants_to_states(disk, 1.0, 0.0, face, face), sign)
        times = np.linspace(0.0, 2.5 * limit.period, 300)
        away = abs(times[:, None] - limit.impacts(3.0 * limit.period)).min(axis=1) > 0.05 * limit.period
        want, sup = limit(times[away]).phi, []
        for eta_hat in etas:
            start = constants_to_states(disk, 1.0, sign * eta_hat, face, face)
            sup.append(float(abs(observed(disk, start, times[away], "phi")[0][0] - want).max()))
        where = f"{disk.name}, side {face:+d}, sgn η {sign:+d}:"
        order, why = exponent(etas, sup), "within O(η ln 1/η): φ shows no logarithm, its delay is of order η"
        yield near(f"{where} exponent of sup |φ − limit| in η, 2 or 3 impacts", order, 1.0, 0.02, why)
        yield at_most(f"{where} sup |φ − limit| at η̂ = 1e-6", sup[-1], 1e-4, "some η ln(1/η) = 1.4e-5")


@statement(43, "LEMMA-6", "Lemma 6, (7.7): χ̇ ~ η/I₁cos²φ, ψ̇ ~ ±χ̇ [corrected]; χ rests where |η| ≪ cos φ ≪ 1.")
def rates_of_the_race() -> Iterator[Finding]:
    for disk, face in ((UNIFORM, 1), (HOOP, -1), (THICK, -1)):
        away, where = [], f"{disk.name}, side {face:+d}:"
        for eta_hat in ETAS:
            run = passage(disk, eta_hat, face)
            unit = run.theta_min / run.A
            times = run.middle + unit * np.array([0.0, 1.0, 3.0])
            step = 1e-3 * unit
            turn = (run.at(times + step) - run.at(times - step))[4:] / (2.0 * step)
            ratio = turn * disk.I1 * np.sin(run.at(times)[0]) ** 2 / run.eta
            away.append(max(abs(ratio[0] - 1.0).max(), abs(face * ratio[1] - 1.0).max()))
        why = "η ln(1/η) and tilt²/η; for ψ also σ₄η"
        yield near(f"{where} χ̇I₁cos²φ/η and ±ψ̇I₁cos²φ/η at θ_m to 3 θ_m, from 1", away[-1], 0.0, 1e-3, why)
        yield near(f"{where} exponent of that in η", exponent(ETAS, away), 1.0, 0.08, _LOG)
        most = turn[0, 0] * run.eta / (2.0 * (run.energy - run.V0))
        yield near(f"{where} largest χ̇ over 2(E−V₀)/η, η̂ = 1e-5", most, 1.0, 1e-3, _LOG)
        edges = np.array([1e-2, 1e-3, 1e-4])
        found = [passages(disk, 1.0, 1e-8, 1.0, face, window=float(edge)) for edge in edges]
        lost = disk.kappa * np.pi - np.array([float(f.race_angle[0]) for f in found])
        want = 2.0 * disk.kappa * np.arcsin(found[0].theta_min[0] / edges)
        why = "terms of order η ln(1/η) = 2e-7"
        yield near(f"{where} race outside cos φ = 1e-2, 1e-3, 1e-4, η̂ = 1e-8", lost, want, 1e-6, why)


@statement(44, "EQ-7.9", "(7.9), (7.10): Δχ = sgn(η) π √(1 + mr²/I₁).")
def race_angle() -> Iterator[Finding]:
    etas = np.array([1e-3, 1e-4, 1e-5])
    for disk in BODIES:
        for sign in (1.0, -1.0):
            by_steps = passages(disk, 1.0, sign * etas, 1.0, method="dop853", accuracy=1e-9)
            exact = passages(disk, 1.0, sign * etas, 1.0)
            where = f"{disk.name}, sgn η {sign:+.0f}:"
            why = "accuracy asked of the integrator"
            yield near(f"{where} race angle, integrator", by_steps.race_angle, exact.race_angle, 1e-8, why)
            deep = passages(disk, 1.0, sign * 1e-12, 1.0, accuracy=1e-12)
            want = sign * np.pi * np.sqrt(1.0 + 1.0 / disk.I1)
            yield near(f"{where} race angle at η̂ = 1e-12", deep.race_angle[0], want, 1e-10, _LOG)
            small = sign * 10.0 ** -np.arange(4.0, 8.0)
            found = passages(disk, 1.0, small, 1.0, accuracy=1e-13)
            eta = small * disk.I3 * closed_form(disk)[0]
            lead = logarithmic(eta, found.race_angle - found.limit)[0]
            want = 2.0 / (disk.I1 * (disk.I1 + 1.0) * deep.impact_speed[0] ** 3)
            why = "η² ln²η, rounding 1e-13/η"
            yield near(f"{where} coefficient of η ln(1/η), over 2mgr/I₁MA³", lead / want, 1.0, 0.01, why)


@statement(45, "PROP-2", "Prop. 2: from V = V₀ + μ̃ to E and back χ grows by sgn(η) Δχ, for μ̃ and η small.")
def window_of_energy() -> Iterator[Finding]:
    shares, etas = np.array([0.25, 0.04, 0.01, 0.0025]), np.array([1e-4, 1e-5, 1e-6])
    for disk in (UNIFORM, HOOP, THICK):
        lead = disk.kappa * (np.pi - 2.0 * np.arcsin(np.sqrt(shares)))
        for sign in (1.0, -1.0):
            grown = np.empty((etas.size, shares.size))
            for row, eta_hat in enumerate(sign * etas):
                run = passage(disk, float(eta_hat))
                grown[row] = [np.diff(run.at(np.array(level(run, share)))[4])[0] for share in shares]
            where, away = f"{disk.name}, sgn η {sign:+.0f}:", grown - sign * lead
            why = "η ln(1/η) = 1.4e-5, a few times"
            yield near(f"{where} growth of χ at μ̃/(E−V₀) = 1/4, η̂ = 1e-6", grown[-1, 0], sign * lead[0], 1e-4, why)
            left = logarithmic(sign * etas, away[:, 0])[1]
            yield at_most(f"{where} misfit of a η ln(1/η) + b η to what it is off by", left, 0.02, "η² ln²η")
            missing = sign * disk.kappa * np.pi - grown[-1]
            reach = polyfit(np.sqrt(shares), missing / np.sqrt(shares), 2)[0]
            why = "what the fit in √μ̃ leaves, and η/μ̃^(3/2) = 1e-2 at the smallest"
            yield near(f"{where} ±(Δχ − growth)/√(μ̃/(E−V₀)) as μ̃ ↓ 0", sign * reach, 2.0 * disk.kappa, 0.02, why)
    run = passage(UNIFORM, 1e-6)
    growth = np.diff(run.at(np.array(level(run, 0.25)))[4])[0]
    yield near("uniform: growth/π at share 1/4, η̂ = 1e-6", growth / np.pi, 1.490706, 6e-7, "the digits given")


@statement(46, "EQ-7.11", "(7.11): ψ grows by ± sgn(η) Δχ.")
def race_of_psi() -> Iterator[Finding]:
    etas = 10.0 ** -np.arange(4.0, 9.0)
    for disk in (UNIFORM, HOOP, THICK):
        for face, sign in ((1, 1.0), (1, -1.0), (-1, 1.0), (-1, -1.0)):
            found = passages(disk, 1.0, sign * etas, 1.0, face, accuracy=1e-13)
            fall_angle = [2.0 * face * fall_from_vertical(disk, np.ones(1), e[None])[2][0] for e in found.energy]
            away = found.delta_psi - fall_angle - face * sign * disk.kappa * np.pi
            where = f"{disk.name}, side {face:+d}, sgn η {sign:+.0f}:"
            yield near(f"{where} Δψ − ±sgn(η)Δχ at η̂ = 1e-8", away[-1], 0.0, 1e-6, _LOG)
            lead = face * logarithmic(sign * etas * disk.I3 * closed_form(disk)[0], away)[0]
            want = 2.0 / (disk.I1 * (disk.I1 + 1.0) * found.impact_speed[-1] ** 3)
            why = "η² ln²η, rounding 1e-13/η"
            yield near(f"{where} its coefficient of ±η ln(1/η), over that of χ", lead / want, 1.0, 0.01, why)
            steps = passages(disk, 1.0, sign * 1e-4, 1.0, face, method="dop853", accuracy=1e-9).delta_psi
            yield near(f"{where} Δψ at η̂ = 1e-4 integrated", steps, found.delta_psi[0], 1e-8, "its accuracy")
    for disk, eta_hat in ((UNIFORM, 0.01), (HOOP, -0.01), (THICK, 0.01)):
        whole, run = passages(disk, 1.0, eta_hat, 1.0), passage(disk, eta_hat)
        race = run.middle + run.theta_min / run.A * np.linspace(-20.0, 20.0, 160)
        times = np.sort(np.concatenate([np.linspace(0.0, float(whole.duration[0]), 160), race]))
        motion = plain.integrate(disk, (0.0, 1.0, 1.0, shot_slope(disk) - eta_hat), times)
        grown = [motion.chi[-1] - motion.chi[0], motion.psi[-1] - motion.psi[0]]
        want = np.array([whole.delta_chi[0], whole.delta_psi[0]])
        why = "8-dimensional equations at 1e-12, amplified a hundredfold near flat"
        yield near(f"{disk.name}: Δχ, Δψ at η̂ = {eta_hat:g} in 8 dimensions", grown, want, 1e-9, why)


@statement(47, "UNIVERSAL", "7.2: Δχ depends on mr²/I₁ only, not on E or σ̄₃.")
def same_for_all() -> Iterator[Finding]:
    random = np.random.Generator(np.random.Philox(47))
    etas = 10.0 ** -np.arange(5.0, 10.0)
    for disk in BODIES:
        bar, speed = random.uniform(-2.0, 2.0, 300), random.uniform(0.5, 2.0, 300)
        face, sign = random.choice([-1.0, 1.0], 300), random.choice([-1.0, 1.0], 300)
        runs = [passages(disk, bar, sign * eta, speed, face, accuracy=1e-13) for eta in etas]
        few = bar[:40], 1e-5 * sign[:40], speed[:40], face[:40]
        steps = passages(disk, *few, method="dop853", accuracy=1e-8).race_angle
        width = np.array([float(abs(run.race_angle - run.limit).max()) for run in runs])
        spread = runs[0].energy.max() - runs[0].energy.min()
        what = f"{disk.name}: 300 passages, energies over {spread:.1f} mgr:"
        yield near(f"{what} furthest from ±π√(1+mr²/I₁), η̂ = 1e-9", width[-1], 0.0, 1e-6, _LOG)
        why = "accuracy asked of the integrator"
        yield near(f"{what} 40 of them integrated, η̂ = 1e-5", steps, runs[0].race_angle[:40], 1e-8, why)
        left = logarithmic(etas, width)[1]
        yield at_most(f"{what} misfit of a η ln(1/η) + b η to it, 1e-5 to 1e-9", left, 0.01, "η² ln²η, rounding")
    race = [passages(Disk(I1=0.25, I3=i), 1.0, 1e-10, 1.0).race_angle[0] for i in (0.5, 0.3, 0.05)]
    yield near("I₁ = 1/4, I₃ = 0.5, 0.3, 0.05: race angle", race, np.pi * np.sqrt(5.0), 1e-7, _LOG)


@dataclass(frozen=True)
class Bounce:
    """A motion at eta_hat shortly before and after its first impact, sqrt(eta_hat) from the middle; two rows each.

    A, B: eqs (7.1), (7.19). nu: angular velocity in space; velocity: of the centre; arm: from centre to contact.
    """

    A: float
    B: float
    phi: Array
    chi: Array
    psi: Array
    nu: Array
    velocity: Array
    arm: Array


@lru_cache
def beside(disk: Disk, face: int, sign: int, eta_hat: float, sigma3_bar: float = 1.0) -> Bounce:
    """The motion from the vertical with speed 1, integrated; nu by (2.27), (2.29), velocities by differences."""
    found = passages(disk, sigma3_bar, sign * eta_hat, 1.0, face)
    wait = np.sqrt(eta_hat)
    grid = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) * 0.02 * wait
    times = 0.5 * found.duration[0] + np.concatenate([grid - wait, grid + wait])
    start = constants_to_states(disk, sigma3_bar, sign * eta_hat, face, face)
    names = ("phi", "phidot", "sigma3", "sigma4", "chi", "psi", "path", "contact")
    phi, phidot, s3, s4, chi, psi, path, contact = (row[0] for row in observed(disk, start, times, *names))
    weights = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * 0.02 * wait)
    at = [2, 7]
    q, z, away = np.cos(phi[at]), np.sin(phi[at]), np.exp(1j * chi[at])
    turning = (q * s4[at] - z * s3[at] / q - 1j * phidot[at]) * away
    return Bounce(
        A=float(found.impact_speed[0]),
        B=disk.I1 * sigma3_bar / (disk.I3 * closed_form(disk)[0]),
        phi=phi[at],
        chi=chi[at],
        psi=psi[at],
        nu=np.stack([turning.real, turning.imag, s3[at] + z * s4[at]], axis=1),
        velocity=np.stack([weights @ path[:5], weights @ path[5:]]),
        arm=contact[at] - path[at],
    )


SMALL = np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
ROOT = "of order √η̂ (1e-4 at 1e-8): it is taken at times √η̂ from the impact"
CASES = tuple((disk, face, sign) for disk in (UNIFORM, HOOP, THICK) for face in (1, -1) for sign in (1, -1))


def case(disk: Disk, face: int, sign: int) -> str:
    """A body, a side and a sign of eta in words."""
    return f"{disk.name}, side {face:+d}, sgn η {sign:+d}:"


def order_of(what: str, away: Any) -> Finding:
    """The exponent in eta_hat of distances along SMALL, taken sqrt(eta_hat) from the impact."""
    return near(f"{what}: exponent in η̂", exponent(SMALL, away), 0.5, 0.05, "the next power, η ln(1/η)")


def horizontal(size: float, chi: Any, lift: float) -> Array:
    """size (sin chi, -cos chi), lift upwards."""
    return np.array([size * np.sin(chi), -size * np.cos(chi), lift])


@statement(48, "LEMMA-7", "Lemma 7, (7.16)–(7.19): χ↑ − χ↓ = sgn(η) Δχ, ν↓ = (±A sin χ↓, ∓A cos χ↓, B); ν↑ alike.")
def limits_of_nu() -> Iterator[Finding]:
    for disk, face, sign in CASES:
        away = np.empty((2, SMALL.size))
        for i, eta_hat in enumerate(SMALL):
            run = beside(disk, face, sign, float(eta_hat))
            down = run.nu[0] - horizontal(face * run.A, run.chi[0], run.B)
            up = run.nu[1] - horizontal(-face * run.A, run.chi[1], run.B)
            away[0, i] = max(np.linalg.norm(down), np.linalg.norm(up))
            away[1, i] = abs(run.chi[1] - run.chi[0] - sign * disk.kappa * np.pi)
        for what, row in (("ν before and after, off (7.17), (7.18)", away[0]), ("χ↑ − χ↓ off sgn(η) Δχ", away[1])):
            yield near(f"{case(disk, face, sign)} {what}, η̂ = 1e-8", row[-1], 0.0, 1e-3, ROOT)
            yield order_of(f"{case(disk, face, sign)} {what}", row)
    for disk in (UNIFORM, THICK):
        other = beside(disk, 1, 1, 1e-3)
        middle = 0.5 * passages(disk, 1.0, 1e-3, 1.0).duration[0]
        times = middle + np.sqrt(1e-3) * np.array([-1.0, 1.0])
        motion = plain.integrate(disk, (0.0, 1.0, 1.0, shot_slope(disk) - 1e-3), times)
        nu = np.einsum("tij,tj->ti", motion.A, motion.omega)
        why = "8-dimensional equations at 1e-12, amplified by 1/η"
        yield near(f"{disk.name}: ν = Aω in 8 dimensions at η̂ = 1e-3, before and after", nu, other.nu, 1e-8, why)


def planar(ratio: float) -> Disk:
    """A planar body with m r^2/I1 = ratio."""
    return Disk(I1=1.0 / ratio, I3=2.0 / ratio, name=f"mr²/I₁ = {ratio:g}")


@statement(49, "COR-1", "Cor. 1: ν turns by sgn(η)(Δχ − π) about the vertical; continuous iff mr²/I₁ = 4k(k+1).")
def jump_of_nu() -> Iterator[Finding]:
    for disk, face, sign in CASES:
        nu = beside(disk, face, sign, 1e-8).nu
        turn = complex(*nu[1, :2]) / complex(*nu[0, :2])
        want = np.exp(1j * sign * np.pi * (disk.kappa - 1.0))
        yield near(f"{case(disk, face, sign)} turn of ν, as e^iα off e^i(Δχ−π)", abs(turn - want), 0.0, 1e-3, ROOT)
        why, rise = "1e-11 a passage; both times mirror each other", float(abs(nu[1, 2] - nu[0, 2]))
        yield near(f"{case(disk, face, sign)} jump of its vertical part", rise, 0.0, 1e-9, why)
    for ratio in (2.0, 3.0, 4.0, 7.9, 8.0, 8.1, 15.0, 24.0):
        run = beside(planar(ratio), 1, 1, 1e-8)
        jump = float(np.linalg.norm(run.nu[1] - run.nu[0]) / run.A)
        want = 2.0 * abs(np.sin(0.5 * np.pi * (np.sqrt(1.0 + ratio) - 1.0)))
        yield near(f"mr²/I₁ = {ratio:g}: |ν↑ − ν↓|/A (zero at 8 and 24 only)", jump, want, 2e-3, ROOT)
    few = np.array([0.04, 0.02, 0.01])  # k = 0 is the limit of I1 >> m r^2
    runs = [beside(planar(ratio), 1, 1, 1e-10) for ratio in few]
    jumps = [float(np.linalg.norm(run.nu[1] - run.nu[0]) / run.A) for run in runs]
    yield near("mr²/I₁ → 0: exponent of |ν↑ − ν↓|/A", exponent(few, jumps), 1.0, 0.02, "√(1+x) − 1 beyond x/2")

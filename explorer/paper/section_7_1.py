"""Sections 7.1 and 7.2 of the paper: the bounce near flat and the race of the contact point.

Limits eta -> 0 are taken along sequences of eta_hat. Three ways to one passage check each other: SciPy on the
reduced equations as they stand (`reduced`), the integrators on the regularised ones, and quadrature.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyfit
from scipy.optimize import brentq

from explorer.motion.fall_integrals import fall_from_vertical
from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import (
    BODIES,
    EXACT,
    HOOP,
    THICK,
    UNIFORM,
    at_most,
    exponent,
    logarithmic,
    near,
    near_the_line,
    observed,
)
from explorer.paper.closed_forms import eta_per_eta_hat, flat_potential, impact_speed
from explorer.paper.four_dimensions import (
    potential,
    rates_down,
    reduced,
    shot_slope,
    sigma_at,
    sigma_energy,
    upright,
)
from explorer.paper.statement import Finding, statement
from explorer.phase.coordinates import coordinates_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array

_LOG = "the next term is of order η ln(1/η)"


@dataclass(frozen=True)
class Track:
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
def passage(disk: Disk, eta_hat: float, face: int = 1) -> Track:
    """See Track; eta_hat is that of `face`."""

    def turning(_t: float, y: Array) -> float:
        return float(y[1])

    turning.direction = 1.0  # type: ignore[attr-defined]
    start = upright(disk, eta_hat, face)
    motion = reduced(disk, face, (0.5 * np.pi, -1.0, 1.0, start[3]), 2.6, turning)
    energy = float(sigma_energy(disk, sigma_at(*start)))
    middle, tilt = float(motion.t_events[0][0]), float(motion.y_events[0][0][0])
    V0, A = flat_potential(disk), impact_speed(disk, energy)
    return Track(eta_per_eta_hat(disk) * eta_hat, energy, V0, A, middle, tilt, motion.sol)


def level(run: Track, share: float) -> tuple[float, float]:
    """The times beside the middle at which V - V0 is a share of E - V0: phidot = ±A sqrt(1 - share)."""
    speed = run.A * np.sqrt(1.0 - share)
    width = run.theta_min / run.A * np.sqrt((1.0 - share) / share)

    def excess(time: float) -> float:
        return float(abs(run.at(run.middle + time)[1]) - speed)

    first, last = (brentq(excess, 0.0, end, xtol=1e-20, rtol=1e-14) for end in (-3.0 * width, 3.0 * width))
    return run.middle + first, run.middle + last


def growth(run: Track, share: float) -> float:
    """The increase of chi between the times of `level`."""
    return float(np.diff(run.at(np.array(level(run, share)))[4])[0])


ETAS = (1e-2, 1e-3, 1e-4, 1e-5)


@statement(40, "LEMMA-5")
def bounce() -> Iterator[Finding]:
    """Lemma 5: near flat cos φ and the duration are O(|η|), φ̇ goes steadily from A to −A."""
    for disk in (UNIFORM, HOOP, THICK):
        runs = [passage(disk, eta) for eta in ETAS]
        eta = np.array([run.eta for run in runs])
        theta = np.array([run.theta_min for run in runs])
        yield near(f"{disk.name}: exponent of θ_min in η, 1e-2 to 1e-5", exponent(eta, theta), 1.0, 0.02, _LOG)
        tiny = passages(disk, 1.0, [1e-8, -1e-8, 1e-12, -1e-12], 1.0, accuracy=EXACT)
        lead = tiny.theta_min * tiny.impact_speed * np.sqrt(disk.I1 * (disk.I1 + 1.0)) / eta_per_eta_hat(disk)
        lead /= [1e-8, 1e-8, 1e-12, 1e-12]
        yield near(f"{disk.name}: θ_min√(2I₁(E−V₀))/η at ±1e-8, ±1e-12 by quadrature", lead, 1.0, 1e-6, _LOG)
        times = np.array([np.diff(level(run, 0.5))[0] for run in runs])
        run, rate = runs[-1], exponent(eta, times)
        yield near(f"{disk.name}: exponent in η of the time with V−V₀ > ½(E−V₀)", rate, 1.0, 0.02, _LOG)
        rates = runs[2].at(runs[2].middle + np.linspace(-8.0, 8.0, 400) * runs[2].theta_min / runs[2].A)[1]
        rise = -float(np.diff(rates).min() / runs[2].A)
        yield at_most(f"{disk.name}: largest fall of tilt's rate while it goes from −A to A", rise, 0.0, "a sign")
        ends = rates[[0, -1]] / runs[2].A
        want, why = 8.0 / np.sqrt(65.0) * np.array([-1.0, 1.0]), "η ln(1/η) and gravity"
        yield near(f"{disk.name}: its rate 8 θ_m/A before and after, over A", ends, want, 1e-3, why)
        yield from _forces_near_flat(disk, run)


def _forces_near_flat(disk: Disk, run: Track) -> Iterator[Finding]:
    """What the proof of Lemma 5 says of V' and V at eta_hat = 1e-5; two misprints."""
    M, step = disk.I1 + 1.0, 1e-3 * run.theta_min / run.A
    speeding = np.diff(run.at(run.middle + np.array([-step, step]))[1])[0] / (2.0 * step)
    push = float(M * speeding * disk.I1 * run.theta_min**3 / run.eta**2)
    text = (
        f"{disk.name}: ±V′ divided by η²/(I₁cos³φ) at the smallest tilt θ_m, (7.6); as printed, cos³φ is a factor "
        "and no divisor"
    )
    yield near(text, push, 1.0, 1e-3, _LOG, {"(7.6)": push / run.theta_min**6})
    tilt, rate = run.at(run.middle - 100.0 * run.theta_min / run.A)[:2]
    other = potential(disk, [tilt], rates_down(disk, 1.0, shot_slope(disk), -1, [tilt]))[0]
    text = f"{disk.name}: E − Mφ̇²/2 at the time 100 θ_m/A before the race on face +1; as printed, it is V_q(−1)"
    why = "it is not yet flat: a tilt of 1e-3"
    yield near(text, run.energy - 0.5 * M * rate**2, run.V0, 5e-3, why, {"Lemma 5, proof": other})


@statement(41, "PERIOD")
def short_periods() -> Iterator[Finding]:
    """After Lemma 5: η → 0, then E ↓ V₀: period ~ 2^(3/2) M^(+1/2) √(E−V₀)/mgr [corrected]."""
    tilts = np.geomspace(0.1, 0.001, 5)  # on l_+, with a kinetic energy of half of mgr times the tilt
    for disk in BODIES:
        M, slope = disk.I1 + 1.0, shot_slope(disk)
        sigma, speeds = rates_down(disk, 1.0, slope, 1, tilts), np.sqrt(tilts / M)
        excess = potential(disk, tilts, sigma) + 0.5 * M * speeds**2 - flat_potential(disk)
        beside = coordinates_to_states(
            disk, phi=0.5 * np.pi - tilts, phidot=-speeds, sigma3_bar=1.0, eta_hat=1e-14
        )
        tau = periods(beside, accuracy=1e-10).period
        ratio, want, printed = tau / np.sqrt(excess), 2.0**1.5 * np.sqrt(M), 2.0**1.5 / np.sqrt(M)
        text, why = (
            f"{disk.name}: period/√(E−V₀) at η̂ = 1e-14, E ↓ V₀; as printed M^(−1/2)",
            "extrapolated from E−V₀ = 1.5e-3 to 0.15 mgr",
        )
        yield near(text, polyfit(excess, ratio, 4)[0], want, 1e-7, why, {"after Lemma 5, period": printed})
        start = 0.5 * np.pi - 1e-5, 0.0, *rates_down(disk, 1.0, slope, 1, [1e-5])[:, -1]
        text = f"{disk.name}: φ̈ in 8 dimensions at rest on l₊, 1e-5 from flat: mgr/M, as printed mgr"
        off = {"after Lemma 5, acceleration": 1.0}
        yield near(text, plain.tilting(disk, start), 1.0 / M, 1e-4, "of the order of the tilt", off)


@statement(42, "REFLECTION")
def elastic_reflection() -> Iterator[Finding]:
    """7.1: as η → 0 φ(t) converges to the motion on F with elastic reflections at flat."""
    etas = np.array([1e-3, 1e-4, 1e-5, 1e-6])
    for disk, face, sign in ((UNIFORM, 1, 1), (HOOP, -1, 1), (THICK, 1, -1)):
        limit = limit_motion(near_the_line(disk, 0.0, face), sign)
        times = np.linspace(0.0, 2.5 * limit.period, 300)
        away = abs(times[:, None] - limit.impacts(3.0 * limit.period)).min(axis=1) > 0.05 * limit.period
        want, sup = limit(times[away]).phi, []
        for eta_hat in etas:
            start = near_the_line(disk, sign * eta_hat, face)
            sup.append(float(abs(observed(disk, start, times[away], "phi")[0][0] - want).max()))
        where = f"{disk.name}, face {face:+d}, sgn η {sign:+d}:"
        order, why = exponent(etas, sup), "within O(η ln 1/η): φ shows no logarithm, its delay is of order η"
        yield near(f"{where} exponent of sup |φ − limit| in η, 2 or 3 impacts", order, 1.0, 0.02, why)
        yield at_most(f"{where} sup |φ − limit| at η̂ = 1e-6", sup[-1], 1e-4, "some η ln(1/η) = 1.4e-5")


@statement(43, "LEMMA-6")
def rates_of_the_race() -> Iterator[Finding]:
    """Lemma 6, (7.7): χ̇ ~ η/I₁cos²φ, ψ̇ ~ ±χ̇ [corrected]; χ rests where |η| ≪ cos φ ≪ 1."""
    for disk, face in ((UNIFORM, 1), (HOOP, -1), (THICK, -1)):
        away, where = [], f"{disk.name}, face {face:+d}:"
        for eta_hat in ETAS:
            run = passage(disk, eta_hat, face)
            unit = run.theta_min / run.A
            times = run.middle + unit * np.array([0.0, 1.0, 3.0])
            step = 1e-3 * unit
            turn = (run.at(times + step) - run.at(times - step))[4:] / (2.0 * step)
            ratio = turn * disk.I1 * np.sin(run.at(times)[0]) ** 2 / run.eta
            away.append(max(abs(ratio[0] - 1.0).max(), abs(face * ratio[1] - 1.0).max()))
        text, why = (
            f"{where} how much χ̇I₁cos²φ/η and ±ψ̇I₁cos²φ/η differ from 1 at tilts from θ_m to 3 θ_m",
            "η ln(1/η) and tilt²/η; for ψ also σ₄η",
        )
        swapped = abs(np.array([face * ratio[0], ratio[1]]) - 1.0).max()
        yield near(text, away[-1], 0.0, 1e-3, why, {"Lemma 6, orders": swapped} if face < 0 else {})
        yield near(f"{where} exponent of that in η", exponent(ETAS, away), 1.0, 0.08, _LOG)
        edges = np.array([1e-2, 1e-3, 1e-4])
        cut = [passages(disk, 1.0, 1e-8, 1.0, face, window=float(edge), accuracy=EXACT) for edge in edges]
        lost = disk.kappa * np.pi - np.array([float(part.race_angle) for part in cut])
        want = 2.0 * disk.kappa * np.arcsin(cut[0].theta_min / edges)
        why = "terms of order η ln(1/η) = 2e-7"
        yield near(f"{where} race outside cos φ = 1e-2, 1e-3, 1e-4, η̂ = 1e-8", lost, want, 1e-6, why)


@statement(44, "EQ-7.9")
def race_angle() -> Iterator[Finding]:
    """(7.9), (7.10): Δχ = sgn(η) π √(1 + mr²/I₁)."""
    etas = np.array([1e-3, 1e-4, 1e-5])
    for disk in BODIES:
        for sign in (1.0, -1.0):
            by_steps = passages(disk, 1.0, sign * etas, 1.0, method="dop853", accuracy=1e-9)
            exact = passages(disk, 1.0, sign * etas, 1.0, accuracy=EXACT)
            where = f"{disk.name}, sgn η {sign:+.0f}:"
            why = "accuracy asked of the integrator"
            yield near(f"{where} race angle, integrator", by_steps.race_angle, exact.race_angle, 1e-8, why)
            deep = passages(disk, 1.0, sign * 1e-12, 1.0, accuracy=1e-12)
            want = sign * np.pi * np.sqrt(1.0 + 1.0 / disk.I1)
            yield near(f"{where} race angle at η̂ = 1e-12", deep.race_angle, want, 1e-10, _LOG)
            small = sign * 10.0 ** -np.arange(4.0, 8.0)
            runs = passages(disk, 1.0, small, 1.0, accuracy=1e-13)
            lead = logarithmic(small * eta_per_eta_hat(disk), runs.race_angle - runs.limit)[0]
            want = 2.0 / (disk.I1 * (disk.I1 + 1.0) * deep.impact_speed**3)
            why = "η² ln²η, rounding 1e-13/η"
            yield near(f"{where} coefficient of η ln(1/η), over 2mgr/I₁MA³", lead / want, 1.0, 0.01, why)


@statement(45, "PROP-2")
def window_of_energy() -> Iterator[Finding]:
    """Prop. 2: from V = V₀ + μ̃ to E and back χ grows by sgn(η) Δχ, for μ̃ and η small."""
    shares, etas = np.array([0.25, 0.04, 0.01, 0.0025]), np.array([1e-4, 1e-5, 1e-6])
    for disk in (UNIFORM, HOOP, THICK):
        lead = disk.kappa * (np.pi - 2.0 * np.arcsin(0.5))
        for sign in (1.0, -1.0):
            runs = [passage(disk, float(sign * eta_hat)) for eta_hat in etas]
            quarter = np.array([growth(run, 0.25) for run in runs])
            where, why = f"{disk.name}, sgn η {sign:+.0f}:", "η ln(1/η) = 1.4e-5, a few times"
            yield near(f"{where} growth of χ at μ̃/(E−V₀) = 1/4, η̂ = 1e-6", quarter[-1], sign * lead, 1e-4, why)
            missing = sign * disk.kappa * np.pi - np.array([growth(runs[-1], share) for share in shares])
            reach = polyfit(np.sqrt(shares), missing / np.sqrt(shares), 2)[0]
            why = "what the fit in √μ̃ leaves, and η/μ̃^(3/2) = 1e-2 at the smallest"
            yield near(f"{where} ±(Δχ − growth)/√(μ̃/(E−V₀)) as μ̃ ↓ 0", sign * reach, 2.0 * disk.kappa, 0.02, why)
    turns = growth(passage(UNIFORM, 1e-6), 0.25) / np.pi
    yield near("uniform: growth/π at share 1/4, η̂ = 1e-6", turns, 1.490706, 6e-7, "the digits given")


@statement(46, "EQ-7.11")
def race_of_psi() -> Iterator[Finding]:
    """(7.11): ψ grows by ± sgn(η) Δχ."""
    etas = 10.0 ** -np.arange(4.0, 9.0)
    for disk in (UNIFORM, HOOP, THICK):
        for face, sign in ((1, 1.0), (1, -1.0), (-1, 1.0), (-1, -1.0)):
            runs = passages(disk, 1.0, sign * etas, 1.0, face, accuracy=1e-13)
            fall_angle = [2.0 * face * fall_from_vertical(disk, np.ones(1), e[None])[2][0] for e in runs.energy]
            away = runs.delta_psi - fall_angle - face * sign * disk.kappa * np.pi
            where = f"{disk.name}, face {face:+d}, sgn η {sign:+.0f}:"
            yield near(f"{where} Δψ − ±sgn(η)Δχ at η̂ = 1e-8", away[-1], 0.0, 1e-6, _LOG)
            steps = passages(disk, 1.0, sign * 1e-4, 1.0, face, method="dop853", accuracy=1e-9).delta_psi
            yield near(f"{where} Δψ at η̂ = 1e-4 integrated", steps, runs.delta_psi[0], 1e-8, "its accuracy")
    for disk, eta_hat in ((UNIFORM, 0.01), (HOOP, -0.01), (THICK, 0.01)):
        whole, run = passages(disk, 1.0, eta_hat, 1.0, accuracy=EXACT), passage(disk, eta_hat)
        race = run.middle + run.theta_min / run.A * np.linspace(-20.0, 20.0, 160)
        times = np.sort(np.concatenate([np.linspace(0.0, float(whole.duration), 160), race]))
        motion = plain.integrate(disk, upright(disk, eta_hat), times)
        grown = [motion.chi[-1] - motion.chi[0], motion.psi[-1] - motion.psi[0]]
        want = np.array([whole.delta_chi, whole.delta_psi])
        why = "8-dimensional equations at 1e-12, amplified a hundredfold near flat"
        yield near(f"{disk.name}: Δχ, Δψ at η̂ = {eta_hat:g} in 8 dimensions", grown, want, 1e-9, why)


@statement(47, "UNIVERSAL")
def same_for_all() -> Iterator[Finding]:
    """7.2: Δχ depends on mr²/I₁ only, not on E or σ̄₃."""
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
    race = [passages(Disk(I1=0.25, I3=i), 1.0, 1e-10, 1.0, accuracy=EXACT).race_angle for i in (0.5, 0.3, 0.05)]
    yield near("I₁ = 1/4, I₃ = 0.5, 0.3, 0.05: race angle", race, np.pi * np.sqrt(5.0), 1e-7, _LOG)

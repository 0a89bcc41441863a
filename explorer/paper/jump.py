"""Statements 50 to 57: what the two one-sided limits do at an impact (sections 7.3 and 1 of the paper).

Measured on integrated motions at small eta_hat of both signs, shortly before and after the impact
(`race.beside`) or back at the vertical (`risen`), along sequences of eta_hat, and in 8 dimensions.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial.polynomial import polyfit

from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.paper import eight_dimensions as plain
from explorer.paper.fall import (
    HOOP,
    MATCHING,
    THICK,
    UNIFORM,
    at_most,
    closed_form,
    exponent,
    near,
    observed,
    shot_slope,
)
from explorer.paper.race import CASES, ROOT, SMALL, beside, case, horizontal, logarithmic, order_of, planar
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states

_LOG = "of order η ln(1/η), 2e-7 at 1e-8"


@dataclass(frozen=True)
class Risen:
    """A motion a third of a passage after its first impact: chi, rotation (3, 3), centre (3)."""

    chi: float
    rotation: Array
    centre: Array


@lru_cache
def risen(disk: Disk, sign: int, eta_hat: float = 1e-8) -> Risen:
    """From the vertical with speed and sigma3_bar of 1 towards face +1, approached from sgn(eta) = sign."""
    time = 5.0 / 3.0 * limit_motion(disk, constants_to_states(disk, 1.0, 0.0, 1.0)).impacts(9.0)[:1]
    start = constants_to_states(disk, 1.0, sign * eta_hat, 1.0)
    phi, chi, psi, path = (row[0, 0] for row in observed(disk, start, time, "phi", "chi", "psi", "path"))
    turned = plain.turn(3, chi) @ plain.turn(2, 0.5 * np.pi - phi) @ plain.turn(3, -psi - np.pi)
    return Risen(float(chi), turned, path)


def apart(disk: Disk) -> tuple[float, float]:
    """How far the limits from both sides are apart when the disk has risen: rotation, centre."""
    plus, minus = risen(disk, 1), risen(disk, -1)
    return float(np.linalg.norm(plus.rotation - minus.rotation)), float(np.linalg.norm(plus.centre - minus.centre))


@statement(50, "ONE-SIDED", "7.3: the limits of the rotation as η ↑ 0 and η ↓ 0 agree iff mr²/I₁ = l² − 1.")
def one_sided_limits() -> Iterator[Finding]:
    ring = Disk.annulus(1.0 / np.sqrt(3.0))
    for disk in (planar(3.0), planar(8.0), planar(15.0), planar(24.0), ring):
        yield near(f"{disk.name}: limits apart, rotation and centre", apart(disk), 0.0, 1e-5, _LOG)
    yield near(f"{ring.name}: mr²/I₁", ring.m * ring.r**2 / ring.I1, 3.0, 1e-14, "rounding")
    for disk in (UNIFORM, HOOP, planar(1.0), planar(2.9), planar(3.1), planar(10.0)):
        why = "they differ, by far more than η ln(1/η)"
        yield at_most(f"{disk.name}: minus the distance of both rotations", -apart(disk)[0], -0.05, why)
    for order in (2, 3, 4):
        ratios = np.linspace(-0.2, 0.2, 5) + order * order - 1.0
        bodies = [planar(float(ratio)) for ratio in ratios]
        signed = [np.sin(0.5 * (risen(disk, 1).chi - risen(disk, -1).chi)) for disk in bodies]
        root = float(polyfit(signed, ratios, 4)[0])
        yield near("mr²/I₁ where the limits agree, from five bodies", root, order * order - 1.0, 1e-5, _LOG)


@statement(
    51,
    "LEMMA-8",
    "Lemma 8, Cor. 2: ȧ↓ = r(±B sin χ↓, ∓B cos χ↓, −A), ȧ↑ with A; elastic iff mr²/I₁ = 4k²−1.",
)
def velocity_of_the_centre() -> Iterator[Finding]:
    for disk, face, sign in CASES:
        away = []
        for eta_hat in SMALL:
            run = beside(disk, face, sign, float(eta_hat))
            want = [horizontal(face * run.B, run.chi[0], -run.A), horizontal(face * run.B, run.chi[1], run.A)]
            away.append(float(np.linalg.norm(run.velocity - want, axis=1).max()))
        what = f"{case(disk, face, sign)} ȧ before and after, off Lemma 8"
        yield near(f"{what}, η̂ = 1e-8", away[-1], 0.0, 1e-3, ROOT)
        yield order_of(what, away)
        plane = beside(disk, face, sign, 1e-10).velocity @ [1.0, 1j, 0.0]
        turn = plane[1] / plane[0] - np.exp(1j * sign * np.pi * disk.kappa)
        yield near(f"{case(disk, face, sign)} turn of horizontal ȧ, as e^iα off e^iΔχ", abs(turn), 0.0, 1e-3, ROOT)
    for ratio in (2.0, 3.0, 4.0, 8.0, 15.0, 24.0):
        run = beside(planar(ratio), 1, 1, 1e-10)
        off = float(np.linalg.norm(run.velocity[1] - run.velocity[0] * [1.0, 1.0, -1.0]) / run.B)
        want = 2.0 * abs(np.sin(0.5 * np.pi * np.sqrt(1.0 + ratio)))
        what = f"mr²/I₁ = {ratio:g}: ȧ↑ off an elastic collision, over B (zero at 3 and 15 only)"
        yield near(what, off, want, 1e-3, ROOT)


def _through_the_race(disk: Disk, eta_hat: float) -> tuple[float, float, dict[str, Array]]:
    """(E, A, observables) through the race, on a grid as fine as the tilt is small."""
    found = passages(disk, 1.0, eta_hat, 1.0)
    y = np.linspace(-5.0, 5.0, 401)
    times = 0.5 * found.duration[0] + found.theta_min[0] / found.impact_speed[0] * np.sinh(y)
    names = ("phi", "phidot", "sigma3", "sigma4", "chi", "path", "contact")
    start = constants_to_states(disk, 1.0, eta_hat, 1.0)
    values = {name: row[0] for name, row in zip(names, observed(disk, start, times, *names), strict=True)}
    values["contact_speed"] = np.linalg.norm(np.gradient(values["contact"], times, axis=0, edge_order=2), axis=1)
    values["speed"] = np.linalg.norm(np.gradient(values["path"], times, axis=0, edge_order=2), axis=1)
    return float(found.energy[0]), float(found.impact_speed[0]), values


_ETAS = (1e-2, 1e-3, 1e-4, 1e-5)


@statement(52, "SEC-7.3", "7.3: ω and ν stay bounded, ⟨Iω,ω⟩ ≤ 2E, and so does ȧ, however flat the disk.")
def bounded_rates() -> Iterator[Finding]:
    for disk in (UNIFORM, HOOP, THICK):
        share, most, fastest, race = [], [], [], []
        for eta_hat in _ETAS:
            E, _, run = _through_the_race(disk, eta_hat)
            square = run["phidot"] ** 2 + (run["sigma3"] / np.cos(run["phi"])) ** 2
            share.append(float((disk.I1 * square + disk.I3 * run["sigma4"] ** 2).max() / (2.0 * E)))
            most.append(float(np.sqrt(square + run["sigma4"] ** 2).max()))
            fastest.append(float(run["speed"].max()))
            race.append(float((abs(run["sigma3"]) / np.cos(run["phi"]) ** 2).max()))
        yield at_most(f"{disk.name}: largest ⟨Iω,ω⟩/2E, η̂ = 1e-2 to 1e-5", max(share), 1.0, "E = T + V, V > 0")
        why = "bounded: it converges as η ln(1/η); χ̇ has −1"
        orders = [exponent(_ETAS, most), exponent(_ETAS, fastest)]
        yield near(f"{disk.name}: exponents in η of largest |ω|, |ȧ|", orders, 0.0, 0.02, why)
        yield near(f"{disk.name}: exponent in η of the largest χ̇", exponent(_ETAS, race), -1.0, 0.02, _LOG)
        found = passages(disk, 1.0, 0.01, 1.0)
        times = np.linspace(0.0, float(found.duration[0]), 300)
        motion = plain.integrate(disk, (0.0, 1.0, 1.0, shot_slope(disk) - 0.01), times)
        inertia = np.array([disk.I1, disk.I1, disk.I3])
        share8 = float((motion.omega**2 @ inertia).max() / (2.0 * found.energy[0]))
        yield at_most(f"{disk.name}: ⟨Iω,ω⟩/2E over a passage in 8 dimensions, η̂ = 0.01", share8, 1.0, "a bound")
        moved = np.gradient(motion.a, times, axis=0, edge_order=2)[1:-1]
        fast = float((np.linalg.norm(moved, axis=1) / np.linalg.norm(motion.omega[1:-1], axis=1)).max())
        yield at_most(f"{disk.name}: |ȧ|/r|ω| there", fast, 1.0 + 1e-3, "a bound; difference quotients")


@statement(
    53,
    "CONTACT",
    "7.3: the contact point races at O(1/|η|), at the angle χ or (lower sign) χ + π [corrected].",
)
def speed_of_the_contact_point() -> Iterator[Finding]:
    for disk in (UNIFORM, HOOP, THICK):
        ratio, speed = [], []
        for eta_hat in _ETAS:
            _, A, run = _through_the_race(disk, eta_hat)
            eta = eta_hat * disk.I3 * closed_form(disk)[0]
            speed.append(float(run["contact_speed"].max()))
            ratio.append(speed[-1] * eta / ((disk.I1 + 1.0) * A * A))  # 2 (E - V0) = M A²
        yield near(f"{disk.name}: exponent of its largest speed in η", exponent(_ETAS, speed), -1.0, 0.02, _LOG)
        why = "η ln(1/η); the difference quotient is good to 1e-4"
        yield near(f"{disk.name}: its largest speed over 2r(E−V₀)/|η|, η̂ = 1e-5", ratio[-1], 1.0, 1e-3, why)
    for disk, face in ((UNIFORM, 1), (UNIFORM, -1), (THICK, -1)):
        middle = 0.5 * passages(disk, 1.0, 1e-3, 1.0, face).duration[0]
        times = middle + 0.03 * np.array([-1.0, 0.0, 1.0])
        start = 0.0, float(face), 1.0, face * (shot_slope(disk) - 1e-3)
        motion = plain.integrate(disk, start, times)
        arm = motion.contact - motion.a
        away = np.exp(1j * (np.arctan2(arm[:, 1], arm[:, 0]) - motion.chi)) - face
        what = f"{disk.name}, side {face:+d}: e^i(angle of p − a) e^−iχ in 8 dimensions, off ±1"
        yield near(what, float(abs(away).max()), 0.0, 1e-8, "1e-12 in A over the tilt, 7e-4")


@statement(54, "TURNS", "7.3: if I₁ ≪ mr² the contact point runs many times round the rim before the disk rises.")
def many_turns() -> Iterator[Finding]:
    for ratio, halves in ((24.0, 5.0), (99.0, 10.0)):
        disk = planar(ratio)
        for sign in (1, -1):
            found = passages(disk, 1.0, sign * 1e-6, 1.0, method="dop853", accuracy=1e-8)
            what = f"mr²/I₁ = {ratio:g}, sgn η {sign:+d}: race angle, integrated, over π (η̂ = 1e-6)"
            yield near(what, found.race_angle[0] / np.pi, sign * halves, 1e-5, _LOG)
        _, _, run = _through_the_race(disk, 1e-5)
        arm = (run["contact"] - run["path"])[:, :2] @ [1.0, 1j]
        turned = float(np.unwrap(np.angle(arm))[[0, -1]] @ [-1.0, 1.0])
        want = disk.kappa * 2.0 * np.arctan(np.sinh(5.0))
        why = "turning with the body beside the race: the tilt 74 θ_m is left and reached"
        yield near(f"mr²/I₁ = {ratio:g}: angle of p − a over 148 θ_m/A", turned / want, 1.0, 1e-3, why)
    ratios = np.array([1e2, 1e3, 1e4])
    turns = [float(passages(planar(float(x)), 1.0, 1e-9, 1.0).race_angle[0]) / (2.0 * np.pi) for x in ratios]
    order = exponent(ratios, turns)
    yield near("exponent of the number of turns in mr²/I₁, 1e2 to 1e4", order, 0.5, 2e-3, "√(1+x)")


@statement(55, "HINGE", "7.3: p↓ and p↑ are hinges: ν↓, ν↑ have horizontal parts orthogonal to p↓ − a*, p↑ − a*.")
def hinges() -> Iterator[Finding]:
    for disk, face, sign in CASES:
        cosine, lift = [], []
        for eta_hat in SMALL:
            run = beside(disk, face, sign, float(eta_hat))
            flat = run.nu * [1.0, 1.0, 0.0]
            size = np.linalg.norm(flat, axis=1) * np.linalg.norm(run.arm, axis=1)
            cosine.append(float(abs((flat * run.arm).sum(axis=1) / size).max()))
            lift.append(abs(np.cross(run.nu, -run.arm)[:, 2] - [-run.A, run.A]).max())
        what = f"{case(disk, face, sign)} cosine of ν and p − a, before and after"
        yield near(f"{what}, η̂ = 1e-8", cosine[-1], 0.0, 1e-3, ROOT)
        yield order_of(what, cosine)
        yield near(f"{case(disk, face, sign)} fall and rise of a about p, off −A and A", lift[-1], 0.0, 1e-3, ROOT)


@statement(56, "SPIN", "7.3: ν₃ does not jump, its limit B is 0 iff σ̄₃ = 0, and χ, ψ jump then as well.")
def spin() -> Iterator[Finding]:
    for disk in (UNIFORM, HOOP, THICK):
        for bar in (-1.0, 0.0, 0.5):
            run, want = beside(disk, 1, 1, 1e-8, bar), disk.I1 * bar / (disk.I3 * closed_form(disk)[0])
            what = f"{disk.name}, σ̄₃ = {bar:g}: ν₃ before and after"
            yield near(what, run.nu[:, 2], want, 1e-6, "of order tilt² and η ln(1/η)")
        unit = disk.kappa * np.pi
        limit = limit_motion(disk, (0.0, 1.0, 0.0, 0.0), 1)
        hits = limit.impacts(2.2 * limit.period)
        times = 0.5 * (hits[0] + hits[1]) + np.array([0.0, limit.period])
        start = constants_to_states(disk, 0.0, 1e-8, 1.0)
        chi, psi = (row[0] for row in observed(disk, start, times, "chi", "psi"))
        why, what = "midway between impacts; η ln(1/η)", f"{disk.name}, σ̄₃ = 0, after impacts on sides + and −:"
        yield near(f"{what} χ/Δχ", chi / unit, [1.0, 0.0], 1e-6, why)
        yield near(f"{what} ψ/Δχ", psi / unit, [1.0, 2.0], 1e-6, why)
        yield near(f"{what} χ off the limit motion", chi, limit(times).chi, 1e-5, why)


@statement(57, "SEC-1", "Section 1: for the uniform disk and the hoop the two limits differ, by 2Δχ mod 2π.")
def two_sides() -> Iterator[Finding]:
    etas = 10.0 ** -np.arange(4.0, 9.0)
    for disk, gap in ((UNIFORM, 1.483259), (HOOP, 4.599611)):
        between = (risen(disk, 1).chi - risen(disk, -1).chi) % (2.0 * np.pi)
        yield near(f"{disk.name}: angle of A e₃ between both limits, η̂ = ±1e-8", between, gap, 2e-6, _LOG)
        both = [passages(disk, 1.0, sign * etas, 1.0, accuracy=1e-13).delta_chi for sign in (1.0, -1.0)]
        away = both[0] - both[1] - 2.0 * disk.kappa * np.pi
        yield near(f"{disk.name}: Δχ from both sides, apart less 2Δχ, η̂ = ±1e-8", away[-1], 0.0, 1e-6, _LOG)
        left = logarithmic(etas, away)[1]
        yield at_most(f"{disk.name}: misfit of a η ln(1/η) + b η to it", left, 0.01, "η² ln²η; rounding")
        for eta_hat in (1e-2, 1e-3):
            heading, want = [], []
            for eta in (eta_hat, -eta_hat):
                found = passages(disk, 1.0, eta, 1.0)
                start = 0.0, 1.0, 1.0, shot_slope(disk) - eta
                heading.append(plain.integrate(disk, start, found.duration).v[-1, :2] @ [1.0, 1j])
                want.append(float(found.delta_chi[0]))
            off = abs(heading[0] / heading[1] - np.exp(1j * (want[0] - want[1])))
            why = "8-dimensional equations at 1e-12, amplified by 1/η"
            yield near(f"{disk.name}: A e₃ from both sides in 8 dimensions, η̂ = ±{eta_hat:g}", off, 0.0, 1e-8, why)
    yield near(f"{MATCHING.name}: both limits apart, rotation and centre", apart(MATCHING), 0.0, 1e-5, _LOG)

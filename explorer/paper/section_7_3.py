"""Sections 7.3 and 1 of the paper: what the two one-sided limits do at an impact.

Measured on integrated motions at small eta_hat of both signs, shortly before and after the impact
(`beside`) or back at the vertical (`risen`), along sequences of eta_hat, and in 8 dimensions.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial.polynomial import polyfit

from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import Passages, passages
from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import (
    EXACT,
    HOOP,
    MATCHING,
    THICK,
    UNIFORM,
    at_most,
    exponent,
    followed,
    near,
    near_the_line,
    observed,
)
from explorer.paper.closed_forms import eta_per_eta_hat, flat_spin
from explorer.paper.four_dimensions import upright
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.states import Array, phi_to_states

_LOG = "of order η ln(1/η), 2e-7 at 1e-8"


@dataclass(frozen=True)
class Bounce:
    """A motion at eta_hat shortly before and after its first impact, sqrt(eta_hat) from the middle; two rows each.

    A, B: eqs (7.1), (7.19). nu: angular velocity in space; velocity: of the centre; arm: from centre to contact.
    """

    A: float
    B: float
    chi: Array
    nu: Array
    velocity: Array
    arm: Array


@lru_cache
def beside(disk: Disk, face: int, sign: int, eta_hat: float, sigma3_bar: float = 1.0) -> Bounce:
    """The motion from the vertical with speed 1, integrated; nu by (2.27), (2.29), velocities by differences."""
    whole = passages(disk, sigma3_bar, sign * eta_hat, 1.0, face, accuracy=EXACT)
    wait = np.sqrt(eta_hat)
    grid = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) * 0.02 * wait
    times = 0.5 * whole.duration + np.concatenate([grid - wait, grid + wait])
    run = followed(disk, near_the_line(disk, sign * eta_hat, face, sigma3_bar), times)
    weights = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * 0.02 * wait)
    at = [2, 7]
    chi, s3, s4, q, z = run.chi[at], run.sigma3[at], run.sigma4[at], np.cos(run.phi[at]), np.sin(run.phi[at])
    turning = (q * s4 - z * s3 / q - 1j * run.phidot[at]) * np.exp(1j * chi)
    return Bounce(
        A=float(whole.impact_speed),
        B=flat_spin(disk, sigma3_bar),
        chi=chi,
        nu=np.stack([turning.real, turning.imag, s3 + z * s4], axis=1),
        velocity=np.stack([weights @ run.path[:5], weights @ run.path[5:]]),
        arm=run.contact[at] - run.path[at],
    )


SMALL = np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
ROOT = "of order √η̂ (1e-4 at 1e-8): it is taken at times √η̂ from the impact"
CASES = tuple(
    (disk, face, sign, f"{disk.name}, face {face:+d}, sgn η {sign:+d}:")
    for disk in (UNIFORM, HOOP, THICK)
    for face in (1, -1)
    for sign in (1, -1)
)


def vanishing(what: str, away: Any) -> Iterator[Finding]:
    """Distances along SMALL, taken sqrt(eta_hat) from the impact: the last of them, and their order."""
    yield near(f"{what}, η̂ = 1e-8", away[-1], 0.0, 1e-3, ROOT)
    yield near(f"{what}: exponent in η̂", exponent(SMALL, away), 0.5, 0.05, "the next power, η ln(1/η)")


def horizontal(size: float, chi: Any, lift: float) -> Array:
    """size (sin chi, -cos chi), lift upwards."""
    return np.array([size * np.sin(chi), -size * np.cos(chi), lift])


@statement(48, "LEMMA-7")
def limits_of_nu() -> Iterator[Finding]:
    """Lemma 7, (7.16)–(7.19): χ↑ − χ↓ = sgn(η) Δχ, ν↓ = (±A sin χ↓, ∓A cos χ↓, B); ν↑ alike."""
    for disk, face, sign, where in CASES:
        away = np.empty((2, SMALL.size))
        for i, eta_hat in enumerate(SMALL):
            run = beside(disk, face, sign, float(eta_hat))
            down = run.nu[0] - horizontal(face * run.A, run.chi[0], run.B)
            up = run.nu[1] - horizontal(-face * run.A, run.chi[1], run.B)
            away[0, i] = np.linalg.norm([down, up], axis=1).max()
            away[1, i] = abs(run.chi[1] - run.chi[0] - sign * disk.kappa * np.pi)
        for what, row in (("ν before and after, off (7.17), (7.18)", away[0]), ("χ↑ − χ↓ off sgn(η) Δχ", away[1])):
            yield from vanishing(f"{where} {what}", row)
    for disk in (UNIFORM, THICK):
        other = beside(disk, 1, 1, 1e-3)
        middle = 0.5 * passages(disk, 1.0, 1e-3, 1.0, accuracy=EXACT).duration
        times = middle + np.sqrt(1e-3) * np.array([-1.0, 1.0])
        motion = plain.integrate(disk, upright(disk, 1e-3), times)
        text = f"{disk.name}: ν = Aω in 8 dimensions at η̂ = 1e-3, before and after"
        yield near(text, motion.nu, other.nu, 1e-8, "8-dimensional equations at 1e-12, amplified by 1/η")
    yield from _where_lemma_7_holds()


def _where_lemma_7_holds() -> Iterator[Finding]:
    """Lemma 7's stretch: sigma4 has its limit (7.20) already, and the race is not on."""
    flat = 0.5 * passages(UNIFORM, 1.0, 1e-8, 1.0, accuracy=EXACT).duration
    times = flat - np.geomspace(2e-2, 2e-3, 20)
    phi, sigma4 = (row[0] for row in observed(UNIFORM, near_the_line(UNIFORM, 1e-8), times, "phi", "sigma4"))
    s1 = np.sin(phi[abs(sigma4 - flat_spin(UNIFORM)) < 1e-2])
    text = "uniform, η̂ = 1e-8, falling to face +1: 1 − σ₁ where σ₄ is within 0.01 of (7.20); as printed, 1 + σ₁"
    off, why = {"Lemma 7, proof": np.min(1.0 + s1)}, "far above |ε| = 1e-8, far below 1"
    yield at_most(text, np.max(1.0 - s1), 1e-2, why, off)


def planar(ratio: float) -> Disk:
    """A planar body with m r^2/I1 = ratio."""
    return Disk(I1=1.0 / ratio, I3=2.0 / ratio, name=f"ratio-{ratio:g}")


def said(disk: Disk) -> str:
    """The name of a body; a planar one is named by its ratio, with a sign that names of files cannot have."""
    return disk.name.replace("ratio-", "mr²/I₁ = ")


@statement(49, "COR-1")
def jump_of_nu() -> Iterator[Finding]:
    """Cor. 1: ν turns by sgn(η)(Δχ − π) about the vertical; continuous iff mr²/I₁ = 4k(k+1)."""
    for disk, face, sign, where in CASES:
        nu = beside(disk, face, sign, 1e-8).nu
        turn = complex(*nu[1, :2]) / complex(*nu[0, :2])
        want = np.exp(1j * sign * np.pi * (disk.kappa - 1.0))
        yield near(f"{where} turn of ν, as e^iα off e^i(Δχ−π)", abs(turn - want), 0.0, 1e-3, ROOT)
        why, rise = "1e-11 a passage; both times mirror each other", float(abs(nu[1, 2] - nu[0, 2]))
        yield near(f"{where} jump of its vertical part", rise, 0.0, 1e-9, why)
    for ratio in (2.0, 3.0, 4.0, 7.9, 8.0, 8.1, 15.0, 24.0):
        run = beside(planar(ratio), 1, 1, 1e-8)
        jump = float(np.linalg.norm(run.nu[1] - run.nu[0]) / run.A)
        want = 2.0 * abs(np.sin(0.5 * np.pi * (np.sqrt(1.0 + ratio) - 1.0)))
        yield near(f"mr²/I₁ = {ratio:g}: |ν↑ − ν↓|/A (zero at 8 and 24 only)", jump, want, 2e-3, ROOT)


@dataclass(frozen=True)
class Risen:
    """A motion a third of a passage after its first impact: chi, rotation (3, 3), centre (3)."""

    chi: float
    rotation: Array
    centre: Array


@lru_cache
def risen(disk: Disk, sign: int, eta_hat: float = 1e-8) -> Risen:
    """From the vertical with speed and sigma3_bar of 1 towards face +1, approached from sgn(eta) = sign."""
    time = 5.0 / 3.0 * limit_motion(near_the_line(disk, 0.0)).impacts(9.0)[:1]
    start = near_the_line(disk, sign * eta_hat)
    phi, chi, psi, path = (row[0, 0] for row in observed(disk, start, time, "phi", "chi", "psi", "path"))
    return Risen(float(chi), plain.rotation(phi, chi, psi), path)


def apart(disk: Disk) -> tuple[float, float]:
    """How far the limits from both sides are apart when the disk has risen: rotation, centre."""
    plus, minus = risen(disk, 1), risen(disk, -1)
    return float(np.linalg.norm(plus.rotation - minus.rotation)), float(np.linalg.norm(plus.centre - minus.centre))


@statement(50, "ONE-SIDED")
def one_sided_limits() -> Iterator[Finding]:
    """7.3: the limits of the rotation as η ↑ 0 and η ↓ 0 agree iff mr²/I₁ = l² − 1."""
    ring = Disk.annulus(1.0 / np.sqrt(3.0))
    for disk in (planar(3.0), planar(8.0), planar(15.0), planar(24.0), ring):
        yield near(f"{said(disk)}: limits apart, rotation and centre", apart(disk), 0.0, 1e-5, _LOG)
    yield near(f"{ring.name}: mr²/I₁", ring.m * ring.r**2 / ring.I1, 3.0, 1e-14, "rounding")
    for disk in (UNIFORM, HOOP, planar(1.0), planar(2.9), planar(3.1), planar(10.0)):
        why = "they differ, by far more than η ln(1/η)"
        yield at_most(f"{said(disk)}: minus the distance of both rotations", -apart(disk)[0], -0.05, why)
    for order in (2, 3, 4):
        ratios = np.linspace(-0.2, 0.2, 5) + order * order - 1.0
        bodies = [planar(float(ratio)) for ratio in ratios]
        signed = [np.sin(0.5 * (risen(disk, 1).chi - risen(disk, -1).chi)) for disk in bodies]
        root = float(polyfit(signed, ratios, 4)[0])
        yield near("mr²/I₁ where the limits agree, from five bodies", root, order * order - 1.0, 1e-5, _LOG)


@statement(51, "LEMMA-8")
def velocity_of_the_centre() -> Iterator[Finding]:
    """Lemma 8, Cor. 2: ȧ↓ = r(±B sin χ↓, ∓B cos χ↓, −A), ȧ↑ with A; elastic iff mr²/I₁ = 4k²−1."""
    for disk, face, sign, where in CASES:
        away = []
        for eta_hat in SMALL:
            run = beside(disk, face, sign, float(eta_hat))
            want = [horizontal(face * run.B, run.chi[0], -run.A), horizontal(face * run.B, run.chi[1], run.A)]
            away.append(float(np.linalg.norm(run.velocity - want, axis=1).max()))
        yield from vanishing(f"{where} ȧ before and after, off Lemma 8", away)
        plane = beside(disk, face, sign, 1e-10).velocity @ [1.0, 1j, 0.0]
        turn = plane[1] / plane[0] - np.exp(1j * sign * np.pi * disk.kappa)
        yield near(f"{where} turn of horizontal ȧ, as e^iα off e^iΔχ", abs(turn), 0.0, 1e-3, ROOT)
    for ratio in (2.0, 3.0, 4.0, 8.0, 15.0, 24.0):
        run = beside(planar(ratio), 1, 1, 1e-10)
        off = float(np.linalg.norm(run.velocity[1] - run.velocity[0] * [1.0, 1.0, -1.0]) / run.B)
        want = 2.0 * abs(np.sin(0.5 * np.pi * np.sqrt(1.0 + ratio)))
        what = f"mr²/I₁ = {ratio:g}: ȧ↑ off an elastic collision, over B (zero at 3 and 15 only)"
        yield near(what, off, want, 1e-3, ROOT)


def _through_the_race(disk: Disk, eta_hat: float) -> tuple[Passages, Any]:
    """The passage, and the motion through the race on a grid as fine as the tilt is small."""
    whole = passages(disk, 1.0, eta_hat, 1.0, accuracy=EXACT)
    y = np.linspace(-5.0, 5.0, 401)
    times = 0.5 * whole.duration + whole.theta_min / whole.impact_speed * np.sinh(y)
    run = followed(disk, near_the_line(disk, eta_hat), times)
    for name in ("path", "contact"):
        velocity = np.gradient(getattr(run, name), times, axis=0, edge_order=2)
        setattr(run, f"{name}_speed", np.linalg.norm(velocity, axis=1))
    return whole, run


_ETAS = (1e-2, 1e-3, 1e-4, 1e-5)


@statement(52, "SEC-7.3")
def bounded_rates() -> Iterator[Finding]:
    """7.3: ω and ν stay bounded, ⟨Iω,ω⟩ ≤ 2E, and so does ȧ, however flat the disk."""
    for disk in (UNIFORM, HOOP, THICK):
        share, most, fastest, race = [], [], [], []
        for eta_hat in _ETAS:
            whole, run = _through_the_race(disk, eta_hat)
            q, square = np.cos(run.phi), run.phidot**2 + (run.sigma3 / np.cos(run.phi)) ** 2
            share.append(float((disk.I1 * square + disk.I3 * run.sigma4**2).max() / (2.0 * whole.energy)))
            most.append(float(np.sqrt(square + run.sigma4**2).max()))
            fastest.append(float(run.path_speed.max()))
            race.append(float((abs(run.sigma3) / q**2).max()))
        yield at_most(f"{disk.name}: largest ⟨Iω,ω⟩/2E, η̂ = 1e-2 to 1e-5", np.max(share), 1.0, "E = T + V, V > 0")
        why = "bounded: it converges as η ln(1/η); χ̇ has −1"
        orders = [exponent(_ETAS, most), exponent(_ETAS, fastest)]
        yield near(f"{disk.name}: exponents in η of largest |ω|, |ȧ|", orders, 0.0, 0.02, why)
        yield near(f"{disk.name}: exponent in η of the largest χ̇", exponent(_ETAS, race), -1.0, 0.02, _LOG)


@statement(53, "CONTACT")
def speed_of_the_contact_point() -> Iterator[Finding]:
    """7.3: the contact point races at O(1/|η|), at the angle χ or (lower sign) χ + π [corrected]."""
    for disk in (UNIFORM, HOOP, THICK):
        ratio, speed = [], []
        for eta_hat in _ETAS:
            whole, run = _through_the_race(disk, eta_hat)
            speed.append(float(run.contact_speed.max()))
            excess = (disk.I1 + 1.0) * whole.impact_speed**2  # 2 (E - V0), eq. (7.1)
            ratio.append(speed[-1] * eta_hat * eta_per_eta_hat(disk) / excess)
        yield near(f"{disk.name}: exponent of its largest speed in η", exponent(_ETAS, speed), -1.0, 0.02, _LOG)
        why = "η ln(1/η); the difference quotient is good to 1e-4"
        yield near(f"{disk.name}: its largest speed over 2r(E−V₀)/|η|, η̂ = 1e-5", ratio[-1], 1.0, 1e-3, why)
    for disk, face in ((UNIFORM, 1), (UNIFORM, -1), (THICK, -1)):
        middle = 0.5 * passages(disk, 1.0, 1e-3, 1.0, face, accuracy=EXACT).duration
        times = middle + 0.03 * np.array([-1.0, 0.0, 1.0])
        motion = plain.integrate(disk, upright(disk, 1e-3, face), times)
        arm = motion.contact - motion.a
        angle = np.exp(1j * (np.arctan2(arm[:, 1], arm[:, 0]) - motion.chi))
        what = (
            f"{disk.name}, face {face:+d}: distance of e^i(angle of p − a) e^−iχ from ±1, in 8 dimensions; as "
            "printed, its distance from −1"
        )
        off = {"7.3, angle of p − a": float(abs(angle + 1.0).min())} if face > 0 else {}
        yield near(what, float(abs(angle - face).max()), 0.0, 1e-8, "1e-12 in A over the tilt, 7e-4", off)


@statement(54, "TURNS")
def many_turns() -> Iterator[Finding]:
    """7.3: if I₁ ≪ mr² the contact point runs many times round the rim before the disk rises."""
    for ratio, halves in ((24.0, 5.0), (99.0, 10.0)):
        disk = planar(ratio)
        for sign in (1, -1):
            race = passages(disk, 1.0, sign * 1e-6, 1.0, method="dop853", accuracy=1e-8).race_angle
            what = f"mr²/I₁ = {ratio:g}, sgn η {sign:+d}: race angle, integrated, over π (η̂ = 1e-6)"
            yield near(what, race / np.pi, sign * halves, 1e-5, _LOG)
        _, run = _through_the_race(disk, 1e-5)
        arm = (run.contact - run.path)[:, :2] @ [1.0, 1j]
        turned = float(np.unwrap(np.angle(arm))[[0, -1]] @ [-1.0, 1.0])
        want = disk.kappa * 2.0 * np.arctan(np.sinh(5.0))
        why = "turning with the body beside the race: the tilt 74 θ_m is left and reached"
        yield near(f"mr²/I₁ = {ratio:g}: angle of p − a over 148 θ_m/A", turned / want, 1.0, 1e-3, why)


@statement(55, "HINGE")
def hinges() -> Iterator[Finding]:
    """7.3: p↓ and p↑ are hinges: ν↓, ν↑ have horizontal parts orthogonal to p↓ − a*, p↑ − a*."""
    for disk, face, sign, where in CASES:
        cosine, lift = [], []
        for eta_hat in SMALL:
            run = beside(disk, face, sign, float(eta_hat))
            flat = run.nu * [1.0, 1.0, 0.0]
            size = np.linalg.norm(flat, axis=1) * np.linalg.norm(run.arm, axis=1)
            cosine.append(float(abs((flat * run.arm).sum(axis=1) / size).max()))
            lift.append(abs(np.cross(run.nu, -run.arm)[:, 2] - [-run.A, run.A]).max())
        yield from vanishing(f"{where} cosine of ν and p − a, before and after", cosine)
        yield near(f"{where} fall and rise of a about p, off −A and A", lift[-1], 0.0, 1e-3, ROOT)


@statement(56, "SPIN")
def spin() -> Iterator[Finding]:
    """7.3: ν₃ does not jump, its limit B is 0 iff σ̄₃ = 0, and χ, ψ jump then as well."""
    for disk in (UNIFORM, HOOP, THICK):
        for bar in (-1.0, 0.0, 0.5):
            run, want = beside(disk, 1, 1, 1e-8, bar), flat_spin(disk, bar)
            what = f"{disk.name}, σ̄₃ = {bar:g}: ν₃ before and after"
            yield near(what, run.nu[:, 2], want, 1e-6, "of order tilt² and η ln(1/η)")
        unit = disk.kappa * np.pi
        limit = limit_motion(phi_to_states(disk, 0.0, 1.0, 0.0, 0.0), 1)
        hits = limit.impacts(2.2 * limit.period)
        times = 0.5 * (hits[0] + hits[1]) + np.array([0.0, limit.period])
        start = near_the_line(disk, 1e-8, sigma3_bar=0.0)
        chi, psi = (row[0] for row in observed(disk, start, times, "chi", "psi"))
        why, what = "midway between impacts; η ln(1/η)", f"{disk.name}, σ̄₃ = 0, after impacts on faces + and −:"
        yield near(f"{what} χ/Δχ", chi / unit, [1.0, 0.0], 1e-6, why)
        yield near(f"{what} ψ/Δχ", psi / unit, [1.0, 2.0], 1e-6, why)
        yield near(f"{what} χ off the limit motion", chi, limit(times).chi, 1e-5, why)


@statement(57, "SEC-1")
def two_sides() -> Iterator[Finding]:
    """Section 1: for the uniform disk and the hoop the two limits differ, by 2Δχ mod 2π."""
    for disk, gap in ((UNIFORM, 1.483259), (HOOP, 4.599611)):
        between = (risen(disk, 1).chi - risen(disk, -1).chi) % (2.0 * np.pi)
        yield near(f"{disk.name}: angle of A e₃ between both limits, η̂ = ±1e-8", between, gap, 2e-6, _LOG)
        for eta_hat in (1e-2, 1e-3):
            heading, want = [], []
            for eta in (eta_hat, -eta_hat):
                whole = passages(disk, 1.0, eta, 1.0, accuracy=EXACT)
                motion = plain.integrate(disk, upright(disk, eta), np.atleast_1d(whole.duration))
                heading.append(motion.v[-1, :2] @ [1.0, 1j])
                want.append(float(whole.delta_chi))
            off = abs(heading[0] / heading[1] - np.exp(1j * (want[0] - want[1])))
            why = "8-dimensional equations at 1e-12, amplified by 1/η"
            yield near(f"{disk.name}: A e₃ from both sides in 8 dimensions, η̂ = ±{eta_hat:g}", off, 0.0, 1e-8, why)
    yield near(f"{MATCHING.name}: both limits apart, rotation and centre", apart(MATCHING), 0.0, 1e-5, _LOG)

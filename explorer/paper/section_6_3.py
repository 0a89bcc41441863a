"""Section 6.3 of the paper: how a fall ends."""

from collections.abc import Iterator
from functools import lru_cache
from typing import Any

import numpy as np

from explorer.motion.limit_motions import limit_motion
from explorer.motion.passages import passages
from explorer.paper import eight_dimensions as plain
from explorer.paper.checks import BODIES, EXACT, HOOP, THICK, UNIFORM, exponent, near
from explorer.paper.closed_forms import flat_spin, impact_speed, recessive_at_vertical
from explorer.paper.four_dimensions import sigma_at, sigma_energy, upright
from explorer.paper.statement import Finding, statement
from explorer.phase.disk import Disk
from explorer.phase.states import Array, phi_to_states


@lru_cache
def ending(disk: Disk, face: int) -> tuple[Array, plain.PlainMotion]:
    """The 8-dimensional motion at times 0.01 to 0.3 before it falls from the vertical with speed and σ̄₃ of 1."""
    tau = 0.155 + 0.145 * np.cos(np.pi * (np.arange(14) + 0.5) / 14)
    impact = passages(disk, 1.0, 0.0, 1.0, face, accuracy=EXACT).fall_time
    return tau, plain.integrate(disk, upright(disk, 0.0, face), impact - tau)


def at_impact(tau: Array, values: Any, order: int = 0) -> Any:
    """The limit at the impact of values (n,) or (n, k), or of their rate of change, by a polynomial."""
    flat = np.reshape(values, (tau.size, -1))
    fitted = np.polynomial.polynomial.polyfit(tau / 0.3, flat, 11)[order] / (-0.3) ** order
    return fitted.reshape(np.shape(values)[1:])


def approach(tau: Array, values: Any) -> float:
    """The exponent of the distance to the limit in t* - t, from the five times nearest to the impact."""
    away = np.reshape(values - at_impact(tau, values), (tau.size, -1))[-5:]
    return exponent(tau[-5:], np.linalg.norm(away, axis=1))


_LIMIT = "motion in 8 dimensions at 1e-12, extrapolated from t* − t ≥ 0.01"
_RATE = "the next power of t* − t, 0.01 to 0.1 here"
_CASES = [(disk, face, f"{disk.name}, face {face:+d}:") for disk in (UNIFORM, HOOP, THICK) for face in (1, -1)]


@statement(36, "PROP-1")
def bang() -> Iterator[Finding]:
    """Prop. 1, (6.12), (6.13): it falls with a bang: φ̇ → ±A = ±√(2(E − V₀)/M) [corrected]."""
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        phidot = motion.sigma[:, 1] / np.hypot(*motion.u.T[:2])
        energy, M = sigma_energy(disk, sigma_at(*upright(disk, 0.0, face))), disk.I1 + 1.0
        wanted, printed = (face * impact_speed(disk, E) for E in (energy, energy + 0.5 - 0.5 * M))
        off = {"Proposition 1, proof": printed}  # E = phidot^2/2 + V, and phidot = 1 at the start
        text = f"{where} φ̇ at flat; as printed from E = φ̇²/2 + V"
        yield near(text, at_impact(tau, phidot), wanted, 1e-8, _LIMIT, off)
        yield near(f"{where} exponent of the approach", approach(tau, phidot), 1.0, 0.1, _RATE)
    for disk, A in ((UNIFORM, 1.816042), (HOOP, 1.758017)):
        speed = passages(disk, 1.0, 0.0, 1.0, accuracy=EXACT).impact_speed
        yield near(f"{disk.name}: A by quadrature for the data of the figures", speed, A, 6e-7, "digits given")


@statement(37, "EQ-6.14")
def momenta_at_flat() -> Iterator[Finding]:
    """(6.14), (6.15): at flat σ₃/(1∓σ₁) → σ̄₃/r(0) and σ₄ → ±I₁σ̄₃/(I₃ r(0))."""
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        s1, _, s3, s4 = motion.sigma.T
        ratio = s3 * (1.0 + face * s1) / (motion.u[:, :2] ** 2).sum(axis=1)  # 1 - σ₁² without cancellation
        yield near(f"{where} σ₃/(1∓σ₁)", at_impact(tau, ratio), 1.0 / recessive_at_vertical(disk)[0], 1e-7, _LIMIT)
        yield near(f"{where} σ₄", at_impact(tau, s4), face * flat_spin(disk), 1e-8, _LIMIT)
        both = [approach(tau, ratio), approach(tau, s4)]
        yield near(f"{where} exponents of both (analytic in 1∓σ₁)", both, 2.0, 0.05, _RATE)


@statement(38, "EQ-6.16")
def spin_of_psi() -> Iterator[Finding]:
    """(6.16): ψ̇ → ∓(−½ + I₁/I₃) σ̄₃/r(0) at flat, zero for planar bodies."""
    for disk in BODIES:
        for face in (1, -1):
            tau, motion = ending(disk, face)
            want = -face * (-0.5 + disk.I1 / disk.I3) / recessive_at_vertical(disk)[0]
            rate = at_impact(tau, motion.psi, 1)
            yield near(f"{disk.name}, face {face:+d}: rate of the angle ψ", rate, want, 1e-6, _LIMIT)


@statement(39, "EQ-6.17")
def vectors_at_flat() -> Iterator[Finding]:
    """(6.17)–(6.19): u̇, ω and the point of contact converge at flat, at a rate O(t* − t)."""
    for disk, face, where in _CASES:
        tau, motion = ending(disk, face)
        psi, speed = (
            at_impact(tau, motion.psi),
            face * passages(disk, 1.0, 0.0, 1.0, face, accuracy=EXACT).impact_speed,
        )
        spin = face * flat_spin(disk)
        hinge = np.array([np.cos(psi), np.sin(psi), 0.0])
        udot = np.cross(motion.u, motion.omega)
        yield near(f"{where} u̇", at_impact(tau, motion.u, 1), -face * speed * hinge, 1e-6, _LIMIT)
        want = np.array([-speed * hinge[1], speed * hinge[0], spin])
        yield near(f"{where} ω", at_impact(tau, motion.omega), want, 1e-7, _LIMIT)
        limit = limit_motion(phi_to_states(disk, *upright(disk, 0.0, face)))
        point = limit(limit.impacts(5.0)[0] * (1.0 - 1e-14)).contact
        yield near(f"{where} point of contact", at_impact(tau, motion.contact), point, 1e-7, _LIMIT)
        rates = [approach(tau, v) for v in (udot, motion.omega, motion.contact)]
        want = np.array([1.0, 1.0, 1.0 if disk is THICK else 3.0])  # p moves at rψ̇, which (6.16) makes O((t*-t)²)
        yield near(f"{where} exponents of u̇, ω, p", rates, want, 0.05, _RATE)

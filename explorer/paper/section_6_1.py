"""Section 6.1 and Lemma 4 of the paper: the barrier off the lines l±, and the potential on them.

Everything is integrated here from eqs (2.15)-(2.18) and (3.1) as they stand, by SciPy, and judges the explorer.
"""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.optimize import brentq

from explorer.measure.tubes import widest_eta
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.paper.checks import BODIES, HOOP, THICK, UNIFORM, at_most, exponent, near, observed
from explorer.paper.closed_forms import (
    eta_per_eta_hat,
    flat_potential,
    line_ratio,
    parameters,
    recessive_at_vertical,
)
from explorer.paper.four_dimensions import potential, rates_down, reduced, shot_slope
from explorer.paper.statement import Finding, statement
from explorer.phase.constants import constants
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import line_chart, line_slope
from explorer.phase.states import Array, phi_to_states


@statement(27, "EQ-6.1")
def lines() -> Iterator[Finding]:
    """(6.1) l± are the lines on which σ₃ vanishes at flat: σ̄₄/σ̄₃ = ±(I₁/I₃) r′(0)/r(0)."""
    for disk in BODIES:
        want, why = line_ratio(disk), "eq. (3.1) is integrated to 1e-13"
        yield near(f"{disk.name}: slope by shooting", shot_slope(disk), want, 1e-11, why)
        yield near(f"{disk.name}: slope by the series", line_slope(disk), want, 1e-14, "rounding")
        flat = rates_down(disk, 1.0, -want, -1, [1e-3])[:, -1]
        yield near(f"{disk.name}: σ₃ near flat on l₋", flat[0], 0.0, 1e-6, "σ₃ is of order tilt² = 1e-6 there")


@statement(28, "LEMMA-3")
def barrier_off_lines() -> Iterator[Finding]:
    """Lemma 3, (6.3), (6.4): off l± V ~ η²/4I₁(1∓σ₁), V′ ~ ±η²/4I₁(1∓σ₁)²; rest [corrected]."""
    step = 1e-4
    for disk, face in ((UNIFORM, 1), (HOOP, -1), (THICK, 1), (THICK, -1)):
        r0, dr0 = recessive_at_vertical(disk)
        eta = disk.I1 * dr0 - face * disk.I3 * r0 * 0.3
        tilts = np.ravel([[t * (1.0 + step), t, t * (1.0 - step)] for t in (1e-2, 1e-3, 1e-4, 1e-5)])
        V = potential(disk, tilts, rates_down(disk, 1.0, 0.3, face, tilts)).reshape(4, 3)
        S = _depth(tilts[1::3])
        ratio = V[:, 1] * 4.0 * disk.I1 * S / eta**2
        slope = (V[:, 0] - V[:, 2]) / (2.0 * step * tilts[1::3]) / -np.sin(tilts[1::3])
        where = f"{disk.name}, face {face:+d}:"
        why = "at tilt 1e-5; the next term is θ² ln²θ = 1e-8 of it"
        yield near(f"{where} V·4I₁(1∓σ₁)/η², tilts 1e-2 to 1e-5", ratio[-1], 1.0, 1e-6, why)
        dV = slope[-1] * 4.0 * disk.I1 * S[-1] ** 2 / eta**2
        text, why = (
            f"{where} ±V′·4I₁(1∓σ₁)²/η², by (6.4); as printed, by (6.3), with 1∓σ₁ in place of its square",
            why + "; a difference quotient",
        )
        yield near(text, dV, 1.0, 1e-6, why, {"Lemma 3, end of proof": dV / S[-1]})  # over the right side of (6.3)
        yield from _rest_of_the_barrier(disk, face, eta)


def _depth(tilts: Array) -> Array:
    """1 -+ sigma_1."""
    return 2.0 * np.sin(0.5 * tilts) ** 2


def _rest_of_the_barrier(disk: Disk, face: int, eta: float) -> Iterator[Finding]:
    """What eq. (6.7) leaves of V beside its first term, for sigma3_bar = 1 and sigma4_bar = 0.3."""
    where, c, J = f"{disk.name}, face {face:+d}:", parameters(disk).c, disk.I3 + 1.0
    square = 0.5 * J * (eta * c / (2.0 * disk.I3)) ** 2
    tilts = np.geomspace(1e-3, 1e-4, 12)
    S, sigma = _depth(tilts), rates_down(disk, 1.0, 0.3, face, tilts)
    logs = np.log(S)
    rest = potential(disk, tilts, sigma) - eta**2 / (4.0 * disk.I1 * S) - square * logs**2
    # sigma_4 = slope ln S + level: its square has this multiple of ln S, sigma_3^2/q^2 the other one.
    slope, level = np.polyfit(logs, sigma[1], 1)
    want = J * slope * level + c * eta**2 / (4.0 * disk.I1)
    text = (
        f"{where} let D be V minus the other terms of (6.7): slope of D against ln(1∓σ₁), divided by the slope "
        "that follows from σ₄ and (3.8); as printed, D does not grow"
    )
    yield near(text, np.polyfit(logs, rest, 1)[0] / want, 1.0, 5e-3, "terms S ln²S", {"(6.7)": 0.0})


@statement(29, "SEC-6.1")
def no_fall_off_lines() -> Iterator[Finding]:
    """6.1: off l± the disk never falls flat, and its motions exist for all time."""
    random = np.random.Generator(np.random.Philox(29))
    low, high = np.array([[-1.5, -2.0, -2.0, -2.0], [1.5, 2.0, 2.0, 2.0]])
    for disk in BODIES:
        rows = random.uniform(low, high, (4000, 4))
        states = phi_to_states(disk, *rows.T)
        theta, status, _ = smallest_tilt(states, plan(("theta_min",), 1e-8, "quadrature"))
        given = constants(states)
        stuck = int((status != 0).sum() + (~(theta > 0.0)).sum())
        yield near(f"{disk.name}: of 4000 plain draws, falls or zero tilts", stuck, 0, 0.0, "a count")
        eta = np.fmin(abs(given.eta_hat_plus), abs(given.eta_hat_minus))
        bound = np.array([widest_eta(given.energy[i : i + 1], theta[i], disk)[0] for i in range(400)])
        share = float((eta[:400] / bound).max())
        yield at_most(f"{disk.name}: largest η, over what the energy allows at θ_min", share, 1.0, "a bound")
        phi = observed(disk, rows[:12].T, np.linspace(0.0, 60.0, 400), "phi")[0]
        lower = 1.0 - float((np.cos(phi).min(axis=1) / np.sin(theta[:12])).min())
        why = "the accuracy 1e-8 of θ_min, 1e-11 a passage of the motion; NaN where one ends"
        yield at_most(f"{disk.name}: 12 motions to t = 60, how far below sin θ_min they come", lower, 1e-7, why)


@statement(30, "EQUILIBRIA")
def equilibria_near_flat() -> Iterator[Finding]:
    """6.1: for fixed (σ̄₃,σ̄₄) ∉ l± none near flat; as η → 0 one at θ₀ ~ (η²/I₁mgr)^⅓."""
    for disk in (UNIFORM, HOOP, THICK):

        def down(log_tilt: float, eta_hat: float, disk: Disk = disk) -> tuple[float, Array]:
            """(dV/dφ, (σ₃, σ₄)) by the exact layer, eq. (4.10)."""
            tilt = np.exp(log_tilt)
            q, z = np.sin([tilt]), np.cos([tilt])
            s3, s4 = line_chart(disk, q, z).rates(0.3, eta_hat)
            slope = disk.I1 * s3 * s3 * z / q**3 - (disk.I3 + 1.0) * s3 * s4 / q - z
            return float(slope[0]), np.array([s3[0], s4[0]])

        etas = 10.0 ** -np.arange(6.0, 15.0)
        want = ((etas * eta_per_eta_hat(disk)) ** 2 / disk.I1) ** (1.0 / 3.0)
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
    """V on l± with σ̄₃ = 1 as a polynomial in the tilt, from tilts 0.01 to 1: it knows nothing of flat."""

    def V(tilts: Array) -> Array:
        falling = np.sort(tilts)[::-1]
        values = potential(disk, falling, rates_down(disk, 1.0, face * shot_slope(disk), face, falling))
        return values[np.argsort(np.argsort(-tilts))]

    return Chebyshev.interpolate(V, 18, domain=[0.01, 1.0])


_FIT = "extrapolated from tilts above 0.01; the fit's tail is 1e-12 and grows a hundredfold"


@statement(31, "LEMMA-4")
def potential_at_flat() -> Iterator[Finding]:
    """Lemma 4, (6.9): on l± V(φ) extends analytically to flat, V(±π/2) = I₁²J σ̄₃²/2I₃²r(0)²."""
    for disk in BODIES:
        for face in (1, -1):
            V = on_line(disk, face)
            other = potential(disk, [1e-3], rates_down(disk, 1.0, face * shot_slope(disk), -face, [1e-3]))[0]
            text = f"{disk.name}, face {face:+d}: V(±π/2)/σ̄₃²; as printed, V(∓π/2), taken 1e-3 from that angle"
            off = {"Lemma 4, proof": other}
            yield near(text, float(V(0.0)), flat_potential(disk), 1e-11, _FIT, off)
        rate = float(np.polyfit(np.arange(14), np.log(abs(V.coef[2:16])), 1)[0])
        why = "a logarithm or root at flat would give algebraic decay, ratio above 0.8"
        yield at_most(f"{disk.name}: ratio of successive Chebyshev coefficients", float(np.exp(rate)), 0.5, why)


@statement(32, "EQ-6.10")
def slope_at_flat() -> Iterator[Finding]:
    """(6.10): on l± V′(±π/2) = ∓mgr: V has a strict one-sided minimum at flat [corrected]."""
    for disk in BODIES:
        for face in (1, -1):
            V = on_line(disk, face)
            slope = -face * float(V.deriv()(0.0))  # φ = face (π/2 - tilt)
            yield near(f"{disk.name}, face {face:+d}: V′(±π/2)", slope, -face, 1e-9, _FIT)
            tilts = np.linspace(1e-3, 0.2, 60)
            fall, beyond = (float(((V(0.0) - V(way * tilts)) / tilts).max()) for way in (1.0, -1.0))
            text = f"{disk.name}, face {face:+d}: largest (V₀ − V)/θ up to tilt 0.2; as printed also beyond flat"
            off = {"Lemma 4, end": beyond}
            yield at_most(text, fall, 0.0, "a sign", off)
            tilts = np.geomspace(1e-5, 1e-4, 10)
            order = exponent(_depth(tilts), V.deriv()(tilts) / np.sin(tilts))
            where = f"{disk.name}, face {face:+d}"
            text = f"{where}: exponent of 1∓σ₁ in the last term of dV/dσ₁, by (6.8); printed 1/2"
            yield near(text, order, -0.5, 1e-3, _FIT, {"(6.8)": 0.5})

"""Tubes round the falling set: how wide they are, and what the energy is in them.

Beside F on one face a state is (phi, phidot, sigma3_bar, eta_hat), and dsigma3 dsigma4 = dsigma3_bar deta_hat.
So eta_hat is a number of its own, drawn as small as one likes, and no digit is lost. A tube is wide enough to
hold every motion that gets flatter than delta: at its flattest moment the energy bounds sigma3 and sigma4, and
with them eta.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at, eta_to_eta_hat
from explorer.phase.linear_constants import line_chart, nearer_plus
from explorer.phase.states import Array, States

# Half the width of a tube is sought by iteration. Each round overshoots by this much, so that it ends above the
# bound that it would otherwise creep up to; a tube that is 2 % too wide wastes 2 % of its draws.
_MARGIN, _ROUNDS = 1.02, 12
# Ratio of two |eta_hat| that are equal up to rounding. The tubes of both faces meet a state beside both lines, and
# each has drawn one of its two eta_hat and rounded the other. Where they are equal, as with phi = sigma3 = 0, such
# a state would by chance count twice or not at all.
_TIE = 1.0 - 1e-12


def widest_eta(energy: Array, delta: float, disk: Disk) -> Array:
    """A bound of |eta_hat| for motions of this energy that get flatter than delta; natural units.

    At the flattest moment I1 rho^2 <= 2E and J sigma4^2 <= 2E, and eta is linear in both, eq. (6.2).
    """
    b = disk.body
    S = 2.0 * math.sin(0.5 * delta) ** 2
    chart = line_chart(disk, np.array([math.sin(delta)]), np.array([math.cos(delta)]))
    # rho(S) and rho'(S) are the chart's columns of sigma3_bar times r(0) and k r(0); rho >= S
    recessive, slope = max(b.r0 * chart.bar_to_sigma3[0], S), b.k * b.r0 * chart.bar_to_sigma4[0]
    most = np.sqrt(2.0 * np.maximum(energy, 0.0))
    eta = most * (math.sqrt(b.I1) * math.sin(delta) * slope + b.I3 / math.sqrt(b.J) * recessive)
    return eta_to_eta_hat(b, eta)


def may_come(states: States, delta: float) -> NDArray[np.bool_]:
    """Which states may come flatter than delta."""
    disk, motion = states.disk, states.motion
    eta_hat = eta_to_eta_hat(disk.body, motion.eta(motion.nearer_plus))
    near: NDArray[np.bool_] = abs(eta_hat) <= widest_eta(motion.energy, delta, disk)
    return near


def counts_on(face: int, eta: Array, other: Array) -> NDArray[np.bool_]:
    """Whether states beside both lines, at eta_hat on this face and on the other, count on this one.

    Each counts once, on the nearer face; equally near, up to rounding, on face +1.
    """
    return nearer_plus(_TIE * eta, other) if face > 0 else ~nearer_plus(_TIE * other, eta)


def half_width(disk: Disk, delta: float, energy: Callable[[Array], Array], count: int) -> Array:
    """Half the widths of tubes: a bound x >= widest_eta(energies within x); inf where none is found.

    widest_eta(energy(x)) is convex in x, so beyond such an x no state comes flatter than delta. energy: of states
    (count) at this distance eta_hat, quadratic in it.
    """
    half = widest_eta(energy(np.zeros(count)), delta, disk) * _MARGIN
    settled = np.zeros(count, bool)
    for _ in range(_ROUNDS):
        needed = widest_eta(np.maximum(energy(half), energy(-half)), delta, disk)
        settled = needed <= half
        if settled.all():
            break
        half = np.where(settled, half, needed * _MARGIN)
    return np.where(settled, half, np.inf)


class TiltAndRate(NamedTuple):
    """Tilts, by cos phi and sin phi, and speeds of draws, and the chart there; natural units."""

    body: "compiled.body.Body"
    q: Array
    z: Array
    phidot: Array
    chart: "compiled.falling.LineChart[Array]"

    def energy(self, bar: Array, eta: Array) -> Array:
        s3, s4 = self.chart.rates(bar, eta)
        found: Array = energy_at(self.body, self.phidot, s3 / self.q, s4, self.q)
        return found

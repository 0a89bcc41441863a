"""Tubes round the falling set: draws of states that come flatter than a given tilt, with their weights.

Beside F on one face a state is (phi, phidot, sigma3_bar, eta_hat), and dsigma3 dsigma4 = dsigma3_bar deta_hat.
So eta_hat is a number of its own, drawn as small as one likes, and no digit is lost. A tube is wide enough to
hold every motion that gets flatter than delta: at its flattest moment the energy bounds sigma3 and sigma4, and
with them eta.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.measure.box_integrals import ends_of_bar
from explorer.measure.density import Density
from explorer.measure.sampling import Range
from explorer.motion.starts import arc_starts
from explorer.motion.turning_points import lowest_tilts
from explorer.phase.disk import Disk
from explorer.phase.lines import LineChart, line_chart, motion_given, other_eta_hat
from explorer.phase.states import Array, Rows

# Half the width of a tube is sought by iteration. Each round overshoots by this much, so that it ends above the
# bound that it would otherwise creep up to; a tube that is 2 % too wide wastes 2 % of its draws.
_MARGIN = 1.02
_ROUNDS = 12  # what has not settled by then takes the bound that holds in all of the box
# Ratio of two |eta_hat| that are equal up to rounding. The tubes of both faces meet a state beside both lines, and
# each has drawn one of its two eta_hat and rounded the other. Where they are equal, as with phi = sigma3 = 0,
# `phase.lines.nearer_plus` would by chance count such a state twice or not at all.
_TIE = 1.0 - 1e-12
_SCAN = 2001  # tilts at which it is looked up where the tube meets the box


@dataclass(frozen=True)
class Draws:
    """States of a tube, one array entry each, in the units of the disk.

    weight: the mean of weight times an indicator, over the draws, is the probability of the event within the
    tube. Zero outside the box or the energies, and where the other face is nearer.
    theta_min: smallest tilt of the whole motion (rad); NaN where status is not OK.
    """

    phi: Array
    phidot: Array
    sigma3_bar: Array
    eta_hat: Array
    energy: Array
    weight: Array
    theta_min: Array
    status: NDArray[np.int8]


def dimensions(density: Density) -> int:
    """Number of uniform numbers that a draw takes."""
    return len(density.box.free)


def draw_tube(
    disk: Disk, density: Density, mass: float, face: int, delta: float, points: Array, accuracy: float = 1e-6
) -> Draws:
    """States within the tube of tilt delta round F on one face.

    mass: integral of the density (FallingConstant.mass). points: (n, dimensions), uniform in the unit cube.
    accuracy: relative, of theta_min.
    """
    return Tube(disk, density.seen_from(disk, face), face, delta).draw(points, mass, accuracy)


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
    return disk.eta_to_eta_hat(
        most * (math.sqrt(b.I1) * math.sin(delta) * slope + b.I3 / math.sqrt(b.J) * recessive)
    )


def counts_on(face: int, eta: Array, other: Array) -> NDArray[np.bool_]:
    """Whether states beside both lines, at eta_hat on this face and on the other, count on this one.

    Each counts once, on the nearer face; equally near, up to rounding, on face +1.
    """
    nearer: NDArray[np.bool_] = abs(eta) * _TIE <= abs(other) if face > 0 else abs(eta) < abs(other) * _TIE
    return nearer


def half_width(
    disk: Disk,
    delta: float,
    energy: Callable[[Array], Array],
    widest: Array,
    most: float = math.inf,
) -> tuple[Array, NDArray[np.bool_]]:
    """Half the width of a tube, and where it is known: a bound x >= widest_eta(energies within x).

    widest_eta(energy(x)) is convex in x, so beyond such an x no state comes flatter than delta. energy: of states
    at this distance eta_hat, quadratic in it; most: a bound of it. widest: a bound of x, taken where none settles.
    """
    half = widest_eta(energy(np.zeros_like(widest)), delta, disk) * _MARGIN
    settled = np.zeros(widest.shape, bool)
    for _ in range(_ROUNDS):
        needed = widest_eta(np.minimum(np.maximum(energy(half), energy(-half)), most), delta, disk)
        settled = needed <= half
        if settled.all():
            break
        half = np.where(settled, half, needed * _MARGIN)
    return np.where(settled, np.minimum(half, widest), widest), settled


@dataclass(frozen=True)
class Tube:
    """The tube of tilt delta round F on a face, which sees the density so."""

    disk: Disk
    density: Density
    face: int
    delta: float

    @property
    def _both_free(self) -> bool:
        """True where neither sigma3 nor sigma4 is fixed by the box."""
        return self.density.free("sigma3") and self.density.free("sigma4")

    def _tilts_met(self) -> Range:
        """The tilts between which the tube passes the box."""
        phi = np.linspace(*self.density.reach("phi"), _SCAN)
        fastest = np.full(_SCAN, self.density.most("phidot"))
        if self._both_free:
            span = self._spans(TiltAndRate.at(self.disk, phi, fastest))[2]
            met = np.flatnonzero(np.convolve(span > 0.0, np.ones(3), "same"))  # and their neighbours
            phi = phi[met] if met.size else phi
        return phi[0], phi[-1]

    def draw(self, points: Array, mass: float, accuracy: float) -> Draws:
        """As `draw_tube`."""
        disk, density, face = self.disk, self.density, self.face
        columns, weight = iter(points.T), np.ones(points.shape[0])
        phi, phidot = (self._draw_factor(name, columns, weight) for name in ("phi", "phidot"))
        place = TiltAndRate.at(disk, phi, phidot)
        bar, eta, width = self._beside(place, columns)
        given, energy = (phi, phidot, *place.chart.rates(bar, eta)), place.energy(bar, eta)
        other = other_eta_hat(disk, bar, eta)
        counted = density.inside(*given, energy) & counts_on(face, eta, other) & (width > 0.0)
        weight = np.where(counted, weight * width / mass, 0.0)
        weight[counted] *= density.shape(*(column[counted] for column in given))
        theta, status = self._tilts(place, bar, eta, np.flatnonzero(weight > 0.0), accuracy)
        unit = disk.rate_unit
        found = face * phi, face * phidot * unit, bar * unit, eta * unit, energy * disk.energy_unit
        return Draws(*found, weight, theta, status)

    def _draw_factor(self, name: str, columns: Iterator[Array], weight: Array) -> Array:
        """Values of phi or phidot; multiplies `weight` by one over the density that they are drawn from."""
        low, high = self.density.reach(name)
        if self.density.means(name):
            # Drawn from its own factor: what it weighs is that factor's integral over the factor.
            value = self.density.quantile(name, next(columns))
            weight *= self.density.factor_mass(name) / self.density.factor(name, value)
            return value
        if not self.density.free(name):
            return np.full(weight.size, low)
        low, high = self._tilts_met() if name == "phi" else (low, high)
        weight *= high - low
        return low + (high - low) * next(columns)

    def _beside(self, place: "TiltAndRate", columns: Iterator[Array]) -> tuple[Array, Array, Array]:
        """sigma3_bar, eta_hat, and the density of these draws to the power -1."""
        if not self._both_free:
            return self._on_segment(place, self._widest(place), next(columns))
        low, widest, span = self._spans(place)
        bar = np.where(span > 0.0, low + span * next(columns), 0.0)
        half = half_width(self.disk, self.delta, lambda x: place.energy(bar, x), widest, self.density.energy[1])[0]
        eta = half * (2.0 * next(columns) - 1.0)
        return bar, eta, 2.0 * half * span

    def _widest(self, place: "TiltAndRate") -> Array:
        """A bound of |eta_hat| at these tilts and speeds, for states of the box that come flatter than delta."""
        most3, most4 = self.density.most("sigma3"), self.density.most("sigma4")
        top = place.tilting + 0.5 * place.inertia3 * most3**2 + 0.5 * place.inertia4 * most4**2
        top = np.minimum(top, self.density.energy[1])
        bound = widest_eta(top, self.delta, self.disk)
        return np.minimum(bound, abs(place.chart.bar_to_sigma4) * most3 + abs(place.chart.bar_to_sigma3) * most4)

    def _spans(self, place: "TiltAndRate") -> tuple[Array, Array, Array]:
        """Smallest sigma3_bar in the tube, half its width in eta_hat, and the span of sigma3_bar (0: not met)."""
        widest = self._widest(place)
        a, a2, c, c2 = place.chart
        low, high = ends_of_bar(
            (a, *self.density.reach("sigma3"), abs(a2) * widest),
            (c, *self.density.reach("sigma4"), abs(c2) * widest),
        )
        return low, widest, np.maximum(high - low, 0.0)

    def _on_segment(self, place: "TiltAndRate", widest: Array, unit: Array) -> tuple[Array, Array, Array]:
        """As `_beside` for a box that fixes sigma3 or sigma4: only eta_hat is drawn, and sets the free one."""
        fixed3 = not self.density.free("sigma3")
        fixed = self.density.reach("sigma3" if fixed3 else "sigma4")[0]
        m, m2 = place.chart[:2] if fixed3 else place.chart[2:]
        eta = widest * (2.0 * unit - 1.0)
        # d(free)/d(eta_hat) = 1/|m| since the chart's determinant is -1
        return (fixed - m2 * eta) / m, eta, 2.0 * widest / abs(m)

    def _tilts(
        self, place: "TiltAndRate", bar: Array, eta: Array, rows: NDArray[np.intp], accuracy: float
    ) -> tuple[Array, NDArray[np.int8]]:
        """theta_min and status of the rows that count; bar, eta: sigma3_bar and eta_hat."""
        disk, (s3, s4) = self.disk, place.chart.rates(bar, eta)
        seen = Rows(*(column[rows] for column in (place.q, place.z, place.phidot, s3 / place.q, s4)))
        motion = motion_given(disk, bar[rows], eta[rows], np.ones(rows.size, np.bool_))
        code = np.zeros(rows.size, np.int8)
        out = lowest_tilts(disk, arc_starts(disk, seen, motion, seen.z >= 0.0), accuracy, code)
        theta, status = np.full(bar.size, np.nan), np.zeros(bar.size, np.int8)
        theta[rows], status[rows] = np.where(code == 0, out, np.nan), code
        return theta, status


@dataclass(frozen=True)
class TiltAndRate:
    """Tilts and speeds of draws, the chart there, and the factors of the energy, eq. (2.19); natural units."""

    q: Array
    z: Array
    phidot: Array
    tilting: Array
    inertia3: Array
    inertia4: float
    chart: LineChart

    @classmethod
    def at(cls, disk: Disk, phi: Array, phidot: Array) -> "TiltAndRate":
        return cls.of(disk, np.cos(phi), np.sin(phi), phidot)

    @classmethod
    def of(cls, disk: Disk, q: Array, z: Array, phidot: Array) -> "TiltAndRate":
        """The same from cos phi and sin phi."""
        b = disk.body
        return cls(q, z, phidot, 0.5 * b.M * phidot**2 + q, b.I1 / (q * q), b.J, line_chart(disk, q, z))

    def energy(self, bar: Array, eta: Array) -> Array:
        s3, s4 = self.chart.rates(bar, eta)
        return self.tilting + 0.5 * self.inertia3 * s3 * s3 + 0.5 * self.inertia4 * s4 * s4

"""The constant C of P(theta_min < delta) = C delta (1 + o(1)), by deterministic quadrature over F.

    C = sum over faces of  integral of f 2 A sqrt(I1 M) delta(eta) 1_F dphi dphidot dsigma3 dsigma4

With dsigma3 dsigma4 = dsigma3_bar deta_hat at every tilt the delta function leaves an integral over
(phi, phidot, sigma3_bar) on the line eta = 0. The innermost, over phidot, is analytic between known ends: the
box, the energy, and the barrier that a start beyond the vertical must pass to belong to F.

Where a density does not vanish at flat, states near one flat state with sigma3 of order one have energies
like 1/theta^2, and come that much nearer to the other one: P is of order delta ln(1/delta) then, and there is
no C. A bound on the energy mends it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.measure.box_integrals import (
    TOLERANCE,
    Integral,
    NaturalDensity,
    between_energies,
    ends_of_bar,
    mirrored,
    over_tilts,
    panels_between,
    settled,
)
from explorer.measure.density import ANY_ENERGY, Density, Function
from explorer.measure.sampling import Box, Range
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import line_chart
from explorer.phase.membership import barrier, well
from explorer.phase.results import Table
from explorer.phase.states import Array

_ROUNDING = 1e-13  # relative, of a sum of some 10^5 positive terms and of the solutions in it
# Halvings of the range of sigma3_bar in which a panel ends: an end that is off by 1e-12 of it costs no digit.
_BISECTIONS = 40
# Tilts between which a change of the sign of eta is sought: the line may not pass a corner twice within 1e-3 rad.
_SCAN = 4001
_STEP = 1e-5  # rad; of a central difference, whose error is 1e-10 and whose rounding 1e-11
# Integrals below the first lose digits beside the least that they try for. Of an error so many times the value not
# even the size of C is known.
_LEAST_MASS, _USELESS = 1e-290, 10.0
_AT_ONCE = 32  # tilts, where the integral over phidot is closed; else its nodes take their place in memory


@dataclass(frozen=True, repr=False)
class FallingConstant(Table):
    """The constant C of P(theta_min < delta) = C delta, per radian of tilt.

    Attributes
    ----------
    value : float
        C. It is infinite where the density does not vanish at flat and the energy has no bound, since
        P(theta_min < delta) is of order delta ln(1/delta) there; and for sigma3 = sigma4 = 0, where all fall.
    error : float
        Estimate of its absolute error.
    plus, minus : float
        What both faces contribute. Where a box fixes sigma3 = 0 or sigma4 = 0 some states come flat on both
        faces; `value` counts them once.
    mass : float
        Integral of the density over the box, natural units.

    Examples
    --------
    >>> import explorer as ex
    >>> C = ex.falling_constant(ex.Disk.uniform())
    >>> round(C.value, 5), C.error < 1e-6
    (1.46927, True)
    """

    value: float
    error: float
    plus: float
    minus: float
    mass: float

    def _arrays(self) -> dict[str, NDArray[Any]]:
        """The numbers as columns of one row."""
        return {name: np.array([value]) for name, value in vars(self).items()}


def falling_constant(
    disk: Disk,
    box: Box | str | None = None,
    *,
    energy: str | tuple[float | None, float | None] | None = None,
    gaussian: str | None = None,
    density: Function | None = None,
) -> FallingConstant:
    """Compute C of P(theta_min < delta) = C delta for states drawn from a density, by quadrature over F.

    Parameters
    ----------
    disk : Disk
        Needs I3 > 0.
    box : Box or str, optional
        Ranges of phi (rad), phidot, sigma3 and sigma4 (units of the disk), as for `run`: "phi=-1:1,sigma4=0.3".
        By default phi = 0 and rates within two natural units.
    energy : (float, float) or str, optional
        Only states with an energy in this range (units of the disk); None is no bound.
    gaussian : str, optional
        "phidot=MEAN:DEVIATION,...": Gaussian factors, cut off where the box ends.
    density : callable, optional
        Another factor: a function of (phi, phidot, sigma3, sigma4), arrays in the units of the disk. It is not
        negative and need not be normalised.

    Returns
    -------
    FallingConstant

    Raises
    ------
    InputError
        Where an argument cannot be used, the density is zero in all of the box, or the integral of a function
        overflows, underflows, or has an error above its value.

    Notes
    -----
    A function that is large in less than a twentieth of the box may be missed: shrink the box to it. Of a function
    that jumps or oscillates the integral ends after some 10^8 points, and `error` says what is lacking.

    References
    ----------
    Sections 6.2 and 7.1 of the paper for F, A and eta.

    Examples
    --------
    >>> import explorer as ex
    >>> constant = ex.falling_constant(ex.Disk.uniform())
    >>> round(constant.value, 6)
    1.469271
    """
    require_axial_inertia(disk)
    return constant_of(disk, Density.of(disk, box, energy, gaussian, density))


def constant_of(disk: Disk, density: Density, tolerance: float = TOLERANCE) -> FallingConstant:
    """As falling_constant, of a Density; tolerance: relative error to try for."""
    natural = NaturalDensity(disk, density, tolerance)
    # What overflows is refused by what comes of it.
    with np.errstate(over="ignore", invalid="ignore"):
        mass = natural.mass()
    _check_known(density, "its integral", mass, 1.0)
    if not mass.value > 0.0:
        factor = "--energy" if density.energy != ANY_ENERGY else "density"
        raise InputError(f"{factor}: the density is zero in all of the box; widen one of them")
    if mass.value < _LEAST_MASS and density.function is not None:
        raise InputError(f"density: its integral is {mass.value:.1e}, and loses its digits; multiply it by 1e300")
    if natural.reaches_flat() or _all_on_f(density.box):
        return FallingConstant(math.inf, math.inf, math.inf, math.inf, mass.value)
    with np.errstate(over="ignore", invalid="ignore"):
        parts = _over_f(natural)
    plus, minus, *both = (part.value / mass.value for part in parts)
    value = plus + minus - sum(both)
    error = (sum(part.error for part in parts) + value * mass.error) / mass.value + _ROUNDING * value
    _check_known(density, "C", Integral(value, error), _USELESS)
    return FallingConstant(value, error, plus, minus, mass.value)


def _check_known(density: Density, what: str, found: Integral, most: float) -> None:
    """Raise InputError where an integral of a function of the user's has an error above `most` times its value."""
    if density.function is None or 0.0 <= found.error <= most * found.value < math.inf:
        return
    if not (math.isfinite(found.value) and math.isfinite(found.error)):
        raise InputError(f"density: {what} is beyond doubles; divide it by its largest value")
    raise InputError(
        f"density: {what} would be {found.value:.2g} with an error of {found.error:.2g}: the box is too wide for "
        "it; shrink the box to where it is large"
    )


def weight_on_f(disk: Disk, density: Density, tolerance: float) -> float:
    """C times the integral of the density, at half the cost of C: for shares of C by energy."""
    plus, minus, *both = (part.value for part in _over_f(NaturalDensity(disk, density, tolerance)))
    return plus + minus - sum(both)


def _over_f(natural: NaturalDensity) -> list[Integral]:
    """Integrals over F on face +1, on face -1, and over what lies on both, if anything does."""
    parts = [_over_line(natural, face) for face in (1, -1)]
    if _lines_meet(natural.density.box):
        parts.append(_over_line(natural, 1, both=True))
    return parts


def _lines_meet(box: Box) -> bool:
    """True where l_+ and l_- meet the box in the same states: it fixes a rate at 0, so sigma3_bar = 0 on both."""
    return (0.0, 0.0) in (box.sigma3, box.sigma4)


def _all_on_f(box: Box) -> bool:
    """True for the inverted pendulum, sigma3 = sigma4 = 0: all of the box falls."""
    return box.sigma3 == box.sigma4 == (0.0, 0.0)


def _over_line(natural: NaturalDensity, face: int, both: bool = False) -> Integral:
    """The integral over F on one face, within the density's energies."""

    def below(energy: float) -> Integral:
        return settled(LineIntegral(natural, face, energy, both).integral, natural.tolerance)

    return between_energies(below, natural.energy)


@dataclass(frozen=True)
class LineIntegral:
    """The integral over the line eta = 0 of one face, up to an energy; all is seen as from face +1, eq. (3.2).

    both: only what comes as flat on the other face too, where both lines meet the box at sigma3_bar = 0.
    """

    natural: NaturalDensity
    face: int
    energy: float
    both: bool = False

    def integral(self, panels: int) -> Integral:
        """Integral of f 2 A sqrt(I1 M)/(I3 r(0)) over phi, phidot and sigma3_bar."""
        natural = self.natural
        if not (natural.free("sigma3") or natural.free("sigma4")):
            points = [(x, x) for x in self._crossings()]
            return over_tilts(lambda phi: self._at(phi, panels), points, 1, natural.tolerance, natural.work)
        middle = [well(natural.disk).phi, *(-math.acos(1.0 - spent) for spent in self._kinetic() if spent < 2.0)]
        if self.energy < 1.0:
            middle += [math.acos(self.energy), -math.acos(self.energy)]
        # Between these tilts the line enters and leaves the box: a narrow box is met nowhere else.
        middle += self._crossings()
        given = natural.pieces([self.face * m for m in middle])
        pieces = [(a, b) if self.face > 0 else (-b, -a) for a, b in given]
        at_once = _AT_ONCE if natural.even else 1
        return over_tilts(lambda phi: self._at(phi, panels), pieces, at_once, natural.tolerance, natural.work)

    def _kinetic(self) -> list[float]:
        """Energies of tilting at the ends of the range of phidot."""
        return [0.5 * self.natural.disk.body.M * speed**2 for speed in self.natural.range("phidot")]

    def _rates(self, name: str) -> Range:
        return mirrored(name, self.natural.range(name), self.face)

    def _at(self, phi: Array, panels: int) -> Array:
        """The integral over phidot and sigma3_bar at tilts phi."""
        disk, b, face = self.natural.disk, self.natural.disk.body, self.face
        a, c = self._chart(phi)
        curvature = self._curvature(phi, a, c)
        bar, weight = self._bars(phi, a, c, curvature, panels)
        V = np.cos(phi)[:, None] + curvature[:, None] * bar * bar
        gain = 2.0 / b.M * (V - disk.energy_at_flat(bar))
        least = self._least_speed(phi, bar, V)
        most = np.sqrt(np.maximum(2.0 / b.M * (self.energy - V), 0.0))
        weight = weight * (self.energy >= V) * disk.eta_to_eta_hat(2.0 * math.sqrt(b.I1 * b.M))
        columns = face * phi[:, None], a[:, None] * bar, face * c[:, None] * bar
        total: Array = (weight * self.natural.over_speeds(columns, least, most, gain, panels)).sum(axis=-1)
        return total

    def _curvature(self, phi: Array, a: Array, c: Array) -> Array:
        """On the line V = cos(phi) + curvature sigma3_bar^2, eq. (3.8)."""
        b = self.natural.disk.body
        return 0.5 * (b.I1 * (a / np.cos(phi)) ** 2 + b.J * c * c)

    def _bars(self, phi: Array, a: Array, c: Array, curvature: Array, panels: int) -> tuple[Array, Array]:
        """sigma3_bar on the line within the box (n, nodes), and the weight of its step."""
        natural = self.natural
        if not (natural.free("sigma3") and natural.free("sigma4")):
            return self._only_bar(phi, a, c)
        left = self.energy - np.cos(phi)
        reach = np.sqrt(np.maximum(left, 0.0) / curvature)
        ends = ends_of_bar((a, *self._rates("sigma3"), 0.0), (c, *self._rates("sigma4"), 0.0))
        low = np.maximum(ends[0], -reach)
        high = np.maximum(np.minimum(ends[1], reach), low)
        kinetic = self._kinetic()
        corners = [np.sqrt(np.maximum(left - spent, 0.0) / curvature) for spent in kinetic]
        corners = [corner for corner in corners if np.isfinite(corner).all()]
        corners += self._barrier_ends(phi, [0.0, *kinetic])
        bells = [bell / a for bell in natural.bells("sigma3")]
        bells += [bell / (self.face * c) for bell in natural.bells("sigma4")]
        inner = [sign * corner for corner in corners for sign in (1.0, -1.0)]
        return panels_between([low, np.zeros_like(low), *inner, *bells, high], panels)

    def _chart(self, phi: Array) -> tuple[Array, Array]:
        """sigma3 and sigma4 on the line, by sigma3_bar."""
        chart = line_chart(self.natural.disk, np.cos(phi), np.sin(phi))
        return chart.bar_to_sigma3, chart.bar_to_sigma4

    def _corners(self) -> tuple[Array, Array]:
        """Pairs of rates at corners of the box, and of what Gaussians leave of it."""
        ends = []
        for name in ("sigma3", "sigma4"):
            sign = 1.0 if name == "sigma3" else float(self.face)
            ends.append(sorted({*self._rates(name), *(sign * bell for bell in self.natural.bells(name))}))
        s3, s4 = np.meshgrid(*ends)
        return s3.ravel(), s4.ravel()

    def _crossings(self) -> list[float]:
        """Tilts at which the line passes a corner of the box. eta_hat = c sigma3 - a sigma4 there is 0."""
        from scipy.optimize import brentq

        low, high = sorted(self.face * end for end in self.natural.range("phi"))
        if not low < high:
            return []
        middle, half = 0.5 * (low + high), 0.5 * (high - low)
        phi = middle + half * np.sin(np.linspace(-0.5 * math.pi, 0.5 * math.pi, _SCAN)[1:-1])
        a, c = self._chart(phi)
        crossings: list[float] = []
        for s3, s4 in zip(*self._corners(), strict=True):

            def eta(x: float, s3: float = s3, s4: float = s4) -> float:
                a, c = self._chart(np.array([x]))
                return float(c[0] * s3 - a[0] * s4)

            sign = np.sign(c * s3 - a * s4)
            crossings += [brentq(eta, phi[i], phi[i + 1]) for i in np.flatnonzero(sign[1:] * sign[:-1] < 0.0)]
        return crossings

    def _only_bar(self, phi: Array, a: Array, c: Array) -> tuple[Array, Array]:
        """The one sigma3_bar at which the line meets a box that fixes sigma3 or sigma4, and its weight."""
        free3 = self.natural.free("sigma3")
        if not (free3 or self.natural.free("sigma4")):
            # On the line sigma3 = a bar and sigma4 = c bar; the larger of the two says bar best.
            s3, s4 = self._rates("sigma3")[0], self._rates("sigma4")[0]
            bar = (a * s3 + c * s4) / (a * a + c * c)
            after, before = self._chart(phi + _STEP), self._chart(phi - _STEP)
            slope = ((after[1] - before[1]) * s3 - (after[0] - before[0]) * s4) / (2.0 * _STEP)
            return bar[:, None], (1.0 / abs(slope))[:, None]
        fixed, other, m, n = ("sigma4", "sigma3", c, a) if free3 else ("sigma3", "sigma4", a, c)
        bar = self._rates(fixed)[0] / m
        low, high = self._rates(other)
        # eta_hat changes by |m| as the free coordinate does by 1: the determinant of the chart is -1.
        width = abs(m)
        if self.both:
            there = self._chart(-phi)
            width = np.maximum(width, abs(there[0] if fixed == "sigma3" else there[1]))
        weight = ((n * bar >= low) & (n * bar <= high)) / width
        return bar[:, None], weight[:, None]

    def _barrier(self, phi: Array, bar: Array) -> Array:
        """Height of the barrier between a start beyond the vertical and flat, -inf if none; shapes as given."""
        disk = self.natural.disk
        largest, (angle, height) = well(disk).sigma3_bar, barrier(disk)
        depth = np.sqrt(np.maximum(1.0 - abs(bar) / largest, 0.0))
        blocked = (abs(bar) < largest) & (phi < angle(depth))
        return np.where(blocked, height(depth), -np.inf)

    def _least_speed(self, phi: Array, bar: Array, V: Array) -> Array:
        """|phidot| below which a start beyond the vertical does not pass the barrier on its way to flat."""
        least = np.zeros(bar.shape)
        if self.both:
            # The inverted pendulum reaches both faces if it passes the vertical, V = 1.
            return np.sqrt(2.0 / self.natural.disk.body.M * np.maximum(1.0 - V, 0.0))
        beyond = phi < 0.0
        if beyond.any():
            height = self._barrier(phi[beyond, None], bar[beyond]) - V[beyond]
            least[beyond] = np.sqrt(2.0 / self.natural.disk.body.M * np.maximum(height, 0.0))
        return least

    def _barrier_ends(self, phi: Array, heights: Sequence[float]) -> list[Array]:
        """sigma3_bar > 0 up to which a barrier stands in the way, and where it is a given height above the start.

        Between 0 and the first its height falls; NaN where there is no such point.
        """
        if not (phi < 0.0).any():
            return []
        disk = self.natural.disk
        b, (well_phi, largest) = disk.body, well(disk)
        critical = np.empty(phi.size)
        compiled.falling.critical_X2_batch(np.minimum(phi, -1e-12), disk.natural, critical)
        own = np.sqrt(np.maximum(critical, 0.0)) * b.r0
        most = np.where(phi < 0.0, np.where(phi < well_phi, largest, np.minimum(own, largest)), np.nan)
        a, c = self._chart(phi)
        curvature = self._curvature(phi, a, c)
        beyond = phi < 0.0
        there, bend, given = phi[beyond], curvature[beyond], np.array(heights)[:, None]
        low = np.zeros((len(heights), there.size))
        high = np.broadcast_to(np.nan_to_num(most[beyond]), low.shape)
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            above = self._barrier(there, middle) - np.cos(there) - bend * middle**2 > given
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        ends = np.full((len(heights), phi.size), np.nan)
        ends[:, beyond] = low
        return [most, *ends]

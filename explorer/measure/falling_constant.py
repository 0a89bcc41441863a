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
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError
from explorer.measure.box_integrals import (
    NODES,
    Integral,
    Integrator,
    between_energies,
    ends_of_bar,
    within_energy,
)
from explorer.measure.density import ANY_ENERGY, Density, Function
from explorer.measure.sampling import Box, Range
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import energy_at, energy_at_flat, eta_to_eta_hat
from explorer.phase.falling_set import barrier, critical_X2, well
from explorer.phase.linear_constants import line_chart
from explorer.phase.results import Table
from explorer.phase.roots import changes_of_sign, roots_among
from explorer.phase.states import Array

_ROUNDING = 1e-13  # relative, of a sum of some 10^5 positive terms and of the solutions in it
# Tilts between which a change of the sign of eta is sought: the line may not pass a corner twice within 1e-3 rad.
_SCAN = 4001
_LEAST_MASS = 1e-290  # integrals below lose digits


@dataclass(frozen=True, repr=False)
class FallingConstant(Table):
    """The constant C of P(theta_min < delta) = C delta, per radian of tilt.

    Attributes
    ----------
    value : float
        C. It is infinite where the density does not vanish at flat and the energy has no bound, since
        P(theta_min < delta) is of order delta ln(1/delta) there.
    error : float
        Estimate of its absolute error.
    plus, minus : float
        What each face contributes. If the box fixes sigma3 = 0 or sigma4 = 0, some states come flat on both
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

    def _lines(self) -> list[tuple[str, str]]:
        """The numbers, and what they do not say."""
        where = "for small delta only; ex.probability tells below which it holds"
        return [*super()._lines(), *([("law C delta", where)] if math.isfinite(self.value) else [])]


def falling_constant(
    disk: Disk,
    box: Box | str | Mapping[str, Any] | None = None,
    *,
    energy: str | tuple[float | None, float | None] | None = None,
    gaussian: str | Mapping[str, Range] | None = None,
    density: Function | None = None,
) -> FallingConstant:
    """Compute C of P(theta_min < delta) = C delta for states drawn from a density, by quadrature over F.

    Parameters
    ----------
    disk : Disk
        Needs I3 > 0.
    box : Box, str or mapping, optional
        Ranges of phi (rad), phidot, sigma3 and sigma4 (units of the disk), as for `run`: "phi=-1:1,sigma4=0.3".
        By default phi = 0 and rates within two natural units.
    energy : (float, float) or str, optional
        Only states with an energy in this range (units of the disk); None is no bound.
    gaussian : str or mapping, optional
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
        If an argument cannot be used, if the density is zero everywhere in the box, or if the integral of a
        function overflows, underflows, or has an error above its value.

    Notes
    -----
    C does not say how small delta must be. If states begin nearly flat, P at 1e-3 may exceed C delta a
    thousandfold. `probability` tests this: its `law.holds_below` is the delta below which the law holds.

    A function that is large only in less than a twentieth of the box may be missed: shrink the box to it. For a
    function that jumps or oscillates, the integral stops after some 10^7 points, and `error` includes what is
    missing.

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


def constant_of(disk: Disk, density: Density) -> FallingConstant:
    """As falling_constant, of a Density."""
    if not (density.free("sigma3") or density.free("sigma4")):
        raise InputError(
            "box: sigma3 and sigma4 are both fixed, so the falling set is met at single tilts or not at all; give "
            "one of them a range"
        )
    # What overflows is refused by what comes of it.
    with np.errstate(over="ignore", invalid="ignore"):
        mass = Integrator(disk, density.seen_from(disk, 1)).mass()
    _check_known(density, "its integral", mass)
    if not mass.value > 0.0:
        factor = "energy" if density.energy != ANY_ENERGY else "density"
        raise InputError(f"{factor}: the density is zero in all of the box; widen one of them")
    if mass.value < _LEAST_MASS and density.function is not None:
        raise InputError(
            f"density: its integral is {mass.value:.1e}, too small for doubles; multiply the density by 1e300"
        )
    if density.reaches_flat():
        return FallingConstant(math.inf, math.inf, math.inf, math.inf, mass.value)
    with np.errstate(over="ignore", invalid="ignore"):
        parts = _over_f(disk, density)
    plus, minus, *both = (part.value / mass.value for part in parts)
    value = plus + minus - sum(both)
    error = (sum(part.error for part in parts) + value * mass.error) / mass.value + _ROUNDING * value
    _check_known(density, "C", Integral(value, error))
    return FallingConstant(value, error, plus, minus, mass.value)


def _check_known(density: Density, what: str, found: Integral) -> None:
    """Raise InputError where an integral of a function of the user's has an error above its value."""
    if density.function is None or 0.0 <= found.error <= found.value < math.inf:
        return
    if not (math.isfinite(found.value) and math.isfinite(found.error)):
        raise InputError(f"density: {what} overflows doubles; divide the density by its largest value")
    raise InputError(
        f"density: {what} would be {found.value:.2g} with an error of {found.error:.2g}: the box is too wide for "
        "it; shrink the box to where it is large"
    )


def _over_f(disk: Disk, density: Density) -> list[Integral]:
    """Integrals over F on face +1, on face -1, and over what lies on both, if anything does."""
    box = density.box
    # l_+ and l_- meet the box in the same states where it fixes a rate at 0: sigma3_bar = 0 on both.
    meet = (0.0, 0.0) in (box.ranges["sigma3"], box.ranges["sigma4"])

    def over(face: int, both: bool = False) -> Integral:
        of = Integrator(disk, density.seen_from(disk, face))
        return between_energies(lambda energy: LineIntegral(of, energy, both).integral(), of.density.energy)

    return [over(1), over(-1), over(1, both=True)] if meet else [over(1), over(-1)]


@dataclass(frozen=True)
class LineIntegral:
    """The integral over the line eta = 0 of the face that sees the density so, up to an energy.

    both: only what comes as flat on the other face too, where both lines meet the box at sigma3_bar = 0.
    """

    of: Integrator
    energy: float
    both: bool = False

    def integral(self) -> Integral:
        """Integral of f 2 A sqrt(I1 M)/(I3 r(0)) over phi, phidot and sigma3_bar."""
        # Between the crossings the line enters and leaves the box: a narrow box is met nowhere else.
        barriers = (-math.acos(1.0 - spent) for spent in self._spent if spent < 2.0)
        pieces = self.of.pieces(self.energy, well(self.of.disk).phi, *barriers, *self._crossings())
        return self.of.over_tilts(self._at, pieces)

    @property
    def _spent(self) -> list[float]:
        """Energies of tilting at the ends of the range of phidot."""
        return [0.5 * self.of.disk.body.M * speed**2 for speed in self.of.density.reach("phidot")]

    def _chart(self, phi: Array) -> tuple[Array, Array]:
        """sigma3 and sigma4 on the line, by sigma3_bar."""
        chart = line_chart(self.of.disk, np.cos(phi), np.sin(phi))
        return chart.bar_to_sigma3, chart.bar_to_sigma4

    def _at(self, phi: Array) -> Array:
        """The integral over phidot and sigma3_bar at tilts phi, by the rules of NODES: (2, n)."""
        disk, b = self.of.disk, self.of.disk.body
        a, c = self._chart(phi)
        # On the line V = cos(phi) + curvature sigma3_bar^2, eq. (3.8).
        curvature = energy_at(b, 0.0, a / np.cos(phi), c, 0.0)
        found = []
        for nodes, (bar, weight) in zip(NODES, self._bars(phi, a, c, curvature), strict=True):
            V = np.cos(phi)[:, None] + curvature[:, None] * bar * bar
            gain = 2.0 / b.M * (V - energy_at_flat(disk.body, bar))
            # A start that is slower does not pass the barrier on its way to flat. Upright at rest (V = 1) that is
            # in the way of the inverted pendulum, which reaches both faces if it passes.
            height = np.ones(bar.shape) if self.both else self._barrier(phi[:, None], bar)
            least, most = (np.sqrt(2.0 / b.M * np.maximum(E - V, 0.0)) for E in (height, self.energy))
            columns = phi[:, None], a[:, None] * bar, c[:, None] * bar
            speeds = self.of.over_speeds(columns, least, most, gain, nodes)
            found.append((weight * (self.energy >= V) * speeds).sum(axis=-1))
        return np.array(found) * eta_to_eta_hat(disk.body, 2.0 * math.sqrt(b.I1 * b.M))

    def _bars(self, phi: Array, a: Array, c: Array, curvature: Array) -> list[tuple[Array, Array]]:
        """sigma3_bar on the line within the box (n, nodes), and the weight of its step, by the rules of NODES."""
        density = self.of.density
        if not (density.free("sigma3") and density.free("sigma4")):
            return [self._only_bar(phi, a, c)] * 2
        ends = ends_of_bar((a, *density.reach("sigma3")), (c, *density.reach("sigma4")))
        barriers = self._barrier_ends(phi, curvature)
        means = [mean / m for name, m in (("sigma3", a), ("sigma4", c)) for mean in density.means(name)]
        inner = [np.zeros_like(a), *barriers, *(-end for end in barriers), *means]
        left = self.energy - np.cos(phi)
        return [within_energy(ends, left, curvature, self._spent, inner, nodes) for nodes in NODES]

    def _crossings(self) -> list[float]:
        """Tilts at which the line passes a corner of the box. eta_hat = c sigma3 - a sigma4 there is 0."""

        def eta(phi: Array, s3: float, s4: float) -> Array:
            a, c = self._chart(phi.ravel())
            return (c * s3 - a * s4).reshape(phi.shape)

        density = self.of.density
        low, high = density.reach("phi")
        scan = np.sin(np.linspace(-0.5 * math.pi, 0.5 * math.pi, _SCAN)[1:-1])
        phi = 0.5 * (low + high) + 0.5 * (high - low) * scan
        found: list[float] = []
        for s3, s4 in product(*({*density.reach(name), *density.means(name)} for name in ("sigma3", "sigma4"))):
            found += roots_among(partial(eta, s3=s3, s4=s4), phi).tolist()
        return found

    def _only_bar(self, phi: Array, a: Array, c: Array) -> tuple[Array, Array]:
        """The one sigma3_bar at which the line meets a box that fixes sigma3 or sigma4, and its weight."""
        density = self.of.density
        free3 = density.free("sigma3")
        fixed, other, m, n = ("sigma4", "sigma3", c, a) if free3 else ("sigma3", "sigma4", a, c)
        bar = density.reach(fixed)[0] / m
        low, high = density.reach(other)
        # eta_hat changes by |m| as the free coordinate does by 1: the determinant of the chart is -1.
        width = abs(m)
        if self.both:
            width = np.maximum(width, abs(self._chart(-phi)[free3]))
        weight = ((n * bar >= low) & (n * bar <= high)) / width
        return bar[:, None], weight[:, None]

    def _barrier(self, phi: Array, bar: Array) -> Array:
        """Height of the barrier between a start beyond the vertical and flat, -inf if none; shapes as given."""
        disk = self.of.disk
        there = (abs(bar) < well(disk).sigma3_bar) & (np.sin(phi) < barrier(disk, bar, "sine"))
        return np.where(there, barrier(disk, bar), -np.inf)

    def _barrier_ends(self, phi: Array, curvature: Array) -> list[Array]:
        """sigma3_bar > 0 up to which a barrier stands in the way, and where it is a given height above the start.

        Between 0 and the first its height falls. phi: all on one side of the vertical.
        """
        if not (phi < 0.0).all():
            return []
        disk = self.of.disk
        bend, largest = well(disk)
        own = np.sqrt(np.maximum(critical_X2(disk, np.minimum(phi, -1e-12)), 0.0)) * disk.body.r0
        most = np.where(phi < bend, largest, np.minimum(own, largest))
        spent = np.array([0.0, *self._spent])[:, None]

        def above(bar: Array) -> Array:
            excess: Array = barrier(disk, bar) - np.cos(phi) - curvature * bar * bar - spent
            return excess

        shape = spent.size, phi.size
        return [most, *changes_of_sign(above, np.zeros(shape), np.broadcast_to(most, shape))]

"""The amended potential at given constants of motion, and the levels of the energy that it makes.

With sigma3_bar and eta held, the tilt moves like a point of mass M in V(phi; sigma3_bar, eta):
E = M phidot^2/2 + V, eq. (3.8). Off the lines l_+- V grows beyond all bounds at both flat states: a wall. On
l_+- it ends at V_0 on that face, eq. (6.9), and the disk falls. All roots are sought in y = artanh(sin phi),
the logarithm of the tilt near flat, so that a wall at eta_hat = 1e-100 is as far away as any other.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import InputError, number, said, shown, sign
from explorer.phase.arguments import column, read_range
from explorer.phase.disk import LARGEST_RATE, Disk, require_axial_inertia
from explorer.phase.energy import energy_at, energy_at_flat, eta_hat_to_eta
from explorer.phase.linear_constants import line_chart, line_slope, nearer_plus, other_eta_hat
from explorer.phase.results import in_shape
from explorer.phase.roots import changes_of_sign, roots_among
from explorer.phase.states import Array

_STEP = 0.02  # of y, in which V is smooth on the scale 1: no two zeros of V'' share a step
_EPS = float(np.finfo(float).eps)
_FLAT = 1e-8  # tilt (rad), at rates of order 1, below which V' keeps its sign where V ends at V_0
_WALL = 1e-3  # the same beside a line, as a share of the tilt at which the wall is as steep as all else
_SMALLEST = 1e-290  # rad; doubles of cosh y end soon after
_FARTHEST = 700.0  # in size, of y: there they do
_POINTS = 400  # of a curve, and some more where it runs to flat
_TOLD_APART = 1e-10  # of an energy: levels as far apart differ by many roundings, also at the fastest rates
CENTRE, SADDLE, DEGENERATE = "centre", "saddle", "degenerate"
TURNING, FLAT = "turning point", "flat"


@dataclass(frozen=True)
class Equilibrium:
    """A steady motion: phi and theta, its tilt from the nearer flat state (rad); V and its second derivative.

    kind: centre (stable, V'' > 0), saddle (unstable, V'' < 0) or degenerate (V'' = 0 to rounding).
    """

    phi: float
    theta: float
    energy: float
    curvature: float
    kind: str
    y: float


@dataclass(frozen=True)
class Component:
    """One piece low <= phi <= high of {V <= energy} (rad).

    ends: a turning point, a saddle, or flat, at the left and at the right. y: these in artanh(sin phi).
    falls: it reaches a flat state.
    """

    energy: float
    low: float
    high: float
    ends: tuple[str, str]
    y: tuple[float, float]

    @property
    def falls(self) -> bool:
        return FLAT in self.ends


@dataclass(frozen=True)
class Separatrix:
    """The level through a saddle, to its left and to its right; motions along it take for ever."""

    saddle: Equilibrium
    branches: tuple[Component, Component]


def curvature_of(q: Array, z: Array, sigma3: Array, sigma4: Array, b: Any) -> Array:
    """d2V/dphi2 at held constants where cos phi = q, sin phi = z; natural units.

    From dsigma3/dphi = -(I3/I1) cos phi sigma4 and dsigma4/dphi = -(m r^2/J) sigma3/cos phi, eqs (2.17), (2.18).
    """
    rho = sigma3 / q
    steep = rho * z / q
    curvature: Array = (
        b.M * rho * rho
        + 3.0 * b.I1 * steep * steep
        - (2.0 * b.I3 + b.J) * steep * sigma4
        + b.J * b.k * sigma4 * sigma4
        - q
    )
    return curvature


class Terms(NamedTuple):
    """V, dV/dphi, d2V/dphi2, the size of the terms that dV/dphi is a sum of, and sigma3/q; natural units."""

    V: Array
    slope: Array
    curvature: Array
    size: Array
    rho: Array


@dataclass(frozen=True, repr=False)
class Potential:
    """The amended potential V(phi; sigma3_bar, eta), as `explorer.potential` makes it.

    Its methods V, dV and d2V take phi (rad); `equilibria`, `components` and `separatrices` describe its motions.

    Attributes
    ----------
    disk : Disk
        The body.
    bar, hat : float
        sigma3_bar and eta_hat in natural units.
    face : int
        +1, or -1 for the mirror image, eq. (3.2).

    Examples
    --------
    >>> import explorer as ex
    >>> falling = ex.potential(ex.Disk.uniform(), 0.25)
    >>> [piece.falls for piece in falling.components(1.0)], round(float(falling.V(0.0)), 4)
    ([False, True], 1.0327)
    >>> falling
    Potential of the disk uniform: sigma3_bar = 0.25, eta_hat = 0 from the line of face 1
    """

    disk: Disk
    bar: float
    hat: float
    face: int = 1

    def __repr__(self) -> str:
        constants = f"sigma3_bar = {self.sigma3_bar:g}, eta_hat = {self.eta_hat:g}"
        return f"Potential of the disk {self.disk.name}: {constants} from the line of face {self.face}"

    @property
    def sigma3_bar(self) -> float:
        return self.bar * self.disk.rate_unit

    @property
    def eta_hat(self) -> float:
        """Signed distance to the line of `face`, eq. (6.2)."""
        return self.hat * self.disk.rate_unit

    @property
    def sigma4_bar(self) -> float:
        return self.face * (line_slope(self.disk) * self.bar - self.hat) * self.disk.rate_unit

    def hats(self) -> dict[int, float]:
        """eta_hat on each face, natural units."""
        return {self.face: self.hat, -self.face: other_eta_hat(self.disk, self.bar, self.hat)}

    def terms(self, q: Array, z: Array) -> Terms:
        """V and its derivatives where cos phi = q, sin phi = z."""
        b = self.disk.body
        with np.errstate(over="ignore", invalid="ignore"):
            chart = line_chart(self.disk, q, self.face * z)
            s3, s4 = chart.rates(self.bar, self.hat)
            s4 = self.face * s4
            rho = s3 / q
            V = energy_at(b, 0.0, rho, s4, q)
            slope = b.I1 * rho * (rho / q) * z - b.J * rho * s4 - z
            curvature = curvature_of(q, z, s3, s4, b)
            # What rounds: sigma3 and sigma4 are sums, and at the vertical D is a difference of terms of order 1
            most3 = abs(chart.bar_to_sigma3 * self.bar)
            most3 += np.maximum(abs(chart.eta_hat_to_sigma3), b.k * b.r0) * abs(self.hat)
            most4 = abs(chart.bar_to_sigma4 * self.bar) + abs(chart.eta_hat_to_sigma4 * self.hat)
            size = most3 / q * (b.I1 * most3 / q * abs(z) / q + b.J * most4) + abs(z)
        return Terms(V, slope, curvature, size, rho)

    def _of_phi(self, phi: ArrayLike, term: str, unit: float) -> Array:
        angle = column("phi", phi)
        if not np.all(abs(angle) < 0.5 * np.pi):
            raise InputError("phi: V is defined between the flat states; give -pi/2 < phi < pi/2 (rad)")
        values: Array = getattr(self.terms(np.cos(angle.ravel()), np.sin(angle.ravel())), term)
        return in_shape(values * unit, angle.shape)

    def V(self, phi: ArrayLike) -> Array:
        """The amended potential, eq. (3.8), at phi (rad)."""
        return self._of_phi(phi, "V", self.disk.energy_unit)

    def dV(self, phi: ArrayLike) -> Array:
        """dV/dphi."""
        return self._of_phi(phi, "slope", self.disk.energy_unit)

    def d2V(self, phi: ArrayLike) -> Array:
        """d2V/dphi2; its sign at an equilibrium decides stability."""
        return self._of_phi(phi, "curvature", self.disk.energy_unit)

    def rho(self, phi: ArrayLike) -> Array:
        """sigma3/cos phi at phi (rad), units of the disk: cos phi times the rate of chi, so finite near flat."""
        return self._of_phi(phi, "rho", self.disk.rate_unit)

    def at_y(self, y: ArrayLike) -> Terms:
        """As `terms`, as flat arrays, at the phi with sin phi = tanh y."""
        places = np.ravel(column("y", y))
        if np.any(abs(places) > _FARTHEST):
            raise InputError(f"y = {shown(y)}: sin phi = tanh y is flat there; give up to {_FARTHEST:g} in size")
        return self.terms(1.0 / np.cosh(places), np.tanh(places))

    def at_flat(self, face: int) -> float:
        """V at a flat state: V_0 on its line, eq. (6.9); infinite off it."""
        return self._at_flat(face) * self.disk.energy_unit

    def _at_flat(self, face: int) -> float:
        """V at a flat state, natural units."""
        if self.hats()[sign("face", face)] != 0.0:
            return math.inf
        return energy_at_flat(self.disk.body, self.bar)

    def outermost(self, face: int) -> float:
        """|y| beyond which V' keeps its sign towards flat; sin phi = tanh y."""
        b, hat = self.disk.body, abs(self.hats()[sign("face", face)])
        eta, spin = eta_hat_to_eta(self.disk.body, hat), abs(self.bar) / (b.k * b.r0) + b.r0 * hat
        if hat == 0.0:
            tilt = _FLAT / (1.0 + abs(self.bar) + abs(self.hat)) ** 2
        else:  # V' is eta^2/(I1 tilt^3), and besides up to J eta spin/tilt and 1; spin: sigma4 there
            tilt = _WALL * min(math.sqrt(eta / (b.J * spin)), (eta / math.sqrt(b.I1)) ** (2.0 / 3.0))
        return math.log(2.0 / max(tilt, _SMALLEST))

    @cached_property
    def equilibria(self) -> tuple[Equilibrium, ...]:
        """All steady motions at these constants, from phi = -pi/2 to pi/2: every root of V'."""
        left, right = (math.ceil(self.outermost(face) / _STEP) for face in (-1, 1))
        y = _STEP * np.arange(-left, right + 1, dtype=np.float64)
        bends = roots_among(self._term("curvature"), y)
        # Between zeros of V'' the slope is monotonic: a pair of close roots cannot hide between points.
        y = np.union1d(y, bends)
        _, slope, _, size, _ = self.at_y(y)
        touches = np.isin(y, bends) & (abs(slope) <= 2.0 * _EPS * size)
        roots = np.union1d(roots_among(self._term("slope"), y), y[(slope == 0.0) | touches])
        apart: list[Equilibrium] = []
        for equilibrium in map(self._equilibrium, roots.tolist()):
            if not apart or equilibrium.y - apart[-1].y > 4.0 * _EPS * max(1.0, abs(equilibrium.y)):
                apart.append(equilibrium)
        return tuple(apart)

    def _term(self, name: str, value: float = 0.0) -> Callable[[Array], Array]:
        """A term, less a value, as a function of y."""
        return lambda y: getattr(self.at_y(y), name).reshape(y.shape) - value

    def _equilibrium(self, y: float) -> Equilibrium:
        V, _, curved, size, _ = (float(values[0]) for values in self.at_y(y))
        sharp = 1e-13 * (size + 1.0)  # V'' below this is lost in the rounding of its terms
        kind = DEGENERATE if abs(curved) <= sharp else CENTRE if curved > 0.0 else SADDLE
        unit = self.disk.energy_unit
        return Equilibrium(_phi(y), 2.0 * math.atan(math.exp(-abs(y))), V * unit, curved * unit, kind, y)

    @cached_property
    def _stops(self) -> tuple[Array, Array]:
        """Ends and equilibria in y, and V there: between two of them V is monotonic."""
        inner = [at.y for at in self.equilibria]
        y = np.array([-self.outermost(-1), *inner, self.outermost(1)])
        V = self.at_y(y).V
        V[[0, -1]] = self._at_flat(-1), self._at_flat(1)
        return y, V

    @property
    def bottom(self) -> float:
        """The least V, or the value that it falls to at flat."""
        return float(self._stops[1].min()) * self.disk.energy_unit

    def components(self, energy: float) -> tuple[Component, ...]:
        """The pieces of {V < energy}, from left to right; energy in the units of the disk."""
        energy = number("energy", energy)
        E = energy / self.disk.energy_unit
        y, V = self._stops
        saddle = np.array([False, *(at.kind == SADDLE for at in self.equilibria), False])
        touched = saddle & (abs(V - E) <= 32.0 * _EPS * abs(E))  # some roundings of V at two saddles
        inside = (V < E) & ~touched
        cuts: list[tuple[float, str]] = [(float(y[0]), FLAT)] if inside[0] else []
        for i in np.flatnonzero(inside[1:] != inside[:-1]).tolist():
            above = i + 1 if inside[i] else i
            cuts.append((float(y[above]), SADDLE) if touched[above] else (self._crossing(E, i), TURNING))
        if inside[-1]:
            cuts.append((float(y[-1]), FLAT))
        return tuple(
            Component(energy, _phi(*low), _phi(*high), (low[1], high[1]), (low[0], high[0]))
            for low, high in zip(cuts[::2], cuts[1::2], strict=True)
        )

    def separatrices(self) -> tuple[Separatrix, ...]:
        """The level through each saddle, on both sides of it."""
        found = []
        for at in self.equilibria:
            if at.kind == SADDLE:
                left, right = (piece for piece in self.components(at.energy) if at.y in piece.y)
                found.append(Separatrix(at, (left, right)))
        return tuple(found)

    def _crossing(self, E: float, i: int) -> float:
        """The root of V = E between two stops."""
        y, V = self._stops
        low, high = float(y[i]), float(y[i + 1])
        # Stops at a wall stand where V is finite: further out for large energies
        while i == 0 and V[0] == math.inf and self.at_y(low).V[0] < E:
            low -= 1.0
        while i == y.size - 2 and V[-1] == math.inf and self.at_y(high).V[0] < E:
            high += 1.0
        return float(changes_of_sign(self._term("V", E), np.array([low]), np.array([high]))[0])

    def curve(self, component: Component) -> tuple[Array, Array]:
        """phi (rad) and phidot >= 0 (units of the disk) along a piece of a level; its other half has -phidot."""
        low, high = component.y
        # Dense towards both ends, where phidot vanishes like a square root
        angle = np.linspace(0.0, np.pi, _POINTS + int(2.0 * (high - low)))
        y = low + (high - low) * 0.5 * (1.0 - np.cos(angle))
        y[-1] = high
        phi, E = np.arctan(np.sinh(y)), component.energy / self.disk.energy_unit
        excess = E - self.at_y(y).V
        for at, end, edge in zip((0, -1), component.ends, (component.low, component.high), strict=True):
            phi[at] = edge
            excess[at] = E - self._at_flat(1 if at else -1) if end == FLAT else 0.0
        return phi, np.sqrt(np.maximum(2.0 * excess / self.disk.body.M, 0.0)) * self.disk.rate_unit

    def levels(self, energies: tuple[float, float] | None = None, count: int = 9) -> Array:
        """Energies of level curves (units of the disk), from the bottom of V to above all saddles unless given.

        Raises InputError where the range is empty or no motion has an energy in it.
        """
        bottom, unit = self.bottom, self.disk.energy_unit
        if energies is None:
            tops = [at.energy for at in self.equilibria] + [float(self.V(0.0))]
            low, high = bottom, max(tops) + 0.5 * max(unit, _TOLD_APART * abs(max(tops)))
        else:
            low, high = read_range("energies", energies)
            if low == high:
                raise InputError(f"energies {low:g}:{high:g} are an empty range; give LOW:HIGH, the smaller first")
            if not high > bottom:
                raise InputError(
                    f"energies {low:g}:{high:g}: with eta_hat = {self.eta_hat:g} no motion has an energy below "
                    f"{bottom:.6g}; give a HIGH above that"
                )
        # The bottom itself is no curve; a range that begins above it keeps its lower end
        return np.linspace(low, high, count) if low > bottom else np.linspace(bottom, high, count + 1)[1:]

    def falling_edge(self, y: Array) -> Array:
        """The least |phidot| with which the disk falls from sin phi = tanh y; infinite where nothing falls.

        Every motion tilts both ways sooner or later, so it is enough that one flat state is within reach.
        """
        every = np.union1d(y, self._stops[0][1:-1])
        V = self.at_y(every).V
        # The highest V on the way to the left, and to the right.
        left = np.maximum(np.maximum.accumulate(V), self._at_flat(-1))
        right = np.maximum(np.maximum.accumulate(V[::-1])[::-1], self._at_flat(1))
        edge = np.sqrt(2.0 / self.disk.body.M * (np.minimum(left, right) - V)) * self.disk.rate_unit
        return np.asarray(edge[np.searchsorted(every, y)])


def potential(
    disk: Disk, sigma3_bar: float, eta_hat: float | None = None, face: int = 1, sigma4_bar: float | None = None
) -> Potential:
    """The amended potential V of the tilt at given constants of motion.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar : float
        Constant of motion, units of the disk.
    eta_hat : float, optional
        Signed distance to the line of `face`, on which the disk falls, units of the disk; by default 0, on the
        line.
    face : int
        +1 for the line l₊, -1 for l₋.
    sigma4_bar : float, optional
        The other constant of motion, instead of eta_hat and face; a value within rounding of a line counts as on
        it.

    Returns
    -------
    Potential

    Raises
    ------
    InputError
        For numbers beyond 1e75, for eta_hat and sigma4_bar together, and for a disk with I3 = 0.

    References
    ----------
    Eqs (3.5), (3.8) and (6.2) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> beside = ex.potential(ex.Disk.uniform(), sigma3_bar=0.25, eta_hat=0.01)
    >>> [at.kind for at in beside.equilibria]
    ['centre', 'saddle', 'centre']
    >>> upright = ex.potential(ex.Disk.uniform(), sigma3_bar=2.0, sigma4_bar=0.0)
    >>> [(at.kind, round(at.phi, 6)) for at in upright.equilibria]
    [('centre', 0.0)]
    """
    require_axial_inertia(disk)
    bar = _constant("sigma3_bar", sigma3_bar) / disk.rate_unit
    if sigma4_bar is None:
        hat = 0.0 if eta_hat is None else _constant("eta_hat", eta_hat) / disk.rate_unit
        return Potential(disk, bar, hat, sign("face", face))
    if eta_hat is not None:
        raise InputError(f"{said('eta_hat', eta_hat)}, sigma4_bar: set the same quantity; leave one out")
    spin, slope = _constant("sigma4_bar", sigma4_bar) / disk.rate_unit, line_slope(disk)
    nearer = 1 if nearer_plus(np.array(slope * bar - spin), np.array(slope * bar + spin)) else -1
    hat = slope * bar - nearer * spin
    return Potential(disk, bar, 0.0 if abs(hat) <= 4.0 * _EPS * abs(spin) else hat, nearer)


def _constant(name: str, value: float) -> float:
    return number(name, value, -LARGEST_RATE, LARGEST_RATE)


def _phi(y: float, end: str = TURNING) -> float:
    return math.copysign(0.5 * math.pi, y) if end == FLAT else math.atan(math.sinh(y))

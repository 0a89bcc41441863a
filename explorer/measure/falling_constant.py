"""The constant C of P(theta_min < delta) = C delta (1 + o(1)), by scrambled Sobol points on F.

    C = sum over faces of  integral of f 2 A sqrt(I1 M) delta(eta) 1_F dphi dphidot dsigma3 dsigma4 / mass

With dsigma3 dsigma4 = dsigma3_bar deta_hat at every tilt the delta function leaves an integral over
(phi, phidot, sigma3_bar) on the line eta = 0, where sigma3 = a sigma3_bar and sigma4 = c sigma3_bar. The unit
cube is mapped onto what the box, the energy and the barrier leave of it, and the integral is the mean over points
of the cube. Scrambles are independent, so their means tell the error. The mass is such an integral over the box.

Where a density does not vanish at flat, states near one flat state with sigma3 of order one have energies
like 1/theta^2, and come that much nearer to the other one: P is of order delta ln(1/delta) then, and there is
no C. A bound on the energy mends it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer.errors import InputError
from explorer.measure.density import ANY_ENERGY, Density, Function, between
from explorer.measure.sampling import Box, Range, numbered_stream
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import energy_at, energy_at_flat, eta_to_eta_hat
from explorer.phase.falling_set import barrier, well
from explorer.phase.linear_constants import line_chart
from explorer.phase.results import Table
from explorer.phase.roots import roots_among
from explorer.phase.states import Array

# Independent scrambles, and points of each. Two standard errors from so many scrambles cover 93.6 %.
_SCRAMBLES, _POINTS = 16, 1 << 16
# Without it SciPy has points of 30 bits, which shift C by more than its error.
_BITS = 60
_ROUNDING = 1e-13  # relative, of a sum of some 10^5 positive terms
# Tilts between which a change of the sign of eta is sought: the line may not pass a corner twice within 1e-3 rad.
_SCAN = 4001
_LEAST_MASS = 1e-290  # integrals below lose digits
_SURE = 0.1  # relative error of the mass, above which so few points decide that it is no longer to be trusted
_RATES = "sigma3", "sigma4"
Columns = dict[str, Array]


@dataclass(frozen=True, repr=False)
class FallingConstant(Table):
    """The constant C of P(theta_min < delta) = C delta, per radian of tilt.

    Attributes
    ----------
    value : float
        C. It is infinite where the density does not vanish at flat and the energy has no bound, since
        P(theta_min < delta) is of order delta ln(1/delta) there.
    error : float
        Its standard error, absolute.
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
    """Compute C of P(theta_min < delta) = C delta for states drawn from a density, by an integral over F.

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
        function overflows, underflows, or has a standard error above a tenth of its value.

    Notes
    -----
    C does not say how small delta must be. If states begin nearly flat, P at 1e-3 may exceed C delta a
    thousandfold. `probability` tests this: its `law.holds_below` is the delta below which the law holds.

    The integrals are means over 2^20 points of a scrambled Sobol sequence, the same in every call. `error` comes
    from its 16 scrambles: in 93 cases of 100, C is within two errors. For boxes and Gaussians the error is mostly
    below 1e-6 of C, for ranges of energy below 1e-3. It is larger for a function that is large only in a small
    part of the box: shrink the box to this part.

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


def constant_of(disk: Disk, density: Density, seed: int = 0) -> FallingConstant:
    """C of a Density; see `falling_constant`. seed: of the scrambles."""
    if not (density.free("sigma3") or density.free("sigma4")):
        raise InputError(
            "box: sigma3 and sigma4 are both fixed, so the falling set is met at single tilts or not at all; give "
            "one of them a range"
        )
    face, other = (_Integrand(disk, density.seen_from(disk, side)) for side in (1, -1))
    parts = [] if density.reaches_flat() else [face.on_line, other.on_line]
    # l_+ and l_- meet the box in the same states where it fixes a rate at 0: sigma3_bar = 0 on both.
    if parts and (0.0, 0.0) in (density.box.ranges["sigma3"], density.box.ranges["sigma4"]):
        parts.append(partial(face.on_line, both=True))
    # What overflows is refused by what comes of it.
    with np.errstate(over="ignore", invalid="ignore"):
        masses, *over_f = _means([face.in_box, *parts], density, seed)
        mass = float(masses.mean())
        _check_mass(density, mass, masses)
        if not parts:
            return FallingConstant(math.inf, math.inf, math.inf, math.inf, mass)
        plus, minus, *both = (part / mass for part in over_f)
        total = plus + minus - sum(both)
        value = float(total.mean())
        # Of a quotient of means, of which the lower one has an error too.
        error = _standard_error(total - value * (masses / mass)) + _ROUNDING * value
    if not math.isfinite(error):
        raise InputError("density: C overflows doubles; divide the density by its largest value")
    return FallingConstant(value, error, float(plus.mean()), float(minus.mean()), mass)


def mass_of(disk: Disk, density: Density) -> float:
    """The integral of a density over its box, natural units."""
    seen = _Integrand(disk, density.seen_from(disk, 1))
    return seen.product if seen.product is not None else float(_means([seen.in_box], density, 0).mean())


def _check_mass(density: Density, mass: float, masses: Array) -> None:
    """Raise InputError where the integral of a density is zero or not known. masses: by scramble."""
    tiny = density.function is not None and mass < _LEAST_MASS
    for wrong, why in (
        (not math.isfinite(mass), "its integral overflows doubles; divide the density by its largest value"),
        (not mass > 0.0, "the density is zero in all of the box; widen one of them"),
        (tiny, f"its integral is {mass:.1e}, too small for doubles; multiply the density by 1e300"),
        (_standard_error(masses) > _SURE * mass, "few points see it; shrink the box to where it is large"),
    ):
        if wrong:
            raise InputError(f"{'density' if density.energy == ANY_ENERGY else 'energy'}: {why}")


def _standard_error(values: Array) -> float:
    """The standard error of the mean of independent values."""
    return float(values.std(ddof=1)) / math.sqrt(values.size)


def _means(functions: Sequence[Callable[[Columns], Array]], density: Density, seed: int) -> Array:
    """Means of functions of points of the unit cube (functions, scrambles): of the same points for all."""
    free, found = density.box.free, []
    for scramble in range(_SCRAMBLES):
        sobol = scipy.stats.qmc.Sobol(len(free), bits=_BITS, rng=numbered_stream(seed, scramble))
        cube = dict(zip(free, sobol.random(_POINTS).T, strict=True))
        found.append([function(cube).mean() for function in functions])
    return np.array(found).T


@dataclass(frozen=True)
class _Integrand:
    """The density in natural units as a face sees it, at points of the unit cube: columns (n) by coordinate.

    Each free coordinate of the box has its own. A range depends on the coordinates before it, so that there are no
    points outside of the box and the energies.
    """

    disk: Disk
    density: Density

    @property
    def product(self) -> float | None:
        """The integral of the density, if it is that of its coordinates' own factors alone."""
        density = self.density
        alone = density.function is None and density.energy == ANY_ENERGY
        return math.prod(density.factor_mass(name) for name in density.box.free) if alone else None

    def in_box(self, cube: Columns) -> Array:
        """The density times the volume of a point."""
        if self.product is not None:
            return np.array([self.product])
        b, density = self.disk.body, self.density
        phi, volume = self._tilts(cube)
        q = np.cos(phi)
        most = np.sqrt(2.0 / b.J * np.maximum(density.energy[1] - q, 0.0))
        sigma4, step4 = self._within("sigma4", cube, -most, most)
        V = energy_at(b, 0.0, 0.0, sigma4, q)
        most = np.sqrt(2.0 / b.I1 * np.maximum(density.energy[1] - V, 0.0)) * q
        sigma3, step3 = self._within("sigma3", cube, -most, most)
        V = energy_at(b, 0.0, sigma3 / q, sigma4, q)
        volume = volume * step4 * step3
        halves = self._speeds(cube, V, density.energy[0])
        return sum((self._at(phi, speed, sigma3, sigma4, volume * step) for speed, step in halves), np.zeros(1))

    def on_line(self, cube: Columns, both: bool = False) -> Array:
        """The density times 2 A sqrt(I1 M)/(I3 r(0)) times the volume of a point of (phi, phidot, sigma3_bar).

        both: only what comes as flat on the other face too, where both lines meet the box at sigma3_bar = 0.
        """
        b, phi, volume = self.disk.body, *self._tilts(cube)
        q, (a, c) = np.cos(phi), self._chart(phi)
        # On the line V = cos(phi) + curvature sigma3_bar^2, eq. (3.8).
        curvature = energy_at(b, 0.0, a / q, c, 0.0)
        most = np.sqrt(np.maximum(self.density.energy[1] - q, 0.0) / curvature)
        bar, step = self._bars(cube, dict(zip(_RATES, (a, c), strict=True)), most)
        if both:
            step = np.minimum(step, self._bars(cube, dict(zip(_RATES, self._chart(-phi), strict=True)), most)[1])
        V = q + curvature * bar * bar
        # A start that is slower does not pass the barrier on its way to flat. Upright at rest (V = 1) that is
        # in the way of the inverted pendulum, which reaches both faces if it passes.
        height = 1.0 if both else self._barrier(phi, bar)
        gain = 2.0 / b.M * (V - energy_at_flat(b, bar))
        volume = volume * step * eta_to_eta_hat(b, 2.0 * math.sqrt(b.I1 * b.M))
        found = np.zeros(1)
        for speed, step in self._speeds(cube, V, np.maximum(height, self.density.energy[0])):
            A = np.sqrt(np.maximum(speed * speed + gain, 0.0))
            found = found + self._at(phi, speed, a * bar, c * bar, volume * step * A)
        return found

    def _at(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array, weight: Array) -> Array:
        """The density times a weight; it is not asked where this is zero."""
        *columns, weight = np.broadcast_arrays(phi, phidot, sigma3, sigma4, weight)
        rows, found = np.flatnonzero(weight), np.zeros(weight.shape)
        # What comes from sigma3_bar may lie outside of the box by rounding.
        ends = self.density.box.ranges.values()
        inside = [np.clip(column[rows], *pair) for column, pair in zip(columns, ends, strict=True)]
        found[rows] = weight[rows] * self.density.shape(*inside)
        return found

    def _within(self, name: str, cube: Columns, least: Array, most: Array) -> tuple[Array, Array]:
        """A coordinate between two bounds, and the length that belongs to a point; of a fixed one this is 1."""
        low, high = self.density.reach(name)
        if not self.density.free(name):
            return np.array([low]), ((least <= low) & (low <= most)).astype(float)
        return between(np.maximum(low, least), np.minimum(high, most), cube[name], self.density.bell(name))

    def _tilts(self, cube: Columns) -> tuple[Array, Array]:
        """phi, and the length that belongs to a point."""
        if not self.density.free("phi"):
            return np.array(self.density.reach("phi")[:1]), np.ones(1)
        count = self._pieces.size - 1
        place = cube["phi"] * count
        piece = np.minimum(place.astype(np.intp), count - 1)
        ends = self._pieces[piece], self._pieces[piece + 1]
        phi, step = between(*ends, place - piece, self.density.bell("phi"))
        return phi, step * count

    def _speeds(self, cube: Columns, V: Array, least: Any) -> list[tuple[Array, Array]]:
        """phidot of both signs between two energies, the higher one that of the density; lengths of points."""
        slow = np.sqrt(2.0 / self.disk.body.M * np.maximum(least - V, 0.0))
        left = self.density.energy[1] - V
        fast = np.where(left < 0.0, -1.0, np.sqrt(2.0 / self.disk.body.M * np.maximum(left, 0.0)))
        halves = [self._within("phidot", cube, slow, fast), self._within("phidot", cube, -fast, -slow)]
        rest = self.density.reach("phidot") == (0.0, 0.0)  # which is in both
        return halves[:1] if rest else halves

    def _bars(self, cube: Columns, along: Columns, most: Array) -> tuple[Array, Array]:
        """sigma3_bar up to `most` on the line within the box, and the length that belongs to a point.

        along: sigma3 and sigma4 by sigma3_bar.
        """
        low, high, bells = -most, most, []
        for name, m in along.items():
            with np.errstate(divide="ignore", invalid="ignore"):
                one, other = (end / m for end in self.density.reach(name))
            low, high = np.fmax(low, np.fmin(one, other)), np.fmin(high, np.fmax(one, other))
            bells += [(m, *bell) for bell in [self.density.bell(name)] if bell]
        fixed = [m for name, m in along.items() if not self.density.free(name)]
        if fixed:
            # eta_hat changes by |m| as the free one does by 1: the determinant of the chart is -1.
            return low, (low <= high) / abs(fixed[0])
        # A product of Gaussians is one.
        precision = np.maximum(sum((m / deviation) ** 2 for m, _, deviation in bells), 1e-12)
        middle = sum(m * mean / deviation**2 for m, mean, deviation in bells) / precision
        return between(low, high, cube["sigma3"], (middle, precision**-0.5) if bells else None)

    def _chart(self, phi: Array) -> tuple[Array, Array]:
        """sigma3 and sigma4 on the line, by sigma3_bar."""
        chart = line_chart(self.disk, np.cos(phi), np.sin(phi))
        return chart.bar_to_sigma3, chart.bar_to_sigma4

    def _barrier(self, phi: Array, bar: Array) -> Array:
        """Height of the barrier between a start beyond the vertical and flat, -inf if none."""
        there = (abs(bar) < well(self.disk).sigma3_bar) & (np.sin(phi) < barrier(self.disk, bar, "sine"))
        return np.where(there, barrier(self.disk, bar), -np.inf)

    @cached_property
    def _pieces(self) -> Array:
        """Ends of 2^k pieces of the range of phi, between which the line does not pass a corner of the box."""

        def off(rates: tuple[float, ...], phi: Array) -> Array:
            a, c = self._chart(phi.ravel())
            return (c * rates[0] - a * rates[1]).reshape(phi.shape)

        scan = np.linspace(*self.density.reach("phi"), _SCAN)
        corners = product(*map(self.density.reach, _RATES))
        crossings = [roots_among(partial(off, corner), scan) for corner in corners]
        pieces = np.unique(np.concatenate([scan[[0, -1]], *crossings]))
        # Sobol points fill halves, quarters and so on evenly.
        while (count := pieces.size - 1) & (count - 1):
            widest = np.argmax(np.diff(pieces))
            pieces = np.insert(pieces, widest + 1, 0.5 * (pieces[widest] + pieces[widest + 1]))
        return pieces

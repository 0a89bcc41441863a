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
from explorer.measure.distributions import ANY_ENERGY, Distribution, Weight
from explorer.measure.sampling import numbered_stream
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import energy_at, energy_at_flat, eta_to_eta_hat
from explorer.phase.falling_set import barrier, well
from explorer.phase.linear_constants import line_chart
from explorer.phase.results import Columns, Table
from explorer.phase.roots import roots_among
from explorer.phase.states import COORDINATES, Array

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
        return {name: np.array(value) for name, value in vars(self).items()}

    def _lines(self) -> list[tuple[str, str]]:
        """The numbers, and what they do not say."""
        where = "for small delta only; ex.probability tells below which it holds"
        return [*super()._lines(), *([("law C delta", where)] if math.isfinite(self.value) else [])]


def falling_constant(
    disk: Disk,
    box: str | Mapping[str, Any] | None = None,
    *,
    energy: str | tuple[float | None, float | None] | None = None,
    density: Weight | None = None,
) -> FallingConstant:
    """Compute C of P(theta_min < delta) = C delta for states drawn from a density, by an integral over F.

    Parameters
    ----------
    disk : Disk
        Needs I3 > 0.
    box : str or mapping, optional
        Ranges, numbers or distributions of scipy.stats of phi (rad), phidot, sigma3 and sigma4 (units of the
        disk), as for `run`: "phi=-1:1,phidot=norm:0:1,sigma4=0.3". By default phi = 0 and rates are even within
        two natural units.
    energy : (float, float) or str, optional
        Only states with an energy in this range (units of the disk); None is no bound.
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
    from its 16 scrambles: in 93 cases of 100, C is within two errors. For ranges and other distributions the error
    is mostly below 1e-6 of C, for ranges of energy below 1e-3. It is larger for a function that is large only in a
    small part of the box: shrink the box to this part.

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
    return constant_of(Distribution.invariant(disk, box, energy, density))


def constant_of(density: Distribution, seed: int = 0) -> FallingConstant:
    """C of a distribution of phi, phidot, sigma3 and sigma4; see `falling_constant`. seed: of the scrambles."""
    if density.why_not_near_f:
        raise InputError(f"box: {density.why_not_near_f}; give one of them a range")
    face, other = (_Integrand(density.seen_from(side)) for side in (1, -1))
    parts = [] if density.reaches_flat() else [face.on_line, other.on_line]
    # l_+ and l_- meet the box in the same states where it fixes a rate at 0: sigma3_bar = 0 on both.
    if parts and (0.0, 0.0) in [density.coordinates[name].ends for name in _RATES]:
        parts.append(partial(face.on_line, both=True))
    # What overflows is refused by what comes of it.
    with np.errstate(over="ignore", invalid="ignore"):
        shares, *over_f = _means([face.in_box, *parts], density, seed)
        share = float(shares.mean())
        mass = share * density.volume
        _check_share(density, share, shares)
        if not parts:
            return FallingConstant(math.inf, math.inf, math.inf, math.inf, mass)
        plus, minus, *both = (part / share for part in over_f)
        total = plus + minus - sum(both)
        value = float(total.mean())
        # Of a quotient of means, of which the lower one has an error too.
        error = _standard_error(total - value * (shares / share)) + _ROUNDING * value
    if not math.isfinite(error):
        raise InputError("density: C overflows doubles; divide the density by its largest value")
    return FallingConstant(value, error, float(plus.mean()), float(minus.mean()), mass)


def _check_share(density: Distribution, mass: float, masses: Array) -> None:
    """Raise InputError where the integral of a density is zero or not known. masses: by scramble."""
    tiny = density.weight is not None and mass < _LEAST_MASS
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


def _means(functions: Sequence[Callable[[Columns], Array]], density: Distribution, seed: int) -> Array:
    """Means of functions of points of the unit cube (functions, scrambles): of the same points for all."""
    free, found = [each.name for each in density.coordinates.values() if each.free], []
    for scramble in range(_SCRAMBLES):
        sobol = scipy.stats.qmc.Sobol(len(free), bits=_BITS, rng=numbered_stream(seed, scramble))
        cube = dict(zip(free, sobol.random(_POINTS).T, strict=True))
        found.append([function(cube).mean() for function in functions])
    return np.array(found).T


@dataclass(frozen=True)
class _Integrand:
    """The density in natural units as a face sees it, at points of the unit cube: columns (n) by coordinate.

    Each free coordinate has its own. A range depends on the coordinates before it, so that there are no points
    outside of the box and the energies; draws from other laws count where they lie inside.
    """

    density: Distribution

    def in_box(self, cube: Columns) -> Array:
        """The weight of draws from the laws, in the energies."""
        if self.density.plain:
            return np.ones(1)
        b, highest = self.density.disk.body, self.density.energy[1]
        phi, volume = self._tilts(cube)
        q = np.cos(phi)
        most = np.sqrt(2.0 / b.J * np.maximum(highest - q, 0.0))
        sigma4, step4 = self._within("sigma4", cube, -most, most)
        V = energy_at(b, 0.0, 0.0, sigma4, q)
        most = np.sqrt(2.0 / b.I1 * np.maximum(highest - V, 0.0)) * q
        sigma3, step3 = self._within("sigma3", cube, -most, most)
        V = energy_at(b, 0.0, sigma3 / q, sigma4, q)
        volume = volume * step4 * step3
        halves = self._speeds(cube, V, self.density.energy[0])
        return sum((self._at(phi, speed, sigma3, sigma4, volume * step) for speed, step in halves), np.zeros(1))

    def on_line(self, cube: Columns, both: bool = False) -> Array:
        """The density times 2 A sqrt(I1 M)/(I3 r(0)) times the volume of a point of (phi, phidot, sigma3_bar).

        both: only what comes as flat on the other face too, where both lines meet the box at sigma3_bar = 0.
        """
        (low, high), b, (phi, volume) = self.density.energy, self.density.disk.body, self._tilts(cube)
        q, (a, c) = np.cos(phi), self._chart(phi)
        # On the line V = cos(phi) + curvature sigma3_bar^2, eq. (3.8).
        curvature = energy_at(b, 0.0, a / q, c, 0.0)
        most = np.sqrt(np.maximum(high - q, 0.0) / curvature)
        bar, step = self._bars(cube, (a, c), most)
        if both:
            step = np.minimum(step, self._bars(cube, self._chart(-phi), most)[1])
        V = q + curvature * bar * bar
        # A start that is slower does not pass the barrier on its way to flat. Upright at rest (V = 1) that is
        # in the way of the inverted pendulum, which reaches both faces if it passes.
        height = 1.0 if both else self._barrier(phi, bar)
        gain = 2.0 / b.M * (V - energy_at_flat(b, bar))
        volume = volume * step * eta_to_eta_hat(b, 2.0 * math.sqrt(b.I1 * b.M))
        found = np.zeros(1)
        for speed, step in self._speeds(cube, V, np.maximum(height, low)):
            A = np.sqrt(np.maximum(speed * speed + gain, 0.0))
            found = found + self._at(phi, speed, a * bar, c * bar, volume * step * A)
        return found

    def _at(self, phi: Array, phidot: Array, sigma3: Array, sigma4: Array, volume: Array) -> Array:
        """The weight times a volume; it is not asked where this is zero."""
        if self.density.weight is None:
            return volume
        *columns, volume = np.broadcast_arrays(phi, phidot, sigma3, sigma4, volume)
        rows, found = np.flatnonzero(volume), np.zeros(volume.shape)
        # What comes from sigma3_bar may lie outside of the box by rounding.
        laws = self.density.coordinates
        inside = {each: np.clip(x[rows], *laws[each].ends) for each, x in zip(COORDINATES, columns, strict=True)}
        found[rows] = volume[rows] * self.density.called(inside)
        return found

    def _within(self, name: str, cube: Columns, least: Array, most: Array) -> tuple[Array, Array]:
        """A coordinate between two bounds, and how often it is there."""
        law = self.density.coordinates[name]
        if law.free:
            return law.between(least, most, cube[name])
        at = law.ends[0]
        return np.array([at]), ((least <= at) & (at <= most)).astype(float)

    def _tilts(self, cube: Columns) -> tuple[Array, Array]:
        """phi, and the share that belongs to a point."""
        law = self.density.coordinates["phi"]
        if not law.free or law.law is not None:
            return (law.quantile(cube["phi"]) if law.free else np.array(law.ends[:1])), np.ones(1)
        count = self._pieces.size - 1
        place = cube["phi"] * count
        piece = np.minimum(place.astype(np.intp), count - 1)
        phi, step = law.between(self._pieces[piece], self._pieces[piece + 1], place - piece)
        return phi, step * count

    def _speeds(self, cube: Columns, V: Array, least: Any) -> list[tuple[Array, Array]]:
        """phidot of both signs between two energies, the higher one that of the density; shares of points."""
        M = self.density.disk.body.M
        slow = np.sqrt(2.0 / M * np.maximum(least - V, 0.0))
        left = self.density.energy[1] - V
        fast = np.where(left < 0.0, -1.0, np.sqrt(2.0 / M * np.maximum(left, 0.0)))
        halves = [self._within("phidot", cube, slow, fast), self._within("phidot", cube, -fast, -slow)]
        rest = self.density.coordinates["phidot"].ends == (0.0, 0.0)  # which is in both
        return halves[:1] if rest else halves

    def _bars(self, cube: Columns, along: tuple[Array, Array], most: Array) -> tuple[Array, Array]:
        """sigma3_bar up to `most` on the line, and the density there times the length that belongs to a point.

        along: sigma3 and sigma4 by sigma3_bar.
        """
        laws = [self.density.coordinates[name] for name in _RATES]
        for law, m, other, n in zip(laws, along, laws[::-1], along[::-1], strict=True):
            if not law.free:
                bar = law.ends[0] / m
                # eta_hat changes by |m| as the free one does by 1: the determinant of the chart is -1.
                return bar, (abs(bar) <= most) * other.density(n * bar) / abs(m)
        # The law that says sigma3_bar more sharply makes it, between the ends of the other.
        sharper = laws[0].spread * abs(along[1]) <= laws[1].spread * abs(along[0])
        found = []
        for law, m, other, n in zip(laws, along, laws[::-1], along[::-1], strict=True):
            with np.errstate(divide="ignore", invalid="ignore"):
                one, last = (end / n for end in other.ends)
                low, high = np.fmax(-most, np.fmin(one, last)), np.fmin(most, np.fmax(one, last))
                at, share = law.between(np.fmin(m * low, m * high), np.fmax(m * low, m * high), cube["sigma3"])
                found.append((at / m, share / abs(m) * other.density(n * (at / m))))
        bar, step = (np.where(sharper, *both) for both in zip(*found, strict=True))
        return bar, step

    def _chart(self, phi: Array) -> tuple[Array, Array]:
        """sigma3 and sigma4 on the line, by sigma3_bar."""
        chart = line_chart(self.density.disk, np.cos(phi), np.sin(phi))
        return chart.bar_to_sigma3, chart.bar_to_sigma4

    def _barrier(self, phi: Array, bar: Array) -> Array:
        """Height of the barrier between a start beyond the vertical and flat, -inf if none."""
        disk = self.density.disk
        there = (abs(bar) < well(disk).sigma3_bar) & (np.sin(phi) < barrier(disk, bar, "sine"))
        return np.where(there, barrier(disk, bar), -np.inf)

    @cached_property
    def _pieces(self) -> Array:
        """Ends of 2^k pieces of the range of phi, between which the line does not pass a corner of the box."""

        def off(rates: tuple[float, ...], phi: Array) -> Array:
            a, c = self._chart(phi.ravel())
            return (c * rates[0] - a * rates[1]).reshape(phi.shape)

        phi, *rates = (self.density.coordinates[name] for name in ("phi", *_RATES))
        scan = np.linspace(*phi.ends, _SCAN)
        corners = [corner for corner in product(*(law.ends for law in rates)) if np.isfinite(corner).all()]
        crossings = [roots_among(partial(off, corner), scan) for corner in corners]
        pieces = np.unique(np.concatenate([scan[[0, -1]], *crossings]))
        # Sobol points fill halves, quarters and so on evenly.
        while (count := pieces.size - 1) & (count - 1):
            widest = np.argmax(np.diff(pieces))
            pieces = np.insert(pieces, widest + 1, 0.5 * (pieces[widest] + pieces[widest + 1]))
        return pieces

"""Steady motions, where phi stays: straight and circular rolling, spinning upright; which are stable.

At a tilt phi a steady motion is fixed by its turn dchi/dt = sigma3/cos^2 phi, since V' = 0 is linear in sigma4
then. So all of them are a surface over (phi, turn), but for straight rolling (both zero, any sigma4). They are
stable iff V'' > 0. Rates in rad per unit of time, angles in rad, lengths in the units of the disk.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import bisect

from explorer.errors import InputError
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import line_chart, line_slope
from explorer.phase.membership import well
from explorer.phase.states import Array, columns_of
from explorer.portrait.potential import DEGENERATE, Potential, at_constants, curvature_of, on_line

_DOUBLINGS = 200


@dataclass(frozen=True)
class Steady:
    """Steady motions, arrays of one shape; turn = dchi/dt, sigma3, sigma4, constants and eta_hat_plus: rates.

    radius: of the circle of the contact point, positive where the disk leans towards its centre (phi < 0 for
    sigma4 and turn of one sign). curvature: V'' (energy); stable where it is positive.
    """

    phi: Array
    turn: Array
    sigma3: Array
    sigma4: Array
    sigma3_bar: Array
    sigma4_bar: Array
    eta_hat: Array
    radius: Array
    curvature: Array

    @property
    def stable(self) -> NDArray[np.bool_]:
        return self.curvature > 0.0


def steady_motions(disk: Disk, phi: ArrayLike, turn: ArrayLike) -> Steady:
    """The steady motions at tilts phi (rad, between the flat states) that turn at dchi/dt != 0; both broadcast."""
    require_axial_inertia(disk)
    shape = np.broadcast_shapes(np.shape(phi), np.shape(turn))
    angle, rate = columns_of(phi=phi, turn=turn)
    if not (np.all(abs(angle) < 0.5 * np.pi) and np.all(np.isfinite(rate) & (rate != 0.0))):
        raise InputError("steady motions: give -pi/2 < phi < pi/2 (rad) and a finite turn, not zero")
    b, unit, rate = disk.body, disk.rate_unit, rate / disk.rate_unit
    q, z = np.cos(angle), np.sin(angle)
    s3 = rate * q * q
    # V' = I1 turn^2 q z - J turn q sigma4 - z = 0
    s4 = z * (b.I1 * rate * rate * q - 1.0) / (b.J * rate * q)
    bar, eta = line_chart(disk, q, z).constants(s3, s4)
    columns = {
        "phi": angle,
        "turn": rate * unit,
        "sigma3": s3 * unit,
        "sigma4": s4 * unit,
        "sigma3_bar": bar * unit,
        "sigma4_bar": (line_slope(disk) * bar - eta) * unit,
        "eta_hat": eta * unit,
        # The contact point moves at r (sigma4 - z turn) along its circle
        "radius": disk.r * (s4 / rate - z),
        "curvature": curvature_of(q, z, s3, s4, b) * disk.energy_unit,
    }
    return Steady(**{name: column.reshape(shape) for name, column in columns.items()})


def stability_edges(disk: Disk, phi: ArrayLike) -> Array:
    """turn > 0 at which steady motions of tilt phi change stability, (2, n): faster, slower; NaN where none do.

    With w = turn^2, V'' = 0 is quadratic in w: the saddle-nodes of the potential. At phi = 0 the faster one is
    the threshold of spinning upright; the slower one goes to zero there, to that of straight rolling.
    """
    require_axial_inertia(disk)
    (angle,) = columns_of(phi=phi)
    two, one, none = _edge_equation(disk, angle)
    with np.errstate(invalid="ignore"):
        larger = np.where(one < 0.0, np.sqrt(one * one - 4.0 * two * none) - one, np.nan) / (2.0 * two)
        return np.sqrt(np.stack([larger, none / (two * larger)])) * disk.rate_unit


def _edge_equation(disk: Disk, phi: Array) -> tuple[Array, Array, Array]:
    b, q, z = disk.body, np.cos(phi), np.sin(phi)
    two = b.M * q * q + z * z * b.I1 * (2.0 - b.I3 / b.J)
    return two, z * z / q - q, b.k * z * z / (b.J * q * q)


def last_unstable_tilt(disk: Disk) -> float:
    """phi (rad) up to which some steady motions are unstable; beyond it all are stable. Both edges meet there."""
    require_axial_inertia(disk)

    def apart(phi: float) -> float:
        two, one, none = _edge_equation(disk, np.array([phi]))
        return float(-one[0] - 2.0 * np.sqrt(two[0] * none[0]))

    # At 45 degrees the linear term changes sign
    return float(bisect(apart, 0.0, 0.25 * math.pi, xtol=1e-16, rtol=1e-15, maxiter=200))


def threshold(disk: Disk, potential: Callable[[float], Potential], unit: float) -> float:
    """The rate above which the upright motion is stable: bisection on V''(0) of potential(rate)."""

    def curvature(rate: float) -> float:
        return float(potential(rate).d2V(0.0))

    high = unit
    for _ in range(_DOUBLINGS):
        if curvature(high) > 0.0:
            return float(bisect(curvature, 0.0, high, xtol=1e-15 * high, rtol=1e-15, maxiter=200))
        high *= 2.0
    raise InputError(f"disk {disk.name}: its upright motion is stable at no speed that a number can hold")


def rolling_threshold(disk: Disk) -> float:
    """Speed of spin sigma4 above which straight rolling is stable; by bisection on V''."""
    return threshold(disk, lambda rate: at_constants(disk, 0.0, rate), disk.rate_unit)


def spinning_threshold(disk: Disk) -> float:
    """Speed of turning above which spinning upright in place is stable; by bisection on V''."""
    return threshold(disk, lambda rate: at_constants(disk, rate, 0.0), disk.rate_unit)


def rolling_closed(disk: Disk) -> float:
    """The same as `rolling_threshold` in closed form: Omega^2 = m g r I1 / (I3 J)."""
    require_axial_inertia(disk)
    J = disk.I3 + disk.m * disk.r**2
    return math.sqrt(disk.m * disk.g * disk.r * disk.I1 / (disk.I3 * J))


def spinning_closed(disk: Disk) -> float:
    """The same as `spinning_threshold` in closed form: Omega^2 = m g r / M."""
    return math.sqrt(disk.m * disk.g * disk.r / (disk.I1 + disk.m * disk.r**2))


def circular_rolling(disk: Disk, lean: float, radius: float) -> float:
    """Rate at which the disk rolls round a circle of `radius`, leaning inwards by `lean` (rad); from V'(phi) = 0.

    By bisection: V' of the potential with the constants of motion of the state that rolls so. InputError where
    there is no such motion.
    """
    _check_circle(disk, lean, radius)
    phi = np.array([-lean])
    chart = line_chart(disk, np.cos(phi), np.sin(phi))

    def slope(rate: float) -> float:
        s3, s4 = rate * math.cos(lean) ** 2, rate * (radius / disk.r - math.sin(lean))
        bar, eta = chart.constants(s3, s4)
        potential = Potential(disk, bar[0], eta[0])
        return float(potential.dV(-lean))

    low, high = 0.0, 1.0
    for _ in range(_DOUBLINGS):
        if slope(high) < 0.0:
            return float(bisect(slope, low, high, xtol=1e-15 * high, rtol=1e-15, maxiter=200)) * disk.rate_unit
        low, high = high, 2.0 * high
    raise _no_circle(disk, lean, radius)


def circular_closed(disk: Disk, lean: float, radius: float) -> float:
    """The same as `circular_rolling` in closed form: Omega^2 = m g r tan(lean)/(J R/r - (J - I1) sin(lean))."""
    _check_circle(disk, lean, radius)
    J = disk.I3 + disk.m * disk.r**2
    below = J * radius / disk.r - (J - disk.I1) * math.sin(lean)
    if not below > 0.0:
        raise _no_circle(disk, lean, radius)
    return math.sqrt(disk.m * disk.g * disk.r * math.tan(lean) / below)


def _check_circle(disk: Disk, lean: float, radius: float) -> None:
    require_axial_inertia(disk)
    if not 0.0 < lean < 0.5 * math.pi:
        raise InputError(f"lean = {lean} must lie between 0 and pi/2 (rad)")
    if not (math.isfinite(radius) and radius >= 0.0):
        raise InputError(f"radius = {radius} must be a finite length, 0 or more")


def _no_circle(disk: Disk, lean: float, radius: float) -> InputError:
    J = disk.I3 + disk.m * disk.r**2
    least = (J - disk.I1) / J * math.sin(lean) * disk.r
    return InputError(
        f"radius = {radius:g}: leaning inwards by {lean:g} rad the disk rolls round circles above {least:.6g} only"
    )


def thresholds(disk: Disk) -> dict[str, dict[str, float]]:
    """Thresholds from V'' and from the closed forms, and sigma3_bar* of the well; rad per unit of time."""
    angle, most = well(disk)
    lean, radius = 0.25 * math.pi, 2.0 * disk.r
    return {
        "straight_rolling": {"measured": rolling_threshold(disk), "closed_form": rolling_closed(disk)},
        "spinning_upright": {"measured": spinning_threshold(disk), "closed_form": spinning_closed(disk)},
        "circular_rolling": {
            "lean": lean,
            "radius": radius,
            "measured": circular_rolling(disk, lean, radius),
            "closed_form": circular_closed(disk, lean, radius),
        },
        "well": {"sigma3_bar": most * disk.rate_unit, "phi": angle},
    }


@dataclass(frozen=True)
class Branch:
    """Equilibria that follow each other along a path: the path's parameter, phi (rad), and their kind."""

    parameter: Array
    phi: Array
    kind: str


PATHS: dict[str, tuple[str, Callable[[Disk, float], Potential]]] = {
    "spinning": ("sigma3_bar", lambda disk, rate: at_constants(disk, rate, 0.0)),
    "rolling": ("sigma4_bar", lambda disk, rate: at_constants(disk, 0.0, rate)),
    "line": ("sigma3_bar", lambda disk, rate: on_line(disk, rate)),
}


def bifurcation(disk: Disk, path: str, parameter: ArrayLike) -> tuple[Branch, ...]:
    """Steady motions along a path in the plane of constants: "spinning" (sigma4_bar = 0), "rolling"
    (sigma3_bar = 0) or "line" (on l_+). parameter: increasing values of the other constant.

    Equilibria are joined while neither their number nor their kinds change.
    """
    if path not in PATHS:
        raise InputError(f"path {path!r} is not known; choose {' or '.join(PATHS)}")
    (values,) = columns_of(parameter=parameter)
    make = PATHS[path][1]
    pieces: list[Branch] = []
    kinds: tuple[str, ...] = ()
    rows: list[tuple[float, list[float]]] = []

    def close() -> None:
        for i, kind in enumerate(kinds):
            at, phi = np.array([v for v, _ in rows]), np.array([found[i] for _, found in rows])
            pieces.append(Branch(at, phi, kind))

    for value in values:
        found = [e for e in make(disk, float(value)).equilibria if e.kind != DEGENERATE]
        now = tuple(e.kind for e in found)
        if now != kinds:
            close()
            kinds, rows = now, []
        rows.append((float(value), [e.phi for e in found]))
    close()
    return tuple(pieces)


def path_values(disk: Disk, path: str) -> tuple[Array, tuple[float, ...]]:
    """Values of a path's parameter, dense where branches meet or reach flat, and the thresholds on it."""
    if path == "line":
        edge = well(disk)[1] * disk.rate_unit
    else:
        edge = spinning_threshold(disk) if path == "spinning" else rolling_threshold(disk)
    near = np.geomspace(1e-7, 1.0, 100)
    # Towards zero tilts reach flat
    half = edge * np.unique(np.concatenate([1.0 - near[:-1], 1.0 + near, np.geomspace(1e-5, 0.1, 40)]))
    return np.concatenate([-half[::-1], half]), (edge, -edge)

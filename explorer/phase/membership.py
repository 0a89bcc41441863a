"""The falling set F: which side of it a state is, how far, and whether the disk could fall."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize_scalar

from explorer import compiled
from explorer.phase.constants import NaturalConstants, natural_constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, phi_to_states

_BARRIER_DEGREE = 24  # both series are at rounding


@dataclass(frozen=True)
class Falls:
    """Where states lie relative to F; 1-D arrays.

    face: +1 or -1, the flat state whose line l_+- is nearer (ties: +1).
    distance: signed distance of (sigma3_bar, sigma4_bar) to that line, rad per unit of time; its
    sign is the sign of eta, the direction in which the contact point races.
    distance_plus, distance_minus: the same for each line.
    could_fall: E > V_0 and the component of {V < E} reaches flat, on the nearer side, eta set to 0.
    could_fall_plus, could_fall_minus: the same on each side.
    on_f: distance is zero to rounding. A state with on_f and could_fall falls.
    theta_min_estimate: leading order |eta| / sqrt(2 I1 (E - V_0)) in rad; NaN where not could_fall.
    """

    face: NDArray[np.int8]
    distance: Array
    distance_plus: Array
    distance_minus: Array
    could_fall: NDArray[np.bool_]
    could_fall_plus: NDArray[np.bool_]
    could_fall_minus: NDArray[np.bool_]
    on_f: NDArray[np.bool_]
    theta_min_estimate: Array
    status: NDArray[np.int8]


def impact_speed(disk: Disk, sigma3_bar: Array, energy: Array) -> Array:
    """A = sqrt(2 (E - V_0) / M), eq. (7.1); natural units in and out; NaN where E < V_0."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(2.0 * (energy - disk.energy_at_flat(sigma3_bar)) / disk.body.M)


@lru_cache(maxsize=64)
def well(disk: Disk) -> tuple[float, float]:
    """(phi, sigma3_bar*) where the non-falling well on l_+ disappears; rad, natural units.

    For |sigma3_bar| below sigma3_bar* the line also carries a well whose motions never fall.
    """

    def minus_critical(phi: float) -> float:
        out = np.empty(1)
        compiled.falling.critical_X2_batch(np.array([phi]), disk.body, disk.series, out)
        return -float(out[0])

    found = minimize_scalar(
        minus_critical, bounds=(-0.5 * np.pi + 1e-6, -1e-6), method="bounded", options={"xatol": 1e-10}
    )
    return float(found.x), float(np.sqrt(-found.fun)) * disk.body.r0


@lru_cache(maxsize=64)
def barrier(disk: Disk) -> tuple[Chebyshev, Chebyshev]:
    """phi and V of the barrier between that well and the vertical, series in sqrt(1 - |sigma3_bar|/sigma3_bar*).

    Well and barrier merge at sigma3_bar*, where both have a root; in this variable they are analytic.
    """
    angle, largest = well(disk)

    def top(depth: Array, row: int) -> Array:
        out = np.empty((2, depth.size))
        bar = np.ascontiguousarray(largest * (1.0 - depth * depth))
        compiled.falling.barrier_batch(bar, angle, disk.body, disk.series, out)
        return out[row]

    phi, V = (Chebyshev.interpolate(top, _BARRIER_DEGREE, domain=[0.0, 1.0], args=(row,)) for row in (0, 1))
    return phi, V


def could_fall(states: States, natural: NaturalConstants) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether states could fall on face +1 and on face -1, were eta there zero. natural: their constants."""
    out = np.empty((3, len(states)))
    disk = states.disk
    compiled.falling.falls_batch(states.natural, natural.rows, well(disk)[0], disk.body, disk.series, out)
    return out[0] > 0.0, out[1] > 0.0


def falls_of(states: States, natural: NaturalConstants | None = None) -> Falls:
    """Where states lie relative to F. `natural`: their constants, where they are known already."""
    disk = states.disk
    require_axial_inertia(disk)
    b, unit = disk.body, disk.rate_unit
    if natural is None:
        natural = natural_constants(states)
    out = np.empty((3, len(states)))
    compiled.falling.falls_batch(states.natural, natural.rows, well(disk)[0], b, disk.series, out)
    norm = unit / np.hypot(b.I1 * b.dr0, b.I3 * b.r0)
    near_plus = natural.nearer_plus
    eta, rounding = natural.eta(near_plus), natural.rounding(near_plus)
    could_plus, could_minus = out[0] > 0.0, out[1] > 0.0
    could_fall = np.where(near_plus, could_plus, could_minus)
    with np.errstate(invalid="ignore"):
        estimate = abs(eta) / np.sqrt(2.0 * b.I1 * np.where(could_fall, out[2], np.nan))
        on_f = abs(eta) <= rounding
    return Falls(
        face=np.where(near_plus, 1, -1).astype(np.int8),
        distance=eta * norm,
        distance_plus=natural.eta_plus * norm,
        distance_minus=natural.eta_minus * norm,
        could_fall=could_fall,
        could_fall_plus=could_plus,
        could_fall_minus=could_minus,
        on_f=on_f,
        theta_min_estimate=estimate,
        status=np.where(
            on_f & could_fall & (states.status == 0), compiled.status.Status.FALLS, states.status
        ).astype(np.int8),
    )


def falls(disk: Disk, phi: ArrayLike, phidot: ArrayLike, sigma3: ArrayLike, sigma4: ArrayLike) -> Falls:
    """Signed side and distance to F, and whether the disk could fall; no integration.

    Arguments as for `constants`. Eqs (6.1), (6.2), (6.9) and section 6.2 of the paper. Needs I3 > 0.
    """
    return falls_of(phi_to_states(disk, phi, phidot, sigma3, sigma4))

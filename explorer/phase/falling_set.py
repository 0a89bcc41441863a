"""The falling set F: the side of it that a state is on, its distance, and whether the disk could fall."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import energy_at_flat
from explorer.phase.linear_constants import Motion
from explorer.phase.results import Result
from explorer.phase.states import Array, States, require_states

# Depths at which the barrier's series are compared with bisections, and how many times the largest difference is
# taken for their error; never less than rounding.
_COMPARED, _CAUTION, _LEAST_SLACK = 257, 100.0, 1e-13
# phi from the other flat state to the vertical, short of both, where critical_X2 is 0/0; at how many places its
# peak is looked for; and the degree of its series beside the peak, which is at rounding.
_BEYOND_VERTICAL, _PLACES, _PEAK_DEGREE = (-0.5 * np.pi + 1e-6, -1e-6), 65, 16


@dataclass(frozen=True, repr=False, eq=False)
class Falls(Result):
    """Positions of states relative to the falling set F, arrays of the states' shape: what `falls` returns.

    Attributes
    ----------
    face : array of int8
        Flat state whose line l_+- is nearer, +1 or -1. If both are equally near, it is +1; but if the state is on
        both lines, it is the face on which the disk falls.
    distance : array
        Signed distance of (sigma3_bar, sigma4_bar) from that line, units of the disk. Its sign is that of
        eta, the direction in which the contact point races.
    distance_plus, distance_minus : array
        The same for each line.
    could_fall : array of bool
        Whether it would fall on that face if eta were exactly 0: the energy E exceeds V_0, the value of V at flat,
        and the component of {V < E} that contains the state reaches flat.
    could_fall_plus, could_fall_minus : array of bool
        The same for each face.
    on_f : array of bool
        Whether the distance is zero to rounding. If on_f and could_fall are both True, the disk falls.
    theta_min_estimate : array
        Leading order of the smallest tilt, |eta| / sqrt(2 I1 (E - V_0)) (rad); NaN where not could_fall.
    status : array of int8
        `Status` of each state: OK, FALLS or BAD_INPUT.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.falls(ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 1.0, [0.7, 0.75]))
    >>> found.face, found.distance.round(4)
    (array([1, 1], dtype=int8), array([ 0.0231, -0.0173]))
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
    states: States


def impact_speed(disk: Disk, sigma3_bar: Array, energy: Array) -> Array:
    """A = sqrt(2 (E - V_0) / M), eq. (7.1); natural units in and out; NaN where E < V_0."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(2.0 * (energy - energy_at_flat(disk.body, sigma3_bar)) / disk.body.M)


class Well(NamedTuple):
    """Where the non-falling well on l_+ ends: phi (rad) and |sigma3_bar|, which is sigma3_bar* (natural units)."""

    phi: float
    sigma3_bar: float


def critical_X2(disk: Disk, phi: Array) -> Array:
    """(sigma3_bar/r(0))^2 of the steady motions on l_+ at phi < 0, beyond the vertical; natural units."""
    out = np.empty(phi.size)
    compiled.falling.critical_X2_batch(phi, disk.natural, out)
    return out


@lru_cache(maxsize=64)
def well(disk: Disk) -> Well:
    """Where the non-falling well on l_+ disappears.

    For |sigma3_bar| below sigma3_bar* the line also carries a well whose motions never fall.
    """
    phi, critical = np.linspace(*_BEYOND_VERTICAL, _PLACES), partial(critical_X2, disk)
    beside = phi[int(np.argmax(critical(phi))) + np.array([-1, 1])]
    slope = Chebyshev.interpolate(critical, _PEAK_DEGREE, domain=beside).deriv()
    (top,) = (float(x.real) for x in slope.roots() if x.imag == 0.0 and beside[0] < x.real < beside[1])
    return Well(top, float(np.sqrt(critical(np.array([top]))[0])) * disk.body.r0)


@lru_cache(maxsize=64)
def obstacle(disk: Disk) -> compiled.falling.Obstacle:
    """The barrier between that well and the vertical as kernels take it: series, with a bound of their errors.

    They are in sqrt(1 - |sigma3_bar|/sigma3_bar*). Well and barrier merge at sigma3_bar*, where sin phi and V of
    the barrier have a root; in this variable they are analytic.
    """
    angle, largest = well(disk)

    def bisected(depth: Array) -> Array:
        out = np.empty((2, depth.size))
        compiled.falling.barrier_batch(largest * (1.0 - depth * depth), angle, disk.natural, out)
        top = compiled.falling.Barrier(*out)
        return np.stack([np.sin(top.phi), top.V])

    make = partial(compiled.polynomials.interpolate, degree=compiled.falling.BARRIER_DEGREE)
    sine, height = make(lambda depth: bisected(depth)[0]), make(lambda depth: bisected(depth)[1])
    depth = np.linspace(0.0, 1.0, _COMPARED)[1:]
    found, series = bisected(depth), [polyval(2.0 * depth - 1.0, powers) for powers in (sine, height)]
    apart = [abs(series[0] - found[0]).max(), abs(series[1] / found[1] - 1.0).max()]
    slack = max(_LEAST_SLACK, _CAUTION * float(max(apart)))
    return compiled.falling.Obstacle(angle, largest / disk.body.r0, slack, tuple(sine), tuple(height))


def barrier(disk: Disk, sigma3_bar: Array, term: str = "V") -> Array:
    """V of the barrier at |sigma3_bar|, and at sigma3_bar* beyond; or the "sine" of its phi. Natural units."""
    u = np.sqrt(np.maximum(1.0 - abs(sigma3_bar) / well(disk).sigma3_bar, 0.0))
    found: Array = polyval(2.0 * u - 1.0, getattr(obstacle(disk), term))
    return found


class Location(NamedTuple):
    """Where states (n) are relative to F: the nearer face, eta there (natural units), and as `Falls` says."""

    face: NDArray[np.int8]
    eta: Array
    could: NDArray[np.bool_]
    could_plus: NDArray[np.bool_]
    could_minus: NDArray[np.bool_]
    on_f: NDArray[np.bool_]
    status: NDArray[np.int8]


def located(states: States) -> Location:
    """Where states are relative to F. Needs I3 > 0."""
    require_axial_inertia(states.disk)
    disk, bits, code = states.disk, compiled.membership, compiled.status.Status
    given, codes = states.given is not None, np.empty(states.size, np.int8)
    rows = np.stack(states.motion) if given else np.empty((len(Motion._fields), states.size))
    bits.membership_batch(states.natural, given, obstacle(disk), disk.natural, rows, codes)
    motion = vars(states).setdefault("motion", states.of_motion(Motion(*rows)))  # which need not be found again
    codes[states.codes == code.BAD_INPUT] = bits.PLUS
    plus, could, on_f, could_plus, could_minus = (
        (codes & bit) != 0 for bit in (bits.PLUS, bits.COULD, bits.ON_F, bits.COULD_PLUS, bits.COULD_MINUS)
    )
    status = np.where(on_f & could & (states.codes == code.OK), np.int8(code.FALLS), states.codes)
    face = np.where(plus, np.int8(1), np.int8(-1))
    return Location(face, motion.eta(plus), could, could_plus, could_minus, on_f, status)


# What this file and the constants of states call, for `compiled.warmup`.
KERNELS = (
    "algebra.constants_batch",
    "falling.barrier_batch",
    "falling.critical_X2_batch",
    "membership.membership_batch",
)


def falls(states: States) -> Falls:
    """Signed distance of states from the falling set F, and whether the disk could fall; no integration.

    Parameters
    ----------
    states : States
        States of one disk, with I3 > 0.

    Returns
    -------
    Falls
        One entry per state.

    Raises
    ------
    InputError
        For anything but States, and for a disk with I3 = 0.

    Notes
    -----
    Eqs (6.1), (6.2), (6.9) and section 6.2 of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.falls(ex.phi_to_states(ex.Disk.uniform(), phi=0.0, phidot=1.0, sigma3=[1.0, 3.0], sigma4=0.7))
    >>> found.could_fall
    array([ True, False])
    """
    disk = require_states(states).disk
    b, here, motion = disk.body, located(states), states.motion
    norm = disk.rate_unit / np.hypot(b.I1 * b.dr0, b.I3 * b.r0)
    with np.errstate(invalid="ignore"):
        excess = np.where(here.could, motion.energy - energy_at_flat(b, motion.sigma3_bar), np.nan)
        estimate = abs(here.eta) / np.sqrt(2.0 * b.I1 * excess)
    found = Falls(
        face=here.face,
        distance=here.eta * norm,
        distance_plus=motion.eta_plus * norm,
        distance_minus=motion.eta_minus * norm,
        could_fall=here.could,
        could_fall_plus=here.could_plus,
        could_fall_minus=here.could_minus,
        on_f=here.on_f,
        theta_min_estimate=estimate,
        status=here.status,
        states=states,
    )
    return found.reshaped(states.shape)

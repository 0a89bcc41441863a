"""Steady motions by what one measures: tilt, precession and spin, or the lean and the circle of a rolling disk."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, flag, number
from explorer.phase.arguments import read_columns
from explorer.phase.coordinates import angle_unit, from_rates, warn_of_degrees
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.potential import curvature_of
from explorer.phase.results import Result
from explorer.phase.states import Array, States


@dataclass(frozen=True, repr=False, eq=False)
class SteadyMotions(Result):
    """Motions that keep their tilt, arrays of the shape of the arguments, in the units of the disk.

    NaN with the status BAD_INPUT where there is no such motion.

    Attributes
    ----------
    tilt : array
        Angle of the disk's plane to the table (rad): 0 is flat, pi/2 upright.
    precession : array
        Rate at which the contact point turns about the vertical.
    spin : array
        Angular velocity about the disk's own axis.
    radius : array
        Radius of the circle of the contact point, negative where the disk leans away from the centre of its
        circle.
    stable : array of bool
        Whether V'' > 0: after a push it only wobbles.
    status : array of int8
        `Status` of each motion, OK or BAD_INPUT.
    states : States
        A state of each motion, for `simulate` and all else that takes States.

    Examples
    --------
    >>> import explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> motion = ex.circular_rolling(coin, lean=0.2, radius=0.1)
    >>> print(f"{motion.radius:.3f} m, {motion.precession:.4f} rad/s, stable: {motion.stable}")
    0.100 m, 3.6781 rad/s, stable: True
    """

    tilt: Array
    precession: Array
    spin: Array
    radius: Array
    stable: NDArray[np.bool_]
    status: NDArray[np.int8]
    states: States


def steady_motions(
    disk: Disk, tilt: ArrayLike, precession: ArrayLike, face: ArrayLike = 1, degrees: bool = False
) -> SteadyMotions:
    """The spin with which a disk keeps its tilt while it precesses.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    tilt : array_like
        Angle between the disk's plane and the table (rad): 0 is flat, pi/2 is upright.
    precession : array_like
        Rate at which the contact point turns about the vertical, units of the disk.
    face : array_like of +1 or -1
        Which face would come down; for the other face the spin changes its sign.
    degrees : bool
        Whether `tilt` is in degrees and `precession` in degrees per unit of time.

    Returns
    -------
    SteadyMotions
        One motion for each tilt and precession, because the equation for the spin is linear. An upright disk with
        precession turns on the spot. Without precession no spin can be given, and the status is BAD_INPUT: a
        tilted disk is not steady, and an upright one rolls straight at any spin.

    Raises
    ------
    InputError
        For arguments that are not numbers or do not broadcast, and for a disk with I3 = 0.

    Warns
    -----
    StateWarning
        As `rates_to_states`.

    Notes
    -----
    V' = 0 of eq. (3.8) with sigma3 = cos^2(phi) precession: I1 precession^2 q z - J precession q spin = m g r z,
    where q = cos(phi), z = sin(phi).

    Examples
    --------
    A coin that wobbles steadily ten degrees above the table, at sixty radians per second:

    >>> import numpy as np, explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> motion = ex.steady_motions(coin, np.radians(10.0), 60.0)
    >>> print(f"spin {motion.spin:.2f} rad/s, stable: {motion.stable}")
    spin -41.24 rad/s, stable: True
    >>> tilts = ex.simulate(motion.states, 1.0, observables=["phi"]).phi
    >>> bool(np.ptp(tilts) < 1e-6)
    True
    """
    require_axial_inertia(disk)
    (angle, rate, down), shape = read_columns(tilt=tilt, precession=precession, face=face)
    angle, rate = (column * angle_unit("tilt", flag("degrees", degrees)) for column in (angle, rate))
    if not degrees:
        warn_of_degrees(angle)
    b, unit, code = disk.body, disk.rate_unit, compiled.status.Status
    with np.errstate(all="ignore"):
        phi, turn = down * (0.5 * np.pi - angle), rate / unit
        q, z = np.sin(angle), np.sin(phi)  # near flat phi has too few digits for its cosine
        spin = z * (b.I1 * turn * turn * q - 1.0) / (b.J * turn * q)
        # The contact point moves at r (spin - z precession) along its circle.
        radius = disk.r * (spin / turn - z)
        stable = curvature_of(q, z, turn * q * q, spin, b) > 0.0
        good = (angle > 0.0) & (angle < np.pi) & (abs(down) == 1.0) & np.isfinite(spin) & np.isfinite(radius)
    states = from_rates(disk, np.where(good, angle, np.nan), rate, spin * unit, 0.0, down)
    good &= states.codes == code.OK
    found = SteadyMotions(
        tilt=angle,
        precession=rate,
        spin=np.where(good, spin * unit, np.nan),
        radius=np.where(good, radius, np.nan),
        stable=stable & good,
        status=np.where(good, code.OK, code.BAD_INPUT).astype(np.int8),
        states=states,
    )
    return found.reshaped(shape)


def circular_rolling(disk: Disk, lean: float, radius: float, degrees: bool = False) -> SteadyMotions:
    """The motion in which a disk rolls round a circle, leaning inwards.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    lean : float
        By how much the disk's plane leans from the vertical towards the centre of the circle (rad), 0 to pi/2.
    radius : float
        Radius of the circle of the contact point, in the unit of length.
    degrees : bool
        Whether `lean` is in degrees.

    Returns
    -------
    SteadyMotions
        The motion that goes round anticlockwise.

    Raises
    ------
    InputError
        If the circle is too small for the lean, or if the disk has I3 = 0.

    Notes
    -----
    precession^2 = m g r tan(lean) / (J radius/r - (J - I1) sin(lean)), J = I3 + m r^2: V' = 0 of eq. (3.8).

    Examples
    --------
    A coin on a circle as large as a saucer, with the time that a round takes:

    >>> import math, explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> motion = ex.circular_rolling(coin, lean=20.0, radius=0.07, degrees=True)
    >>> print(f"{2.0 * math.pi / motion.precession:.3f} s, spin {motion.spin:.1f} rad/s")
    1.051 s, spin 32.6 rad/s
    """
    require_axial_inertia(disk)
    inward, circle = number("lean", lean), number("radius", radius, 0.0)
    inward *= angle_unit("tilt", flag("degrees", degrees))
    if not 0.0 < inward < 0.5 * math.pi:
        raise InputError(
            f"lean = {inward:g} rad must lie between 0 and pi/2; where it is in degrees, give degrees=True"
        )
    J = disk.I3 + disk.m * disk.r**2
    below = J * circle / disk.r - (J - disk.I1) * math.sin(inward)
    if not below > 0.0:
        least = (J - disk.I1) / J * math.sin(inward) * disk.r
        raise InputError(
            f"radius = {circle:g}: leaning inwards by {inward:g} rad the disk rolls round circles above "
            f"{least:.6g} only; give a larger radius"
        )
    rate = math.sqrt(disk.m * disk.g * disk.r * math.tan(inward) / below)
    return steady_motions(disk, 0.5 * math.pi - inward, rate, face=-1)

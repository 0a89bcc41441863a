"""Steady motions by what one measures: tilt, precession and spin, or the lean and the circle of a rolling disk."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import flag, number
from explorer.phase.arguments import read_columns
from explorer.phase.coordinates import from_rates, warn_of_degrees
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.results import Result
from explorer.phase.stability import circular_precession, steady_rates
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
        Of the circle of the contact point, negative where the disk leans away from the centre of its circle.
    stable : array of bool
        Whether V'' > 0: a push makes it wobble only.
    status : array of int8
        `Status` of each motion, OK or BAD_INPUT.
    states : States
        A state of each motion, for `simulate` and all else that takes States.

    Examples
    --------
    >>> import explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> motion = ex.circular_rolling(coin, lean=0.2, radius=0.1)
    >>> print(f"{motion.radius[0]:.3f} m, {motion.precession[0]:.4f} rad/s, stable: {motion.stable[0]}")
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
    """The spins with which a disk keeps its tilt while it precesses.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    tilt : array_like
        Angle between the disk's plane and the table (rad): 0 is flat, pi/2 is upright.
    precession : array_like
        Rate at which the contact point turns about the vertical, units of the disk.
    face : array_like of +1 or -1
        Which face would come down; the spins for the other one are those for the mirror image.
    degrees : bool
        Whether `tilt` is in degrees and `precession` counts degrees, not radians, per time.

    Returns
    -------
    SteadyMotions
        One for each pair: the equation for the spin is linear. An upright disk that precesses spins in place.
        Without precession only the upright disk is steady, and rolls straight at any spin: that is BAD_INPUT.

    Raises
    ------
    InputError
        For arguments that are no numbers or do not broadcast, and for a disk with I3 = 0.

    Warns
    -----
    StateWarning
        Where all tilts lie beyond upright, as degrees that are read as radians do.

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
    >>> print(f"spin {motion.spin[0]:.2f} rad/s, stable: {motion.stable[0]}")
    spin -41.24 rad/s, stable: True
    >>> tilts = ex.simulate(motion.states, 1.0, observables=["phi"]).phi
    >>> bool(np.ptp(tilts) < 1e-6)
    True
    """
    require_axial_inertia(disk)
    (angle, rate, face_of_each), shape = read_columns({"tilt": tilt, "precession": precession, "face": face})
    if flag("degrees", degrees):
        angle, rate = np.radians(angle), np.radians(rate)
    else:
        warn_of_degrees(angle)
    flat = _steady(disk, angle, rate, face_of_each)
    return replace(flat.reshaped(shape), states=replace(flat.states, shape=shape))


def _steady(disk: Disk, angle: Array, rate: Array, face: Array) -> SteadyMotions:
    """Steady motions of one row; angle: tilt."""
    with np.errstate(all="ignore"):
        phi = face * (0.5 * np.pi - angle)
        possible = (abs(phi) < 0.5 * np.pi) & np.isfinite(rate) & (rate != 0.0) & (abs(face) == 1.0)
    # Something steady stands in for what is not.
    with np.errstate(all="ignore"):
        found = steady_rates(disk, np.where(possible, phi, 0.0), np.where(possible, rate, disk.rate_unit))
        possible &= np.isfinite(found.sigma4) & np.isfinite(found.radius)

    def known(values: Array) -> Array:
        return np.where(possible, values, np.nan)

    states = from_rates(disk, (known(angle), np.zeros_like(angle), rate, found.sigma4), face)
    code = compiled.status.Status
    return SteadyMotions(
        tilt=angle,
        precession=rate,
        spin=known(found.sigma4),
        radius=known(found.radius),
        stable=found.stable & possible,
        status=np.where(possible, code.OK, code.BAD_INPUT).astype(np.int8),
        states=states,
    )


def circular_rolling(disk: Disk, lean: float, radius: float) -> SteadyMotions:
    """The motion in which a disk rolls round a circle, leaning inwards.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    lean : float
        By how much the disk's plane leans from the vertical towards the centre of the circle (rad), 0 to pi/2.
    radius : float
        Radius of the circle of the contact point, in the unit of length.

    Returns
    -------
    SteadyMotions
        The motion that goes round anticlockwise, as an array of one.

    Raises
    ------
    InputError
        Where the circle is too small for the lean, and for a disk with I3 = 0.

    Notes
    -----
    precession^2 = m g r tan(lean) / (J radius/r - (J - I1) sin(lean)), J = I3 + m r^2: V' = 0 of eq. (3.8).

    Examples
    --------
    A coin on a circle as large as a saucer, with the time that a round takes:

    >>> import math, explorer as ex
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> motion = ex.circular_rolling(coin, lean=math.radians(20.0), radius=0.07)
    >>> print(f"{2.0 * math.pi / motion.precession[0]:.3f} s, spin {motion.spin[0]:.1f} rad/s")
    1.051 s, spin 32.6 rad/s
    """
    inward = number("lean", lean)
    rate = circular_precession(disk, inward, number("radius", radius))
    return steady_motions(disk, 0.5 * np.pi - inward, rate, face=-1)

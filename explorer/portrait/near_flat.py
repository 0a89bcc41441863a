"""Passages seen from near flat: where the race of the contact point is one and the same curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import InputError, number, positive
from explorer.motion.passages import passages
from explorer.motion.trajectories import finer, trajectories
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, columns_of, constants_to_states
from explorer.portrait.both_sides import BothSides, both_sides

_PARTS = 2  # of a step of the record, for 0.1 rad of chi between two points of a curve
_MOST = 500  # distances in one call
_ACCURACY = 1e-9
# Tilts below are lost in the rounding of phi, which is near pi/2 there.
_SMALLEST = 1e-10


@dataclass(frozen=True)
class NearFlat:
    """One passage from the vertical to nearly flat and back, on face +1.

    Attributes
    ----------
    disk : Disk
        The body.
    eta_hat : float
        With its sign, units of the disk.
    theta, chi : (nt,) array
        Tilt from flat and contact angle (rad).
    p, rho : (nt,) array
        dtheta/dt, and sigma3 / sin(theta), both in units of the disk; rho is bounded where dchi/dt is not.
    theta_min : float
        The smallest tilt (rad).
    impact_speed : float
        A of eq. (7.1), units of the disk.

    Examples
    --------
    >>> import explorer as ex
    >>> one, = ex.portrait.near_flat(ex.Disk.uniform(), [1e-6])
    >>> print(f"{one.theta_min:.3g} rad at the flattest")
    7.24e-07 rad at the flattest
    """

    disk: Disk
    eta_hat: float
    theta: Array
    chi: Array
    p: Array
    rho: Array
    theta_min: float
    impact_speed: float

    @property
    def stretched(self) -> Array:
        """A t / theta_min, t from the flattest moment, as theta^2 = theta_min^2 + A^2 t^2 has it."""
        size = np.sqrt(np.maximum((self.theta / self.theta_min) ** 2 - 1.0, 0.0))
        return np.asarray(np.copysign(size, self.p))

    @property
    def raced(self) -> Array:
        """chi from the middle of the race, in units of kappa (rad)."""
        return np.asarray((self.chi - 0.5 * (self.chi[0] + self.chi[-1])) / self.disk.kappa)


def near_flat(
    disk: Disk, eta_hat: ArrayLike, sigma3_bar: float = 1.0, phidot: float = 1.0
) -> tuple[NearFlat, ...]:
    """Passages on face +1 at distances eta_hat from F, with their signs, from the same start at the vertical.

    Parameters
    ----------
    disk : Disk
    eta_hat : array_like
        Distances from F, units of the disk; from 1e-10 sqrt(g/r) up.
    sigma3_bar, phidot : float
        At the vertical, units of the disk.

    Returns
    -------
    tuple of NearFlat
        One for each eta_hat.

    Raises
    ------
    InputError
        Where there is no such passage.

    References
    ----------
    Lemma 6 of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> both = ex.portrait.near_flat(ex.Disk.uniform(), [1e-3, -1e-3])
    >>> [round(one.theta_min, 6) for one in both]
    [0.000723, 0.000725]
    """
    require_axial_inertia(disk)
    sizes = _distances(eta_hat)
    sigma3_bar, phidot = number("sigma3_bar", sigma3_bar), number("phidot", phidot)
    if not (abs(sizes) >= _SMALLEST * disk.rate_unit).all():
        raise InputError(f"eta_hat = {eta_hat!r}: give numbers of size {_SMALLEST:g} sqrt(g/r) and above")
    ways = passages(disk, sigma3_bar, sizes, phidot)
    if ways.status.any():
        raise InputError(f"sigma3_bar = {sigma3_bar!r}, phidot = {phidot!r}: no passage; give phidot above 0")
    found = []
    for row, signed in enumerate(sizes):
        start = constants_to_states(disk, sigma3_bar, signed, phidot)
        observables = ("phi", "phidot", "sigma3", "chi")
        motion = trajectories(start, float(ways.duration[row]), observables=observables, accuracy=_ACCURACY)
        at = motion(finer(motion.t[0], _PARTS))
        phi, phidots, sigma3, chi = (getattr(at, name)[0] for name in observables)
        theta = 0.5 * np.pi - phi
        least, speed = float(ways.theta_min[row]), float(ways.impact_speed[row])
        found.append(NearFlat(disk, float(signed), theta, chi, -phidots, sigma3 / np.sin(theta), least, speed))
    return tuple(found)


def _distances(eta_hat: ArrayLike) -> Array:
    """Distances from F, of which each is a picture's line and takes milliseconds. Raises InputError."""
    sizes = columns_of(eta_hat=eta_hat)[0]
    if sizes.size > _MOST:
        raise InputError(f"eta_hat: {sizes.size:,} distances; give at most {_MOST}, a line of a picture each")
    return sizes


def toward_limits(
    disk: Disk, eta_hat: Sequence[float], sigma3_bar: float = 1.0, phidot: float = 1.0
) -> tuple[BothSides, ...]:
    """Motions beside one point of F at several distances, each beside both limits.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    eta_hat : sequence of float
        Distances from F, above 0, natural units.
    sigma3_bar, phidot : float
        At the vertical, units of the disk.

    Returns
    -------
    tuple of BothSides
        One for each distance, as `explorer.both_sides` gives it.

    Raises
    ------
    InputError
        For distances that are not above 0, and where no motion falls from there.

    Examples
    --------
    >>> import explorer as ex
    >>> [round(both.eta_hat, 3) for both in ex.portrait.toward_limits(ex.Disk.uniform(), [0.1, 0.01])]
    [0.1, 0.01]
    """
    sizes = [positive("eta_hat", size) for size in _distances(eta_hat)]
    start = constants_to_states(disk, number("sigma3_bar", sigma3_bar), 0.0, number("phidot", phidot))
    return tuple(both_sides(start, size * disk.rate_unit) for size in sizes)

"""The rotation number: by how many turns the contact point advances in one period, at given constants."""

from dataclasses import dataclass

import numpy as np

from explorer.errors import InputError, number, whole
from explorer.motion.periods import periods
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import line_slope
from explorer.phase.states import Array, phi_to_states

_MOST_POINTS = 2001
_ACCURACY = 1e-4  # rad: a hundredth of what a colour shows


@dataclass(frozen=True)
class RotationMap:
    """chi(tau)/2pi of motions through the vertical, at one energy.

    Attributes
    ----------
    disk : Disk
        The body.
    energy : float
        In its unit of energy.
    sigma3_bar, sigma4_bar : (n,) array
        The sides of the grid, units of the disk.
    turns : (n, n) array
        By sigma4_bar and by sigma3_bar, NaN where no motion of this energy passes the
        vertical, and on F.
    slope : float
        sigma4_bar/sigma3_bar on l_+.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.rotation_map(ex.Disk.uniform(), 2.0, points=4).turns.shape
    (4, 4)
    """

    disk: Disk
    energy: float
    sigma3_bar: Array
    sigma4_bar: Array
    turns: Array
    slope: float


def rotation_map(disk: Disk, energy: float, points: int = 300) -> RotationMap:
    """The rotation number on a grid over all constants of motion that a motion of this energy can have.

    Parameters
    ----------
    disk : Disk
    energy : float
        In the unit of energy of the disk; more than m g r.
    points : int
        On each side of the grid; an even number, so that none lies on an axis.

    Returns
    -------
    RotationMap

    Raises
    ------
    InputError
        For an energy that no motion through the vertical has.

    References
    ----------
    Eq. (3.13) of the paper; Borisov, Mamaev & Kilin 2003.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.rotation_map(ex.Disk.uniform(), 2.0, points=4)
    >>> int((found.turns > 0.0).sum())
    6
    """
    require_axial_inertia(disk)
    count = whole("points", points, 2, _MOST_POINTS)
    energy = number("energy", energy)
    free = energy / disk.energy_unit - 1.0
    if free <= 0.0:
        raise InputError(f"energy = {energy!r}: upright, the disk has m g r = {disk.energy_unit:g}; give more")
    body, unit = disk.body, disk.rate_unit
    # At the vertical the energy is M phidot^2 / 2 + I1 sigma3^2 / 2 + J sigma4^2 / 2 + m g r.
    sigma3, sigma4 = (np.sqrt(2.0 * free / inertia) * _inside(count) for inertia in (body.I1, body.J))
    left = 2.0 * free - body.I1 * sigma3[None, :] ** 2 - body.J * sigma4[:, None] ** 2
    rows, columns = np.nonzero(left > 0.0)
    phidot = np.sqrt(left[rows, columns] / body.M) * unit
    states = phi_to_states(disk, 0.0, phidot, sigma3[columns] * unit, sigma4[rows] * unit)
    turns = np.full(left.shape, np.nan)
    turns[rows, columns] = periods(states, _ACCURACY).chi / (2.0 * np.pi)
    return RotationMap(disk, energy, sigma3 * unit, sigma4 * unit, turns, line_slope(disk))


def _inside(count: int) -> Array:
    """Middles of `count` equal parts of (-1, 1)."""
    return np.asarray((np.arange(count) + 0.5) * 2.0 / count - 1.0)

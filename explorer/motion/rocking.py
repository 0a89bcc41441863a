"""The disk that rocks at the bottom of the well beside flat, and its turn per bounce: the Euler-disk regime.

At small eta and E - V_0 of order theta_0 = (eta^2/(I1 m g r))^(1/3) the motion rocks near flat between
the centrifugal wall eta^2/(2 I1 theta^2) and gravity m g r theta, and never comes near the vertical.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError, number
from explorer.motion.periods import periods
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import energy_at_flat, eta_hat_to_eta
from explorer.phase.results import Result
from explorer.phase.states import Array, theta_to_states

ETA_HAT = 1e-12
# Dense near the bottom, where the turn is linear in the energy; at the end it is within 2e-4 of the race.
EXCESS = np.concatenate([1.0 + np.geomspace(1e-3, 1.0, 40), np.geomspace(2.0, 1e4, 81)[1:]])
_LARGEST_TILT = 0.1  # rad; beyond, gravity is not m g r theta
_ACCURACY = 1e-6  # of the turn (rad); terms of order theta_0, about 1e-8 by default, are left out anyway


@dataclass(frozen=True, repr=False, eq=False)
class Rocking(Result):
    """Motions that rock near flat, arrays of the shape of `excess`; NaN where the status is not OK.

    Attributes
    ----------
    disk : Disk
        The body.
    excess : array
        (E - V_0)/(3/2 m g r theta_0), computed from the motion; it is 1 at the bottom of the well.
    chi : array
        Turn of the contact point per bounce (rad).
    theta_min : array
        Smallest tilt of the bounce (rad).
    period : array
        Period of one bounce, units of the disk.
    status : array of int8
        `Status` of each motion.
    theta_0 : float
        Tilt of the bottom (rad).

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.rocking(ex.Disk.uniform(), excess=1.001)
    >>> print(f"{found.chi:.4f} rad, the smallest oscillation {found.slowest:.4f} rad")
    8.1109 rad, the smallest oscillation 8.1116 rad
    """

    disk: Disk
    excess: Array
    chi: Array
    theta_min: Array
    period: Array
    status: NDArray[np.int8]
    theta_0: float

    @property
    def slowest(self) -> float:
        """2 pi sqrt(M/(3 I1)): the turn of the smallest oscillation (rad)."""
        return 2.0 * math.pi * math.sqrt(self.disk.body.M / (3.0 * self.disk.body.I1))


def rocking(disk: Disk, excess: ArrayLike | None = None, eta_hat: float = ETA_HAT) -> Rocking:
    """How far chi turns per bounce of a disk that rocks near flat: from the smallest oscillations up to the race.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    excess : array_like, optional
        Energies, as (E - V_0)/(3/2 m g r theta_0), where V_0 is the value of V at flat if eta = 0. They must
        exceed 1, the value at the bottom of the well; by default up to 1e4.
    eta_hat : float
        Units of the disk; not 0, and small enough for the tilts to stay below 0.1 rad. The motions have a
        sigma3_bar of the size of eta_hat ln(eta_hat). As eta_hat goes to 0, their curve of chi against excess
        tends to a limit.

    Returns
    -------
    Rocking

    Raises
    ------
    InputError
        For an excess up to 1, and an eta_hat that is 0 or too large.

    Notes
    -----
    By quadrature, eqs (3.12) and (3.13) of the paper. theta_0 = (eta^2/(I1 m g r))^(1/3).

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.rocking(ex.Disk.uniform(), excess=100.0)
    >>> print(f"{found.chi:.3f} of {found.disk.race_limit:.3f}")
    7.032 of 7.025
    """
    require_axial_inertia(disk)
    b, unit = disk.body, disk.rate_unit
    (ratio,), shape = read_columns(excess=EXCESS if excess is None else excess)
    eta = eta_hat_to_eta(disk.body, number("eta_hat", eta_hat) / unit)
    if not (np.isfinite(ratio).all() and (ratio > 1.0).all()):
        raise InputError(f"excess = {excess!r}: give finite numbers above 1; the bottom of the well is at 1")
    theta_0 = math.exp((2.0 * math.log(abs(eta)) - math.log(b.I1)) / 3.0) if abs(eta) > 0.0 else math.nan
    most = ratio.max(initial=1.0)
    if not 1.5 * most * theta_0 <= _LARGEST_TILT:
        raise InputError(
            f"eta_hat = {eta_hat!r}: must not be 0, and so small that excess {most:g} stays below a tilt "
            f"of {_LARGEST_TILT} rad; give for instance {ETA_HAT:g}"
        )
    # u = theta/theta_0; V - V_0 = m g r theta_0 (1/(2 u^2) + u) up to a share of theta_0
    speed = np.sqrt(3.0 / b.M * theta_0 * (ratio - 1.0))  # at the bottom, where u = 1
    states = theta_to_states(disk, theta_0, speed * unit, eta / b.I1 * unit, 0.0)
    # The eta of these states is meant: its rounding shifts the turn by no more than terms of order theta_0.
    motion = states.motion._replace(rounding_plus=0.0 * ratio, rounding_minus=0.0 * ratio)
    found = periods(replace(states, given=motion), accuracy=_ACCURACY)
    above = (found.energy / disk.energy_unit - energy_at_flat(disk.body, motion.sigma3_bar)) / (1.5 * theta_0)
    return Rocking(disk, above, found.chi, found.theta_min, found.period, found.status, theta_0).reshaped(shape)

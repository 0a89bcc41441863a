"""Forces at the contact during passages: normal force and friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from explorer import compiled
from explorer.motion.vertical import starts_at_vertical
from explorer.phase.disk import Disk
from explorer.phase.states import Array


@dataclass(frozen=True)
class Forces:
    """Extremes of the forces during passages, one entry per sample: what `passage_forces` returns.

    Attributes
    ----------
    min_normal_force : (n,) array
        Least normal force, in m g. Where it is not positive a real disk would lift off.
    max_friction : (n,) array
        Largest coefficient of friction that rolling needs; infinite where the normal force is not positive.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.passage_forces(ex.Disk.uniform(), 1.0, 0.01, 1.0).max_friction
    array([inf])
    """

    min_normal_force: Array
    max_friction: Array


def passage_forces(disk: Disk, sigma3_bar: ArrayLike, eta_hat: ArrayLike, phidot: ArrayLike) -> Forces:
    """Forces at the contact during passages; they are the same on both faces.

    The motion is looked at on a grid, so the extremes are good to some digits.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar, eta_hat, phidot : array_like
        As for `passages`, units of the disk; they broadcast.

    Returns
    -------
    Forces
        Least normal force and largest friction, 1-D arrays; NaN where `passages` would not take the input.

    Raises
    ------
    InputError
        For arguments that are no numbers or do not broadcast, and for a disk with I3 = 0.

    Notes
    -----
    The force is m times the acceleration of the centre, whose velocity is eq. (2.33), plus the weight; section 8
    of the paper asks for it.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.passage_forces(ex.Disk.uniform(), 1.0, 0.01, 1.0).min_normal_force.round(2)
    array([-0.97])
    """
    starts = starts_at_vertical(disk, sigma3_bar, eta_hat, phidot)
    out = np.empty((2, starts.status.size))
    compiled.forces.forces_batch(starts.natural(disk), disk.natural, out)
    out[:, starts.status != compiled.status.Status.OK] = np.nan
    found = compiled.forces.ForceRow(*out)
    return Forces(min_normal_force=found.normal, max_friction=found.friction)

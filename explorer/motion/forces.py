"""Forces at the contact during passages: normal force and friction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.motion.arcs import next_inward
from explorer.motion.parts import blocks
from explorer.motion.passages_by_quadrature import from_vertical
from explorer.motion.vertical import Starts, starts_at_vertical
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk
from explorer.phase.results import Result
from explorer.phase.states import Array

KERNELS = "forces.forces_batch", "turning_points.inward_batch"  # for `compiled.warmup`


@dataclass(frozen=True, repr=False, eq=False)
class Forces(Result):
    """Extremes of the forces during passages, arrays of the arguments' shape: what `passage_forces` returns.

    Attributes
    ----------
    disk : Disk
        The body.
    sigma3_bar, eta_hat, phidot : array
        As given.
    min_normal_force : array
        Least normal force, in m g. Where it is not positive a real disk would lift off.
    max_friction : array
        Largest coefficient of friction that rolling needs; infinite where the normal force is not positive.
    status : array of int8
        `Status` of each sample.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.passage_forces(ex.Disk.uniform(), 1.0, 0.01, 1.0).max_friction
    array([inf])
    """

    disk: Disk
    sigma3_bar: Array
    eta_hat: Array
    phidot: Array
    min_normal_force: Array
    max_friction: Array
    status: NDArray[np.int8]

    _GIVEN = ("sigma3_bar", "eta_hat", "phidot")


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
        Least normal force and largest friction; NaN where `passages` would not take the input.

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
    (bar, eta, speed), shape = read_columns({"sigma3_bar": sigma3_bar, "eta_hat": eta_hat, "phidot": phidot})
    starts = starts_at_vertical(disk, bar, eta, speed, np.ones_like(bar))
    out = np.concatenate([_extremes(disk, starts.at(rows)) for rows in blocks(starts.status.size)], axis=1)
    out[:, starts.status != compiled.status.Status.OK] = np.nan
    found = compiled.forces.ForceRow(*out)
    code, falls = compiled.status.Status, starts.eta_hat == 0.0
    # No friction is enough where the table would have to pull; elsewhere an infinite one has overflowed.
    overflown = np.isnan(found.friction) | (np.isinf(found.friction) & (found.normal > 0.0))
    lost = (starts.status == code.OK) & (overflown | ~np.isfinite(found.normal))
    status = np.where(lost, np.where(falls, code.FALLS, code.NOT_FINITE), starts.status).astype(np.int8)
    out[:, lost] = np.nan
    flat = Forces(disk, bar, eta, speed, found.normal, found.friction, status)
    return flat.reshaped(shape)


def _extremes(disk: Disk, starts: Starts) -> Array:
    """(2, n): rows as ForceRow."""
    out, crossings = np.empty((2, starts.status.size)), starts.natural(disk)
    r = next_inward(disk, from_vertical(disk, crossings).starts).r
    compiled.forces.forces_batch(crossings, 2.0 * r / np.sqrt(1.0 + r * r), disk.natural, out)
    return out

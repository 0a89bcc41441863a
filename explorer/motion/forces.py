"""Forces at the contact during passages: normal force and friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.motion.arcs import from_place, next_inward, places
from explorer.motion.passage_starts import VerticalStarts, starts_at_vertical
from explorer.motion.passages_by_quadrature import from_vertical
from explorer.motion.threads import BLOCK, blocks
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.results import Result
from explorer.phase.states import Array

KERNELS = "turning_points.inward_batch", "turning_points.point_batch"  # for `compiled.warmup`
_POINTS = 400  # of a passage at which forces are looked at
_NEAR = 20.0  # in y: half of them lie within half of it from the turning point, half from the vertical


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
        Least normal force, in m g. If it is not positive, a real disk would lift off.
    max_friction : array
        Largest coefficient of friction that rolling needs; infinite where the normal force is not positive.
    status : array of int8
        `Status` of each sample.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.passage_forces(ex.Disk.uniform(), 1.0, 0.01, 1.0).max_friction
    np.float64(inf)
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

    The extremes are sought on a grid of points, and are good to a few digits.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar, eta_hat, phidot : array_like
        As for `passages`, units of the disk; they broadcast.

    Returns
    -------
    Forces
        Least normal force and largest friction; NaN where `passages` would refuse the input.

    Raises
    ------
    InputError
        For arguments that are not numbers or do not broadcast, and for a disk with I3 = 0.

    Notes
    -----
    The force is m times the acceleration of the centre, whose velocity is eq. (2.33), plus the weight. How large
    it is, is a question that section 8 of the paper raises.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.passage_forces(ex.Disk.uniform(), 1.0, 0.01, 1.0).min_normal_force.round(2)
    np.float64(-0.97)
    """
    (bar, eta, speed), shape = read_columns(sigma3_bar=sigma3_bar, eta_hat=eta_hat, phidot=phidot)
    starts = starts_at_vertical(disk, bar, eta, speed, np.ones_like(bar))
    groups = blocks(starts.status.size, BLOCK // _POINTS)
    normal, friction = np.concatenate([_extremes(disk, rows_of(starts, rows)) for rows in groups], axis=1)
    code, good = compiled.status.Status, starts.status == compiled.status.Status.OK
    # No friction is enough where the table would have to pull; elsewhere an infinite one has overflowed.
    overflown = np.isnan(friction) | (np.isinf(friction) & (normal > 0.0))
    lost = good & (overflown | ~np.isfinite(normal))
    status = np.where(lost, code.NOT_FINITE, starts.status).astype(np.int8)
    normal[lost | ~good] = friction[lost | ~good] = np.nan
    return Forces(disk, bar, eta, speed, normal, friction, status).reshaped(shape)


@np.errstate(all="ignore")  # of what has no passage, and overflows
def _extremes(disk: Disk, starts: VerticalStarts) -> Array:
    """Least normal forces and largest friction (2, n), on a grid in y, h = 2 sin(theta/2) = h_turn cosh y."""
    crossing = from_vertical(disk, starts.natural(disk)).starts
    turning = next_inward(disk, crossing)
    below = np.linspace(0.0, 0.5, _POINTS // 2, endpoint=False)
    above = np.linspace(0.5, 0.0, _POINTS // 2 + 1)
    h = 2.0 * turning.r[:, None] / np.sqrt(1.0 + turning.r[:, None] ** 2)
    end = np.arccosh(np.fmax(math.sqrt(2.0) / h, 1.0))
    span = np.fmin(_NEAR, end)
    risen = np.sinh(span * below) ** 2
    above_turning = 0.5 * (np.log1p(risen) - np.log1p(-0.25 * h * h * risen / (1.0 - 0.25 * h * h)))
    far = h * np.cosh(end - span * above)
    below_vertical = np.fmax(np.log(2.0 / far) + 0.5 * np.log1p(-0.25 * far * far), 0.0)
    here = []
    for start, d, inward in (
        (crossing, below_vertical, True),
        (from_place(crossing.X, crossing.Y, turning), above_turning, False),
    ):
        each = rows_of(start, np.repeat(np.arange(len(d)), d.shape[1]))
        found = _forces(disk, compiled.turning_points.Place(*places(disk, each, d.ravel(), inward)))
        here.append(found.reshape(2, *d.shape))
    normal, friction = np.concatenate(here, axis=2)
    return np.stack([normal.min(axis=1), friction.max(axis=1)])


def _forces(disk: Disk, at: compiled.turning_points.Place[Array]) -> Array:
    """Normal force and friction (2, n) at points.

    Centre of mass: a3 = sin theta, and (2.33) for the horizontal part, differentiated once more.
    """
    b, larger = disk.body, 1.0 + at.r * at.r
    q, z = 2.0 * at.r / larger, at.w / larger
    ratio, speed2 = at.sigma3 / q, 2.0 * b.inv_M * np.maximum(at.K, 0.0)
    acceleration = -b.inv_M * (b.J * ratio * at.sigma4 + z - b.I1 * z * ratio * (ratio / q))
    normal = 1.0 + z * acceleration - q * speed2
    along = q * acceleration + z * speed2 + ratio * at.sigma4 / q
    across = ratio * np.sqrt(speed2) * (1.0 - b.inv_J)
    return np.stack([normal, np.where(normal > 0.0, np.hypot(along, across) / normal, np.inf)])

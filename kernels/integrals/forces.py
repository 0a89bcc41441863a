"""What a passage asks of the contact: normal force and friction (not part of the paper's model)."""

import math
from typing import Generic, NamedTuple

from kernels._jit import kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.rows import Entry, put
from kernels.integrals.point import VERTICAL, Motion, motion_through, point
from kernels.near_flat.passages import Crossings
from kernels.types import Matrix, Vector

# Points per passage at which forces are looked at.
_FORCE_POINTS = 400
_NEAR = 20.0  # in y: half of the points lie within ten units of the turning point, half of the vertical


class ForceRow(NamedTuple, Generic[Entry]):
    """Normal force (in m g) and the friction coefficient needed, infinite where the force is not positive."""

    normal: Entry
    friction: Entry


@kernel
def forces_batch(crossings: Crossings, h_turn: Vector, disk: Disk, out: Matrix) -> None:
    """Least normal force and largest needed friction of every passage, face +1 -> out (2, n), rows as ForceRow.

    h_turn (n): at the turning point. Looked at on a grid in y and at both ends, so good to some digits.
    """
    b = disk.body
    for i in range(out.shape[1]):
        X, Y = crossings.sigma3_bar[i] / b.r0, crossings.eta[i] / b.I1
        out[:, i] = math.nan
        if h_turn[i] > 0.0:
            put(extremes(h_turn[i], motion_through(VERTICAL, crossings.speed[i], X, Y, disk), disk), out, i)


@subroutine
def extremes(h_turn: float, motion: Motion, disk: Disk) -> ForceRow[float]:
    """The least normal force and the largest friction of one passage."""
    y_end = math.acosh(max(VERTICAL / h_turn, 1.0))
    least, most = math.inf, 0.0
    for j in range(_FORCE_POINTS + 1):
        share = j / _FORCE_POINTS
        y = min(_NEAR * share, y_end * share) if share < 0.5 else y_end - min(_NEAR, y_end) * (1.0 - share)
        at = forces(h_turn * math.cosh(y), motion, disk)
        least, most = min(least, at.normal), max(most, at.friction)
    return ForceRow(least, most)


@subroutine
def forces(h: float, motion: Motion, disk: Disk) -> ForceRow[float]:
    """The forces at h.

    Centre of mass: a3 = sin theta, and (2.33) for the horizontal part, differentiated once more.
    """
    b = disk.body
    at = point(h, motion.X, motion.Y, disk)
    q, z = h * at.shape, 1.0 - at.S
    kinetic2 = 2.0 * b.inv_M * max(motion.level - at.V, 0.0)
    acceleration = -b.inv_M * at.slope * at.shape / h
    normal = 1.0 + z * acceleration - q * kinetic2
    along = acceleration * q + kinetic2 * z + at.ratio * at.sigma4 / q
    across = at.ratio * math.sqrt(kinetic2) * (1.0 - b.inv_J)
    return ForceRow(normal, math.hypot(along, across) / normal if normal > 0.0 else math.inf)

"""Whole orbits between two turning points: periods, and the smallest tilt without any integral."""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import Entry, put
from kernels.integrals import nodes
from kernels.integrals.point import VERTICAL, Motion, motion_through
from kernels.integrals.quadrature import PassageRow, Rules, Start, passage
from kernels.integrals.turning import turning_point, turning_point_outward
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_LIMIT = int(Status.STEP_LIMIT)
# V is measured from V_0; where V_0 exceeds the energy by more (I3 near 0), its rounding is felt.
_ROUNDING = 20.0 * 2.2e-16
_NOT_THERE = PassageRow(math.nan, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Orbits(NamedTuple):
    """States (n) on motions, as seen from their hemisphere.

    h and rate: 2 sin(theta/2) and theta-dot; near and far: eta of this and of the other face.
    """

    h: Vector
    rate: Vector
    sigma3_bar: Vector
    near: Vector
    far: Vector


class OrbitRow(NamedTuple, Generic[Entry]):
    """One period: smallest tilt from this and from the other face (NaN if never there), what a period adds to the
    angles and the time, energy, error of angles, relative error of time."""

    theta_here: Entry
    theta_there: Entry
    chi: Entry
    psi: Entry
    time: Entry
    energy: Entry
    angle_error: Entry
    time_error: Entry


@subroutine
def orbit(
    h0: float, motion: Motion, far: float, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float], PassageRow[float]]:
    """One whole period of a motion that passes h0 on face +1; far: its Y of the other face.

    Returns status, the passage of this face (or between both turning points) and that of the other
    face (chi = psi = time = 0 if the motion does not cross the vertical).
    """
    outer = turning_point_outward(h0, motion, disk)
    if outer > 0.0:
        status, here = passage(Start(outer, True, 0.0), motion, target, rules, disk, W)
        return status, here, _NOT_THERE
    mirrored = Motion(motion.X, far, motion.level)
    status, here = passage(Start(VERTICAL, False, 0.0), motion, target, rules, disk, W)
    other_status, there = passage(Start(VERTICAL, False, 0.0), mirrored, target, rules, disk, W)
    return max(status, other_status), here, there


@kernel
def orbit_batch(orbits: Orbits, target: float, rules: Rules, disk: Disk, out: Matrix, status: Codes) -> None:
    """`orbit` for every sample -> out (8, n), rows as OrbitRow.

    status (n): samples that come in as not OK are skipped.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        out[:, i] = math.nan
        if status[i] != _OK:
            continue
        X, Y = orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1
        motion = motion_through(orbits.h[i], orbits.rate[i], X, Y, disk)
        status[i], here, there = orbit(orbits.h[i], motion, orbits.far[i] / b.I1, target, rules, disk, W)
        period = OrbitRow(
            theta_here=here.theta_min,
            theta_there=there.theta_min,
            chi=here.chi + there.chi,
            psi=here.psi - there.psi,
            time=here.time + there.time,
            energy=here.energy,
            angle_error=here.angle_error + there.angle_error,
            time_error=max(here.time_error, there.time_error),
        )
        put(period, out, i)


@kernel
def tilt_batch(orbits: Orbits, target: float, disk: Disk, out: Vector, status: Codes) -> None:
    """Smallest tilt of every motion, from both of its turning points.

    A sample whose energy is not known to `target` times what it has above V_0 is STEP_LIMIT; those that
    come in as not OK are skipped.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        out[i] = math.nan
        if status[i] != _OK:
            continue
        h, rate, X, Y = orbits.h[i], orbits.rate[i], orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1
        motion = motion_through(h, rate, X, Y, disk)
        least = turning_point(h, rate == 0.0, motion, disk, W)
        if not turning_point_outward(h, motion, disk) > 0.0:
            mirrored = Motion(X, orbits.far[i] / b.I1, motion.level)
            least = min(least, turning_point(VERTICAL, False, mirrored, disk, W))
        out[i] = 2.0 * math.asin(0.5 * least)
        scale = potential_at_flat(X, b)
        if not (least > 0.0 and _ROUNDING * scale <= target * abs(motion.level + scale)):
            status[i] = _LIMIT

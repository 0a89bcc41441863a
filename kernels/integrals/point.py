"""The motion at one tilt, measured by h = 2 sin(theta/2) on face +1.

Everything near flat is written in h and ratios to it; S = h^2/2 may underflow.
"""

import math
from typing import Generic, NamedTuple

from kernels._jit import kernel, subroutine
from kernels.disk import chaplygin
from kernels.disk.body import Disk
from kernels.disk.falling import potential_above_flat
from kernels.disk.rows import Entry, put
from kernels.types import Matrix, Vector

_LN2 = math.log(2.0)
VERTICAL = math.sqrt(2.0)  # h there


class Motion(NamedTuple):
    """Constants of one motion: X = sigma3_bar / r(0), Y = eta_+ / I1, and level = E - V_0."""

    X: float
    Y: float
    level: float


class Point(NamedTuple, Generic[Entry]):
    """A tilt on a motion with constants (X, Y), face +1.

    shape: sqrt(1 - h^2/4) = cos(theta/2); D: dominant solution; ratio: sigma3/q; V: amended potential
    above V_0; slope: h dV/dh.
    """

    S: Entry
    shape: Entry
    D: Entry
    ratio: Entry
    sigma4: Entry
    V: Entry
    slope: Entry


@subroutine
def point(h: float, X: float, Y: float, disk: Disk) -> Point[float]:
    """The motion at 0 < h <= VERTICAL."""
    b = disk.body
    S = 0.5 * h * h
    f = chaplygin.solutions(S, 2.0 * math.log(h) - _LN2, b.c, disk.series)
    shape = math.sqrt(1.0 - 0.5 * S)
    smooth = 0.5 * X * f.rho_over_S * h
    ratio = (smooth + Y * f.D / h) / shape
    q, z = h * shape, 1.0 - S
    rise = (X * S * chaplygin.slope_excess(S, disk.series) + Y * f.dD) / b.k
    sigma4 = (X * f.drho + Y * f.dD) / b.k
    V, _spin = potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * X / b.k, q, b)
    slope = h / shape * (b.J * ratio * sigma4 + z) - b.I1 * z * ratio * ratio / (shape * shape)
    return Point(S, shape, f.D, ratio, sigma4, V, slope)


@subroutine
def motion_through(h: float, rate: float, X: float, Y: float, disk: Disk) -> Motion:
    """The motion with constants X, Y whose theta-dot is +-`rate` at h."""
    return Motion(X, Y, 0.5 * disk.body.M * rate * rate + point(h, X, Y, disk).V)


@kernel
def point_batch(h: Vector, X: float, Y: float, disk: Disk, out: Matrix) -> None:
    """`point` at every h (n) -> out (7, n), rows as Point."""
    for i in range(h.size):
        put(point(h[i], X, Y, disk), out, i)

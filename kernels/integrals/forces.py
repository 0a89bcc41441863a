"""What a passage asks of the contact: normal force and friction (not part of the paper's model)."""

import math

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body
from kernels.integrals import nodes
from kernels.integrals.quadrature import VERTICAL, point, turning_point
from kernels.types import Matrix, Vector

# Points per passage at which forces are looked at.
_FORCE_POINTS = 400


@kernel
def forces_batch(sigma3_bar: Vector, eta: Vector, speed: Vector, b: Body, series: Matrix, out: Matrix) -> None:
    """Least normal force (in m g) and largest needed friction coefficient of passages, face +1.

    Arguments as passage_batch. Looked at on a grid in y and at both ends, so good to some digits. The
    coefficient is infinite where the normal force is not positive. out (2, n).
    """
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(eta.size):
        X, Y = sigma3_bar[i] / b.r0, eta[i] / b.I1
        level = 0.5 * b.M * speed[i] * speed[i] + point(VERTICAL, X, Y, b, series).V
        h_turn = turning_point(VERTICAL, speed[i] == 0.0, level, X, Y, b, series, W)
        out[0, i] = out[1, i] = math.nan
        if not h_turn > 0.0:
            continue
        y_end = math.acosh(max(VERTICAL / h_turn, 1.0))
        least, most = math.inf, 0.0
        for j in range(_FORCE_POINTS + 1):
            # Half of the points within ten units of the turning point, half of the vertical.
            share = j / _FORCE_POINTS
            y = min(20.0 * share, y_end * share) if share < 0.5 else y_end - min(20.0, y_end) * (1.0 - share)
            normal, needed = forces(h_turn * math.cosh(y), level, X, Y, b, series)
            least, most = min(least, normal), max(most, needed)
        out[0, i], out[1, i] = least, most


@subroutine
def forces(h, level, X, Y, b, series):
    """(normal force / m g, needed friction coefficient) at h.

    Centre of mass: a3 = sin theta, and (2.33) for the horizontal part, differentiated once more.
    """
    at = point(h, X, Y, b, series)
    q, z = h * at.shape, 1.0 - at.S
    kinetic2 = 2.0 * b.inv_M * max(level - at.V, 0.0)
    acceleration = -b.inv_M * at.slope * at.shape / h
    normal = 1.0 + z * acceleration - q * kinetic2
    along = acceleration * q + kinetic2 * z + at.ratio * at.sigma4 / q
    across = at.ratio * math.sqrt(kinetic2) * (1.0 - b.inv_J)
    needed = math.hypot(along, across) / normal if normal > 0.0 else math.inf
    return normal, needed

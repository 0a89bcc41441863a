"""The variational equations: how the reduced flow stretches the phase space.

Four tangent vectors ride along with a state. Time is carried as well (t' = q), so that the derivative of
the flow at a fixed time follows by taking out of every vector what its difference in time has moved.
"""

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.disk.body import Body
from kernels.disk.field import State, column, reduced, reduced_state, speed
from kernels.steps.tableaux import DORMAND_PRINCE_853
from kernels.types import Matrix, Table

_STAGES = len(DORMAND_PRINCE_853.b)
_A = np.array([row + (0.0,) * (_STAGES - len(row)) for row in DORMAND_PRINCE_853.a])
_B = np.array(DORMAND_PRINCE_853.b)
# Rows q, z, p, rho, sigma4, t; column 0 is the state, the others are derivatives in phi, phidot, sigma3, sigma4.
_ROWS, _COLUMNS = 6, 5


@subroutine
def tangent_field(Y: Matrix, b: Body, out: Matrix) -> None:
    """d/ds of the state in column 0 of Y and of the tangent vectors in the others."""
    q, z, p, rho, s4 = Y[0, 0], Y[1, 0], Y[2, 0], Y[3, 0], Y[4, 0]
    out[0, 0], out[1, 0], out[2, 0], out[3, 0], out[4, 0] = reduced(reduced_state(q, z, p, rho, s4), b)
    out[5, 0] = q
    pull = b.J_over_M * (rho * s4) + b.inv_M * z
    for j in range(1, _COLUMNS):
        dq, dz, dp, drho, ds4 = Y[0, j], Y[1, j], Y[2, j], Y[3, j], Y[4, j]
        qp = dq * p + q * dp
        out[0, j] = dz * q * p + z * qp
        out[1, j] = -dq * q * p - q * qp
        dpull = b.J_over_M * (drho * s4 + rho * ds4) + b.inv_M * dz
        out[2, j] = b.inv_kappa2 * (dz * rho * rho + 2.0 * z * rho * drho) - dq * pull - q * dpull
        out[3, j] = b.k * (qp * s4 + q * p * ds4) - dz * rho * p - z * (drho * p + rho * dp)
        out[4, j] = b.inv_J * (qp * rho + q * p * drho)
        out[5, j] = dq


@subroutine
def begin(x: State, Y: Matrix) -> None:
    """The state and the unit vectors of phi, phidot, sigma3, sigma4: q = cos phi, p = -phidot, rho = sigma3/q."""
    Y[:, :] = 0.0
    Y[0, 0], Y[1, 0], Y[2, 0], Y[3, 0], Y[4, 0] = x.q, x.z, x.p, x.rho, x.sigma4
    Y[0, 1], Y[1, 1], Y[3, 1] = -x.z, x.q, x.rho * x.z / x.q
    Y[2, 2] = -1.0
    Y[3, 3] = 1.0 / x.q
    Y[4, 4] = 1.0


@subroutine
def at_fixed_time(Y: Matrix, b: Body, rate: Matrix, out: Matrix) -> None:
    """d(phi, phidot, sigma3, sigma4) at this time by the same at the start, out (4, 4)."""
    tangent_field(Y, b, rate)
    q, z, rho = Y[0, 0], Y[1, 0], Y[3, 0]
    for j in range(4):
        late = Y[5, j + 1] / q
        dq, dz = Y[0, j + 1] - late * rate[0, 0], Y[1, j + 1] - late * rate[1, 0]
        dp, drho = Y[2, j + 1] - late * rate[2, 0], Y[3, j + 1] - late * rate[3, 0]
        out[0, j] = q * dz - z * dq
        out[1, j] = -dp
        out[2, j] = rho * dq + q * drho
        out[3, j] = Y[4, j + 1] - late * rate[4, 0]


@device
def add(total: Matrix, weight: float, part: Matrix) -> None:
    """total += weight part."""
    for row in range(_ROWS):
        for j in range(_COLUMNS):
            total[row, j] += weight * part[row, j]


@maker  # an assignment of slices may copy
def advance(Y: Matrix, h: float, b: Body, X: Matrix, K: Table) -> None:
    """One step of length h in s, by the method of order 8; X and K are room for a state and for the stages."""
    for stage in range(_STAGES):
        X[:, :] = Y
        for before in range(stage):
            if _A[stage, before] != 0.0:
                add(X, h * _A[stage, before], K[before])
        tangent_field(X, b, K[stage])
    for stage in range(_STAGES):
        if _B[stage] != 0.0:
            add(Y, h * _B[stage], K[stage])


@kernel
def variation_batch(states: Matrix, h: float, steps: int, b: Body, out: Table, ends: Matrix) -> None:
    """Follow states (5, n), rows as State, for `steps` steps of h/speed in s.

    out (n, 4, 4): derivative of (phi, phidot, sigma3, sigma4) then by that at the start, at a fixed time; ends
    (6, n): the state there and its time, rows as State.
    """
    Y, X = np.empty((_ROWS, _COLUMNS)), np.empty((_ROWS, _COLUMNS))
    K = np.empty((_STAGES, _ROWS, _COLUMNS))
    for i in range(states.shape[1]):
        x = column(states, i)
        begin(x, Y)
        step = h / speed(x, b)
        for _ in range(steps):
            advance(Y, step, b, X, K)
        at_fixed_time(Y, b, X, out[i])
        ends[:, i] = Y[:, 0]

"""Constants of motion of many states, in lanes without a branch."""

import math

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import Solutions, solutions
from kernels.disk.constants import depth_below_vertical, from_solutions
from kernels.disk.field import energy, reduced_state
from kernels.types import Matrix, Vector

LANES = 64  # eight AVX-512 registers; columns of a block stay in the first cache
# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`. The state; its constants, six
# rows as Constants; the solutions at its tilt, five rows.
Q, Z, P, RHO, SIGMA4 = range(5)
CONSTANTS, SOLUTIONS, ROWS = 5, 11, 16


@device
def solutions_of(W: Vector, i: int) -> Solutions:
    """The solutions of lane i."""
    return Solutions(
        W[SOLUTIONS * LANES + i],
        W[(SOLUTIONS + 1) * LANES + i],
        W[(SOLUTIONS + 2) * LANES + i],
        W[(SOLUTIONS + 3) * LANES + i],
        W[(SOLUTIONS + 4) * LANES + i],
    )


@subroutine
def solve(W: Vector, disk: Disk) -> None:
    """The solutions at the tilts."""
    for i in range(LANES):
        q, z = W[Q * LANES + i], W[Z * LANES + i]
        S, log_S = depth_below_vertical(q, z)
        f = solutions(S, log_S, disk.body.c, disk.series)
        W[SOLUTIONS * LANES + i] = f.rho
        W[(SOLUTIONS + 1) * LANES + i] = f.drho
        W[(SOLUTIONS + 2) * LANES + i] = f.rho_over_S
        W[(SOLUTIONS + 3) * LANES + i] = f.D
        W[(SOLUTIONS + 4) * LANES + i] = f.dD


@subroutine
def constants(W: Vector, b: Body) -> None:
    """The constants of states from the solutions at their tilts."""
    for i in range(LANES):
        q, z, p = W[Q * LANES + i], W[Z * LANES + i], W[P * LANES + i]
        x = reduced_state(q if q > 0.0 else math.nan, z, p, W[RHO * LANES + i], W[SIGMA4 * LANES + i])
        found = from_solutions(x, solutions_of(W, i), energy(x, b), b)
        W[CONSTANTS * LANES + i] = found.sigma3_bar
        W[(CONSTANTS + 1) * LANES + i] = found.eta_plus
        W[(CONSTANTS + 2) * LANES + i] = found.eta_minus
        W[(CONSTANTS + 3) * LANES + i] = found.energy
        W[(CONSTANTS + 4) * LANES + i] = found.rounding_plus
        W[(CONSTANTS + 5) * LANES + i] = found.rounding_minus


@subroutine
def load(rows: Matrix, first: int, count: int, row: int, W: Vector) -> None:
    """Columns `first` ... of an array -> lanes, from `row` on."""
    for k in range(rows.shape[0]):
        for i in range(count):
            W[(row + k) * LANES + i] = rows[k, first + i]


@subroutine
def store(W: Vector, row: int, first: int, count: int, rows: Matrix) -> None:
    """Lanes, from `row` on -> columns `first` ... of an array."""
    for k in range(rows.shape[0]):
        for i in range(count):
            rows[k, first + i] = W[(row + k) * LANES + i]


@kernel
def constants_batch(states: Matrix, disk: Disk, out: Matrix) -> None:
    """states (5, n): q, z, p, rho, sigma4 -> out (6, n), rows as Constants. NaN where not q > 0."""
    n, W = states.shape[1], np.zeros(ROWS * LANES)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        load(states, first, count, 0, W)
        solve(W, disk)
        constants(W, disk.body)
        store(W, CONSTANTS, first, count, out)

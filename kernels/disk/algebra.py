"""Constants of motion of many states, in lanes without a branch."""

import math

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.chaplygin import Solutions, solutions
from kernels.disk.constants import MotionConstants, depth_below_vertical, from_solutions
from kernels.disk.field import energy, reduced_state
from kernels.records import reader, writer
from kernels.types import Matrix, Vector

LANES = 64  # eight AVX-512 registers; columns of a block stay in the first cache
# Rows of the work array: the state; its constants; the solutions at its tilt.
Q, Z, P, RHO, SIGMA4 = range(0, 5 * LANES, LANES)
CONSTANTS, SOLUTIONS, ROWS = 5 * LANES, 11 * LANES, 16 * LANES
read_constants, write_constants = reader(MotionConstants, LANES), writer(MotionConstants, LANES)
read_solutions, write_solutions = reader(Solutions, LANES), writer(Solutions, LANES)


@subroutine
def solve(W: Vector, disk: NaturalDisk) -> None:
    """The solutions at the tilts."""
    for i in range(LANES):
        q, z = W[Q + i], W[Z + i]
        S, log_S = depth_below_vertical(q, z)
        write_solutions(W, SOLUTIONS, i, solutions(S, log_S, disk.body.c, disk.series))


@subroutine
def constants(W: Vector, b: Body) -> None:
    """The constants of states from the solutions at their tilts."""
    for i in range(LANES):
        q, z, p = W[Q + i], W[Z + i], W[P + i]
        x = reduced_state(q if q > 0.0 else math.nan, z, p, W[RHO + i], W[SIGMA4 + i])
        found = from_solutions(x, read_solutions(W, SOLUTIONS, i), energy(x, b), b)
        write_constants(W, CONSTANTS, i, found)


@subroutine
def load(rows: Matrix, first: int, count: int, row: int, W: Vector) -> None:
    """Columns `first` ... of an array -> lanes, from `row` on."""
    for k in range(rows.shape[0]):
        for i in range(count):
            W[row + k * LANES + i] = rows[k, first + i]


@subroutine
def store(W: Vector, row: int, first: int, count: int, rows: Matrix) -> None:
    """Lanes, from `row` on -> columns `first` ... of an array."""
    for k in range(rows.shape[0]):
        for i in range(count):
            rows[k, first + i] = W[row + k * LANES + i]


@kernel
def constants_batch(states: Matrix, disk: NaturalDisk, out: Matrix) -> None:
    """states (5, n): q, z, p, rho, sigma4 -> out (6, n), rows as MotionConstants. NaN where not q > 0."""
    n, W = states.shape[1], np.zeros(ROWS)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        load(states, first, count, 0, W)
        solve(W, disk)
        constants(W, disk.body)
        store(W, CONSTANTS, first, count, out)

"""On which side of the falling set states are, and which could fall: many states judged in lanes.

What lanes cannot tell for rounding is told for one state at a time, by what judges single states.
"""

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.algebra import (
    CONSTANTS,
    LANES,
    ROWS,
    SOLUTIONS,
    Q,
    Z,
    constants,
    load,
    read_constants,
    read_solutions,
    solve,
    store,
)
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.chaplygin import Solutions
from kernels.disk.constants import nearer_minus
from kernels.disk.falling import (
    FALLS_BACK,
    PASSES,
    UNDECIDED,
    Obstacle,
    passes_barrier,
    potential_above_flat,
    potential_at_flat,
    rates_on_f,
    reaches_flat,
    tilt,
)
from kernels.types import Codes, Matrix, Vector

# Rows of the work array beyond those of `algebra`. NEAR and FAR: of the face on whose hemisphere the state is, and
# the other; first U, then verdicts.
_NEAR, _FAR, _CODE = range(ROWS, ROWS + 3 * LANES, LANES)
_SIGMA3_BAR, _ENERGY = CONSTANTS, CONSTANTS + 3 * LANES
_BEYOND = 3  # a verdict that awaits the barrier's
# Relative to their sum: an energy and a potential nearer than this are compared one state at a time.
_TIE = 1e-12
# Bits of a code. The nearer face is +1; there eta is 0 to rounding; there the disk could fall, were it 0; and
# whether it could on either face.
PLUS, ON_F, COULD, COULD_PLUS, COULD_MINUS = 1, 2, 4, 8, 16

_nearer_minus = device(nearer_minus)


@device
def part_of_spin(q: float, z: float, f: Solutions, b: Body) -> float:
    """U of V = X^2 U + q on F, where f are the solutions."""
    turn, sigma4 = rates_on_f(1.0, q, z, f, b)
    V, _spin = potential_above_flat(0.5 * b.I1 * (turn * q) * (turn * q), sigma4, 0.0, 0.0, b)
    return V


@subroutine
def at_tilts(W: Vector, b: Body) -> None:
    """U on either hemisphere."""
    for i in range(LANES):
        q, z, f = W[Q + i], abs(W[Z + i]), read_solutions(W, SOLUTIONS, i)
        W[_NEAR + i], W[_FAR + i] = part_of_spin(q, z, f, b), part_of_spin(q, -z, f, b)


@device
def verdict(E: float, V0: float, V: float, passing: float) -> float:
    """What energies decide; `passing` where they do not hinder."""
    # How far above both, in units of what rounding leaves open.
    above = min((E - V0) / (E + V0), (E - V) / (E + V))
    return (
        passing if above > _TIE else FALLS_BACK if above < -_TIE else UNDECIDED
    )  # also NaN, of infinite energies


@subroutine
def judge(W: Vector, b: Body) -> bool:
    """Verdicts; whether any of them awaits the barrier's."""
    waiting = 0
    for i in range(LANES):
        q, z, E = W[Q + i], W[Z + i], W[_ENERGY + i]
        X = W[_SIGMA3_BAR + i] / b.r0
        V0 = potential_at_flat(X, b)
        near, far = X * X * W[_NEAR + i] + q, X * X * W[_FAR + i] + q
        other = verdict(E, V0, far, _BEYOND if z != 0.0 else PASSES)
        W[_NEAR + i], W[_FAR + i] = verdict(E, V0, near, PASSES), other
        waiting += 1 if other == _BEYOND else 0
    return waiting > 0


@subroutine
def barriers(o: Obstacle, W: Vector, b: Body) -> None:
    """Verdicts on starts beyond the vertical that have the energy for flat."""
    for i in range(LANES):
        X = W[_SIGMA3_BAR + i] / b.r0
        passes, found = passes_barrier(-abs(W[Z + i]), W[_ENERGY + i], X, o), W[_FAR + i]
        W[_FAR + i] = passes if found == _BEYOND else found


@subroutine
def undecided(W: Vector) -> bool:
    """Whether rounding could decide in any lane."""
    odd = 0
    for i in range(LANES):
        odd += 1 if W[_NEAR + i] == UNDECIDED or W[_FAR + i] == UNDECIDED else 0
    return odd > 0


@subroutine
def look(row: int, hemisphere: float, o: Obstacle, disk: NaturalDisk, W: Vector) -> None:
    """Decide what lanes leave undecided, one at a time; hemisphere: 1 as of the state, -1 the other."""
    for i in range(LANES):
        if W[row + i] == UNDECIDED:
            at = tilt(W[Q + i], hemisphere * abs(W[Z + i]), disk)
            X = W[_SIGMA3_BAR + i] / disk.body.r0
            falls = reaches_flat(at, W[_ENERGY + i], X, o, disk)
            W[row + i] = PASSES if falls else FALLS_BACK


@subroutine
def encode(W: Vector) -> None:
    """Codes from constants and verdicts."""
    for i in range(LANES):
        north = W[Z + i] >= 0.0
        near, far = W[_NEAR + i] == PASSES, W[_FAR + i] == PASSES
        could_plus, could_minus = near if north else far, far if north else near
        found = read_constants(W, CONSTANTS, i)
        on_plus = abs(found.eta_plus) <= found.rounding_plus
        on_minus = abs(found.eta_minus) <= found.rounding_minus
        # On both lines it is the face on which the disk falls.
        both = on_plus and on_minus and could_plus != could_minus
        plus = could_plus if both else not _nearer_minus(found.eta_plus, found.eta_minus)
        code = (COULD_PLUS if could_plus else 0) + (COULD_MINUS if could_minus else 0) + (PLUS if plus else 0)
        code += (ON_F if (on_plus if plus else on_minus) else 0) + (
            COULD if (could_plus if plus else could_minus) else 0
        )
        W[_CODE + i] = code


@kernel
def membership_batch(
    states: Matrix, given: bool, obstacle: Obstacle, disk: NaturalDisk, out: Matrix, codes: Codes
) -> None:
    """states (5, n) as State -> their constants, out (6, n), rows as MotionConstants, and codes (n).

    given: the constants are in `out` already, and are taken as they are.
    """
    n, W = codes.size, np.ones(_CODE + LANES)
    for first in range(0, n, LANES):
        count = min(LANES, n - first)
        load(states, first, count, 0, W)
        solve(W, disk)
        if given:
            load(out, first, count, CONSTANTS, W)
        else:
            constants(W, disk.body)
            store(W, CONSTANTS, first, count, out)
        at_tilts(W, disk.body)
        if judge(W, disk.body):
            barriers(obstacle, W, disk.body)
        if undecided(W):
            look(_NEAR, 1.0, obstacle, disk, W)
            look(_FAR, -1.0, obstacle, disk, W)
        encode(W)
        for i in range(count):
            codes[first + i] = np.int8(W[_CODE + i])

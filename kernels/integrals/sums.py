"""Sums of rules in lanes: rows of the work array, and what a rule misses of what it adds up.

The last coefficients of each panel's Legendre series say how well it has converged, or a bound that is known
beforehand. A slow start is told apart: the same feature is in all integrals, and may hide from all coefficients.
"""

import math
from typing import NamedTuple

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.elementary import DEEPEST, exp_fall
from kernels.types import Vector

LANES = 64  # ROWS rows of them are 26 kB, within the first cache; 32 took a tenth longer in vectors of 512 bits
# The inner rule's error is told by the size of what it adds up, which for single motions nearly cancels.
_LEAST_SIZE = 0.02
TURNED = 40.0  # what an error of the turning point, about the square of Newton's last step, does to the angles
_LENIENT = 10.0  # as much as the accuracy asked may be missed by
_OF_START = 0.1  # what is missed of a slow start, in e^(-2 n sqrt(r)): no error of 500,000 was twice its estimate

# Rows of the work array: entry (row, i) stands at row * LANES + i, as in `batch`. Their order means nothing.
ROWS = 51
(
    # the sample; NOISE: of E - V, START: what it does at a slow start; LEAST: least theta-dot^2 met
    X, Y, SPEED, LEVEL, H_TURN, LOG_TURN, STEP, NOISE, START, LEAST,
    # results; CHECK: 0 where they stand, 1 where finer rules may do better, 2 where none here will
    CHI, REST, TIME, PSI, ANGLE_ERROR, TIME_ERROR, WAY, CHECK,
    # fields of Closed
    CAP, LOG_CAP, WIDTH, BELOW, TURN2, RACE, PULL, SPIN, SLOW, REST0, REST1,
    # of a panel, as in Gathered
    CHI_SIZE, CHI_LAST, CHI_LAST_BUT_ONE, REST_SIZE, REST_LAST, REST_LAST_BUT_ONE,
    TIME_SIZE, TIME_LAST, TIME_LAST_BUT_ONE,
    # fields of Place
    NODE, TAU, LOG_NODE, INV_NODE, INV_TAU2,
    # fields of Moving
    SMOOTH, DOMINANT, RATIO, SPIN_THERE, INV_SHAPE, ROOT,
    # of a slow start: kinetic energy at the vertical; square of how far from the rule's end the speed vanishes
    DEPARTED, ROOT2,
) = range(ROWS)  # fmt: skip


class Goal(NamedTuple):
    """Accuracy of angles (rad) and time (relative), and what rounding allows, relative to chi and to the time."""

    target: float
    floor: float


class Gathered(NamedTuple):
    """Rows of one integral: its sum, and of the latest panel the sum of sizes and the last two coefficients."""

    total: int
    size: int
    last: int
    last_but_one: int


OF_CHI = Gathered(CHI, CHI_SIZE, CHI_LAST, CHI_LAST_BUT_ONE)
OF_REST = Gathered(REST, REST_SIZE, REST_LAST, REST_LAST_BUT_ONE)
OF_TIME = Gathered(TIME, TIME_SIZE, TIME_LAST, TIME_LAST_BUT_ONE)
SUMS = (CHI, REST, TIME)
ERRORS = (ANGLE_ERROR, TIME_ERROR)
TAILS = (*OF_CHI[1:], *OF_REST[1:], *OF_TIME[1:])
MOVING = SPEED  # of falls, which leave the vertical with a kinetic energy; START is its rounding
FALLEN = (Y, *SUMS, *ERRORS, *TAILS)  # zero where a fall begins


@contracted_subroutine
def clear(W: Vector, rows: tuple[int, ...]) -> None:
    """Zeros in these rows."""
    for row in rows:
        for i in range(LANES):
            W[row * LANES + i] = 0.0


@contracted_device
def add(W: Vector, i: int, rows: Gathered, value: float) -> None:
    """Add a weighted value to the sum and to the panel's sum of sizes."""
    W[rows.total * LANES + i] += value
    W[rows.size * LANES + i] += abs(value)


@contracted_device
def gather(W: Vector, i: int, rows: Gathered, value: float, last: float, last_but_one: float) -> None:
    """As `add`, and to the panel's last two coefficients."""
    add(W, i, rows, value)
    W[rows.last * LANES + i] += value * last
    W[rows.last_but_one * LANES + i] += value * last_but_one


@contracted_device
def tail_of(W: Vector, i: int, rows: Gathered) -> float:
    """The sum of sizes of the last two coefficients."""
    return abs(W[rows.last * LANES + i]) + abs(W[rows.last_but_one * LANES + i])


@contracted_device
def remainder(W: Vector, i: int, rows: Gathered) -> float:
    """Error of a Gauss rule of n nodes from coefficients n - 1 and n - 2: of a geometric series about
    size * ratio^(2n), where they are size * ratio^n. Never more than they are themselves."""
    return tail_of(W, i, rows) * share_of_tail(W, i, rows)


@contracted_device
def share_of_tail(W: Vector, i: int, rows: Gathered) -> float:
    """The last coefficients over the sum of sizes, 1 at most."""
    share = tail_of(W, i, rows) / (W[rows.size * LANES + i] + 1e-300)  # never 0/0
    return share if share < 1.0 else 1.0


@contracted_subroutine
def told_by_coefficients(W: Vector) -> None:
    """Add the panel's errors as its last coefficients tell them, and clear its sums."""
    for i in range(LANES):
        chi, rest, time = remainder(W, i, OF_CHI), remainder(W, i, OF_REST), remainder(W, i, OF_TIME)
        W[ANGLE_ERROR * LANES + i] += 2.0 * (chi + rest)
        W[TIME_ERROR * LANES + i] += 2.0 * time
    clear(W, TAILS)


@contracted_subroutine
def told_by_the_worst(W: Vector, trust: float) -> None:
    """As `told_by_coefficients` for rules of some ten nodes.

    Two coefficients in turn may vanish by chance there: the largest share of all three integrals serves each. The
    error of a Gauss rule goes like its square; trust: how many times the square that is at most.
    """
    for i in range(LANES):
        chi, rest, time = share_of_tail(W, i, OF_CHI), share_of_tail(W, i, OF_REST), share_of_tail(W, i, OF_TIME)
        share = max(max(chi, rest), time)
        missed = trust * share * share
        W[ANGLE_ERROR * LANES + i] += missed * (W[CHI_SIZE * LANES + i] + W[REST_SIZE * LANES + i])
        W[TIME_ERROR * LANES + i] += missed * W[TIME_SIZE * LANES + i]
    clear(W, TAILS)


@contracted_device
def missed_of_start(nodes: int, root2: float) -> float:
    """What a rule of so many nodes misses of a slow start, as a share.

    Where the speed vanishes at i r from its end, what a rule misses falls like e^(-2 n sqrt(r)); root2: r^2. All
    its last coefficients may vanish by chance there.
    """
    fourth = 0.5 * nodes * math.sqrt(math.sqrt(root2))
    return _OF_START * exp_fall(fourth if fourth < DEEPEST else DEEPEST) ** 4


@contracted_subroutine
def told_by_the_start(W: Vector, nodes: int) -> None:
    """Add what a rule of so many nodes misses of slow starts."""
    for i in range(LANES):
        missed = missed_of_start(nodes, W[ROOT2 * LANES + i])
        W[ANGLE_ERROR * LANES + i] += missed * (W[CHI_SIZE * LANES + i] + W[REST_SIZE * LANES + i])
        W[TIME_ERROR * LANES + i] += missed * W[TIME_SIZE * LANES + i]


@contracted_subroutine
def told_by_size(W: Vector, missed: float, spun: float) -> None:
    """Add the errors of an inner rule that misses this share of what it adds up, and clear its sums."""
    for i in range(LANES):
        size = W[CHI_SIZE * LANES + i] + spun * (W[REST_SIZE * LANES + i] + W[TIME_SIZE * LANES + i])
        error = missed * (size + _LEAST_SIZE) + TURNED * W[STEP * LANES + i] * W[STEP * LANES + i]
        W[ANGLE_ERROR * LANES + i] += error
        W[TIME_ERROR * LANES + i] += error
    clear(W, TAILS)


@contracted_subroutine
def finish(W: Vector, target: float, floor: float) -> None:
    """There and back in CHI, REST, PSI and TIME, errors with rounding; CHECK is 0 where they meet the
    target, or the floor relative to chi and to the time."""
    for i in range(LANES):
        chi, rest, time = 2.0 * W[CHI * LANES + i], 2.0 * W[REST * LANES + i], 2.0 * W[TIME * LANES + i]
        noise = W[NOISE * LANES + i]
        angle_error = 2.0 * W[ANGLE_ERROR * LANES + i] + noise * (abs(chi) + abs(rest))
        time_error = 2.0 * W[TIME_ERROR * LANES + i] / time + noise
        W[CHI * LANES + i], W[PSI * LANES + i], W[TIME * LANES + i] = chi, chi - rest, time
        W[ANGLE_ERROR * LANES + i], W[TIME_ERROR * LANES + i] = angle_error, time_error
        size = abs(chi) if abs(chi) > 1.0 else 1.0
        # What is within the floor and still too far off has to be left to other rules.
        lenient = _LENIENT * target if _LENIENT * target > floor else floor
        rounded = floor * size if floor * size < lenient else lenient
        angle_target = rounded if rounded > target else target
        time_target = floor if floor > target else target
        good = (angle_error <= angle_target) & (time_error <= time_target) & (W[LEAST * LANES + i] > 0.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else max(W[CHECK * LANES + i], 1.0)

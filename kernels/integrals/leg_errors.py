"""What the rules of legs miss, in lanes, as measured on 10^5 legs of eight bodies; and the rows of these lanes."""

import math

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.body import Body
from kernels.disk.elementary import DEEPEST, exp_fall
from kernels.integrals import sums
from kernels.integrals.point import VERTICAL, Motion
from kernels.integrals.sums import (
    ANGLE_ERROR,
    CHI,
    LANES,
    LEVEL,
    NOISE,
    OF_CHI,
    OF_REST,
    OF_TIME,
    REST,
    TAILS,
    TIME_ERROR,
    clear,
    share_of_tail,
)
from kernels.types import Vector

_DEEP = 8.0  # in y
# Rules miss so much of the square of the share that their last coefficients have, and so much more over the fourth
# power of the nodes on a unit of y.
_MISSED, _SPARSE = 0.06, 8.0
# Where a motion is slow at its end, more by so many squares of that share, but at most so much of it: the square
# of the first over how near the end of the panel comes to where the motion would turn back, or of the second over
# E - V there, whichever is larger; the third over how steeply V rises where it does turn.
_NEAR, _LITTLE, _LEVEL = 0.006, 0.01, 0.001
_NEAREST, _MOST_MISSED = 1e-7, 0.05
_SPUN = 10.0  # times h at the turning point: where spin changes the race by more, it is that which counts
_LEAST = 1e-300  # of what is divided by
_ROUND = 16.0  # kappa up to which the tables of a body hold its races as well as its rules tell
# Beside the turning point, of the angle of the race and of h there: six times the largest that was seen.
_TURN_RATE, _TURN_SHARE = 4.36, 6.0
_OFF_WALL = 1.0 / 3.0  # by gravity alone 2 E/slope - 1 is 3 h over the slope

# Rows beside those of `sums`: ends in h, and where the motion turns back beyond the outer one (0: not known);
# E - V there and how much further in y it would go; what `at_depth` takes; y there and below the
# panel; the panel; the closed part; rounding of E - V; how slow the motion is at its end, as `slowness`; what is
# left of the race beside the turning point, as `beside_turn`.
(
    H_TURN, H_END, H_BEYOND, MOVING, FURTHER, LOG_TURN, LOG_END, CAP, LOG_CAP, TURN2, Y_END, BELOW,
    REACH, ANGLE, SINE_END, CLOSED, RACE, ROUNDING, SLOW, BESIDE_TURN,
) = range(sums.ROWS, sums.ROWS + 20)  # fmt: skip
ROWS = sums.ROWS + 20


@contracted_device
def slowness(W: Vector, i: int, slope: float) -> float:
    """How many squares of the share of the last coefficients a leg misses because it ends slowly.

    slope: h dV/dh at its end. Energies count as parts of |E - V_0| + 1. Of a way from a state only the time is
    wanted, which this does not change.
    """
    whole, moving = abs(W[LEVEL * LANES + i]) + 1.0, W[MOVING * LANES + i]
    near = min((1.0 - W[SINE_END * LANES + i]) / _NEAR, moving / (_LITTLE * whole))
    near = near if near > _NEAREST else _NEAREST
    level = _LEVEL * whole / max(abs(slope), _NEAREST)
    slow = 1.0 / (near * near) if moving > 0.0 else level
    return slow if (moving == 0.0) | (W[H_END * LANES + i] >= VERTICAL) else 0.0


@contracted_device
def beside_turn(h: float, level: float, slope: float, motion: Motion) -> float:
    """What is left of the race after its closed part, beside a turning point at h, as a share of the race.

    slope: -h dV/dh there. It is of the order of h where E - V_0 is of the order of 1. A motion of little energy
    near flat has two turning points that are both small, and what counts is h over the other one: V less its wall
    against all of V. Were V all wall, the slope would be twice the level.
    """
    other = _OFF_WALL * abs(2.0 * level / slope - 1.0)
    # What a fast spin adds to sigma3 at the turning point, as a part of it, may be far more than h.
    spun = 0.5 * abs(motion.X) * h * h / (abs(motion.Y) + _LEAST)
    own = spun if spun > _SPUN * h else h
    return other if other > own else own


@contracted_subroutine
def tell_errors(W: Vector, size: int) -> None:
    """Add the errors of a rule of `size` nodes as its last coefficients tell them.

    The largest share of all three integrals serves each. Coefficients that fall like ratio^k leave the square of
    their share: a part of it, the larger the further apart nodes lie. On a very long way, whose turning point
    stands apart from all else, a small part of the integrand falls more slowly than the rest, and the share is of
    that. Where a motion is slow at its end, coefficients oscillate or fall off late, and two in turn may be small.
    """
    for i in range(LANES):
        chi, rest, time = share_of_tail(W, i, OF_CHI), share_of_tail(W, i, OF_REST), share_of_tail(W, i, OF_TIME)
        share = max(max(chi, rest), time)
        apart = W[Y_END * LANES + i] / size
        trust = _MISSED + _SPARSE * (apart * apart) * (apart * apart)
        slow = min(W[SLOW * LANES + i] * share, _MOST_MISSED)
        missed = share * (max(math.sqrt(share), slow) if W[Y_END * LANES + i] > _DEEP else trust * share + slow)
        W[ANGLE_ERROR * LANES + i] += missed * (W[OF_CHI.size * LANES + i] + W[OF_REST.size * LANES + i])
        W[TIME_ERROR * LANES + i] += missed * W[OF_TIME.size * LANES + i]
    clear(W, TAILS)


@contracted_subroutine
def tell_turn(W: Vector, size: int) -> None:
    """Add what a rule of `size` nodes misses beside the turning point.

    What is left of the race after its closed part, as `beside_turn` has it, is there over a length of 1 in y: too
    small for the last coefficients to tell, and all that is left where the way is long. It falls off with the
    nodes on such a length, as measured. They are closer where the panel ends far from a second turning point.
    """
    for i in range(LANES):
        closer = W[ANGLE * LANES + i] / (0.5 * math.pi) if W[Y_END * LANES + i] < _DEEP else 1.0
        resolved = 0.25 * _TURN_RATE * size / (W[REACH * LANES + i] * closer)
        unseen = exp_fall(resolved if resolved < DEEPEST else DEEPEST)
        unseen *= unseen
        unseen *= unseen
        W[ANGLE_ERROR * LANES + i] += _TURN_SHARE * abs(W[RACE * LANES + i]) * W[BESIDE_TURN * LANES + i] * unseen


@contracted_subroutine
def tell_thin(W: Vector, b: Body) -> None:
    """Make errors of angles larger where kappa is: tables and closed forms hold a race to a share of it."""
    over = b.kappa / _ROUND - 1.0
    if over > 0.0:
        for i in range(LANES):
            turned = abs(W[CHI * LANES + i]) + abs(W[REST * LANES + i])
            error = W[ANGLE_ERROR * LANES + i]
            W[ANGLE_ERROR * LANES + i] = error + over * (error + W[NOISE * LANES + i] * turned)

"""The constant of the law of races, of many passages in one pass.

Beside F a race angle is sgn(eta) kappa pi + K eta (ln(1/|eta|) - c) + ..., with K = 2 m g r/(I1 M A^3) for the
impact speed A.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body
from kernels.disk.counting import LARGEST
from kernels.types import Longs, Vector

LANES = 64  # as in `algebra`
# Rows of the work array: what is given, and what is found.
_ETA_HAT, _RACE, _ERROR, _SIZE, _CUBE, _LOG, _CONSTANT, _DOUBT = range(8)
_ROWS = 8
_ROUNDING = 1e-12  # rad; a deviation is known to some 1e-15, and its law to a percent from here on


class Races(NamedTuple):
    """Passages (n): eta_hat, race angle and its error (rad); |eta|, A^3 and ln(1/|eta|) in natural units."""

    eta_hat: Vector
    race: Vector
    error: Vector
    size: Vector
    cube: Vector
    log: Vector


@subroutine
def load(values: Vector, row: int, W: Vector) -> None:
    """One row of the work array. Of a slice all indices count from its start, so it is copied in lanes."""
    room = W[row * LANES : (row + 1) * LANES]
    for i in range(values.size):
        room[i] = values[i]


@subroutine
def lanes(W: Vector, limit: float, inertia: float) -> None:
    """Constants and doubts from what is given."""
    for i in range(LANES):
        eta_hat, size = W[_ETA_HAT * LANES + i], W[_SIZE * LANES + i]
        side = 1.0 if eta_hat > 0.0 else -1.0 if eta_hat < 0.0 else 0.0
        scale = 2.0 / (inertia * W[_CUBE * LANES + i]) * size
        c = W[_LOG * LANES + i] - side * (W[_RACE * LANES + i] - side * limit) / scale
        good = (abs(c) <= LARGEST) & (scale > _ROUNDING)
        W[_CONSTANT * LANES + i] = c if good else math.nan
        W[_DOUBT * LANES + i] = W[_ERROR * LANES + i] * size / scale


@subroutine
def in_lanes(
    races: Races, limit: float, inertia: float, constant: Vector, doubt: Vector, known: Longs, W: Vector
) -> None:
    """`constant_batch`."""
    count = known[0]
    for begin in range(0, constant.size, LANES):
        end = min(begin + LANES, constant.size)
        load(races.eta_hat[begin:end], _ETA_HAT, W)
        load(races.race[begin:end], _RACE, W)
        load(races.error[begin:end], _ERROR, W)
        load(races.size[begin:end], _SIZE, W)
        load(races.cube[begin:end], _CUBE, W)
        load(races.log[begin:end], _LOG, W)
        lanes(W, limit, inertia)
        for i in range(end - begin):
            c = W[_CONSTANT * LANES + i]
            constant[begin + i] = c
            doubt[count] = W[_DOUBT * LANES + i]
            count += 1 if c == c else 0
    known[0] = count


@kernel
def constant_batch(races: Races, limit: float, b: Body, constant: Vector, doubt: Vector, known: Longs) -> None:
    """c of each passage -> constant (n); NaN where it is not finite, or where rounding is felt in the deviation.

    limit: kappa pi. doubt: of each constant that is known, one after the other, |eta| at which its error would be
    1, from place known (1) on; how many there are then -> known.
    """
    in_lanes(races, limit, b.I1 * b.M, constant, doubt, known, np.empty(_ROWS * LANES))

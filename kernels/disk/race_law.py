"""The constant of the law of races, of many passages in one pass.

Beside F a race angle is sgn(eta) kappa pi + K eta (ln(1/|eta|) - c) + ..., with K = 2 m g r/(I1 M A^3) for the
impact speed A.
"""

import math
from typing import NamedTuple

from kernels._jit import kernel
from kernels.disk.body import Body
from kernels.disk.counting import LARGEST
from kernels.types import Longs, Vector

_ROUNDING = 1e-12  # rad; a deviation is known to some 1e-15, and its law to a percent from here on


class Races(NamedTuple):
    """Passages (n): eta_hat, race angle and its error (rad); |eta|, A^3 and ln(1/|eta|) in natural units."""

    eta_hat: Vector
    race: Vector
    error: Vector
    size: Vector
    cube: Vector
    log: Vector


@kernel
def constant_batch(races: Races, limit: float, b: Body, constant: Vector, doubt: Vector, known: Longs) -> None:
    """c of each passage -> constant (n); NaN where it is not finite, or where rounding is felt in the deviation.

    limit: kappa pi. doubt: of each constant that is known, one after the other, |eta| at which its error would be
    1; how many there are -> known (1).
    """
    count = 0
    for i in range(constant.size):
        eta_hat, size = races.eta_hat[i], races.size[i]
        side = 1.0 if eta_hat > 0.0 else -1.0 if eta_hat < 0.0 else 0.0
        scale = 2.0 / (b.I1 * b.M * races.cube[i]) * size
        c = races.log[i] - side * (races.race[i] - side * limit) / scale
        good = (abs(c) <= LARGEST) & (scale > _ROUNDING)
        constant[i] = c if good else math.nan
        doubt[count] = races.error[i] * size / scale
        count += 1 if good else 0
    known[0] = count

"""What the ways between a turning point and an end need of the body, computed once: tilts to try, series, rules.

Any motion is looked at on fixed tilts from the vertical down, where sigma_3 and sigma_4 are X and Y times numbers
of the body, so that its turning points are bracketed without a series. The rules of `legs` are the same for all.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numba import float64
from numba import types as nb

from kernels._jit import contracted_device
from kernels.disk.body import Disk
from kernels.disk.chaplygin import DEGREE
from kernels.integrals.point import VERTICAL
from kernels.integrals.tables import at_tilts, coefficients
from kernels.types import Longs, Matrix

TILTS = 24  # tried: as many as `turning` looks at for a single motion
# Rows of the table of rules.
NODE, WEIGHT, EVEN, EVEN_BUT_ONE = range(4)

WidePowers = Annotated[tuple[float, ...], nb.UniTuple(float64, DEGREE + 1)]


class Wide(NamedTuple):
    """Chaplygin's series for S <= 1, ascending powers of 2 S - 1; rho' is 1 + S excess."""

    rho_over_S: WidePowers
    v: WidePowers
    dv: WidePowers
    excess: WidePowers


class Tilt(NamedTuple):
    """A tilt to try: rows of a table. ratio_x to height as in `tables.Fixed`; z: cos theta."""

    ratio_x: float
    ratio_y: float
    rise_x: float
    rise_y: float
    height: float
    z: float
    h: float
    theta: float


@contracted_device
def tilt(table: Matrix, k: int) -> Tilt:
    """Tilt k of a table."""
    ratio_x, ratio_y, rise_x, rise_y = table[0, k], table[1, k], table[2, k], table[3, k]
    return Tilt(ratio_x, ratio_y, rise_x, rise_y, table[4, k], table[5, k], table[6, k], table[7, k])


class LegTables(NamedTuple):
    """Tables of one body: tilts (8, TILTS) from flat to the vertical; rules (4, n), from few nodes to many."""

    wide: Wide
    tilts: Matrix
    rules: Matrix
    sizes: Longs


def make_leg_tables(disk: Disk, rules: tuple[np.ndarray, ...]) -> LegTables:
    """Tables for the legs of a disk. rules: Gauss rules (2, 2n) on [-1, 1], whose positive halves are used."""
    g, _drho, v, dv, excess = (tuple(map(float, row)) for row in disk.series)
    h = VERTICAL * np.arange(1, TILTS + 1) / TILTS
    theta = 2.0 * np.arcsin(0.5 * h)
    rows = at_tilts(disk, theta, np.zeros(TILTS))
    tilts = np.concatenate([rows[:5], np.cos(theta)[None], h[None], theta[None]])
    halves = [_half(rule) for rule in rules]
    return LegTables(
        Wide(g, v, dv, excess),
        np.ascontiguousarray(tilts),
        np.ascontiguousarray(np.concatenate(halves, axis=1)),
        np.array([half.shape[1] for half in halves], np.int64),
    )


def _half(rule: np.ndarray) -> np.ndarray:
    """The positive half of a symmetric rule, and factors that turn it into even Legendre coefficients."""
    degree, half = rule.shape[1] - 2, rule.shape[1] // 2
    return np.concatenate([rule, coefficients(rule, (degree, degree - 2))])[:, half:]

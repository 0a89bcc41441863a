"""Whole motions from turning point to turning point, in lanes: what `bounces` and `periods` ask for first."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.passages_by_quadrature import (
    chord,
    departures_beside,
    departures_of_energy,
    near_flat,
    table_kernel,
    unanswered,
)
from explorer.phase.disk import Disk
from explorer.phase.gauss import packed_rules
from explorer.phase.states import Array

# The rule to begin with at accuracies down to each of these, for ways of middling length: few need a larger one.
# A power of ten may be rounded down.
_FIRST = (
    (0.9e-2, 4), (0.9e-3, 5), (0.9e-4, 5), (0.9e-5, 6), (0.9e-6, 6),
    (0.9e-7, 8), (0.9e-8, 9), (0.9e-9, 10), (0.0, 11),
)  # fmt: skip
# The kernels of `falls_of_energy`, for `compiled.warmup`.
FALL_KERNELS = ("passages.fall_batch", "low_falls.low_fall_batch", "passages.fall_by_rules_batch")


class Legs(NamedTuple):
    """Ends of motions, and their legs (5, kinds * n), NaN where lanes do not settle them."""

    ends: "compiled.ends.Ends"
    legs: Array


def first_rule(accuracy: float) -> int:
    """The rule for legs to begin with."""
    return next(rule for least, rule in _FIRST if accuracy >= least)


def leg_kernels(accuracy: float) -> tuple[str, ...]:
    """The kernels of `legs_of` at an accuracy, for `compiled.warmup`."""
    return "ends.end_batch", "legs.leg_batch", table_kernel(accuracy)


def legs_of(
    disk: Disk, orbits: "compiled.point.Orbits", status: NDArray[np.int8], accuracy: float, kinds: int
) -> Legs:
    """The legs of motions. kinds: 2 for the passages of both faces, 3 for the way from the state as well."""
    n, tables = status.size, disk.leg_tables
    rows = np.empty((5, n))
    compiled.ends.end_batch(orbits, tables, disk.natural, rows, status)
    ends = compiled.ends.Ends(*rows)
    legs = np.full((5, kinds * n), np.nan)
    _near_flat(disk, orbits, ends, accuracy, legs)
    compiled.legs.leg_batch(orbits, ends, first_rule(accuracy), accuracy, tables, disk.natural, legs)
    return Legs(ends, legs)


def _near_flat(
    disk: Disk, orbits: "compiled.point.Orbits", ends: "compiled.ends.Ends", accuracy: float, legs: Array
) -> None:
    """Fill in the passages that the tables of `passages` serve, which are at home near flat."""
    n, code = ends.level.size, compiled.status.Status
    speed = np.sqrt(2.0 * disk.body.inv_M * ends.moving)
    for block, (eta, h) in enumerate(((orbits.near, ends.here), (orbits.far, ends.there))):
        served = np.isfinite(speed) & (h < compiled.tabulated.WIDEST)
        if not served.any():
            continue
        rows = np.flatnonzero(served)
        out, status = np.empty((8, rows.size)), np.full(rows.size, code.OK, np.int8)
        crossings = compiled.passages.Crossings(orbits.sigma3_bar[rows], eta[rows], speed[rows])
        near_flat(disk, crossings, accuracy, out, status)
        found = compiled.quadrature.PassageRow(*out)
        kept = found.chi, found.psi, found.time, found.angle_error, found.time_error
        legs[:, block * n + rows] = kept


def falls_of_energy(
    disk: Disk,
    sigma3_bar: Array,
    energy: Array,
    accuracy: float,
    orbits: "compiled.point.Orbits | None" = None,
) -> "compiled.quadrature.FallRow[Array]":
    """The falls on F of these constants, from the vertical or from rest below it; accuracy: of there and back.

    orbits: states of these motions; one at the vertical tells better than its energy how fast the fall begins.
    """
    out = np.empty((4, sigma3_bar.size))
    given = np.ascontiguousarray(sigma3_bar), np.ascontiguousarray(energy)
    departures = departures_of_energy(disk, *given)
    if orbits is not None:
        here = departures_beside(disk, compiled.passages.Crossings(given[0], orbits.near, abs(orbits.rate)))
        upright = (orbits.z == 0.0) & np.isfinite(energy)
        columns = (np.where(upright, *pair) for pair in zip(here, departures, strict=True))
        departures = compiled.passages.Departures(*columns)
    compiled.passages.fall_batch(departures, accuracy, disk.tables, disk.natural, out)
    asked = np.isfinite(energy)
    if unanswered(out, asked):
        first, tables = first_rule(accuracy), disk.leg_tables
        compiled.low_falls.low_fall_batch(*given, first, accuracy, tables, disk.natural, out)
    if unanswered(out, asked):
        compiled.passages.fall_by_rules_batch(departures, chord(0.0), packed_rules(), disk.natural, out)
    return compiled.quadrature.FallRow(*out)

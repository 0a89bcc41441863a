"""Whole motions from turning point to turning point, in lanes: what `bounces` and `periods` ask for first."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.passages_by_quadrature import (
    chord,
    departures_beside,
    departures_of_energy,
    departures_of_moving,
    near_flat,
    table_kernel,
    unanswered,
)
from explorer.motion.starts import told_upright
from explorer.phase.disk import Disk
from explorer.phase.gauss import packed_rules
from explorer.phase.states import Array

# The rule to begin with at accuracies down to each of these, for ways of middling length: few need a larger one.
# A power of ten may be rounded down.
_FIRST = (
    (0.9e-2, 4), (0.9e-3, 5), (0.9e-4, 5), (0.9e-5, 6), (0.9e-6, 7),
    (0.9e-7, 8), (0.9e-8, 8), (0.9e-9, 9), (0.0, 10),
)  # fmt: skip
# Of the accuracy: rounding of the energy at the vertical that is not felt.
_UNFELT = 1e-3
# So many rules further on for bodies from each kappa on: their coefficients fall off later, or sooner. Where
# kappa is very large, later on some ways only.
_OF_KAPPA = (16.0, 0), (4.0, 1), (1.2, 0), (0.0, -1)
# The kernels of `falls_of_energy`, for `compiled.warmup`.
FALL_KERNELS = (
    *("passages.departure_batch", "passages.fall_batch"),
    *("low_falls.low_fall_batch", "passages.fall_by_rules_batch"),
)


class Legs(NamedTuple):
    """Ends of motions, and their legs (5, kinds * n), NaN where lanes do not settle them.

    upright: whether what they leave is told from the vertical.
    """

    ends: "compiled.ends.Ends"
    legs: Array
    upright: NDArray[np.bool_]


def first_rule(disk: Disk, accuracy: float) -> int:
    """The rule for legs of a disk to begin with."""
    rule = next(rule for least, rule in _FIRST if accuracy >= least)
    return rule + next(more for least, more in _OF_KAPPA if disk.kappa >= least)


def leg_kernels(accuracy: float) -> tuple[str, ...]:
    """The kernels of `legs_of` at an accuracy, for `compiled.warmup`."""
    return "ends.end_batch", "legs.leg_batch", table_kernel(accuracy)


def legs_of(
    disk: Disk,
    orbits: "compiled.point.Orbits",
    status: NDArray[np.int8],
    accuracy: float,
    kinds: int,
    first_only: bool = False,
) -> Legs:
    """The legs of motions. kinds: 2 for the passages of both faces, 3 for the way from the state as well.

    first_only: motions on their way to this face leave out the other one, whose flattest tilt is NaN then.
    """
    n, tables = status.size, disk.leg_tables
    rows = np.empty((5, n))
    compiled.ends.end_batch(orbits, tables, disk.natural, rows, status)
    ends = compiled.ends.Ends(*rows)
    upright, rounding = told_upright(disk, orbits, np.isfinite(ends.here) & np.isnan(ends.moving))
    if upright.any():
        # Lanes measure potentials from flat, and count the rounding of that on their own face alone.
        rows[:, upright & (rounding > _UNFELT * accuracy * np.minimum(ends.moving, 1.0))] = np.nan
    if first_only:
        ends = ends._replace(there=np.where(orbits.rate <= 0.0, np.nan, ends.there))
    legs = np.full((5, kinds * n), np.nan)
    _near_flat(disk, orbits, ends, accuracy, legs)
    compiled.legs.leg_batch(orbits, ends, first_rule(disk, accuracy), accuracy, tables, disk.natural, legs)
    return Legs(ends, legs, upright)


def motions_by_rules(
    kernel: Callable[..., None],
    disk: Disk,
    orbits: "compiled.point.Orbits",
    upright: NDArray[np.bool_],
    accuracy: float,
    out: Array,
    status: NDArray[np.int8],
) -> None:
    """Whole motions that are still NaN in `out`, by `orbit_batch` or `bounce_batch`, one after the other."""
    code = compiled.status.Status
    for natural, told in ((disk.natural, ~upright), (disk.upright, upright)):
        asked = told & (status == code.OK)
        if unanswered(out, asked):
            found = np.where(asked, status, code.STEP_LIMIT).astype(np.int8)
            kernel(orbits, accuracy, packed_rules(), natural, out, found)
            status[asked] = found[asked]


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


def _replaced(
    old: "compiled.passages.Departures", new: "compiled.passages.Departures", rows: NDArray[np.bool_]
) -> "compiled.passages.Departures":
    """Departures, the new ones in some rows."""
    return compiled.passages.Departures(*(np.where(rows, *pair) for pair in zip(new, old, strict=True)))


def falls_of_energy(
    disk: Disk,
    sigma3_bar: Array,
    energy: Array,
    accuracy: float,
    orbits: "compiled.point.Orbits | None" = None,
    moving: Array | None = None,
) -> "compiled.quadrature.FallRow[Array]":
    """The falls on F of these constants, from the vertical or from rest below it; accuracy: of there and back.

    orbits: states of these motions; one at the vertical tells better than its energy how fast the fall begins.
    moving: E - V of these motions at the vertical, NaN where that is not known better than by the energy.
    """
    out = np.empty((4, sigma3_bar.size))
    given = np.ascontiguousarray(sigma3_bar), np.ascontiguousarray(energy)
    departures = departures_of_energy(disk, *given)
    if orbits is not None:
        here = departures_beside(disk, compiled.passages.Crossings(given[0], orbits.near, abs(orbits.rate)))
        upright = (orbits.z == 0.0) & np.isfinite(energy)
        departures = _replaced(departures, here, upright)
        if moving is not None and (known := np.isfinite(moving) & ~upright).any():
            size = abs(moving) + disk.body.M * orbits.rate**2
            eta = np.where(abs(orbits.near) <= abs(orbits.far), orbits.near, orbits.far)
            departures = _replaced(departures, departures_of_moving(disk, given[0], eta, moving, size), known)
            given = given[0], np.where(known, np.nan, given[1])  # what follows from the energy is not asked for
    compiled.passages.fall_batch(departures, accuracy, disk.tables, disk.natural, out)
    asked = np.isfinite(energy)
    if unanswered(out, asked):
        first, tables = first_rule(disk, accuracy), disk.leg_tables
        compiled.low_falls.low_fall_batch(*given, first, accuracy, tables, disk.natural, out)
    if unanswered(out, asked):
        compiled.passages.fall_by_rules_batch(departures, chord(0.0), packed_rules(), disk.natural, out)
    return compiled.quadrature.FallRow(*out)

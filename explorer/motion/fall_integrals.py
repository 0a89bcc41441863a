"""Falls on F to flat, from the vertical, from rest below it or from a tilt: by tables, and as arcs elsewhere."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import PIECE, arcs_between, by_rules, from_place, integrals, places
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at
from explorer.phase.linear_constants import line_slope, rows_of
from explorer.phase.states import Array

# For `compiled.warmup`
KERNELS = "passages.fall_batch", "turning_points.point_batch", "turning_points.rest_batch", "rules.arc_batch"
OF_FALL = 0.1  # of the accuracy of a race, for the fall that is taken from a passage
_COARSE = 1e-6 * (1.0 - 1e-9)  # the least accuracy of coarse tables; a power of ten may be rounded down
_ROUNDING = 4.0 * 2.2e-16  # of a difference, for each unit of its terms
_BEST = 1e-15  # of an accuracy: no answer is better


def fall_from_vertical(
    disk: Disk, sigma3_bar: Array, energy: Array, accuracy: float = 0.0
) -> "compiled.passages.FallRow[Array]":
    """The fall on F with these constants from the vertical to flat, face +1, natural units: `fall_integrals`."""
    V = energy_at(disk.body, 0.0, sigma3_bar, line_slope(disk) * sigma3_bar, 1.0)
    departures = departures_of_moving(disk, sigma3_bar, np.zeros(V.size), energy - V, abs(energy) + V)
    return fall_integrals(disk, departures, accuracy=accuracy)


def fall_integrals(
    disk: Disk, departures: "compiled.passages.Departures", edge: float = 0.0, accuracy: float = 0.0
) -> "compiled.passages.FallRow[Array]":
    """The falls on F that leave the vertical so, once to flat, face +1, natural units; NaN for what does not fall.

    edge: how far below the vertical they begin, in x = ln tan(theta/2). accuracy: of twice the angle, and of the
    time; 0: the best there is. What lacks energy to be at the vertical falls from rest below it.
    """
    n, most = departures.level.size, max(0.5 * OF_FALL * accuracy, _BEST)
    out = np.full((4, n), np.nan)

    def left() -> NDArray[np.intp]:
        return np.flatnonzero(~(out[3] <= most) & (departures.level > 0.0))

    if edge == 0.0:
        by_tables(disk, compiled.passages.fall_batch, departures, accuracy, left, out)
    rows = left()
    if rows.size:
        out[:, rows] = falls_as_arcs(disk, departures, rows, edge, most)
    return compiled.passages.FallRow(*out)


def by_tables(
    disk: Disk,
    kernel: Callable[..., None],
    motions: NamedTuple,
    accuracy: float,
    left: Callable[[], NDArray[np.intp]],
    out: Array,
) -> None:
    """What the tables of a disk answer of motions from the vertical, by a kernel of `passages` -> out.

    left: those that are not yet answered as well as was asked, from what out holds.
    """
    for tables in disk.tables[0 if accuracy >= _COARSE else 1 :]:
        rows = left()
        if not rows.size:
            return
        if rows.size == motions[0].size:
            kernel(motions, tables, disk.natural, out)
            continue
        found = np.empty((len(out), rows.size))
        kernel(rows_of(motions, rows), tables, disk.natural, found)
        out[:, rows] = found


@np.errstate(invalid="ignore")  # of motions that stay where they are
def falls_as_arcs(
    disk: Disk, departures: "compiled.passages.Departures", rows: NDArray[np.intp], edge: float, accuracy: float
) -> Array:
    """Some of the falls (4, n), rows as FallRow."""
    place, rule = compiled.turning_points.Place, compiled.rules
    bar, K, n = departures.sigma3_bar[rows], departures.moving[rows], rows.size
    X, none = bar / disk.body.r0, np.zeros(n)
    starts = compiled.turning_points.Starts(X, none, K, none + 1.0, none, bar, line_slope(disk) * bar)
    begin = places(disk, starts, none + edge, True)
    rest = np.flatnonzero(place(*begin).K < 0.0)
    if rest.size:
        found = np.empty((begin.shape[0], rest.size))
        compiled.turning_points.rest_batch(rows_of(starts, rest), disk.arc_disk, found)
        begin[:, rest] = found
    first, below_piece = np.zeros((len(rule.ArcRow._fields), n)), begin.copy()
    slow = np.flatnonzero(np.isfinite(place(*begin).slow))
    if slow.size:
        top, length = place(*begin.take(slow, 1)), np.full(slow.size, PIECE)
        below_piece[:, slow] = places(disk, from_place(X[slow], none[slow], top), length, True)
        piece = arcs_between(X[slow], none[slow], length, place(*below_piece[:, slow]), top)
        first[:, slow] = integrals(disk, piece, np.full(slow.size, np.nan), accuracy)
    end = place(*below_piece)
    kinds = np.where(end.K == 0.0, rule.FALL_FROM_REST, rule.FALL)
    arc = rule.ArcRow(*first + by_rules(disk, kinds, arcs_between(X, none, none + 1.0, end, end), accuracy))
    # Beside V_0 all changes by about as large a share as E - V_0 does.
    rounding = departures.rounding[rows] / departures.level[rows]
    # Of a long fall the share of its time counts.
    late = (arc.time_error + rounding * arc.time) / np.fmax(arc.time, 1.0)
    error = np.fmax(arc.angle_error + rounding * abs(arc.chi), late)
    return np.stack([arc.time, arc.chi, arc.psi, error])


@np.errstate(over="ignore", invalid="ignore")  # of motions that are no input
def departures_of_moving(
    disk: Disk, sigma3_bar: Array, eta: Array, given: Array, size: Array
) -> "compiled.passages.Departures":
    """Falls on F with the sigma3_bar and energies of motions on or beside it, natural units.

    given: E - V of these motions at the vertical; size: of what that is a difference of.
    """
    b = disk.body
    # sigma4 at the vertical is less by eta_hat than on F, eq. (6.2): no energies are subtracted.
    on_f, eta_hat = line_slope(disk) * sigma3_bar, eta / (b.I3 * b.r0)
    turning = 0.5 * b.J * eta_hat
    moving = given - turning * (2.0 * on_f - eta_hat)
    rounding = _ROUNDING * (size + abs(turning) * (2.0 * abs(on_f) + abs(eta_hat)))
    # V - V_0 at the vertical on F, eq. (3.8). The squares of sigma4 there and at flat are not subtracted: where
    # they are large, nothing would be left of 1. The series is that of (r'(S) - 1)/S, here at S = 1.
    flat = sigma3_bar / (b.k * b.r0)
    rise = flat * sum(disk.natural.series.excess)
    above = 0.5 * b.I1 * (sigma3_bar * sigma3_bar) + 0.5 * b.J * rise * (2.0 * flat + rise) + 1.0
    columns = sigma3_bar, moving + above, moving, rounding
    return compiled.passages.Departures(*map(np.ascontiguousarray, columns))

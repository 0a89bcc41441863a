"""Falls on F to flat, from the vertical, from rest below it or from a tilt: by tables, and as arcs elsewhere."""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import PIECE, arcs_between, by_rules, from_place, integrals, places
from explorer.motion.vertical import depth
from explorer.phase.disk import Disk
from explorer.phase.energy import potential_at_flat
from explorer.phase.lines import line_slope
from explorer.phase.states import Array

KERNELS = (
    *("passages.departure_batch", "passages.fall_batch"),
    *("turning_points.point_batch", "turning_points.rest_batch", "rules.arc_batch"),
)  # for `compiled.warmup`
OF_FALL = 0.1  # of the accuracy of a race, for the fall that is taken from a passage
_BEST = 1e-15  # of an accuracy: no answer is better
# Rows of doubles whose lengths are multiples of this displace one another in the cache.
_ALIKE = 512


def rows_apart(rows: int, n: int) -> Array:
    """Room for results: n in each row, or a few more where rows would displace one another in the cache."""
    return np.empty((rows, n + 8 if n % _ALIKE == 0 else n))


def fall_from_vertical(
    disk: Disk, sigma3_bar: Array, energy: Array, edge: float = 0.0, accuracy: float = 0.0
) -> "compiled.in_turn.FallRow[Array]":
    """The fall on F with these constants from the vertical to flat, face +1, natural units; as `falls_of`."""
    return falls_of(disk, departures_of_energy(disk, sigma3_bar, energy), edge, accuracy)


def falls_of(
    disk: Disk, departures: "compiled.passages.Departures", edge: float = 0.0, accuracy: float = 0.0
) -> "compiled.in_turn.FallRow[Array]":
    """The falls on F that leave the vertical so, once to flat, face +1, natural units; NaN for what does not fall.

    edge: phi (rad) at which they begin instead. accuracy: of twice the angle, and of the time; 0: the best there
    is. What lacks energy to be at the vertical falls from rest below it.
    """
    n = departures.level.size
    out = rows_apart(4, n)
    if edge == 0.0:
        compiled.passages.fall_batch(departures, OF_FALL * accuracy, disk.tables, disk.natural, out)
    else:
        out.fill(np.nan)
    most = max(0.5 * OF_FALL * accuracy, _BEST)
    rows = np.flatnonzero(~(out[3, :n] <= most) & (departures.level > 0.0))
    if rows.size:
        out[:, rows] = falls_as_arcs(disk, departures, rows, edge, most)
    return compiled.in_turn.FallRow(*out[:, :n])


@np.errstate(invalid="ignore")  # of motions that stay where they are
def falls_as_arcs(
    disk: Disk, departures: "compiled.passages.Departures", rows: NDArray[np.intp], edge: float, accuracy: float
) -> Array:
    """Some of the falls (4, n), rows as FallRow."""
    place, rule = compiled.turning_points.Place, compiled.rules
    bar, K, n = departures.sigma3_bar[rows], departures.moving[rows], rows.size
    X, none = bar / disk.body.r0, np.zeros(n)
    starts = compiled.turning_points.Starts(X, none, K, none + 1.0, none, bar, line_slope(disk) * bar)
    begin = places(disk, starts, none + depth(edge), True)
    rest = np.flatnonzero(place(*begin).K < 0.0)
    if rest.size:
        found = np.empty((begin.shape[0], rest.size))
        below = compiled.turning_points.Starts(*(column[rest] for column in starts))
        compiled.turning_points.rest_batch(below, disk.chart, found)
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
    way = rule.ArcRow(*first + by_rules(disk, kinds, arcs_between(X, none, none + 1.0, end, end), accuracy))
    # Beside V_0 all changes by about as large a share as E - V_0 does.
    doubt = departures.doubt[rows] / departures.level[rows]
    error = np.fmax(way.angle_error + doubt * abs(way.chi), way.time_error + doubt * way.time)
    return np.stack([way.time, way.chi, way.psi, error])


def vertical_above_flat(disk: Disk, sigma3_bar: Array) -> Array:
    """V - V_0 at the vertical on F, eq. (3.8), natural units."""
    none = np.zeros(sigma3_bar.size)
    return departures_of_moving(disk, sigma3_bar, none, none, none).level


@np.errstate(over="ignore", invalid="ignore")  # of motions that are no input
def departures_of_energy(disk: Disk, sigma3_bar: Array, energy: Array) -> "compiled.passages.Departures":
    """Falls with these energies, as far as a difference of energies tells their start; natural units."""
    bar, given = np.ascontiguousarray(sigma3_bar), np.ascontiguousarray(energy)
    at_flat = potential_at_flat(disk.body, bar)
    level = given - at_flat
    moving = level - vertical_above_flat(disk, bar)
    return compiled.passages.Departures(bar, level, moving, compiled.passages.ROUNDING * (abs(given) + at_flat))


def departures_beside(disk: Disk, crossings: "compiled.passages.Crossings") -> "compiled.passages.Departures":
    """Falls on F with the sigma3_bar and energies of motions beside it that cross the vertical; natural units."""
    with np.errstate(over="ignore", invalid="ignore"):  # of motions that are no input
        given = 0.5 * disk.body.M * crossings.speed**2
    return departures_of_moving(disk, crossings.sigma3_bar, crossings.eta, given, given)


def departures_of_moving(
    disk: Disk, sigma3_bar: Array, eta: Array, given: Array, size: Array
) -> "compiled.passages.Departures":
    """The same from E - V of motions beside F at the vertical, and the size of what that is a difference of."""
    motions = compiled.passages.Beside(*map(np.ascontiguousarray, (sigma3_bar, eta, given, size)))
    out = rows_apart(3, sigma3_bar.size)
    # The polynomial of (r'(S) - 1)/S at S = 1.
    compiled.passages.departure_batch(motions, disk.natural.series[4].sum(), disk.natural, out)
    return compiled.passages.Departures(motions.sigma3_bar, *out[:, : sigma3_bar.size])

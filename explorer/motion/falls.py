"""Falls on F to flat, from the vertical or from rest below it, as arcs."""

from typing import NamedTuple

import numpy as np

from explorer import compiled
from explorer.motion.arcs import PIECE, arcs_between, by_rules, from_place, integrals, places
from explorer.motion.starts import Motions
from explorer.phase.disk import Disk
from explorer.phase.states import Array

_FLAT = 60.0  # in x, below the vertical: V on F is that at flat


class Falls(NamedTuple):
    """Falls (n) once to flat, as seen from that face: rows of ArcRow, NaN where the motion does not fall.

    level: E - V_0; it falls where that is above 0.
    """

    ways: "compiled.rules.ArcRow[Array]"
    level: Array


def falls_beside(
    disk: Disk, motions: Motions, vertical: "compiled.turning_points.Place[Array]", accuracy: float
) -> Falls:
    """The falls on F with the sigma3_bar and energies of motions, whose K at the vertical is known.

    On F sigma4 there is less by eta_hat, of the face that is nearer, and so K changes by a product.
    """
    b, (X, Y, *_) = disk.body, motions.starts
    here = abs(Y) <= abs(motions.Y_far)
    sigma4 = np.where(here, vertical.sigma4, -vertical.sigma4)
    missing = np.where(here, Y, motions.Y_far) / (b.r0 * b.k)
    on_f = sigma4 + missing
    K = vertical.K - 0.5 * b.J * missing * (sigma4 + on_f)
    one, none = np.ones_like(K), np.zeros_like(K)
    return falls_from(disk, compiled.turning_points.Starts(X, none, K, one, none, vertical.sigma3, on_f), accuracy)


def falls_from(disk: Disk, starts: "compiled.turning_points.Starts", accuracy: float) -> Falls:
    """The falls of motions on F from their starts; where K < 0 there, from where they are at rest below."""
    place, rule = compiled.turning_points.Place, compiled.rules
    level = place(*places(disk, starts, np.full(starts.X.size, _FLAT), True)).K
    ways = np.full((len(rule.ArcRow._fields), level.size), np.nan)
    rows = np.flatnonzero(level > 0.0)
    X, none = starts.X[rows], np.zeros(rows.size)
    begin = places(disk, _at(starts, rows), none, True)
    rest = np.flatnonzero(starts.K[rows] < 0.0)
    if rest.size:
        found = np.empty((begin.shape[0], rest.size))
        compiled.turning_points.rest_batch(_at(starts, rows[rest]), disk.chart, found)
        begin[:, rest] = found
    first, below = np.zeros((ways.shape[0], rows.size)), begin.copy()
    slow = np.flatnonzero(np.isfinite(begin[place._fields.index("slow")]))
    if slow.size:
        top = place(*begin.take(slow, 1))
        below[:, slow] = places(disk, from_place(X[slow], none[slow], top), np.full(slow.size, PIECE), True)
        piece = arcs_between(X[slow], none[slow], np.full(slow.size, PIECE), place(*below.take(slow, 1)), top)
        first[:, slow] = integrals(disk, piece, np.full(slow.size, np.nan), accuracy)
    end = place(*below)
    kinds = np.where(end.K == 0.0, rule.FALL_FROM_REST, rule.FALL)
    ways[:, rows] = first + by_rules(disk, kinds, arcs_between(X, none, none + 1.0, end, end), accuracy)
    return Falls(rule.ArcRow(*ways), level)


def _at(
    starts: "compiled.turning_points.Starts", rows: "np.typing.NDArray[np.intp]"
) -> "compiled.turning_points.Starts":
    return compiled.turning_points.Starts(*(column[rows] for column in starts))

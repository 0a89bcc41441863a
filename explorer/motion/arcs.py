"""Integrals along motions: sums over arcs, which are cut where rules would need many nodes."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.states import Array

# In x = ln tan(theta/2): from a slow end of an arc longer than the first, a piece of the second is cut off, since
# there and at the other end nodes lie differently.
_LONG, PIECE = 3.0, 1.0


@cache
def rule() -> "compiled.rules.Rule":
    """Nodes and weights, the same for all bodies."""
    return compiled.rules.make_rule()


def some(
    place: "compiled.turning_points.Place[Array]", rows: NDArray[np.intp]
) -> "compiled.turning_points.Place[Array]":
    """Some of the places."""
    return compiled.turning_points.Place(*(column[rows] for column in place))


def from_place(
    X: Array, Y: Array, place: "compiled.turning_points.Place[Array]"
) -> "compiled.turning_points.Starts":
    """Motions that are searched on from places."""
    columns = X, Y, place.K, place.r, place.w, place.sigma3, place.sigma4
    return compiled.turning_points.Starts(*map(np.ascontiguousarray, columns))


def places(disk: Disk, starts: "compiled.turning_points.Starts", d: Array, inward: bool) -> Array:
    """The points (9, n) at distances d from starts, rows as Place."""
    out = np.empty((len(compiled.turning_points.Place._fields), d.size))
    compiled.turning_points.point_batch(starts, np.ascontiguousarray(d), inward, disk.chart, out)
    return out


def next_inward(disk: Disk, starts: "compiled.turning_points.Starts") -> "compiled.turning_points.Place[Array]":
    """The next turning points towards flat."""
    out = np.empty((len(compiled.turning_points.Place._fields), starts.X.size))
    compiled.turning_points.inward_batch(starts, disk.chart, out)
    return compiled.turning_points.Place(*out)


def arcs_between(
    X: Array,
    Y: Array,
    length: Array,
    inner: "compiled.turning_points.Place[Array]",
    outer: "compiled.turning_points.Place[Array]",
) -> Array:
    """Arcs (15, n) of motions between two of their places, rows as `compiled.rules.Arcs`."""
    ends = [row for at in (inner, outer) for row in (at.r, at.w, at.sigma3, at.sigma4, at.K, at.slow)]
    return np.stack([X, Y, length, *ends])


def integrals(disk: Disk, arcs: Array, crest: Array, accuracy: float) -> Array:
    """Integrals (5, n) along arcs (15, n), rows as ArcRow.

    crest: the distance from the outer end at which a motion is slow on its way, NaN where it is not.
    """
    n = crest.size
    parts, owner = _cut_at_slow_ends(disk, *_cut_at_crests(disk, arcs, np.arange(n), crest))
    arc, kind = compiled.rules.Arcs(*parts), compiled.rules
    turns_in, turns_out = arc.K_in == 0.0, arc.K_out == 0.0
    inside = np.where(turns_out, kind.TWO_TURNS, kind.TURN_INSIDE)
    kinds = np.where(turns_in, inside, np.where(turns_out, kind.TURN_OUTSIDE, kind.NO_TURN))
    kinds[arc.L == 0.0] = kind.NOTHING
    out = by_rules(disk, kinds, parts, accuracy)
    if owner.size == n:
        return out
    return np.stack([np.bincount(owner, row, n) for row in out])


def by_rules(disk: Disk, kinds: NDArray[np.int64], arcs: Array, accuracy: float) -> Array:
    """The same, of arcs whose kinds are known, as they are."""
    out = np.zeros((len(compiled.rules.ArcRow._fields), kinds.size))
    compiled.rules.arc_batch(kinds, compiled.rules.Arcs(*arcs), accuracy, rule(), disk.chart, out)
    return out


def _cut_at_crests(
    disk: Disk, arcs: Array, owner: NDArray[np.intp], crest: Array
) -> tuple[Array, NDArray[np.intp]]:
    """Arcs, and which motion each belongs to, without slow places between their ends."""
    rows = np.flatnonzero((crest > 0.0) & (crest < arcs[2]))
    return _cut(disk, arcs, owner, rows, crest[rows], True) if rows.size else (arcs, owner)


def _cut_at_slow_ends(disk: Disk, arcs: Array, owner: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
    """The same, with one slow end at most, and that on a short piece."""
    arc = compiled.rules.Arcs(*arcs)
    slow_in, slow_out, long = np.isfinite(arc.slow_in), np.isfinite(arc.slow_out), arc.L > _LONG
    rows = np.flatnonzero((slow_in & slow_out) | (long & (slow_in | slow_out)))
    if not rows.size:
        return arcs, owner
    L = arc.L[rows]
    d = np.where(long[rows], np.where(slow_out[rows], PIECE, L - PIECE), 0.5 * L)
    return _cut(disk, arcs, owner, rows, d, False)


def _cut(
    disk: Disk, arcs: Array, owner: NDArray[np.intp], rows: NDArray[np.intp], d: Array, slow: bool
) -> tuple[Array, NDArray[np.intp]]:
    """Cut some arcs at distances d from their outer ends; slow: whether the motion is, where they are cut."""
    arc = compiled.rules.Arcs(*arcs.take(rows, 1))
    inner = compiled.turning_points.Starts(*arc[:2], arc.K_in, *arc[3:7])
    outer = compiled.turning_points.Starts(*arc[:2], arc.K_out, *arc[9:13])
    here = np.where(d <= 0.5 * arc.L, places(disk, outer, d, True), places(disk, inner, arc.L - d, False))
    at = compiled.turning_points.Place(*here)
    slowness = at.slow if slow else np.full(d.size, np.inf)
    cut = np.stack([at.r, at.w, at.sigma3, at.sigma4, at.K, slowness])
    upper, lower = arcs.take(rows, 1), arcs.take(rows, 1)
    upper[2], upper[3:9] = d, cut
    lower[2], lower[9:15] = arc.L - d, cut
    kept = arcs.copy()
    kept[:, rows] = upper
    return np.hstack([kept, lower]), np.append(owner, owner[rows])

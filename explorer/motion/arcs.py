"""Integrals along motions: sums over arcs, which are cut where rules would need many nodes."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.states import Array

# In x = ln tan(theta/2): what is cut off at a slow end, since nodes lie otherwise there than on the rest of an
# arc; and at both ends of one longer than the last: integrands fall like e^-d, so that little is left between.
PIECE, _LAYER, _LONG = 1.0, 30.0, 100.0
# The error that is allowed whatever accuracy is asked for, for each radian of angles: of 14 digits.
OF_ANGLES = 64.0 * 2.2e-16


def allowed(accuracy: float, chi: Array, psi: Array) -> Array:
    """The largest error of an answer with such angles (rad)."""
    most: Array = np.fmax(accuracy, OF_ANGLES * (abs(chi) + abs(psi)))
    return most


@cache
def rule() -> "compiled.rules.Rule":
    """Nodes and weights, the same for all bodies."""
    return compiled.rules.make_rule()


def from_place(
    X: Array, Y: Array, place: "compiled.turning_points.Place[Array]"
) -> "compiled.turning_points.Starts":
    """Motions that are searched on from places."""
    columns = X, Y, place.K, place.r, place.w, place.sigma3, place.sigma4
    return compiled.turning_points.Starts(*map(np.ascontiguousarray, columns))


def places(disk: Disk, starts: "compiled.turning_points.Starts", d: Array, inward: bool) -> Array:
    """The points (9, n) at distances d from starts, rows as Place."""
    out = np.empty((len(compiled.turning_points.Place._fields), d.size))
    compiled.turning_points.point_batch(starts, np.ascontiguousarray(d), inward, disk.arc_disk, out)
    return out


def next_inward(disk: Disk, starts: "compiled.turning_points.Starts") -> "compiled.turning_points.Place[Array]":
    """The next turning points towards flat."""
    out = np.empty((len(compiled.turning_points.Place._fields), starts.X.size))
    compiled.turning_points.inward_batch(starts, disk.arc_disk, out)
    return compiled.turning_points.Place(*out)


def arcs_between(
    X: Array,
    Y: Array,
    length: Array,
    inner: "compiled.turning_points.Place[Array]",
    outer: "compiled.turning_points.Place[Array]",
) -> Array:
    """Arcs (17, n) of motions between two of their places, rows as `compiled.rules.Arcs`."""
    ends = [row for at in (inner, outer) for row in (at.r, at.w, at.sigma3, at.sigma4, at.K, at.slow, at.error)]
    return np.stack([X, Y, length, *ends])


def integrals(disk: Disk, arcs: Array, crest: Array, accuracy: float) -> Array:
    """Integrals (5, n) along arcs (17, n), rows as ArcRow.

    crest: the distance from the outer end at which a motion is slow on its way, NaN where it is not.
    """
    n, rows = crest.size, np.flatnonzero((crest > 0.0) & (crest < arcs[2]))
    parts, owner = _cut_at_ends(disk, *_cut(disk, arcs, np.arange(n), rows, crest[rows], True))
    out = by_rules(disk, _kinds(compiled.rules.Arcs(*parts)), parts, accuracy)
    if owner.size == n:
        return out
    return np.stack([np.bincount(owner, row, n) for row in out])


def _kinds(arc: "compiled.rules.Arcs") -> NDArray[np.int64]:
    """The kinds of arcs, by what is at their ends."""
    kind, turns_in, turns_out = compiled.rules, arc.K_in == 0.0, arc.K_out == 0.0
    inside = np.where(turns_out, kind.TWO_TURNS, kind.TURN_INSIDE)
    kinds = np.where(turns_in, inside, np.where(turns_out, kind.TURN_OUTSIDE, kind.NO_TURN))
    slow_in, slow_out = np.isfinite(arc.slow_in), np.isfinite(arc.slow_out)
    kinds = np.where(slow_in, np.where(turns_in, kind.SLOW_TURN_INSIDE, kind.SLOW_INSIDE), kinds)
    kinds = np.where(slow_out, np.where(turns_out, kind.SLOW_TURN_OUTSIDE, kind.SLOW_OUTSIDE), kinds)
    return np.where(arc.L > 0.0, kinds, kind.NOTHING)


def by_rules(disk: Disk, kinds: NDArray[np.int64], arcs: Array, accuracy: float) -> Array:
    """The same, of arcs whose kinds are known, as they are."""
    out = np.zeros((len(compiled.rules.ArcRow._fields), kinds.size))
    compiled.rules.arc_batch(kinds, compiled.rules.Arcs(*arcs), accuracy, rule(), disk.arc_disk, out)
    return out


def _cut_at_ends(disk: Disk, arcs: Array, owner: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
    """Arcs, and which motion each belongs to, none of them very long.

    Those with a slow end are short, and go on at the other one.
    """
    for outside in (True, False):
        arc = compiled.rules.Arcs(*arcs)
        slow, far = np.isfinite(arc.slow_out if outside else arc.slow_in), arc.K_in if outside else arc.K_out
        otherwise = (arc.L > PIECE) | (far == 0.0) | (outside & np.isfinite(arc.slow_in))
        rows = np.flatnonzero((slow & otherwise) | (arc.L > _LONG))
        d = np.fmin(np.where(slow[rows], PIECE, _LAYER), 0.5 * arc.L[rows])
        arcs, owner = _cut(disk, arcs, owner, rows, d if outside else arc.L[rows] - d, False)
    return arcs, owner


def _cut(
    disk: Disk, arcs: Array, owner: NDArray[np.intp], rows: NDArray[np.intp], d: Array, slow: bool
) -> tuple[Array, NDArray[np.intp]]:
    """Cut some arcs at distances d from their outer ends; slow: whether the motion is, where they are cut."""
    if not rows.size:
        return arcs, owner
    arc = compiled.rules.Arcs(*arcs.take(rows, 1))
    inner = compiled.turning_points.Starts(*arc[:2], arc.K_in, *arc[3:7])
    outer = compiled.turning_points.Starts(*arc[:2], arc.K_out, *arc[10:14])
    here = np.where(d <= 0.5 * arc.L, places(disk, outer, d, True), places(disk, inner, arc.L - d, False))
    at = compiled.turning_points.Place(*here)
    slowness = at.slow if slow else np.full(d.size, np.inf)
    cut = np.stack([at.r, at.w, at.sigma3, at.sigma4, at.K, slowness, at.error])
    upper, lower = arcs.take(rows, 1), arcs.take(rows, 1)
    upper[2], upper[3:10] = d, cut
    lower[2], lower[10:17] = arc.L - d, cut
    kept = arcs.copy()
    kept[:, rows] = upper
    return np.hstack([kept, lower]), np.append(owner, owner[rows])

"""Whole motions between their turning points, from arcs: what `periods`, `bounces` and smallest tilts ask for."""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import arcs_between, from_place, integrals, rows_of
from explorer.motion.starts import Motions
from explorer.phase.disk import Disk
from explorer.phase.states import Array


class Ends(NamedTuple):
    """Where motions turn, seen from the faces on which they do; rows as Place, NaN where nothing was found.

    crosses: whether the motion comes to the vertical; far: its turning point on the other face then.
    """

    state: "compiled.turning_points.Place[Array]"
    inner: "compiled.turning_points.Place[Array]"
    outer: "compiled.turning_points.Place[Array]"
    vertical: "compiled.turning_points.Place[Array]"
    far: "compiled.turning_points.Place[Array]"
    crosses: NDArray[np.bool_]

    @property
    def width(self) -> Array:
        """Distance between both turning points, in x."""
        return self.inner.d + self.outer.d + np.where(self.crosses, self.far.d, 0.0)


class Orbits(NamedTuple):
    """Half of the ways there and back: on the face of the state, on the other one, and from the state to flattest.

    NaN where there is none, or none was found.
    """

    here: "compiled.rules.ArcRow[Array]"
    there: "compiled.rules.ArcRow[Array]"
    lead: "compiled.rules.ArcRow[Array]"


@cache
def _points() -> "compiled.nutation.Points":
    return compiled.nutation.make_points()


def ends_of(disk: Disk, motions: Motions) -> Ends:
    """The turning points of motions."""
    turning, n = compiled.turning_points, motions.starts.X.size
    tables = [np.empty((len(turning.Place._fields), n)) for _ in range(4)]
    turning.orbit_batch(motions.starts, disk.chart, *tables)
    state, inner, outer, vertical = (turning.Place(*table) for table in tables)
    crosses, far = outer.K > 0.0, np.full_like(tables[0], np.nan)
    rows = np.flatnonzero(crosses)
    if rows.size:
        found = np.empty((far.shape[0], rows.size))
        beyond = from_place(motions.starts.X[rows], motions.Y_far[rows], _beyond(rows_of(tables[3], rows)))
        turning.inward_batch(beyond, disk.chart, found)
        far[:, rows] = found
    return Ends(state, inner, outer, vertical, turning.Place(*far), crosses)


def smallest(ends: Ends) -> Array:
    """The tilt at the flattest moment (rad)."""
    tilt: Array = 2.0 * np.arctan(np.fmin(ends.inner.r, ends.far.r))
    return tilt


def _beyond(place: "compiled.turning_points.Place[Array]") -> "compiled.turning_points.Place[Array]":
    """The vertical as seen from the other face."""
    return place._replace(sigma4=-place.sigma4)


def _some(
    place: "compiled.turning_points.Place[Array]", rows: NDArray[np.intp]
) -> "compiled.turning_points.Place[Array]":
    return compiled.turning_points.Place(*(column[rows] for column in place))


def orbits_of(disk: Disk, motions: Motions, ends: Ends, accuracy: float, lead: bool) -> Orbits:
    """The ways of motions between their ends; lead: whether the one from the state is asked for."""
    rule, n = compiled.rules.ArcRow, ends.crosses.size
    here, there, ahead = (np.full((len(rule._fields), n), np.nan) for _ in range(3))
    narrow = ends.width < compiled.nutation.WIDEST
    rows = np.flatnonzero(np.isfinite(ends.width) & ~narrow)
    X, Y, state, inner, outer = motions.starts.X[rows], motions.starts.Y[rows], *_at(ends, rows)
    # At most one crest lies on the way, on one or on the other side of the state.
    crest = np.where(np.isnan(inner.crest), outer.d - outer.crest, outer.d + inner.crest)
    here[:, rows] = integrals(disk, arcs_between(X, Y, inner.d + outer.d, inner, outer), crest, accuracy)
    if lead:
        ahead[:, rows] = np.where(outer.d == 0.0, here[:, rows], 0.0)
        between = np.flatnonzero((inner.d > 0.0) & (outer.d > 0.0))
        low, at, way = _some(inner, between), _some(state, between), arcs_between
        part = integrals(disk, way(X[between], Y[between], low.d, low, at), low.crest, accuracy)
        ahead[:, rows[between]] = part
    crossing = rows[ends.crosses[rows]]
    if crossing.size:
        far, top = _some(ends.far, crossing), _beyond(_some(ends.vertical, crossing))
        ways = arcs_between(motions.starts.X[crossing], motions.Y_far[crossing], far.d, far, top)
        there[:, crossing] = integrals(disk, ways, far.crest, accuracy)
    rows = np.flatnonzero(narrow)
    if rows.size:
        here[:, rows], there[:, rows], ahead[:, rows] = _wobbles(disk, motions, ends, rows)
    return Orbits(rule(*here), rule(*there), rule(*ahead))


def _at(ends: Ends, rows: NDArray[np.intp]) -> "tuple[compiled.turning_points.Place[Array], ...]":
    return tuple(_some(place, rows) for place in ends[:3])


def _wobbles(disk: Disk, motions: Motions, ends: Ends, rows: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """The same ways of motions whose turning points are near together, by the bend of the potential alone."""
    state, inner, outer = _at(ends, rows)
    crosses, vertical = ends.crosses[rows], _some(ends.vertical, rows)
    wells = compiled.nutation.Wells(
        from_place(motions.starts.X[rows], motions.starts.Y[rows], inner),
        inner.d,
        outer.d + np.where(crosses, ends.far.d[rows], 0.0),
        np.where(crosses, inner.d + outer.d, np.inf),
        np.where(crosses, ends.far.d[rows], np.inf),
        motions.Y_far[rows],
        vertical.sigma3,
        -vertical.sigma4,
    )
    out = np.empty((len(compiled.nutation.WellRow._fields), rows.size))
    compiled.nutation.well_batch(wells, _points(), disk.chart, out)
    whole, lead, upright = out.reshape(3, -1, rows.size)
    beyond = np.vstack([whole[:3] - upright[:3], whole[3:]])
    beyond[2] *= -1.0  # psi, as that face has it
    return np.where(crosses, upright, whole), np.where(crosses, beyond, np.nan), lead

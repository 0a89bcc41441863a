"""Whole motions between their turning points, from arcs: what `periods`, `bounces` and smallest tilts ask for."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import OF_ANGLES, allowed, arcs_between, from_place, integrals, next_inward, places
from explorer.motion.starts import ArcStarts
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array

# Of `ends_of`, and of what goes on from there: for `compiled.warmup`
KERNELS = "turning_points.orbit_batch", "turning_points.inward_batch"
WITH_PLACES = (*KERNELS, "turning_points.point_batch")
_OF_ARC = 0.125  # of the accuracy: a period goes twice over two arcs, which may be cut in two


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

    @property
    def slowest(self) -> Array:
        """How near a crest of the potential lies beyond a turning point, in x; inf or NaN where none is near."""
        return np.fmin(self.inner.slow, np.where(self.crosses, self.far.slow, self.outer.slow))


class Orbits(NamedTuple):
    """Arcs of motions: all of it on the face of the state, on the other one, and from the state to flattest.

    NaN where there is none, or none was found.
    """

    here: "compiled.rules.ArcRow[Array]"
    there: "compiled.rules.ArcRow[Array]"
    lead: "compiled.rules.ArcRow[Array]"


@cache
def _points() -> "compiled.nutation.Points":
    return compiled.nutation.make_points()


def ends_of(disk: Disk, motions: ArcStarts) -> Ends:
    """The turning points of motions."""
    turning, n = compiled.turning_points, motions.starts.X.size
    tables = np.empty((4, len(turning.Place._fields), n))
    turning.orbit_batch(motions.starts, disk.arc_disk, *tables)
    state, inner, outer, vertical = (turning.Place(*table) for table in tables)
    crosses, far = outer.K > 0.0, np.full(tables[0].shape, np.nan)
    rows = np.flatnonzero(crosses)
    far[:, rows] = next_inward(
        disk, from_place(motions.starts.X[rows], motions.Y_far[rows], beyond(rows_of(vertical, rows)))
    )
    return Ends(state, inner, outer, vertical, turning.Place(*far), crosses)


def tilts_by_face(motions: ArcStarts, ends: Ends) -> tuple[Array, Array]:
    """The smallest tilts (rad) of motions on the face of their state and on the other one, with relative errors.

    Both (2, n). Near F a tilt is in proportion to eta, and known as well as that.
    """
    errors = ends.inner.error + motions.unsure, ends.far.error + motions.unsure_far
    return 2.0 * np.arctan([ends.inner.r, ends.far.r]), np.stack(errors)


def closest_to_crest(disk: Disk, motions: ArcStarts) -> Array:
    """How near motions come to rest at a crest of the potential, on their way or beyond a turning point.

    The distance in x from there to the next zero of E - V, real or complex; inf where none is near.
    """
    ends = ends_of(disk, motions)
    closest = ends.slowest
    other = from_place(motions.starts.X, motions.Y_far, beyond(ends.vertical))
    ends_and_starts = (
        (motions.starts, ends.inner, True),
        (motions.starts, ends.outer, False),
        (other, ends.far, True),
    )
    for starts, end, inward in ends_and_starts:
        rows = np.flatnonzero(np.isfinite(end.crest))
        at = compiled.turning_points.Place(*places(disk, rows_of(starts, rows), end.crest[rows], inward))
        closest[rows] = np.fmin(closest[rows], at.slow)
    return np.nan_to_num(closest, nan=np.inf, posinf=np.inf)


def beyond(vertical: "compiled.turning_points.Place[Array]") -> "compiled.turning_points.Place[Array]":
    """The vertical as seen from the other face."""
    return vertical._replace(sigma4=-vertical.sigma4)


def orbits_of(
    disk: Disk,
    motions: ArcStarts,
    ends: Ends,
    accuracy: float,
    there: NDArray[np.bool_] | bool,
    lead: bool,
    tables: bool = True,
) -> Orbits:
    """The arcs of motions between their ends.

    there: whether the arc on the other face is asked for, where a motion comes there; lead: that from the state.
    What is not is NaN. tables: whether those of the disk may serve arcs from the vertical; else rules alone.
    """
    rule, n = compiled.rules.ArcRow, ends.crosses.size
    here, back, ahead = (np.full((len(rule._fields), n), np.nan) for _ in range(3))
    of_arc = _OF_ARC * accuracy
    narrow = (ends.width < compiled.nutation.WIDEST) & ~(ends.slowest < np.inf)
    rows = np.flatnonzero(narrow)
    if rows.size:
        whole, *parts = _nutations(disk, rows_of(motions, rows), ends, rows)
        if lead:
            here[:, rows], back[:, rows], ahead[:, rows] = parts
        else:  # where the vertical lies in a well is not known as well as the well
            here[:, rows], back[:, rows] = whole, 0.0
        # Where a zero of K lies not far beyond, so few points do not serve wells as wide as these.
        arc = rule(*whole)
        known = arc.angle_error <= allowed(of_arc, arc.chi, arc.psi)
        narrow[rows] = known & (arc.time_error <= max(of_arc, OF_ANGLES) * arc.time)
    # On a crest itself motions rest for ever. What falls on the other face has an arc on this one.
    length = ends.inner.d + ends.outer.d
    rows = np.flatnonzero((length > 0.0) & (length < np.inf) & ~narrow)
    X, Y, Y_far = motions.starts.X, motions.starts.Y, motions.Y_far

    def integrated(
        of: NDArray[np.intp], constant: Array, length: Array, low: Any, high: Any, crest: Array
    ) -> Array:
        out, left = np.empty((len(rule._fields), of.size)), np.ones(of.size, np.bool_)
        # Tables serve arcs from the vertical that come near flat.
        near = low.r[of] < compiled.passages.WIDEST
        upright = np.flatnonzero(near & (high.w[of] == 0.0) & (high.K[of] > 0.0))
        if tables and disk.tables and upright.size:
            rows = of[upright]
            out[:, upright] = _by_tables(disk, X[rows], constant[rows], high.K[rows])
            row = rule(*out[:, upright])
            left[upright] = ~((row.angle_error <= of_arc) & (row.time_error <= of_arc * row.time))
        rows = of[left]
        arcs = arcs_between(X[rows], constant[rows], length[rows], rows_of(low, rows), rows_of(high, rows))
        out[:, left] = integrals(disk, arcs, crest[rows], of_arc)
        return out

    state, inner, outer, vertical, far, crosses = ends
    # At most one crest lies on the way, on one or on the other side of the state.
    crest = np.where(np.isnan(inner.crest), outer.d - outer.crest, outer.d + inner.crest)
    # A start on one is slow, and no turning point is so near.
    starts = np.isnan(crest) & (state.K > 0.0) & (2.0 * state.slow < np.fmin(inner.d, outer.d))
    crest = np.where(starts, outer.d, crest)
    here[:, rows] = integrated(rows, Y, inner.d + outer.d, inner, outer, crest)
    crossing = rows[(crosses & there & (far.d > 0.0))[rows]]
    back[:, crossing] = integrated(crossing, Y_far, far.d, far, beyond(vertical), far.crest)
    if lead:
        # From an end it is all or nothing.
        ahead[:, rows] = np.where(outer.d[rows] == 0.0, here[:, rows], 0.0)
        between = rows[(inner.d[rows] > 0.0) & (outer.d[rows] > 0.0)]
        ahead[:, between] = integrated(between, Y, inner.d, inner, state, inner.crest)
    return Orbits(rule(*here), rule(*back), rule(*ahead))


def _by_tables(disk: Disk, X: Array, Y: Array, K: Array) -> Array:
    """Arcs (5, n), rows as ArcRow, between the vertical and flattest; NaN errors where tables do not serve."""
    b, n = disk.body, X.size
    out = np.empty((len(compiled.passages.PassageRow._fields), n))
    crossings = compiled.passages.Crossings(X * b.r0, Y * b.I1, np.sqrt(2.0 * b.inv_M * K))
    compiled.passages.passage_batch(crossings, disk.tables[-1], disk.natural, out)
    both = compiled.passages.PassageRow(*out)
    return 0.5 * np.stack([both.time, both.chi, both.psi, both.time_error * both.time, both.angle_error])


@np.errstate(over="ignore")  # of motions that are no input
def _nutations(disk: Disk, motions: ArcStarts, ends: Ends, rows: NDArray[np.intp]) -> tuple[Array, ...]:
    """Of motions whose turning points are near together the arc between these, and the same arcs as above."""
    inner, outer, vertical = (rows_of(place, rows) for place in (ends.inner, ends.outer, ends.vertical))
    crosses, far = ends.crosses[rows], ends.far.d[rows]
    wells = compiled.nutation.Wells(
        from_place(motions.starts.X, motions.starts.Y, inner),
        from_place(motions.starts.X, motions.starts.Y, rows_of(ends.state, rows)),
        inner.d,
        outer.d + np.where(crosses, far, 0.0),
        np.where(crosses, inner.d + outer.d, np.inf),
        np.where(crosses, far, np.inf),
        motions.Y_far,
        vertical.sigma3,
        -vertical.sigma4,
    )
    whole, lead, upright = out = np.empty((3, len(compiled.rules.ArcRow._fields), rows.size))
    compiled.nutation.well_batch(wells, _points(), disk.arc_disk, out.reshape(-1, rows.size))
    rest = np.vstack([whole[:3] - upright[:3], whole[3:]])
    rest[2] *= -1.0  # psi, as that face has it
    return whole, np.where(crosses, upright, whole), np.where(crosses, rest, np.nan), lead

"""Rises of the tilt as the kernels lay them: between which turning points, and from where points are counted.

A rise goes from the flatter turning point of a motion to the other one, which may lie beyond the vertical; on F it
begins at flat, and a pendulum's ends there. Where a motion is slow on its way, at a crest of the potential, where
it starts or at the vertical, that place is an anchor as well. Between two anchors the way is counted from either
up to the middle; where they are far apart, from so near that nothing is left to do but to coast.
"""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import from_place, places
from explorer.motion.orbits import Ends, beyond, ends_of
from explorer.motion.starts import ArcStarts
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array, Rows

Place: TypeAlias = "compiled.turning_points.Place[Array]"
# K at the vertical below which it is an anchor, and how far turning points must be from it: near one, what K is at
# the vertical is known less well than from there.
_SLOW = 0.3
_FLAT_FROM = 300.0  # in x: what lies below the vertical by so much is flat
_ROUNDING = 2.2e-16  # of a double
_OF_BOUND = 0.25  # the bound of eta's rounding allows four units of it for a sum that is off by about one


def _either(rows: NDArray[np.bool_], one: Any, other: Any) -> Place:
    """Places: one where rows, else the other."""
    return compiled.turning_points.Place(*(np.where(rows, a, b) for a, b in zip(one, other, strict=True)))


class _Slow:
    """The place of each motion between its turning points at which it is slow; at most one.

    middle, after: how far from the lower turning point, NaN where there is none, and from the upper one. other: on
    the other face than the lower turning point.
    """

    def __init__(self, number: int) -> None:
        self.place = np.full((len(compiled.turning_points.Place._fields), number), np.nan)
        self.middle, self.after, self.other = *np.full((2, number), np.nan), np.zeros(number, np.bool_)

    def note(self, rows: NDArray[np.intp], place: Any, middle: Array, after: Array, other: Any) -> None:
        """These motions are slow there."""
        self.place[:, rows], self.middle[rows], self.after[rows], self.other[rows] = place, middle, after, other

    @property
    def found(self) -> Place:
        """These places."""
        return compiled.turning_points.Place(*self.place)

    @property
    def there(self) -> NDArray[np.bool_]:
        """Whether there is one."""
        found: NDArray[np.bool_] = ~np.isnan(self.after)
        return found


@np.errstate(all="ignore")  # of motions on F, some distances of which are infinite, and of those without rises
def rises_of(disk: Disk, rows: Rows, m: ArcStarts, own: Array, jump: Array) -> "compiled.motions.Rises":
    """The rises of motions through states, seen from the faces `own` (m); jump: of chi at flat, 0 off F."""
    e, on_f, n = ends_of(disk, m), jump != 0.0, own.size
    X, Y, far_Y, crosses = m.starts.X, m.starts.Y, m.Y_far, e.crosses
    pendulum = on_f & crosses & (Y == 0.0) & (far_Y == 0.0)
    # Seen from the lower turning point; that may be on the other face than the state.
    turned = crosses & np.where(on_f, Y != 0.0, e.far.r < e.inner.r)
    place, left = e.inner.d, e.outer.d + np.where(crosses, e.far.d, 0.0)  # of the state, from both turning points
    here, there = e.inner.d + e.outer.d, e.far.d
    lower, upper = e.inner, _either(crosses, e.far, e.outer)
    flat = _flat(disk, m, e, turned) if on_f.any() else lower
    place = np.where(on_f & ~turned, np.inf, place)
    left = np.where(pendulum | (on_f & turned), np.inf, left)
    lower = _either(on_f & ~turned, flat, lower)
    upper = _either(pendulum | (on_f & turned), flat, upper)
    here, there = np.where(on_f & ~turned, np.inf, here), np.where(pendulum | (on_f & turned), np.inf, there)
    vertical, mirrored = e.vertical, beyond(e.vertical)

    # By how many units of rounding the constants may be off, as they were found from a state.
    off = np.stack([m.unsure * abs(Y), m.unsure_far * abs(far_Y)])
    loose = np.fmax(1.0, _OF_BOUND * off / (_ROUNDING * (abs(X) + abs(np.stack([Y, far_Y])))))
    place, left = np.where(turned, [left, place], [place, left])
    up, above = np.where(turned, [there, here], [here, there])
    Y, far_Y = np.where(turned, [far_Y, Y], [Y, far_Y])
    loose, far_loose = np.where(turned, loose[::-1], loose)
    lower, upper = _either(turned, upper, lower), _either(turned, lower, upper)
    vertical, mirrored = _either(turned, mirrored, vertical), _either(turned, vertical, mirrored)
    own = np.where(turned, -own, own)
    way = np.fmax(np.where(crosses, up + above, place + left), compiled.pieces.STEADY)
    slow = _slow_places(disk, m, e, turned, (place, left, up, above), vertical)

    # Signed distances from the vertical, along the rise.
    of_middle = np.where(slow.other, -1.0, 1.0) * np.log(slow.place[1])
    of_upper = np.where(crosses, above, np.log(np.fmin(upper.r, 1.0)))
    deep = compiled.pieces.DEEP
    to_middle, from_middle = np.where(slow.there, slow.middle, way), np.where(slow.there, slow.after, way)
    ends = np.where(slow.there, of_middle, of_upper)  # of the lowest part of the way
    far_below = to_middle - np.fmax(ends, 0.0) > 3.0 * deep
    far_above = slow.there & (from_middle - np.fmax(-of_middle, 0.0) > 3.0 * deep)
    # As far below the vertical, or below the anchor if that is lower, nothing is left to do but to coast.
    down, ahead = np.where(far_below, deep + np.fmax(ends, 0.0), 0.5 * to_middle), deep + np.fmax(-of_middle, 0.0)
    first = np.where(far_below, np.where(on_f, 0.0, deep), 0.5 * to_middle)
    last = np.where(far_above, np.where(pendulum, 0.0, deep), 0.5 * from_middle)
    last, down = np.where(slow.there, last, down), np.where(slow.there, down, 0.0)
    ahead = np.where(slow.there, np.where(far_above, ahead, 0.5 * from_middle), 0.0)
    coast_below = np.where(far_below, np.fmin(to_middle - first - np.where(slow.there, down, last), 1e3), 0.0)
    coast_above = np.where(far_above, np.fmin(from_middle - ahead - last, 1e3), 0.0)
    lower = lower._replace(r=np.where(on_f, np.exp(ends - np.where(slow.there, down, last)), lower.r))
    upper = upper._replace(r=np.where(pendulum, np.exp(-of_middle - ahead), upper.r))
    apart = np.where((way < compiled.nutation.WIDEST) & ~slow.there & ~(e.slowest < np.inf), way, 0.0)

    mine, others = np.stack([X, Y, np.ones(n), loose]), np.stack([X, far_Y, -np.ones(n), far_loose])
    no, yes = np.zeros(n, np.bool_), np.ones(n, np.bool_)
    anchors = []
    for at, far in ((lower, no), (upper, crosses), (vertical, no), (mirrored, yes), (slow.found, slow.other)):
        *motion, off = np.where(far, others, mine)
        anchors.append(np.stack([*motion, *at[1:8], off]))
    at_lower, at_upper, at_vertical, at_mirrored, at_slow = np.arange(5)[:, None] * n + np.arange(n)
    never, none = np.full(n, np.inf), np.zeros(n)
    stretches = np.stack([
        np.stack([at_lower, at_mirrored, np.where(crosses, up, never), first, coast_below, apart]),
        np.stack([at_slow, at_vertical, np.where(slow.other, of_middle, never), down, none, none]),
        np.stack([at_slow, at_mirrored, np.where(crosses & ~slow.other, -of_middle, never), ahead, none, none]),
        np.stack([at_upper, at_vertical, np.where(crosses, above, never), last, coast_above, apart]),
    ])  # fmt: skip
    # A motion that falls, or is none, has no rise.
    stretches[:, 3:5, np.isnan(lower.r) | np.isnan(upper.r)] = 0.0
    off = np.where(np.isfinite(place), place - slow.middle, slow.after - left)
    tangent = rows.q / (1.0 + abs(rows.z))
    off = np.where(pendulum, np.where(turned, -1.0, 1.0) * np.log(tangent) - of_middle, off)
    where = [
        place <= first,
        left <= last,
        slow.there & (off >= 0.0) & (off <= ahead),
        slow.there & (off < 0.0) & (-off <= down),
    ]
    distance = np.select(where, [place, left, off, -off], tangent)
    coasts = ~np.any(where, axis=0)
    number = np.select(where, [0, 3, 2, 1], np.where(slow.there & (off > 0.0), 3, 0))
    # A pendulum's side is that of eta on face +1; on the other one eta has the other sign.
    jump = np.where(pendulum, own * jump, jump)
    # The height of a state is known by its distance from turning points, its speed to rounding. A race ends soon:
    # no motion goes on as in one; but a small nutation about a steady motion may be as fast.
    turn, unsure = rows.rho / rows.q, _ROUNDING * disk.body.M * rows.p**2
    lasting = (way < compiled.nutation.WIDEST) | (abs(turn) <= compiled.motions.FAST)
    rates = turn * lasting, own * (rows.z * turn - rows.sigma4) * lasting, own * rows.sigma4
    # Where V' is 0 by symmetry it is no sum that has lost its digits.
    resting = (way == compiled.pieces.STEADY) & (rows.p == 0.0) & (rows.z != 0.0)
    grows = np.where(resting, np.sqrt(np.fmax(-_bend(disk, rows) / disk.body.M, 0.0)) / rows.q, 0.0)
    given = [number, distance, coasts, own * rows.p >= 0.0, own, jump, pendulum, *rates, unsure, grows]
    flattened = (
        np.moveaxis(each, -2, -1).ravel()
        for each in (np.stack(anchors), np.moveaxis(stretches, 2, 0).swapaxes(1, 2), np.stack(given))
    )
    return compiled.motions.Rises(*map(np.ascontiguousarray, flattened))


def _flat(disk: Disk, m: ArcStarts, e: Ends, turned: NDArray[np.bool_]) -> Place:
    """Flat as motions on F come to it: by what they have at a place that is as good as there."""
    flat = compiled.turning_points.Place(
        *places(
            disk,
            from_place(
                m.starts.X, np.where(turned, m.Y_far, m.starts.Y), _either(turned, beyond(e.vertical), e.outer)
            ),
            np.full(e.crosses.size, _FLAT_FROM),
            True,
        )
    )
    none = np.zeros(e.crosses.size)
    return flat._replace(d=none, r=none, w=none + 1.0, sigma3=none, slow=none + np.inf)


def _slow_places(disk: Disk, m: ArcStarts, e: Ends, turned: Any, distances: Any, vertical: Place) -> _Slow:
    """Where motions are slow on their way: a crest, a slow start, or a slow vertical."""
    slow, (place, left, up, above) = _Slow(turned.size), distances
    room = np.fmin(up, above)
    far = room > 3.0 * compiled.pieces.DEEP
    rows = np.flatnonzero(
        e.crosses & (far | ((vertical.K < _SLOW) & ((room > _SLOW) | (2.0 * vertical.slow < room))))
    )
    slow.note(rows, rows_of(vertical, rows), up[rows], above[rows], False)
    other = from_place(m.starts.X, m.Y_far, beyond(e.vertical))
    # Seen from the state, towards flat is back to the lower turning point, or, if that is on the other face,
    # ahead.
    back = np.where(turned, 1.0, -1.0)
    for end, starts, before, after, way, inward, far_side in (
        (e.inner, m.starts, place, left, back, True, turned),
        (e.outer, m.starts, place, left, -back, False, turned),
        (e.far, other, up, above, -back, True, ~turned),
    ):
        rows = np.flatnonzero(np.isfinite(end.crest))
        if rows.size:
            at = places(disk, rows_of(starts, rows), end.crest[rows], inward)
            moved = (way * end.crest)[rows]
            slow.note(rows, at, before[rows] + moved, after[rows] - moved, far_side[rows])
    rows = np.flatnonzero((e.state.K > 0.0) & (2.0 * e.state.slow < np.fmin(place, left)))
    slow.note(rows, rows_of(e.state, rows), place[rows], left[rows], turned[rows])
    return slow


def _bend(disk: Disk, rows: Rows) -> Array:
    """V'' of states, as the kernels have it."""
    b, turn, spin = disk.body, rows.z * rows.rho, rows.q * rows.sigma4
    within = 2.0 * turn * (b.I1 * turn - b.I3 * spin) + b.J * b.k * spin * spin
    return np.asarray(b.M * (rows.q * rows.rho) ** 2 + within + rows.q * (rows.z - rows.q) * (rows.z + rows.q))

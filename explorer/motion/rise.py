"""One rise on F, from flat until it turns, or to the other flat state: all that a limit motion is made of.

Its points are taken as distances in x = ln tan(theta/2) from the nearest of a few places, where it turns, passes
the vertical, or was given, so that no digit of the speed is lost. Time, angles and the centre are Chebyshev series
over stretches of such distances: to flat in tan(theta/2), where nothing on F is singular, with the root taken out
at a turning point, and halved where the motion changes faster than a series can follow.
"""

from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebint, chebinterpolate, chebpts1, chebval
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.arcs import from_place, places
from explorer.motion.orbits import beyond, ends_of
from explorer.motion.starts import ArcStarts
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array

Place: TypeAlias = "compiled.turning_points.Place[Array]"
_NODES = 32  # of a piece
# What the last coefficients of a piece may leave of its series; the last are so many.
_TAIL, _LAST = 1e-14, 3
_KNOWN = 1e-3  # how well K must be known, or where its next zero is
_FLAT_FROM = 300.0  # in x: what lies below is flat
_NEWTON_STEPS = 5  # from a table as fine as the nodes, three double the digits up to rounding; two to spare
_ENDLESS = (
    "state_on_f: the motion comes to rest within rounding of an equilibrium or a separatrix, so its period is "
    "infinite; change phidot or sigma3 slightly"
)


class Moving(NamedTuple):
    """A motion on F at some times, natural units, as seen from the face that it leaves.

    q, z: sine and cosine of the tilt theta from flat there. turn: sigma3/q^2, the rate of chi. centre: a1 + i a2.
    """

    q: Array
    z: Array
    thetadot: Array
    turn: Array
    sigma4: Array
    chi: Array
    psi: Array
    centre: NDArray[np.complex128]


class RiseStretch(NamedTuple):
    """A part of a rise whose points are counted from one place: -1 <= u <= 0 before it, 0 <= u <= 1 behind it.

    crossed: whether it is on the other face. length: in x, inf to flat. power: of |u| in the distance, 2 where the
    rise turns at the place.
    """

    start: "compiled.turning_points.Starts"
    crossed: bool
    before: bool
    length: float
    power: int

    def distance(self, u: Array) -> tuple[Array, Array]:
        """Distances from the place, and how they grow with |u|."""
        share, rate = abs(u) ** self.power, self.power * abs(u) ** (self.power - 1)
        if self.length < np.inf:
            return self.length * share, self.length * rate
        return np.minimum(-np.log1p(-share), _FLAT_FROM), rate / (1.0 - share)

    def u_at(self, d: float) -> float:
        """u at such a distance."""
        share = d / self.length if self.length < np.inf else -np.expm1(-d)
        return float((-1.0 if self.before else 1.0) * share ** (1.0 / self.power))

    @np.errstate(divide="ignore", invalid="ignore")  # at flat
    def points(self, disk: Disk, u: Array) -> tuple[Array, ...]:
        """q, z, thetadot, sigma3/q and sigma4, as in Moving, and the relative error of K."""
        starts = rows_of(self.start, np.zeros(u.size, np.intp))
        inward = self.before != self.crossed
        at = compiled.turning_points.Place(*places(disk, starts, self.distance(u)[0], inward))
        larger, face = 1.0 + at.r * at.r, -1.0 if self.crossed else 1.0
        q, speed = 2.0 * at.r / larger, np.sqrt(2.0 * disk.body.inv_M * np.maximum(at.K, 0.0))
        return q, face * at.w / larger, speed, at.sigma3 / q, face * at.sigma4, at.error / at.K


def _integrated(rates: NDArray[Any]) -> NDArray[Any]:
    """Coefficients of the integrals from -1 of rates, whose last axis are Chebyshev's nodes."""
    values: Any = rates.T  # of several functions at once
    return np.asarray(chebint(chebinterpolate(lambda _nodes: values, _NODES - 1), lbnd=-1)).T


class Rise:
    """One rise on F from flat to its turning point, with sigma3_bar = 0 over the vertical to flat; natural units.

    half, chi_half, psi_half, centre_half: what time, angles and centre come to. offset: the time at the state that
    was given. upright: whether it ends at the other flat state. impact_speed: its speed at flat.
    """

    def __init__(self, disk: Disk, motions: ArcStarts, crossed: bool) -> None:
        """motions: the one through the state; crossed: whether that is beyond the vertical."""
        X = motions.starts.X
        Y = (motions.Y_far, motions.starts.Y) if crossed else (motions.starts.Y, motions.Y_far)
        ends = ends_of(disk, motions)
        outer, crosses = ends.outer, bool(ends.crosses[0])

        def stretch(place: Place, crossed: bool, before: bool, length: float) -> RiseStretch:
            turns = bool(place.K[0] == 0.0)
            if not place.error[0] < _KNOWN * (place.slow[0] if turns else place.K[0]):
                raise InputError(_ENDLESS)
            return RiseStretch(from_place(X, Y[crossed], place), crossed, before, length, 2 if turns else 1)

        # On F it is slowest on the near face where that ends, so that K is taken from there.
        near, there = (beyond(outer), outer) if crossed else (outer, beyond(outer))
        arcs, self.upright = [stretch(near, False, True, np.inf)], crosses and bool(X[0] == 0.0)
        given, distance = arcs[0], outer.d[0]
        if self.upright:
            arcs.append(stretch(there, True, False, np.inf))
        elif crosses:
            end, length = (ends.inner, outer.d + ends.inner.d) if crossed else (ends.far, ends.far.d)
            half = 0.5 * float(length[0])
            arcs += stretch(there, True, False, half), stretch(end, True, True, half)
            if crossed:
                given, distance = (arcs[1], outer.d[0]) if outer.d[0] < half else (arcs[2], ends.inner.d[0])
        self._disk, self._reached = disk, np.zeros(4, np.complex128)  # time, chi, psi and the centre
        self._pieces = list[tuple[RiseStretch, list[Chebyshev]]]()  # with series of these in u
        self.impact_speed = float(arcs[0].points(disk, np.array([-1.0]))[2][0])
        for arc in arcs:
            low = -1.0 if arc.before else 0.0
            state = arc.u_at(distance) if arc is given else low
            self._lay(arc, low, state)
            if arc is given:
                self.offset = float(self._reached[0].real)
            self._lay(arc, state, low + 1.0)
        self._starts = np.array([when(when.domain[0]) for _stretch, (when, *_) in self._pieces])
        self.half, self.chi_half, self.psi_half = self._reached[:3].real.tolist()
        self.centre_half = complex(self._reached[3])

    def _lay(self, stretch: RiseStretch, low: float, high: float) -> None:
        """Add the pieces of a part of a stretch, halved until their series have all digits."""
        left = [(low, high)] if low < high else []
        while left:
            low, high = left.pop()
            made, rounding = self._series(stretch, low, high)
            total = made.sum(axis=1)
            size = abs(self._reached) + abs(total) + [0.0, 1.0, 1.0, 1.0]
            if (abs(made[:, -_LAST:]).sum(axis=1) <= _TAIL * size + rounding).all():
                made[:, 0] += self._reached
                series = [Chebyshev(row, [low, high]) for row in (*made[:3].real, made[3])]
                self._pieces.append((stretch, series))
                self._reached += total
            else:
                middle = 0.5 * (low + high)
                if not low < middle < high:
                    raise InputError(_ENDLESS)
                left += [(middle, high), (low, middle)]

    @np.errstate(divide="ignore", invalid="ignore")  # where it does not move, which is refused
    def _series(self, stretch: RiseStretch, low: float, high: float) -> tuple[NDArray[np.complex128], Array]:
        """Time, chi, psi and centre over a piece, from 0 at its low end: coefficients (4, _NODES + 1).

        And what rounding of K may change (4).
        """
        nodes, width = chebpts1(_NODES), 0.5 * (high - low)
        u = low + width * (1.0 + nodes)
        q, z, speed, ratio, sigma4, unsure = stretch.points(self._disk, u)
        if not (unsure < _KNOWN).all():
            raise InputError(_ENDLESS)
        ds = width * stretch.distance(u)[1] / speed
        chi = self._reached[1].real + chebval(nodes, _integrated(ratio * ds))
        # eq. (2.33): d(a1 + i a2)/dt = (thetadot cos phi - i sigma4) e^(i chi)
        moved = q * (speed * q - 1j * sigma4) * np.exp(1j * chi)
        rates = np.stack([q, ratio, z * ratio - q * sigma4, moved]) * ds
        return _integrated(rates), (abs(rates) * unsure).mean(axis=1)

    def at(self, time: Array) -> Moving:
        """The rise at times since flat, 0 <= time <= half."""
        out = Moving(*(np.empty(time.shape, kind) for kind in (7 * "d" + "D")))
        number = np.searchsorted(self._starts, time, side="right") - 1
        for each in np.unique(number):
            (stretch, (when, *others)), here = self._pieces[each], number == each
            (low, high), slope = when.domain, when.deriv()
            table = np.linspace(low, high, _NODES)
            u = np.interp(time[here], when(table), table)
            for _ in range(_NEWTON_STEPS):
                u = np.clip(u - (when(u) - time[here]) / slope(u), low, high)
            q, z, speed, ratio, sigma4, _ = stretch.points(self._disk, u)
            made = q, z, speed, ratio / q, sigma4, *(series(u) for series in others)
            for column, part in zip(out, made, strict=True):
                column[here] = part
        return out

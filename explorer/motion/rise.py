"""One rise on F, from flat until it turns or stands upright: all that a limit motion is made of.

Its points are taken as distances in x = ln tan(theta/2) from the nearest of a few places, where it turns, passes
the vertical, is slow, or was given, so that no digit of the speed is lost. Time, angles and the centre are
Chebyshev series over stretches of such distances: down to flat in tan(theta/2), where nothing on F is singular,
with the root taken out at a turning point, and halved where the motion changes faster than a series can follow.
"""

from functools import cache
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.polynomial.chebyshev import chebint, chebpts1, chebvander
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.arcs import from_place, places
from explorer.motion.orbits import beyond, ends_of
from explorer.motion.starts import Motions
from explorer.phase.disk import Disk
from explorer.phase.states import Array

# For `compiled.warmup`
KERNELS = "turning_points.inward_batch", "turning_points.orbit_batch", "turning_points.point_batch"
Place: TypeAlias = "compiled.turning_points.Place[Array]"
Coefficients = NDArray[np.complex128]
_NODES = 32  # of a piece
# What the last coefficients of a piece may leave of its series; the last are so many.
_TAIL, _LAST = 1e-14, 3
_KNOWN = 1e-3  # how well K must be known where it is least, or where its next zero is
_HALVINGS = 1000  # down to the smallest numbers
_DEEPEST = 300.0  # in x: what lies below is flat
_NEWTON_STEPS = 5  # from a table as fine as the nodes, three double the digits up to rounding; two to spare


class Stretch(NamedTuple):
    """A part of a rise whose points are counted from one place: -1 <= u <= 0 before it, 0 <= u <= 1 behind it.

    crossed: whether it is on the other face. length: in x, inf down to flat. power: of |u| in the distance, 2
    where the rise turns at the place.
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
        return np.minimum(-np.log1p(-share), _DEEPEST), rate / (1.0 - share)


class Along(NamedTuple):
    """Points of a rise in natural units, as seen from the face that it leaves.

    q, z: sine and cosine of theta, the tilt from there; speed: of theta; ratio: sigma3/q. unsure: the relative
    error of K.
    """

    q: Array
    z: Array
    speed: Array
    ratio: Array
    sigma4: Array
    unsure: Array


class Moving(NamedTuple):
    """A motion on F at some times, natural units; theta: tilt from the flat state that it falls to.

    q: sin(theta), which theta near pi has no digits for. centre: a1 + i a2. turn: sigma3/q^2, the rate of chi.
    """

    theta: Array
    q: Array
    thetadot: Array
    chi: Array
    psi: Array
    turn: Array
    sigma4: Array
    centre: NDArray[np.complex128]


class Piece(NamedTuple):
    """A piece of a stretch with its series in u; `time` counts from `start`, since flat."""

    stretch: Stretch
    start: float
    time: Chebyshev
    chi: Chebyshev
    psi: Chebyshev
    centre: Chebyshev

    def solve(self, since: Array) -> Array:
        """u at times since its low end: Newton's method from a table."""
        (low, high), slope = self.time.domain, self.time.deriv()
        table = np.linspace(low, high, _NODES)
        u = np.interp(since, self.time(table), table)
        for _ in range(_NEWTON_STEPS):
            u = np.clip(u - (self.time(u) - since) / slope(u), low, high)
        return u


@cache
def _nodes() -> tuple[Array, Array, Array]:
    """Nodes on (-1, 1); matrices from values there to coefficients of their integral, and from these to values."""
    nodes, orders = chebpts1(_NODES), np.arange(_NODES + 1)
    integral: Array = chebint(np.linalg.inv(chebvander(nodes, _NODES - 1)), lbnd=-1)
    values: Array = np.cos(np.outer(orders, np.arccos(nodes)))
    return nodes, integral.T, values


class Rise:
    """One rise on F from flat to its turning point, or to the vertical where sigma3_bar = 0; natural units.

    half, chi_half, psi_half, centre_half: what time, angles and centre come to. offset: the time at the state that
    was given. upright: whether it ends at the vertical. impact_speed: its speed at flat.
    """

    def __init__(self, disk: Disk, motions: Motions, crossed: bool) -> None:
        """motions: the one through the state; crossed: whether that is beyond the vertical."""
        self._disk, self._X = disk, motions.starts.X
        self._Y = (motions.Y_far, motions.starts.Y) if crossed else (motions.starts.Y, motions.Y_far)
        state, inner, outer, _vertical, far, crosses = ends_of(disk, motions)
        self.upright = bool(crosses[0] and self._X[0] == 0.0)
        first, before = beyond(outer) if crossed else state, list[Stretch]()
        if crossed:
            before = self._way(True, outer, state, outer.d, outer.d - outer.crest)
            behind = self._way(True, state, inner, inner.d, inner.crest)
        else:
            behind = self._way(False, state, outer, outer.d, outer.crest)
            if crosses[0] and not self.upright:
                behind += self._way(True, beyond(outer), far, far.d, far.crest)
        up = self._stretch(first, False, True, np.inf)
        self.impact_speed = float(self._along(up, np.array([-1.0])).speed[0])
        self._pieces = list[Piece]()
        self.half, self.chi_half, self.psi_half, self.centre_half = 0.0, 0.0, 0.0, 0j
        for stretch in (up, *before):
            self._lay(stretch)
        self.offset = self.half
        for stretch in behind:
            self._lay(stretch)
        self._starts = np.array([piece.start for piece in self._pieces])

    def _stretch(self, place: Place, crossed: bool, before: bool, length: float) -> Stretch:
        turns = bool(place.K[0] == 0.0)
        if not place.error[0] < _KNOWN * (place.slow[0] if turns else place.K[0]):
            raise _endless()
        return Stretch(from_place(self._X, self._Y[crossed], place), crossed, before, length, 2 if turns else 1)

    def _way(self, crossed: bool, place: Place, to: Place, length: Array, crest: Array) -> list[Stretch]:
        """The way from one place up to the next; crest: how far from it the rise is slow, NaN where it is not."""
        if 0.0 < crest[0] < length[0]:
            start = from_place(self._X, self._Y[crossed], place)
            top = compiled.turning_points.Place(*places(self._disk, start, crest, crossed))
            none = np.full(1, np.nan)
            return self._way(crossed, place, top, crest, none) + self._way(crossed, top, to, length - crest, none)
        if np.isnan(length[0]):
            raise _endless()
        half = 0.5 * float(length[0])
        ways = self._stretch(place, crossed, False, half), self._stretch(to, crossed, True, half)
        return list(ways) if half > 0.0 else []

    @np.errstate(divide="ignore", invalid="ignore")  # at a turning point itself, and at flat
    def _along(self, stretch: Stretch, u: Array) -> Along:
        """Points of a stretch."""
        d, _rate = stretch.distance(u)
        starts = compiled.turning_points.Starts(*(np.full(u.size, column[0]) for column in stretch.start))
        at = compiled.turning_points.Place(*places(self._disk, starts, d, stretch.before != stretch.crossed))
        larger, face = 1.0 + at.r * at.r, -1.0 if stretch.crossed else 1.0
        q = 2.0 * at.r / larger
        speed = np.sqrt(2.0 * self._disk.body.inv_M * np.maximum(at.K, 0.0))
        return Along(q, face * at.w / larger, speed, at.sigma3 / q, face * at.sigma4, at.error / at.K)

    def _lay(self, stretch: Stretch) -> None:
        """Add the pieces of a stretch, halved until their series have all digits."""
        low, found = np.array([-1.0 if stretch.before else 0.0]), list[tuple[float, float, Coefficients]]()
        size = np.array([[self.half], [1.0], [1.0], [1.0]])
        for level in range(_HALVINGS):
            width = 0.5**level
            made, rounding = self._series(stretch, low, width)
            if level == 0:
                size += abs(made.sum(axis=2))  # about that of the whole stretch
            if not np.isfinite(rounding).all():
                raise _endless()
            left = abs(made[:, :, -_LAST:]).sum(axis=2)
            done = (left <= _TAIL * size + rounding).all(axis=0)
            found += [(low[i], low[i] + width, made[:, i]) for i in np.flatnonzero(done)]
            low = np.add.outer(low[~done], [0.0, 0.5 * width]).ravel()
            if not low.size:
                break
        else:
            raise _endless()
        for first, last, coefficients in sorted(found, key=lambda piece: piece[0]):
            coefficients[3] *= np.exp(1j * self.chi_half)
            total = coefficients.sum(axis=1)
            coefficients[1:, 0] += self.chi_half, self.psi_half, self.centre_half
            rows = (Chebyshev(row, [first, last]) for row in (*coefficients[:3].real, coefficients[3]))
            self._pieces.append(Piece(stretch, self.half, *rows))
            self.half += float(total[0].real)
            self.chi_half += float(total[1].real)
            self.psi_half += float(total[2].real)
            self.centre_half += complex(total[3])

    def _series(self, stretch: Stretch, low: Array, width: float) -> tuple[Coefficients, Array]:
        """Time, chi, psi and centre over pieces from `low` on, from 0 there: coefficients (4, n, _NODES + 1).

        And what rounding of K may change (4, n).
        """
        nodes, integral, values = _nodes()
        u = np.add.outer(low, 0.5 * width * (1.0 + nodes))
        at = Along(*(row.reshape(u.shape) for row in self._along(stretch, u.ravel())))
        with np.errstate(invalid="ignore", divide="ignore"):  # where it does not move, which is refused
            ds = 0.5 * width * stretch.distance(u)[1] / at.speed
            rates = np.stack([at.q, at.ratio, at.z * at.ratio - at.q * at.sigma4, 0j * at.q]) * ds
            # eq. (2.33): d(a1 + i a2)/dt = (thetadot cos phi - i sigma4) e^(i chi)
            chi = (rates[1] @ integral @ values).real
            rates[3] = rates[0] * (at.speed * at.q - 1j * at.sigma4) * np.exp(1j * chi)
            made = (rates @ integral).astype(np.complex128)
            return made, (abs(rates) * abs(at.unsure)).mean(axis=2)

    def at(self, time: Array) -> Moving:
        """The rise at times since flat, 0 <= time <= half."""
        rows, centre = np.empty((7, time.size)), np.empty(time.size, np.complex128)
        number = np.searchsorted(self._starts, time, side="right") - 1
        for each in np.unique(number):
            piece, here = self._pieces[each], number == each
            u = piece.solve(time[here] - piece.start)
            at = self._along(piece.stretch, u)
            tilt, turn = np.arctan2(at.q, at.z), at.ratio / at.q
            rows[:, here] = tilt, at.q, at.speed, piece.chi(u), piece.psi(u), turn, at.sigma4
            centre[here] = piece.centre(u)
        theta, q, speed, chi, psi, turn, sigma4 = rows
        return Moving(theta, q, speed, chi, psi, turn, sigma4, centre)


def _endless() -> InputError:
    return InputError(
        "limit motion: the motion comes to rest within rounding of an equilibrium or a separatrix, "
        "where the period is infinite"
    )

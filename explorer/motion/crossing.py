"""A rise on F that crosses the vertical and turns beside the other flat state, where it races as well.

That happens where sigma3_bar is small: eta of the other face is 2 I1 r'(0) sigma3_bar, eq. (6.2). The turning
point is then a race of its own, as sharp as sigma3_bar is small, which one series over the whole rise cannot
follow. So the rise is cut into pieces: up to the vertical in theta, and beyond it in v, where the chord
2 sin(tilt/2) from the other flat state is its least value times cosh v. In v the race is smooth, however near.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.chebyshev import HALF_PI, primitive
from explorer.phase.disk import Disk
from explorer.phase.roots import root
from explorer.phase.series import Series
from explorer.phase.states import Array

_DEGREE = 24  # of a piece: its coefficients fall by a digit or so each on pieces of length about one
_TURN_DEGREE = 48  # of the last piece, which is twice as long: even in v, so every second one vanishes
_TURN = 3.0  # its half: at v = 3 the chord is ten times its least
_TAIL = 1e-14  # what the last coefficients of a piece may leave of time and angles
_SHORTEST = 1e-6  # a piece that is not halved any more
_TABLE = 33  # entries of a piece from which Newton's method starts
_NEWTON_STEPS = 5  # from the table, three double the digits up to rounding; two to spare
_MARGIN = 2.0  # by which the least chord may be off its leading order, in its logarithm
_SMALLEST = 1e-300


class Along(NamedTuple):
    """Points of the rise: rates of time, and what the angles and the centre are made of; natural units."""

    theta: Array
    q: Array
    dt: Array
    speed: Array
    turn: Array
    sigma4: Array


class Piece(NamedTuple):
    """A part of the rise, low <= v <= high, with series in v, and what they start from."""

    crossed: bool
    low: float
    high: float
    start: float
    time: Series
    chi: Series
    psi: Series
    centre: Series


class CrossingRise:
    """One rise on F (face +1) from flat over the vertical to its turning point, natural units."""

    def __init__(self, disk: Disk, energy: float, sigma3_bar: float) -> None:
        b = disk.body
        self._disk = disk
        self._X = sigma3_bar / b.r0
        self._Y = 2.0 * b.dr0 * sigma3_bar
        self._excess = energy - float(disk.energy_at_flat(sigma3_bar))
        self.impact_speed = math.sqrt(2.0 / b.M * self._excess)
        self._least = least_chord(disk, energy, sigma3_bar)
        self.theta_turn = math.pi - 2.0 * math.asin(0.5 * self._least)
        far = math.acosh(math.sqrt(2.0) / self._least)
        turn = min(_TURN, far)
        self._pieces: list[Piece] = []
        self._lay(False, 0.0, HALF_PI)
        self._lay(True, -far, -turn)
        self._add(self._piece(True, -turn, turn, _TURN_DEGREE), 0.0)
        last = self._pieces[-1]
        self.half = last.start + float(last.time(0.0))
        self.chi_half, self.psi_half = float(last.chi(0.0)), float(last.psi(0.0))
        self.centre_half = complex(last.centre(0.0))

    def _lay(self, crossed: bool, low: float, high: float) -> None:
        """Add pieces from low to high, each short enough for its series."""
        ends = [high]
        while ends:
            piece = self._piece(crossed, low, ends[-1], _DEGREE)
            if _left_over(piece) > _TAIL and ends[-1] - low > _SHORTEST:
                ends.append(0.5 * (low + ends[-1]))
                continue
            low = ends.pop()
            self._add(piece, low)

    def _add(self, piece: Piece, end: float) -> None:
        """Add a piece, which is used up to `end`, behind the others."""
        if self._pieces:
            before = self._pieces[-1]
            start = before.start + float(before.time(before.high))
            chi, turn = float(before.chi(before.high)), np.exp(1j * float(before.chi(before.high)))
            piece = piece._replace(
                start=start,
                chi=piece.chi + chi,
                psi=piece.psi + float(before.psi(before.high)),
                centre=piece.centre * turn + complex(before.centre(before.high)),
            )
        self._pieces.append(piece._replace(high=end))

    def _piece(self, crossed: bool, low: float, high: float, degree: int) -> Piece:
        """Series between low and high, all from 0 at low and chi = 0 there."""
        nodes = 0.5 * (low + high) + 0.5 * (high - low) * np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
        at = self._along(crossed, nodes)

        chi = primitive(at.dt * at.turn, low, high)
        # eq. (2.33): d(a1 + i a2)/dt = (thetadot cos phi - i sigma4) e^(i chi). Behind the turning point, where
        # v > 0, the disk falls.
        thetadot = np.where(crossed & (nodes > 0.0), -at.speed, at.speed)
        centre = primitive(at.dt * (thetadot * at.q - 1j * at.sigma4) * np.exp(1j * chi(nodes)), low, high)
        psi = primitive(at.dt * (np.cos(at.theta) * at.turn - at.sigma4), low, high)
        return Piece(crossed, low, high, 0.0, primitive(at.dt, low, high), chi, psi, centre)

    def _along(self, crossed: bool, v: Array) -> Along:
        b, sign = self._disk.body, -1.0 if crossed else 1.0
        h = self._least * np.cosh(v) if crossed else 2.0 * np.sin(0.5 * np.maximum(v, _SMALLEST))
        out = np.empty((7, h.size))
        compiled.point.point_batch(h, self._X, self._Y if crossed else 0.0, self._disk.natural, out)
        at = compiled.point.Point(*out)
        speed = np.sqrt(2.0 / b.M * np.maximum(self._excess - at.V, 0.0))
        tilt = 2.0 * np.arcsin(0.5 * h)
        with np.errstate(invalid="ignore", divide="ignore"):
            dt = (self._least * abs(np.sinh(v)) / at.shape if crossed else 1.0) / speed
        return Along(
            np.pi - tilt if crossed else tilt, h * at.shape, dt, speed, at.ratio / (h * at.shape), sign * at.sigma4
        )

    def time_at(self, theta: float) -> float:
        """Time since flat at which the rise reaches theta."""
        if not 0.0 < theta <= self.theta_turn * (1.0 + 1e-9):
            raise InputError("limit motion: the state is not on the part of F that falls")
        crossed = theta > HALF_PI
        chord = 2.0 * math.sin(0.5 * (math.pi - theta)) if crossed else 0.0
        v = -math.acosh(max(chord / self._least, 1.0)) if crossed else theta
        (piece,) = [p for p in self._pieces if p.crossed == crossed and p.low <= v][-1:]
        return piece.start + float(piece.time(v))

    def at(self, time: Array) -> "Rising":
        """The rise at times since flat, 0 <= time <= half."""
        rows = np.empty((7, time.size))
        centre = np.empty(time.size, np.complex128)
        place = np.searchsorted([piece.start for piece in self._pieces], time, side="right") - 1
        for number, piece in enumerate(self._pieces):
            here = place == number
            v = _solve(piece, time[here] - piece.start)
            at = self._along(piece.crossed, v)
            rows[:, here] = at.theta, at.q, at.speed, piece.chi(v), piece.psi(v), at.turn, at.sigma4
            centre[here] = piece.centre(v)
        theta, q, speed, chi, psi, turn, sigma4 = rows
        return Rising(theta, q, speed, chi, psi, centre, turn, sigma4)


class Rising(NamedTuple):
    """Points of a rise in natural units. q: sin(theta), which theta near pi has no digits for; centre: a1 + i a2;
    turn: sigma3/q^2, the rate of chi."""

    theta: Array
    q: Array
    speed: Array
    chi: Array
    psi: Array
    centre: NDArray[np.complex128]
    turn: Array
    sigma4: Array


def least_chord(disk: Disk, energy: float, sigma3_bar: float) -> float:
    """2 sin(tilt/2) from the other flat state at the turning point there, if nothing bars the way to it."""
    b, excess = disk.body, energy - float(disk.energy_at_flat(sigma3_bar))
    X, Y = sigma3_bar / b.r0, 2.0 * b.dr0 * sigma3_bar
    # To leading order the least chord is |Y| sqrt(I1 / 2 (E - V_0)).
    guess = math.log(abs(Y)) + 0.5 * math.log(0.5 * b.I1 / excess)

    def kinetic(log_h: Array) -> Array:
        out = np.empty((7, log_h.size))
        compiled.point.point_batch(np.exp(log_h), X, Y, disk.natural, out)
        above: Array = excess - compiled.point.Point(*out).V
        return above

    return math.exp(root(kinetic, guess - _MARGIN, 0.5 * math.log(2.0)))


def _left_over(piece: Piece) -> float:
    """What the last coefficients leave of time, angles and centre; infinite where they are not finite."""
    tails = [abs(series.coef[-3:]).max() for series in (piece.time, piece.chi, piece.psi, piece.centre)]
    return float(np.nan_to_num(max(tails), nan=np.inf))


def _solve(piece: Piece, time: Array) -> Array:
    """v at times since the start of a piece: Newton's method from a table."""
    table, slope = np.linspace(piece.low, piece.high, _TABLE), piece.time.deriv()
    v = np.interp(time, piece.time(table), table)
    for _ in range(_NEWTON_STEPS):
        v = np.clip(v - (piece.time(v) - time) / slope(v), piece.low, piece.high)
    return v

"""The inverted pendulum keeling over: sigma3 = sigma4 = 0, energy above m g r (section 3.4)."""

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError
from explorer.motion.rise import primitive
from explorer.phase.disk import Disk
from explorer.phase.states import Array

_HALF_PI = 0.5 * np.pi


class Pendulum:
    """One swing from flat (theta = 0) over the vertical to flat (theta = pi), natural units.

    Symmetric about the vertical, so only the time of the first half is fitted, as a Chebyshev series
    in theta. Its degree grows as the energy nears m g r, where the swing takes for ever.
    """

    def __init__(self, disk: Disk, energy: float) -> None:
        self._factor, self._energy = 2.0 / disk.body.M, energy
        self.impact_speed = float(np.sqrt(self._factor * energy))
        degree = 64
        while True:
            nodes = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
            theta = 0.25 * np.pi * (1.0 + nodes)
            self._time = primitive(1.0 / self.speed(theta))
            tail = abs(self._time.coef[-4:]).max() / abs(self._time.coef).max()
            if tail < 1e-13 or degree >= 8192:
                break
            degree *= 2
        if tail > 1e-9:
            raise InputError(
                "limit motion: the energy is within rounding of m g r, where the disk stops upright for ever"
            )
        self.half = float(self._time(_HALF_PI))
        self.whole = 2.0 * self.half

    def speed(self, theta: Array) -> Array:
        """|thetadot|."""
        return np.sqrt(self._factor * (self._energy - np.sin(theta)))

    def time_at(self, theta: float) -> float:
        """Time since flat on the way over."""
        if theta <= _HALF_PI:
            return float(self._time(theta))
        return self.whole - float(self._time(np.pi - theta))

    def theta(self, time: Array) -> Array:
        """theta at times since flat, 0 <= time <= whole."""
        late = time > self.half
        early = np.where(late, self.whole - time, time)
        table = np.linspace(0.0, _HALF_PI, 513)
        theta = np.interp(early, self._time(table), table)
        for _ in range(5):
            theta = np.clip(theta - (self._time(theta) - early) * self.speed(theta), 0.0, _HALF_PI)
        return np.where(late, np.pi - theta, theta)

    @staticmethod
    def centre(theta: Array, swings: Array, jump: float) -> NDArray[np.complex128]:
        """a1 + i a2, from 0 at the impact before swing 0; chi is 0 in even and -jump in odd swings.

        In a swing the centre moves along e^(i chi) by 1 - cos theta; a whole one takes it 2 there, and
        the next, back from theta = pi, -2 along its own direction.
        """
        pairs, odd = np.floor(swings / 2.0), swings % 2.0
        back = np.exp(-1j * jump)
        per_pair = 2.0 - 2.0 * back
        there = pairs * per_pair + (1.0 - np.cos(theta))
        home = pairs * per_pair + 2.0 + back * ((1.0 - np.cos(theta)) - 2.0)
        return np.where(odd == 1.0, home, there)

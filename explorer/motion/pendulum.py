"""The inverted pendulum keeling over: sigma3 = sigma4 = 0, energy above m g r (section 3.4)."""

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError
from explorer.motion.chebyshev import HALF_PI, nodes, primitive, settled
from explorer.phase.disk import Disk
from explorer.phase.states import Array

# A swing at an energy 1e-12 above m g r, the nearest that rounding allows, needs the last of these degrees.
_FIRST_DEGREE, _LAST_DEGREE = 64, 8192
_TABLE = 513  # entries from which Newton's method starts; five steps from there end at rounding
_NEWTON_STEPS = 5


class Pendulum:
    """One swing from flat (theta = 0) over the vertical to flat (theta = pi), natural units.

    Symmetric about the vertical, so only the time of the first half is fitted, as a Chebyshev series
    in theta. Its degree grows as the energy nears m g r, where the swing takes for ever.
    """

    def __init__(self, disk: Disk, energy: float) -> None:
        self._factor, self._energy = 2.0 / disk.body.M, energy
        self.impact_speed = float(np.sqrt(self._factor * energy))
        made = settled(lambda n: [primitive(1.0 / self.speed(nodes(n)))], _FIRST_DEGREE, _LAST_DEGREE)
        if made is None:
            raise InputError(
                "limit motion: the energy is within rounding of m g r, where the disk stops upright for ever"
            )
        (self._time,) = made
        self.half = float(self._time(HALF_PI))
        self.whole = 2.0 * self.half

    def speed(self, theta: Array) -> Array:
        """|thetadot|."""
        return np.sqrt(self._factor * (self._energy - np.sin(theta)))

    def time_at(self, theta: float) -> float:
        """Time since flat on the way over."""
        if theta <= HALF_PI:
            return float(self._time(theta))
        return self.whole - float(self._time(np.pi - theta))

    def theta(self, time: Array) -> Array:
        """theta at times since flat, 0 <= time <= whole."""
        late = time > self.half
        early = np.where(late, self.whole - time, time)
        table = np.linspace(0.0, HALF_PI, _TABLE)
        theta = np.interp(early, self._time(table), table)
        for _ in range(_NEWTON_STEPS):
            theta = np.clip(theta - (self._time(theta) - early) * self.speed(theta), 0.0, HALF_PI)
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
        centre: NDArray[np.complex128] = np.where(odd == 1.0, home, there)
        return centre

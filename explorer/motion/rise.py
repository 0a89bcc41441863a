"""One rise on F from flat to its turning point: all that a limit motion is made of.

theta = theta_turn sin(alpha) takes the square root out of the turning point, and on F nothing is
singular at flat, so time, chi, psi and the centre are smooth in alpha and kept as Chebyshev series.
"""

import math

import numpy as np

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.chebyshev import HALF_PI, nodes, primitive, settled
from explorer.motion.crossing import CrossingRise, Rising, least_chord
from explorer.phase.disk import Disk
from explorer.phase.membership import well
from explorer.phase.roots import root
from explorer.phase.series import Series
from explorer.phase.states import Array

# Most rises are at rounding at degree 32 or 64; those that end beside an equilibrium take more.
_FIRST_DEGREE, _LAST_DEGREE = 32, 2048
_TABLE = 257  # entries from which Newton's method starts; four steps from there end at rounding
_NEWTON_STEPS = 4
_FLAT = 1e-12  # a tilt that counts as flat: V on F is V_0 there, to within this tilt
_OTHER_FLAT = np.pi - 1e-9  # a tilt beside the other flat state, where V on F grows without bound
_SMALLEST = 1e-300  # a tilt that the kernel can take the logarithm of
# Turning points flatter than this (rad) are as sharp as a race; for steeper ones one series does.
_BESIDE_FLAT = 0.1
_WELL_POINTS = 512  # tilts looked at, between the vertical and the well, for the barrier
# Of sigma3_bar over the energy: below, the rate of the race overflows, and no double tells the race from a jump.
_TINY = 1e-290


class Rise:
    """One rise on F (face +1) from flat to its turning point, natural units."""

    def __init__(self, disk: Disk, energy: float, sigma3_bar: float) -> None:
        self._disk = disk
        self._X = sigma3_bar / disk.body.r0
        self._energy = energy
        try:
            self.theta_turn = self._turning_point(sigma3_bar)
        except ValueError:
            raise InputError("limit motion: the state is flat and at rest to rounding") from None
        self.impact_speed = float(np.sqrt(2.0 / disk.body.M * self._kinetic(np.array([_FLAT]))[0]))
        # Where the period is infinite the series are not finite.
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            made = settled(self._series, _FIRST_DEGREE, _LAST_DEGREE)
        if made is None:
            raise InputError(
                "limit motion: the motion comes to rest within rounding of an equilibrium or a separatrix, "
                "where the period is infinite"
            )
        self._time, self._chi, self._psi = made
        self._centre = self._centre_series(self._time.degree())
        self.half = float(self._time(HALF_PI))
        self.chi_half = float(self._chi(HALF_PI))
        self.psi_half = float(self._psi(HALF_PI))
        self.centre_half = complex(self._centre(HALF_PI))
        self._table = np.linspace(0.0, HALF_PI, _TABLE)
        self._table_time = self._time(self._table)

    def _on_f(self, theta: Array) -> "compiled.falling.OnF[Array]":
        out = np.empty((4, theta.size))
        compiled.falling.on_f_batch(np.ascontiguousarray(theta), self._X, self._disk.natural, out)
        return compiled.falling.OnF(*out)

    def _kinetic(self, theta: Array) -> Array:
        """E - V at some tilts."""
        return self._energy - self._on_f(theta).V

    def _turning_point(self, sigma3_bar: float) -> float:
        """The tilt at which the rise ends; ValueError where it does not begin."""
        if self._kinetic(np.array([HALF_PI]))[0] <= 0.0:
            return root(self._kinetic, _FLAT, HALF_PI)
        edge, largest = well(self._disk)
        if abs(sigma3_bar) >= largest:
            return root(self._kinetic, HALF_PI, _OTHER_FLAT)
        # Past the barrier there is a well; the first turning point counts.
        grid = np.linspace(HALF_PI, HALF_PI - edge, _WELL_POINTS)
        blocked = self._energy < self._on_f(grid).V
        if not blocked.any():
            return root(self._kinetic, HALF_PI - edge, _OTHER_FLAT)
        first = int(np.argmax(blocked))
        return root(self._kinetic, grid[first - 1], grid[first])

    def _along(self, alpha: Array) -> tuple[Array, Array, "compiled.falling.OnF[Array]"]:
        """theta, |thetadot| and the point of F at alpha."""
        theta = self.theta_turn * np.sin(alpha)
        here = self._on_f(np.maximum(theta, _SMALLEST))
        speed = np.sqrt(2.0 / self._disk.body.M * np.maximum(self._energy - here.V, 0.0))
        return theta, speed, here

    def _series(self, degree: int) -> list[Series]:
        """time, chi and psi as series in alpha."""
        alpha = nodes(degree)
        theta, speed, here = self._along(alpha)
        dt = self.theta_turn * np.cos(alpha) / speed
        dpsi = np.cos(theta) * here.turn - here.sigma4
        return [primitive(dt), primitive(dt * here.turn), primitive(dt * dpsi)]

    def _centre_series(self, degree: int) -> Series:
        """a1 + i a2 as a series in alpha: its rate is (thetadot cos phi - i sigma4) e^(i chi), eq. (2.33)."""
        alpha = nodes(degree)
        theta, speed, here = self._along(alpha)
        dt = self.theta_turn * np.cos(alpha) / speed
        return primitive(dt * (speed * np.sin(theta) - 1j * here.sigma4) * np.exp(1j * self._chi(alpha)))

    def time_at(self, theta: float) -> float:
        """Time since flat at which the rise reaches theta."""
        if not 0.0 < theta <= self.theta_turn * (1.0 + 1e-9):
            raise InputError("limit motion: the state is not on the part of F that falls")
        return float(self._time(np.arcsin(min(theta / self.theta_turn, 1.0))))

    def at(self, time: Array) -> Rising:
        """The rise at times since flat, 0 <= time <= half."""
        slope = self._time.deriv()
        alpha = np.interp(time, self._table_time, self._table)
        for _ in range(_NEWTON_STEPS):
            alpha = np.clip(alpha - (self._time(alpha) - time) / slope(alpha), 0.0, HALF_PI)
        theta, speed, here = self._along(alpha)
        centre = np.asarray(self._centre(alpha), np.complex128)
        return Rising(
            theta, np.sin(theta), speed, self._chi(alpha), self._psi(alpha), centre, here.turn, here.sigma4
        )


def rise(disk: Disk, energy: float, sigma3_bar: float) -> Rise | CrossingRise:
    """The rise with these constants, by the series that can follow it. Raises InputError where there is none."""
    tiny = _TINY * max(energy, 1.0)
    if 0.0 < abs(sigma3_bar) < tiny:
        sigma3_bar = math.copysign(tiny, sigma3_bar)
    if crosses(disk, energy, sigma3_bar) and least_chord(disk, energy, sigma3_bar) < _BESIDE_FLAT:
        return CrossingRise(disk, energy, sigma3_bar)
    return Rise(disk, energy, sigma3_bar)


def crosses(disk: Disk, energy: float, sigma3_bar: float) -> bool:
    """Whether the rise passes the vertical and nothing bars its way to the other flat state."""
    edge, largest = well(disk)
    last = HALF_PI - edge if abs(sigma3_bar) < largest else HALF_PI
    out, theta = np.empty((4, _WELL_POINTS)), np.linspace(HALF_PI, last, _WELL_POINTS)
    compiled.falling.on_f_batch(theta, sigma3_bar / disk.body.r0, disk.natural, out)
    return sigma3_bar != 0.0 and bool((energy > compiled.falling.OnF(*out).V).all())

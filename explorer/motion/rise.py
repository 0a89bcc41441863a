"""One rise on F from flat to its turning point: all that a limit motion is made of.

theta = theta_turn sin(alpha) takes the square root out of the turning point, and on F nothing is
singular at flat, so time, chi, psi and the centre are smooth in alpha and kept as Chebyshev series.
"""

from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.fft import dct
from scipy.optimize import brentq

from explorer import compiled
from explorer.errors import InputError
from explorer.phase.disk import Disk
from explorer.phase.membership import well
from explorer.phase.states import Array

_HALF_PI = 0.5 * np.pi


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
        self.impact_speed = float(np.sqrt(2.0 / disk.body.M * (energy - self._on_f(np.array([1e-12]))[2][0])))
        self._fit()

    def _on_f(self, theta: Array) -> Array:
        out = np.empty((4, theta.size))
        disk = self._disk
        compiled.falling.on_f_batch(np.ascontiguousarray(theta), self._X, disk.body, disk.series, out)
        return out

    def _turning_point(self, sigma3_bar: float) -> float:
        def excess(theta: float) -> float:
            return float(self._on_f(np.array([theta]))[2][0]) - self._energy

        if excess(_HALF_PI) >= 0.0:
            return brentq(excess, 1e-12, _HALF_PI, xtol=1e-15, rtol=1e-15)
        edge, largest = well(self._disk)
        lower = _HALF_PI
        if abs(sigma3_bar) < largest:
            # Past the barrier there is a well; the first turning point counts.
            grid = np.linspace(_HALF_PI, _HALF_PI - edge, 512)
            blocked = self._on_f(grid)[2] > self._energy
            if blocked.any():
                first = int(np.argmax(blocked))
                return brentq(excess, grid[first - 1], grid[first], xtol=1e-15, rtol=1e-15)
            lower = _HALF_PI - edge
        return brentq(excess, lower, np.pi - 1e-9, xtol=1e-15, rtol=1e-15)

    def _fit(self) -> None:
        degree = 32
        while True:
            # Where the period is infinite the series are not finite; that is looked at below.
            with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
                series = self._series(degree)
            tail = np.max([abs(s.coef[-4:]).max() / abs(s.coef).max() for s in series[:3] if s.coef.any()])
            if tail < 1e-13 or degree >= 2048:
                break
            degree *= 2
        if not tail <= 1e-9:  # NaN where the speed is lost in rounding
            raise InputError(
                "limit motion: the motion comes to rest within rounding of an equilibrium or a separatrix, "
                "where the period is infinite"
            )
        self._time, self._chi, self._psi, self._centre = series
        self.half = float(self._time(_HALF_PI))
        self.chi_half = float(self._chi(_HALF_PI))
        self.psi_half = float(self._psi(_HALF_PI))
        self.centre_half = complex(self._centre(_HALF_PI))
        self._table = np.linspace(0.0, _HALF_PI, 257)
        self._table_time = self._time(self._table)

    def _series(self, degree: int) -> tuple[Chebyshev, Chebyshev, Chebyshev, Chebyshev]:
        """time, chi, psi and a1 + i a2 as Chebyshev series in alpha."""
        nodes = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
        alpha = 0.5 * _HALF_PI * (1.0 + nodes)
        theta = self.theta_turn * np.sin(alpha)
        turn, sigma4, V, _ = self._on_f(theta)
        q, z = np.sin(theta), np.cos(theta)
        rate = np.sqrt(2.0 / self._disk.body.M * np.maximum(self._energy - V, 0.0))
        dt = self.theta_turn * np.cos(alpha) / rate
        time = primitive(dt)
        chi = primitive(dt * turn)
        psi = primitive(dt * (z * turn - sigma4))
        # eq. (2.33): d(a1 + i a2)/dt = (thetadot cos phi - i sigma4) e^(i chi)
        centre = primitive(dt * (rate * q - 1j * sigma4) * np.exp(1j * chi(alpha)))
        return time, chi, psi, centre

    def time_at(self, theta: float) -> float:
        """Time since flat at which the rise reaches theta."""
        if not 0.0 < theta <= self.theta_turn * (1.0 + 1e-9):
            raise InputError("limit motion: the state is not on the part of F that falls")
        return float(self._time(np.arcsin(min(theta / self.theta_turn, 1.0))))

    def at(self, time: Array) -> tuple[Array, Array, Array, Array, Any, Array]:
        """(theta, |thetadot|, chi, psi, a1 + i a2, rates) at times since flat, 0 <= time <= half.

        rates (2, n): sigma3/q^2 and sigma4.
        """
        slope = self._time.deriv()
        alpha = np.interp(time, self._table_time, self._table)
        for _ in range(4):
            alpha = np.clip(alpha - (self._time(alpha) - time) / slope(alpha), 0.0, _HALF_PI)
        theta = self.theta_turn * np.sin(alpha)
        rates = self._on_f(np.maximum(theta, 1e-300))
        speed = np.sqrt(2.0 / self._disk.body.M * np.maximum(self._energy - rates[2], 0.0))
        return theta, speed, self._chi(alpha), self._psi(alpha), self._centre(alpha), rates[:2]


def primitive(values: Any) -> Chebyshev:
    """The integral from 0 of a function of alpha given at Chebyshev nodes, in their usual order."""
    coefficients = dct(values, type=2) / values.size
    coefficients[0] *= 0.5
    return Chebyshev(coefficients, domain=[0.0, _HALF_PI]).integ(lbnd=0.0)

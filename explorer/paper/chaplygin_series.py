"""Solutions of the rescaled Chaplygin equations (4.2) near flat, as NumPy series for checks.

Slow and plain; shares no code with the compiled layer, which it judges misprints without.
"""

from dataclasses import dataclass

import numpy as np

from explorer.phase.disk import Disk

_TERMS = 120  # radius 2, used up to 1: below rounding


@dataclass(frozen=True)
class Chaplygin:
    """Series in S = 1 -+ z for the body with parameters c, d, eqs (4.3), (4.7); S up to 1."""

    c: float
    d: float

    @classmethod
    def of(cls, disk: Disk) -> "Chaplygin":
        rim = disk.m * disk.r**2
        axial = disk.I3 + rim
        return cls(rim * disk.I3 / (axial * disk.I1), disk.I3**2 / (disk.I1 * axial))

    def recessive(self, S: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """r and r', eqs (5.1)-(5.3), as functions of S = 1 + z."""
        return _sum(self._recessive(), S), _sum(_derivative(self._recessive()), S)

    def near_flat(
        self, a: float, epsilon: float, S: np.ndarray | float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """x, y and W at z = 1 - S, eqs (5.9), (4.6), from a = X/r(0) and epsilon of eq. (6.5)."""
        S = np.asarray(S, dtype=float)
        half, (r, dr) = 0.5 * self.c, self.recessive(S)
        x = a * r + epsilon * (half * r * np.log(S) + _sum(self._regular(), S))
        slope = half * (dr * np.log(S) + r / S) + _sum(_derivative(self._regular()), S)
        y = -(a * dr + epsilon * slope)
        q2 = S * (2.0 - S)
        return x, y, 0.5 * self.d * x * x / q2 + 0.5 * y * y + np.sqrt(q2)

    def slope_of_W(self, x: np.ndarray, y: np.ndarray, S: np.ndarray | float) -> np.ndarray:
        """W'(z) at z = 1 - S, eq. (4.10)."""
        S = np.asarray(S, dtype=float)
        z, q2 = 1.0 - S, S * (2.0 - S)
        return self.d * z * x * x / q2**2 + (self.c + self.d) * x * y / q2 - z / np.sqrt(q2)

    @property
    def v1(self) -> float:
        """First coefficient of the regular part v of eq. (5.5)."""
        return float(self._regular()[1])

    def _recessive(self) -> np.ndarray:
        r = np.zeros(_TERMS)
        r[1] = 1.0
        for n in range(1, _TERMS - 1):
            r[n + 1] = (self.c + n * (n - 1)) / (2.0 * n * (n + 1)) * r[n]
        return r

    def _regular(self) -> np.ndarray:
        """Coefficients of v in x = (c/2) r ln S + v, the solution with x(0) = 0 at S = 1."""
        r, v = self._recessive(), np.zeros(_TERMS)
        v[0] = 1.0
        for k in range(1, _TERMS - 1):
            source = 0.5 * self.c * (2 * (2 * k + 1) * r[k + 1] - (2 * k - 1) * r[k])
            v[k + 1] = ((k * (k - 1) + self.c) * v[k] - source) / (2.0 * k * (k + 1))
        return v - v.sum() / r.sum() * r


def _sum(coefficients: np.ndarray, S: np.ndarray | float) -> np.ndarray:
    return np.polynomial.polynomial.polyval(S, coefficients)


def _derivative(coefficients: np.ndarray) -> np.ndarray:
    return np.polynomial.polynomial.polyder(coefficients)

"""What the paper gives in closed form or as a series: parameters, r(0) and r'(0), potentials, limits at flat.

Written for reading, in the disk's own units, and apart from the explorer, which it judges.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyval
from scipy.special import rgamma

from explorer.paper.four_dimensions import sigma_energy
from explorer.phase.disk import Disk
from explorer.phase.states import Array


class Parameters(NamedTuple):
    """c, d, b of eqs (4.3), (4.7), (4.5)."""

    c: float
    d: float
    b: float


def parameters(disk: Disk) -> Parameters:
    """The two dimensionless parameters of a body and the unit of its sigma4."""
    inertia = disk.m * disk.r**2
    J = disk.I3 + inertia
    c, d = inertia * disk.I3 / (J * disk.I1), disk.I3**2 / (disk.I1 * J)
    return Parameters(c, d, float(np.sqrt(disk.m * disk.g * disk.r / J)))


def at_vertical(c: Any) -> tuple[Any, Any]:
    """r(0), r'(0) by gamma functions, eqs (5.11), (5.12); c may be complex."""
    root = np.sqrt(1.0 - 4.0 * np.asarray(c, dtype=complex)) / 4.0
    r0 = 0.5 * np.sqrt(np.pi) * rgamma(1.25 - root) * rgamma(1.25 + root)
    return r0, np.sqrt(np.pi) * rgamma(0.75 - root) * rgamma(0.75 + root)


def recessive_at_vertical(disk: Disk) -> tuple[float, float]:
    """r(0), r'(0) of a body."""
    r0, dr0 = at_vertical(parameters(disk).c)
    return float(r0.real), float(dr0.real)


def eta_per_eta_hat(disk: Disk) -> float:
    """I3 r(0), which is eta over eta_hat."""
    return disk.I3 * recessive_at_vertical(disk)[0]


def line_ratio(disk: Disk) -> float:
    """sigma4_bar over sigma3_bar on l_+, eq. (6.1)."""
    r0, dr0 = recessive_at_vertical(disk)
    return disk.I1 * dr0 / (disk.I3 * r0)


def flat_spin(disk: Disk, sigma3_bar: float = 1.0) -> float:
    """The limit of sigma4 at face +1 on l_+, eq. (6.15), which is B of eq. (7.19)."""
    return disk.I1 * sigma3_bar / eta_per_eta_hat(disk)


def flat_potential(disk: Disk, sigma3_bar: float = 1.0) -> float:
    """V_0, eq. (6.9)."""
    return 0.5 * (disk.I3 + disk.m * disk.r**2) * flat_spin(disk, sigma3_bar) ** 2


def impact_speed(disk: Disk, energy: float, sigma3_bar: float = 1.0) -> float:
    """A, eq. (7.1)."""
    M = disk.I1 + disk.m * disk.r**2
    return float(np.sqrt(2.0 * (energy - flat_potential(disk, sigma3_bar)) / M))


def coefficients(c: float, terms: int) -> Array:
    """2^n r_n for n = 0 .. terms, eqs (5.2), (5.3), so that no power overflows."""
    n = np.arange(1, terms)
    return np.concatenate([[0.0, 2.0], 2.0 * np.cumprod((c + n * (n - 1.0)) / (n * (n + 1.0)))])


def recessive(c: float, z: Any, terms: int = 120) -> tuple[Any, Any]:
    """r and r' by eq. (5.1); 120 terms are at rounding for z <= 0.4."""
    scaled = coefficients(c, terms)
    x = 0.5 * (1.0 + z)
    return polyval(x, scaled), 0.5 * polyval(x, scaled[1:] * np.arange(1, terms + 1))


def basis(c: float, z: Any) -> tuple[Any, Any, Any, Any]:
    """Even and odd solution of eq. (4.4), each with its derivative: series about the vertical; z may be complex.

    All coefficients are positive for c > 0, so nothing cancels; radius 1.
    """
    terms = int(min(20_000, 40.0 / -np.log(max(0.05, float(np.max(np.abs(z)))))))
    series = np.zeros(terms + 2)
    series[:2] = 1.0
    for n in range(terms):
        series[n + 2] = (n * (n - 1) + c) / ((n + 1) * (n + 2)) * series[n]
    even, odd = series[::2], series[1::2]
    z2 = z * z
    slopes = even[1:] * np.arange(2, 2 * even.size, 2), odd * np.arange(1, 2 * odd.size, 2)
    return polyval(z2, even), z * polyval(z2, slopes[0]), z * polyval(z2, odd), polyval(z2, slopes[1])


def scaled(c: float, d: float, X: Any, Y: Any, z: Any) -> tuple[Any, Any, Any]:
    """x, y of eq. (4.2) with x(0) = X, y(0) = Y, and W of eqs (4.6), (4.8)."""
    even, deven, odd, dodd = basis(c, z)
    x, y = X * even + Y * odd, X * deven + Y * dodd
    return x, y, 0.5 * d * x * x / (1.0 - z * z) + 0.5 * y * y + np.sqrt(1.0 - z * z)


def chaplygin(disk: Disk, bar3: Any, bar4: Any, z: Any) -> tuple[Any, Any]:
    """sigma_3, sigma_4 at sigma_1 = z of the solution (3.3) of Chaplygin's equations. Needs I3 > 0."""
    even, deven, odd, dodd = basis(parameters(disk).c, z)
    k = disk.I3 / disk.I1
    return bar3 * even - k * bar4 * odd, bar4 * dodd - bar3 * deven / k


def bars(disk: Disk, z: Any, s3: Any, s4: Any) -> tuple[Any, Any]:
    """The constants (3.5) of a state: the inverse of `chaplygin`, whose determinant is 1."""
    even, deven, odd, dodd = basis(parameters(disk).c, z)
    k = disk.I3 / disk.I1
    return dodd * s3 + k * odd * s4, deven * s3 / k + even * s4


def amended(disk: Disk, bar3: Any, bar4: Any, z: Any) -> Any:
    """V of eq. (3.8) at sigma_1 = z: the energy of a motion that turns there."""
    return sigma_energy(disk, (z, 0.0, *chaplygin(disk, bar3, bar4, z)))

"""Steady motions, where phi stays: straight and circular rolling, spinning upright; which are stable.

At a tilt phi a steady motion is fixed by its precession dchi/dt = sigma3/cos^2 phi, since V' = 0 is linear in
sigma4 then. So all of them are a surface over (phi, precession), but for straight rolling (both zero, any sigma4).
They are stable iff V'' > 0. Rates in units of the disk, angles in rad, lengths in the units of the disk.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import InputError, one_of, shown
from explorer.phase.arguments import read_columns
from explorer.phase.constants import constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.falling_set import well
from explorer.phase.potential import DEGENERATE, Potential, potential
from explorer.phase.states import Array
from explorer.phase.steady import circular_rolling, steady_motions

_CIRCLE = 0.25 * math.pi, 2.0  # lean (rad) and radius (radii of the disk) at which `thresholds` rolls


def stability_edges(disk: Disk, phi: ArrayLike) -> Array:
    """dchi/dt > 0 at which steady motions of tilt phi change stability, (2, n): faster, slower; NaN where none do.

    V'' = 0 is quadratic in the square of the precession: the saddle-nodes of the potential. At phi = 0 the faster
    one is the threshold of spinning upright; the slower one goes to zero there, to that of straight rolling.
    """
    require_axial_inertia(disk)
    (angle,), _ = read_columns(phi=phi)
    b, q, z = disk.body, np.cos(angle), np.sin(angle)
    # Coefficients of the quadratic, highest power first.
    two = b.M * q * q + z * z * b.I1 * (2.0 - b.I3 / b.J)
    one, none = z * z / q - q, b.k * z * z / (b.J * q * q)
    with np.errstate(invalid="ignore"):
        larger = np.where(one < 0.0, np.sqrt(one * one - 4.0 * two * none) - one, np.nan) / (2.0 * two)
        return np.sqrt(np.stack([larger, none / (two * larger)])) * disk.rate_unit


def last_unstable_tilt(disk: Disk) -> float:
    """phi (rad) up to which some steady motions are unstable; beyond it all are stable. Both edges meet there."""
    require_axial_inertia(disk)
    b = disk.body
    # The discriminant of V'' = 0 vanishes, a quadratic in cos^2 phi, of which one root lies between 1/2 and 1.
    unit, steep = 4.0 * b.k / b.J, b.I1 * (2.0 - b.I3 / b.J)
    two, one, none = 4.0 + unit * (b.M - steep), unit * (2.0 * steep - b.M) - 4.0, 1.0 - unit * steep
    cosine = math.sqrt((math.sqrt(one * one - 4.0 * two * none) - one) / (2.0 * two))
    return math.acos(cosine)


def fold_curve(disk: Disk, points: int = 400) -> tuple[Array, Array]:
    """(sigma3_bar, sigma4_bar) where two steady motions merge (V' = V'' = 0), a closed curve with four cusps.

    The cusps are the thresholds of spinning upright and of straight rolling. Inside there is a saddle.
    """
    # In t both ends, where the two edges meet, and the vertical are smooth; t = 0 is kept out
    t = 0.5 * np.pi * (1.0 - np.linspace(0.0, 1.0, points)[:-1] ** 2)
    phi = last_unstable_tilt(disk) * (1.0 - 1e-12) * np.sin(t)
    fast, slow = (np.nan_to_num(row) for row in stability_edges(disk, phi))
    tilts = np.concatenate([-phi[::-1], -phi, phi[::-1], phi])
    turns = np.concatenate([slow[::-1], fast, fast[::-1], slow])
    half = constants(steady_motions(disk, 0.5 * np.pi - tilts, turns).states)
    x = np.concatenate([half.sigma3_bar, -half.sigma3_bar, half.sigma3_bar[:1]])
    return x, np.concatenate([half.sigma4_bar, -half.sigma4_bar, half.sigma4_bar[:1]])


def rolling_threshold(disk: Disk) -> float:
    """sigma4 above which straight rolling is stable: its square is m g r I1/(I3 J)."""
    require_axial_inertia(disk)
    J = disk.I3 + disk.m * disk.r**2
    return math.sqrt(disk.m * disk.g * disk.r * disk.I1 / (disk.I3 * J))


def spinning_threshold(disk: Disk) -> float:
    """dchi/dt above which spinning upright in place is stable: its square is m g r/M."""
    return math.sqrt(disk.m * disk.g * disk.r / (disk.I1 + disk.m * disk.r**2))


def thresholds(disk: Disk) -> dict[str, dict[str, float]]:
    """Thresholds in closed form, and sigma3_bar* of the well; units of the disk."""
    angle, most = well(disk)
    lean, radius = _CIRCLE[0], _CIRCLE[1] * disk.r
    circle = float(circular_rolling(disk, lean, radius).precession)
    return {
        "straight_rolling": {"closed_form": rolling_threshold(disk)},
        "spinning_upright": {"closed_form": spinning_threshold(disk)},
        "circular_rolling": {"lean": lean, "radius": radius, "closed_form": circle},
        "well": {"sigma3_bar": most * disk.rate_unit, "phi": angle},
    }


@dataclass(frozen=True, eq=False)
class Branch:
    """Equilibria that follow each other along a path through the constants of motion.

    Attributes
    ----------
    parameter : array
        Parameter of the path, units of the disk.
    phi : array
        Tilts (rad).
    energy : array
        Units of the disk.
    kind : str
        "centre" or "saddle".

    Examples
    --------
    >>> import explorer as ex
    >>> branch, *_ = ex.bifurcation(ex.Disk.uniform(), "line", [0.1, 0.2, 0.3])
    >>> branch.parameter
    array([0.1, 0.2, 0.3])
    """

    parameter: Array
    phi: Array
    energy: Array
    kind: str


class Path(NamedTuple):
    """A path in the plane of constants of motion.

    potential: at a value of its parameter. threshold: the parameter at which branches meet or reach flat.
    """

    potential: Callable[[Disk, float], Potential]
    threshold: Callable[[Disk], float]


PATHS = {
    "spinning": Path(lambda disk, bar: potential(disk, bar, sigma4_bar=0.0), spinning_threshold),
    "rolling": Path(lambda disk, bar: potential(disk, 0.0, sigma4_bar=bar), rolling_threshold),
    "line": Path(potential, lambda disk: well(disk).sigma3_bar * disk.rate_unit),
}


def bifurcation(disk: Disk, path: str, parameter: ArrayLike) -> tuple[Branch, ...]:
    """Steady motions along a path in the plane of constants of motion.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    path : str
        "spinning" (sigma4_bar = 0), "rolling" (sigma3_bar = 0) or "line" (on l_+).
    parameter : array_like
        Increasing values of sigma3_bar for "spinning" and "line", of sigma4_bar for "rolling"; units of the disk.

    Returns
    -------
    tuple of Branch
        Each follows one steady motion (an equilibrium of V) along the path, as long as neither the number of
        equilibria nor their kinds change.

    Raises
    ------
    InputError
        For an unknown path, and values that are not numbers.

    References
    ----------
    Eqs (3.8) and (6.2) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> [branch.kind for branch in ex.bifurcation(ex.Disk.uniform(), "line", [0.1, 0.2])]
    ['centre', 'saddle']
    """
    require_axial_inertia(disk)
    one_of("path", path, PATHS)
    (values,), _ = read_columns(parameter=parameter)
    if not np.isfinite(values).all():
        raise InputError(f"parameter = {shown(parameter)}: give finite numbers")
    # The potential is quadratic in the constants of a path, the same where both change their signs.
    steady = cache(
        lambda size: [at for at in PATHS[path].potential(disk, size).equilibria if at.kind != DEGENERATE]
    )
    rows = [(value, steady(abs(float(value)))) for value in values]
    branches: list[Branch] = []
    for kinds, group in groupby(rows, key=lambda row: tuple(at.kind for at in row[1])):
        members = list(group)
        at = np.array([value for value, _ in members])
        for number, kind in enumerate(kinds):
            phi, energy = np.array([(each[number].phi, each[number].energy) for _, each in members]).T
            branches.append(Branch(at, phi, energy, kind))
    return tuple(branches)


@lru_cache(maxsize=8)
def whole_path(disk: Disk, path: str) -> tuple[Branch, ...]:
    """The branches along all of a path, dense where they meet or reach flat; seconds of root-finding, so kept."""
    near = np.geomspace(1e-7, 1.0, 100)  # branches meet like a square root: up to tilts of 3e-4 rad
    # Towards zero tilts reach flat
    half = PATHS[path].threshold(disk) * np.unique(
        np.concatenate([1.0 - near[:-1], 1.0 + near, np.geomspace(1e-5, 0.1, 40)])
    )
    return bifurcation(disk, path, np.concatenate([-half[::-1], half]))

"""Energies of steady motions along a path through the constants, and what the motions between them look like."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from explorer.errors import InputError, number, one_of, shown
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array
from explorer.portrait.potential import Potential
from explorer.portrait.steady import PATHS, Branch, bifurcation, path_values

_SHARES = (0.55, 1.2)  # of the threshold: where the default places lie
_SAME = 1e-9  # of an energy: nearer levels are one


@dataclass(frozen=True)
class BifurcationPortraits:
    """Energies of steady motions along a path, with the potentials at some places of the plane.

    Attributes
    ----------
    disk : Disk
    path : str
        As for `bifurcation`.
    parameter, floor : array (n)
        Along the path, and the energy below which there is no motion; units of the disk.
    branches : tuple of Branch
        Steady motions, with their energies.
    threshold : float
        The value of the parameter at which steady motions merge.
    places : tuple of (float, float)
        Values of the parameter and energies, units of the disk.
    potentials : tuple of Potential
        At each place.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.bifurcation_portraits(ex.Disk.uniform(), "line")
    >>> len(found.potentials) == len(found.places)
    True
    """

    disk: Disk
    path: str
    parameter: Array
    floor: Array
    branches: tuple[Branch, ...]
    threshold: float
    places: tuple[tuple[float, float], ...]
    potentials: tuple[Potential, ...]


def bifurcation_portraits(
    disk: Disk, path: str, places: Sequence[tuple[float, float]] | None = None
) -> BifurcationPortraits:
    """The energies of steady motions along a path in the plane of constants, and potentials at some places.

    Parameters
    ----------
    disk : Disk
    path : str
        "spinning", "rolling" or "line", as for `explorer.portrait.bifurcation`.
    places : sequence of (float, float), optional
        Values of the path's parameter and energies, units of the disk; by default one in each region of the plane.

    Returns
    -------
    BifurcationPortraits

    Raises
    ------
    InputError
        For an unknown path, no places, or a place with an energy below all motions.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.portrait import bifurcation_portraits
    >>> found = bifurcation_portraits(ex.Disk.uniform(), "line")
    >>> len(found.places), round(found.threshold, 5)
    (4, 0.34456)
    """
    require_axial_inertia(disk)
    one_of("path", path, PATHS)
    threshold = max(path_values(disk, path)[1])
    chosen = tuple(_one_in_each_region(disk, path, threshold) if places is None else _pairs(places))
    if not chosen:
        raise InputError("places: give at least one (parameter, energy)")
    potentials = tuple(PATHS[path](disk, at) for at, _ in chosen)
    for (at, energy), potential in zip(chosen, potentials, strict=True):
        if not energy > potential.bottom:
            raise InputError(
                f"places: there is no motion of energy {energy:g} at {at:g}; give more than {potential.bottom:g}"
            )
    parameter = _grid(threshold)
    branches = bifurcation(disk, path, parameter)
    floor = _floor(disk, path, parameter, branches)
    return BifurcationPortraits(disk, path, parameter, floor, branches, threshold, chosen, potentials)


def _pairs(places: object) -> list[tuple[float, float]]:
    """The places that a user gives. Raises InputError."""
    try:
        return [(number("places", at), number("places", energy)) for at, energy in list(places)]  # type: ignore[call-overload]
    except (TypeError, ValueError, ArithmeticError):
        raise InputError(f"places = {shown(places)}: give pairs (parameter, energy)") from None


def _levels(potential: Potential) -> list[float]:
    """Energies at which the motions change: where V ends at flat, and of equilibria; increasing."""
    ends = [potential.flat_value(face) * potential.disk.energy_unit for face in (-1, 1)]
    found: list[float] = []
    for energy in sorted([end for end in ends if np.isfinite(end)] + [at.energy for at in potential.equilibria]):
        if not found or energy - found[-1] > _SAME * potential.disk.energy_unit:
            found.append(energy)
    return found


def _one_in_each_region(disk: Disk, path: str, threshold: float) -> list[tuple[float, float]]:
    """Between the levels on one side of the threshold and above them, and as high on its other side."""
    inner, outer = (share * threshold for share in _SHARES)
    levels = _levels(PATHS[path](disk, inner))
    energies = [0.5 * (low + high) for low, high in pairwise(levels)]
    energies.append(levels[-1] + 0.25 * disk.energy_unit)
    beyond = max(energies[-1], _levels(PATHS[path](disk, outer))[-1] + 0.1 * disk.energy_unit)
    return [(inner, energy) for energy in energies] + [(outer, beyond)]


def _grid(threshold: float) -> Array:
    """Values of the parameter from zero to well beyond the threshold, dense at both."""
    near = np.geomspace(1e-6, 0.2, 30)
    share = np.concatenate([near, np.linspace(0.2, 1.5, 40), 1.0 - near, 1.0 + near])
    return threshold * np.unique(share)


def _floor(disk: Disk, path: str, parameter: Array, branches: Sequence[Branch]) -> Array:
    """The least energy of all motions along the path."""
    if path == "line":
        return np.asarray(disk.energy_at_flat(parameter / disk.rate_unit)) * disk.energy_unit
    floor = np.full(parameter.size, np.inf)
    for branch in branches:
        rows = np.searchsorted(parameter, branch.parameter)
        floor[rows] = np.minimum(floor[rows], branch.energy)
    for row in np.flatnonzero(np.isinf(floor)):  # at the threshold, where the one steady motion is of no branch
        floor[row] = PATHS[path](disk, float(parameter[row])).bottom
    return floor

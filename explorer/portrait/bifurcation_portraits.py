"""Steady motions along a path, and what the motions between them look like."""

from collections.abc import Sequence
from dataclasses import dataclass

from explorer.errors import InputError, one_of
from explorer.phase.disk import Disk
from explorer.portrait.potential import Potential
from explorer.portrait.steady import PATHS, Branch, whole_path

_SHARES = (0.4, 0.8, 1.05)  # of the threshold


@dataclass(frozen=True)
class BifurcationPortraits:
    """A bifurcation diagram, with the potentials at some of its places.

    path: as for `bifurcation`. branches, thresholds: of all of it. places: values of the parameter, units of the
    disk, with the potential at each.
    """

    disk: Disk
    path: str
    branches: tuple[Branch, ...]
    thresholds: tuple[float, ...]
    places: tuple[float, ...]
    potentials: tuple[Potential, ...]


def bifurcation_portraits(disk: Disk, path: str, shares: Sequence[float] = _SHARES) -> BifurcationPortraits:
    """The steady motions along a path in the plane of constants, and potentials before and after the threshold.

    Parameters
    ----------
    disk : Disk
    path : str
        "spinning", "rolling" or "line", as for `explorer.portrait.steady.bifurcation`.
    shares : sequence of float
        Where the potentials are, in thresholds.

    Returns
    -------
    BifurcationPortraits

    Raises
    ------
    InputError
        For an unknown path, or no shares.
    """
    one_of("path", path, list(PATHS))
    if not shares:
        raise InputError("shares: give at least one place, in thresholds")
    branches, thresholds = whole_path(disk, path)
    places = tuple(share * max(thresholds) for share in shares)
    return BifurcationPortraits(
        disk, path, branches, thresholds, places, tuple(PATHS[path](disk, place) for place in places)
    )

"""The race number of all bodies, and by how much the two limit motions differ per fall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer.errors import InputError, positive, shown, whole
from explorer.motion.passages import passages
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array

MOST = 16.0  # of m r^2/I1; a hoop has 2, a uniform disk 4
# Where the gap is measured, natural units of eta_hat: the law eta ln(1/eta) leaves 1e-10 rad there.
_BESIDE = 1e-12
_MOST_POINTS = 1_000_000
_LARGEST = 1e6  # of m r^2/I1: a body a thousand times smaller than its rim
_SAME = 1e-8  # turns; rounding and the law leave less of a gap of zero, which must not become 2 pi


@dataclass(frozen=True)
class RaceNumbers:
    """Race number and gap against the body; arrays (n).

    Attributes
    ----------
    ratio : array
        m r^2/I1.
    kappa : array
        sqrt(1 + ratio), eq. (7.9).
    gap : array
        2 kappa pi mod 2 pi (rad), from 0 up to 2 pi.
    matching : array
        The ratios l^2 - 1 up to the largest, where the gap is zero (section 7.2 of the paper).

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.race_numbers(16.0).matching
    array([ 0.,  3.,  8., 15.])
    """

    ratio: Array
    kappa: Array
    gap: Array
    matching: Array


def race_numbers(most: float = MOST, points: int = 1601) -> RaceNumbers:
    """The race number kappa and the gap between the limits for all bodies.

    Parameters
    ----------
    most : float
        Largest m r^2/I1, up to 1e6; from 0 on.
    points : int
        How many, evenly spaced; the matching bodies are among them as well.

    Returns
    -------
    RaceNumbers

    Raises
    ------
    InputError
        Where `most` is not above 0 and up to 1e6, or there are fewer than 2 points.

    References
    ----------
    Eq. (7.9) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.race_numbers(4.0, points=5).kappa.round(4)
    array([1.    , 1.4142, 1.7321, 2.    , 2.2361])
    """
    largest, points = _ratio("most", most), whole("points", points, 2, _MOST_POINTS)
    turns = np.arange(1.0, math.floor(math.sqrt(1.0 + largest)) + 1.0)
    matching = turns * turns - 1.0
    ratio = np.union1d(np.linspace(0.0, largest, points), matching)
    kappa = np.sqrt(1.0 + ratio)
    # Whole kappa are exact, so the gap of a matching body is 0, not 2 pi.
    return RaceNumbers(ratio, kappa, 2.0 * math.pi * (kappa % 1.0), matching)


def flat_body(ratio: float) -> Disk:
    """The flat body (I3 = 2 I1) with this m r^2/I1, in natural units.

    Parameters
    ----------
    ratio : float
        m r^2/I1, above 0 and up to 1e6; 4 is the uniform disk, 2 the hoop.

    Returns
    -------
    Disk

    Raises
    ------
    InputError
        For another ratio.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.flat_body(8.0).kappa
    3.0
    """
    value = _ratio("ratio", ratio)
    return Disk(I1=1.0 / value, I3=2.0 / value, name=f"ratio-{value:g}")


def _ratio(name: str, value: float) -> float:
    ratio = positive(name, value)
    if ratio > _LARGEST:
        raise InputError(f"{name} = {shown(value)}: give m r^2/I1, above 0 and up to {_LARGEST:g}")
    return ratio


@dataclass(frozen=True)
class MeasuredGaps:
    """Race angles beside F by quadrature; arrays (n).

    Attributes
    ----------
    ratio : array
        m r^2/I1.
    kappa : array
        Half the difference of the race angles on both sides of F, over pi.
    gap : array
        That difference less the whole turns nearest to it, modulo 2 pi (rad).

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.measured_gaps([ex.Disk.matching()]).gap.round(8)
    array([0.])
    """

    ratio: Array
    kappa: Array
    gap: Array


def measured_gaps(disks: Sequence[Disk]) -> MeasuredGaps:
    """Race numbers of bodies as passages beside F have them.

    Parameters
    ----------
    disks : sequence of Disk
        One body or more, with I3 > 0.

    Returns
    -------
    MeasuredGaps
        At eta_hat = +-1e-12, sigma3_bar = phidot = 1 natural units.

    Raises
    ------
    InputError
        Where no disk is given, or something else.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.measured_gaps([ex.Disk.hoop(), ex.Disk.uniform()]).kappa.round(6)
    array([1.732051, 2.236068])
    """
    given = list(disks) if isinstance(disks, list | tuple) else []
    if not given:
        raise InputError(f"disks: none in {shown(disks)}; give a list of one Disk or more")
    kappa = []
    for disk in given:
        require_axial_inertia(disk)
        unit = disk.rate_unit
        angle = passages(disk, unit, [_BESIDE * unit, -_BESIDE * unit], unit, accuracy=1e-9).race_angle
        kappa.append((angle[0] - angle[1]) / (2.0 * math.pi))
    measured = np.array(kappa)
    near = measured - np.round(measured)
    gap = 2.0 * math.pi * np.where(abs(near) < _SAME, near, measured % 1.0)
    ratio = np.array([disk.m * disk.r**2 / disk.I1 for disk in given])
    return MeasuredGaps(ratio, measured, gap)

"""The race number of all bodies, and by how much the two limit motions differ per fall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer.errors import InputError
from explorer.motion.passages import passages
from explorer.phase.disk import Disk
from explorer.phase.states import Array

MOST = 16.0
# Where the gap is measured: far enough from F for two passages, near enough for the law eta ln(1/eta).
_BESIDE = 1e-12
_LARGEST = 1e6


@dataclass(frozen=True)
class RaceNumbers:
    """Race number and gap against the body; arrays (n).

    ratio: m r^2/I1. kappa: sqrt(1 + ratio), eq. (7.9). gap: 2 kappa pi mod 2 pi (rad), from 0 up to 2 pi.
    matching: the ratios l^2 - 1 up to the largest, where the gap is zero (section 7.2 of the paper).
    """

    ratio: Array
    kappa: Array
    gap: Array
    matching: Array


def race_numbers(most: float = MOST, points: int = 1601) -> RaceNumbers:
    """kappa and gap for m r^2/I1 from 0 to `most`; the matching bodies are among the points."""
    if not (isinstance(most, int | float) and 0.0 < most <= _LARGEST):
        raise InputError(f"most = {most!r}: give the largest m r^2/I1, above 0 and up to {_LARGEST:g}")
    if isinstance(points, bool) or not isinstance(points, int) or points < 2:
        raise InputError(f"points = {points!r}: give a whole number, 2 or more")
    turns = np.arange(1.0, math.floor(math.sqrt(1.0 + most)) + 1.0)
    matching = turns * turns - 1.0
    ratio = np.union1d(np.linspace(0.0, most, points), matching)
    kappa = np.sqrt(1.0 + ratio)
    # Whole kappa are exact, so the gap of a matching body is 0, not 2 pi.
    return RaceNumbers(ratio, kappa, 2.0 * math.pi * (kappa % 1.0), matching)


def flat_body(ratio: float) -> Disk:
    """The flat body (I3 = 2 I1) with this m r^2/I1, in natural units."""
    if not (isinstance(ratio, int | float) and 0.0 < ratio <= _LARGEST):
        raise InputError(f"ratio = {ratio!r}: give m r^2/I1, above 0 and up to {_LARGEST:g}")
    return Disk(I1=1.0 / ratio, I3=2.0 / ratio, name=f"ratio-{ratio:g}")


@dataclass(frozen=True)
class MeasuredGaps:
    """Race angles beside F by quadrature; arrays (n). ratio: m r^2/I1.

    kappa: half the difference of the race angles on both sides of F, over pi. gap: that difference less
    the whole turns nearest to it, modulo 2 pi (rad).
    """

    ratio: Array
    kappa: Array
    gap: Array


def measured_gaps(disks: Sequence[Disk]) -> MeasuredGaps:
    """Race numbers of bodies from passages at eta_hat = +-1e-12 natural units, sigma3_bar = phidot = 1."""
    if not disks:
        raise InputError("disks: none were given; give at least one Disk")
    kappa = []
    for disk in disks:
        unit = disk.rate_unit
        found = passages(disk, unit, [_BESIDE * unit, -_BESIDE * unit], unit, accuracy=1e-9)
        kappa.append((found.race_angle[0] - found.race_angle[1]) / (2.0 * math.pi))
    measured = np.array(kappa)
    near = measured - np.round(measured)
    # What rounding and the law leave of a gap of zero must not become 2 pi.
    gap = 2.0 * math.pi * np.where(abs(near) < 1e-8, near, measured % 1.0)
    ratio = np.array([disk.m * disk.r**2 / disk.I1 for disk in disks])
    return MeasuredGaps(ratio, measured, gap)

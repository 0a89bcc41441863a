"""The race number of all bodies, and by how much the two limit motions differ per fall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer.errors import InputError, positive, shown, whole
from explorer.motion.passages import passages
from explorer.phase.disk import Disk
from explorer.phase.states import Array

MOST = 16.0  # of m r^2/I1; a hoop has 2, a uniform disk 4
# Where the gap is measured, natural units of eta_hat: the law eta ln(1/eta) leaves 1e-10 rad there.
_BESIDE = 1e-12
_LARGEST = 1e6  # of m r^2/I1: a body a thousand times smaller than its rim
_SAME = 1e-8  # turns; rounding and the law leave less of a gap of zero, which must not become 2 pi


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
    largest, points = _ratio("most", most), whole("points", points, 2)
    turns = np.arange(1.0, math.floor(math.sqrt(1.0 + largest)) + 1.0)
    matching = turns * turns - 1.0
    ratio = np.union1d(np.linspace(0.0, largest, points), matching)
    kappa = np.sqrt(1.0 + ratio)
    # Whole kappa are exact, so the gap of a matching body is 0, not 2 pi.
    return RaceNumbers(ratio, kappa, 2.0 * math.pi * (kappa % 1.0), matching)


def flat_body(ratio: float) -> Disk:
    """The flat body (I3 = 2 I1) with this m r^2/I1, in natural units."""
    value = _ratio("ratio", ratio)
    return Disk(I1=1.0 / value, I3=2.0 / value, name=f"ratio-{value:g}")


def _ratio(name: str, value: float) -> float:
    ratio = positive(name, value)
    if ratio > _LARGEST:
        raise InputError(f"{name} = {shown(value)}: give m r^2/I1, above 0 and up to {_LARGEST:g}")
    return ratio


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
        angle = passages(disk, unit, [_BESIDE * unit, -_BESIDE * unit], unit, accuracy=1e-9).race_angle
        kappa.append((angle[0] - angle[1]) / (2.0 * math.pi))
    measured = np.array(kappa)
    near = measured - np.round(measured)
    gap = 2.0 * math.pi * np.where(abs(near) < _SAME, near, measured % 1.0)
    ratio = np.array([disk.m * disk.r**2 / disk.I1 for disk in disks])
    return MeasuredGaps(ratio, measured, gap)

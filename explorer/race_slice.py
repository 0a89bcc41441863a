"""Slices of the phase space by the way the contact point races: F is where the way changes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.disk import Disk
from explorer.errors import InputError
from explorer.scenes.falling_set import Slice, SliceMap, slice_and_falls
from explorer.states import require_axial_inertia

_MOST_POINTS = 2001


@dataclass(frozen=True)
class RaceSlice:
    """A slice with theta_min by quadrature; arrays (ny, nx).

    map: tilt (rad), distances and could-fall, as for the pictures of F. side: the flat state whose line
    is nearer, +1 or -1. way: the sign of eta on that side, the direction in which the contact point
    races (7.9); 0 where the disk could not fall there, whatever eta.
    """

    map: SliceMap
    side: NDArray[np.int8]
    way: NDArray[np.int8]


def race_slice(disk: Disk, where: Slice, points: int) -> RaceSlice:
    """Compute a slice on points x points states; the tilt is a root of V = E, eq. (3.8), no integration."""
    require_axial_inertia(disk)
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= _MOST_POINTS:
        raise InputError(f"points = {points!r}: give a whole number from 2 to {_MOST_POINTS}")
    computed, exact = slice_and_falls(disk, where, points, "quadrature")
    shape = (points, points)
    way = np.where(exact.could_fall, np.sign(exact.distance), 0.0).astype(np.int8)
    return RaceSlice(computed, exact.side.reshape(shape), way.reshape(shape))

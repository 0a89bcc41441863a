"""Slices of the phase space by the way the contact point races: F is where the way changes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer import models
from explorer.disk import Disk
from explorer.errors import InputError
from explorer.falling import falls_of
from explorer.motions import smallest_tilt
from explorer.scenes.falling_set import SLICE_ACCURACY, Slice, SliceMap
from explorer.states import natural_constants, phi_to_states, require_axial_inertia

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
    x, y, columns = where.grid(points)
    states = phi_to_states(disk, **columns)
    found = natural_constants(states)
    how = models.plan(("theta_min",), SLICE_ACCURACY, "quadrature")
    theta = smallest_tilt(states, how, found)[0]
    exact = falls_of(states, found)
    shape = (points, points)
    way = np.where(exact.could_fall, np.sign(exact.distance), 0.0).astype(np.int8)
    computed = SliceMap(
        where,
        x,
        y,
        theta.reshape(shape),
        exact.distance_plus.reshape(shape),
        exact.distance_minus.reshape(shape),
        exact.could_fall_plus.reshape(shape),
        exact.could_fall_minus.reshape(shape),
    )
    return RaceSlice(computed, exact.side.reshape(shape), way.reshape(shape))

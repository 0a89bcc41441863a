"""Slices of the phase space by the way the contact point races: F is where the way changes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError
from explorer.measure.sampling import Box, Range, parse_ranges
from explorer.motion import plan as models
from explorer.motion.trajectories import smallest_tilt
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.membership import Falls, falls_of
from explorer.phase.states import COORDINATES, Array, phi_to_states

_MOST_POINTS = 2001
SLICE_ACCURACY = 1e-3  # of theta_min in a picture


@dataclass(frozen=True)
class Slice:
    """A two-dimensional slice of the phase space: two coordinates with a range, two fixed."""

    ranges: tuple[tuple[str, Range], ...]

    @classmethod
    def parse(cls, text: str) -> "Slice":
        """From "sigma3=-2:2,sigma4=-2:2,phi=0,phidot=1". Raises InputError."""
        ranges = parse_ranges(text, "--slice")
        free = [name for name, (low, high) in ranges.items() if low < high]
        if len(free) != 2 or set(ranges) != set(COORDINATES):
            raise InputError(
                f"--slice {text!r}: give all of {', '.join(COORDINATES)}, two as LOW:HIGH and two as numbers"
            )
        Box(**ranges)  # the same bounds hold
        return cls(tuple(sorted(ranges.items(), key=lambda item: COORDINATES.index(item[0]))))

    @classmethod
    def defaults(cls, disk: Disk) -> tuple["Slice", ...]:
        """At the vertical, where F is a pair of lines, and a curved one with an edge of could-fall."""
        unit = disk.rate_unit
        two = 2.0 * unit
        return (
            cls((("phi", (0.0, 0.0)), ("phidot", (unit, unit)), ("sigma3", (-two, two)), ("sigma4", (-two, two)))),
            cls(
                (
                    ("phi", (-1.35, 1.35)),
                    ("phidot", (0.05 * unit, 0.05 * unit)),
                    ("sigma3", (0.15 * unit, 0.15 * unit)),
                    ("sigma4", (-0.8 * unit, 0.8 * unit)),
                )
            ),
        )

    @property
    def axes(self) -> tuple[str, str]:
        first, second = (name for name, (low, high) in self.ranges if low < high)
        return first, second

    @property
    def fixed(self) -> dict[str, float]:
        return {name: low for name, (low, high) in self.ranges if low == high}

    def grid(self, points: int) -> tuple[Array, Array, dict[str, Array]]:
        """Axis values (points) of both axes, and the coordinates of the grid, second axis first."""
        box = dict(self.ranges)
        x, y = (np.linspace(*box[name], points) for name in self.axes)
        X, Y = np.meshgrid(x, y)
        columns = {name: np.full(X.size, value) for name, value in self.fixed.items()}
        columns.update({self.axes[0]: X.ravel(), self.axes[1]: Y.ravel()})
        return x, y, columns


@dataclass(frozen=True)
class SliceMap:
    """theta_min on a slice by integration, and the exact set from algebra; arrays (ny, nx)."""

    slice: Slice
    x: Array
    y: Array
    theta_min: Array
    distance_plus: Array
    distance_minus: Array
    could_fall_plus: NDArray[np.bool_]
    could_fall_minus: NDArray[np.bool_]


def map_slice(disk: Disk, where: Slice, points: int) -> SliceMap:
    """Compute a slice on points x points states, by integration."""
    return slice_and_falls(disk, where, points, "dopri5")[0]


def slice_and_falls(disk: Disk, where: Slice, points: int, method: str) -> tuple[SliceMap, Falls]:
    """A slice with theta_min by `method`, and where its states, flat, lie relative to F."""
    x, y, columns = where.grid(points)
    states = phi_to_states(disk, **columns)
    natural = natural_constants(states)
    how = models.plan(("theta_min",), SLICE_ACCURACY, method)
    theta, _status, _steps = smallest_tilt(states, how, natural)
    exact = falls_of(states, natural)
    shape = (points, points)
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
    return computed, exact


@dataclass(frozen=True)
class ConstantsPlane:
    """What the map of all samples shows: cell edges, smallest theta_min per cell, slope of l_+."""

    disk: Disk
    sigma3_edges: Array
    sigma4_edges: Array
    smallest: Array
    slope: float


@dataclass(frozen=True)
class RaceSlice:
    """A slice with theta_min by quadrature; arrays (ny, nx).

    map: tilt (rad), distances and could-fall, as for the pictures of F. face: the flat state whose line
    is nearer, +1 or -1. way: the sign of eta on that side, the direction in which the contact point
    races (7.9); 0 where the disk could not fall there, whatever eta.
    """

    map: SliceMap
    face: NDArray[np.int8]
    way: NDArray[np.int8]


def race_slice(disk: Disk, where: Slice, points: int) -> RaceSlice:
    """Compute a slice on points x points states; the tilt is a root of V = E, eq. (3.8), no integration."""
    require_axial_inertia(disk)
    if isinstance(points, bool) or not isinstance(points, int) or not 2 <= points <= _MOST_POINTS:
        raise InputError(f"points = {points!r}: give a whole number from 2 to {_MOST_POINTS}")
    computed, exact = slice_and_falls(disk, where, points, "quadrature")
    shape = (points, points)
    way = np.where(exact.could_fall, np.sign(exact.distance), 0.0).astype(np.int8)
    return RaceSlice(computed, exact.face.reshape(shape), way.reshape(shape))

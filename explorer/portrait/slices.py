"""Slices of the phase space: the smallest tilt of motions, and the side of F on which they lie."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, whole
from explorer.measure.sampling import Box, Range, parse_ranges
from explorer.motion.plan import plan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.constants import constants_of, natural_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import line_slope
from explorer.phase.membership import falls_of
from explorer.phase.states import COORDINATES, Array, States, phi_to_states

_MOST_POINTS = 4000  # a side; 16 million states, of which every array takes 128 MB
SLICE_ACCURACY = 1e-3  # relative, of theta_min: a picture shows no more


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
        """Two slices: at the vertical, where F is a pair of lines, and one where F is curved and has an edge."""
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

    def describe(self) -> dict[str, list[float]]:
        """The ranges as run.json holds them."""
        return {name: list(span) for name, span in self.ranges}

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
    """theta_min on a slice of the phase space, and the exact set from algebra; arrays (ny, nx).

    x, y: values of the two axes. theta_min: smallest tilt of the whole motion (rad). method: how it was
    computed, "quadrature" or the name of an integrator. distance_plus, distance_minus, could_fall_plus,
    could_fall_minus, face: as in `Falls`. side: the sign of eta on that face, which is the direction in which
    the contact point races (7.9); 0 where the disk could not fall there, whatever eta.
    """

    disk: Disk
    slice: Slice
    x: Array
    y: Array
    theta_min: Array
    method: str
    distance_plus: Array
    distance_minus: Array
    could_fall_plus: NDArray[np.bool_]
    could_fall_minus: NDArray[np.bool_]
    face: NDArray[np.int8]
    side: NDArray[np.int8]


def map_slice(disk: Disk, where: Slice, points: int, method: str = "auto") -> SliceMap:
    """Compute a slice on points x points states; `auto` finds the tilt as a root of V = E, eq. (3.8)."""
    points = whole("points", points, 2, _MOST_POINTS)
    x, y, columns = where.grid(points)
    states = phi_to_states(disk, **columns)
    constants = natural_constants(states)
    how = plan(("theta_min",), SLICE_ACCURACY, method)
    exact = falls_of(states, constants)
    theta, _status, _steps = smallest_tilt(states, how, constants)
    side = np.where(exact.could_fall, np.sign(exact.distance), 0.0).astype(np.int8)

    def on_grid(values: NDArray[Any]) -> NDArray[Any]:
        return values.reshape(points, points)

    return SliceMap(
        disk=disk,
        slice=where,
        x=x,
        y=y,
        theta_min=on_grid(theta),
        method=how.method,
        distance_plus=on_grid(exact.distance_plus),
        distance_minus=on_grid(exact.distance_minus),
        could_fall_plus=on_grid(exact.could_fall_plus),
        could_fall_minus=on_grid(exact.could_fall_minus),
        face=on_grid(exact.face),
        side=on_grid(side),
    )


@dataclass(frozen=True)
class ConstantsPlane:
    """The flattest of a run's samples over the plane of constants of motion.

    sigma3_edges, sigma4_edges: edges of the cells (units of the disk). smallest: least theta_min in each cell
    (rad), NaN where there is none. slope: sigma4_bar / sigma3_bar on l_+. method: as in `SliceMap`.
    """

    disk: Disk
    sigma3_edges: Array
    sigma4_edges: Array
    smallest: Array
    slope: float
    method: str


def flattest_per_cell(states: States, cells: int = 100, method: str = "auto") -> ConstantsPlane:
    """Find the flattest motion among states in each cell of the plane of constants of motion.

    Parameters
    ----------
    states : States
        The samples.
    cells : int
        A side of the plane, which holds 99.5 % of the samples in each direction.
    method : str
        How theta_min is computed, as for `passages`.

    Returns
    -------
    ConstantsPlane

    Raises
    ------
    InputError
        Where cells or method cannot be used.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> from explorer.portrait.slices import flattest_per_cell
    >>> draw = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 500))
    >>> plane = flattest_per_cell(ex.phi_to_states(ex.Disk.uniform(), 0.0, *draw), cells=10)
    >>> plane.smallest.shape
    (10, 10)
    """
    cells = whole("cells", cells, 2, _MOST_POINTS)
    how = plan(("theta_min",), SLICE_ACCURACY, method)
    constants = natural_constants(states)
    theta, _status, _steps = smallest_tilt(states, how, constants)
    table = constants_of(states)
    bars = np.ravel(table.sigma3_bar), np.ravel(table.sigma4_bar)
    known = np.isfinite(theta) & np.isfinite(bars[0]) & np.isfinite(bars[1])
    edges, places = [], []
    for bar in bars:
        reach = float(np.percentile(abs(bar[known]), 99.5)) if known.any() else 1.0
        edges.append(np.linspace(-reach, reach, cells + 1))
        places.append(np.searchsorted(edges[-1], bar, side="right") - 1)
    inside = known & np.all([(place >= 0) & (place < cells) for place in places], axis=0)
    smallest = np.full((cells, cells), np.inf)
    np.minimum.at(smallest, (places[1][inside], places[0][inside]), theta[inside])
    smallest[np.isinf(smallest)] = np.nan
    return ConstantsPlane(states.disk, edges[0], edges[1], smallest, line_slope(states.disk), how.method)

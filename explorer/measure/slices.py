"""Slices of the phase space: the smallest tilt of motions, and the side of F on which they lie."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, flag, shown, whole
from explorer.measure.distributions import Coordinate, read_coordinates, read_given
from explorer.measure.sampling import Range
from explorer.motion.plan import plan
from explorer.motion.scan import Observable, Scan, scan
from explorer.motion.turning_points import smallest_tilt
from explorer.phase.columns import ANGLE, COLUMNS
from explorer.phase.coordinates import ANGULAR, angle_unit, recognise
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.falling_set import Falls, falls
from explorer.phase.results import to_arrow
from explorer.phase.states import Array, States

if TYPE_CHECKING:
    import pyarrow as pa

_MOST_POINTS = 4000  # a side; 16 million states, of which every array takes 128 MB
SLICE_ACCURACY = 1e-3  # relative, of theta_min: a picture shows no more


@dataclass(frozen=True)
class Slice:
    """A plane in the phase space: two coordinates or constants of motion with a range, the others fixed."""

    coordinates: dict[str, Coordinate] = dataclasses.field(hash=False)

    @classmethod
    def read(cls, given: Any, degrees: bool = False, option: str = "slice") -> Slice:
        """From "sigma3=-2:2,sigma4=-2:2,phi=0,phidot=1" or a mapping of numbers and pairs.

        Raises InputError naming the option.
        """
        if isinstance(given, Slice):
            if all(each.unit == angle_unit(name, degrees) for name, each in given.coordinates.items()):
                return given
            ends = {name: each.ends for name, each in given.coordinates.items()}
            given = {name: [end / angle_unit(name, degrees) for end in both] for name, both in ends.items()}
        found = cls(read_coordinates(option, read_given(option, given), degrees))
        for each in found.coordinates.values():
            each.check(option)
        free = [each for each in found.coordinates.values() if each.free]
        if len(free) != 2 or any(each.law is not None for each in free):
            names = ", ".join(found.coordinates)
            raise InputError(
                f"{option} {shown(given)}: give two of {names} as LOW:HIGH, and numbers for the others"
            )
        return found

    @classmethod
    def defaults(cls, disk: Disk) -> tuple[Slice, ...]:
        """Two slices: at the vertical, where F is a pair of lines, and one where F is curved and has an edge."""
        unit = disk.rate_unit
        two, most = (-2.0 * unit, 2.0 * unit), (-0.8 * unit, 0.8 * unit)
        lines = {"phi": 0.0, "phidot": unit, "sigma3": two, "sigma4": two}
        curves = {"phi": (-1.35, 1.35), "phidot": 0.05 * unit, "sigma3": 0.15 * unit, "sigma4": most}
        return cls.read(lines), cls.read(curves)

    @property
    def axes(self) -> tuple[str, str]:
        first, second = (name for name, each in self.coordinates.items() if each.free)
        return first, second

    @property
    def fixed(self) -> dict[str, float]:
        return {name: each.ends[0] for name, each in self.coordinates.items() if not each.free}

    def grid(self, points: int) -> tuple[Array, Array, dict[str, Array]]:
        """Axis values (points) of both axes, and the coordinates of the grid, second axis first."""
        x, y = (np.linspace(*self.coordinates[name].ends, points) for name in self.axes)
        X, Y = np.meshgrid(x, y)
        fixed = {name: np.full(X.size, value) for name, value in self.fixed.items()}
        return x, y, {self.axes[0]: X.ravel(), self.axes[1]: Y.ravel(), **fixed}

    def describe(self) -> dict[str, Any]:
        """The entry of run.json, in what the user gave."""
        return {name: each.describe() for name, each in self.coordinates.items()}


@dataclass(frozen=True, repr=False, eq=False)
class SliceMap(Scan):
    """Observables on a plane of the phase space, arrays (ny, nx) with their axes: what `slice_map` returns.

    It is indexed by the name of an observable. Pictures such as slice-of-tilts draw it.

    Attributes
    ----------
    states : States
        The points of the plane, (ny, nx), of the body `disk`.
    values : dict of (ny, nx) arrays
        The observables by name.
    slice : Slice
        The plane: which coordinates vary, and which are fixed at what.
    x, y : (nx,) and (ny,) array
        Values of the two axes, `slice.axes` (rad, or degrees if `degrees`; units of the disk).
    falls : Falls
        Where the falling set is, from algebra; arrays (ny, nx).
    method : str
        How theta_min was computed: "quadrature" or the name of an integrator.
    degrees : bool
        Whether angles and rates of the plane are in degrees, in x, y and tables; `slice` and observables are in
        rad. The metadata of `to_arrow` say the unit of each column.

    Examples
    --------
    >>> import explorer as ex
    >>> plane = "phi=0,phidot=1,sigma3_bar=-2:2,eta_hat=-1:1"
    >>> found = ex.slice_map(ex.Disk.uniform(), plane, "race_angle", points=5)
    >>> list(found), found["race_angle"].shape, found.y
    (['race_angle'], (5, 5), array([-1. , -0.5,  0. ,  0.5,  1. ]))
    """

    slice: Slice
    x: Array
    y: Array
    falls: Falls
    method: str
    degrees: bool

    @property
    def disk(self) -> Disk:
        """The body."""
        return self.states.disk

    @property
    def columns(self) -> dict[str, NDArray[Any]]:
        """The coordinates of the grid, in the units of the axes, then the observables."""
        grid = self.slice.grid(self.x.size)[2].items()
        shown = {n: column.reshape(self.shape) / angle_unit(n, self.degrees) for n, column in grid}
        return shown | self.values

    def to_arrow(self) -> pa.Table:
        """The table of `to_pandas`, in Arrow; the metadata of each field states its meaning, unit and equation."""
        turned = ({*self.slice.coordinates} & {*ANGULAR}) - {*self.values} if self.degrees else ()
        units = {name: COLUMNS[name].unit.replace(ANGLE, "degrees") for name in turned}
        known = COLUMNS | {name: replace(COLUMNS[name], unit=unit) for name, unit in units.items()}
        return to_arrow(self.columns, len(self.shape), known)

    @property
    def side(self) -> NDArray[np.int8]:
        """The sign of eta on the nearer face, the direction of the race (7.9); 0 where it could not fall."""
        return np.where(self.falls.could_fall, np.sign(self.falls.distance), 0.0).astype(np.int8)


def slice_map(
    disk: Disk,
    slice: Slice | str | Mapping[str, float | Range],
    observable: Observable = "theta_min",
    *,
    points: int = 401,
    jobs: int = 1,
    method: str = "auto",
    degrees: bool = False,
) -> SliceMap:
    """Compute observables on a plane of the phase space.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    slice : str, mapping or Slice
        Two ranges and the fixed numbers, as in "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2". The coordinates are phi
        (rad), then phidot or else the energy, and one of the pairs sigma3 and sigma4, sigma3_bar and sigma4_bar,
        sigma3_bar and eta_hat; or they are tilt, precession and spin, with tilt_rate (0 if left out). All are in
        the units of the disk. face is +1 if left out.
    observable : str, several, or callable
        Names, or a function of `States`, as `scan` takes them.
    points, jobs : int
        Points of each axis, 2 to 4000; threads.
    method : str
        For theta_min alone: 'auto' finds the tilt as a root of V = E, eq. (3.8); or the name of an integrator.
    degrees : bool
        Whether angles and rates of the slice, of the axes of the map, and of its pictures and tables are in
        degrees.

    Returns
    -------
    SliceMap
        The arrays (ny, nx) with their axes; NaN where there is no such state.

    Raises
    ------
    InputError
        If the slice cannot be read, if the observable is not known, or if a method is given for another than
        theta_min.

    Examples
    --------
    >>> import explorer as ex
    >>> plane = {"phi": 0.0, "phidot": 1.0, "sigma3": (-2, 2), "sigma4": (-2, 2)}
    >>> ex.slice_map(ex.Disk.uniform(), plane, points=3)["theta_min"].round(4)
    array([[0.3759, 1.2485, 0.3759],
           [1.0824,    nan, 1.0824],
           [0.3759, 1.2485, 0.3759]])
    >>> coins = ex.slice_map(ex.Disk.uniform(), "tilt=10:80,precession=-90:90,spin=30", points=5, degrees=True)
    >>> coins.slice.axes, coins.x
    (('tilt', 'precession'), array([10. , 27.5, 45. , 62.5, 80. ]))
    """
    require_axial_inertia(disk)
    points, degrees = whole("points", points, 2, _MOST_POINTS), flag("degrees", degrees)
    where = Slice.read(slice, degrees)
    how = plan(("theta_min",), SLICE_ACCURACY, method)
    x, y, columns = where.grid(points)
    states = replace(recognise(columns).make(disk, **columns), shape=(points, points))

    def theta_min(some: States) -> Array:
        """A root of V = E at a picture's accuracy: ten times as fast as a whole period."""
        return smallest_tilt(some, how)[0]

    alone = isinstance(observable, str) and observable == "theta_min"
    if not alone and method != "auto":
        raise InputError(f"method {shown(method)}: is for the observable theta_min alone; leave it out")
    found = scan(states, theta_min if alone else observable, jobs=jobs).values
    # One column, as `bounces` returns it, is one entry for each state.
    values = {name: each[..., 0] if each.shape[2:] == (1,) else each for name, each in found.items()}
    x, y = (ends / angle_unit(name, degrees) for name, ends in zip(where.axes, (x, y), strict=True))
    return SliceMap(states, values, where, x, y, falls(states), how.method, degrees)


@dataclass(frozen=True, eq=False)
class ConstantsPlane:
    """The flattest of many samples over the plane of constants of motion.

    Attributes
    ----------
    disk : Disk
        The body.
    sigma3_edges, sigma4_edges : array
        Edges of the cells, units of the disk.
    smallest : (ny, nx) array
        Least theta_min in each cell (rad), NaN where there is none.
    method : str
        As in `SliceMap`.

    Examples
    --------
    >>> import explorer as ex
    >>> run = ex.run("falling-set", samples=1000)  # doctest: +SKIP
    >>> run.figure("constants-plane")  # doctest: +SKIP
    """

    disk: Disk
    sigma3_edges: Array
    sigma4_edges: Array
    smallest: Array
    method: str

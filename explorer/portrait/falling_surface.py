"""F from farther off and from nearer: as a surface, and under a magnifying glass."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number, positive, whole
from explorer.motion.passages import passages
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import line_chart
from explorer.phase.states import Array, columns_of

_MOST_POINTS = 2001
_MOST_PASSAGES = 10_000_000  # in one call
_EDGE = 1.5  # rad of phi: the sheets are drawn to there, flat is pi/2


@dataclass(frozen=True)
class FallingSurface:
    """The two sheets of F in (phi, sigma3, sigma4), where the disk has speed enough to reach flat.

    Attributes
    ----------
    disk : Disk
        The body.
    phi, sigma3, sigma4 : dict of int to (n, n) array
        By the face, +1 and -1; phi in rad, the others in units of the disk.

    Examples
    --------
    >>> import explorer as ex
    >>> sheets = ex.portrait.falling_surface(ex.Disk.uniform(), points=5)
    >>> bool((sheets.sigma4[-1] == -sheets.sigma4[1]).all())
    True
    """

    disk: Disk
    phi: dict[int, Array]
    sigma3: dict[int, Array]
    sigma4: dict[int, Array]


def falling_surface(disk: Disk, size: float = 1.0, points: int = 41) -> FallingSurface:
    """The states with eta = 0 on either face: over each tilt a line through the origin, so a ruled surface.

    Parameters
    ----------
    disk : Disk
    size : float
        The sheets lie in the box |sigma3|, |sigma4| <= size, units of the disk.
    points : int
        On each side of the grid.

    Returns
    -------
    FallingSurface

    Raises
    ------
    InputError
        For a size that is not above 0, and fewer than 2 points.

    References
    ----------
    Eqs (3.5), (6.1) of the paper; face -1 by the symmetry (3.2).

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.falling_surface(ex.Disk.uniform(), size=2.0, points=7).phi[1].shape
    (7, 7)
    """
    require_axial_inertia(disk)
    count, most = whole("points", points, 2, _MOST_POINTS), positive("size", size)
    phi = np.linspace(-_EDGE, _EDGE, count)
    chart = line_chart(disk, np.cos(phi), np.sin(phi))
    longer = np.maximum(abs(chart.bar_to_sigma3), abs(chart.bar_to_sigma4))
    along = np.linspace(-most, most, count)
    sigma3, sigma4 = ((rate / longer)[:, None] * along for rate in (chart.bar_to_sigma3, chart.bar_to_sigma4))
    tilts = np.repeat(phi[:, None], count, axis=1)
    # (phi, sigma3, sigma4) -> (-phi, sigma3, -sigma4) takes face +1 to face -1.
    return FallingSurface(disk, {1: tilts, -1: -tilts}, {1: sigma3, -1: sigma3}, {1: sigma4, -1: -sigma4})


@dataclass(frozen=True)
class Zoom:
    """Squares round one point of F, each smaller than the one before.

    Attributes
    ----------
    disk : Disk
        The body.
    sigma3_bar : float
        Where they lie, units of the disk.
    half : (k,) array
        Half the side of each square, units of the disk.
    offset : (n,) array
        The places in a square, in halves.
    race_angle : (k, n, n) array
        Of the passage that starts there (rad), by eta_hat and sigma3_bar; NaN where none does.
    falls : int
        How many of all these motions fall.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.zoom(ex.Disk.uniform(), [0.1], points=4).race_angle.shape
    (1, 4, 4)
    """

    disk: Disk
    sigma3_bar: float
    half: Array
    offset: Array
    race_angle: Array
    falls: int


def zoom(
    disk: Disk, halves: Sequence[float], sigma3_bar: float = 1.0, phidot: float = 1.0, points: int = 28
) -> Zoom:
    """Race angles on squares in (sigma3_bar, eta_hat) round a point of F.

    Parameters
    ----------
    disk : Disk
    halves : sequence of float
        Half the sides of the squares, units of the disk.
    sigma3_bar, phidot : float
        Where they lie, units of the disk.
    points : int
        On each side of a square; an even number, so that none lies on F.

    Returns
    -------
    Zoom

    Raises
    ------
    InputError
        For an odd number of points, halves that are not above 0, and a disk with I3 = 0.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.portrait.zoom(ex.Disk.uniform(), [0.1, 1e-9], points=4).falls
    0
    """
    require_axial_inertia(disk)
    count = whole("points", points, 2, _MOST_POINTS)
    if count % 2:
        raise InputError(f"points = {points!r}: give an even number, so that no point lies on F itself")
    offset = np.asarray((np.arange(count) - 0.5 * (count - 1)) / (0.5 * count), np.float64)
    sizes = columns_of(halves=halves)[0]
    if sizes.size * count * count > _MOST_PASSAGES:
        most = f"give fewer; {_MOST_PASSAGES:g} passages are the most"
        raise InputError(f"halves: {sizes.size:,} maps of {count} by {count} points; {most}")
    half = np.array([positive("halves", size) for size in sizes])
    bar, speed = number("sigma3_bar", sigma3_bar), number("phidot", phidot)
    bars = bar + half[:, None, None] * offset[None, None, :]
    found = passages(disk, bars, half[:, None, None] * offset[None, :, None], speed)
    return Zoom(
        disk, bar, half, offset, found.race_angle, int((found.status == compiled.status.Status.FALLS).sum())
    )

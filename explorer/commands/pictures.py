"""Groups of `nearflat portrait` that explain: what happens, what is named how, and why."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from explorer.phase.disk import Disk
from explorer.portrait.bifurcation_portraits import bifurcation_portraits
from explorer.portrait.conservation import conservation
from explorer.portrait.contact_forces import contact_forces
from explorer.portrait.falling_surface import falling_surface, zoom
from explorer.portrait.film import film
from explorer.portrait.general_solvers import general_solvers
from explorer.portrait.near_flat import NearFlat, near_flat, toward_limits
from explorer.portrait.rotation import rotation_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Iterator[tuple[str, "Figure"]]

# Natural units: near enough to F that the disk looks flat, far enough that its race is seen to take time.
_ETA_HAT, _SIGMA3_BAR, _PHIDOT, _ROWS = 0.01, 1.0, 1.0, 300


# Distances from F, natural units: as far as a picture shows it.
_TOWARD, _COLLAPSE, _BLOW_UP = (0.3, 0.1, 0.01, 1e-4), (0.1, 1e-2, 1e-4, 1e-8), (0.1, 0.03, 0.01, 0.003)


_ZOOM = (0.3, 3e-5, 3e-9, 3e-13)  # half the sides of squares round a point of F, natural units
_ENERGY = 2.0  # m g r, of the map of rotation numbers
_FORCES = 0.3, 0.1, 0.01  # distances from F, natural units
_SOLVED = 50  # passages that general solvers are given, from 0.1 to 1e-8, the sides in turn


def hero(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """The whole phenomenon in one picture."""
    from explorer import plot

    unit = disk.rate_unit
    yield "hero", plot.hero(film(disk, _ETA_HAT * unit, _SIGMA3_BAR * unit, _PHIDOT * unit, _ROWS))


def definitions(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """What things are called."""
    from explorer import plot

    yield "definitions", plot.definitions(disk)


def limit(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """The limit from each side: paths, the one curve of all races, and why there is one."""
    from explorer import plot

    unit = disk.rate_unit
    bar, phidot = _SIGMA3_BAR * unit, _PHIDOT * unit
    yield "limit-paths", plot.limit_paths(toward_limits(disk, _TOWARD, bar, phidot))
    for name, sizes, draw in (("race-collapse", _COLLAPSE, _collapse), ("blow-up", _BLOW_UP, plot.blow_up)):
        yield name, draw(near_flat(disk, [sign * size * unit for size in sizes for sign in (1, -1)], bar, phidot))


def _collapse(several: "tuple[NearFlat, ...]") -> "Figure":
    from explorer import plot

    return plot.figure_of(plot.race_collapse, several)


def solvers(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """Why this program: what general solvers make of the race."""
    from explorer import plot

    unit = disk.rate_unit
    sizes = np.logspace(-1.0, -8.0, _SOLVED) * np.resize([1.0, -1.0], _SOLVED)
    yield (
        "missed-races",
        plot.missed_races(general_solvers(disk, sizes * unit, _SIGMA3_BAR * unit, _PHIDOT * unit)),
    )


def surface(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """F as a surface, and under a magnifying glass."""
    from explorer import plot

    unit = disk.rate_unit
    yield "falling-surface", plot.falling_surface(falling_surface(disk, unit))
    squares = zoom(disk, [half * unit for half in _ZOOM], _SIGMA3_BAR * unit, _PHIDOT * unit)
    yield "zoom", plot.zoom_on_f(squares)


def rotation(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """Turns of the contact point per period, over the constants of motion."""
    from explorer import plot

    yield "rotation", plot.figure_of(plot.rotation_map, rotation_map(disk, _ENERGY * disk.energy_unit))


def bifurcation(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """Steady motions along two paths through the constants, each with portraits of the motions there."""
    from explorer import plot

    for path in ("line", "spinning"):
        yield f"bifurcation-{path}", plot.bifurcation_portraits(bifurcation_portraits(disk, path))


def forces(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """Normal force and needed friction over a period."""
    from explorer import plot

    unit = disk.rate_unit
    sizes = [size * unit for size in _FORCES]
    yield "forces", plot.contact_forces(contact_forces(disk, sizes, _SIGMA3_BAR * unit, _PHIDOT * unit))


def kept(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """What is left of the constants after thousands of passages."""
    from explorer import plot

    yield "conservation", plot.conservation(conservation(disk))

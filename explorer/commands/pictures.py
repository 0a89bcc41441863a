"""Groups of `nearflat portrait` that explain: what happens, what is named how, and why."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from explorer.phase.disk import Disk
from explorer.portrait.film import film

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Pictures = Iterator[tuple[str, "Figure"]]

# Natural units: near enough to F that the disk looks flat, far enough that its race is seen to take time.
_ETA_HAT, _SIGMA3_BAR, _PHIDOT, _ROWS = 0.01, 1.0, 1.0, 300


def hero(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """The whole phenomenon in one picture."""
    from explorer import plot

    unit = disk.rate_unit
    yield "hero", plot.hero(film(disk, _ETA_HAT * unit, _SIGMA3_BAR * unit, _PHIDOT * unit, _ROWS))


def definitions(disk: Disk, _options: dict[str, Any]) -> Pictures:
    """What things are called."""
    from explorer import plot

    yield "definitions", plot.definitions(disk)

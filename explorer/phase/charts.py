"""States from named coordinates: which chart the names belong to, and the states in it."""

from collections.abc import Callable, Collection, Mapping
from typing import NamedTuple, TypeVar

import numpy as np

from explorer.errors import InputError, suggest
from explorer.phase.columns import ANGLE, COLUMNS, RATE
from explorer.phase.coordinates import coordinates_to_states, from_rates, warn_of_degrees
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States, phi_to_states, theta_to_states

T = TypeVar("T")


class Chart(NamedTuple):
    """Coordinates that say where a state is.

    names: all of them, in their order. optional: those that may be left out, and mean what `make` takes then: a
    tilt or a rate 0, and face +1. make: called with the disk and arrays by name.
    """

    names: tuple[str, ...]
    optional: tuple[str, ...]
    make: Callable[..., States]

    @property
    def needed(self) -> tuple[str, ...]:
        """Those that must be there."""
        return tuple(name for name in self.names if name not in self.optional)

    def present(self, names: Collection[str]) -> tuple[str, ...]:
        """The coordinates of this chart among `names`."""
        return tuple(name for name in self.names if name in names)

    def in_radians(self, names: Collection[str]) -> tuple[str, ...]:
        """Those of them that are angles or rates of angles."""
        return tuple(name for name in self.present(names) if name in ANGULAR)

    def states(self, disk: Disk, columns: Mapping[str, Array], degrees: bool = False) -> States:
        """The states of a table. degrees: whether angles and rates are in degrees; energies never are."""
        used = {name: columns[name] for name in self.present(columns)}
        if "tilt" in used and not degrees:
            warn_of_degrees(used["tilt"])
        if degrees:
            used |= {name: np.radians(used[name]) for name in self.in_radians(used)}
        return self.make(disk, **used)


def _from_rates(disk: Disk, tilt: Array, precession: Array, spin: Array, **more: Array) -> States:
    """A disk whose tilt_rate is not said is at the highest or the lowest point of its motion."""
    rate, face = more.get("tilt_rate", 0.0 * tilt), more.get("face", np.ones_like(tilt))
    return from_rates(disk, (tilt, rate, precession, spin), face)


# In the order in which they are tried: what says most directly where the disk is comes first. The angle phi may be
# left out only beside constants of motion, which are values at the vertical; then it is 0.
CHARTS = (
    Chart(("phi", "phidot", "sigma3", "sigma4"), (), phi_to_states),
    Chart(("theta", "thetadot", "sigma3", "sigma4", "face"), ("face",), theta_to_states),
    Chart(("tilt", "tilt_rate", "precession", "spin", "face"), ("tilt_rate", "face"), _from_rates),
    Chart(("phi", "energy", "sigma3", "sigma4"), (), coordinates_to_states),
    Chart(("phi", "phidot", "sigma3_bar", "eta_hat", "face"), ("phi", "face"), coordinates_to_states),
    Chart(("phi", "energy", "sigma3_bar", "eta_hat", "face"), ("phi", "face"), coordinates_to_states),
    Chart(("phi", "phidot", "sigma3_bar", "sigma4_bar"), ("phi",), coordinates_to_states),
    Chart(("phi", "energy", "sigma3_bar", "sigma4_bar"), ("phi",), coordinates_to_states),
)
KNOWN = tuple(dict.fromkeys(name for chart in CHARTS for name in chart.names))
ANGULAR = tuple(name for name in KNOWN if COLUMNS[name].unit in (ANGLE, RATE))  # what may be in degrees


def recognise(names: Collection[str], what: str = "states") -> Chart:
    """The chart that a table with columns of these names is in; other columns are the user's own.

    what: how the message calls the table. Raises InputError, with the charts, where no chart is complete.
    """
    for chart in CHARTS:
        if set(chart.needed) <= set(names):
            _refuse_misspelt(chart, names, what)
            return chart
    there = [name for name in names if name in KNOWN]
    if there:
        nearest = max(CHARTS, key=lambda chart: len(set(chart.needed) & set(there)) / len(chart.needed))
        missing = [name for name in nearest.needed if name not in there]
        raise InputError(f"{what}: {', '.join(there)}: these alone say no state; add {' and '.join(missing)}")
    shown = ", ".join(list(names)[:6]) or "no columns"
    sets = "; ".join(", ".join(chart.needed) for chart in CHARTS[:5])
    raise InputError(f"{what}: has {shown}, which say no state; name columns as in one of: {sets}")


def chart_of(what: str, given: Mapping[str, T], zero: T) -> tuple[Chart, dict[str, T]]:
    """The chart of coordinates that are given by name, and these in its order; but for the face none is left out.

    zero: stands for what may be left out. Raises InputError for a name that is no coordinate, and for too many.
    """
    for name in given:
        if name not in KNOWN:
            raise InputError(f"{what}: unknown coordinate {name!r}; {suggest(name, KNOWN)}")
    chart = recognise(given, what)
    unused = [name for name in given if name not in chart.names]
    if unused:
        raise InputError(f"{what}: {', '.join(unused)}: leave out; the state is said without")
    values = {name: zero for name in chart.optional if name != "face"} | dict(given)
    return chart, {name: values[name] for name in chart.present(values)}


def _refuse_misspelt(chart: Chart, names: Collection[str], what: str) -> None:
    """Raise InputError where a column looks like an optional one that is not there, and would be ignored."""
    for name in chart.optional:
        for other in names:
            if name not in names and other not in COLUMNS and _spelt(other) == _spelt(name):
                raise InputError(f"{what}: column {other!r} looks like {name!r}, which is not there; rename it")


def _spelt(name: str) -> str:
    return "".join(letter for letter in name.lower() if letter.isalnum())

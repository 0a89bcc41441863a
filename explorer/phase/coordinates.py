"""States from coordinates by name: which chart the names belong to, and the states in it.

The charts of `states` are (phi or theta, its rate, sigma3, sigma4). Here a tilt may be combined with precession
and spin, with constants of motion in place of sigma3 and sigma4, or with the energy in place of the rate.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import InputError, flag, one_of, warn
from explorer.phase.arguments import column, read_columns
from explorer.phase.columns import ANGLE, COLUMNS, RATE
from explorer.phase.disk import Disk, require_axial_inertia, require_disk
from explorer.phase.energy import energy_at
from explorer.phase.linear_constants import line_chart, line_slope, motion_given
from explorer.phase.states import Array, States, StateWarning, phi_to_states, theta_to_states

T = TypeVar("T")
# What may stand for the spins.
_SPINS = (("sigma3", "sigma4"), ("sigma3_bar", "sigma4_bar"), ("sigma3_bar", "eta_hat"))


def rates_to_states(
    disk: Disk,
    tilt: ArrayLike,
    tilt_rate: ArrayLike = 0.0,
    precession: ArrayLike = 0.0,
    spin: ArrayLike = 0.0,
    face: ArrayLike = 1,
    degrees: bool = False,
) -> States:
    """States from what an experimenter measures: the tilt, the rate at which the disk precesses, and its spin.

    Parameters
    ----------
    disk : Disk
        The disk; with m, r and g in kilograms, metres and seconds, rates are in rad/s.
    tilt : array_like
        Angle between the disk's plane and the table (rad): 0 is flat, pi/2 is upright.
    tilt_rate, precession : array_like
        Rates (units of the disk): that of the tilt, positive where the disk rises, and that at which the contact
        point turns about the vertical. A rate that is left out is 0.
    spin : array_like
        Angular velocity about the disk's own axis (units of the disk), as a gyroscope on the disk would read it.
        It is face * precession * cos(tilt) for a disk that touches the table with the same point of its rim all
        the time.
    face : array_like of +1 or -1
        Which face would come down: +1 for flat at phi = +pi/2, -1 for flat at phi = -pi/2.
    degrees : bool
        Whether `tilt` is in degrees and all rates are in degrees instead of rad.

    Returns
    -------
    States
        The status is BAD_INPUT where a number is not finite or a tilt does not lie between 0 and pi.

    Raises
    ------
    InputError
        If an argument is not a number, or the shapes do not fit together.

    Warns
    -----
    StateWarning
        If all tilts lie beyond upright, which suggests that they are in degrees.

    Examples
    --------
    >>> import math, explorer as ex
    >>> states = ex.rates_to_states(ex.Disk.uniform(r=12.1e-3, g=9.81), math.radians(1.0), 0.0, 60.0, 0.5)
    >>> print(f"{states.phi:.6f} rad, sigma3 = {states.sigma3:.6f} rad/s")
    1.553343 rad, sigma3 = 0.018275 rad/s

    Notes
    -----
    sigma3 = sin^2(tilt) * precession and sigma4 = spin: eqs (2.14), (2.31) of Cushman & Duistermaat (2006).
    """
    given = {"tilt": tilt, "tilt_rate": tilt_rate, "precession": precession, "spin": spin, "face": face}
    return recognise(given).states(disk, given, flag("degrees", degrees))


def from_rates(
    disk: Disk,
    tilt: ArrayLike,
    precession: ArrayLike,
    spin: ArrayLike,
    tilt_rate: ArrayLike = 0.0,
    face: ArrayLike = 1,
) -> States:
    """The same without a warning, for states in rad that are drawn or known.

    A disk whose tilt_rate is not said is at the highest or the lowest point of its motion.
    """
    columns, shape = read_columns(tilt=tilt, tilt_rate=tilt_rate, precession=precession, spin=spin, face=face)
    angle, rate, turn, own, down = columns
    with np.errstate(all="ignore"):
        sigma3 = np.sin(angle) ** 2 * turn
    return theta_to_states(disk, angle, rate, sigma3, own, down).reshaped(shape)


def warn_of_degrees(angle: Array) -> None:
    """Warn where tilts (rad) are probably degrees that were read as radians."""
    known = angle[np.isfinite(angle)]
    if known.size and (known > 0.5 * np.pi).all():
        warn(
            "tilt: all tilts lie beyond upright (pi/2 rad); where they are degrees, give degrees=True, or "
            "--degrees on the command line",
            StateWarning,
        )


def coordinates_to_states(disk: Disk, *, degrees: bool = False, **coordinates: ArrayLike) -> States:
    """States from any complete set of coordinates and constants of motion.

    Parameters
    ----------
    disk : Disk
        The disk.
    degrees : bool
        Whether angles and rates are in degrees instead of rad.
    **coordinates
        Three to five arrays, which broadcast: a tilt, two spins and, if you like, a face. All rates are in the
        units of the disk.

        - The tilt is one of three: phi, the angle to the vertical (rad, 0 if left out), with phidot or with the
          energy; theta with thetadot, as for `theta_to_states`; or tilt with tilt_rate (0 if left out), as for
          `rates_to_states`. phidot is the rate of phi, whatever the face; computed from an energy, it is
          towards the flat state of the face.
        - The spins are sigma3 with sigma4, of eq. (2.14). With phi they may also be constants of motion,
          sigma3_bar with sigma4_bar or with eta_hat, of eqs (3.5), (6.2); with tilt they are precession with spin,
          as for `rates_to_states`.
        - The face, +1 or -1, is that to which theta, tilt or eta_hat refers; +1 if left out.

    Returns
    -------
    States
        The status is BAD_INPUT where the energy is too small for the tilt. Constants of motion are kept as given,
        so that eta_hat may be smaller than the rounding of a state.

    Raises
    ------
    InputError
        If the names do not make a complete set, or an argument is not a number.

    Warns
    -----
    StateWarning
        As `rates_to_states`.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.coordinates_to_states(ex.Disk.uniform(), phi=0.5, energy=3.0, sigma3_bar=1.0, eta_hat=1e-9)
    >>> states.phidot.round(6)
    np.float64(1.749083)

    Notes
    -----
    Eqs (3.5), (6.2) and (2.19) of Cushman & Duistermaat (2006).
    """
    require_disk(disk)
    if not {"theta", "tilt"} & coordinates.keys():
        coordinates.setdefault("phi", 0.0)
    chart, values = chart_of("coordinates", coordinates, 0.0)
    return chart.states(disk, values, flag("degrees", degrees))


def constants_to_states(
    disk: Disk, sigma3_bar: ArrayLike, eta_hat: ArrayLike, phidot: ArrayLike, face: ArrayLike = 1
) -> States:
    """States at the vertical from constants of motion.

    They keep the eta_hat that they are made from, however small. Computed from a state, it would drown in
    rounding.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    sigma3_bar : array_like
        Constant of motion of eq. (3.5), which at the vertical is sigma3; units of the disk.
    eta_hat : array_like
        Signed distance from the line of `face`, eq. (6.2), units of the disk.
    phidot : array_like
        Speed at the vertical towards the flat state of `face`, units of the disk; negative away from it. The
        arrays broadcast; the result has their shape.
    face : array_like
        The flat state to whose line the distance is measured, +1 or -1.

    Returns
    -------
    States
        States with phi = 0; status BAD_INPUT where they are not finite.

    Raises
    ------
    InputError
        For arguments that are not numbers or do not broadcast, and for a disk with I3 = 0.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.hoop(), 1.0, [1e-3, 1e-300], 1.0)
    >>> states.motion.eta_plus / states.motion.eta_plus[0]
    array([1.e+000, 1.e-297])
    """
    (bar, distance, speed, down), shape = read_columns(
        sigma3_bar=sigma3_bar, eta_hat=eta_hat, phidot=phidot, face=face
    )
    states = coordinates_to_states(disk, sigma3_bar=bar, eta_hat=distance, phidot=down * speed, face=down)
    return states.reshaped(shape)


def _from_constants(disk: Disk, **given: ArrayLike) -> States:
    """States from an energy, or from constants of motion in the place of sigma3 and sigma4."""
    spins = next(pair for pair in _SPINS if set(pair) <= given.keys())
    speed = "energy" if "energy" in given else "phidot"
    given = {"phi": 0.0, "face": 1, **given}
    (phi, rate, first, second, face), shape = read_columns(
        **{name: given[name] for name in ("phi", speed, *spins, "face")}
    )
    inside = np.isfinite(phi) & (abs(phi) < 0.5 * np.pi) & (abs(face) == 1.0)
    motion = None
    if spins != ("sigma3", "sigma4"):
        require_axial_inertia(disk)
        with np.errstate(invalid="ignore", over="ignore"):
            eta_hat = second if spins[1] == "eta_hat" else line_slope(disk) * first - second
        angle, seen = np.where(inside, phi, 0.0), np.where(inside, face, 1.0)
        # The mirror image of a motion on the other face: phi and sigma4 change their signs.
        chart = line_chart(disk, np.cos(angle), seen * np.sin(angle))
        unit = disk.rate_unit
        with np.errstate(invalid="ignore", over="ignore"):
            motion = motion_given(disk, first / unit, eta_hat / unit, seen > 0.0)
            first, second = chart.rates(first, eta_hat)
        second = seen * second
    if speed == "energy":
        rate = face * _speed(disk, np.where(inside, phi, 0.0), rate, first, second)
    states = phi_to_states(disk, np.where(inside, phi, np.nan), rate, first, second)
    return replace(states, given=motion, shape=shape)


def _speed(disk: Disk, phi: Array, energy: Array, sigma3: Array, sigma4: Array) -> Array:
    """phidot >= 0 of the states with this energy; NaN where the energy is too small for the place."""
    unit, q = disk.rate_unit, np.cos(phi)
    with np.errstate(invalid="ignore", over="ignore"):
        left = energy / disk.energy_unit - energy_at(disk.body, 0.0, sigma3 / (q * unit), sigma4 / unit, q)
        return np.sqrt(np.where(left >= 0.0, left, np.nan) * 2.0 / disk.body.M) * unit


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

    def states(
        self, disk: Disk, columns: Mapping[str, ArrayLike], degrees: bool = False, quiet: bool = False
    ) -> States:
        """The states of a table.

        degrees: whether angles and rates are in degrees; energies never are. quiet: gives no warning of tilts that
        look like degrees.
        """
        used = {name: column(name, columns[name]) * angle_unit(name, degrees) for name in self.present(columns)}
        if "tilt" in used and not degrees and not quiet:
            warn_of_degrees(used["tilt"])
        return self.make(disk, **used)


# In the order in which they are tried: what says most directly where the disk is comes first. The angle phi may be
# left out only beside constants of motion, which are values at the vertical; then it is 0.
CHARTS = (
    Chart(("phi", "phidot", "sigma3", "sigma4"), (), phi_to_states),
    Chart(("theta", "thetadot", "sigma3", "sigma4", "face"), ("face",), theta_to_states),
    Chart(("tilt", "tilt_rate", "precession", "spin", "face"), ("tilt_rate", "face"), from_rates),
    Chart(("phi", "energy", "sigma3", "sigma4"), (), _from_constants),
    Chart(("phi", "phidot", "sigma3_bar", "eta_hat", "face"), ("phi", "face"), _from_constants),
    Chart(("phi", "energy", "sigma3_bar", "eta_hat", "face"), ("phi", "face"), _from_constants),
    Chart(("phi", "phidot", "sigma3_bar", "sigma4_bar"), ("phi",), _from_constants),
    Chart(("phi", "energy", "sigma3_bar", "sigma4_bar"), ("phi",), _from_constants),
)
_ONCE = {"phi", "theta", "tilt", "phidot", "thetadot", "tilt_rate"}  # of which a state has one tilt and one rate
KNOWN = tuple(dict.fromkeys(name for chart in CHARTS for name in chart.names))
ANGULAR = tuple(name for name in KNOWN if COLUMNS[name].unit in (ANGLE, RATE))  # what may be in degrees


def angle_unit(name: str, degrees: bool) -> float:
    """A unit of a coordinate in rad or the units of the disk. degrees: whether angles are in degrees."""
    return math.radians(1.0) if degrees and name in ANGULAR else 1.0


def recognise(names: Collection[str], what: str = "states") -> Chart:
    """The chart that a table with columns of these names is in; other columns are the user's own.

    what: how the message calls the table. Raises InputError, with the charts, where no chart is complete.
    """
    strange = {name: _spelt(name) for name in names if name not in KNOWN}
    alike = {_spelt(name): name for name in KNOWN if strange and name not in names}
    meant = {name: alike[spelt] for name, spelt in strange.items() if spelt in alike}
    for chart in CHARTS:
        if set(chart.needed) <= set(names):
            complete = {name for each in CHARTS if set(each.needed) <= set(names) for name in each.names}
            for name in names:  # one that would be ignored
                known = meant.get(name, name)
                if name in meant and known in chart.optional:
                    raise InputError(f"{what}: column {name!r} looks like {known!r}, which is missing; rename it")
                if known in _ONCE - complete and (name in meant or name not in CHARTS[0].names):
                    used = ", ".join(chart.present(names))
                    raise InputError(f"{what}: {name!r} is not used beside {used}; rename it, or leave it out")
            return chart
    there = [name for name in names if name in KNOWN]
    hint = f"; did you mean {', '.join(meant.values())} by {', '.join(meant)}?" if meant else ""
    if there:
        nearest = max(CHARTS, key=lambda chart: len(set(chart.needed) & set(there)) / len(chart.needed))
        missing = [name for name in nearest.needed if name not in there]
        raise InputError(
            f"{what}: {', '.join(there)}: these alone do not determine a state; add {' and '.join(missing)}{hint}"
        )
    shown = f"{', '.join(list(names)[:6])}: they do not determine a state" if names else "none were given"
    sets = "; ".join(", ".join(chart.needed) for chart in CHARTS[:5])
    raise InputError(f"{what}: {shown}; give one of these sets: {sets}{hint}")


def chart_of(what: str, given: Mapping[str, T], zero: T) -> tuple[Chart, dict[str, T]]:
    """The chart of coordinates that are given by name, and these in its order; but for the face none is left out.

    zero: stands for what may be left out. Raises InputError for a name that is no coordinate, and for too many.
    """
    for name in given:
        one_of(f"{what}: coordinate", name, KNOWN)
    chart = recognise(given, what)
    unused = [name for name in given if name not in chart.names]
    if unused:
        raise InputError(f"{what}: {', '.join(unused)}: leave out; the other coordinates determine the state")
    values = {name: zero for name in chart.optional if name != "face"} | dict(given)
    return chart, {name: values[name] for name in chart.present(values)}


def _spelt(name: str) -> str:
    """The letters of a name without its unit: "tiltrate" of "Tilt_Rate", "tiltdot" and "tilt rate (deg/s)"."""
    bare = re.split(r"[(\[/]|[\W_](?:deg|rad)", name.lower())[0]
    return "".join(letter for letter in bare if letter.isalnum()).replace("dot", "rate")

"""A motion from the vertical to nearly flat and back, on both sides of F, on a clock that slows near flat."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from explorer.errors import InputError, number, positive, whole
from explorer.motion.dense_times import dense_times
from explorer.motion.passages import passages
from explorer.motion.trajectories import simulate
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, constants_to_states

FRAMES = 100
BETWEEN = 6  # points of a trail per frame, so that a race of some turns is drawn round
_MOST_FRAMES = 2000
_ACCURACY = 1e-8  # of angles (rad): the rim touches the table to far less than a pixel
_FIRST_TIMES = 400  # that the clock is integrated over; between them the race adds its own
_SMALLEST = 1e-6  # natural units of eta_hat; below, no picture would differ
_OBSERVABLES = ("phi", "chi", "psi", "path", "contact")


@dataclass(frozen=True)
class Film:
    """Two motions, +eta_hat and -eta_hat on face +1, at the same times; units of the disk.

    t (nt): time from the flattest moment, which both pass at t = 0. slowed (nt): by how much time runs
    slower than at the vertical, 1/cos(phi) of whichever disk is flatter. Dictionaries by sign of eta:
    phi, chi, psi (nt) rad; centre, contact (nt, 3). frames: rows of these that are frames; the rows
    between belong to the trails.
    """

    disk: Disk
    eta_hat: float
    t: Array
    slowed: Array
    phi: dict[int, Array]
    chi: dict[int, Array]
    psi: dict[int, Array]
    centre: dict[int, Array]
    contact: dict[int, Array]
    frames: NDArray[np.intp]

    def rim(self, sign: int, row: int, angles: Array) -> Array:
        """Points of the rim (n, 3) at angles (rad) from the contact point, eqs (2.34), (2.35)."""
        z, q = math.sin(self.phi[sign][row]), math.cos(self.phi[sign][row])
        c, s = math.cos(self.chi[sign][row]), math.sin(self.chi[sign][row])
        down, along = np.array([z * c, z * s, -q]), np.array([-s, c, 0.0])
        turned = np.cos(angles)[:, None] * down + np.sin(angles)[:, None] * along
        return np.asarray(self.centre[sign][row] + self.disk.r * turned)

    def mark(self, sign: int, row: int, place: float = math.pi) -> Array:
        """A point of the rim that belongs to the body, (3): the one that touches the table when psi = place.

        By default it is on top at the start.
        """
        return np.asarray(self.rim(sign, row, np.array([place - self.psi[sign][row]]))[0])


def film(
    disk: Disk, eta_hat: float = 0.05, sigma3_bar: float = 1.0, phidot: float = 1.0, frames: int = FRAMES
) -> Film:
    """Both motions from the vertical to nearly flat and back, in equal steps of s with dt = cos(phi) ds.

    eta_hat > 0, sigma3_bar, phidot > 0: rad per unit of time; both start in the same place with chi = 0.
    """
    require_axial_inertia(disk)
    frames = whole("frames", frames, 2, _MOST_FRAMES)
    size = positive("eta_hat", eta_hat)
    if size < _SMALLEST * disk.rate_unit:
        raise InputError(f"eta_hat = {eta_hat!r}: give a number from {_SMALLEST:g} sqrt(g/r) up, without its sign")
    bar, speed = number("sigma3_bar", sigma3_bar), number("phidot", phidot)
    signed = np.array([size, -size])
    ways = passages(disk, bar, signed, speed)
    if ways.status.any():
        raise InputError(
            f"sigma3_bar = {sigma3_bar!r}, phidot = {phidot!r}: no passage from the vertical to flat and back; "
            "give phidot above 0, for instance 1"
        )
    both = constants_to_states(disk, bar, signed, speed)
    starts = {sign: both.at(np.array([row])) for row, sign in enumerate((1, -1))}
    halves = {sign: 0.5 * float(ways.duration[row]) for row, sign in enumerate((1, -1))}
    t = _times(starts, halves, BETWEEN * (frames - 1) + 1)
    columns: dict[str, dict[int, Array]] = {name: {} for name in _OBSERVABLES}
    for sign, start in starts.items():
        motion = simulate(start, t_eval=t + halves[sign], observables=_OBSERVABLES, accuracy=_ACCURACY)
        for name in _OBSERVABLES:
            columns[name][sign] = getattr(motion, name)[0]
    columns["centre"] = columns.pop("path")
    q = np.minimum(*(np.cos(phi) for phi in columns["phi"].values()))
    return Film(disk, size, t, 1.0 / q, **columns, frames=np.arange(0, t.size, BETWEEN))


def _times(starts: dict[int, States], halves: dict[int, float], count: int) -> Array:
    """Times from the flattest moment, equally spaced in s with dt = q ds, q the smaller of both cos(phi).

    starts: the motions at the vertical. halves: how long each takes to its flattest moment.
    """
    # A hair inside: rounding must not ask for a time before the start.
    end = min(halves.values()) * (1.0 - 1e-12)
    first = np.linspace(-end, end, _FIRST_TIMES)
    fine = [dense_times(start, first + halves[sign]) - halves[sign] for sign, start in starts.items()]
    t = np.clip(np.union1d(*fine), -end, end)
    t = t[np.concatenate([[True], np.diff(t) > 1e-12 * end])]
    tilts = []
    for sign, start in starts.items():
        phi = simulate(start, t_eval=t + halves[sign], observables=("phi",)).phi
        assert phi is not None
        tilts.append(np.cos(phi[0]))
    rate = 1.0 / np.minimum(*tilts)
    s = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
    times: Array = np.clip(CubicSpline(s, t)(np.linspace(0.0, s[-1], count)), -end, end)
    return times

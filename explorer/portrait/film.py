"""A fall from the vertical on both sides of F, frame by frame, on a clock that slows down near flat."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from explorer.errors import InputError
from explorer.motion.dense_times import dense_times
from explorer.motion.passages import passages
from explorer.motion.trajectories import simulate
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, constants_to_states
from explorer.portrait.wander import STEP

FRAMES = 100
BETWEEN = 6  # points of a trail per frame
_MOST_FRAMES = 2000
_ACCURACY = 1e-8
_FIRST_TIMES = 400
_SMALLEST = 1e-6  # natural units of eta_hat; below, no picture would differ


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
    if isinstance(frames, bool) or not isinstance(frames, int) or not 2 <= frames <= _MOST_FRAMES:
        raise InputError(f"frames = {frames!r}: give a whole number from 2 to {_MOST_FRAMES}")
    if not (isinstance(eta_hat, int | float) and _SMALLEST * disk.rate_unit <= eta_hat < math.inf):
        raise InputError(f"eta_hat = {eta_hat!r}: give a number from {_SMALLEST:g} sqrt(g/r) up, without its sign")
    for name, value in (("sigma3_bar", sigma3_bar), ("phidot", phidot)):
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{name} = {value!r}: a film shows one motion on each side; give one number")
    signed = np.array([eta_hat, -eta_hat])
    found = passages(disk, sigma3_bar, signed, phidot)
    if found.status.any():
        raise InputError(
            f"sigma3_bar = {sigma3_bar!r}, phidot = {phidot!r}: no passage from the vertical to flat and back; "
            "give phidot above 0, for instance 1"
        )
    states = constants_to_states(disk, sigma3_bar, signed, phidot)
    t = _times(disk, states, found.duration, BETWEEN * (frames - 1) + 1)
    observables = ("phi", "chi", "psi", "path", "contact")
    columns: dict[str, dict[int, Array]] = {name: {} for name in observables}
    for row, sign in enumerate((1, -1)):
        moved = simulate(
            disk,
            states.at(np.array([row])),
            t_eval=t + 0.5 * found.duration[row],
            observables=observables,
            accuracy=_ACCURACY,
        )
        for name in observables:
            columns[name][sign] = getattr(moved, name)[0]
    q = np.minimum(*(np.cos(phi) for phi in columns["phi"].values()))
    return Film(
        disk,
        float(eta_hat),
        t,
        1.0 / q,
        columns["phi"],
        columns["chi"],
        columns["psi"],
        columns["path"],
        columns["contact"],
        np.arange(0, t.size, BETWEEN),
    )


def _times(disk: Disk, states: States, duration: Array, count: int) -> Array:
    """Times from the flattest moment, equally spaced in s with dt = q ds, q the smaller of both cos(phi)."""
    # A hair inside: rounding must not ask for a time before the start.
    end = 0.5 * float(duration.min()) * (1.0 - 1e-12)
    first = np.linspace(-end, end, _FIRST_TIMES)
    halves = 0.5 * duration
    fine = [dense_times(states.at(np.array([row])), first + halves[row], STEP) - halves[row] for row in (0, 1)]
    t = np.clip(np.union1d(*fine), -end, end)
    t = t[np.concatenate([[True], np.diff(t) > 1e-12 * end])]
    tilts = []
    for row in (0, 1):
        phi = simulate(disk, states.at(np.array([row])), t_eval=t + halves[row], observables=("phi",)).phi
        assert phi is not None
        tilts.append(np.cos(phi[0]))
    rate = 1.0 / np.minimum(*tilts)
    s = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
    return np.clip(CubicSpline(s, t)(np.linspace(0.0, s[-1], count)), -end, end)

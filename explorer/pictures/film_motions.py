"""Motions from the vertical through approaches to flat, on both sides of F, on a clock that slows near flat."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, number, positive, whole
from explorer.errors import sign as face_or_side
from explorer.motion.passages import passages
from explorer.motion.periods import periods
from explorer.motion.trajectories import Trajectories, finer, trajectories
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, constants_to_states
from explorer.pictures.pose import Pose

FRAMES = 100
BETWEEN = 6  # points of a trail per frame, so that a race of some turns is drawn round
_MOST_FRAMES, _MOST_BOUNCES = 2000, 20
_ACCURACY = 1e-8  # of angles (rad): the rim touches the table to far less than a pixel
_PARTS = 4  # of a step of either motion, over which the clock is integrated
_SMALLEST = 1e-6  # natural units of eta_hat; below, no picture would differ
_NEAR = 0.25  # the share by which the other side's speed may differ to have the same period
_OBSERVABLES = ("phi", "chi", "psi", "path", "contact")


@dataclass(frozen=True)
class Film:
    """Two motions, +eta_hat and -eta_hat on face +1, at the same times; units of the disk.

    Attributes
    ----------
    disk : Disk
        The body.
    eta_hat : float
        Distance of both motions from F, without its sign.
    t : (nt,) array
        Time from the first flattest moment, which both pass at t = 0.
    slowed : (nt,) array
        By how much time runs slower than at the vertical, 1/cos(phi) of whichever disk is flatter.
    flat : (bounces,) array
        Times of the flattest moments.
    phidot : dict of float
        Speed at the start, by sign of eta.
    phi, chi, psi : dict of (nt,) arrays
        Angles (rad), by sign of eta.
    centre, contact : dict of (nt, 3) arrays
        Where the centre and the point of contact are, by sign of eta.
    frames : (frames,) array of int
        Rows of these that are frames; the rows between belong to the trails.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.pictures.film_motions import film
    >>> made = film(ex.Disk.uniform(), eta_hat=0.05, frames=3)
    >>> made.t[made.frames[[0, 2]]].round(3), float(made.phi[1].max().round(3))
    (array([-1.122,  1.122]), 1.535)
    """

    disk: Disk
    eta_hat: float
    t: Array
    slowed: Array
    flat: Array
    phidot: dict[int, float]
    phi: dict[int, Array]
    chi: dict[int, Array]
    psi: dict[int, Array]
    centre: dict[int, Array]
    contact: dict[int, Array]
    frames: NDArray[np.intp]

    def pose(self, sign: int, row: int) -> Pose:
        """The disk on one side of F at one row."""
        sign, row = face_or_side("sign", sign), whole("row", row, 0, len(self.t) - 1)
        phi, chi, psi = (float(angle[sign][row]) for angle in (self.phi, self.chi, self.psi))
        return Pose(phi, chi, psi, self.centre[sign][row], self.disk.r)


def film(
    disk: Disk,
    eta_hat: float = 0.05,
    sigma3_bar: float = 1.0,
    phidot: float = 1.0,
    frames: int = FRAMES,
    bounces: int = 1,
) -> Film:
    """Both motions through their approaches to flat, in equal steps of s with dt = cos(phi) ds.

    Parameters
    ----------
    disk : Disk
    eta_hat : float
        Distance from F of both motions, without its sign, units of the disk.
    sigma3_bar, phidot : float
        At the vertical, where both start in the same place with chi = 0; units of the disk. With more than
        one bounce the motion with eta < 0 has another phidot, for which both have the same period: they lie
        down together every time.
    frames, bounces : int
        How many rows are frames, and how often the disks come to lie nearly flat on face +1.

    Returns
    -------
    Film
        From the vertical before the first bounce to the one after the last.

    Raises
    ------
    InputError
        Where there is no passage, or an argument cannot be used.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.pictures.film_motions import film
    >>> made = film(ex.Disk.hoop(), eta_hat=0.1, frames=4)
    >>> made.frames.size, sorted(made.phi)
    (4, [-1, 1])
    """
    require_axial_inertia(disk)
    frames, bounces = whole("frames", frames, 2, _MOST_FRAMES), whole("bounces", bounces, 1, _MOST_BOUNCES)
    size = positive("eta_hat", eta_hat)
    if size < _SMALLEST * disk.rate_unit:
        raise InputError(f"eta_hat = {eta_hat!r}: give a number from {_SMALLEST:g} sqrt(g/r) up, without its sign")
    bar, speed = number("sigma3_bar", sigma3_bar), number("phidot", phidot)
    speeds, period = {1: speed, -1: speed}, 0.0
    if bounces > 1:
        speeds[-1], period = _in_step(disk, bar, size, speed)
    ways = passages(disk, bar, [size, -size], [speeds[1], speeds[-1]])
    if ways.status.any():
        raise InputError(
            f"sigma3_bar = {sigma3_bar!r}, phidot = {phidot!r}: no passage from the vertical to flat and back; "
            "give phidot above 0, for instance 1"
        )
    halves = {sign: 0.5 * float(ways.duration[row]) for row, sign in enumerate((1, -1))}
    starts = {sign: constants_to_states(disk, bar, sign * size, speeds[sign]) for sign in (1, -1)}
    flat: Array = np.array([period * k for k in range(bounces)])
    t, columns = _followed(starts, halves, flat[-1], BETWEEN * (frames - 1) + 1)
    q = np.minimum(*(np.cos(phi) for phi in columns["phi"].values()))
    return Film(disk, size, t, 1.0 / q, flat, speeds, **columns, frames=np.arange(0, t.size, BETWEEN))


def _followed(
    starts: dict[int, States], halves: dict[int, float], last: float, count: int
) -> tuple[Array, dict[str, dict[int, Array]]]:
    """Times from the first flattest moment, and what a film shows of both motions at them, by its names.

    starts: the motions at the vertical. halves: how long each takes to its flattest moment. last: the last of such
    moments. count: of the times.
    """
    # A hair inside: rounding must not ask for a time before the start.
    half = min(halves.values()) * (1.0 - 1e-12)
    until = last + half
    motions = {
        sign: trajectories(start, until + halves[sign], observables=_OBSERVABLES, accuracy=_ACCURACY)
        for sign, start in starts.items()
    }
    t = _times(motions, halves, (-half, until), count)
    return t, _columns(motions, halves, t)


def _columns(motions: dict[int, Trajectories], halves: dict[int, float], t: Array) -> dict[str, dict[int, Array]]:
    """What a film shows of both motions at times from the first flattest moment, by its names."""
    columns: dict[str, dict[int, Array]] = {name: {} for name in _OBSERVABLES}
    for sign, motion in motions.items():
        at = motion(t + halves[sign])
        for name in _OBSERVABLES:
            columns[name][sign] = getattr(at, name)[0]
    columns["centre"] = columns.pop("path")
    return columns


def _in_step(disk: Disk, sigma3_bar: float, size: float, phidot: float) -> tuple[float, float]:
    """phidot of the motion with eta < 0 that has the period of the one with eta > 0, and this period."""

    from scipy.optimize import brentq

    def period(signed: float, speed: float) -> float:
        return float(periods(constants_to_states(disk, sigma3_bar, signed, speed), eta_hat=signed).period[0])

    wanted = period(size, phidot)
    ends = (phidot * (1.0 - _NEAR), phidot * (1.0 + _NEAR))
    apart = [period(-size, end) - wanted for end in ends]
    if not apart[0] * apart[1] < 0.0:
        raise InputError(
            f"sigma3_bar = {sigma3_bar!r}, eta_hat = {size!r}, phidot = {phidot!r}: both sides of F have no "
            "common period nearby; give a smaller eta_hat, or bounces=1"
        )
    return float(brentq(lambda speed: period(-size, speed) - wanted, *ends, xtol=1e-12)), wanted


def _times(
    motions: dict[int, Trajectories], halves: dict[int, float], ends: tuple[float, float], count: int
) -> Array:
    """Times from the first flattest moment, equally spaced in s with dt = q ds, q the smaller of both cos(phi).

    halves: how long each motion takes to its flattest moment. ends: the first time and the last.
    """
    from scipy.interpolate import CubicSpline

    fine = [finer(motion.t[0], _PARTS) - halves[sign] for sign, motion in motions.items()]
    t = np.clip(np.union1d(*fine), *ends)
    t = t[np.concatenate([[True], np.diff(t) > -1e-12 * ends[0]])]
    phi = _columns(motions, halves, t)["phi"]
    rate = 1.0 / np.minimum(*(np.cos(each) for each in phi.values()))
    s = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
    times: Array = np.clip(CubicSpline(s, t)(np.linspace(0.0, s[-1], count)), *ends)
    return times

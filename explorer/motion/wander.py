"""The wander of the disk over the table: the shift per period, and resonances, at which it has no bound.

One period turns the picture by chi(tau) and moves it by a(tau) - a(0): the motion in the plane is a
rotation about a fixed centre unless chi(tau) is a multiple of 2 pi (Borisov, Mamaev & Kilin 2003).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, number, whole
from explorer.motion.trajectories import simulate
from explorer.phase.arguments import read_pair
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.results import Result, require_ok
from explorer.phase.states import Array, States, require_states

_MOST_PERIODS = 10_000
_MOST_STEPS = 10_000_000  # of all motions together: a complex number each
_MOST_TURNS = 1_000_000  # of chi in a period, far beyond any body's race


@dataclass(frozen=True, repr=False, eq=False)
class Wander(Result):
    """The shift of the disk in one period, arrays of the states' shape, units of the disk: what `wander` returns.

    Attributes
    ----------
    period : array
        Time.
    chi : array
        Turn per period (rad).
    shift : (..., 3) array
        Shift of the centre, a(tau) - a(0), for chi(0) = 0; along the table, so that its last entry is 0.
    radius : array
        Radius of the circle on which the centre lies after each period, |step|/(2 |sin(chi/2)|); infinite at a
        resonance.
    status : array of int8
        `Status` of each motion. Where it is not OK, the other columns are NaN.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> beside = ex.constants_to_states(ex.Disk.uniform(), 0.7, 0.05, 1.0)
    >>> found = ex.wander(beside)
    >>> bool(abs(found.after(1)[1]) == abs(found.step))
    True
    """

    period: Array
    chi: Array
    shift: Array
    radius: Array
    status: NDArray[np.int8]
    states: States

    @property
    def step(self) -> NDArray[np.complex128]:
        """The shift as the complex number a1 + i a2."""
        step: NDArray[np.complex128] = self.shift[..., 0] + 1j * self.shift[..., 1]
        return step

    def after(self, count: int) -> NDArray[np.complex128]:
        """a(k tau) - a(0), k = 0 ... count, along a last axis. Each step is the one before, turned by chi."""
        count = whole("count", count, 0, _MOST_STEPS // max(1, self.size))
        turned = np.exp(1j * self.chi[..., None] * np.arange(count))
        turns = np.concatenate([np.zeros((*self.shape, 1)), np.cumsum(turned, axis=-1)], axis=-1)
        return np.asarray(self.step[..., None] * turns)


def wander(states: States) -> Wander:
    """How far, and which way, the disk moves over the table in one period.

    Parameters
    ----------
    states : States
        One or more, of a disk with I3 > 0.

    Returns
    -------
    Wander
        Period, chi and step are those of the exact motion, eqs (3.12), (3.13) and (2.33).

    Raises
    ------
    InputError
        For anything but States, and for a disk with I3 = 0.

    References
    ----------
    Borisov, Mamaev & Kilin, Regul. Chaotic Dyn. 8 (2003) 201-212.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.wander(ex.constants_to_states(ex.Disk.uniform(), 0.7, [0.05, -0.05], 1.0))
    >>> bool(found.radius[0] != found.radius[1]), found.status
    (True, array([0, 0], dtype=int8))
    """
    require_axial_inertia(require_states(states).disk)
    each, code = simulate(states, t_eval=[0.0], observables=("path",)), compiled.status.Status
    status = np.where(each.ok & np.isnan(each.turn), code.TOO_FEW_DIGITS, each.status).astype(np.int8)[()]
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = np.hypot(each.shift[..., 0], each.shift[..., 1]) / (2.0 * abs(np.sin(0.5 * each.turn)))
    return Wander(each.period, each.turn, each.shift, radius, status, states)


def resonance(
    disk: Disk, eta_hat: float, phidot: float, turns: int, between: tuple[float, float]
) -> tuple[float, States]:
    """The sigma3_bar at which chi turns by whole turns in a period, so that the disk walks away over the table.

    Parameters
    ----------
    disk : Disk
        The body, with I3 > 0.
    eta_hat : float
        Distance from F on face +1, units of the disk.
    phidot : float
        At the vertical, units of the disk.
    turns : int
        By how many turns chi increases in one period tau.
    between : (float, float)
        Two values of sigma3_bar, units of the disk, with chi(tau) on different sides of the resonance.

    Returns
    -------
    float, States
        sigma3_bar by Brent's method on chi(tau), eq. (3.13), and the state at the vertical.

    Raises
    ------
    InputError
        If there is no resonance between the two values, or no period.

    Examples
    --------
    >>> import explorer as ex
    >>> bar, start = ex.resonance(ex.Disk.uniform(), 0.01, 1.0, turns=2, between=(0.1, 0.3))
    >>> chi = ex.periods(start).chi
    >>> print(f"{bar:.3f}: {chi / 6.283185307179586:.6f} turns")
    0.201: 2.000000 turns
    """
    from scipy.optimize import brentq

    def excess(sigma3_bar: float) -> float:
        motion = simulate(
            constants_to_states(disk, sigma3_bar, eta_hat, phidot), t_eval=[0.0], observables=("chi",)
        )
        require_ok(motion, f"between: no period at sigma3_bar = {sigma3_bar:g}; give another range")
        return float(motion.turn) / (2.0 * math.pi) - whole_turns

    require_axial_inertia(disk)
    eta_hat, phidot = number("eta_hat", eta_hat), number("phidot", phidot)
    whole_turns = whole("turns", turns, -_MOST_TURNS, _MOST_TURNS)
    low, high = read_pair("between", between, "two numbers")
    first, last = excess(low), excess(high)
    if first * last > 0.0:
        raise InputError(
            f"resonance: chi(tau) is {first + whole_turns:.4f} turns at sigma3_bar = {low:g} and "
            f"{last + whole_turns:.4f} at {high:g}; {turns} is not in between: change `between` or turns"
        )
    root = float(brentq(excess, low, high, xtol=1e-14, rtol=1e-14))
    return root, constants_to_states(disk, root, eta_hat, phidot)


@dataclass(frozen=True, eq=False)
class WanderPath:
    """The path of one motion over whole periods, units of the disk.

    Attributes
    ----------
    disk : Disk
        The body.
    t : (nt,) array
        Times.
    contact, centre : (nt, 2) array
        The contact point and the shadow of the centre on the table, which starts at the origin with chi = 0.
    wander : Wander
        The shift in one period.
    count : int
        Number of periods.

    Examples
    --------
    >>> import explorer as ex
    >>> path = ex.wander_path(ex.constants_to_states(ex.Disk.uniform(), 0.7, 0.05, 1.0), 3)
    >>> path.contact.shape == path.centre.shape == (path.t.size, 2)
    True
    """

    disk: Disk
    t: Array
    contact: Array
    centre: Array
    wander: Wander
    count: int


def wander_path(states: States, count: int) -> WanderPath:
    """One motion over whole periods, at times that are dense where the contact point races.

    Parameters
    ----------
    states : States
        One state, of a disk with I3 > 0.
    count : int
        Number of periods, up to 10,000.

    Returns
    -------
    WanderPath

    Raises
    ------
    InputError
        For several states, and for a state that has no period.

    Examples
    --------
    >>> import explorer as ex
    >>> path = ex.wander_path(ex.constants_to_states(ex.Disk.uniform(), 0.7, 0.05, 1.0), 3)
    >>> print(f"{path.t[-1] / path.wander.period:.1f} periods")
    3.0 periods
    """
    if require_states(states).size != 1:
        raise InputError(
            f"states: wander_path follows one motion, {states.size} were given; choose one, as in states[0]"
        )
    count = whole("count", count, 1, _MOST_PERIODS)
    one = states.reshaped(())
    each = wander(one)
    require_ok(each, "states: no period")
    rounds = float(each.period) * np.arange(count + 1)
    course = simulate(one, rounds[-1], observables=("path", "contact"))
    t = np.union1d(course.t, rounds)
    at = course(t)
    return WanderPath(states.disk, t, at.contact[:, :2], at.path[:, :2], each, count)

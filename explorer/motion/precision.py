"""How finely motions in time are integrated so that they meet the accuracy asked, and how far they may have erred.

Both are of the angles (rad) and of the path (r), for each passage, which takes about two units of time: errors add
up along a motion, and to less than its square, since its constants are held.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.plan import ANGLES, FIXED, PATH, Plan
from explorer.phase.constants import NaturalConstants
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at
from explorer.phase.states import Array

_PASSAGE = 2.0  # units of time
# What steps are calibrated on, and a little more: the way of the centre in a unit of time (r), and kappa.
_WAY, _KAPPA = 3.0, 2.5
# In a step of rk8 chi turns by no more than the first of these (rad) and the second times the fourth root of the
# accuracy: measured for kappa = 32, where its path errs by 2e-3 at 26 rad, 1e-4 at 14 and 1e-10 at 4.
_TURN, _TURN_MORE = 4.0, 58.0
# Errors are some units of what holding has moved, up to _MOVED, and of the energy that it has taken out, up to
# _TAKEN. By luck a motion may show neither although it errs, so a share of the accuracy, which was calibrated, is
# always added, and the rounding of a passage. More may be hidden of a path in which chi turns many times within a
# step, and of motions that run free.
_MOVED, _TAKEN, _SHARE, _ROUNDING, _FREE = 8.0, 4.0, 0.12, 1e-11, 2.0
# Where sigma4 is as large as a little I3 lets it be, the centre goes thousands of r in a unit of time, and its
# path takes finer steps than were measured. Every step rounds chi, which turns the way, and the time. The error is
# that way times so many units of rounding and the square root of the number of steps: for I3 from 1e-3 to 1e-6,
# by rk8 and both pairs, up to t = 10, 6 units in the median and 29 at worst.
_FAST, _ROUNDED = 30.0, 16.0 * 2.0**-53
# Near the vertical at rest a motion passes an unstable equilibrium, which amplifies errors like 1/speed: below
# this speed (natural units) it is felt. It is not felt more than at the least speed: the time there is short.
_SLOW, _LEAST_SPEED = 0.05, 1e-3
# Rate of chi (natural units) from which an error of the time counts more than that of the angles.
_TURNED = 3.0
# Of the time an error is some of that of the angles: this many times at most.
_BESIDE = 4.0
# Rates (natural units) beyond which adaptive methods are told to err more than their constants show, and ways (r).
_SPUN, _LONG_WAY = 5.0, 20.0
_LITTLE = 0.05  # of I3/I1
# Below that a fast spin hardly shortens fixed steps, since it has little to turn, and those of rk8 are long:
# measured for I3/I1 from 0.003 to 0.03 with spins up to 100, whose paths came out up to four times as wrong as was
# asked at t = 4. Those of rk4 met it.
_OF_LITTLE = 0.2
# Finer steps are kept where other steps end apart by more than this share of what was asked.
_NEARLY = 0.5
# Speed at the vertical (natural units) below which errors are amplified each time, and a time for more than one.
_OFTEN_SLOW, _TWICE = 0.2, 5.0
# Motions that are followed twice, by other steps, and come apart by this many times what was asked have no answer:
# the finer steps of adaptive methods err by so much less, fixed ones by a tenth. Where I3 = 0, estimates tell.
_ASTRAY, _ASTRAY_FIXED = 1e3, 1e2
# Tolerances of the second run, relative to those of the first: errors of a fast spin may hardly change between two
# that are ten times apart. Below the least one rounding refuses steps.
_FINER, _LEAST_TOLERANCE = 1e-3, 1e-14


def steps(disk: Disk, how: Plan, energy: Array) -> Array:
    """The step or tolerance of each motion, (n), from its energy in natural units."""
    if how.setting is not None:
        return np.full(energy.size, how.setting)
    fast = way(disk, energy) > _FAST if how.rung == PATH else np.zeros(energy.size, np.bool_)
    found = how.held_controls(share_of_accuracy(disk, how, energy), fast)
    if how.method == "rk8" and how.rung == PATH:
        found = np.minimum(found, (_TURN + _TURN_MORE * how.accuracy**0.25) / disk.kappa)
    return found


def share_of_accuracy(disk: Disk, how: Plan, energy: Array) -> Array:
    """The share of the accuracy (n) to which motions are integrated, so that all that is asked for meets it.

    An error of chi moves the path by as much times its way, and sigma4, whose bound is in the energy, may take
    that far. Where the disk tilts by some angle chi turns by up to kappa times as much. Adaptive methods see both
    in the error of a step, and need less.
    """
    share, b = np.ones(energy.size), disk.body
    if how.rung == PATH:
        share = np.fmin(share, _WAY / way(disk, energy))
    share *= min(1.0, _KAPPA / b.kappa) ** (0.5 if how.adaptive else 1.0)
    if b.k < _LITTLE and how.method == "rk8":
        share *= _OF_LITTLE * np.fmin(1.0, _WAY / way(disk, energy)) ** 1.5
    return share


def doubtful(disk: Disk, how: Plan, start: NaturalConstants, time: float) -> NDArray[np.bool_]:
    """Which motions (n) must be followed again by other steps to know how far they erred up to a time.

    Of those that run free nothing tells it. Of those that spin fast, or long, errors of the phase add up over many
    periods, which the constants do not show; fixed steps are short enough there, but where I3 is little. Each slow
    passage of the vertical amplifies what the ones before have left. A setting that is named is one that is tried,
    and nothing was asked of it.
    """
    if how.setting is not None:
        return np.zeros(start.energy.size, np.bool_)
    if not disk.body.I3 > 0.0:
        return np.ones(start.energy.size, np.bool_)
    far = way(disk, start.energy)
    spun = (far > _SPUN) | (far > _LONG_WAY / time)
    spun &= how.adaptive or disk.body.k < _LITTLE
    return np.asarray(spun | ((_speed_at_vertical(disk, start) < _OFTEN_SLOW) & (time > _TWICE)))


def finer(how: Plan, control: Array) -> Array:
    """Other steps or tolerances of motions (n), by which errors are far smaller; larger ones at rounding."""
    if how.adaptive:
        tighter = np.fmax(_FINER * control, _LEAST_TOLERANCE)
        return np.where(control > 10.0 * _LEAST_TOLERANCE, tighter, 10.0 * control)
    return np.asarray(control * 0.1 ** (1.0 / FIXED[how.method]))


def asked(how: Plan, time: float) -> float:
    """The error that motions may have at a time."""
    return how.accuracy * max(1.0, time / _PASSAGE)


def astray(how: Plan, apart: Array, time: float) -> NDArray[np.bool_]:
    """Which motions have come so far apart (n) up to a time by other steps that the finer ones are to be kept."""
    return np.asarray(apart > _NEARLY * asked(how, time))


def most_apart(disk: Disk, how: Plan, time: float) -> float:
    """How far motions may come apart by other steps, until they are no answer."""
    held_by_fixed = disk.body.I3 > 0.0 and not how.adaptive
    return (_ASTRAY_FIXED if held_by_fixed else _ASTRAY) * asked(how, time)


class Ends(NamedTuple):
    """Where motions (n) ended: their times, natural units; their steps; the relative errors of their energies; and
    what holding took (3, n), rows as `motion_lanes.Taken`, whose `moved` is NaN of motions that run free."""

    time: Array
    steps: NDArray[np.int32]
    energy_error: Array
    taken: Array


def error_estimate(disk: Disk, how: Plan, start: NaturalConstants, ends: Ends) -> Array:
    """Of angles (rad) and path (r) of motions (n) with these constants, whichever is larger, outside of races.

    `estimate_in_race` tells what it is inside of one.
    """
    found = compiled.motion_lanes.Taken(*ends.taken)
    passages = np.maximum(1.0, ends.time / _PASSAGE)
    energy = np.maximum(found.excess, abs(ends.energy_error))
    # fmax takes the other number where one is NaN: where I3 = 0, nothing is moved and the speed is not known.
    measured = _MOVED * np.fmax(found.moved, 0.0) + _TAKEN * energy + _ROUNDING * passages
    amplified = np.fmax(1.0 + _SLOW / (_speed_at_vertical(disk, start) + _LEAST_SPEED), 1.0)
    hidden = _SHARE * how.accuracy * (1.0 if disk.body.I3 > 0.0 else _FREE)
    if how.rung == PATH:
        hidden *= math.sqrt(max(1.0, disk.kappa / _KAPPA))
    estimate: Array = amplified * measured + hidden * passages
    if how.rung == PATH:
        estimate += np.fmax(_rounding_of_path(disk, start.energy, ends) - _ROUNDING * passages, 0.0)
    return estimate


def estimate_in_race(disk: Disk, how: Plan, ended: Array, found: Array) -> Array:
    """The estimate (n) with what an error of the time makes of chi where motions end: their states there (10, n).

    Inside a race chi turns by some 1/|eta| in a unit of time; tilts and rates do not. Where flat is so near that
    it may lie before the end or behind it, the whole race is in doubt.
    """
    if how.rung not in (ANGLES, PATH):
        return found
    row = compiled.field.ROW
    q, p, rho = ended[row.q], ended[row.p], ended[row.rho]
    with np.errstate(all="ignore"):  # rows of samples that are no motions hold any numbers
        turned = np.fmax(abs(rho / q) / _TURNED, 1.0)
        beside = q < _BESIDE * found * abs(p)
    return np.asarray(found * turned + np.where(beside, math.pi * disk.kappa, 0.0))


def strayed(disk: Disk, points: Array, first: NDArray[np.int64]) -> Array:
    """How far curves (n) stray from q^2 + z^2 = 1 and, relative, from the energies in which they begin, added.

    points (10 or more, all), rows as State; first (n + 1): where each begins; NaN of those without points. Where
    steps are cut this is several times what interpolation errs in angles and path; steps themselves err less.
    """
    rows, body = compiled.field.ROW, disk.body
    found, some = np.full(first.size - 1, np.nan), np.flatnonzero(np.diff(first))
    if some.size:
        q, z, p, rho, sigma4 = (points[row] for row in (rows.q, rows.z, rows.p, rows.rho, rows.sigma4))
        energy, begins = energy_at(body, p, rho, sigma4, q), first[some]
        apart = abs(energy / np.repeat(energy[begins], np.diff(first)[some]) - 1.0) + abs(q * q + z * z - 1.0)
        found[some] = np.maximum.reduceat(apart, begins)
    return found


def lost_to_rounding(disk: Disk, how: Plan, energy: Array, ends: Ends) -> NDArray[np.bool_]:
    """Which motions (n) go so far that rounding alone moves the path asked for by more than the accuracy."""
    bound = how.accuracy * np.maximum(1.0, ends.time / _PASSAGE)
    far = (_rounding_of_path(disk, energy, ends) > bound) & (way(disk, energy) > _FAST)
    return far & (how.rung == PATH)


def _rounding_of_path(disk: Disk, energy: Array, ends: Ends) -> Array:
    """The error (r) by which rounding in all steps moves the ends of paths (n)."""
    rounded: Array = _ROUNDED * np.sqrt(ends.steps) * way(disk, energy) * ends.time
    return rounded


def way(disk: Disk, energy: Array) -> Array:
    """The longest way (r) of the centre in a unit of time at these energies (n)."""
    longest: Array = np.sqrt(2.0 * energy / disk.body.J)
    return longest


def _speed_at_vertical(disk: Disk, constants: NaturalConstants) -> Array:
    """How fast motions pass the vertical or, where they turn before, would at as much more energy as they lack."""
    sigma4_bar = 0.5 * disk.eta_to_eta_hat(constants.eta_minus - constants.eta_plus)
    there = energy_at(disk.body, 0.0, constants.sigma3_bar, sigma4_bar, 1.0)
    speed: Array = np.sqrt(2.0 * disk.body.inv_M * abs(constants.energy - there))
    return speed

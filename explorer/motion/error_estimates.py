"""How far integrations may have erred, in angles (rad), times and the path (r), from what holding them moved.

A motion is put back onto its sigma3_bar and eta after every step, and its energy is watched. How far the steps
were off is an error that is measured, not estimated, in three directions out of the five of a state; what the
others add is in proportion.
"""

import math

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.calibration import SAFETY
from explorer.motion.orbits import closest_to_crest
from explorer.motion.plan import PATH, Plan
from explorer.motion.starts import arc_starts
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at, eta_to_eta_hat
from explorer.phase.linear_constants import Motion
from explorer.phase.states import Array, Rows

PASSAGE = 2.0  # units of time that a passage takes: errors add up over them
# Angles err by so many times what rates were moved by, relative to their bounds, and kappa times that, since chi
# turns at up to kappa times the speed of the tilt; and sigma4, where I3 is little, at more than that. Of passages
# from kappa = 1.2 to 1000 and for I3/I1 from 0.004 on 1.6 times covers all but few. Long steps of order eight show
# half as much: of bodies with kappa from 100 on angles erred by up to four estimates where they had the same.
_ANGLES = {"rk4": 1.6, "dopri5": 1.6, "rk8": 3.2, "dop853": 3.2}
# By luck a motion may show nothing although it errs: that share of the accuracy is always added. 99 of 100
# passages err by less.
SHARE = 0.2
_ROUNDING = 3e-12  # of a passage: some hundred steps, each of some ten operations
# Near the vertical at rest a motion passes an unstable equilibrium, which amplifies errors like 1/speed: below
# this speed (natural units) it is felt. Beside other crests the distance from E = V in x stands for the speed.
# Rounding also ends a rest: it acts like the least speed.
_SLOW, _LEAST_SPEED = 0.15, 5e-5
_CALIBRATED_WAY = 3.0  # of the centre in a unit of time (r), of motions that steps are calibrated on
# Every step rounds chi, which turns the way, and the time: the error of a path is the way times so many units of
# rounding and the square root of the number of steps.
_ROUNDED = 16.0 * 2.0**-53
# Rate of chi (natural units) from which an error of the time counts more than that of the angles.
_TURNED = 3.0
# Of the time an error is some of that of the angles: this many times at most.
_BESIDE = 4.0
# Periods beyond which errors of the phase add up, which the constants do not show: that many radians of the
# fastest rate.
_PERIODS = 30.0
_RESOLVED = 5.0  # rad of chi in a fixed step, which turns a path: up to there it errs by 1e-9 or less
# A way to a turning point takes longer than two passages only where it has lingered beside an equilibrium, which
# amplifies errors unseen.
LINGERS = 2.0 * PASSAGE
FEW = 12  # steps of an adaptive method, in which an error need not have shown
_AMPLIFIED = 1.75  # from here on slow passages are felt that follow each other


def amplification(speed: Array) -> Array:
    """How many times as much a motion amplifies errors that passes the vertical at that speed (natural units)."""
    return np.asarray(np.fmax(1.0 + _SLOW / (speed + _LEAST_SPEED), 1.0))


def error_of(disk: Disk, how: Plan, moved: Array, ended: Array, amplified: Array, time: float) -> Array:
    """Of angles and times (n) after a time, outside of races, at states (10, n); moved (3, n): as `engine.Moved`.

    Infinite of motions that run free: nothing tells it.
    """
    shown = compiled.engine.Moved(*moved)
    passages = max(1.0, time / PASSAGE)
    if not disk.body.I3 > 0.0:  # it runs free
        return np.full(shown.energy.size, math.inf)
    # Errors of the energy that were taken out are seen before; what is left at the end is one of them at most.
    drifted = np.fmax(shown.energy, shown.removed) + shown.rates
    # psi errs by what the time does, times the spin, which is thousands of needles; twice that covers them.
    fastest = np.fmax(disk.kappa / math.sqrt(min(disk.body.k, 1.0)), 2.0 * abs(ended[compiled.field.ROW.sigma4]))
    measured = _ANGLES[how.method] * fastest * drifted
    return np.asarray(amplified * (measured + _ROUNDING * passages) + SHARE * how.accuracy * passages)


def accepted(how: Plan, time: float) -> float:
    """The error that motions may have at a time."""
    return math.inf if how.setting is not None else how.accuracy * max(1.0, time / PASSAGE)


def amplified_at(disk: Disk, how: Plan, initial: Array, start: Motion, time: float) -> tuple[Array, Array]:
    """How many times as much motions (n) amplify errors up to a time, and the same where holding them shows it.

    It does not, and the second is infinite, where motions spin fast, or long, so that errors of the phase add up
    over many periods; where each of several slow passages of the vertical, or of a crest of the potential,
    amplifies what the ones before have left; and of paths in fixed steps in which chi turns far.
    initial (10, n): where they start.
    """
    speed = speed_at_vertical(disk, start)
    if time > LINGERS and disk.body.I3 > 0.0:
        rows = Rows(*initial[:5])
        speed = np.fmin(speed, closest_to_crest(disk, arc_starts(disk, rows, start, rows.z >= 0.0)))
    amplified, moved = amplification(speed), centre_speed(disk, start.energy)
    hidden = (moved * max(1.0, time / PASSAGE) > _PERIODS) | ((amplified > _AMPLIFIED) & (time > LINGERS))
    seen = amplified
    if how.level == PATH:  # an error of chi moves the path by as much times its way
        seen = amplified * np.fmax(1.0, moved / _CALIBRATED_WAY)
        hidden |= not how.adaptive and how.control * disk.kappa > _RESOLVED
    return amplified, np.where(hidden, math.inf, seen)


def less_where_amplified(how: Plan, amplified: Array) -> Array:
    """By how much less steps are to err that follow motions which amplify errors.

    Where little happens in the first steps, an adaptive method would take them too long. Fixed ones are as much
    shorter as takes back what is amplified beyond the reserve of the calibration.
    """
    return amplified**-2.0 if how.adaptive else np.fmin(SAFETY / amplified, 1.0)


def in_race(disk: Disk, ended: Array, error: Array) -> Array:
    """The estimate (n) with what an error of the time makes of chi where motions end: their states there (10, n).

    Where flat is so near that it may lie before the end or behind it, the whole race is in doubt.
    """
    row = compiled.field.ROW
    with np.errstate(invalid="ignore"):  # NaN of motions that did not get there
        beside = ended[row.q] < _BESIDE * error * abs(ended[row.p])
    return np.asarray(error * turned(ended) + np.where(beside, math.pi * disk.kappa, 0.0))


def turned(ended: Array) -> Array:
    """How many times an error of the time shows in chi at states (10, n).

    Inside a race chi turns by some 1/|eta| in a unit of time; tilts and rates do not.
    """
    row = compiled.field.ROW
    with np.errstate(all="ignore"):  # NaN of motions that did not get there
        return np.asarray(np.fmax(abs(ended[row.rho] / ended[row.q]) / _TURNED, 1.0))


def rounding_of_path(disk: Disk, energy: Array, steps: NDArray[np.int32], time: float) -> Array:
    """The error (r) by which rounding in all steps moves the ends of paths (n)."""
    return np.asarray(_ROUNDED * np.sqrt(steps) * centre_speed(disk, energy) * time)


def centre_speed(disk: Disk, energy: Array) -> Array:
    """The largest speed of the centre (r in a unit of time) at these energies (n)."""
    return np.asarray(np.sqrt(2.0 * energy / disk.body.J))


def speed_at_vertical(disk: Disk, start: Motion) -> Array:
    """How fast motions pass the vertical or, where they turn before, would at as much more energy as they lack."""
    sigma4_bar = 0.5 * eta_to_eta_hat(disk.body, start.eta_minus - start.eta_plus)
    there = energy_at(disk.body, 0.0, start.sigma3_bar, sigma4_bar, 1.0)
    return np.asarray(np.sqrt(2.0 * disk.body.inv_M * abs(start.energy - there)))

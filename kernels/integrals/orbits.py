"""Whole orbits between two turning points: periods, and the smallest tilt without any integral."""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.falling import potential_at_flat, rounding_at_anchor, spin_at_anchor
from kernels.disk.rows import Entry, put
from kernels.integrals import nodes
from kernels.integrals.departure import at_vertical
from kernels.integrals.ends import Ends
from kernels.integrals.legs import passages_of
from kernels.integrals.point import VERTICAL, Motion, Orbits, Point, Seen, met, point
from kernels.integrals.quadrature import FLOOR, PassageRow, Rules, Start, magnitude, passage
from kernels.integrals.turning import turning_point, turning_point_outward
from kernels.integrals.wells import WIDEST, find_well, guess
from kernels.integrals.wobbles import NOT_THERE, least_tilt, told, whole_wobble
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_LIMIT = int(Status.STEP_LIMIT)
# V is measured from V_0; where V_0 exceeds the energy by more (I3 near 0), its rounding is felt.
_ROUNDING_AT_FLAT = 20.0 * 2.2e-16
_SOON = 0.15  # of sin(phi) at the other turning point
_SHARP = 1e-8  # an accuracy that a soon return does not reach by rules
_SMALL = 0.02  # in x: turning points of larger wobbles are as sharp without their series
_ROUNDING = 8.0 * 2.2e-16  # of E - V at the vertical, for each unit of its terms
_HIDDEN = 64.0 * 2.2e-16  # the same, where it decides whether the vertical is crossed
_APART = 1.1  # of h: between ends nearer than this a motion is a wobble, which series tell sharper
_TOLD = 2.0 * 2.2e-16  # the same, with the vertical as anchor


class OrbitRow(NamedTuple, Generic[Entry]):
    """One period: smallest tilt from this and from the other face (NaN if never there), what a period adds to the
    angles and the time, energy, error of angles, relative error of time."""

    theta_here: Entry
    theta_there: Entry
    chi: Entry
    psi: Entry
    time: Entry
    energy: Entry
    angle_error: Entry
    time_error: Entry


class Crossed(NamedTuple):
    """E - V at the vertical where it is known better than as a difference, else NaN; and its rounding.

    Below 0 the motion turns back before.
    """

    moving: float
    rounding: float


@subroutine
def crossed(seen: Seen, motion: Motion, disk: Disk, W: Vector) -> Crossed:
    """What a state beside the vertical tells of how fast the motion crosses it."""
    moving = 0.5 * disk.body.M * seen.rate * seen.rate
    there, rounding = at_vertical(W, seen.z, moving, motion.X, motion.Y, disk.body)
    return Crossed(there, rounding)


@subroutine
def moving_there(known: Crossed, motion: Motion, disk: Disk) -> float:
    """E - V at the vertical, as a difference if it is not known better."""
    if math.isnan(known.moving):
        return motion.level - point(VERTICAL, motion.X, motion.Y, disk).V
    return known.moving


@subroutine
def told_there(known: Crossed, motion: Motion, disk: Disk) -> Motion:
    """The motion with its level told at the vertical, if that is the anchor and E - V is known there.

    Where I3 is little, V varies so fast with h that the rounding of h itself is felt.
    """
    if disk.body.anchor.dD == 0.0 or math.isnan(known.moving):
        return motion
    return Motion(motion.X, motion.Y, point(VERTICAL, motion.X, motion.Y, disk).V + known.moving)


@subroutine
def upright_start(known: Crossed, motion: Motion, disk: Disk) -> Crossed:
    """E - V at the vertical, which is the anchor, and its rounding, which `explorer` judges."""
    if not math.isnan(known.moving):
        return known
    b = disk.body
    at = point(VERTICAL, motion.X, motion.Y, disk)
    # What V rose or fell by since the state is some parts of this, and may be more than what is left.
    spin = abs(spin_at_anchor(motion.X, motion.Y, b)) + rounding_at_anchor(motion.Y, b)
    risen = b.J * (abs(motion.X) + abs(motion.Y)) * spin
    return Crossed(motion.level - at.V, _TOLD * (risen + magnitude(at, motion, b)))


@subroutine
def way_out(seen: Seen, known: Crossed, motion: Motion, disk: Disk) -> float:
    """h of the turning point towards the vertical; NaN where that is crossed, 0 where rounding hides which.

    The difference E - V tells, and where that is rounding, what is `known` of a state beside the vertical.
    """
    outer, at = turning_point_outward(seen.h, motion, disk), point(VERTICAL, motion.X, motion.Y, disk)
    doubt = _HIDDEN * magnitude(at, motion, disk.body)
    if disk.body.anchor.dD != 0.0:
        doubt = max(doubt, upright_start(known, motion, disk).rounding)
    if abs(motion.level - at.V) > doubt:
        return outer
    if known.moving > known.rounding:
        return math.nan
    if known.moving < -known.rounding:
        return outer if outer > 0.0 else VERTICAL
    if seen.z == 0.0:  # at rest there
        return outer
    barred = outer > 0.0 and motion.level - point(0.5 * (outer + VERTICAL), motion.X, motion.Y, disk).V < -doubt
    return outer if barred else 0.0


@device
def doubted(status: int, row: PassageRow[float], doubt: float, target: float) -> tuple[int, PassageRow[float]]:
    """A passage whose time is in doubt by this share, as are its angles."""
    angle_doubt = doubt * (1.0 + abs(row.chi) + abs(row.psi))
    if not max(doubt, angle_doubt) <= max(target, FLOOR):
        status = _LIMIT
    return status, PassageRow(
        theta_min=row.theta_min,
        chi=row.chi,
        psi=row.psi,
        time=row.time,
        energy=row.energy,
        angle_error=row.angle_error + angle_doubt,
        time_error=row.time_error + doubt,
        way=row.way,
    )


@subroutine
def from_vertical(
    motion: Motion, known: Crossed, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float]]:
    """The passage of a motion that crosses the vertical, with its status.

    Unless it is known, a difference tells how fast it is there. Where it is slow or soon back rules lose some
    digits to that, or do not settle: the series of `departure` carry this number on, whose rounding is then all
    that is lost. With the vertical as anchor it is known as well as it ever is.
    """
    status, row = _LIMIT, NOT_THERE
    if disk.body.anchor.dD != 0.0:
        start = upright_start(known, motion, disk)
        if start.moving > 0.0:
            status, row = passage(Start(VERTICAL, False, start.moving), motion, target, rules, disk, W)
            status, row = doubted(status, row, start.rounding / start.moving, math.inf)
        return status, row
    if known.moving > 0.0:
        status, row = passage(Start(VERTICAL, False, known.moving), motion, target, rules, disk, W)
        status, row = doubted(status, row, known.rounding / known.moving, target)
    elif target >= _SHARP:
        status, row = passage(Start(VERTICAL, False, 0.0), motion, target, rules, disk, W)
    if status == _OK:
        return status, row
    at = point(VERTICAL, motion.X, motion.Y, disk)
    moving = motion.level - at.V
    # E - V = moving + slope/2 sin(phi) + ...
    if target < _SHARP and not 0.0 < 2.0 * moving < -_SOON * at.slope:
        status, row = passage(Start(VERTICAL, False, 0.0), motion, target, rules, disk, W)
    if status == _OK or not moving > 0.0:
        return status, row
    doubt = _ROUNDING * magnitude(at, motion, disk.body) / moving
    status, row = passage(Start(VERTICAL, False, moving), motion, target, rules, disk, W)
    return doubted(status, row, doubt, target)


@subroutine
def orbit(
    seen: Seen, motion: Motion, far: float, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float], PassageRow[float]]:
    """One whole period of a motion through a state on face +1; far: its Y of the other face.

    Returns status, the passage of this face (or between both turning points) and that of the other
    face (chi = psi = time = 0 if the motion does not cross the vertical).
    """
    known = crossed(seen, motion, disk, W)
    motion = told_there(known, motion, disk)
    outer = way_out(seen, known, motion, disk)
    if outer == 0.0:
        return _LIMIT, NOT_THERE, NOT_THERE
    if outer > 0.0:
        status, here = passage(Start(outer, True, 0.0), motion, target, rules, disk, W)
        return status, here, NOT_THERE
    status, here = from_vertical(motion, known, target, rules, disk, W)
    other_status, there = from_vertical(Motion(motion.X, far, motion.level), known, target, rules, disk, W)
    return max(status, other_status), here, there


@subroutine
def period_of(here: PassageRow[float], there: PassageRow[float]) -> OrbitRow[float]:
    """A period from its passages."""
    return OrbitRow(
        theta_here=here.theta_min,
        theta_there=there.theta_min,
        chi=here.chi + there.chi,
        psi=here.psi - there.psi,
        time=here.time + there.time,
        energy=here.energy,
        angle_error=here.angle_error + there.angle_error,
        time_error=max(here.time_error, there.time_error),
    )


@kernel
def orbits_of_legs(orbits: Orbits, ends: Ends, legs: Matrix, disk: Disk, out: Matrix, status: Codes) -> None:
    """The period of every sample whose legs (5, 2n) are known -> out (8, n), rows as OrbitRow.

    NaN where they are not, and where status (n) is not OK.
    """
    b = disk.body
    for i in range(status.size):
        out[:, i] = math.nan
        here, there = passages_of(i, orbits.sigma3_bar[i] / b.r0, ends, legs, b)
        if status[i] == _OK and here.time > 0.0 and there.time >= 0.0:
            put(period_of(here, there), out, i)


@kernel
def orbit_batch(orbits: Orbits, target: float, rules: Rules, disk: Disk, out: Matrix, status: Codes) -> None:
    """The period of every sample that is still NaN in out (8, n), rows as OrbitRow.

    status (n): samples that come in as not OK are skipped. Series first, where they hold the motion: they are
    faster, and know a wobble to rounding; again at the end, where they may hold what the rules did not settle.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        if status[i] != _OK or not math.isnan(out[0, i]):
            continue
        h, rate = orbits.h[i], orbits.rate[i]
        at, motion = met(h, rate, orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1, disk)
        well = told(rate, find_well(h, rate, at, motion, guess(h, rate, at, b), disk, W))
        code, here, there = whole_wobble(well, motion, target, rules, disk, W)
        if code != _OK:
            seen = Seen(h, rate, orbits.z[i])
            code, here, there = orbit(seen, motion, orbits.far[i] / b.I1, target, rules, disk, W)
        if code != _OK:
            well = told(rate, find_well(h, rate, at, motion, WIDEST, disk, W))
            code, here, there = whole_wobble(well, motion, target, rules, disk, W)
        status[i] = code
        put(period_of(here, there), out, i)


@device
def told_by_lanes(ends: Ends, i: int) -> float:
    """h at the flattest moment, where both ends are known and apart; else NaN."""
    here, there = ends.here[i], ends.there[i]
    if not ends.outer[i] > _APART * here:
        return math.nan
    return there if there < here else here


@subroutine
def tilt_doubt(least: float, at: Point[float], known: Crossed, motion: Motion, disk: Disk) -> float:
    """Relative error of h at a turning point from rounding, where the vertical is the anchor; at: the state."""
    b = disk.body
    end = point(least, motion.X, motion.Y, disk)
    spin = abs(spin_at_anchor(motion.X, motion.Y, b)) + rounding_at_anchor(motion.Y, b)
    terms = b.J * (abs(motion.X) + abs(motion.Y)) * spin + magnitude(end, motion, b)
    if math.isnan(known.moving):
        # Rounding of the h of the state is felt, too.
        rounding = _TOLD * (terms + magnitude(at, motion, b) + abs(at.slope))
    else:
        rounding = known.rounding + _TOLD * terms
    # d(E - V)/d ln h = -slope
    return rounding / -end.slope if end.slope < 0.0 else math.inf


@subroutine
def flattest(
    seen: Seen, at: Point[float], motion: Motion, far: float, disk: Disk, W: Vector
) -> tuple[float, float]:
    """(h, its relative error) at the flattest moment of a motion through a state on face +1; NaN if not found.

    at: that state; far: Y of the other face. The error is 0 where potentials are told from flat.
    """
    # At rest, where nothing draws it towards flat, it is flattest there.
    rest = seen.rate == 0.0
    stays, told_upright = rest and not at.slope > 0.0, disk.body.anchor.dD != 0.0
    known = crossed(seen, motion, disk, W)
    motion = told_there(known, motion, disk)
    least = seen.h if stays else turning_point(seen.h, rest, motion, disk, W)
    doubt = tilt_doubt(least, at, known, motion, disk) if told_upright and not stays else 0.0
    outer = way_out(seen, known, motion, disk)
    if outer == 0.0:
        return math.nan, doubt
    if not outer > 0.0:
        beyond = Motion(motion.X, far, motion.level)
        there = turning_point(VERTICAL, False, beyond, disk, W)
        if told_upright and not there >= least:
            doubt = tilt_doubt(there, at, known, beyond, disk)
        least = min(least, there)
    return least, doubt


@kernel
def tilt_batch(orbits: Orbits, ends: Ends, target: float, disk: Disk, out: Vector, status: Codes) -> None:
    """Smallest tilt of every motion -> out (n), from both of its turning points.

    ends: those that lanes have found. A sample whose energy is not known to `target` times what it has above V_0,
    or whose tilt is not where the vertical is the anchor, is STEP_LIMIT; those that come in as not OK are skipped.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        out[i] = math.nan
        if status[i] != _OK:
            continue
        X, least, level, doubt = orbits.sigma3_bar[i] / b.r0, told_by_lanes(ends, i), ends.level[i], 0.0
        if not least > 0.0:
            seen = Seen(orbits.h[i], orbits.rate[i], orbits.z[i])
            at, motion = met(seen.h, seen.rate, X, orbits.near[i] / b.I1, disk)
            reach = guess(seen.h, seen.rate, at, b)
            if reach <= _SMALL:
                well = find_well(seen.h, seen.rate, at, motion, reach, disk, W)
                if well.outer >= well.inner and well.shift <= target:
                    out[i] = least_tilt(well, W)
                    continue
            (least, doubt), level = flattest(seen, at, motion, orbits.far[i] / b.I1, disk, W), motion.level
        out[i] = 2.0 * math.asin(0.5 * least)
        # From flat, V_0 is the largest term; where the vertical is the anchor each term is counted in `doubt`.
        scale = potential_at_flat(X, b) if b.anchor.dD == 0.0 else 0.0
        told_well = doubt <= target and _ROUNDING_AT_FLAT * scale <= target * abs(level + scale)
        if not (least > 0.0 and told_well):
            status[i] = _LIMIT

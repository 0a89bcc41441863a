"""Every approach to flat of a motion: the passages that make up its period, and when the first one is."""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.rows import Entry, put
from kernels.integrals import nodes
from kernels.integrals.ends import AT_VERTICAL, Ends
from kernels.integrals.legs import BESIDE, LEAD, leg_at, passages_of, wanted
from kernels.integrals.orbits import Crossed, crossed, moving_there, orbit
from kernels.integrals.point import VERTICAL, Motion, Orbits, Seen, met, point
from kernels.integrals.quadrature import FLOOR, PassageRow, Rules, Start, magnitude, passage
from kernels.integrals.wells import WIDEST, Well, find_well, guess
from kernels.integrals.wobbles import parted_wobble, time_to_flattest_of_wobble, told
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_LIMIT = int(Status.STEP_LIMIT)
_ROUNDING = 8.0 * 2.2e-16  # of dV/dh, of the sizes of the terms of V
_COARSEST = 0.1  # accuracy of a lead by itself
_VARIES = 0.5  # of theta-dot-dot on the way to a turning point: where it varies more there may be none


class BounceRow(NamedTuple, Generic[Entry]):
    """The approaches to flat of one period, as seen from the hemisphere of the state.

    first: time from the state to the first approach; first_here: 1 where that is to this face, else 0. Then the
    passage of this face (from vertical to vertical, or from turning point to turning point where the motion
    does not cross the vertical) and that of the other face, NaN where there is none. first_error: of `first`, in
    periods. moving: E - V at the vertical, below 0 what the motion lacks to be there; NaN where legs gave the row.
    """

    first: Entry
    first_error: Entry
    first_here: Entry
    energy: Entry
    theta_here: Entry
    chi_here: Entry
    psi_here: Entry
    time_here: Entry
    error_here: Entry
    theta_there: Entry
    chi_there: Entry
    psi_there: Entry
    time_there: Entry
    error_there: Entry
    moving: Entry


@subroutine
def first_approach(rate: float, lead: float, here: float, there: float) -> tuple[float, float]:
    """(time to the first approach, 1 where it is to this face), from the times of the passages.

    rate: theta-dot of the state. lead: time from its tilt to flattest, on this face. there: NaN where the
    motion does not cross the vertical; it then comes back to this face.
    """
    if rate <= 0.0:
        return lead, 1.0
    if math.isnan(there):
        return here - lead, 1.0
    return 0.5 * here - lead + 0.5 * there, 0.0


class Lead(NamedTuple):
    """Time between a state and its flattest moment on this face, and its error."""

    time: float
    error: float


@subroutine
def lead_beside_turn(h: float, rate: float, half: Lead, motion: Motion, disk: Disk) -> Lead:
    """The same of a state just beside a turning point, from its rate; half: of the passage.

    E - V has few digits there, but a = theta-dot-dot varies little. It is even in the time t from the turning
    point, so theta-dot = t (2 a(0) + a(t))/3 and a term of order t^5. NaN where the state is not so near.
    """
    b = disk.body
    at = point(h, motion.X, motion.Y, disk)
    # In ln h: the turning point lies where V falls to.
    way = 0.5 * b.M * rate * rate / at.slope
    if not (abs(way) <= BESIDE and h * (1.0 + way) < VERTICAL):
        return Lead(math.nan, math.inf)
    h_turn = h * (1.0 + way)
    turn = point(h_turn, motion.X, motion.Y, disk)
    # dV/dtheta = dV/dh cos(theta/2)
    push, first = at.slope * at.shape / h, turn.slope * turn.shape / h_turn
    time = 3.0 * b.M * abs(rate / (2.0 * first + push))
    change = push / first - 1.0
    if not abs(change) <= _VARIES:
        return Lead(math.nan, math.inf)
    rounding = _ROUNDING * magnitude(turn, motion, b) / abs(turn.slope)
    error = time * (change * change + way * way + rounding)
    if way < 0.0:
        return Lead(time, error)
    return Lead(half.time - time, half.error + error)


@subroutine
def lead_beside_vertical(seen: Seen, half: Lead, crossing: Crossed, motion: Motion, disk: Disk) -> Lead:
    """The same of a state just beside the vertical that the motion crosses, by mean speeds; else NaN."""
    b = disk.body
    if not (crossing.moving > 0.0 and seen.z <= BESIDE):
        return Lead(math.nan, math.inf)
    at, last = point(seen.h, motion.X, motion.Y, disk), point(VERTICAL, motion.X, motion.Y, disk)
    speeds = math.sqrt(2.0 * b.inv_M * crossing.moving) + abs(seen.rate)
    time = 2.0 * math.asin(seen.z) / speeds
    change = b.inv_M * abs(at.slope * at.shape / seen.h - last.slope * last.shape / VERTICAL)
    error = time * (change * time / speeds + crossing.rounding / crossing.moving)
    return Lead(half.time - time, half.error + error)


@subroutine
def time_to_flattest(
    seen: Seen, here: PassageRow[float], motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, Lead]:
    """Status, and the time between a state and the turning point on the way to flat, `here` being its passage.

    `target` is of the time of that passage: to so much of its own a short lead may not be known.
    """
    h, rate, allowed = seen.h, seen.rate, max(target, FLOOR) * here.time
    half = Lead(0.5 * here.time, 0.5 * here.time * here.time_error)
    if rate != 0.0:
        if h >= VERTICAL - AT_VERTICAL:
            return _OK, half
        beside = lead_beside_turn(h, rate, half, motion, disk)
        if not beside.error - half.error <= allowed:
            beside = lead_beside_vertical(seen, half, crossed(seen, motion, disk, W), motion, disk)
        if beside.error - half.error <= allowed:
            return _OK, beside
    status, lead = passage(Start(h, rate == 0.0, 0.0), motion, target, rules, disk, W)
    if rate == 0.0 and not lead.theta_min > 0.0:
        # At rest, and flatter tilts are barred: the state is at its flattest.
        return _OK, Lead(0.0, 0.0)
    coarser = 10.0 * max(target, FLOOR)
    while status != _OK and coarser <= _COARSEST:
        status, lead = passage(Start(h, rate == 0.0, 0.0), motion, coarser, rules, disk, W)
        if not 0.5 * lead.time * lead.time_error <= allowed:
            status = _LIMIT
        coarser *= 10.0
    return status, Lead(0.5 * lead.time, 0.5 * lead.time * lead.time_error)


@subroutine
def by_series(
    rate: float, well: Well, motion: Motion, target: float, rules: Rules, disk: Disk, W: Vector
) -> tuple[int, PassageRow[float], PassageRow[float], Lead]:
    """Status, the passages of both faces and the time to flattest, by the series of `wells`."""
    status, here, there = parted_wobble(well, motion, target, rules, disk, W)
    if status != _OK:
        return status, here, there, Lead(math.nan, math.nan)
    status, time, error = time_to_flattest_of_wobble(rate, well, target, rules, disk, W)
    return status, here, there, Lead(time, error)


@subroutine
def bounces_of(
    rate: float, here: PassageRow[float], there: PassageRow[float], lead: Lead, moving: float
) -> BounceRow[float]:
    """The bounces of a period from its passages; there.theta_min is NaN where there is none on the other face."""
    crosses = there.theta_min > 0.0
    first, first_here = first_approach(rate, lead.time, here.time, there.time if crosses else math.nan)
    error = lead.error
    if rate > 0.0:
        halves = 0.5 if crosses else 1.0
        error += halves * (here.time_error * here.time + there.time_error * there.time)
    return BounceRow(
        first=first,
        first_error=error / (here.time + there.time),
        first_here=first_here,
        energy=here.energy,
        theta_here=here.theta_min,
        chi_here=here.chi,
        psi_here=here.psi,
        time_here=here.time,
        error_here=max(here.angle_error, here.time_error),
        theta_there=there.theta_min,
        chi_there=there.chi if crosses else math.nan,
        psi_there=there.psi if crosses else math.nan,
        time_there=there.time if crosses else math.nan,
        error_there=max(there.angle_error, there.time_error) if crosses else math.nan,
        moving=moving,
    )


@subroutine
def lead_of(i: int, orbits: Orbits, ends: Ends, legs: Matrix, disk: Disk) -> Lead:
    """The time to flattest of a sample from its legs; NaN where that is not known."""
    if wanted(LEAD, i, orbits, ends):
        leg = leg_at(legs, LEAD * orbits.h.size + i)
        return Lead(0.5 * leg.time, 0.5 * leg.time * leg.time_error)
    h, here = orbits.h[i], leg_at(legs, i)
    if orbits.rate[i] != 0.0 and h < VERTICAL - AT_VERTICAL:
        b = disk.body
        motion = Motion(orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1, ends.level[i])
        half = Lead(0.5 * here.time, 0.5 * here.time * here.time_error)
        beside = lead_beside_turn(h, orbits.rate[i], half, motion, disk)
        return beside if beside.error - half.error <= FLOOR * here.time else Lead(math.nan, math.nan)
    if h - ends.here[i] < ends.outer[i] - h:
        return Lead(0.0, 0.0)
    return Lead(0.5 * here.time, 0.5 * here.time * here.time_error)


@kernel
def bounces_of_legs(orbits: Orbits, ends: Ends, legs: Matrix, disk: Disk, out: Matrix, status: Codes) -> None:
    """The bounces of a period of every sample whose legs (5, 3n) are all known -> out (15, n), rows as BounceRow.

    NaN where they are not, and where status (n) is not OK.
    """
    b, n = disk.body, status.size
    for i in range(n):
        lead = lead_of(i, orbits, ends, legs, disk)
        here, there = passages_of(i, orbits.sigma3_bar[i] / b.r0, ends, legs, b)
        if status[i] == _OK and here.time > 0.0 and there.time >= 0.0 and lead.time >= 0.0:
            put(bounces_of(orbits.rate[i], here, there, lead, math.nan), out, i)
        else:
            out[:, i] = math.nan


@kernel
def bounce_batch(orbits: Orbits, target: float, rules: Rules, disk: Disk, out: Matrix, status: Codes) -> None:
    """The bounces of a period of every sample that is still NaN in out (15, n), rows as BounceRow.

    status (n): samples that come in as not OK are skipped. Series and rules take turns as in `orbits.orbit_batch`.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(status.size):
        if status[i] != _OK or not math.isnan(out[0, i]):
            continue
        h, rate = orbits.h[i], orbits.rate[i]
        at, motion = met(h, rate, orbits.sigma3_bar[i] / b.r0, orbits.near[i] / b.I1, disk)
        well = told(rate, find_well(h, rate, at, motion, guess(h, rate, at, b), disk, W))
        code, here, there, lead = by_series(rate, well, motion, target, rules, disk, W)
        if code != _OK:
            seen = Seen(h, rate, orbits.z[i])
            code, here, there = orbit(seen, motion, orbits.far[i] / b.I1, target, rules, disk, W)
            lead_code, lead = time_to_flattest(seen, here, motion, target, rules, disk, W)
            code = max(code, lead_code)
        if code != _OK:
            well = told(rate, find_well(h, rate, at, motion, WIDEST, disk, W))
            code, here, there, lead = by_series(rate, well, motion, target, rules, disk, W)
        status[i] = code
        moving = moving_there(crossed(Seen(h, rate, orbits.z[i]), motion, disk, W), motion, disk)
        put(bounces_of(rate, here, there, lead, moving), out, i)

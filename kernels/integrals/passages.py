"""Passages and falls of many samples near flat, by tables.

Kernels of their own for few digits and for many: what a caller needs compiles in a part of the time.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import put
from kernels.integrals import sums, tabulated
from kernels.integrals.grades import (
    Lines,
    empty_lines,
    finer,
    first_grade,
    grade_at,
    line_up,
    next_grade,
    take,
)
from kernels.integrals.in_turn import (
    FallRow,
    PassageRow,
    in_turn,
    load_crossings,
    load_departures,
    stands,
    store_falls,
    store_passages,
)
from kernels.integrals.near_flat import tilt_of
from kernels.integrals.sums import CHECK, LANES, Goal
from kernels.integrals.tables import GRADES, ROUGH, Series, Tables
from kernels.status import Status
from kernels.types import Codes, Longs, Matrix, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)
_LINE = 8  # doubles in a line of the cache
FLOOR = 1e-11  # an accuracy below this is met as far as rounding allows
ROUNDING = 4.0 * 2.2e-16  # of a difference, for each unit of its terms


class Crossings(NamedTuple):
    """Motions (n) where they cross the vertical: constants, and the size of theta-dot there."""

    sigma3_bar: Vector
    eta: Vector
    speed: Vector


class Departures(NamedTuple):
    """Falls (n) on F, as they leave the vertical.

    level: E - V_0; moving: kinetic energy at the vertical, below 0 what the motion lacks to be there; doubt: the
    rounding of that. At a slow start `moving` is less than the rounding of `level`.
    """

    sigma3_bar: Vector
    level: Vector
    moving: Vector
    doubt: Vector


class Beside(NamedTuple):
    """Motions (n) beside F where they cross the vertical: constants; E - V there, and the size of its terms."""

    sigma3_bar: Vector
    eta: Vector
    moving: Vector
    size: Vector


class Asked(NamedTuple):
    """Accuracy; the first grade that may give it, and the one behind the last."""

    target: float
    first: int
    end: int


class Room(NamedTuple):
    """Room for groups: lanes, lines, and the samples of a group."""

    lanes: Vector
    lines: Lines
    group: Longs


@maker
def make_room() -> Room:
    """Room in which nobody waits."""
    return Room(lanes_in_line(sums.ROWS * LANES), empty_lines(), np.zeros(LANES, np.int64))


@maker
def lanes_in_line(n: int) -> Vector:
    """Ones (n) that begin where a line of the cache does: a vector across two lines takes as long as two."""
    room = np.ones(n + _LINE)
    first = -(room.ctypes.data // room.itemsize) % _LINE
    return room[first : first + n]


@device
def blank(out: Matrix, i: int) -> None:
    """NaN in column i."""
    for row in range(out.shape[0]):
        out[row, i] = math.nan


@subroutine
def fill(W: Vector, group: Longs, n: int, crossings: Crossings, b: Body) -> None:
    """A group of samples into lanes; a lane without one is given numbers that are not used."""
    for i in range(LANES):
        j = group[i]
        W[sums.X * LANES + i] = crossings.sigma3_bar[j] / b.r0 if i < n else 0.0
        W[sums.Y * LANES + i] = crossings.eta[j] / b.I1 if i < n else 0.0
        W[sums.SPEED * LANES + i] = crossings.speed[j] if i < n else 1.0


@device
def settle(room: Room, k: int, found: Any, grade: int, end: int, out: Matrix) -> None:
    """What a grade found in lane k goes into the results, or its sample waits for a finer grade before `end`."""
    sample, check = room.group[k], room.lanes[CHECK * LANES + k]
    if check == 0.0:
        put(found, out, sample)
    elif check == 1.0 and grade < end - 1:
        line_up(room.lines, finer(grade, end), sample)
    else:
        blank(out, sample)


@subroutine
def in_lane(W: Vector, i: int, low: Series, b: Body) -> PassageRow[float]:
    """The passage that the tables found for lane i."""
    return PassageRow(
        theta_min=tilt_of(W[sums.H_TURN * LANES + i], low),
        chi=W[sums.CHI * LANES + i],
        psi=W[sums.PSI * LANES + i],
        time=W[sums.TIME * LANES + i],
        energy=W[sums.LEVEL * LANES + i] + potential_at_flat(W[sums.X * LANES + i], b),
        angle_error=W[sums.ANGLE_ERROR * LANES + i],
        time_error=W[sums.TIME_ERROR * LANES + i],
        way=W[sums.WAY * LANES + i],
    )


class Work(NamedTuple):
    """Passages to find: from where, how exactly, and where they go."""

    crossings: Crossings
    asked: Asked
    out: Matrix
    status: Codes


@subroutine
def by_tables(work: Work, room: Room, of_body: Tables, low: Series, disk: Disk) -> None:
    """`passage_batch` and `rough_batch`, with the series of their grades."""
    crossings, asked, out, status = work
    goal, n = Goal(asked.target, FLOOR), status.size
    for i in range(n + 1):
        if i < n:
            if status[i] == _OK and crossings.eta[i] == 0.0:
                status[i] = _FALLS
            if status[i] == _OK:
                line_up(room.lines, asked.first, i)
            else:
                blank(out, i)
        if i < n and room.lines.counts[asked.first] < LANES:
            continue
        grade = next_grade(room.lines, i == n)
        while grade >= 0:
            taken = take(room.lines, grade, room.group)
            rows = in_turn(room.group, taken)
            if rows:
                load_crossings(room.lanes, room.group[0], crossings, disk.body)
            else:
                fill(room.lanes, room.group, taken, crossings, disk.body)
            rules = grade_at(of_body, grade)
            tabulated.passages(room.lanes, goal, rules, of_body.vertical, low, disk.body)
            if rows:
                store_passages(room.lanes, room.group[0], low, disk.body, out)
            for k in range(taken):
                if not (rows and stands(room.lanes, k)):
                    settle(room, k, in_lane(room.lanes, k, low, disk.body), grade, asked.end, out)
            grade = next_grade(room.lines, i == n)


@kernel
def passage_batch(
    crossings: Crossings, target: float, of_body: Tables, disk: Disk, out: Matrix, status: Codes
) -> None:
    """The passage on face +1 from the vertical of every motion -> out (8, n or more), as PassageRow.

    target: accuracy of the angles (rad) and of the time (relative). status (n): samples that come in as not OK
    are skipped; eta = 0 is FALLS. Those that tables do not serve stay OK, with NaN: they are left to arcs.
    """
    asked = Asked(target, max(first_grade(target), ROUGH), GRADES)
    by_tables(Work(crossings, asked, out, status), make_room(), of_body, of_body.low, disk)


@kernel
def rough_batch(
    crossings: Crossings, target: float, of_body: Tables, disk: Disk, out: Matrix, status: Codes
) -> None:
    """As `passage_batch`, for targets down to 1e-5: by short series and few nodes."""
    asked = Asked(target, min(first_grade(target), ROUGH), ROUGH + 1)
    by_tables(Work(crossings, asked, out, status), make_room(), of_body, of_body.short, disk)


@subroutine
def departures_beside(motions: Beside, excess: float, b: Body, out: Matrix) -> None:
    """`departure_batch`."""
    slope, unit = b.dr0 / (b.r0 * b.k), b.I3 * b.r0
    for i in range(motions.eta.size):
        bar, eta_hat, moving = motions.sigma3_bar[i], motions.eta[i] / unit, motions.moving[i]
        on_f, turning = slope * bar, 0.5 * b.J * eta_hat
        left = moving - turning * (2.0 * on_f - eta_hat)
        terms = motions.size[i] + abs(turning) * (2.0 * abs(on_f) + abs(eta_hat))
        # V - V_0 at the vertical on F, eq. (3.8). The squares of sigma4 there and at flat are not subtracted:
        # where they are large, nothing would be left of 1.
        flat = bar / (b.k * b.r0)
        rise = flat * excess
        above = 0.5 * b.I1 * (bar * bar) + 0.5 * b.J * rise * (2.0 * flat + rise) + 1.0
        out[0, i], out[1, i], out[2, i] = left + above, left, ROUNDING * terms


@kernel
def departure_batch(motions: Beside, excess: float, disk: Disk, out: Matrix) -> None:
    """Falls on F with the sigma3_bar and energies of motions beside it -> out (3, n), as Departures from level on.

    excess: r'(S) - 1 at the vertical, S = 1. sigma4 there is less by eta_hat than on F, eq. (6.2): no energies are
    subtracted.
    """
    departures_beside(motions, excess, disk.body, out)


@subroutine
def fill_falls(W: Vector, group: Longs, n: int, departures: Departures, b: Body) -> None:
    """A group of falls into lanes; the first fills those that are left over."""
    for i in range(LANES):
        j = group[i] if i < n else group[0]
        W[sums.X * LANES + i] = departures.sigma3_bar[j] / b.r0
        W[sums.LEVEL * LANES + i] = departures.level[j]
        W[sums.MOVING * LANES + i] = departures.moving[j]
        W[sums.START * LANES + i] = departures.doubt[j]


@subroutine
def fall_in_lane(W: Vector, i: int) -> FallRow[float]:
    """The fall that the tables found for lane i, there and back, once."""
    time = 0.5 * W[sums.TIME * LANES + i]
    return FallRow(
        time,
        0.5 * W[sums.CHI * LANES + i],
        0.5 * W[sums.PSI * LANES + i],
        max(0.5 * W[sums.ANGLE_ERROR * LANES + i], W[sums.TIME_ERROR * LANES + i] * time),
    )


@subroutine
def falls_by_tables(
    departures: Departures, target: float, room: Room, of_body: Tables, disk: Disk, out: Matrix
) -> None:
    """`fall_batch`."""
    b, n = disk.body, departures.level.size
    first = first_grade(target)
    for i in range(n + 1):
        if i < n:
            if departures.level[i] > 0.0:
                line_up(room.lines, first, i)
            else:
                blank(out, i)
        if i < n and room.lines.counts[first] < LANES:
            continue
        grade = next_grade(room.lines, i == n)
        while grade >= 0:
            taken = take(room.lines, grade, room.group)
            rows = in_turn(room.group, taken)
            if rows:
                load_departures(room.lanes, room.group[0], departures, b)
            else:
                fill_falls(room.lanes, room.group, taken, departures, b)
            goal = Goal(target if grade < GRADES - 1 else FLOOR, FLOOR)
            tabulated.falls(room.lanes, goal, grade_at(of_body, grade), of_body.vertical, b)
            if rows:
                store_falls(room.lanes, room.group[0], out)
            for k in range(taken):
                if not (rows and stands(room.lanes, k)):
                    settle(room, k, fall_in_lane(room.lanes, k), grade, GRADES, out)
            grade = next_grade(room.lines, i == n)


@kernel
def fall_batch(departures: Departures, target: float, of_body: Tables, disk: Disk, out: Matrix) -> None:
    """The fall on F from the vertical on face +1 of every sample -> out (4, n or more), as FallRow.

    target: accuracy of there and back, as for passages; the last grade gives the best there is. NaN where tables
    do not serve: those are left to arcs.
    """
    falls_by_tables(departures, target, make_room(), of_body, disk, out)

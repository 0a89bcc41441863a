"""Passages and falls of many samples: by tables where they serve, by adaptive quadrature elsewhere.

Two kernels each: what most callers need compiles in half the time.
"""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import put
from kernels.integrals import nodes, tabulated
from kernels.integrals.grades import empty_lines, first_grade, grade_at, line_up, next_grade, take
from kernels.integrals.point import VERTICAL, Motion, motion_through
from kernels.integrals.quadrature import FLOOR, FallRow, PassageRow, Rules, Start, fall, passage
from kernels.integrals.tables import MIDDLE, Tables
from kernels.integrals.tabulated import CHECK, LANES, Goal
from kernels.status import Status
from kernels.types import Codes, Longs, Matrix, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)


class Crossings(NamedTuple):
    """Motions (n) where they cross the vertical: constants, and the size of theta-dot there."""

    sigma3_bar: Vector
    eta: Vector
    speed: Vector


@subroutine
def fill(W: Vector, group: Longs, n: int, crossings: Crossings, b: Body) -> None:
    """A group of samples into lanes; a lane without one is given numbers that are not used."""
    for i in range(LANES):
        j = group[i]
        W[tabulated.X * LANES + i] = crossings.sigma3_bar[j] / b.r0 if i < n else 0.0
        W[tabulated.Y * LANES + i] = crossings.eta[j] / b.I1 if i < n else 0.0
        W[tabulated.SPEED * LANES + i] = crossings.speed[j] if i < n else 1.0


@subroutine
def in_lane(W: Vector, i: int, b: Body) -> PassageRow[float]:
    """The passage that the tables found for lane i."""
    return PassageRow(
        theta_min=2.0 * math.asin(0.5 * W[tabulated.H_TURN * LANES + i]),
        chi=W[tabulated.CHI * LANES + i],
        psi=W[tabulated.PSI * LANES + i],
        time=W[tabulated.TIME * LANES + i],
        energy=W[tabulated.LEVEL * LANES + i] + potential_at_flat(W[tabulated.X * LANES + i], b),
        angle_error=W[tabulated.ANGLE_ERROR * LANES + i],
        time_error=W[tabulated.TIME_ERROR * LANES + i],
        way=W[tabulated.WAY * LANES + i],
    )


@kernel
def passage_batch(
    crossings: Crossings, target: float, of_body: Tables, disk: Disk, out: Matrix, status: Codes
) -> None:
    """The passage on face +1 from the vertical of every motion -> out (8, n), rows as PassageRow.

    target: accuracy of the angles (rad) and of the time (relative). status (n): samples that come in as not OK
    are skipped; eta = 0 is FALLS. Those that tables do not serve stay OK, with NaN: they are left to
    `passage_by_rules_batch`.
    """
    lanes, n = np.ones(tabulated.ROWS * LANES), status.size
    lines, group = empty_lines(), np.zeros(LANES, np.int64)
    first, goal = first_grade(target), Goal(target, FLOOR)
    for i in range(n + 1):
        if i < n:
            out[:, i] = math.nan
            if status[i] == _OK and crossings.eta[i] == 0.0:
                status[i] = _FALLS
            if status[i] == _OK:
                line_up(lines, first, i)
        if i < n and lines.counts[first] < LANES:
            continue
        grade = next_grade(lines, first, i == n)
        while grade >= 0:
            taken = take(lines, grade, group)
            fill(lanes, group, taken, crossings, disk.body)
            tabulated.passages(lanes, goal, grade_at(of_body, grade), of_body, disk.body)
            for k in range(taken):
                if lanes[CHECK * LANES + k] == 0.0:
                    put(in_lane(lanes, k, disk.body), out, group[k])
                else:
                    line_up(lines, grade + 1, group[k])
            grade = next_grade(lines, first, i == n)


@kernel
def passage_by_rules_batch(
    crossings: Crossings, h_end: float, target: float, rules: Rules, disk: Disk, out: Matrix, status: Codes
) -> None:
    """The same, cut at h_end, of every motion that is OK and still NaN in out (8, n).

    A motion that does not come as far as h_end is BAD_INPUT.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    at_vertical = h_end == VERTICAL
    for i in range(status.size):
        if status[i] == _OK and crossings.eta[i] == 0.0:
            status[i] = _FALLS
        if status[i] != _OK or not math.isnan(out[0, i]):
            continue
        speed = crossings.speed[i]
        X, Y = crossings.sigma3_bar[i] / b.r0, crossings.eta[i] / b.I1
        motion = motion_through(VERTICAL, speed, X, Y, disk)
        moving = 0.5 * b.M * speed * speed if at_vertical else 0.0
        start = Start(h_end, speed == 0.0 and at_vertical, moving)
        status[i], row = passage(start, motion, target, rules, disk, W)
        put(row, out, i)


@subroutine
def fill_falls(W: Vector, group: Longs, n: int, sigma3_bar: Vector, energy: Vector, b: Body) -> None:
    """A group of falls into lanes; the first fills those that are left over."""
    for i in range(LANES):
        j = group[i] if i < n else group[0]
        X = sigma3_bar[j] / b.r0
        W[tabulated.X * LANES + i] = X
        W[tabulated.LEVEL * LANES + i] = energy[j] - potential_at_flat(X, b)


@subroutine
def fall_in_lane(W: Vector, i: int) -> FallRow[float]:
    """The fall that the tables found for lane i, there and back, once."""
    time = 0.5 * W[tabulated.TIME * LANES + i]
    return FallRow(
        time,
        0.5 * W[tabulated.CHI * LANES + i],
        0.5 * W[tabulated.PSI * LANES + i],
        max(0.5 * W[tabulated.ANGLE_ERROR * LANES + i], W[tabulated.TIME_ERROR * LANES + i] * time),
    )


@kernel
def fall_batch(
    sigma3_bar: Vector, energy: Vector, target: float, of_body: Tables, disk: Disk, out: Matrix
) -> None:
    """The fall on F from the vertical on face +1 of every sample -> out (4, n), rows as FallRow.

    target: accuracy of there and back, as for passages; below MIDDLE it is the best there is. NaN where tables do
    not serve: those are left to `fall_by_rules_batch`.
    """
    b, n = disk.body, energy.size
    lanes = np.ones(tabulated.ROWS * LANES)
    lines, group = empty_lines(), np.zeros(LANES, np.int64)
    first, goal = first_grade(target), Goal(target if target >= MIDDLE else FLOOR, FLOOR)
    for i in range(n + 1):
        if i < n:
            out[:, i] = math.nan
            if energy[i] > potential_at_flat(sigma3_bar[i] / b.r0, b):
                line_up(lines, first, i)
        if i < n and lines.counts[first] < LANES:
            continue
        grade = next_grade(lines, first, i == n)
        while grade >= 0:
            taken = take(lines, grade, group)
            fill_falls(lanes, group, taken, sigma3_bar, energy, b)
            tabulated.falls(lanes, goal, grade_at(of_body, grade), of_body, b)
            for k in range(taken):
                if lanes[CHECK * LANES + k] == 0.0:
                    put(fall_in_lane(lanes, k), out, group[k])
                else:
                    line_up(lines, grade + 1, group[k])
            grade = next_grade(lines, first, i == n)


@kernel
def fall_by_rules_batch(
    sigma3_bar: Vector, energy: Vector, h_end: float, rules: Rules, disk: Disk, out: Matrix
) -> None:
    """The same from h_end, of every sample that is still NaN in out (4, n).

    It stays NaN where the energy does not exceed V_0.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    for i in range(energy.size):
        X = sigma3_bar[i] / b.r0
        motion = Motion(X, 0.0, energy[i] - potential_at_flat(X, b))
        if math.isnan(out[0, i]) and motion.level > 0.0:
            put(fall(h_end, motion, rules, disk, W), out, i)

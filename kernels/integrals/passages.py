"""Passages and falls of many samples: by tables where they serve, by adaptive quadrature elsewhere."""

import math
from typing import NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import put
from kernels.integrals import nodes, tabulated
from kernels.integrals.point import VERTICAL, Motion, motion_through
from kernels.integrals.quadrature import FLOOR, FallRow, PassageRow, Rules, Start, fall, passage
from kernels.integrals.tables import Tables
from kernels.integrals.tabulated import CHECK, LANES
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)


class Crossings(NamedTuple):
    """Motions (n) where they cross the vertical: constants, and the size of theta-dot there."""

    sigma3_bar: Vector
    eta: Vector
    speed: Vector


class Quadrature(NamedTuple):
    """What integrals are computed by: rules for any body, and tables of this one."""

    rules: Rules
    tables: Tables


@subroutine
def fill(W: Vector, first: int, crossings: Crossings, status: Codes, b: Body) -> None:
    """Samples from `first` on into lanes; a lane without one is given numbers that are not used."""
    for i in range(LANES):
        j = first + i
        usable = j < status.size and status[j] == _OK
        W[tabulated.X * LANES + i] = crossings.sigma3_bar[j] / b.r0 if usable else 0.0
        W[tabulated.Y * LANES + i] = crossings.eta[j] / b.I1 if usable else 0.0
        W[tabulated.SPEED * LANES + i] = crossings.speed[j] if usable else 1.0


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
    crossings: Crossings,
    h_end: float,
    target: float,
    quadrature: Quadrature,
    disk: Disk,
    out: Matrix,
    status: Codes,
) -> None:
    """The passage on face +1 of every motion, cut at h_end -> out (8, n), rows as PassageRow.

    target: accuracy of the angles (rad) and of the time (relative). status (n): samples that come in as not OK
    are skipped; eta = 0 is FALLS; a motion that does not come as far as h_end is BAD_INPUT.
    """
    b, rules = disk.body, quadrature.rules
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    lanes = np.ones(tabulated.ROWS * LANES)  # row CHECK above all
    for i in range(status.size):
        if i % LANES == 0 and h_end == VERTICAL:
            fill(lanes, i, crossings, status, b)
            tabulated.passages(lanes, target, FLOOR, quadrature.tables, b)
        if status[i] == _OK and crossings.eta[i] == 0.0:
            status[i] = _FALLS
        if status[i] != _OK:
            out[:, i] = math.nan
        elif lanes[CHECK * LANES + i % LANES] == 0.0:
            put(in_lane(lanes, i % LANES, b), out, i)
        else:
            speed = crossings.speed[i]
            X, Y = crossings.sigma3_bar[i] / b.r0, crossings.eta[i] / b.I1
            motion = motion_through(VERTICAL, speed, X, Y, disk)
            at_vertical = h_end == VERTICAL
            moving = 0.5 * b.M * speed * speed if at_vertical else 0.0
            start = Start(h_end, speed == 0.0 and at_vertical, moving)
            status[i], row = passage(start, motion, target, rules, disk, W)
            put(row, out, i)


@subroutine
def fill_falls(W: Vector, first: int, sigma3_bar: Vector, energy: Vector, b: Body) -> None:
    """Falls from `first` on into lanes; the last one fills those that are left over."""
    for i in range(LANES):
        j = min(first + i, energy.size - 1)
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
    sigma3_bar: Vector, energy: Vector, h_end: float, quadrature: Quadrature, disk: Disk, out: Matrix
) -> None:
    """The fall on F from h_end on face +1 of every sample -> out (4, n), rows as FallRow.

    NaN where the energy does not exceed V_0.
    """
    b = disk.body
    W = np.zeros(nodes.ROWS * nodes.ROOM)
    lanes = np.ones(tabulated.ROWS * LANES)  # row CHECK above all
    for i in range(energy.size):
        if i % LANES == 0 and h_end == VERTICAL:
            fill_falls(lanes, i, sigma3_bar, energy, b)
            tabulated.falls(lanes, FLOOR, FLOOR, quadrature.tables, b)
        X = sigma3_bar[i] / b.r0
        motion = Motion(X, 0.0, energy[i] - potential_at_flat(X, b))
        if lanes[CHECK * LANES + i % LANES] == 0.0:
            put(fall_in_lane(lanes, i % LANES), out, i)
        elif motion.level > 0.0:
            put(fall(h_end, motion, quadrature.rules, disk, W), out, i)
        else:
            out[:, i] = math.nan

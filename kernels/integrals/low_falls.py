"""Falls on F that begin at rest below the vertical, in lanes: halves of limit motions that do not come up to it.

With theta = theta_start (1 - u^2) the square root at the start is gone and the integrands are even in u, so that
the rules of `legs` serve. Falls that these do not settle are left to `passages.fall_by_rules_batch`.
"""

import math

import numpy as np

from kernels._jit import contracted_subroutine, kernel, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.elementary import sine
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import put
from kernels.integrals import ends, leg_errors, leg_tables, legs, sums
from kernels.integrals.ends import anywhere, at_tilt, barrier_between, settle
from kernels.integrals.leg_tables import LegTables, tilt
from kernels.integrals.near_flat import slope_of
from kernels.integrals.point import Motion
from kernels.integrals.quadrature import FLOOR, FallRow
from kernels.integrals.sums import LANES, OF_CHI, OF_REST, OF_TIME, clear, finish, gather, keep_least
from kernels.types import Longs, Matrix, Vector

_EPSILON = 2.2e-16
_NOISE = 100.0  # units of rounding, as in tabulated
_LEAST_LEFT = 1e-300


@contracted_subroutine
def find_start(V: Vector, of_body: LegTables, b: Body) -> None:
    """H where falls begin, in the lanes of `ends` from X and LEVEL; CHECK is raised where nothing bars the way."""
    tilts = of_body.tilts
    before = tilt(tilts, 0)
    for i in range(LANES):
        V[ends.BARRED * LANES + i] = V[ends.OPEN * LANES + i] = V[ends.CHECK * LANES + i] = 0.0
        V[ends.NEAR * LANES + i], V[ends.WAY * LANES + i] = 0.0, -1.0
        V[ends.GAP * LANES + i] = V[ends.LEVEL * LANES + i]
    for k in range(tilts.shape[1]):
        at = tilt(tilts, k)
        for i in range(LANES):
            level, last_gap = V[ends.LEVEL * LANES + i], V[ends.GAP * LANES + i]
            potential, dV = at_tilt(at, V[ends.X * LANES + i], 0.0, b)
            gap = level - potential
            open_yet = V[ends.BARRED * LANES + i] == 0.0
            barrier = barrier_between(last_gap, V[ends.DV * LANES + i], gap, dV, at.theta - before.theta)
            V[ends.CHECK * LANES + i] = 1.0 if (k > 0) & open_yet & barrier else V[ends.CHECK * LANES + i]
            hit = open_yet & (gap < 0.0)
            below = before.h if k > 0 else 0.0
            V[ends.BARRED * LANES + i] = at.h if hit else V[ends.BARRED * LANES + i]
            V[ends.OPEN * LANES + i] = below if hit else V[ends.OPEN * LANES + i]
            start = below + (at.h - below) * last_gap / (last_gap - gap)
            V[ends.H * LANES + i] = start if hit else V[ends.H * LANES + i]
            V[ends.GAP * LANES + i], V[ends.DV * LANES + i] = gap, dV
        before = at
    for i in range(LANES):
        never = V[ends.BARRED * LANES + i] == 0.0
        V[ends.CHECK * LANES + i] = 1.0 if never else V[ends.CHECK * LANES + i]
        V[ends.H * LANES + i] = 1.0 if never else V[ends.H * LANES + i]
        V[ends.LOG_H * LANES + i] = 0.0  # it is not needed where Y = 0
    settle(V, ends.OTHER, ends.NEAR, of_body.wide, b)


@contracted_subroutine
def begin(W: Vector, V: Vector, of_body: LegTables, b: Body) -> None:
    """The starts found in V into the lanes of `legs`: ANGLE is theta there."""
    for i in range(LANES):
        W[sums.X * LANES + i], W[sums.LEVEL * LANES + i] = (
            V[ends.X * LANES + i],
            V[ends.LEVEL * LANES + i],
        )
        W[sums.CHECK * LANES + i], W[sums.Y * LANES + i] = V[ends.CHECK * LANES + i], 0.0
        # Such a way is short, and no end of it slow but that from rest.
        W[leg_errors.Y_END * LANES + i], W[leg_errors.SLOW * LANES + i] = 0.0, 0.0
        W[leg_errors.ANGLE * LANES + i] = 2.0 * math.asin(0.5 * V[ends.H * LANES + i])
    for i in range(LANES):
        h, level = V[ends.H * LANES + i], W[sums.LEVEL * LANES + i]
        motion = Motion(W[sums.X * LANES + i], 0.0, level)
        at = anywhere(h, 0.0, motion, b, of_body.wide)
        # The energy comes from a start at the vertical, where q = 1.
        rounding = legs.ROUNDING_UNITS * _EPSILON * (abs(level) + legs.terms_of(h, at, motion, b) + 1.0)
        slope = slope_of(h, at, motion.X, b)
        W[leg_errors.ROUNDING * LANES + i] = rounding
        W[sums.NOISE * LANES + i] = _NOISE * _EPSILON + rounding / (slope if slope > rounding else rounding)
        W[sums.LEAST * LANES + i] = 1.0


@contracted_subroutine
def integrate(W: Vector, target: float, first: int, last: int, of_body: LegTables, b: Body) -> None:
    """The falls in the lanes, there and back, by the nodes first to last - 1 of the rules."""
    rules = of_body.rules
    clear(W, sums.SUMS)
    clear(W, sums.TAILS)
    clear(W, sums.ERRORS)
    for j in range(first, last):
        node, weight = rules[leg_tables.NODE, j], rules[leg_tables.WEIGHT, j]
        even, but_one = rules[leg_tables.EVEN, j], rules[leg_tables.EVEN_BUT_ONE, j]
        for i in range(LANES):
            whole = W[leg_errors.ANGLE * LANES + i]
            h = 2.0 * sine(0.5 * whole * (1.0 - node * node))
            motion = Motion(W[sums.X * LANES + i], 0.0, W[sums.LEVEL * LANES + i])
            at = anywhere(h, 0.0, motion, b, of_body.wide)
            left = motion.level - at.V
            keep_least(W, i, left)
            left = left if left > _LEAST_LEFT else _LEAST_LEFT
            dt = 2.0 * whole * node * weight / math.sqrt(2.0 * b.inv_M * left)
            turn = at.n / at.shape2
            chi, rest = dt * turn * at.inv_h, dt * (0.5 * h * turn + motion.X * (1.0 / b.k) + at.rise)
            gather(W, i, OF_CHI, chi, even, but_one)
            gather(W, i, OF_REST, rest, even, but_one)
            gather(W, i, OF_TIME, dt, even, but_one)
            doubt = W[leg_errors.ROUNDING * LANES + i] / left
            W[sums.ANGLE_ERROR * LANES + i] += doubt * (abs(chi) + abs(rest))
            W[sums.TIME_ERROR * LANES + i] += doubt * dt
    leg_errors.tell_errors(W, last - first)
    finish(W, target, FLOOR)


@subroutine
def fall_in_lane(W: Vector, i: int) -> FallRow[float]:
    """The fall in lane i, of there and back."""
    time = 0.5 * W[sums.TIME * LANES + i]
    chi, psi = 0.5 * W[sums.CHI * LANES + i], 0.5 * W[sums.PSI * LANES + i]
    error = max(0.5 * W[sums.ANGLE_ERROR * LANES + i], W[sums.TIME_ERROR * LANES + i] * time)
    return FallRow(time, chi, psi, error)


@subroutine
def fill(V: Vector, group: Longs, n: int, sigma3_bar: Vector, energy: Vector, b: Body) -> None:
    """Falls into lanes; the first one fills those that are left over."""
    for k in range(LANES):
        i = group[k] if k < n else group[0]
        X = sigma3_bar[i] / b.r0
        V[ends.X * LANES + k], V[ends.LEVEL * LANES + k] = X, energy[i] - potential_at_flat(X, b)


@kernel
def low_fall_batch(
    sigma3_bar: Vector, energy: Vector, first: int, target: float, of_body: LegTables, disk: Disk, out: Matrix
) -> None:
    """The fall on F from rest on face +1 of every sample that is still NaN in out (4, n), rows as FallRow.

    first: the rule to begin with. Those that reach the vertical, and those that no rule settles, stay NaN.
    """
    b, sizes = disk.body, of_body.sizes
    V, W = np.ones(ends.ROWS * LANES), np.ones(leg_errors.ROWS * LANES)
    waiting, group = np.empty(energy.size, np.int64), np.zeros(LANES, np.int64)
    count = 0
    for i in range(energy.size):
        if math.isnan(out[0, i]) and energy[i] > potential_at_flat(sigma3_bar[i] / b.r0, b):
            waiting[count] = i
            count += 1
    done = 0
    for grade in range(first):
        done += sizes[grade]
    for grade in range(first, sizes.size):
        left = 0
        for start in range(0, count, LANES):
            taken = min(LANES, count - start)
            group[:taken] = waiting[start : start + taken]
            fill(V, group, taken, sigma3_bar, energy, b)
            find_start(V, of_body, b)
            begin(W, V, of_body, b)
            integrate(W, target, done, done + sizes[grade], of_body, b)
            for k in range(taken):
                if W[sums.CHECK * LANES + k] == 0.0:
                    put(fall_in_lane(W, k), out, group[k])
                elif V[ends.CHECK * LANES + k] == 0.0:
                    waiting[left] = group[k]
                    left += 1
        count, done = left, done + sizes[grade]

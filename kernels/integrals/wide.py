"""Passages that do not come near flat: samples side by side, a fixed number of nodes in ln h.

From the turning point h_m to the vertical ln h grows by L, as L s^2 with s = sin(pi v/2): E - V vanishes at the
turning point like s^2, so the integrand is even in v, and a slow start is crowded by nodes as well. Nothing is
known in closed form; a range L of a few units needs some ten nodes, 26 for the best there is. The turning point is
looked for at tilts that all samples share, and found by Newton's method in ln h.

Rows of the work array are those of `sums`.
"""

import math

from kernels._jit import contracted_device, contracted_subroutine
from kernels.disk.body import Body
from kernels.disk.elementary import exp_fall, inverse_root
from kernels.disk.falling import contracted_potential_above_flat
from kernels.integrals import tables
from kernels.integrals.near_flat import near_flat, slope_of
from kernels.integrals.point import VERTICAL
from kernels.integrals.sums import (
    ANGLE_ERROR,
    CHECK,
    DEPARTED,
    ERRORS,
    H_TURN,
    LANES,
    LEAST,
    LEVEL,
    LOG_TURN,
    NOISE,
    OF_CHI,
    OF_REST,
    OF_TIME,
    ROOT2,
    SPEED,
    START,
    STEP,
    SUMS,
    TAILS,
    TIME_ERROR,
    TURNED,
    WAY,
    WIDTH,
    Goal,
    X,
    Y,
    clear,
    finish,
    gather,
    told_by_coefficients,
    told_by_the_start,
    told_by_the_worst,
)
from kernels.integrals.tables import SCAN_STEP, Fixed, Grade, Series, Tables, fixed
from kernels.integrals.tabulated import EPSILON, departure, motion_of, newton_in_lanes
from kernels.types import Matrix, Vector

_LOG_VERTICAL = 0.5 * math.log(2.0)
_ROUNDS, _SETTLED = 5, 1e-5  # of Newton's method: how many, and the last step at most
_BLUR = 100.0  # units of rounding, as NOISE_UNITS; slow starts feel as many
_STARTED = 2e-3  # share of the terms of E - V with which a motion must leave the vertical
_PARKED = -0.7  # ln h_m of lanes that are left to `quadrature`
_SHORTEST, _LONGEST = 0.02, 4.5  # range of ln h that the nodes cover
_BENT = 0.25 * math.pi * math.pi  # ln h at the vertical, less that at v = 1 - r, is so many times L r^2
# Rows that hold, during the search: ln h and E - V of the last tilt and the one before it, the last but two;
# whether the turning point is behind.
_LOG_ABOVE, _LEFT_ABOVE, _LEFT_BEFORE, _FOUND = OF_CHI.size, OF_REST.size, OF_TIME.size, OF_TIME.last


@contracted_device
def left_at(at: Fixed, x: float, y: float, level: float, b: Body) -> float:
    """E - V at a fixed tilt."""
    ratio, rise = x * at.ratio_x + y * at.ratio_y, x * at.rise_x + y * at.rise_y
    V, _spin = contracted_potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * x / b.k, at.height, b)
    return level - V


@contracted_subroutine
def start(W: Vector, vertical: Matrix, b: Body) -> None:
    """LEVEL from SPEED at the vertical, and the noise of the start."""
    at = fixed(vertical, 0)
    for i in range(LANES):
        x, y, speed = W[X * LANES + i], W[Y * LANES + i], W[SPEED * LANES + i]
        level, terms, noise, _h, _check = departure(x, y, speed, 0.0, at, b)
        moving = 0.5 * b.M * speed * speed
        W[LEVEL * LANES + i], W[NOISE * LANES + i], W[START * LANES + i] = level, terms, _BLUR * noise
        W[CHECK * LANES + i] = 0.0 if moving > _STARTED * terms else 2.0
        W[_LOG_ABOVE * LANES + i], W[_LEFT_ABOVE * LANES + i] = _LOG_VERTICAL, moving
        W[_LEFT_BEFORE * LANES + i], W[_FOUND * LANES + i], W[DEPARTED * LANES + i] = moving, 0.0, moving
        W[LOG_TURN * LANES + i] = 0.0


@contracted_subroutine
def seek(W: Vector, scan: Matrix, b: Body) -> None:
    """A guess at LOG_TURN; CHECK is raised where there is none, or where a barrier may stand between two tilts.

    ROOT2: how far from the vertical, in ln h, a motion has gained as much energy as it left with.
    """
    for j in range(scan.shape[1]):
        at, above = fixed(scan, j), _LOG_VERTICAL - SCAN_STEP * j
        for i in range(LANES):
            left = left_at(at, W[X * LANES + i], W[Y * LANES + i], W[LEVEL * LANES + i], b)
            last, before = W[_LEFT_ABOVE * LANES + i], W[_LEFT_BEFORE * LANES + i]
            sought = W[_FOUND * LANES + i] == 0.0
            barred = sought & (last < before) & (last < left) & (2.0 * last < left + before - 2.0 * last)
            turns = sought & (left < 0.0)
            guess = above - SCAN_STEP * last / (last - left)
            W[CHECK * LANES + i] = 2.0 if barred else W[CHECK * LANES + i]
            W[LOG_TURN * LANES + i] = guess if turns else W[LOG_TURN * LANES + i]
            W[_FOUND * LANES + i] = 1.0 if turns else W[_FOUND * LANES + i]
            W[_LEFT_BEFORE * LANES + i], W[_LEFT_ABOVE * LANES + i] = last, left
    at = fixed(scan, 0)
    for i in range(LANES):
        moving = W[DEPARTED * LANES + i]
        gained = left_at(at, W[X * LANES + i], W[Y * LANES + i], W[LEVEL * LANES + i], b) - moving
        W[ROOT2 * LANES + i] = SCAN_STEP * moving / (gained if gained > moving else moving)
    for i in range(LANES):
        good = (W[_FOUND * LANES + i] == 1.0) & (W[CHECK * LANES + i] == 0.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 2.0
        W[LOG_TURN * LANES + i] = W[LOG_TURN * LANES + i] if good else _PARKED
        W[H_TURN * LANES + i] = VERTICAL * exp_fall(_LOG_VERTICAL - W[LOG_TURN * LANES + i])


@contracted_subroutine
def turn(W: Vector, b: Body, low: Series) -> None:
    """H_TURN, LOG_TURN, WIDTH, WAY and the noise; CHECK is raised where Newton's method finds no root."""
    newton_in_lanes(W, _ROUNDS, b, low)
    for i in range(LANES):
        motion, h, log_h = motion_of(W, i), W[H_TURN * LANES + i], W[LOG_TURN * LANES + i]
        width = _LOG_VERTICAL - log_h
        at = near_flat(h, log_h, motion, b, low)
        slope = -slope_of(h, at, motion.X, b)
        good = (abs(W[STEP * LANES + i]) < _SETTLED) & (width > _SHORTEST) & (width < _LONGEST) & (slope > 0.0)
        W[CHECK * LANES + i] = W[CHECK * LANES + i] if good else 2.0
        W[WIDTH * LANES + i] = width if good else _SHORTEST
        W[ROOT2 * LANES + i] /= _BENT * W[WIDTH * LANES + i]
        W[WAY * LANES + i] = at.n * at.inv_shape
        noise = _BLUR * EPSILON * (1.0 + W[NOISE * LANES + i] / slope) + W[START * LANES + i]
        W[NOISE * LANES + i] = noise if good else 0.0
        W[LEAST * LANES + i] = 1.0
    clear(W, SUMS)
    clear(W, TAILS)
    clear(W, ERRORS)


@contracted_subroutine
def panel(W: Vector, wide: Matrix, b: Body, low: Series) -> None:
    """Add up the integrals from the turning point to the vertical."""
    for j in range(wide.shape[1]):
        gap, weight = wide[tables.GAP, j], wide[tables.WEIGHT, j]
        last, last_but_one = wide[tables.EVEN, j], wide[tables.EVEN_BUT_ONE, j]
        for i in range(LANES):
            motion, width = motion_of(W, i), W[WIDTH * LANES + i]
            d = width * gap
            h = VERTICAL * exp_fall(d)
            at = near_flat(h, _LOG_VERTICAL - d, motion, b, low)
            speed2 = 2.0 * b.inv_M * (motion.level - at.V)
            inv_shape2 = at.inv_shape * at.inv_shape
            step = weight * width * at.inv_shape * inverse_root(speed2)
            rest = h * (0.5 * h * at.n * inv_shape2 + motion.X / b.k + at.rise)
            gather(W, i, OF_CHI, step * at.n * inv_shape2, last, last_but_one)
            gather(W, i, OF_REST, step * rest, last, last_but_one)
            gather(W, i, OF_TIME, step * h, last, last_but_one)


@contracted_subroutine
def passages(W: Vector, goal: Goal, grade: Grade, of_body: Tables, b: Body) -> None:
    """Whole passages of the samples in rows X, Y and SPEED."""
    start(W, of_body.vertical, b)
    seek(W, of_body.scan, b)
    turn(W, b, of_body.wide)
    panel(W, grade.wide, b, of_body.wide)
    for i in range(LANES):
        # On a short way the first nodes lie closer to the turning point.
        missed = TURNED * W[STEP * LANES + i] * W[STEP * LANES + i] * (1.0 + 10.0 / W[WIDTH * LANES + i])
        W[ANGLE_ERROR * LANES + i] += missed
        W[TIME_ERROR * LANES + i] += missed
    told_by_the_start(W, 2 * grade.wide.shape[1])
    if grade.limits.trust_of_wide > 0.0:
        told_by_the_worst(W, grade.limits.trust_of_wide)
    else:
        told_by_coefficients(W)
    finish(W, goal.target, goal.floor)

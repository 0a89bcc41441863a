"""Passages that come near flat, and falls, from the vertical: samples side by side, the same nodes, no branch.

From the vertical to HANDOVER the nodes stand at tilts that are the same for all samples (`tables`). From there to
the turning point they lie in y, and what the terms of first order give is known in closed form (`closed_forms`),
so that few nodes serve every |eta|. What a rule misses is told by its last Legendre coefficients. Motions that do
not come near flat, and those that start too slowly, have no error that tells, and are left to arcs.
"""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import device, kernel, subroutine
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.elementary import EPSILON, exponential, inverse_root
from kernels.disk.falling import potential_above_flat, potential_at_flat
from kernels.near_flat.closed_forms import (
    Closed,
    Integrals,
    PassageConstants,
    closed_forms,
    left_over,
    near_flat,
    newton,
    slope_of,
)
from kernels.near_flat.tables import LAST, LAST_BUT_ONE, SHARE, WEIGHT, Fixed, Low, Rules, Tables, fixed
from kernels.records import Entry, put, reader, writer
from kernels.types import Matrix, Vector

LANES = 64  # _ROWS rows of them lie within the first cache
WIDEST = 0.1  # of h_m: well inside HANDOVER
_NARROWEST = 1e-303  # of |Y|: h_m must not be denormal
_PARKED = 0.1  # h_m of lanes that are left to arcs: any number within the bounds
_ROUNDS = 5  # of Newton's method, from the law of first order to rounding
_SLOWEST = 1e-3  # share of the energy with which a motion must leave the vertical
_MIDDLE = 0.8  # r^2 of a slow start that has gained as much as it left with at the middle of the rule
_OF_START = 0.1  # what is missed of a slow start, in e^(-2 n sqrt(r)): no error of 500,000 was twice its estimate
_OF_COEFFICIENTS = 10.0  # what a rule misses, in squares of the share of its last coefficients
_SETTLED = 1e-8  # Newton's last step: the next one, about its square, would be rounding
_ROUNDING = 100.0 * EPSILON  # of angles and time
# Rows of the work array.
(
    # the motion; ROUNDED: what rounding does to angles and time
    _X, _Y, _LEVEL, _MOVING, _ROUNDED, _H, _LOG_H, _STEP, _TURN_RATE,
    _CHI, _REST, _TIME, _ANGLE_ERROR, _TIME_ERROR,
    _CLOSED,
) = range(0, 15 * LANES, LANES)  # fmt: skip
# Where records begin: PassageConstants; Integrals; after the ten rows of Closed, Integrals of sizes and of the
# last coefficients at fixed tilts.
_MOTION, _SUMS = _X, _CHI
_SIZES, _LAST, _BEFORE, _ROWS = range(_CLOSED + 10 * LANES, _CLOSED + 20 * LANES, 3 * LANES)
read_motion = reader(PassageConstants, LANES)
read_closed, write_closed = reader(Closed, LANES), writer(Closed, LANES)
read_integrals, write_integrals = reader(Integrals, LANES), writer(Integrals, LANES)


class Crossings(NamedTuple):
    """Motions (n) where they cross the vertical: constants, and the size of theta-dot there."""

    sigma3_bar: Vector
    eta: Vector
    speed: Vector


class Departures(NamedTuple):
    """Falls (n) on F, as they leave the vertical.

    level: E - V_0; moving: kinetic energy at the vertical, below 0 what the motion lacks to be there; rounding: of
    that. At a slow start `moving` is less than the rounding of `level`.
    """

    sigma3_bar: Vector
    level: Vector
    moving: Vector
    rounding: Vector


class PassageRow(NamedTuple, Generic[Entry]):
    """A passage from its start to the turning point and back, natural units, face +1.

    theta_min: smallest tilt; chi, psi, time: increases; angle_error (rad), time_error (relative): of these.
    turn_rate: sigma3/q at the turning point, whose sign is the direction of the race.
    """

    theta_min: Entry
    chi: Entry
    psi: Entry
    time: Entry
    energy: Entry
    angle_error: Entry
    time_error: Entry
    turn_rate: Entry


class FallRow(NamedTuple, Generic[Entry]):
    """The fall on F to flat: time, increases of chi and psi, and their error. psi changes sign on face -1."""

    time: Entry
    chi: Entry
    psi: Entry
    error: Entry


@device
def leave(W: Vector, i: int, at: Fixed, given: float, b: Body) -> None:
    """What rounding in E - V does to a motion that leaves the vertical; its level, unless that is `given`.

    It acts while the motion is within about a radian of the vertical.
    """
    x, y, moving, rounding = W[_X + i], W[_Y + i], W[_MOVING + i], W[_ROUNDED + i]
    inv_k = 1.0 / b.k
    ratio, rise = x * at.ratio_x + y * at.ratio_y, x * at.rise_x + y * at.rise_y
    gyration = 0.5 * b.I1 * ratio * ratio
    _V, spin = potential_above_flat(gyration, rise, 2.0 * x * inv_k, 1.0, b)
    level = given if given > 0.0 else moving + gyration + spin + 1.0
    terms = abs(level) + gyration + abs(spin) + 1.0
    duration = min(1.0, math.sqrt(0.5 * b.M / moving))
    of_start = (4.0 * EPSILON * terms + rounding) / moving * duration * (1.0 + abs(ratio) + abs(x * inv_k + rise))
    W[_LEVEL + i], W[_ROUNDED + i] = level, _ROUNDING * (1.0 + terms / abs(level)) + of_start
    W[_TIME_ERROR + i] = 0.0 if moving > _SLOWEST * level else math.nan


@subroutine
def turn(W: Vector, b: Body, low: Low) -> None:
    """H and LOG_H of the turning point; no error where it is not near flat, or not found to rounding.

    Integrands near a turning point change by a thousand times the share by which it is off.
    """
    for i in range(LANES):
        level, size = W[_LEVEL + i], abs(W[_Y + i])
        first = size * math.sqrt(0.5 * b.I1 / level)
        # Gravity shares the energy at the turning point: one step of q = h.
        left = level - first
        near = (size > _NARROWEST) & (first < 2.0 * WIDEST) & (left > 0.5 * level)
        W[_H + i] = size * math.sqrt(0.5 * b.I1 / left) if near else _PARKED
        W[_TIME_ERROR + i] = W[_TIME_ERROR + i] if near else math.nan
    for i in range(LANES):
        W[_LOG_H + i] = math.log(W[_H + i])
    for _ in range(_ROUNDS):
        for i in range(LANES):
            motion = read_motion(W, _MOTION, i)
            W[_H + i], W[_LOG_H + i], W[_STEP + i] = newton(W[_H + i], W[_LOG_H + i], motion, b, low)
    for i in range(LANES):
        near = (W[_H + i] < WIDEST) & (abs(W[_STEP + i]) < _SETTLED)
        W[_H + i], W[_LOG_H + i] = W[_H + i] if near else _PARKED, W[_LOG_H + i] if near else math.log(_PARKED)
        W[_TIME_ERROR + i] = W[_TIME_ERROR + i] if near else math.nan


@subroutine
def begin_near(W: Vector, b: Body, low: Low) -> None:
    """What is known in closed form below the handover; its factors into rows."""
    for i in range(LANES):
        h, log_h, motion = W[_H + i], W[_LOG_H + i], read_motion(W, _MOTION, i)
        at = near_flat(h, 1.0 / h, log_h, motion, b, low)
        slope = -slope_of(h, at, motion.X, b)
        good = slope > 0.0
        known, integrals = closed_forms(h, log_h, at, slope if good else 1.0, motion, b, low)
        W[_TURN_RATE + i] = at.n * at.inv_shape
        W[_ROUNDED + i] += _ROUNDING * W[_LEVEL + i] / slope
        write_integrals(W, _SUMS, i, integrals)
        write_closed(W, _CLOSED, i, known)
        W[_ANGLE_ERROR + i], W[_TIME_ERROR + i] = 0.0, W[_TIME_ERROR + i] if good else math.nan


@device
def add(W: Vector, row: int, i: int, weight: float, node: Integrals) -> None:
    """Add what a node gives, so many times, to integrals of lane i."""
    total = read_integrals(W, row, i)
    chi, rest = total.chi + weight * node.chi, total.rest + weight * node.rest
    write_integrals(W, row, i, Integrals(chi, rest, total.time + weight * node.time))


@device
def add_sizes(W: Vector, i: int, node: Integrals) -> None:
    """Add what a node gives to the integrals of lane i, and to those of sizes."""
    add(W, _SUMS, i, 1.0, node)
    add(W, _SIZES, i, 1.0, Integrals(abs(node.chi), abs(node.rest), abs(node.time)))


@subroutine
def near_panel(W: Vector, rules: Rules, b: Body, low: Low) -> None:
    """Add what the closed forms leave between the turning point and the handover."""
    inner = rules.inner
    for j in range(inner.shape[1]):
        share, weight = inner[SHARE, j], 5.0 * inner[WEIGHT, j]
        for i in range(LANES):
            known, motion = read_closed(W, _CLOSED, i), read_motion(W, _MOTION, i)
            v, rate = known.lowest + (1.0 - known.lowest) * share, weight * (1.0 - known.lowest)
            node = left_over(v, W[_H + i], W[_LOG_H + i], known, motion, b, low)
            rate /= v
            add_sizes(W, i, Integrals(rate * node.chi, rate * node.rest, rate * node.time))
    for i in range(LANES):
        size = read_integrals(W, _SIZES, i)
        W[_ANGLE_ERROR + i] += rules.truncation * (size.chi + size.rest)
        W[_TIME_ERROR + i] += rules.truncation * size.time


@device
def at_fixed(at: Fixed, motion: PassageConstants, b: Body) -> tuple[float, Integrals]:
    """(theta-dot^2, weighted integrands) of a motion at a fixed tilt."""
    ratio = motion.X * at.ratio_x + motion.Y * at.ratio_y
    rise = motion.X * at.rise_x + motion.Y * at.rise_y
    flat = motion.X * (1.0 / b.k)
    V, _spin = potential_above_flat(0.5 * b.I1 * ratio * ratio, rise, 2.0 * flat, at.height, b)
    speed2 = 2.0 * b.inv_M * (motion.level - V)
    inv_speed = inverse_root(speed2)
    rest = at.time * inv_speed * (ratio * at.slope + flat + rise)
    return speed2, Integrals(at.chi * ratio * inv_speed, rest, at.time * inv_speed)


@subroutine
def far_panel(W: Vector, nodes: Matrix, b: Body) -> None:
    """Add a stretch below the vertical, by nodes at tilts that all samples share, and what rules miss."""
    W[_LAST:_ROWS] = 0.0
    n = nodes.shape[1]
    for j in range(n):
        at, last, last_but_one = fixed(nodes, j), nodes[LAST, j], nodes[LAST_BUT_ONE, j]
        for i in range(LANES):
            _speed2, node = at_fixed(at, read_motion(W, _MOTION, i), b)
            add_sizes(W, i, node)
            add(W, _LAST, i, last, node)
            add(W, _BEFORE, i, last_but_one, node)
    estimate_truncation(W, nodes, b)


@device
def share_of(last: float, before: float, size: float) -> float:
    """The last coefficients of a rule over its sum of sizes, 1 at most."""
    share = (abs(last) + abs(before)) / (size + 1e-300)  # never 0/0
    return share if share < 1.0 else 1.0


@subroutine
def estimate_truncation(W: Vector, nodes: Matrix, b: Body) -> None:
    """Add what a rule at fixed tilts misses.

    Its last coefficients tell it: the error of a Gauss rule goes like the square of their share. Two in turn may
    vanish by chance, so that the largest share of all three integrals serves each. Where the speed vanishes at i r
    from the end of a rule, all may; what it misses then falls like e^(-2 n sqrt(r)).
    """
    n = nodes.shape[1]
    middle = fixed(nodes, n // 2)
    for i in range(LANES):
        speed2, _node = at_fixed(middle, read_motion(W, _MOTION, i), b)
        moving = W[_MOVING + i]
        gained = 0.5 * b.M * speed2 - moving
        root2 = _MIDDLE * moving / (gained if gained > moving else moving)
        of_start, _less = exponential(-2.0 * n * math.sqrt(math.sqrt(root2)))
        size = read_integrals(W, _SIZES, i)
        last, before = read_integrals(W, _LAST, i), read_integrals(W, _BEFORE, i)
        angles = max(share_of(last.chi, before.chi, size.chi), share_of(last.rest, before.rest, size.rest))
        share = max(angles, share_of(last.time, before.time, size.time))
        truncation = _OF_COEFFICIENTS * share * share + _OF_START * of_start
        W[_ANGLE_ERROR + i] += truncation * (size.chi + size.rest)
        W[_TIME_ERROR + i] += truncation * size.time


@subroutine
def finish(W: Vector, times: float) -> None:
    """CHI, REST and TIME so many times, and their errors with rounding; that of the time is relative."""
    for i in range(LANES):
        chi, rest, time, rounding = W[_CHI + i], W[_REST + i], W[_TIME + i], W[_ROUNDED + i]
        W[_ANGLE_ERROR + i] = times * (W[_ANGLE_ERROR + i] + rounding * (abs(chi) + abs(rest)))
        W[_TIME_ERROR + i] = W[_TIME_ERROR + i] / time + rounding
        W[_CHI + i], W[_REST + i], W[_TIME + i] = times * chi, times * rest, times * time


@subroutine
def load(W: Vector, row: int, values: Vector, first: int, unit: float) -> None:
    """Numbers in units into a row, from `first` on; the last one fills the lanes that are left over."""
    n = min(LANES, values.size - first)
    some, room = values[first : first + n], W[row : row + LANES]
    for i in range(n):
        room[i] = some[i] / unit
    for i in range(n, LANES):
        room[i] = room[n - 1]


@kernel
def passage_batch(crossings: Crossings, tables: Tables, disk: NaturalDisk, out: Matrix) -> None:
    """The passage on face +1 from the vertical of every motion -> out (8, n or more), as PassageRow.

    time_error is NaN where tables do not serve.
    """
    b, rules, low = disk.body, tables.rules, tables.low
    W, at = np.zeros(_ROWS), fixed(tables.vertical, 0)
    for first in range(0, crossings.eta.size, LANES):
        load(W, _X, crossings.sigma3_bar, first, b.r0)
        load(W, _Y, crossings.eta, first, b.I1)
        load(W, _MOVING, crossings.speed, first, 1.0)
        for i in range(LANES):
            W[_MOVING + i] *= 0.5 * b.M * W[_MOVING + i]
            W[_ROUNDED + i] = 0.0
            leave(W, i, at, 0.0, b)
        W[_SIZES:_LAST] = 0.0
        turn(W, b, low)
        begin_near(W, b, low)
        near_panel(W, rules, b, low)
        far_panel(W, rules.outer, b)
        finish(W, 2.0)
        for i in range(min(LANES, crossings.eta.size - first)):
            row = PassageRow(
                theta_min=2.0 * math.asin(0.5 * W[_H + i]),
                chi=W[_CHI + i],
                psi=W[_CHI + i] - W[_REST + i],
                time=W[_TIME + i],
                energy=W[_LEVEL + i] + potential_at_flat(W[_X + i], b),
                angle_error=W[_ANGLE_ERROR + i],
                time_error=W[_TIME_ERROR + i],
                turn_rate=W[_TURN_RATE + i],
            )
            put(row, out, first + i)


@kernel
def fall_batch(departures: Departures, tables: Tables, disk: NaturalDisk, out: Matrix) -> None:
    """The fall on F from the vertical on face +1 of every sample -> out (4, n or more), as FallRow.

    error is NaN where tables do not serve.
    """
    b, n = disk.body, departures.level.size
    W, at = np.zeros(_ROWS), fixed(tables.vertical, 0)
    for first in range(0, n, LANES):
        W[:] = 0.0
        load(W, _X, departures.sigma3_bar, first, b.r0)
        load(W, _LEVEL, departures.level, first, 1.0)
        load(W, _MOVING, departures.moving, first, 1.0)
        load(W, _ROUNDED, departures.rounding, first, 1.0)
        for i in range(LANES):
            leave(W, i, at, W[_LEVEL + i], b)
        far_panel(W, tables.rules.fall, b)
        finish(W, 1.0)
        for i in range(min(LANES, n - first)):
            angle = W[_ANGLE_ERROR + i]
            time = W[_TIME_ERROR + i] * min(W[_TIME + i], 1.0)  # a share, if it is long
            error = angle if angle > time else time  # NaN where that of the time is
            put(FallRow(W[_TIME + i], W[_CHI + i], W[_CHI + i] - W[_REST + i], error), out, first + i)

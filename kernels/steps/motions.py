"""Many motions at given times: lanes that the compiler vectorises, a kernel for each method and depth.

As in `batch`, LANES samples advance side by side, each with its own step, and a lane whose sample has ended takes
the next one at once. What lies within a step is found for many samples together: the states at the times asked,
and, before the first step, the starts on their constants. No result depends on a sample's neighbours.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kernels._jit import device, kernel, maker, subroutine
from kernels.disk.body import Body, Disk
from kernels.disk.chaplygin import Whole
from kernels.disk.constants import Constants
from kernels.disk.field import ANGLES, PATH, State, column, energy, pace
from kernels.disk.rows import put
from kernels.status import Status
from kernels.steps import attempt as by
from kernels.steps import motion_lanes as lanes
from kernels.steps.attempt import (
    DOP853,
    DOPRI5,
    RK4,
    RK8,
    Ending,
    Integration,
    Outcome,
    first_step,
    judge,
    settle,
    to_depth,
)
from kernels.steps.events import TIME, Stop
from kernels.steps.lanes import BROKEN, NOTHING, STUCK, onto_circle
from kernels.steps.motion_lanes import BEFORE, LANES, NOW, Taken, read, work_array, write
from kernels.steps.trail import Trail, keep, shorten
from kernels.types import Matrix, Table, Vector

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)
_LOOK = 100_000  # sweeps between two looks at whether anybody still waits: a tenth of a second


class Motions(NamedTuple):
    """Motions to follow to increasing times > 0, and where their states go.

    states (10, n), pinned (3, n): starts and what they are held to, rows as State and Pinned. out (n, times, 10):
    the states; what it holds of motions that are not OK means nothing. last (10, n): where each ended. taken
    (3, n): what holding took on the way, rows as Taken.
    """

    how: Integration
    times: Vector
    states: Matrix
    pinned: Matrix
    out: Table
    last: Matrix
    taken: Matrix
    outcome: Outcome


NOT_FOLLOWED = Taken(math.nan, math.nan, math.nan)


class Place(NamedTuple):
    """How far the work is: the next sample to prepare, how many of those prepared are in lanes, how many lanes are
    busy, and when one of them runs out of steps."""

    upcoming: int
    handed: int
    busy: int
    due: int


@subroutine
def end(work: Motions, j: int, code: int, spent: int, last: State, taken: Taken[float]) -> None:
    """Sample j has ended."""
    put(last, work.last, j)
    put(taken, work.taken, j)
    work.outcome.status[j], work.outcome.steps[j] = code, spent


@subroutine
def load(work: Motions, j: int, W: Vector, i: int, b: Body) -> None:
    """Sample j into column i, but for what its start on its constants tells."""
    W[lanes.X_HELD * LANES + i] = work.pinned[0, j] / b.r0
    W[lanes.Y_PLUS * LANES + i] = work.pinned[1, j] / b.I1
    W[lanes.Y_MINUS * LANES + i] = work.pinned[2, j] / b.I1
    x = onto_circle(column(work.states, j), not math.isnan(work.pinned[0, j]))
    write(W, NOW, i, x)
    write(W, BEFORE, i, x)
    W[lanes.CONTROL * LANES + i] = work.how.control[j]
    W[lanes.NEXT * LANES + i], W[lanes.SAMPLE * LANES + i] = work.times[0], j


@subroutine
def prepare(work: Motions, W: Vector, upcoming: int, disk: Disk, whole: Whole) -> int:
    """The next samples as they start, on their constants; returns the one after them."""
    status, b = work.outcome.status, disk.body
    for i in range(LANES):
        while upcoming < status.size and status[upcoming] != _OK:
            end(work, upcoming, status[upcoming], 0, column(work.states, upcoming), NOT_FOLLOWED)
            upcoming += 1
        lanes.idle(W, i)
        if upcoming < status.size:
            load(work, upcoming, W, i, b)
            upcoming += 1
    lanes.hold(W, W.view(np.int64), whole, b)
    method = work.how.method
    for i in range(LANES):
        if W[lanes.SAMPLE * LANES + i] >= 0.0:
            x = read(W, NOW, i)
            unit = pace(x, b)
            W[lanes.ENERGY * LANES + i], W[lanes.UNIT * LANES + i] = energy(x, b), unit
            W[lanes.STEP * LANES + i] = first_step(method, W[lanes.CONTROL * LANES + i], unit)
            W[lanes.REMOVED * LANES + i] = W[lanes.EXCESS * LANES + i] = W[lanes.MOVED * LANES + i] = 0.0
    return upcoming


@subroutine
def unwanted(work: Motions, W: Vector) -> bool:
    """Whether somebody has changed the status of a sample in a lane: nobody waits for any of them any more."""
    changed = False
    for i in range(LANES):
        j = int(W[lanes.SAMPLE * LANES + i])
        changed |= j >= 0 and work.outcome.status[j] != _OK
    return changed


@subroutine
def leave(work: Motions, W: Vector, begun: int, sweeps: int) -> None:
    """Take the samples that have ended, or that began before a sweep, out of their lanes."""
    number = work.times.size
    for i in range(LANES):
        if lanes.has_ended(W, i, number, begun):
            note = W[lanes.NOTE * LANES + i]
            failed = note in (BROKEN, STUCK)
            code = _OK if W[lanes.MET * LANES + i] == number else _STEP_LIMIT
            if failed:
                code = _NOT_FINITE if note == BROKEN else _TOO_SMALL
            last, spent = read(W, BEFORE if failed else NOW, i), sweeps - int(W[lanes.SINCE * LANES + i])
            end(work, int(W[lanes.SAMPLE * LANES + i]), code, spent, last, lanes.taken(W, i))
            lanes.idle(W, i)


@subroutine
def fill(work: Motions, W: Vector, ready: Vector, place: Place, sweeps: int, disk: Disk, whole: Whole) -> Place:
    """Samples into the lanes that are empty."""
    upcoming, handed = place.upcoming, lanes.hand_over(W, ready, place.handed, sweeps)
    while handed == LANES and upcoming < work.outcome.status.size:
        upcoming = prepare(work, ready, upcoming, disk, whole)
        handed = lanes.hand_over(W, ready, 0, sweeps)
    busy, oldest = 0, sweeps
    for i in range(LANES):
        if W[lanes.SAMPLE * LANES + i] >= 0.0:
            busy, oldest = busy + 1, min(oldest, int(W[lanes.SINCE * LANES + i]))
    return Place(upcoming, handed, busy, oldest + work.how.max_steps)


@subroutine
def put_down(attempt_by: Any, work: Motions, W: Vector, waiting: int, b: Body) -> None:
    """States at the times met within the last steps of a landing."""
    lanes.land_all(attempt_by, W, b)
    out, method, depth = work.out, work.how.method, work.how.depth
    for i in range(waiting):
        y = read(W, NOW, i)
        if W[lanes.NOTE * LANES + i] != NOTHING:
            stop = Stop(TIME, W[lanes.NEXT * LANES + i])
            whole, length = W[lanes.WHOLE * LANES + i], W[lanes.TAKEN * LANES + i]
            y = settle(method, read(W, BEFORE, i), whole, length, stop, b)
        y = to_depth(y, depth)
        j, k = int(W[lanes.SAMPLE * LANES + i]), int(W[lanes.MET * LANES + i])
        for component in range(10):
            out[j, k, component] = y[component]


class Room(NamedTuple):
    """Work arrays: of the samples under way, of those that are ready to go, and of those that land."""

    W: Vector
    ready: Vector
    landing: Vector


@maker
def make_room() -> Room:
    """Room in which there are no samples."""
    return Room(work_array(), work_array(), work_array())


@device
def follow(attempt_by: Any, work: Motions, trail: Trail, room: Room, disk: Disk, whole: Whole) -> None:
    """Follow every motion to all of the times, by steps of `attempt_by`, which the trail keeps.

    Where there is one and it is cut off, the outcome means nothing. Whoever waits for it no more changes the
    statuses of all samples: none is then begun, and those that are under way end within _LOOK sweeps.
    """
    W, ready, landing = room.W, room.ready, room.landing
    bits, times, max_steps, b = W.view(np.int64), work.times, work.how.max_steps, disk.body
    sweeps = waiting = 0
    place = fill(work, W, ready, Place(0, LANES, 0, 0), 0, disk, whole)
    due = min(place.due, _LOOK)
    while place.busy > 0:
        if trail.most > 0:
            shorten(trail.curve, work.how.method, W, b)
        attention = lanes.sweep(attempt_by, W, b)
        sweeps += 1
        lanes.hold(W, bits, whole, b)
        if trail.most > 0 and keep(trail, W) >= trail.most:
            return
        if attention == 0 and sweeps < due:
            continue
        waiting = lanes.collect(W, times, landing, waiting)
        while waiting == LANES:
            put_down(attempt_by, work, landing, waiting, b)
            waiting = lanes.collect(W, times, landing, 0)
        begun = sweeps - max_steps + 1
        if sweeps >= due:
            if unwanted(work, W):
                begun = sweeps + 1
            due = min(place.due, sweeps + _LOOK)
        if lanes.any_ended(W, times.size, begun):
            leave(work, W, begun, sweeps)
            place = fill(work, W, ready, place, sweeps, disk, whole)
            due = min(place.due, sweeps + _LOOK)
    put_down(attempt_by, work, landing, waiting, b)


@kernel
def judge_batch(work: Motions, before: Matrix, after: Matrix, disk: Disk) -> None:
    """Statuses and errors of the constants, from those at the starts and ends, rows as Constants.

    The error of the energy includes what was taken out on the way. Errors are NaN of motions that were skipped.
    """
    outcome = work.outcome
    for i in range(outcome.status.size):
        held = not math.isnan(work.pinned[0, i])
        first = Constants(before[0, i], before[1, i], before[2, i], before[3, i], before[4, i], before[5, i])
        last = Constants(after[0, i], after[1, i], after[2, i], after[3, i], after[4, i], after[5, i])
        bound = work.how.constants_bound
        ending = Ending(outcome.status[i], work.last[5, i], work.taken[0, i], held, bound)
        outcome.status[i], errors = judge(ending, first, last, disk.body)
        put(errors, outcome.errors, i)
        if math.isnan(work.taken[0, i]):
            outcome.errors[:, i] = math.nan


@device
def rk4_angles(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    """One step with time and angles; alike below."""
    return by.rk4_attempt(ANGLES, x, h, control, unit, b)


@device
def rk8_angles(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.rk8_attempt(ANGLES, x, h, control, unit, b)


@device
def dopri5_angles(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.dopri5_attempt(ANGLES, x, h, control, unit, b)


@device
def dop853_angles(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.dop853_attempt(ANGLES, x, h, control, unit, b)


@device
def rk4_path(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    """One step with the path too; alike below."""
    return by.rk4_attempt(PATH, x, h, control, unit, b)


@device
def rk8_path(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.rk8_attempt(PATH, x, h, control, unit, b)


@device
def dopri5_path(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.dopri5_attempt(PATH, x, h, control, unit, b)


@device
def dop853_path(x: State, h: float, control: float, unit: float, b: Body) -> tuple[State, bool, float]:
    return by.dop853_attempt(PATH, x, h, control, unit, b)


@kernel
def motions_rk4_angles(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk4, with time and angles."""
    follow(rk4_angles, work, trail, make_room(), disk, whole)


@kernel
def motions_rk8_angles(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk8, with time and angles."""
    follow(rk8_angles, work, trail, make_room(), disk, whole)


@kernel
def motions_dopri5_angles(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dopri5, with time and angles."""
    follow(dopri5_angles, work, trail, make_room(), disk, whole)


@kernel
def motions_dop853_angles(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dop853, with time and angles."""
    follow(dop853_angles, work, trail, make_room(), disk, whole)


@kernel
def motions_rk4_path(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk4, with the path."""
    follow(rk4_path, work, trail, make_room(), disk, whole)


@kernel
def motions_rk8_path(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by rk8, with the path."""
    follow(rk8_path, work, trail, make_room(), disk, whole)


@kernel
def motions_dopri5_path(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dopri5, with the path."""
    follow(dopri5_path, work, trail, make_room(), disk, whole)


@kernel
def motions_dop853_path(work: Motions, trail: Trail, disk: Disk, whole: Whole) -> None:
    """Follow every motion by dop853, with the path."""
    follow(dop853_path, work, trail, make_room(), disk, whole)


MOTIONS: dict[tuple[int, int], Callable[[Motions, Trail, Disk, Whole], None]] = {
    (RK4, ANGLES): motions_rk4_angles,
    (RK8, ANGLES): motions_rk8_angles,
    (DOPRI5, ANGLES): motions_dopri5_angles,
    (DOP853, ANGLES): motions_dop853_angles,
    (RK4, PATH): motions_rk4_path,
    (RK8, PATH): motions_rk8_path,
    (DOPRI5, PATH): motions_dopri5_path,
    (DOP853, PATH): motions_dop853_path,
}

"""Many motions at once to where an event takes given values: one engine for all methods and depths.

LANES samples advance side by side, each with its own step, and a lane whose sample has ended takes the next one at
once. What lies within a step is found for many samples together. No result depends on a sample's neighbours.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from kernels._jit import Kernel, device, kernel, maker, subroutine
from kernels.disk.body import Body, NaturalDisk
from kernels.disk.field import ANGLES, PATH, REDUCED, State, column, energy, pace
from kernels.status import Status
from kernels.steps import lanes
from kernels.steps.attempt import ATTEMPTS, NAMES, first_step, to_depth
from kernels.steps.events import Event, Stop, crossed, first_guess, level, locate, settle
from kernels.steps.lanes import BEFORE, BROKEN, HIT, LANES, NOTHING, NOW, STUCK, idle, onto_circle, read, write
from kernels.types import Codes, Counts, Matrix, Table, Vector

_OK = int(Status.OK)
_STEP_LIMIT = int(Status.STEP_LIMIT)
_TOO_SMALL = int(Status.STEP_TOO_SMALL)
_NOT_FINITE = int(Status.NOT_FINITE)
_LOOK = 100_000  # sweeps between two looks at whether anybody still waits: a tenth of a second
_ANY = 1e300  # a tolerance that any step meets


class Work(NamedTuple):
    """Motions to follow, and what becomes of them.

    method: RK4 ...; max_steps: attempts, refused ones included. event, values: where to stop, in this order.
    control (n): step in units of 1/speed (RK4, RK8) or tolerance (DOPRI5, DOP853). states (5 or 10, n): starts,
    rows as State; what is lacking is 0. linear (3, n): sigma3_bar, eta_plus and eta_minus that they are held to,
    NaN where one runs free. status (n): samples that come in as not OK are skipped; one that somebody changes ends
    its motion soon. out (n, values, 10): the states, NaN where one was not reached. steps (n): attempted ones.
    moved (3, n): rows as Moved.
    """

    method: int
    max_steps: int
    event: Event
    values: Vector
    control: Vector
    states: Matrix
    linear: Matrix
    status: Codes
    out: Table
    steps: Counts
    moved: Matrix


class Moved(NamedTuple):
    """What holding a motion to its constants showed of the error of its steps, and NaN where it ran free.

    energy: its largest relative error; removed: the sum of those that were taken out. rates: the sum of what
    sigma3/q and sigma4 were moved by, over their bounds.
    """

    energy: Any
    removed: Any
    rates: Any


class Progress(NamedTuple):
    """How far the work is: the next sample, how many lanes are busy, and after which sweep all are looked at."""

    upcoming: int
    busy: int
    due: int


@subroutine
def begin(work: Work, j: int, W: Vector, i: int, sweeps: int, b: Body) -> None:
    """Start sample j in lane i."""
    W[lanes.X_HELD + i] = work.linear[0, j] / b.r0
    W[lanes.Y_PLUS + i] = work.linear[1, j] / b.I1
    W[lanes.Y_MINUS + i] = work.linear[2, j] / b.I1
    x, control = onto_circle(column(work.states, j), not math.isnan(work.linear[0, j])), work.control[j]
    unit = pace(x, b)
    write(W, NOW, i, x)
    W[lanes.ENERGY + i], W[lanes.UNIT + i] = energy(x, b), unit
    W[lanes.CONTROL + i], W[lanes.STEP + i] = first_step(work.method, control, unit)
    W[lanes.NEXT + i], W[lanes.SAMPLE + i] = work.values[0], j
    W[lanes.MET + i], W[lanes.SINCE + i] = 0.0, sweeps
    W[lanes.LARGEST + i] = W[lanes.REMOVED + i] = W[lanes.MOVED + i] = 0.0


@subroutine
def fill(work: Work, W: Vector, place: Progress, sweeps: int, b: Body) -> Progress:
    """The next samples into the lanes that are empty."""
    upcoming, busy, status, look = place.upcoming, 0, work.status, sweeps >= place.due
    due = sweeps + min(work.max_steps, _LOOK) if look else place.due
    for i in range(LANES):
        if W[lanes.SAMPLE + i] < 0.0:
            while upcoming < status.size and status[upcoming] != _OK:
                upcoming += 1
            if upcoming == status.size:
                idle(W, i)
                continue
            begin(work, upcoming, W, i, sweeps, b)
            upcoming += 1
        elif look:
            due = min(due, int(W[lanes.SINCE + i]) + work.max_steps)
        busy += 1
    return Progress(upcoming, busy, due)


@subroutine
def leave(work: Work, W: Vector, sweeps: int, look: bool) -> None:
    """Take the samples that have ended out of their lanes; look: also those that take too long."""
    for i in range(LANES):
        note = W[lanes.NOTE + i]
        if note == NOTHING and not look:
            continue
        j, spent = int(W[lanes.SAMPLE + i]), sweeps - int(W[lanes.SINCE + i])
        if j < 0 or (note == NOTHING and spent < work.max_steps and work.status[j] == _OK):
            continue
        work.steps[j] = spent
        if note != lanes.THROUGH:
            work.status[j] = _NOT_FINITE if note == BROKEN else _TOO_SMALL if note == STUCK else _STEP_LIMIT
        elif not math.isnan(W[lanes.X_HELD + i]):
            work.moved[0, j] = W[lanes.LARGEST + i] / W[lanes.ENERGY + i]
            work.moved[1, j] = W[lanes.REMOVED + i] / W[lanes.ENERGY + i]
            work.moved[2, j] = W[lanes.MOVED + i] / W[lanes.UNIT + i]
        W[lanes.SAMPLE + i] = -1.0


@subroutine
def collect(work: Work, W: Vector, arrived: Vector, waiting: int) -> int:
    """Send steps to `arrived`, once for each value they met, until it is full; returns how many wait there."""
    values = work.values
    for i in range(LANES):
        while W[lanes.NOTE + i] == HIT:
            if waiting == LANES:
                return waiting
            for row in range(0, lanes.ROWS, LANES):
                arrived[row + waiting] = W[row + i]
            waiting += 1
            met = int(W[lanes.MET + i]) + 1
            W[lanes.MET + i] = met
            following = values[met] if met < values.size else math.inf
            W[lanes.NEXT + i] = following
            before, after = level(read(W, BEFORE, i), work.event), level(read(W, NOW, i), work.event)
            if not crossed(before, after, following):
                W[lanes.NOTE + i] = lanes.THROUGH if met == values.size else NOTHING
    return waiting


@subroutine
def locate_all(attempt: Any, depth: int, work: Work, W: Vector, waiting: int, disk: NaturalDisk) -> None:
    """States at the values met within the last steps of lanes: first by a step about as far, then located.

    SINCE is then the length of the whole step.
    """
    b = disk.body
    for i in range(LANES):
        x, end, h = read(W, BEFORE, i), read(W, NOW, i), W[lanes.TAKEN + i]
        W[lanes.STEP + i] = first_guess(x, end, h, Stop(work.event, W[lanes.NEXT + i]), b)
        W[lanes.SINCE + i], W[lanes.CONTROL + i] = h, _ANY
        write(W, NOW, i, x)
    lanes.sweep(attempt, W, work.event, b)
    lanes.hold(W, disk)
    for i in range(LANES):
        h = W[lanes.SINCE + i]
        y, found = locate(read(W, NOW, i), h, Stop(work.event, W[lanes.NEXT + i]), b)
        W[lanes.NOTE + i] = NOTHING if found else STUCK
        write(W, NOW, i, to_depth(y, depth))
    for i in range(waiting):
        y = read(W, NOW, i)
        if W[lanes.NOTE + i] != NOTHING:
            stop, h = Stop(work.event, W[lanes.NEXT + i]), W[lanes.SINCE + i]
            y = to_depth(settle(work.method, read(W, BEFORE, i), h, W[lanes.TAKEN + i], stop, b), depth)
        j, k = int(W[lanes.SAMPLE + i]), int(W[lanes.MET + i])
        for component in range(10):
            work.out[j, k, component] = y[component]


@maker
def make_lanes() -> Vector:
    """A work array without samples."""
    W = np.zeros(lanes.ROWS)
    for i in range(LANES):
        idle(W, i)
    return W


@device
def follow(attempt: Any, depth: int, work: Work, room: tuple[Vector, Vector], disk: NaturalDisk) -> None:
    """Follow every motion to all of the values, by steps of `attempt`.

    room: lanes for those under way, and for those whose event is being located.
    """
    (W, arrived), b = room, disk.body
    sweeps = waiting = 0
    place = fill(work, W, Progress(0, 0, 0), 0, b)
    while place.busy > 0:
        attention = lanes.sweep(attempt, W, work.event, b)
        sweeps += 1
        lanes.hold(W, disk)
        if attention > 0 or sweeps >= place.due:
            waiting = collect(work, W, arrived, waiting)
            while waiting == LANES:
                locate_all(attempt, depth, work, arrived, waiting, disk)
                waiting = collect(work, W, arrived, 0)
            leave(work, W, sweeps, sweeps >= place.due)
            place = fill(work, W, place, sweeps, b)
    locate_all(attempt, depth, work, arrived, waiting, disk)


def at_depth(method: int, depth: int) -> Any:
    """One attempted step by a method that carries what a depth needs, both known to the compiler."""
    by = ATTEMPTS[method]

    def attempt(x: State, h: float, control: float, unit: float, b: Body) -> Any:
        return by(depth, x, h, control, unit, b)

    attempt.__qualname__ = f"attempt_{NAMES[method]}_{depth}"
    return device(attempt)


def _kernel(method: int, depth: int, name: str) -> Kernel:
    attempt = at_depth(method, depth)

    def run(work: Work, disk: NaturalDisk) -> None:
        """Follow every motion by one method at one depth."""
        follow(attempt, depth, work, (make_lanes(), make_lanes()), disk)

    run.__name__ = run.__qualname__ = name
    return kernel(run)


FOLLOW = {
    (method, depth): _kernel(method, depth, f"{NAMES[method]}_{word}")
    for method in ATTEMPTS
    for depth, word in ((REDUCED, "reduced"), (ANGLES, "angles"), (PATH, "path"))
}

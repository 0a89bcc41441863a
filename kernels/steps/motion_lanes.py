"""Lanes of motions in time: as `lanes`, with the path, with times to be met on the way, and with the energy held.

A motion is put back onto its constants after every step by sums and products that the compiler may round together;
so motions that are held equal to rounding what a plain loop gives, and motions that run free bit for bit.
"""

import math
from typing import Any, Generic, NamedTuple

import numpy as np

from kernels._jit import contracted_subroutine, device, maker, subroutine
from kernels.disk.body import Body
from kernels.disk.chaplygin import Whole
from kernels.disk.constants import fastest_within, onto_energy
from kernels.disk.field import State, with_reduced
from kernels.disk.rows import Entry
from kernels.steps.adaptive import SHORTEST_STEP
from kernels.steps.attempt import all_finite, first_guess, land
from kernels.steps.events import TIME, Stop
from kernels.steps.lanes import BROKEN, HIT, NOTHING, STUCK, Held, max_of, onto_circle, rates, split
from kernels.types import Longs, Vector

LANES = 16  # as in `lanes`
# Rows of the work array, entry (row, i) at row * LANES + i: one flat array, for the reason that `lanes` gives.
NOW, BEFORE = 0, 10  # states: after and before the latest attempted step
(
    # the next step and the latest, which is 0 where it was refused
    STEP, TAKEN,
    CONTROL, UNIT, NOTE,
    # the next time to be met, and in a landing the length of the whole step
    NEXT, WHOLE,
    # constants of motion that the sample is held to, as Motion has them; NaN in X_HELD: it runs free
    X_HELD, Y_PLUS, Y_MINUS, ENERGY,
    # what holding has taken from the energy so far, and its size; and moved, rho and sigma4 by their bounds
    REMOVED, EXCESS, MOVED,
    # which sample it is (-1: none), how many times it has met, and the sweep in which it began
    SAMPLE, MET, SINCE,
    EXPONENT, MANTISSA,
) = range(20, 39)  # fmt: skip
ROWS = 39
_ANY = 1e300  # a tolerance that any step meets


@device
def read(W: Vector, row: int, i: int) -> State:
    """The state in column i, its first component in the given row."""
    return State(
        W[row * LANES + i],
        W[(row + 1) * LANES + i],
        W[(row + 2) * LANES + i],
        W[(row + 3) * LANES + i],
        W[(row + 4) * LANES + i],
        W[(row + 5) * LANES + i],
        W[(row + 6) * LANES + i],
        W[(row + 7) * LANES + i],
        W[(row + 8) * LANES + i],
        W[(row + 9) * LANES + i],
    )


@device
def write(W: Vector, row: int, i: int, y: State) -> None:
    """Put a state into column i, its first component into the given row."""
    W[row * LANES + i] = y.q
    W[(row + 1) * LANES + i] = y.z
    W[(row + 2) * LANES + i] = y.p
    W[(row + 3) * LANES + i] = y.rho
    W[(row + 4) * LANES + i] = y.sigma4
    W[(row + 5) * LANES + i] = y.t
    W[(row + 6) * LANES + i] = y.chi
    W[(row + 7) * LANES + i] = y.psi
    W[(row + 8) * LANES + i] = y.a1
    W[(row + 9) * LANES + i] = y.a2


@subroutine
def sweep(attempt_by: Any, W: Vector, b: Body) -> int:
    """One attempted step of every lane by `attempt_by`; returns how many need attention."""
    for i in range(LANES):
        x = read(W, NOW, i)
        h = W[STEP * LANES + i]
        unit = W[UNIT * LANES + i]
        y, accepted, following = attempt_by(x, h, W[CONTROL * LANES + i], unit, b)
        hit = accepted & (y.t >= W[NEXT * LANES + i])
        broken = accepted & (not all_finite(y))
        stuck = (not accepted) & (not following * unit > SHORTEST_STEP)
        note = HIT if hit else NOTHING
        note = BROKEN if broken else note
        note = STUCK if stuck else note
        W[NOTE * LANES + i] = note
        W[TAKEN * LANES + i] = h if accepted else 0.0
        W[STEP * LANES + i] = following
        write(W, BEFORE, i, x)
        y = onto_circle(y, W[X_HELD * LANES + i] == W[X_HELD * LANES + i])
        write(W, NOW, i, y if accepted else x)
    attention = 0
    for i in range(LANES):
        attention += W[NOTE * LANES + i] != NOTHING
    return attention


@contracted_subroutine
def hold(W: Vector, bits: Longs, whole: Whole, b: Body) -> None:
    """Put every lane that is held back onto its constants, and where it is fastest onto its energy.

    That is once in each swing: what steps do to the energy on the way down is mostly undone on the way up, and p
    would take up an error of the tilt. bits: W seen as integers. Needs I3 > 0 of lanes that are held.
    """
    split(bits, NOW, EXPONENT, MANTISSA)
    inv_kappa, weight, inv_k = 1.0 / b.kappa, math.sqrt(b.J_over_M), 1.0 / b.k
    for i in range(LANES):
        x, bar = read(W, NOW, i), W[X_HELD * LANES + i]
        # All are loaded, so that nothing branches.
        plus, minus = W[Y_PLUS * LANES + i], W[Y_MINUS * LANES + i]
        held = Held(bar, plus, minus, W[MANTISSA * LANES + i], W[EXPONENT * LANES + i])
        rho, sigma4 = rates(held, x, inv_k, whole, b)
        y = with_reduced(x, x.q, x.z, x.p, rho, sigma4)
        fastest = fastest_within(read(W, BEFORE, i), y, b)
        faster, excess = onto_energy(y, W[ENERGY * LANES + i], b)
        excess = excess if fastest & (bar == bar) else 0.0
        W[REMOVED * LANES + i] += excess
        W[EXCESS * LANES + i] += abs(excess)
        W[MOVED * LANES + i] += max_of(abs(rho - x.rho) * inv_kappa, abs(sigma4 - x.sigma4) * weight)
        W[(NOW + 2) * LANES + i] = faster.p if fastest & (bar == bar) else x.p
        W[(NOW + 3) * LANES + i] = y.rho if bar == bar else x.rho
        W[(NOW + 4) * LANES + i] = y.sigma4 if bar == bar else x.sigma4


@subroutine
def idle(W: Vector, i: int) -> None:
    """Park lane i: an upright disk at rest that takes steps of length zero."""
    for row in range(ROWS):
        W[row * LANES + i] = 0.0
    W[NOW * LANES + i] = W[BEFORE * LANES + i] = W[CONTROL * LANES + i] = W[UNIT * LANES + i] = 1.0
    W[ENERGY * LANES + i] = 1.0
    W[NEXT * LANES + i], W[SAMPLE * LANES + i] = math.inf, -1.0
    W[X_HELD * LANES + i] = math.nan


class Taken(NamedTuple, Generic[Entry]):
    """What holding took from a motion: energy; the sum of its sizes, relative; and of what it moved rho and sigma4
    by, relative to their bounds."""

    energy: Entry
    excess: Entry
    moved: Entry


@device
def taken(W: Vector, i: int) -> Taken[float]:
    """What holding took from the sample in lane i."""
    removed, excess = W[REMOVED * LANES + i], W[EXCESS * LANES + i] / W[ENERGY * LANES + i]
    return Taken(removed, excess, W[MOVED * LANES + i] / W[UNIT * LANES + i])


@device
def move(W: Vector, i: int, there: Vector, k: int) -> None:
    """Column i of one work array into column k of another."""
    for row in range(ROWS):
        there[row * LANES + k] = W[row * LANES + i]


@device
def send(W: Vector, i: int, time: float, landing: Vector, k: int) -> None:
    """The last step of column i into column k of a landing, to be cut short at a time."""
    for row in range(STEP):
        landing[row * LANES + k] = W[row * LANES + i]
    landing[UNIT * LANES + k], landing[WHOLE * LANES + k] = W[UNIT * LANES + i], W[TAKEN * LANES + i]
    landing[SAMPLE * LANES + k], landing[MET * LANES + k] = W[SAMPLE * LANES + i], W[MET * LANES + i]
    landing[NEXT * LANES + k] = time


@subroutine
def collect(W: Vector, times: Vector, landing: Vector, waiting: int) -> int:
    """Send steps to the landing, once for each time they met, until it is full; returns how many wait there."""
    for i in range(LANES):
        if W[NOTE * LANES + i] == HIT:
            met, now = int(W[MET * LANES + i]), W[(NOW + 5) * LANES + i]
            while met < times.size and times[met] <= now:
                if waiting == LANES:
                    return waiting
                send(W, i, times[met], landing, waiting)
                waiting += 1
                met += 1
                W[MET * LANES + i] = met
            W[NEXT * LANES + i] = times[met] if met < times.size else math.inf
    return waiting


@device
def has_ended(W: Vector, i: int, number: int, begun: int) -> bool:
    """Whether the sample in lane i, if any, has met that many times, has failed, or began before a sweep."""
    note = W[NOTE * LANES + i]
    over = (W[MET * LANES + i] == number) | (note == BROKEN) | (note == STUCK) | (W[SINCE * LANES + i] < begun)
    return over & (W[SAMPLE * LANES + i] >= 0.0)


@subroutine
def any_ended(W: Vector, number: int, begun: int) -> bool:
    """Whether `has_ended` is true of any lane."""
    ended = False
    for i in range(LANES):
        ended |= has_ended(W, i, number, begun)
    return ended


@subroutine
def hand_over(W: Vector, ready: Vector, handed: int, sweeps: int) -> int:
    """Samples that are ready into empty lanes; returns how many of those that were ready are in lanes."""
    for i in range(LANES):
        if W[SAMPLE * LANES + i] < 0.0 and handed < LANES:
            move(ready, handed, W, i)
            W[SINCE * LANES + i] = sweeps
            handed += 1
    return handed


@subroutine
def land_all(attempt_by: Any, W: Vector, b: Body) -> None:
    """From the last steps of all columns to their next times; the note is STUCK where that did not succeed.

    WHOLE: the length of these steps, from BEFORE to NOW. TAKEN is then the length of the partial step.
    """
    for i in range(LANES):
        x, end = read(W, BEFORE, i), read(W, NOW, i)
        stop = Stop(TIME, W[NEXT * LANES + i])
        W[STEP * LANES + i] = first_guess(x, end, W[WHOLE * LANES + i], stop, b)
        W[CONTROL * LANES + i], W[X_HELD * LANES + i] = _ANY, math.nan
        write(W, NOW, i, x)
    sweep(attempt_by, W, b)
    for i in range(LANES):
        stop = Stop(TIME, W[NEXT * LANES + i])
        y, found = land(read(W, NOW, i), W[WHOLE * LANES + i], stop, b)
        W[NOTE * LANES + i] = NOTHING if found else STUCK
        write(W, NOW, i, y)


@maker
def work_array() -> Vector:
    """Lanes without samples."""
    W = np.zeros(ROWS * LANES)
    for i in range(LANES):
        idle(W, i)
    return W

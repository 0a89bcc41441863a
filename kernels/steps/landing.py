"""Landings: where the events lie within the last steps of many samples, located side by side.

A sample that has met its event leaves its lane, which takes the next sample at once. When a whole group has left,
their last steps are cut short together: by the cubic through both ends of the step, then by two short steps.
"""

from kernels._jit import subroutine
from kernels.disk.body import Body
from kernels.steps.attempt import first_guess
from kernels.steps.attempt import land as land_one
from kernels.steps.events import Stop
from kernels.steps.lanes import BEFORE, LANES, NOTE, NOTHING, NOW, ROWS, STEP, STUCK, TAKEN, read, write
from kernels.types import Vector


@subroutine
def move(W: Vector, i: int, there: Vector, k: int) -> None:
    """Column i of the lanes into column k of the landings."""
    for row in range(ROWS):
        there[row * LANES + k] = W[row * LANES + i]


@subroutine
def aim(there: Vector, stop: Stop, b: Body) -> None:
    """Put all columns back to the start of their last step, to go only about as far as the event; TAKEN stays in
    the row of notes."""
    for i in range(LANES):
        x, end, h = read(there, BEFORE, i), read(there, NOW, i), there[TAKEN * LANES + i]
        there[STEP * LANES + i] = first_guess(x, end, h, stop, b)
        there[NOTE * LANES + i] = h
        write(there, NOW, i, x)


@subroutine
def land(there: Vector, stop: Stop, b: Body) -> None:
    """From the ends of the partial steps to the events; the note is STUCK where that did not succeed.

    Row STEP holds the length of the whole step.
    """
    for i in range(LANES):
        y, found = land_one(read(there, NOW, i), there[STEP * LANES + i], stop, b)
        there[NOTE * LANES + i] = NOTHING if found else STUCK
        write(there, NOW, i, y)

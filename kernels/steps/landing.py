"""Landings: where the events lie within the last steps of many samples, located side by side.

A sample that has met its event leaves its lane, which takes the next sample at once. When a whole group has left,
their last steps are cut short together: by the cubic through both ends of the step, then by short steps.
"""

from kernels._jit import subroutine
from kernels.disk.body import Body
from kernels.steps.attempt import first_guess, land
from kernels.steps.events import Stop
from kernels.steps.lanes import BEFORE, LANES, NOTE, NOTHING, NOW, ROWS, STEP, STUCK, TAKEN, WHOLE, read, write
from kernels.types import Vector


@subroutine
def move(W: Vector, i: int, there: Vector, k: int) -> None:
    """Column i of one work array into column k of another."""
    for row in range(ROWS):
        there[row * LANES + k] = W[row * LANES + i]


@subroutine
def aim(W: Vector, stop: Stop, b: Body) -> None:
    """Put all columns back to the start of their last step, to go only about as far as the event."""
    for i in range(LANES):
        x, end = read(W, BEFORE, i), read(W, NOW, i)
        W[WHOLE * LANES + i] = W[TAKEN * LANES + i]
        W[STEP * LANES + i] = first_guess(x, end, W[WHOLE * LANES + i], stop, b)
        write(W, NOW, i, x)


@subroutine
def approach_events(W: Vector, stop: Stop, b: Body) -> None:
    """From the ends of the partial steps to the events; the note is STUCK where that did not succeed."""
    for i in range(LANES):
        y, found = land(read(W, NOW, i), W[WHOLE * LANES + i], stop, b)
        W[NOTE * LANES + i] = NOTHING if found else STUCK
        write(W, NOW, i, y)

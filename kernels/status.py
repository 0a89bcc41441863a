"""Outcome of one sample: a code, what it means, what to do about it."""

from enum import IntEnum


class Status(IntEnum):
    """Outcome of one sample. Kernels never raise; they return one of these."""

    OK = 0
    FALLS = 1
    BAD_INPUT = 2
    STEP_LIMIT = 3
    STEP_TOO_SMALL = 4
    NOT_FINITE = 5
    INVARIANT_DRIFT = 6
    UNRESOLVED_SIDE = 7

    @property
    def sentence(self) -> str:
        """What happened, in one sentence."""
        return _TEXTS[self][0]

    @property
    def remedy(self) -> str:
        """What the user can do about it."""
        return _TEXTS[self][1]


_TEXTS = {
    Status.OK: ("The sample was computed to the accuracy asked.", "Nothing to do."),
    Status.FALLS: (
        "The state lies on the falling set to rounding: the disk falls flat in finite time.",
        "Use the one-sided limit motions to continue it.",
    ),
    Status.BAD_INPUT: (
        "The initial state is not a number, is infinite, or is already flat.",
        "Give finite values with -pi/2 < phi < pi/2.",
    ),
    Status.STEP_LIMIT: (
        "The work allowed ended before the event or the accuracy asked: a slow start, or an equilibrium near.",
        "Raise the step cap, or ask for less accuracy.",
    ),
    Status.STEP_TOO_SMALL: ("The step size fell below what rounding allows.", "Ask for less accuracy."),
    Status.NOT_FINITE: (
        "The integration overflowed or became undefined.",
        "Use a smaller step or the adaptive method.",
    ),
    Status.INVARIANT_DRIFT: (
        "A constant of motion drifted further than the accuracy asked allows.",
        "Use a smaller step, a tighter accuracy, or the adaptive method.",
    ),
    Status.UNRESOLVED_SIDE: (
        "The error in eta is not small against eta, so the direction of the race is unknown.",
        "Ask for more accuracy, or stay further from the falling set.",
    ),
}

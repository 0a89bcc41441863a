"""Outcome of one sample: a code, what it means, what to do about it."""

from enum import IntEnum


class Status(IntEnum):
    """Outcome of one sample. Kernels never raise; they return one of these.

    Attributes
    ----------
    sentence : str
        What happened.
    remedy : str
        What the caller can do about it.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.Status(7).name
    'UNRESOLVED_SIDE'
    >>> ex.Status.STEP_LIMIT.remedy
    'Allow larger errors (a larger `accuracy`), or try another `method`.'
    """

    OK = 0
    FALLS = 1
    BAD_INPUT = 2
    STEP_LIMIT = 3
    STEP_TOO_SMALL = 4
    NOT_FINITE = 5
    INVARIANT_DRIFT = 6
    UNRESOLVED_SIDE = 7
    TOO_FEW_DIGITS = 8

    @property
    def sentence(self) -> str:
        """What happened, in one sentence."""
        return _TEXTS[self][0]

    @property
    def remedy(self) -> str:
        """What the user can do about it."""
        return _TEXTS[self][1]


# A remedy is something that every call which returns the status lets its caller do.
_TEXTS = {
    Status.OK: ("The sample was computed to the accuracy asked for.", "Nothing to do."),
    Status.FALLS: (
        "The state lies on the falling set to within rounding: the disk falls flat in finite time.",
        "Continue with `limit_motion`, once for each side.",
    ),
    Status.BAD_INPUT: (
        "The numbers do not describe a state (not finite, too large, already flat, a face other than +1 and -1), "
        "or they start a passage that turns back before it comes to the window, or at once.",
        "Give finite numbers below 1e75 natural units, with phi between -pi/2 and pi/2. For a passage, give a "
        "speed towards flat that is not negative, and a window that the passage comes to.",
    ),
    Status.STEP_LIMIT: (
        "The limit of steps or of quadrature points was reached before the end of the motion, or before the "
        "accuracy asked for: the start is slow, or an equilibrium is near.",
        "Allow larger errors (a larger `accuracy`), or try another `method`.",
    ),
    Status.STEP_TOO_SMALL: (
        "The step size became smaller than rounding allows.",
        "Allow larger errors (a larger `accuracy`), or leave `method` at 'auto'.",
    ),
    Status.NOT_FINITE: (
        "The integration overflowed or became undefined.",
        "Start with lower rates, or leave `method` at 'auto'.",
    ),
    Status.INVARIANT_DRIFT: (
        "A constant of motion drifted by more than the accuracy that was asked for.",
        "Leave `method` at 'auto'; with a fixed step, ask for smaller errors (a smaller `accuracy`).",
    ),
    Status.UNRESOLVED_SIDE: (
        "The error of eta is not small compared with eta, so the direction of the race is unknown.",
        "Give eta_hat itself, to `constants_to_states` or `passages`, or start further from F.",
    ),
    Status.TOO_FEW_DIGITS: (
        "The state has too few digits for the accuracy asked for: so near F its smallest tilt depends on digits "
        "of eta that rounding of the state has lost.",
        "Give eta_hat itself, to `constants_to_states` or `passages`, allow larger errors (a larger `accuracy`), "
        "or start further from F.",
    ),
}

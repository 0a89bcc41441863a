"""Times that are dense where the contact point races: the one way to sample a motion for a curve.

Near flat all of a race, kappa pi in chi, takes a time of about the smallest tilt over the speed of the impact.
Equal steps in time miss it, and a curve drawn through them cuts across the rim.
"""

import numpy as np
from numpy.typing import ArrayLike

from explorer.motion.trajectories import trajectories
from explorer.phase.states import Array, States

STEP = 0.2  # rad: chords of such arcs of the rim stay within half a per cent of the radius
_FIRST_TIMES = 201  # enough for each swing of a motion over some periods to be seen
# A step of time is halved at most so often. A race that takes less than 1e-9 of the first steps is then left
# as a jump; after some 50 halvings doubles have no times in between.
_FINEST = 30


def dense_times(states: States, until: float | ArrayLike, step: float = STEP) -> Array:
    """Times between which the contact angle chi of every motion changes by `step` at most.

    Parameters
    ----------
    states : States
        Where the motions start. One that fails, or falls, asks for no times.
    until : float or (nt,) array
        The end of the time, in the units of the disk, or increasing times to begin with. All of them
        are kept.
    step : float
        The largest change of chi (rad) between two times.

    Returns
    -------
    (nt,) array
        Increasing times from 0 to `until`, or from the first to the last of the times that were given.
    """
    t = np.asarray(until, np.float64)
    if t.ndim == 0:
        t = np.linspace(0.0, float(t), _FIRST_TIMES)
    for _ in range(_FINEST):
        chi = trajectories(states, t_eval=t, observables=("chi",)).chi
        assert chi is not None
        wide = (abs(np.diff(chi)) > step).any(axis=0)
        if not wide.any():
            break
        t = np.union1d(t, 0.5 * (t[1:] + t[:-1])[wide])
    return t

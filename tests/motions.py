"""Motions in time at any times, also such that a curve through them misses races."""

import warnings

import explorer as ex


def trajectories(states, t_end=None, t_eval=None, **asked):
    """As `ex.simulate`, without its warning of coarse times."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ex.CoarseTimesWarning)
        return ex.simulate(states, t_end, t_eval=t_eval, **asked)

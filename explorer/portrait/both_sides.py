"""The motions on both sides of a point of F, beside the two limit motions that they approach."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from explorer.motion.limit_motions import AnyLimit, limit_motion
from explorer.motion.trajectories import Trajectories, simulate
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states

FALLS = 3  # impacts that each motion passes
TIMES = 240
# Impacts are cut out by this share of a period on either side.
MARGIN = 0.1
QUANTITIES = ("phi", "chi", "psi", "path", "contact")


def limits_at(disk: Disk, start: tuple[float, float, int]) -> dict[int, AnyLimit]:
    """Both limit motions from a point of F: (sigma3_bar, phidot, face) at the vertical."""
    sigma3_bar, phidot, face = start
    base = constants_to_states(disk, sigma3_bar, 0.0, phidot, face)
    return {sign: limit_motion(disk, base, sign) for sign in (1, -1)}


def sample_times(limit: AnyLimit) -> tuple[Array, int]:
    """Times through FALLS impacts, none within MARGIN of a period of an impact.

    Also the place of the time half-way between the first two impacts.
    """
    first = limit.impacts(2.0 * limit.period)[0]
    middle = first + 0.5 * limit.period
    end = first + (FALLS - 0.5) * limit.period
    times = np.union1d(np.linspace(0.0, end, TIMES), [middle])
    gaps = abs(times[:, None] - limit.impacts(end + limit.period)).min(axis=1)
    times = times[gaps > MARGIN * limit.period]
    return times, int(np.searchsorted(times, middle))


def follow(
    disk: Disk, start: tuple[float, float, int], eta_hat: Array, times: Array, accuracy: float, method: str
) -> Trajectories:
    """Motions that start beside a point of F at the distances eta_hat."""
    sigma3_bar, phidot, face = start
    states = constants_to_states(disk, sigma3_bar, eta_hat, phidot, face)
    return simulate(disk, states, t_eval=times, observables=QUANTITIES, method=method, accuracy=accuracy)


@dataclass(frozen=True)
class BothSides:
    """What the pictures of one point of F show: motions beside it and both limits, on one time axis."""

    disk: Disk
    eta_hat: float
    t: Array
    impacts: Array
    motions: dict[int, Any]
    limits: dict[int, Any]


def both_sides(disk: Disk, start: tuple[float, float, int], eta_hat: float = 0.01) -> BothSides:
    """Motions at +-eta_hat (natural units) beside a point of F, and the limits, through two falls."""
    limits = limits_at(disk, start)
    impacts = limits[1].impacts(100.0 * limits[1].period)[:2]
    t = np.linspace(0.0, impacts[-1] + 0.6 * limits[1].period, 1600)
    # The race takes about eta_hat units of time: the picture needs times inside it.
    close = np.linspace(-0.04, 0.04, 1600) * limits[1].period
    t = np.union1d(t, (impacts[:, None] + close).ravel())
    t = t[t >= 0.0]
    size = eta_hat * disk.rate_unit
    motion = follow(disk, start, np.array([size, -size]), t, 1e-6, "auto")
    rows = {sign: {name: getattr(motion, name)[row] for name in QUANTITIES} for row, sign in enumerate((1, -1))}
    return BothSides(disk, size, t, impacts, rows, {sign: limits[sign](t) for sign in limits})

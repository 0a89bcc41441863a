"""The motions on both sides of a point of F, beside the two limit motions that they approach."""

from dataclasses import dataclass

import numpy as np

from explorer.motion.dense_times import dense_times
from explorer.motion.limit_motions import AnyLimit, LimitState, limit_motion
from explorer.motion.trajectories import Trajectories, trajectories
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states

FALLS = 3  # impacts that each motion passes
TIMES = 240  # at which distances are taken: some 80 to a period
# Share of a period that is cut out on either side of an impact: there the limits jump and motions do not.
MARGIN = 0.1
_FIRST_TIMES = 800  # of a picture: phi(t) is round at its turning points; the race adds its own
QUANTITIES = ("phi", "chi", "psi", "path", "contact")


def limits_at(disk: Disk, start: tuple[float, float, int]) -> dict[int, AnyLimit]:
    """Both limit motions from a point of F: (sigma3_bar, phidot, face) at the vertical."""
    sigma3_bar, phidot, face = start
    base = constants_to_states(disk, sigma3_bar, 0.0, phidot, face)
    return {sign: limit_motion(base, sign) for sign in (1, -1)}


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
    return trajectories(states, t_eval=times, observables=QUANTITIES, method=method, accuracy=accuracy)


@dataclass(frozen=True)
class BothSides:
    """Motions beside one point of F and both limits, on one time axis, in the units of the disk.

    eta_hat: distance of the motions from F, without its sign. t (nt). impacts (2): times of the limits' impacts.
    By the sign of eta: motions, columns named in QUANTITIES, arrays (nt) or (nt, 3); limits, limit motions at t.
    """

    disk: Disk
    eta_hat: float
    t: Array
    impacts: Array
    motions: dict[int, dict[str, Array]]
    limits: dict[int, LimitState]


def both_sides(disk: Disk, start: tuple[float, float, int], eta_hat: float = 0.01) -> BothSides:
    """Motions at +-eta_hat (natural units) beside a point of F, and the limits, through two falls."""
    limits = limits_at(disk, start)
    impacts = limits[1].impacts(100.0 * limits[1].period)[:2]
    size = eta_hat * disk.rate_unit
    sigma3_bar, phidot, face = start
    beside = constants_to_states(disk, sigma3_bar, [size, -size], phidot, face)
    t = dense_times(beside, np.linspace(0.0, impacts[-1] + 0.6 * limits[1].period, _FIRST_TIMES))
    motion = trajectories(beside, t_eval=t, observables=QUANTITIES)
    rows = {sign: {name: getattr(motion, name)[row] for name in QUANTITIES} for row, sign in enumerate((1, -1))}
    return BothSides(disk, size, t, impacts, rows, {sign: limits[sign](t) for sign in limits})

"""The motions on both sides of a point of F, beside the two limit motions that they approach."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from explorer.errors import positive, sign
from explorer.motion.limit_motions import LimitMotion, limit_motion
from explorer.motion.trajectories import Trajectories, simulate
from explorer.phase.constants import constants
from explorer.phase.coordinates import coordinates_to_states
from explorer.phase.disk import Disk
from explorer.phase.results import require_ok
from explorer.phase.states import Array, States, require_states

FALLS = 3  # impacts that each motion passes
TIMES = 240  # at which distances are taken: some 80 to a period
# Share of a period that is cut out on either side of an impact: there the limits jump and motions do not.
MARGIN = 0.1
QUANTITIES = ("phi", "chi", "psi", "path", "contact")
_RACE_POINTS = 120  # of the circle of a race


def limits_from(point: States) -> dict[int, LimitMotion]:
    """Both limit motions from a point of F, by the side."""
    return {side: limit_motion(point, side) for side in (1, -1)}


def sample_times(limit: LimitMotion) -> tuple[Array, int]:
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


@dataclass(frozen=True, repr=False, eq=False)
class BothSides:
    """The motions on both sides of a point of F, and their two limits, on one time axis, in the units of the disk.

    Attributes
    ----------
    start : States
        The point of F.
    eta_hat : float
        Distance of the motions from F, without its sign.
    t : (nt,) array
        Times.
    impacts : array
        Times at which the limits come flat.
    motions : dict of int to dict of str to array
        By the side, +1 and -1: phi, chi, psi (nt), path and contact (nt, 3).
    limits : dict of int to Trajectories
        By the side: the limit motion at t.

    Examples
    --------
    >>> import explorer as ex
    >>> both = ex.both_sides(ex.constants_to_states(ex.Disk.hoop(), 1.0, 0.0, 1.0))
    >>> both.motions[-1]["contact"].shape == (both.t.size, 3)
    True
    """

    start: States
    eta_hat: float
    t: Array
    impacts: Array
    motions: dict[int, dict[str, Array]]
    limits: dict[int, Trajectories]

    def __repr__(self) -> str:
        impacts = ", ".join(f"{time:.6g}" for time in self.impacts)
        return (
            f"BothSides of the disk {self.disk.name}: eta_hat +-{self.eta_hat:.6g}\n"
            f"  t: {self.t.size:,} times up to {self.t[-1]:.6g}; limits come flat at {impacts}"
        )

    @property
    def disk(self) -> Disk:
        """The body."""
        return self.start.disk

    def limit_path(self, side: int) -> Array:
        """The limit's contact point (n, 2), with the circle that it runs through in no time at each impact."""
        limit = self.limits[sign("side", side)]
        pieces, first = [], 0
        for row in np.searchsorted(self.t, self.impacts):
            centre = limit.path[row - 1, :2]
            turn = np.exp(1j * np.linspace(0.0, limit.chi[row] - limit.chi[row - 1], _RACE_POINTS))
            circle = turn * complex(*(limit.contact[row - 1, :2] - centre))
            pieces += [limit.contact[first:row, :2], centre + np.stack([circle.real, circle.imag], axis=1)]
            first = row
        return np.concatenate([*pieces, limit.contact[first:, :2]])


def both_sides(state: States, eta_hat: float | None = None, t_end: float | None = None) -> BothSides:
    """The motions on both sides of a point of F, and the limit of each side, through two falls or until t_end.

    Parameters
    ----------
    state : States
        One state on F, as for `limit_motion`. The motions beside it have its phi, phidot and sigma3_bar.
    eta_hat : float, optional
        Distance of the motions from F, above 0, in the units of the disk; by default 0.01 natural units.
    t_end : float, optional
        The last time; by default a little more than half a period after the second fall.

    Returns
    -------
    BothSides
        Both motions and both limits at the same times, dense where either motion races.

    Raises
    ------
    InputError
        As `limit_motion` does, and if eta_hat or t_end is not above 0.

    Notes
    -----
    Section 7 of the paper: as eta_hat -> 0, each motion tends to the limit of its side.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> both = ex.both_sides(ex.constants_to_states(disk, 1.0, 0.0, 1.0), eta_hat=1e-6)
    >>> apart = [both.motions[side]["chi"][-1] - both.limits[side].chi[-1] for side in (1, -1)]
    >>> bool(np.all(np.abs(apart) < 1e-4))
    True
    """
    disk = require_states(state, "state").disk
    size = 0.01 * disk.rate_unit if eta_hat is None else positive("eta_hat", eta_hat)
    limits, state = limits_from(state), state.reshaped(())
    limit = limits[1]
    at_point: dict[str, ArrayLike] = {"phi": state.phi, "phidot": state.phidot, "face": limit.face}
    at_point["sigma3_bar"] = constants(state).sigma3_bar
    beside = coordinates_to_states(disk, degrees=False, **at_point, eta_hat=[size, -size])
    end = limit.impacts(3.0 * limit.period)[1] + 0.6 * limit.period if t_end is None else positive("t_end", t_end)
    motion = simulate(beside, float(end), observables=QUANTITIES)
    require_ok(motion, f"eta_hat = {size:g}")
    t = np.unique(motion.t)
    at = motion(t)
    rows = {sign: {name: getattr(at, name)[row] for name in QUANTITIES} for row, sign in enumerate((1, -1))}
    return BothSides(state, size, t, limit.impacts(end), rows, {sign: limits[sign](t) for sign in limits})

"""The two one-sided limit motions, to which motions that approach F from one side converge (section 7).

Between impacts the disk moves on F. At an impact phidot changes sign and chi jumps by sgn(eta) kappa pi
(eq. 7.16), psi by face times that (7.11); the motion is then the same fall run backwards. So it is an exact motion
whose rise begins at flat, with half of the jump. Where sigma3_bar = sigma4_bar = 0 the disk may swing over the
vertical, as a pendulum: the rise ends on the other flat state, where chi and psi jump as well.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from explorer import compiled
from explorer.errors import InputError, number, sign
from explorer.motion import exact
from explorer.motion.exact import Exact
from explorer.motion.plan import LOOSEST
from explorer.motion.starts import arc_starts
from explorer.motion.trajectories import ALL, OTHERS, Trajectories, at_times
from explorer.phase import falling_set
from explorer.phase.disk import require_axial_inertia
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.falling_set import falls
from explorer.phase.linear_constants import line_chart, motion_given
from explorer.phase.states import Array, Rows, States, require_states

KERNELS = *falling_set.KERNELS, *exact.KERNELS, "falling.line_chart_batch"  # for `compiled.warmup`
_MOST_IMPACTS = 1e8  # their times take 0.8 GB, and a double has 8 digits left for the place between two
# Of sigma3_bar over the energy: below, the rate of the race overflows, and no double tells the race from a jump.
_TINY = 1e-290
_MEANT = 1e-12  # |eta_hat|, over the rates, that rounding leaves where a state on F was computed
_KNOWN = 1e-3  # how well a period must be known, as a share
_ENDLESS = (
    "state_on_f: the motion comes to rest within rounding of an equilibrium or a separatrix, so its period is "
    "infinite; change phidot or sigma3 slightly"
)


class LimitMotion:
    """The one-sided continuation of a motion on F through all its impacts; call it with times of either sign.

    It gives Trajectories, with all observables. At the instant of an impact the values are those after it.

    If sigma3_bar = sigma4_bar = 0 and the energy is above m g r, the disk swings over the vertical, as a pendulum,
    and falls to both flat states in turn. If the motions of which this is the limit also have sigma3_bar = 0,
    their eta has opposite signs on the two faces: chi then jumps to and fro, and psi always jumps the same way.

    Attributes
    ----------
    disk : Disk
        The body.
    face, side : int
        Flat state that it falls to, and sign of eta from which F is approached, +1 or -1. For a pendulum `face` is
        +1, and `side` is the sign of eta on this face.
    sigma3_bar : float
        sigma3 at the vertical (units of the disk).
    period : float
        Time between impacts.
    impact_speed : float
        |phidot| at an impact, A of eq. (7.1), units of the disk.
    chi_per_period : float
        Increase of chi from impact to impact (rad), one jump of side times kappa pi included; for a pendulum it is
        this jump alone, and the next jump on the same face comes two periods later.

    Examples
    --------
    >>> import explorer as ex
    >>> limit = ex.limit_motion(ex.constants_to_states(ex.Disk.uniform(), 1.0, 0.0, 1.0))
    >>> limit.impacts(6.0).round(4)
    array([1.123 , 4.6417])
    >>> swing = ex.limit_motion(ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 0.0, 0.0))
    >>> swing(swing.impacts(9.0) + 0.1).phi.round(2)
    array([ 1.41, -1.41,  1.41])
    """

    def __init__(self, states: States, source: Exact, sigma3_bar: float, face: int, side: int) -> None:
        """states: the one that was given; source: its motion on F, with the jump of a side."""
        self.disk, self.side, self._states, self._source = states.disk, side, states, source
        self.sigma3_bar = sigma3_bar * self.disk.rate_unit
        flat, found, row = *source.seen(np.zeros((1, 1)), np.zeros((1, 1))), compiled.field.ROW
        assert found.period is not None
        each = compiled.motions.PeriodRow(*found.period[:, 0])
        if not each.time_error < _KNOWN * each.time:
            raise InputError(_ENDLESS)
        half = source.seen(np.full((1, 1), 0.5 * each.time), np.zeros((1, 1)))[0]
        # A pendulum comes flat twice in a period, once on either face.
        pendulum = sigma3_bar == 0.0 and bool(half[row.z] * flat[row.z] < 0.0)
        self.face = 1 if pendulum else face
        self.period = (0.5 if pendulum else 1.0) * float(each.time) * self.disk.time_unit
        self._passed = float(each.since) * self.disk.time_unit % self.period  # since an impact
        self.impact_speed = abs(flat[row.p].item()) * self.disk.rate_unit
        self.chi_per_period = side * self.disk.race_limit if pendulum else float(each.chi)

    def __repr__(self) -> str:
        return (
            f"LimitMotion of the disk {self.disk.name}, face {self.face:+d}, side {self.side:+d}: "
            f"period {self.period:.6g}, impact_speed {self.impact_speed:.6g}"
        )

    def impacts(self, t_end: float) -> Array:
        """Times of impact in (0, t_end]."""
        end = number("t_end", t_end, high=_MOST_IMPACTS * self.period)
        first = self.period - self._passed
        count = max(0, int(np.floor((end - first) / self.period)) + 1)
        return np.array(first + self.period * np.arange(count), dtype=np.float64)

    def __call__(self, t: ArrayLike, since: str = "start") -> Trajectories:
        """The motion at any times since the start, or since the first impact at or after it; as of `simulate`."""
        return at_times(self._source, self._states, t, since, (*ALL, *OTHERS))


def limit_motion(state_on_f: States, side: int = 1) -> LimitMotion:
    """The limit of the motions that approach a state on F from one side of F.

    Parameters
    ----------
    state_on_f : States
        One state on F, of a disk with I3 > 0. An eta_hat up to 1e-12 times the rates of the state counts as 0.
    side : int
        Sign of eta from which F is approached, +1 or -1.

    Returns
    -------
    LimitMotion
        The motion through all its impacts; call it with times.

    Raises
    ------
    InputError
        If the state is not on F, if the disk would not fall from it, if side is not +1 or -1, or if there are
        several states.

    Notes
    -----
    Section 7 of the paper: chi jumps by side times kappa pi at an impact, eq. (7.16), psi by face times that.

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> start = ex.constants_to_states(disk, sigma3_bar=1.0, eta_hat=0.0, phidot=1.0)
    >>> up, down = (ex.limit_motion(start, side) for side in (1, -1))
    >>> print(f"{up(2.0).chi - down(2.0).chi:.4f} = 2 kappa pi = {2.0 * disk.race_limit:.4f}")
    14.0496 = 2 kappa pi = 14.0496
    """
    states = require_states(state_on_f, "state_on_f")
    disk = states.disk
    require_axial_inertia(disk)
    side = sign("side", side)
    if states.size != 1:
        raise InputError(f"state_on_f: takes one state, {states.size} were given; choose one, as in states[0]")
    where, motion = falls(states.flat), states.motion
    if not bool(where.could_fall[0]):
        raise InputError(
            "state_on_f: the disk would not fall from this state whatever eta is; choose one with "
            "ex.falls(...).could_fall"
        )
    z, bar = (float(row[0]) for row in (states.rows.z, motion.sigma3_bar))
    nearer = int(where.face[0])
    eta_hat = eta_to_eta_hat(disk.body, float(motion.eta(np.array([nearer > 0]))[0]))
    if abs(eta_hat) > _MEANT * max(1.0, abs(bar)):
        raise InputError(
            f"state_on_f: is not on F, but at eta_hat = {eta_hat * disk.rate_unit:.3g}; for the one "
            "on F use coordinates_to_states(disk, phi=..., phidot=..., sigma3_bar=..., eta_hat=0)"
        )
    # With sigma3_bar = 0 both lines l_+ and l_- meet.
    face = nearer if bar != 0.0 else 1 if z >= 0.0 else -1
    if bar != 0.0:
        bar = math.copysign(max(abs(bar), _TINY * max(float(motion.energy[0]), 1.0)), bar)
    return LimitMotion(states.reshaped(()), _on_f(states.flat, bar, face, side), bar, face, side)


@np.errstate(invalid="ignore")  # within 1e-160 of flat 0 times infinity is no number, which is refused
def _on_f(states: States, sigma3_bar: float, face: int, side: int) -> Exact:
    """The motion with eta = 0 through a state, and the jump of a side."""
    disk, (q, z, p, _, _) = states.disk, states.rows
    bar, plus = np.array([sigma3_bar]), np.array([face > 0])
    sigma3, sigma4 = line_chart(disk, q, face * z).rates(bar, 0.0)
    rows = Rows(q, z, p, sigma3 / q, face * sigma4)
    own = np.where(plus == (face * z >= 0.0), 1.0, -1.0)
    starts = arc_starts(disk, rows, motion_given(disk, bar, np.zeros(1), plus), own > 0.0)
    jump, none = np.array([side * disk.race_limit]), np.zeros(1)
    good = np.array([compiled.status.Status.OK], np.int8)
    return Exact(disk, rows, starts, own, jump, none, states.motion.energy, good, LOOSEST, True)

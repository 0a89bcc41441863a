"""The two one-sided limit motions, to which motions that approach F from one side converge (section 7).

Between impacts the disk moves on F. At an impact phidot changes sign and chi jumps by sgn(eta) kappa pi
(eq. 7.16), psi by face times that (7.11); the motion is then the same fall run backwards. So one rise, from flat
to its turning point, holds the whole motion (`rise`). Where sigma3_bar = sigma4_bar = 0 the disk may swing over
the vertical, as a pendulum: the rise ends on the other flat state, where chi and psi jump as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError, number, shown, sign
from explorer.motion.orbits import WITH_PLACES
from explorer.motion.rise import Moving, Rise
from explorer.motion.starts import ArcStarts, arc_starts
from explorer.phase import falling_set
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.falling_set import falls
from explorer.phase.linear_constants import line_chart, motion_given
from explorer.phase.results import Table
from explorer.phase.states import Array, Rows, States, require_states

KERNELS = *falling_set.KERNELS, *WITH_PLACES, "falling.line_chart_batch"  # for `compiled.warmup`
_MOST_IMPACTS = 1e8  # their times take 0.8 GB, and a double has 8 digits left for the place between two
# Of sigma3_bar over the energy: below, the rate of the race overflows, and no double tells the race from a jump.
_TINY = 1e-290
_MEANT = 1e-12  # |eta_hat|, over the rates, that rounding leaves where a state on F was computed


@dataclass(frozen=True, repr=False, eq=False)
class LimitState(Table):
    """A limit motion at given times, in the units of the disk; arrays of the shape of the times.

    At the instant of an impact the values are those after it.

    Attributes
    ----------
    t : array
        The times.
    phi, phidot : array
        Tilt (rad) and its rate (units of the disk).
    chi, psi : array
        Angles of contact (rad), from 0 at t = 0, with the jumps of all impacts so far.
    path, contact : (..., 3) array
        Centre of mass and contact point; the centre starts above the origin.
    velocity : (..., 3) array
        Velocity of the centre, eq. (2.33).
    nu : (..., 3) array
        Angular velocity in space, eqs (2.27), (2.29), units of the disk.

    Examples
    --------
    >>> import explorer as ex
    >>> limit = ex.limit_motion(ex.phi_to_states(ex.Disk.hoop(), 0.0, 1.0, 0.0, 0.0))
    >>> limit([0.0, 0.5]).velocity.shape
    (2, 3)
    """

    t: Array
    phi: Array
    phidot: Array
    chi: Array
    psi: Array
    path: Array
    contact: Array
    velocity: Array
    nu: Array


class LimitMotion:
    """The one-sided continuation of a motion on F through all its impacts; call it with times.

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

    def __init__(self, disk: Disk, rise: Rise, sigma3_bar: float, face: int, side: int, rises: bool) -> None:
        """rise: from the flat state of `face`, through the state that was given, which `rises` or falls again."""
        self.disk, self.side = disk, side
        self.sigma3_bar = sigma3_bar * disk.rate_unit
        self.face = 1 if rise.upright else face
        self._rise, self._jump = rise, side * disk.race_limit
        # What chi and psi have come to when it is flat again, or, after the jump there, on the other face.
        upright_jump = self._jump if rise.upright else 0.0
        self._chi_back, self._psi_back = 2.0 * rise.chi_half - upright_jump, 2.0 * rise.psi_half + upright_jump
        passed = rise.offset if rises else -rise.offset
        self._offset = (passed + (rise.half if face != self.face else 0.0)) % (2.0 * rise.half)  # from an impact
        self.period = (1.0 if rise.upright else 2.0) * rise.half * disk.time_unit
        self.impact_speed = rise.impact_speed * disk.rate_unit
        self.chi_per_period = self._jump + (0.0 if rise.upright else self._chi_back)

    def __repr__(self) -> str:
        return (
            f"LimitMotion of the disk {self.disk.name}, face {self.face:+d}, side {self.side:+d}: "
            f"period {self.period:.6g}, impact_speed {self.impact_speed:.6g}"
        )

    def impacts(self, t_end: float) -> Array:
        """Times of impact in (0, t_end]."""
        end = number("t_end", t_end, high=_MOST_IMPACTS * self.period)
        passed = self._offset * self.disk.time_unit
        first = self.period * (np.floor(passed / self.period) + 1.0) - passed
        count = max(0, int(np.floor((end - first) / self.period)) + 1)
        return np.array(first + self.period * np.arange(count), dtype=np.float64)

    def __call__(self, t: ArrayLike) -> LimitState:
        """The motion at times from 0 to that of the 1e8th impact. So late, its phase has 8 digits fewer."""
        (times,), shape = read_columns(t=t)
        disk, face = self.disk, self.face
        last = _MOST_IMPACTS * self.period
        if not ((times >= 0.0) & (times <= last)).all():
            raise InputError(f"t = {shown(t)}: give times from 0 to {last:g}, that of {_MOST_IMPACTS:g} impacts")
        start = self._unfold(np.array([self._offset]))
        at = self._unfold(times * disk.rate_unit + self._offset)
        z, sigma4, phidot, turn, q = face * at.z, face * at.sigma4, -face * at.thetadot, at.turn, at.q
        chi, psi = at.chi - start.chi[0], face * (at.psi - start.psi[0])
        centre, away = face * (at.centre - start.centre[0]) * np.exp(-1j * start.chi[0]), np.exp(1j * chi)
        velocity = (-phidot * q - 1j * sigma4) * away  # eq. (2.33)
        nu = (q * (sigma4 - z * turn) - 1j * phidot) * away  # eq. (2.29)
        r, unit = disk.r, disk.rate_unit

        def vector(plane: NDArray[np.complex128], height: Array, scale: float) -> Array:
            return scale * np.stack([plane.real, plane.imag, height], axis=-1)

        return LimitState(
            t=times,
            phi=face * (0.5 * np.pi - np.arctan2(q, at.z)),
            phidot=phidot * unit,
            chi=chi,
            psi=psi,
            path=vector(centre, q, r),
            contact=vector(centre + z * away, np.zeros_like(q), r),
            velocity=vector(velocity, -phidot * z, r * unit),
            nu=vector(nu, q * q * turn + z * sigma4, unit),  # eq. (2.27)
        ).reshaped(shape)

    def _unfold(self, since_impact: Array) -> Moving:
        """The motion at natural times counted from an impact, as on face +1."""
        rise, chi_back = self._rise, self._chi_back
        bounces = np.floor(since_impact / (2.0 * rise.half))
        phase = since_impact - 2.0 * rise.half * bounces
        falling = phase >= rise.half
        here = rise.at(np.where(falling, np.maximum(2.0 * rise.half - phase, 0.0), phase))
        # The fall is the rise run backwards, mirrored where that ends (eq. 3.12 ff.).
        top, mirror = rise.centre_half, np.exp(1j * chi_back)
        mirrored = top + mirror * np.conj(here.centre - top)
        # Each bounce turns the whole picture by the same angle and moves it along: a geometric series.
        turn = chi_back + self._jump
        half_turn = 0.5 * np.angle(np.exp(1j * turn))
        times = bounces * np.sinc(bounces * half_turn / np.pi) / np.sinc(half_turn / np.pi)
        moved = times * np.exp(1j * (bounces - 1.0) * half_turn) * (top - mirror * np.conj(top))
        return here._replace(
            thetadot=np.where(falling, -here.thetadot, here.thetadot),
            chi=np.where(falling, chi_back - here.chi, here.chi) + turn * bounces,
            psi=np.where(falling, self._psi_back - here.psi, here.psi) + (self._psi_back + self._jump) * bounces,
            centre=moved + np.exp(1j * turn * bounces) * np.where(falling, mirrored, here.centre),
        )


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
    z, p, bar = (float(row[0]) for row in (states.rows.z, states.rows.p, motion.sigma3_bar))
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
    rise = Rise(disk, _on_f(states, bar, face), face * z < 0.0)
    return LimitMotion(disk, rise, bar, face, side, face * p >= 0.0)


@np.errstate(invalid="ignore")  # within 1e-160 of flat 0 times infinity is no number, and Rise refuses it
def _on_f(states: States, sigma3_bar: float, face: int) -> ArcStarts:
    """The motion with eta = 0 through a state."""
    disk, (q, z, p, _, _) = states.disk, states.rows
    bar, plus = np.array([sigma3_bar]), np.array([face > 0])
    sigma3, sigma4 = line_chart(disk, q, face * z).rates(bar, 0.0)
    rows = Rows(q, z, abs(p), sigma3 / q, face * sigma4)
    return arc_starts(disk, rows, motion_given(disk, bar, np.zeros(1), plus), plus == (face * z >= 0.0))

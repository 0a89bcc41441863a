"""The two one-sided limit motions: what approaching F from one side converges to (section 7).

Between impacts the disk moves on F. At an impact phidot changes sign and chi jumps by
sgn(eta) kappa pi (eq. 7.16), psi by side times that (7.11); the motion is then the same fall run
backwards. So one rise, from flat to its turning point, holds the whole motion; it is smooth in
alpha with theta = theta_turn sin(alpha), and kept as Chebyshev series.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike
from scipy.fft import dct
from scipy.optimize import brentq

from explorer import compiled
from explorer.disk import Disk
from explorer.errors import InputError
from explorer.falling import well
from explorer.states import Array, States, natural_constants, require_axial_inertia

_GAUSS = np.polynomial.legendre.leggauss(64)
_HALF_PI = 0.5 * np.pi


def fall_from_vertical(disk: Disk, sigma3_bar: Array, energy: Array) -> tuple[Array, Array, Array]:
    """Time, chi and psi gained by the fall on F from the vertical to flat (side +1), natural units.

    Where the energy is too low for the vertical the fall starts at its turning point; NaN where
    the energy does not exceed V_0.
    """
    out = np.empty((3, sigma3_bar.size))
    compiled.falling.fall_batch(
        np.ascontiguousarray(sigma3_bar), np.ascontiguousarray(energy), *_GAUSS, disk.body, disk.series, out
    )
    return out[0], out[1], out[2]


@dataclass(frozen=True)
class LimitState:
    """A limit motion at given times, in the units of the disk; arrays like the times.

    chi, psi (rad) count from t = 0 with all jumps included. path: centre of mass; contact: contact
    point, (..., 3). At the instant of an impact the values are those after it.
    """

    phi: Array
    phidot: Array
    chi: Array
    psi: Array
    path: Array
    contact: Array


class LimitMotion:
    """The one-sided continuation of a motion on F through all its impacts; call it with times.

    sign: the sign of eta from which F is approached. Attributes in the units of the disk:
    `period` between impacts, `impact_speed` A of eq. (7.1), `chi_per_period` (rad, jump included).
    """

    def __init__(
        self, disk: Disk, energy: float, sigma3_bar: float, side: int, sign: int, start: tuple[float, float]
    ) -> None:
        self.disk, self.side, self.sign = disk, side, sign
        self._rise = _Rise(disk, energy, sigma3_bar)
        self._jump = sign * disk.race_limit
        theta, thetadot = start
        rising = self._rise.time_at(theta)
        self._offset = rising if thetadot >= 0.0 else 2.0 * self._rise.half - rising
        self._origin = self._unfold(np.array([self._offset]))
        self.period = 2.0 * self._rise.half * disk.time_unit
        self.impact_speed = self._rise.impact_speed * disk.rate_unit
        self.chi_per_period = 2.0 * self._rise.chi_half + self._jump

    def impacts(self, t_end: float) -> Array:
        """Times of impact in (0, t_end]."""
        first = self.period - self._offset * self.disk.time_unit
        count = max(0, int(np.floor((t_end - first) / self.period)) + 1)
        return np.array(first + self.period * np.arange(count), dtype=np.float64)

    def __call__(self, t: ArrayLike) -> LimitState:
        times = np.asarray(t, dtype=np.float64)
        if not (np.isfinite(times).all() and (times >= 0.0).all()):
            raise InputError("limit motion: times must be finite and >= 0")
        flat = np.ravel(times) * self.disk.rate_unit + self._offset
        theta, thetadot, chi, psi, centre = self._unfold(flat)
        _, _, chi0, psi0, centre0 = self._origin
        chi = chi - chi0
        centre = (centre - centre0) * np.exp(-1j * chi0) * self.side
        r, shape = self.disk.r, times.shape
        phi = self.side * (_HALF_PI - theta)
        shadow = centre + np.sin(phi) * np.exp(1j * chi)
        zero = np.zeros_like(theta)
        return LimitState(
            phi=phi.reshape(shape),
            phidot=(-self.side * thetadot * self.disk.rate_unit).reshape(shape),
            chi=chi.reshape(shape),
            psi=(self.side * (psi - psi0)).reshape(shape),
            path=(r * np.stack([centre.real, centre.imag, np.sin(theta)], axis=-1)).reshape(*shape, 3),
            contact=(r * np.stack([shadow.real, shadow.imag, zero], axis=-1)).reshape(*shape, 3),
        )

    def _unfold(self, since_impact: Array) -> tuple[Array, Array, Array, Array, Any]:
        """(theta, thetadot, chi, psi, a1 + i a2) at times counted from an impact, on side +1."""
        rise = self._rise
        bounces = np.floor(since_impact / (2.0 * rise.half))
        phase = since_impact - 2.0 * rise.half * bounces
        falling = phase > rise.half
        theta, speed, chi, psi, centre = rise.at(np.where(falling, 2.0 * rise.half - phase, phase))
        # The fall is the rise run backwards, mirrored at the turning point (eq. 3.12 ff.).
        top = rise.centre_half
        mirrored = top + np.exp(2j * rise.chi_half) * np.conj(centre - top)
        centre = np.where(falling, mirrored, centre)
        chi = np.where(falling, 2.0 * rise.chi_half - chi, chi)
        psi = np.where(falling, 2.0 * rise.psi_half - psi, psi)
        thetadot = np.where(falling, -speed, speed)
        # Each bounce turns the whole picture by the same angle and moves it along.
        turn = 2.0 * rise.chi_half + self._jump
        whole = top + np.exp(2j * rise.chi_half) * np.conj(-top)
        spin = np.exp(1j * turn)
        moved = bounces * whole if abs(spin - 1.0) < 1e-12 else whole * (spin**bounces - 1.0) / (spin - 1.0)
        centre = moved + np.exp(1j * turn * bounces) * centre
        psi_turn = 2.0 * rise.psi_half + self._jump
        return theta, thetadot, chi + turn * bounces, psi + psi_turn * bounces, centre


class _Rise:
    """One rise on F (side +1) from flat to its turning point, natural units."""

    def __init__(self, disk: Disk, energy: float, sigma3_bar: float) -> None:
        self._disk = disk
        self._X = sigma3_bar / disk.body.r0
        self._energy = energy
        self.theta_turn = self._turning_point(sigma3_bar)
        self.impact_speed = float(np.sqrt(2.0 / disk.body.M * (energy - self._on_f(np.array([1e-12]))[2][0])))
        self._fit()

    def _on_f(self, theta: Array) -> Array:
        out = np.empty((4, theta.size))
        disk = self._disk
        compiled.falling.on_f_batch(np.ascontiguousarray(theta), self._X, disk.body, disk.series, out)
        return out

    def _turning_point(self, sigma3_bar: float) -> float:
        def excess(theta: float) -> float:
            return float(self._on_f(np.array([theta]))[2][0]) - self._energy

        if excess(_HALF_PI) >= 0.0:
            return brentq(excess, 1e-12, _HALF_PI, xtol=1e-15, rtol=1e-15)
        if sigma3_bar == 0.0:
            raise InputError(
                "limit motion: with sigma3_bar = sigma4_bar = 0 and energy above m g r the disk falls to "
                "both sides in turn, which is not covered; give sigma3_bar other than 0"
            )
        edge, largest = well(self._disk)
        lower = _HALF_PI
        if abs(sigma3_bar) < largest:
            # Past the barrier there is a well; the first turning point counts.
            grid = np.linspace(_HALF_PI, _HALF_PI - edge, 512)
            blocked = self._on_f(grid)[2] > self._energy
            if blocked.any():
                first = int(np.argmax(blocked))
                return brentq(excess, grid[first - 1], grid[first], xtol=1e-15, rtol=1e-15)
            lower = _HALF_PI - edge
        return brentq(excess, lower, np.pi - 1e-9, xtol=1e-15, rtol=1e-15)

    def _fit(self) -> None:
        degree = 32
        while True:
            series = self._series(degree)
            tails = [abs(s.coef[-4:]).max() / abs(s.coef).max() for s in series[:3] if s.coef.any()]
            if max(tails) < 1e-13 or degree >= 1024:
                break
            degree *= 2
        self._time, self._chi, self._psi, self._centre = series
        self.half = float(self._time(_HALF_PI))
        self.chi_half = float(self._chi(_HALF_PI))
        self.psi_half = float(self._psi(_HALF_PI))
        self.centre_half = complex(self._centre(_HALF_PI))
        self._table = np.linspace(0.0, _HALF_PI, 257)
        self._table_time = self._time(self._table)

    def _series(self, degree: int) -> tuple[Chebyshev, Chebyshev, Chebyshev, Chebyshev]:
        """time, chi, psi and a1 + i a2 as Chebyshev series in alpha."""
        nodes = np.cos(np.pi * (np.arange(degree) + 0.5) / degree)
        alpha = 0.5 * _HALF_PI * (1.0 + nodes)
        theta = self.theta_turn * np.sin(alpha)
        turn, sigma4, V, _ = self._on_f(theta)
        q, z = np.sin(theta), np.cos(theta)
        rate = np.sqrt(2.0 / self._disk.body.M * np.maximum(self._energy - V, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            dt = self.theta_turn * np.cos(alpha) / rate
        time = _primitive(dt)
        chi = _primitive(dt * turn)
        psi = _primitive(dt * (z * turn - sigma4))
        # eq. (2.33): d(a1 + i a2)/dt = (thetadot cos phi - i sigma4) e^(i chi)
        centre = _primitive(dt * (rate * q - 1j * sigma4) * np.exp(1j * chi(alpha)))
        return time, chi, psi, centre

    def time_at(self, theta: float) -> float:
        """Time since flat at which the rise reaches theta."""
        if not 0.0 < theta <= self.theta_turn * (1.0 + 1e-9):
            raise InputError("limit motion: the state is not on the part of F that falls")
        return float(self._time(np.arcsin(min(theta / self.theta_turn, 1.0))))

    def at(self, time: Array) -> tuple[Array, Array, Array, Array, Any]:
        """(theta, |thetadot|, chi, psi, a1 + i a2) at times since flat, 0 <= time <= half."""
        slope = self._time.deriv()
        alpha = np.interp(time, self._table_time, self._table)
        for _ in range(4):
            alpha = np.clip(alpha - (self._time(alpha) - time) / slope(alpha), 0.0, _HALF_PI)
        theta = self.theta_turn * np.sin(alpha)
        V = self._on_f(np.maximum(theta, 1e-300))[2]
        speed = np.sqrt(2.0 / self._disk.body.M * np.maximum(self._energy - V, 0.0))
        return theta, speed, self._chi(alpha), self._psi(alpha), self._centre(alpha)


def _primitive(values: Any) -> Chebyshev:
    """The integral from 0 of a function of alpha given at Chebyshev nodes, in their usual order."""
    coefficients = dct(values, type=2) / values.size
    coefficients[0] *= 0.5
    return Chebyshev(coefficients, domain=[0.0, _HALF_PI]).integ(lbnd=0.0)


def limit_motion(disk: Disk, state_on_f: ArrayLike | States, sign: int = 1) -> LimitMotion:
    """The limit of the motions that approach `state_on_f` from the side sgn(eta) = `sign`.

    state_on_f: (phi, phidot, sigma3, sigma4) in the units of the disk, or States with one entry. What
    it misses F by is ignored: its energy and sigma3_bar are taken and eta on the nearer side set to 0.
    Raises InputError where the disk would not fall from there.
    """
    from explorer.falling import falls_of
    from explorer.states import phi_to_states

    require_axial_inertia(disk)
    if sign not in (1, -1):
        raise InputError(f"limit motion: sign = {sign} must be +1 or -1")
    states = state_on_f if isinstance(state_on_f, States) else phi_to_states(disk, *np.asarray(state_on_f))
    found = natural_constants(states)
    where = falls_of(states, found)
    if len(states) != 1 or not bool(where.could_fall[0]):
        raise InputError("limit motion: needs one state from which the disk could fall")
    side = int(where.side[0])
    q, z, p = states.natural[:3, 0]
    start = (float(np.arctan2(q, side * z)), side * float(p))
    return LimitMotion(disk, float(found[3, 0]), float(found[0, 0]), side, sign, start)

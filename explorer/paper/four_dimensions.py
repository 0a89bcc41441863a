"""The reduced equations as they stand in the paper, integrated by SciPy without the kernels' series or variables.

In the variables sigma they hold for every disk in its own units; `reduced` and what follows it have m = r = g = 1.
Tilt is the angle from the flat state of one face (+1 or -1).
"""

import math
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from explorer.phase.disk import Disk
from explorer.phase.states import Array

_TIGHT: dict[str, Any] = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}


def sigma_at(phi: Any, phidot: Any, s3: Any, s4: Any) -> Array:
    """(sigma_1 .. sigma_4), (4,) or (4, n)."""
    return np.array([np.sin(phi), phidot * np.cos(phi), s3, s4])


def sigma_rates(disk: Disk, sigma: Array) -> Array:
    """Eqs (2.15)-(2.18)."""
    s1, s2, s3, s4 = sigma
    q2, inertia = 1.0 - s1 * s1, disk.m * disk.r**2
    M, J = disk.I1 + inertia, disk.I3 + inertia
    weight = disk.m * disk.g * disk.r * s1 * np.sqrt(q2)
    s2dot = (-s1 * (M * s2**2 + disk.I1 * s3**2) / q2 + J * s3 * s4 + weight) / M
    return np.array([s2, s2dot, -disk.I3 * s2 * s4 / disk.I1, -inertia * s2 * s3 / (q2 * J)])


def sigma_energy(disk: Disk, sigma: Any) -> Any:
    """Eq. (2.19); sigma (4,) or (4, n)."""
    s1, s2, s3, s4 = sigma
    q2, inertia = 1.0 - s1 * s1, disk.m * disk.r**2
    moving = ((disk.I1 + inertia) * s2**2 + disk.I1 * s3**2) / q2 + (disk.I3 + inertia) * s4**2
    return 0.5 * moving + disk.m * disk.g * disk.r * np.sqrt(q2)


def turns(disk: Disk, state: Array, end: float) -> Array:
    """Times of the turning points of (2.15)-(2.18) up to `end`."""
    still: Callable[..., float] = lambda _t, sigma: float(sigma[1])  # noqa: E731
    rate: Callable[..., Array] = lambda _t, sigma: sigma_rates(disk, sigma)  # noqa: E731
    run = solve_ivp(rate, (0.0, end), sigma_at(*state), "DOP853", rtol=1e-12, atol=1e-13, events=still)
    return np.asarray(run.t_events[0])


def solved(
    rate: Callable[..., Any], start: Sequence[float] | Array, at: Array, begin: float, rtol: float
) -> Array:
    """Solutions of linear equations at the places `at`, (n, places), from `start` at the place `begin`."""
    solutions: Array = solve_ivp(rate, (begin, at[-1]), start, "DOP853", at, rtol=rtol, atol=1e-14).y
    return solutions


def reduced(disk: Disk, face: int, start: Sequence[float], t_end: float, events: Any = None) -> Any:
    """Eqs (2.15)-(2.18), (2.22), (2.31) from (tilt, its rate, sigma3, sigma4) up to an event, by SciPy.

    Rows of y: tilt, rate, sigma3, sigma4, chi, psi.
    """
    k, h, M = disk.I3 / disk.I1, 1.0 / (disk.I3 + 1.0), disk.I1 + 1.0

    def rate(_t: float, y: Array) -> list[float]:
        tilt, speed, s3, s4 = y[:4].tolist()
        q, z, p = math.sin(tilt), face * math.cos(tilt), face * speed
        turn = s3 / (q * q)
        pull = (z * disk.I1 * turn * s3 / q - s3 * s4 / (h * q) - z) / M
        return [speed, face * pull, k * q * s4 * p, h * p * s3 / q, turn, z * turn - s4]

    y0 = [*start, 0.0, 0.0]
    return solve_ivp(rate, (0.0, t_end), y0, events=events, dense_output=True, max_step=0.25, **_TIGHT)


def rates_down(
    disk: Disk, sigma3_bar: float, sigma4_bar: float, face: int, tilts: Sequence[float] | Array
) -> Array:
    """(sigma3, sigma4), (2, n), at falling tilts below pi/2 from their values at the vertical: eq. (3.1)."""
    k, h = disk.I3 / disk.I1, 1.0 / (disk.I3 + 1.0)

    def rate(y: float, s: Array) -> list[float]:
        tilt = np.exp(y)
        return [face * k * s[1] * np.sin(tilt) * tilt, face * h * s[0] * tilt / np.sin(tilt)]

    ends = float(np.log(0.5 * np.pi)), float(np.log(tilts[-1]))
    rates: Array = solve_ivp(rate, ends, [sigma3_bar, sigma4_bar], t_eval=np.log(tilts), **_TIGHT).y
    return rates


def potential(disk: Disk, tilts: Any, sigma: Array) -> Array:
    """The amended potential, eq. (3.8)."""
    q = np.sin(tilts)
    potential: Array = 0.5 * disk.I1 * (sigma[0] / q) ** 2 + 0.5 * (disk.I3 + 1.0) * sigma[1] ** 2 + q
    return potential


@lru_cache
def shot_slope(disk: Disk) -> float:
    """sigma4_bar/sigma3_bar for which sigma3 vanishes at flat on face +1, by shooting."""
    end = [rates_down(disk, *start, 1, [1e-9])[0, -1] for start in ((1.0, 0.0), (0.0, 1.0))]
    return float(-end[0] / end[1])


def upright(disk: Disk, eta_hat: float = 0.0, face: int = 1) -> tuple[float, float, float, float]:
    """(phi, phidot, sigma3, sigma4) of `checks.near_the_line`, its line found by shooting."""
    return 0.0, float(face), 1.0, face * (shot_slope(disk) - eta_hat)

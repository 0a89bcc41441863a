"""The energy of a motion and its amended potential V, and eta by eta_hat: written once, in natural units."""

import math
from typing import Any, TypeVar

from explorer import compiled
from explorer.phase.arguments import Array

Number = TypeVar("Number", float, Array)


def energy_at(body: "compiled.body.Body", phidot: Any, rho: Any, sigma4: Any, q: Any) -> Any:
    """The energy, eq. (2.19), where cos phi = q and sigma3 = rho q; V of eq. (3.8) where phidot = 0."""
    return 0.5 * body.M * phidot**2 + 0.5 * body.I1 * rho**2 + 0.5 * body.J * sigma4**2 + q


def energy_at_flat(body: "compiled.body.Body", sigma3_bar: Number) -> Number:
    """V_0, the amended potential at flat on a line l_+-, eq. (6.9). Needs I3 > 0."""
    spin = sigma3_bar / (body.k * body.r0)  # the limit of sigma4 there, eq. (6.15)
    flat: Number = energy_at(body, 0.0, 0.0, spin, 0.0)
    return flat


def eta_hat_to_eta(body: "compiled.body.Body", eta_hat: Number) -> Number:
    """eta = I3 r(0) eta_hat, eq. (6.2)."""
    return eta_hat * body.I3 * body.r0


def eta_to_eta_hat(body: "compiled.body.Body", eta: Number) -> Number:
    """eta_hat = eta / (I3 r(0)), eq. (6.2). NaN if I3 = 0."""
    return eta / (body.I3 * body.r0 if body.I3 > 0.0 else math.nan)

"""The energy of a motion, and with no speed its amended potential V: written once, in natural units."""

from typing import Any

from explorer import compiled


def energy_at(body: "compiled.body.Body", phidot: Any, rho: Any, sigma4: Any, q: Any) -> Any:
    """The energy, eq. (2.19), where cos phi = q and sigma3 = rho q; V of eq. (3.8) where phidot = 0."""
    return 0.5 * body.M * phidot**2 + 0.5 * body.I1 * rho**2 + 0.5 * body.J * sigma4**2 + q

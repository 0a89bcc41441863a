"""Constants of motion of states, without integration."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States, phi_to_states


@dataclass(frozen=True)
class Constants:
    """Constants of motion, 1-D arrays in the units of the disk; NaN for bad input.

    sigma3_bar, sigma4_bar, eta_hat_plus, eta_hat_minus: rad per unit of time, eqs (3.5), (6.2);
    eta_plus, eta_minus: eta_hat times I3 r(0); energy: eq. (2.19).
    eta_hat_* and sigma4_bar are NaN where I3 = 0, since they divide by it.
    """

    sigma3_bar: Array
    sigma4_bar: Array
    eta_hat_plus: Array
    eta_hat_minus: Array
    eta_plus: Array
    eta_minus: Array
    energy: Array
    status: NDArray[np.int8]


def natural_constants(states: States) -> Array:
    """Constants of motion in natural units, (6, n), rows as kernels.constants.Constants."""
    out = np.empty((6, len(states)))
    compiled.algebra.constants_batch(states.natural, states.disk.whole, states.disk.body, states.disk.series, out)
    out[:, states.status == compiled.status.Status.BAD_INPUT] = np.nan
    return out


def constants_of(states: States, found: Array | None = None) -> Constants:
    """Constants of motion of states; algebra, no integration. `found`: their natural_constants."""
    disk = states.disk
    if found is None:
        found = natural_constants(states)
    b: Any = disk.body
    divisor = b.I3 * b.r0 if b.I3 > 0.0 else np.nan
    plus, minus = found[1] / divisor, found[2] / divisor
    unit = disk.rate_unit
    return Constants(
        sigma3_bar=found[0] * unit,
        sigma4_bar=0.5 * (minus - plus) * unit,
        eta_hat_plus=plus * unit,
        eta_hat_minus=minus * unit,
        eta_plus=found[1] * disk.eta_unit,
        eta_minus=found[2] * disk.eta_unit,
        energy=found[3] * disk.energy_unit,
        status=states.status,
    )


def constants(disk: Disk, phi: ArrayLike, phidot: ArrayLike, sigma3: ArrayLike, sigma4: ArrayLike) -> Constants:
    """Constants of motion from a state, with no integration.

    phi in rad, -pi/2 < phi < pi/2; phidot, sigma3, sigma4 in rad per unit of time (eq. 2.14).
    Arguments broadcast; the result is 1-D. Bad input gives NaN and status BAD_INPUT.
    For states nearer to flat than phi can express see `theta_to_states` and `constants_of`.
    """
    return constants_of(phi_to_states(disk, phi, phidot, sigma3, sigma4))

"""Constants of motion of states, without integration."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants, nearer_plus
from explorer.phase.states import Array, States, phi_to_states


@dataclass(frozen=True)
class NaturalConstants:
    """Constants of motion in natural units, arrays of one length.

    rows: all of them as the kernels take them, (6, n), in the order of kernels.disk.constants.Constants. An eta
    below its `rounding` in size cannot be told from zero.
    """

    rows: Array

    def __len__(self) -> int:
        return self.rows.shape[1]

    @property
    def sigma3_bar(self) -> Array:
        return self.rows[0]

    @property
    def eta_plus(self) -> Array:
        return self.rows[1]

    @property
    def eta_minus(self) -> Array:
        return self.rows[2]

    @property
    def energy(self) -> Array:
        return self.rows[3]

    @property
    def rounding_plus(self) -> Array:
        return self.rows[4]

    @property
    def rounding_minus(self) -> Array:
        return self.rows[5]

    @property
    def linear(self) -> LinearConstants:
        return LinearConstants(*self.rows[:3])

    @property
    def nearer_plus(self) -> NDArray[np.bool_]:
        """True where face +1 is the nearer one."""
        return nearer_plus(self.eta_plus, self.eta_minus)

    def eta(self, plus: NDArray[np.bool_]) -> Array:
        """eta on face +1 where `plus`, on face -1 elsewhere."""
        return np.where(plus, self.eta_plus, self.eta_minus)

    def rounding(self, plus: NDArray[np.bool_]) -> Array:
        """A bound of the rounding error of that eta."""
        return np.where(plus, self.rounding_plus, self.rounding_minus)

    def at(self, rows: NDArray[np.intp]) -> "NaturalConstants":
        """Those of some of the states."""
        return NaturalConstants(np.ascontiguousarray(self.rows[:, rows]))


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


def natural_constants(states: States) -> NaturalConstants:
    """Constants of motion in natural units; NaN for bad input."""
    rows = np.empty((6, len(states)))
    compiled.algebra.constants_batch(states.natural, states.disk.whole, states.disk.body, states.disk.series, rows)
    rows[:, states.status == compiled.status.Status.BAD_INPUT] = np.nan
    return NaturalConstants(rows)


def constants_of(states: States, natural: NaturalConstants | None = None) -> Constants:
    """Constants of motion of states; algebra, no integration. `natural`: they, where known already."""
    disk, unit = states.disk, states.disk.rate_unit
    if natural is None:
        natural = natural_constants(states)
    plus, minus = disk.eta_to_eta_hat(natural.eta_plus), disk.eta_to_eta_hat(natural.eta_minus)
    return Constants(
        sigma3_bar=natural.sigma3_bar * unit,
        sigma4_bar=0.5 * (minus - plus) * unit,
        eta_hat_plus=plus * unit,
        eta_hat_minus=minus * unit,
        eta_plus=natural.eta_plus * disk.eta_unit,
        eta_minus=natural.eta_minus * disk.eta_unit,
        energy=natural.energy * disk.energy_unit,
        status=states.status,
    )


def constants(disk: Disk, phi: ArrayLike, phidot: ArrayLike, sigma3: ArrayLike, sigma4: ArrayLike) -> Constants:
    """Constants of motion from a state, with no integration.

    phi in rad, -pi/2 < phi < pi/2; phidot, sigma3, sigma4 in rad per unit of time (eq. 2.14).
    Arguments broadcast; the result is 1-D. Bad input gives NaN and status BAD_INPUT.
    For states nearer to flat than phi can express see `theta_to_states` and `constants_of`.
    """
    return constants_of(phi_to_states(disk, phi, phidot, sigma3, sigma4))

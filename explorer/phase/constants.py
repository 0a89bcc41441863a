"""Constants of motion of states, without integration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.results import Result
from explorer.phase.states import Array, States, require_states


@dataclass(frozen=True, repr=False, eq=False)
class Constants(Result):
    """Constants of motion in the units of the disk, arrays of the states' shape: what `constants` returns.

    For bad input all is NaN, and status says so.

    Attributes
    ----------
    sigma3_bar, sigma4_bar : array
        Values that sigma3 and sigma4 have, or would have, at the vertical, units of the disk, eq. (3.5).
        sigma4_bar is NaN where I3 = 0; it is half the difference of the two eta_hat, so where I3 is tiny it is
        only known to some 1e-16 I1/I3.
    eta_hat_plus, eta_hat_minus : array
        Signed distance of (sigma3_bar, sigma4_bar) from the lines ``l_+`` and ``l_-``, measured along sigma4_bar,
        units of the disk, eq. (6.2); NaN where I3 = 0.
    eta_plus, eta_minus : array
        eta_hat_plus and eta_hat_minus, multiplied by I3 r(0), where r(phi) is a function of the paper, eq. (5.11),
        not the radius.
    energy : array
        Energy, eq. (2.19).
    status : array of int8
        `Status` of each state, OK or BAD_INPUT.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.constants(ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, [1.0, 2.0], 0.7)).sigma3_bar
    array([1., 2.])
    """

    sigma3_bar: Array
    sigma4_bar: Array
    eta_hat_plus: Array
    eta_hat_minus: Array
    eta_plus: Array
    eta_minus: Array
    energy: Array
    status: NDArray[np.int8]
    states: States


def constants(states: States) -> Constants:
    """Constants of motion of states, by algebra and without integration.

    Parameters
    ----------
    states : States
        States of one disk.

    Returns
    -------
    Constants
        One entry per state; NaN, with status BAD_INPUT, where a state is not finite or already flat.

    Raises
    ------
    InputError
        For anything but States.

    Notes
    -----
    Eqs (3.5), (6.2) and (2.19) of the paper, to full relative accuracy near both flat states. Very near flat, phi
    itself has too few digits: give such states by `theta_to_states`.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.constants(ex.phi_to_states(ex.Disk.uniform(), phi=0.0, phidot=1.0, sigma3=1.0, sigma4=0.7))
    >>> found.eta_hat_plus.round(4), found.energy.round(4)
    (np.float64(0.0286), np.float64(2.1175))
    """
    disk, unit, motion = require_states(states).disk, states.disk.rate_unit, states.motion
    plus, minus = eta_to_eta_hat(disk.body, motion.eta_plus), eta_to_eta_hat(disk.body, motion.eta_minus)
    found = Constants(
        sigma3_bar=motion.sigma3_bar * unit,
        sigma4_bar=0.5 * (minus - plus) * unit,
        eta_hat_plus=plus * unit,
        eta_hat_minus=minus * unit,
        eta_plus=motion.eta_plus * disk.eta_unit,
        eta_minus=motion.eta_minus * disk.eta_unit,
        energy=motion.energy * disk.energy_unit,
        status=states.codes,
        states=states,
    )
    return found.reshaped(states.shape)

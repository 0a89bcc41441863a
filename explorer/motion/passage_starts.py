"""Passages from their starts at the vertical, as they are asked for and as they are followed."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.fall_integrals import departures_of_moving
from explorer.phase.disk import LARGEST_RATE, Disk, require_axial_inertia
from explorer.phase.energy import eta_hat_to_eta
from explorer.phase.states import Array

SMALLEST = 1e-302  # of eta_hat, natural units: below, eta = I3 r(0) eta_hat loses digits


class VerticalStarts(NamedTuple):
    """Starts at the vertical towards the flat state of `face`, columns in the units of the disk.

    speed: phidot towards that flat state. Numbers that mean nothing, and have a status, are placeholders: no
    kernel ever sees them.
    """

    sigma3_bar: Array
    eta_hat: Array
    speed: Array
    face: Array
    status: NDArray[np.int8]

    def natural(self, disk: Disk) -> "compiled.passages.Crossings":
        """The starts as the kernels take them, in natural units."""
        unit = disk.rate_unit
        eta = eta_hat_to_eta(disk.body, self.eta_hat / unit)
        return compiled.passages.Crossings(self.sigma3_bar / unit, eta, self.speed / unit)


class Followed(NamedTuple):
    """Passages (n) as a method has followed them, natural units, angles as on face +1.

    speed: at the vertical, towards flat. turn_rate: sigma3/q at the flattest moment. error: of the angles (rad),
    and relative of the time and of theta_min.
    """

    sigma3_bar: Array
    eta: Array
    speed: Array
    face: Array
    theta_min: Array
    chi: Array
    psi: Array
    time: Array
    turn_rate: Array
    energy: Array
    error: Array
    status: NDArray[np.int8]


def starts_at_vertical(disk: Disk, sigma3_bar: Array, eta_hat: Array, speed: Array, face: Array) -> VerticalStarts:
    """Starts from columns that were read; their status says which can be computed.

    A number that is not finite or whose square overflows is no input; an eta_hat that is lost in the smallest
    numbers of the machine has no side; with an eta_hat of 0 and more energy than V_0 the disk falls.
    """
    require_axial_inertia(disk)
    code, unit = compiled.status.Status, disk.rate_unit
    good = np.fmax(np.fmax(abs(sigma3_bar), abs(speed)), abs(eta_hat)) <= LARGEST_RATE * unit
    good &= ~(np.isnan(sigma3_bar) | np.isnan(eta_hat) | np.isnan(speed)) & (speed >= 0.0) & (abs(face) == 1.0)
    lost = good & (eta_hat != 0.0) & (abs(eta_hat) < SMALLEST * unit)
    status = np.where(good, np.where(lost, code.UNRESOLVED_SIDE, code.OK), code.BAD_INPUT).astype(np.int8)
    usable = status == code.OK
    on_f = np.flatnonzero(usable & (eta_hat == 0.0))
    kinetic = 0.5 * disk.body.M * (speed[on_f] / unit) ** 2
    level = departures_of_moving(disk, sigma3_bar[on_f] / unit, np.zeros(on_f.size), kinetic, kinetic).level
    status[on_f[level > 0.0]] = code.FALLS
    return VerticalStarts(
        np.where(usable, sigma3_bar, unit),
        np.where(usable, eta_hat, np.copysign(unit, eta_hat)),
        np.where(usable, speed, unit),
        np.where(good, face, 1.0),
        status,
    )

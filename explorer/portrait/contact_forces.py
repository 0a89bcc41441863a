"""What the table does to the disk along its motion: normal force, and the friction that rolling needs."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number
from explorer.motion.periods import periods
from explorer.motion.trajectories import finer, trajectories
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, columns_of, constants_to_states

_PARTS = 4  # of a step of the record, for 0.05 rad of chi between two times: a race has some hundred of them
_ACCURACY = 1e-9


@dataclass(frozen=True)
class ContactForces:
    """Forces at the contact over one period.

    Attributes
    ----------
    disk : Disk
        The body.
    eta_hat : float
        Distance of the motion from F, units of the disk.
    t : (nt,) array
        Time from the vertical, units of the disk.
    theta : (nt,) array
        Tilt from flat (rad).
    normal : (nt,) array
        Normal force, in m g.
    friction : (nt,) array
        The coefficient of friction that rolling needs, NaN where the normal force is not positive.

    Examples
    --------
    >>> import explorer as ex
    >>> one, = ex.portrait.contact_forces(ex.Disk.uniform(), [0.1])
    >>> 0.0 < one.airborne < 1.0
    True
    """

    disk: Disk
    eta_hat: float
    t: Array
    theta: Array
    normal: Array
    friction: Array

    @property
    def airborne(self) -> float:
        """The share of the period in which the table would have to pull."""
        below = np.maximum(-self.normal, 0.0), abs(self.normal)
        pull, size = (each[1:] + each[:-1] for each in below)  # between two times the force is a straight line
        return float(np.sum(pull / size * np.diff(self.t)) / self.t[-1])


def contact_forces(
    disk: Disk, eta_hat: Sequence[float], sigma3_bar: float = 1.0, phidot: float = 1.0
) -> tuple[ContactForces, ...]:
    """Forces over one period of motions that start at the vertical towards face +1.

    Parameters
    ----------
    disk : Disk
    eta_hat : sequence of float
        Distances from F, not 0, units of the disk.
    sigma3_bar, phidot : float
        At the vertical, units of the disk.

    Returns
    -------
    tuple of ContactForces
        One for each eta_hat.

    Raises
    ------
    InputError
        Where there is no such motion.

    Notes
    -----
    Mass times the acceleration of the centre, whose velocity is eq. (2.33), plus the weight.

    Examples
    --------
    >>> import explorer as ex
    >>> one, = ex.portrait.contact_forces(ex.Disk.uniform(), [0.3])
    >>> print(f"{one.normal[0]:.2f} m g at the vertical")
    0.00 m g at the vertical
    """
    require_axial_inertia(disk)
    sizes = columns_of(eta_hat=eta_hat)[0]
    bar, speed = number("sigma3_bar", sigma3_bar), number("phidot", phidot)
    starts = constants_to_states(disk, bar, sizes, speed)
    found = periods(starts)
    if not found.ok.all():
        raise InputError(f"eta_hat = {eta_hat!r}: {found.status_names[~found.ok][0]}; give numbers other than 0")
    every = []
    for row, (size, period) in enumerate(zip(sizes, found.period, strict=True)):
        names = ("phi", "phidot", "sigma3", "sigma4")
        motion = trajectories(starts[row], float(period), observables=names, accuracy=_ACCURACY)
        at = motion(finer(motion.t[0], _PARTS))
        phi, *rates = (getattr(at, name)[0] for name in names)
        normal, friction = _forces(disk, phi, *(rate / disk.rate_unit for rate in rates))
        every.append(ContactForces(disk, float(size), at.t, 0.5 * np.pi - phi, normal, friction))
    return tuple(every)


def _forces(disk: Disk, phi: Array, phidot: Array, sigma3: Array, sigma4: Array) -> tuple[Array, Array]:
    """Normal force and needed friction at states in natural units.

    The centre moves at z p upwards and at (p q - i sigma4) e^(i chi) along the table; the field differentiates.
    """
    force = np.empty((phi.size, 3))
    for row, (q, z, p, s3, s4) in enumerate(zip(np.cos(phi), np.sin(phi), -phidot, sigma3, sigma4, strict=True)):
        x = compiled.field.reduced_state(q, z, p, s3 / q, s4)
        k = compiled.field.field(x, disk.body)
        up = z * k.p + k.z * p
        along, across = q * k.p + k.q * p + k.chi * s4, k.chi * p * q - k.sigma4
        force[row] = np.array([up, along, across]) / k.t
    normal = 1.0 + force[:, 0]
    held = np.where(normal > 0.0, normal, np.nan)
    return normal, np.hypot(force[:, 1], force[:, 2]) / held

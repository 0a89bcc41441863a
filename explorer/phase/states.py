"""Charts of the phase space: what people give, what kernels take, and the constants of motion.

People give (phi, phidot, sigma3, sigma4) in the units of the disk; kernels take
(q, z, p, rho, sigma4) in natural units, which keep full relative accuracy near flat.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.phase.disk import Disk, require_disk
from explorer.phase.lines import Array as Array
from explorer.phase.lines import LinearConstants, line_slope, linear_constants

COORDINATES = ("phi", "phidot", "sigma3", "sigma4")


_LARGEST = 1e150


@dataclass(frozen=True)
class States:
    """Initial states in the kernels' chart.

    natural: (5, n) rows q, z, p, rho, sigma4 in natural units. status: (n) int8, kernels.Status;
    a state that is not finite or already flat is BAD_INPUT and never reaches an integrator.
    exact: the linear constants where they were given rather than computed from the state, so that eta may be
    smaller than the state's rounding; None otherwise.
    """

    disk: Disk
    natural: Array
    status: NDArray[np.int8]
    exact: LinearConstants | None = None

    def __len__(self) -> int:
        return self.natural.shape[1]

    def at(self, rows: NDArray[np.intp]) -> "States":
        """Some of the states."""
        exact = None if self.exact is None else LinearConstants(*(column[rows] for column in self.exact))
        return States(self.disk, np.ascontiguousarray(self.natural[:, rows]), self.status[rows], exact)

    def reversed(self) -> "States":
        """The same states with time running backwards: phidot changes sign (rho, sigma4 stay)."""
        natural = self.natural.copy()
        natural[2] *= -1.0
        return States(self.disk, natural, self.status.copy(), self.exact)


def phi_to_states(disk: Disk, phi: ArrayLike, phidot: ArrayLike, sigma3: ArrayLike, sigma4: ArrayLike) -> States:
    """States from phi (rad), phidot, sigma3, sigma4 (rad per unit of time); arguments broadcast."""
    require_disk(disk)
    columns = _broadcast(phi, phidot, sigma3, sigma4)
    angle = np.where(np.isfinite(columns[0]), columns[0], np.pi)
    if angle.size and (angle == angle[0]).all():
        q, z = (np.full(angle.size, f(angle[0])) for f in (np.cos, np.sin))
    else:
        q, z = np.cos(angle), np.sin(angle)
    return _states(disk, q, z, -columns[1], columns[2], columns[3], abs(angle))


def theta_to_states(
    disk: Disk,
    theta: ArrayLike,
    thetadot: ArrayLike,
    sigma3: ArrayLike,
    sigma4: ArrayLike,
    face: ArrayLike = 1,
) -> States:
    """States from the tilt theta (rad, 0 < theta < pi) measured from the flat state of `face` (+-1).

    The chart for states very near flat, where phi itself has no digits left.
    """
    tilt, rate, s3, s4, s = _broadcast(theta, thetadot, sigma3, sigma4, face)
    good = (tilt > 0.0) & (tilt < np.pi) & (abs(s) == 1.0)
    flat, tilt = np.where(good, 0.0, np.inf), np.where(good, tilt, 1.0)
    return _states(disk, np.sin(tilt), s * np.cos(tilt), s * rate, s3, s4, flat)


def constants_to_states(
    disk: Disk, sigma3_bar: ArrayLike, eta_hat: ArrayLike, phidot: ArrayLike, face: ArrayLike = 1
) -> States:
    """States at the vertical with given sigma3_bar, eta_hat on `face` (+-1) and phidot, eq. (6.2)."""
    s3, eta_hat_, rate, s = _broadcast(sigma3_bar, eta_hat, phidot, face)
    flat = np.where(abs(s) == 1.0, 0.0, np.inf)
    s4 = s * (line_slope(disk) * s3 - eta_hat_)
    made = _states(disk, np.ones_like(s3), np.zeros_like(s3), -rate, s3, s4, flat)
    unit = disk.rate_unit
    return replace(made, exact=linear_constants(disk, s3 / unit, eta_hat_ / unit, s > 0.0))


def _broadcast(*arguments: ArrayLike) -> list[Array]:
    try:
        arrays = np.broadcast_arrays(*(np.asarray(a, dtype=np.float64) for a in arguments))
    except (TypeError, ValueError) as error:
        raise InputError(f"initial states: {error}; give numbers or arrays that broadcast together") from None
    return [np.ravel(a).astype(np.float64) for a in arrays]


def _states(disk: Disk, q: Array, z: Array, p: Array, sigma3: Array, sigma4: Array, tilt: Array) -> States:
    unit = disk.rate_unit
    good = (q > 0.0) & (tilt < 0.5 * np.pi)
    with np.errstate(all="ignore"):
        natural = np.empty((5, q.size))
        natural[0], natural[1] = q, z
        np.divide(p, unit, out=natural[2])
        np.divide(sigma3, q * unit, out=natural[3])
        np.divide(sigma4, unit, out=natural[4])
    # Squares beyond overflow; NaN fails the comparison as well. rho may be large near flat.
    rates = natural[2], natural[3] * q, natural[4]
    if not all(rate.min(initial=0.0) > -_LARGEST and rate.max(initial=0.0) < _LARGEST for rate in rates):
        good &= np.all([abs(rate) < _LARGEST for rate in rates], axis=0)
    good &= np.isfinite(natural[3])
    # A placeholder keeps the kernels away from values that mean nothing; the status says so.
    natural[:, ~good] = np.array([[1.0], [0.0], [0.0], [0.0], [0.0]])
    status = np.where(good, compiled.status.Status.OK, compiled.status.Status.BAD_INPUT)
    return States(disk, np.ascontiguousarray(natural), status.astype(np.int8))


def columns_of(**named: ArrayLike) -> list[Array]:
    """The arguments as flat columns of one length. InputError names what is not a number or does not fit."""
    arrays = []
    for name, value in named.items():
        try:
            arrays.append(np.asarray(value, dtype=np.float64))
        except (TypeError, ValueError):
            raise InputError(f"{name} = {value!r} is not a number or an array of real numbers") from None
    try:
        together = np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in zip(named, arrays, strict=True))
        raise InputError(f"shapes do not fit together: {shapes}") from None
    return [np.ravel(column).astype(np.float64) for column in together]


def rows_to_states(disk: Disk, states: ArrayLike | States) -> States:
    """States from rows of phi, phidot, sigma3, sigma4; `States` pass through."""
    if isinstance(states, States):
        if states.disk != disk:
            raise InputError(f"states: made for the disk {states.disk.name!r}, used with {disk.name!r}")
        return states
    try:
        rows = np.atleast_2d(np.asarray(states, dtype=np.float64))
    except (TypeError, ValueError):
        raise InputError("states: give numbers, rows of phi, phidot, sigma3, sigma4") from None
    if rows.ndim != 2 or rows.shape[1] != 4:
        raise InputError(f"states: shape {rows.shape} is not (n, 4); give rows of phi, phidot, sigma3, sigma4")
    return phi_to_states(disk, *rows.T)

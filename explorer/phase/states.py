"""Charts of the phase space: states as users give them, and as kernels take them.

Users give (phi, phidot, sigma3, sigma4) in the units of the disk; kernels take
(q, z, p, rho, sigma4) in natural units, which keep full relative accuracy near flat.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, shown
from explorer.phase.arguments import read_columns
from explorer.phase.disk import LARGEST_RATE, Disk, require_disk
from explorer.phase.disk import Array as Array
from explorer.phase.linear_constants import Motion, motion_through, rows_of
from explorer.phase.results import COORDINATES as COORDINATES
from explorer.phase.results import WithStatus, in_shape


class StateWarning(UserWarning):
    """States are probably not what was meant: tilts look like degrees.

    Examples
    --------
    >>> import warnings, explorer as ex
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     states = ex.rates_to_states(ex.Disk.uniform(), tilt=10.0, tilt_rate=0.0, precession=1.0, spin=0.0)
    >>> [warning.category.__name__ for warning in caught], states.status.tolist()
    (['StateWarning'], 2)
    """


class Rows(NamedTuple):
    """What the kernels know of a state, natural units: cos phi, sin phi, -phidot, sigma3/q and sigma4."""

    q: Array
    z: Array
    p: Array
    rho: Array
    sigma4: Array


@dataclass(frozen=True, repr=False, eq=False)
class States(WithStatus):
    """States of one disk, as the kernels take them: what `phi_to_states` and similar functions return.

    Attributes
    ----------
    disk : Disk
        The body.
    natural : (5, n) array
        Rows q = cos phi, z = sin phi, p = -phidot, rho = sigma3/q and sigma4, in natural units, of all states one
        after the other.
    codes : (n,) array of int8
        The statuses, likewise.
    status : array of int8
        `Status` of each state. A state that is not finite or already flat is BAD_INPUT and is never followed.
    given : Motion or None
        sigma3_bar, eta_plus and eta_minus (natural units) where they were given rather than computed from the
        state, so that eta may be smaller than the state's rounding.
    shape : tuple of int
        The shape to which the arguments broadcast, () of a single state. Results computed from the states have it
        too.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.phi_to_states(ex.Disk.uniform(), [0.0, 2.0], 1.0, 1.0, 0.7)
    >>> len(states), states.status
    (2, array([0, 2], dtype=int8))
    >>> states
    States of 2 of the disk uniform: ok 1, bad_input 1; tilts 90 to 90 degrees
    >>> states[0].shape, states[states.ok].shape
    ((), (1,))
    """

    disk: Disk
    natural: Array
    codes: NDArray[np.int8]
    given: Motion | None = None
    shape: tuple[int, ...] = (-1,)

    def __post_init__(self) -> None:
        """Without a shape the states stand in a row. Raises InputError for what are no states."""
        require_disk(self.disk)
        natural, status = self.natural, self.codes
        if self.shape == (-1,):
            object.__setattr__(self, "shape", (status.size,))
        # Kernels take these arrays as they are in memory.
        right = natural.dtype == np.float64 and natural.flags.carray and status.dtype.kind == "i"
        right &= natural.shape == (5, status.size) and math.prod(self.shape) == status.size
        if not right or any(column.shape != (status.size,) for column in (status, *(self.given or ()))):
            what = f"natural = {shown(natural)}, status = {shown(status)}, shape = {self.shape}"
            raise InputError(f"States: {what}; make them by phi_to_states or another of its kind")

    @property
    def status(self) -> NDArray[np.int8]:  # type: ignore[override]
        """`Status` of each state, OK or BAD_INPUT."""
        return in_shape(self.codes, self.shape)

    def __repr__(self) -> str:
        tilt = np.degrees(np.arctan2(self.rows.q, abs(self.rows.z))[self.codes == compiled.status.Status.OK])
        tilts = f"; tilts {tilt.min():.3g} to {tilt.max():.3g} degrees" if tilt.size else ""
        return f"{self._title()} of the disk {self.disk.name}: {self._counted()}{tilts}"

    def at(self, rows: slice | NDArray[Any]) -> States:
        """Some of the states, by their numbers among all, in a row."""
        given = None if self.given is None else rows_of(self.given, rows)
        return States(self.disk, np.ascontiguousarray(self.natural[:, rows]), self.codes[rows], given)

    def reshaped(self, shape: tuple[int, ...]) -> States:
        """The same states in another shape."""
        if shape == self.shape:
            return self
        made = replace(self, shape=shape)
        if "motion" in vars(self):  # which need not be found again
            vars(made)["motion"] = self.motion
        return made

    @property
    def flat(self) -> States:
        """The same states in a row."""
        return self.reshaped((self.size,))

    def _known(self, values: Array) -> Array:
        """Values of all states in their shape; NaN for bad input, for which a placeholder stands."""
        bad = self.codes == compiled.status.Status.BAD_INPUT
        return in_shape(np.where(bad, np.nan, values), self.shape)

    @property
    def rows(self) -> Rows:
        """The rows of `natural` by name."""
        return Rows(*self.natural)

    @cached_property
    def motion(self) -> Motion:
        """The motions through the states (natural units), as flat arrays; NaN for bad input."""
        return self.of_motion(motion_through(self.disk, self.natural))

    def of_motion(self, computed: Motion) -> Motion:
        """The motions, of which these were computed: what was given instead of states, and NaN for bad input."""
        motion = computed if self.given is None else self.given._replace(energy=computed.energy)
        bad = self.codes == compiled.status.Status.BAD_INPUT
        return Motion(*(np.where(bad, np.nan, column) for column in motion)) if bad.any() else motion

    @property
    def phi(self) -> Array:
        """Angle of the disk's plane to the vertical (rad)."""
        return self._known(np.arctan2(self.rows.z, self.rows.q))

    @property
    def phidot(self) -> Array:
        """Rate of phi (units of the disk)."""
        return self._known(-self.rows.p * self.disk.rate_unit)

    @property
    def sigma3(self) -> Array:
        """sigma3 of eq. (2.14) (units of the disk)."""
        return self._known(self.rows.q * self.rows.rho * self.disk.rate_unit)

    @property
    def sigma4(self) -> Array:
        """Spin sigma4 of eq. (2.14) (units of the disk)."""
        return self._known(self.rows.sigma4 * self.disk.rate_unit)

    def reversed(self) -> States:
        """The same states with time running backwards: phidot changes sign (rho, sigma4 stay).

        Examples
        --------
        >>> import explorer as ex
        >>> ex.phi_to_states(ex.Disk.uniform(), 0.1, 1.0, 1.0, 0.7).reversed().phidot
        np.float64(-1.0)
        """
        natural = self.natural.copy()
        Rows(*natural).p[:] *= -1.0
        turned = States(self.disk, natural, self.codes.copy(), self.given, self.shape)
        turned.__dict__["motion"] = self.motion  # the same constants, which are known already
        return turned


def phi_to_states(disk: Disk, phi: ArrayLike, phidot: ArrayLike, sigma3: ArrayLike, sigma4: ArrayLike) -> States:
    """States from the angle phi between the disk's plane and the vertical.

    Parameters
    ----------
    disk : Disk
        The body.
    phi : array_like
        Angle to the vertical (rad), -pi/2 < phi < pi/2.
    phidot, sigma3, sigma4 : array_like
        Rates of eq. (2.14), units of the disk. The arrays broadcast; the result has their shape.

    Returns
    -------
    States
        States with status BAD_INPUT where they are not finite or already flat.

    Raises
    ------
    InputError
        For arguments that are not numbers or do not broadcast.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, [1.0, 2.0, 3.0], 0.7).rows.rho
    array([1., 2., 3.])
    """
    require_disk(disk)
    (tilt, rate, s3, s4), shape = read_columns(phi=phi, phidot=phidot, sigma3=sigma3, sigma4=sigma4)
    angle = np.where(np.isfinite(tilt), tilt, np.pi)
    with np.errstate(all="ignore"):
        if angle.size and (angle == angle[0]).all():
            q, z = (np.full(angle.size, f(angle[0])) for f in (np.cos, np.sin))
        else:
            q, z = np.cos(angle), np.sin(angle)
    return _states(disk, (q, z, -rate, s3, s4), abs(angle) < 0.5 * np.pi, shape)


def theta_to_states(
    disk: Disk,
    theta: ArrayLike,
    thetadot: ArrayLike,
    sigma3: ArrayLike,
    sigma4: ArrayLike,
    face: ArrayLike = 1,
) -> States:
    """States from the tilt theta above flat, for states so near flat that phi would have too few digits.

    Parameters
    ----------
    disk : Disk
        The body.
    theta : array_like
        Tilt (rad) above the flat state of `face`, 0 < theta < pi.
    thetadot, sigma3, sigma4 : array_like
        Rates, units of the disk. The arrays broadcast; the result has their shape.
    face : array_like
        The flat state above which theta is measured, +1 or -1.

    Returns
    -------
    States
        States with status BAD_INPUT where they are not finite or already flat.

    Raises
    ------
    InputError
        For arguments that are not numbers or do not broadcast.

    Examples
    --------
    >>> import explorer as ex
    >>> ex.theta_to_states(ex.Disk.uniform(), 1e-200, 0.5, 0.0, 0.3).natural[:3, 0]
    array([1.e-200, 1.e+000, 5.e-001])
    """
    require_disk(disk)
    columns, shape = read_columns(theta=theta, thetadot=thetadot, sigma3=sigma3, sigma4=sigma4, face=face)
    tilt, rate, s3, s4, s = columns
    good = (tilt > 0.0) & (tilt < np.pi) & (abs(s) == 1.0)
    tilt, s = np.where(good, tilt, 1.0), np.where(good, s, 1.0)
    with np.errstate(all="ignore"):
        seen = np.sin(tilt), s * np.cos(tilt), s * rate, s3, s4
    return _states(disk, seen, good, shape)


def _states(disk: Disk, columns: tuple[Array, ...], good: NDArray[np.bool_], shape: tuple[int, ...]) -> States:
    """States from q, z, p, sigma3 and sigma4, rates in the units of the disk. good: where the tilt is one."""
    unit, (q, z, p, sigma3, sigma4) = disk.rate_unit, columns
    good = good & (q > 0.0)
    # In place: large runs make states in blocks that stay in the processor's cache.
    natural = np.empty((5, q.size))
    row = Rows(*natural)
    row.q[:], row.z[:] = q, z
    with np.errstate(all="ignore"):
        np.divide(p, unit, out=row.p)
        np.divide(sigma3, q * unit, out=row.rho)
        np.divide(sigma4, unit, out=row.sigma4)
        # NaN fails the comparison as well. rho may be large near flat.
        for rate in (row.p, row.rho * q, row.sigma4):
            good &= abs(rate) < LARGEST_RATE
    good &= np.isfinite(row.rho)
    bad = ~good
    if bad.any():
        # A placeholder keeps the kernels away from values that mean nothing; the status says so.
        natural[:, bad] = 0.0
        row.q[bad] = 1.0
    code = compiled.status.Status
    return States(disk, natural, np.where(good, np.int8(code.OK), np.int8(code.BAD_INPUT)), shape=shape)


def joined_states(parts: Sequence[States]) -> States:
    """Some states of one disk and others, in a row."""
    natural = np.concatenate([part.natural for part in parts], axis=1)
    given = None
    if parts[0].given is not None:
        given = Motion(*map(np.concatenate, zip(*(part.given for part in parts if part.given), strict=True)))
    return States(parts[0].disk, natural, np.concatenate([part.codes for part in parts]), given)


def require_states(states: Any, name: str = "states") -> States:
    """An argument as it is. Raises InputError if it is anything but States, rows of numbers for instance."""
    if not isinstance(states, States):
        raise InputError(
            f"{name} = {shown(states)}: give States, which know their disk; "
            "phi_to_states(disk, phi, phidot, sigma3, sigma4) and its like make them"
        )
    return states

"""What general solvers make of passages near flat, on the equations as they stand in the paper."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, one_of, said
from explorer.motion.passages import passages
from explorer.phase.disk import Disk
from explorer.phase.states import Array, columns_of, constants_to_states

METHODS = ("RK45", "DOP853", "LSODA")  # of scipy.integrate.solve_ivp
OURS = "nearflat"
# Evaluations after which a solver is stopped: far more than any of them needs where it works.
_MOST_EVALUATIONS = 30_000
_MOST_PASSAGES = 10_000  # by solvers that take milliseconds for each


@dataclass(frozen=True)
class GeneralSolvers:
    """Race angles (rad) of the same passages by several solvers.

    Attributes
    ----------
    disk : Disk
        The body.
    eta_hat : (n,) array
        With its sign, units of the disk.
    race_angle : dict of str to (n,) array
        By the solver's name, NaN where it gave up.
    beyond : dict of str to (n,) array
        By the solver's name, whether its disk went through the table.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.general_solvers(ex.Disk.uniform(), [0.1])
    >>> [str(name) for name in found.race_angle]
    ['RK45', 'DOP853', 'LSODA', 'nearflat']
    """

    disk: Disk
    eta_hat: Array
    race_angle: dict[str, Array]
    beyond: dict[str, NDArray[np.bool_]]

    def wrong(self, name: str) -> NDArray[np.bool_]:
        """Which races go the wrong way, are missed, or were given up: not within half of kappa pi of ours."""
        apart = abs(self.race_angle[one_of("name", name, self.race_angle)] - self.race_angle[OURS])
        return np.asarray(~(apart < 0.5 * self.disk.race_limit))


class _GaveUpError(Exception):
    pass


class PlainField:
    """d/dt of (phi, phidot, sigma3, sigma4, chi), eqs (2.15) to (2.18) and (2.22), by the chain rule.

    The regularised field has the formulas: sigma3 = q rho, phidot = -p, dt = q ds.
    """

    def __init__(self, disk: Disk) -> None:
        self.body, self.calls = disk.body, 0

    def __call__(self, _t: float, v: Array) -> list[float]:
        self.calls += 1
        if self.calls > _MOST_EVALUATIONS or not np.isfinite(v).all():
            raise _GaveUpError
        q, z = math.cos(v[0]), math.sin(v[0])
        rho = v[2] / q
        k = compiled.field.field(compiled.field.reduced_state(q, z, -v[1], rho, v[3]), self.body)
        return [v[1], -k.p / q, (k.q * rho + q * k.rho) / q, k.sigma4 / q, k.chi / q]


def general_solvers(
    disk: Disk, eta_hat: ArrayLike, sigma3_bar: float = 1.0, phidot: float = 1.0
) -> GeneralSolvers:
    """Passages from the vertical on face +1, by SciPy's `solve_ivp` at its defaults and by `ex.passages`.

    Parameters
    ----------
    disk : Disk
    eta_hat : array_like
        Distances from F with their signs, units of the disk.
    sigma3_bar, phidot : float
        At the vertical, units of the disk.

    Returns
    -------
    GeneralSolvers

    Raises
    ------
    InputError
        Where there is no such passage.

    Notes
    -----
    The solvers get the equations of the paper in (phi, phidot, sigma3, sigma4), rtol = 1e-3 and atol = 1e-6.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.general_solvers(ex.Disk.uniform(), [0.1, -1e-6])
    >>> found.wrong("nearflat").tolist()
    [False, False]
    """
    signed = columns_of(eta_hat=eta_hat)[0]
    if not 0 < signed.size <= _MOST_PASSAGES:
        raise InputError(f"{said('eta_hat', eta_hat)} has {signed.size:,} entries; give 1 to {_MOST_PASSAGES:,}")
    ours = passages(disk, sigma3_bar, signed, phidot)
    if ours.status.any():
        raise InputError(
            f"{said('eta_hat', eta_hat)}, {said('phidot', phidot)}: no passage; give phidot above 0, eta_hat not 0"
        )
    unit = disk.rate_unit
    starts = constants_to_states(disk, sigma3_bar, signed, phidot)
    rows = np.stack([starts.phi, *(rate / unit for rate in (starts.phidot, starts.sigma3, starts.sigma4))], axis=1)
    found = {name: np.full(signed.size, np.nan) for name in METHODS}
    beyond = {name: np.zeros(signed.size, np.bool_) for name in (*METHODS, OURS)}
    for name, angles in found.items():
        for row, start in enumerate(rows):
            end = float(ours.duration[row]) * unit
            turned, beyond[name][row] = _turned(disk, name, start, end)
            angles[row] = turned - ours.fall_angle[row]
    return GeneralSolvers(disk, signed, {**found, OURS: np.asarray(ours.race_angle)}, beyond)


def _turned(disk: Disk, method: str, start: Array, end: float) -> tuple[float, bool]:
    """The increase of chi by one of SciPy's solvers, NaN where it gives up; whether phi went beyond flat."""
    from scipy.integrate import solve_ivp

    try:
        with np.errstate(all="ignore"):
            found = solve_ivp(PlainField(disk), (0.0, end), [*start, 0.0], method=method)
    except (_GaveUpError, ValueError, ZeroDivisionError):
        return math.nan, False
    turned = float(found.y[4, -1]) if found.success else math.nan
    return turned, bool((np.cos(found.y[0]) < 0.0).any())

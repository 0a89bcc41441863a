"""Whole periods of motions, from turning point to turning point, by quadrature or by integration."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import jobs_of
from explorer.motion.arcs import allowed
from explorer.motion.orbits import Ends, Orbits, ends_of, orbits_of, tilts_by_face
from explorer.motion.orbits_by_integration import integrated_orbits
from explorer.motion.plan import Plan, plan
from explorer.motion.starts import ArcStarts, arc_starts, face_of, status_at_start
from explorer.motion.threads import BLOCK, in_parts
from explorer.phase.disk import require_axial_inertia
from explorer.phase.results import Result, joined
from explorer.phase.states import Array, States, require_states


@dataclass(frozen=True, repr=False, eq=False)
class Periods(Result):
    """Whole periods, arrays of the states' shape, in the units of the disk: what `periods` returns.

    All is NaN where status is not OK.

    Attributes
    ----------
    period : array
        Time after which phi, phidot, sigma3, sigma4 return.
    chi, psi : array
        Increase of the angles of contact per period (rad), eq. (3.13).
    theta_min : array
        Smallest tilt from either flat state (rad).
    crosses : array of bool
        Whether the motion passes the vertical.
    energy : array
        Energy.
    error_estimate : array
        The largest of the errors of the angles (rad), of the period and of theta_min (relative). Near F, theta_min
        is known only as well as eta_hat: to some 1e-16 if eta_hat is computed from a state in doubles, and better
        if eta_hat is given.
    status : array of int8
        `Status` of each state.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> ex.periods(ex.phi_to_states(disk, 0.3, 0.0, 0.5, 0.2)).crosses
    np.False_
    """

    period: Array
    chi: Array
    psi: Array
    theta_min: Array
    crosses: NDArray[np.bool_]
    energy: Array
    error_estimate: Array
    status: NDArray[np.int8]
    states: States


def periods(states: States, *, accuracy: float = 1e-6, jobs: int = 1, method: str = "auto") -> Periods:
    """Periods of the motions through `states`.

    Parameters
    ----------
    states : States
        One state of each motion; the disk needs I3 > 0.
    accuracy : float
        Error of the angles (rad), relative error of the period and of theta_min, 1e-13 to 0.1. If an angle is so
        large that its 14th digit exceeds this, its error is of the size of that digit.
    jobs : int
        Threads, by default 1; the results do not depend on their number.
    method : str
        As for `bounces`: 'auto', 'quadrature', or an integrator.

    Returns
    -------
    Periods
        One entry per state.

    Raises
    ------
    InputError
        For a disk with I3 = 0, or an accuracy out of its range.

    Notes
    -----
    Eqs (3.12), (3.13) of the paper.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.uniform(), 1.0, 0.01, 1.0)
    >>> ex.periods(states, accuracy=1e-9).period.round(6)
    np.float64(3.530913)
    """
    require_axial_inertia(require_states(states).disk)
    how = plan(("period",), accuracy, method)
    found = of_motions(states, jobs_of("jobs", jobs), lambda some: _periods(some, how))
    return replace(found, states=states).reshaped(states.shape)


M = TypeVar("M", bound=Result)


def of_motions(states: States, jobs: int, call: Callable[[States], M]) -> M:
    """What `call` finds of states that have a period, block by block; the others keep their status."""
    status = status_at_start(states)
    rows = np.flatnonzero(status == compiled.status.Status.OK)
    return joined(in_parts(jobs, rows.size, lambda some: call(states.at(rows[some])), BLOCK)).among(rows, status)


def arcs_of(
    states: States, own: Array, how: Plan, there: NDArray[np.bool_] | bool, lead: bool
) -> tuple[ArcStarts, Ends, Orbits]:
    """Motions as each is seen from the face `own` of its state, their turning points, and the arcs between them.

    there, lead: as for `orbits_of`; an integrator gives all arcs.
    """
    motions = arc_starts(states.disk, states.rows, states.motion, own > 0.0)
    ends = ends_of(states.disk, motions)
    if how.method == "quadrature":
        return motions, ends, orbits_of(states.disk, motions, ends, how.accuracy, there, lead)
    return motions, *integrated_orbits(states, own, ends, how)


@np.errstate(invalid="ignore", divide="ignore")  # of motions that were not found
def _periods(states: States, how: Plan) -> Periods:
    """The periods of states that have one."""
    disk, own = states.disk, face_of(states)
    motions, ends, (here, there, _lead) = arcs_of(states, own, how, True, False)
    back = compiled.rules.ArcRow(*np.where(ends.crosses, there, 0.0))
    time = 2.0 * (here.time + back.time)
    chi, psi = 2.0 * (here.chi + back.chi), 2.0 * own * (here.psi - back.psi)
    error = np.fmax(2.0 * (here.angle_error + back.angle_error), 2.0 * (here.time_error + back.time_error) / time)
    tilts, tilt_errors = tilts_by_face(motions, ends)
    flatter = tilts[1] < tilts[0]  # on the other face
    error = np.fmax(error, np.where(flatter, tilt_errors[1], tilt_errors[0]))
    good = np.isfinite(time) & (error <= allowed(how.accuracy, chi, psi))
    return Periods(
        period=time * disk.time_unit,
        chi=chi,
        psi=psi,
        theta_min=np.where(flatter, tilts[1], tilts[0]),
        crosses=ends.crosses,
        energy=states.motion.energy * disk.energy_unit,
        error_estimate=error,
        status=motions.status(good, ends.crosses, how.accuracy),
        states=states,
    )

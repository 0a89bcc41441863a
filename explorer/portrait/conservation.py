"""What is left of the constants of motion, and of the angle, after thousands of passages."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from explorer.errors import InputError, number, shown, whole
from explorer.motion.periods import periods
from explorer.motion.plan import plan
from explorer.motion.trajectories import trajectories
from explorer.phase.constants import constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import Array, States, constants_to_states, phi_to_states
from explorer.portrait.general_solvers import PlainField

_LEAST = 1e-17  # an error of exactly 0 counts as this, below the rounding of doubles, for a logarithmic axis
_CONSTANTS = ("energy", "sigma3_bar", "eta_hat_plus")
_OBSERVABLES = ("phi", "phidot", "sigma3", "sigma4", "chi")
_MOST_STEPS = 10**8
_MOST_ACCURACIES = 20
_MOST_PERIODS = 10**6  # of some hundred steps each
TOLERANCES = {"rtol": 1e-8, "atol": 1e-10}


@dataclass(frozen=True)
class Followed:
    """Errors of one motion.

    passages (n): how many. constants (n): the largest relative error of energy, sigma3_bar and eta_hat, computed
    from the state itself. chi (n): of the contact angle (rad).
    """

    passages: Array
    constants: Array
    chi: Array


@dataclass(frozen=True)
class Conservation:
    """Errors after many passages: ours by the accuracy asked, and those of a general solver.

    Attributes
    ----------
    disk : Disk
        The body.
    eta_hat : float
        Distance of the motion from F, units of the disk.
    ours : dict of float to Followed
        By the accuracy: `passages`, and the errors of `constants` and of `chi` after so many.
    solver : Followed
        The same of SciPy's DOP853.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.conservation(ex.Disk.uniform(), most=2, most_by_solver=1, accuracies=[1e-6])
    >>> list(found.ours)
    [1e-06]
    """

    disk: Disk
    eta_hat: float
    ours: dict[float, Followed]
    solver: Followed


def conservation(
    disk: Disk, most: int = 10_000, most_by_solver: int = 300, accuracies: Sequence[float] = (1e-4, 1e-6, 1e-8)
) -> Conservation:
    """Follow one motion through many passages near flat and compare it with whole periods by quadrature.

    Parameters
    ----------
    disk : Disk
    most, most_by_solver : int
        Passages by this program, and by SciPy's DOP853, which takes a hundred times longer.
    accuracies : sequence of float
        Those asked of `simulate`.

    Returns
    -------
    Conservation

    Raises
    ------
    InputError
        For what is no disk, number of passages or list of accuracies, and where a motion could not be followed
        to its end.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.portrait.conservation(ex.Disk.uniform(), most=3, most_by_solver=1, accuracies=[1e-6])
    >>> bool(found.ours[1e-6].chi.max() < 1e-5)
    True
    """
    require_axial_inertia(disk)
    asked = _accuracies("accuracies", accuracies)
    most = whole("most", most, 1, _MOST_PERIODS)
    by_solver = _counts(whole("most_by_solver", most_by_solver, 1, _MOST_PERIODS))
    unit = disk.rate_unit
    start = constants_to_states(disk, unit, 0.01 * unit, unit)
    whole_period = periods(start, 1e-11)
    period, turn = float(whole_period.period[0]), float(whole_period.chi[0])
    ours = {}
    counts = _counts(most)
    for accuracy in asked:
        motion = trajectories(start, None, counts * period, _OBSERVABLES, accuracy=accuracy, max_steps=_MOST_STEPS)
        if not motion.lengths.all():
            raise InputError(f"most = {most}: the motion could not be followed so far; give a smaller number")
        ours[accuracy] = _errors(start, counts, [getattr(motion, name)[0] for name in _OBSERVABLES], turn)
    solver = _errors(start, by_solver, _by_solver(start, by_solver, period), turn)
    return Conservation(disk, 0.01 * unit, ours, solver)


def _accuracies(name: str, value: Any) -> list[float]:
    """Read the accuracies that `simulate` is asked for. Raises InputError."""
    several = value.tolist() if isinstance(value, np.ndarray) else value
    if not isinstance(several, list | tuple) or not 0 < len(several) <= _MOST_ACCURACIES:
        raise InputError(
            f"{name} = {shown(value)}: give a list of 1 to {_MOST_ACCURACIES} numbers, such as [1e-6]"
        )
    return [plan(_OBSERVABLES, number(name, each)).accuracy for each in several]


def _counts(most: int) -> Array:
    return np.unique(np.geomspace(1, most, 31).round())


def _by_solver(start: States, counts: Array, period: float) -> list[Array]:
    """The observables after so many periods by a general solver on the equations of the paper."""
    from scipy.integrate import solve_ivp

    unit = start.disk.rate_unit
    first = [float(start.phi[0]), *(float(v[0]) / unit for v in (start.phidot, start.sigma3, start.sigma4)), 0.0]
    state, rows = first, []
    for _ in range(int(counts[-1])):
        found = solve_ivp(PlainField(start.disk), (0.0, period * unit), state, method="DOP853", **TOLERANCES)
        state = found.y[:, -1].tolist()
        rows.append(state)
    phi, *rates, chi = np.array(rows)[counts.astype(int) - 1].T
    return [phi, *(rate * unit for rate in rates), chi]


def _errors(start: States, counts: Array, observed: list[Array], turn: float) -> Followed:
    phi, phidot, sigma3, sigma4, chi = observed
    now, first = constants(phi_to_states(start.disk, phi, phidot, sigma3, sigma4)), constants(start)
    apart = [abs(getattr(now, name) / getattr(first, name) - 1.0) for name in _CONSTANTS]
    return Followed(
        counts, np.maximum(np.max(apart, axis=0), _LEAST), np.maximum(abs(chi - counts * turn), _LEAST)
    )

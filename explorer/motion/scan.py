"""An observable of the user's own, for every state: in batches, in parallel, with bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from joblib import Parallel, delayed
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError, jobs_of, one_of, shown, whole
from explorer.motion.bounces import bounces
from explorer.motion.periods import periods
from explorer.phase.constants import constants_of
from explorer.phase.membership import falls_of
from explorer.phase.states import States, require_states

BATCH = 4096  # states; a trajectory of a few hundred times for each still takes some ten megabytes
Values = NDArray[Any] | dict[str, NDArray[Any]]
Observable = str | Callable[[States], ArrayLike | Mapping[str, ArrayLike]]

# The observables that have names, by the call that computes them.
_SOURCES: dict[str, tuple[Callable[[States], Any], tuple[str, ...]]] = {
    "constants": (constants_of, ("sigma3_bar", "sigma4_bar", "eta_hat_plus", "eta_hat_minus", "energy")),
    "falls": (falls_of, ("face", "distance", "could_fall", "on_f")),
    "periods": (periods, ("theta_min", "period", "chi", "psi", "crosses")),
    "bounces": (bounces, ("race_angle", "delta_chi", "fall_angle", "side", "time")),
}
OBSERVABLES = {name: call for call, names in _SOURCES.values() for name in names}


def scan(states: States, observable: Observable, jobs: int = 1, batch: int = BATCH) -> Values:
    """Compute an observable for every state.

    Parameters
    ----------
    states : States
        The states, for instance of `phi_to_states`, `rates_to_states` or `coordinates_to_states`.
    observable : str or callable
        A name: one of sigma3_bar, sigma4_bar, eta_hat_plus, eta_hat_minus, energy, face, distance, could_fall,
        on_f, theta_min, period, chi and psi (per period), crosses, and race_angle, delta_chi, fall_angle, side,
        time of the next approach to flat. Or a function f(batch) of `States` that returns an array with one
        entry for each state, or a dict of such arrays; it may call `constants`, `bounces`, `simulate` and so on.
    jobs : int
        Threads; the order of calls is then not defined.
    batch : int
        States in one call of the function, which bounds the memory.

    Returns
    -------
    array or dict of arrays
        What the function returned for all states, with the shape of `states` first.

    Raises
    ------
    InputError
        Where the name is not known, or the function does not return one entry for each state.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> states = ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 0.5, np.linspace(-1.0, 1.0, 5))
    >>> ex.scan(states, "theta_min").round(4)
    array([0.6272, 0.1223, 0.3639, 0.1223, 0.6272])

    Turns of the contact point within a time of 10:

    >>> def turns(batch):
    ...     motion = ex.simulate(batch, t_eval=[10.0], observables=["chi"])
    ...     return motion.chi[:, 0] / (2.0 * np.pi)
    >>> ex.scan(states, turns).round(3)
    array([-0.362, -0.637,  3.327, -0.824, -0.436])
    """
    require_states(states)
    jobs, batch = jobs_of("jobs", jobs), whole("batch", batch, 1)
    if isinstance(observable, str):
        name = one_of("observable", observable, OBSERVABLES)
        call = OBSERVABLES[name]
        return scan(states, lambda part: np.reshape(getattr(call(part), name), len(part)), jobs, batch)
    if not callable(observable):
        raise InputError(f"observable = {shown(observable)} is neither a name nor a function of States")
    parts = [np.arange(first, min(first + batch, len(states))) for first in range(0, max(len(states), 1), batch)]
    found = Parallel(n_jobs=jobs, backend="threading")(
        delayed(_checked)(observable, states.at(rows)) for rows in parts
    )
    names = list(found[0])
    if any(list(part) != names for part in found):
        raise InputError("observable: the function returned other names for some states")
    joined = {name: _joined([part[name] for part in found], states.shape) for name in names}
    return joined[""] if names == [""] else joined


def _checked(observable: Callable[[States], Any], part: States) -> dict[str, NDArray[Any]]:
    """What the function returned for some states, by name; a single array has the name ''."""
    returned = observable(part)
    columns = dict(returned) if isinstance(returned, Mapping) else {"": returned}
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    for name, values in arrays.items():
        if values.ndim == 0 or values.shape[0] != len(part):
            what = f" {name!r}" if name else ""
            raise InputError(
                f"observable: the function returned{what} shape {values.shape} for {len(part)} states; "
                "return one entry for each state"
            )
    return arrays


def _joined(parts: list[NDArray[Any]], shape: tuple[int, ...]) -> NDArray[Any]:
    whole_array = np.concatenate(parts)
    return whole_array.reshape(*shape, *whole_array.shape[1:])

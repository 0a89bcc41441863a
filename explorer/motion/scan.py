"""An observable of the user's own, for every state: in batches, in parallel, with bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError, jobs_of, one_of, shown, whole
from explorer.motion.bounces import bounces
from explorer.motion.periods import periods
from explorer.motion.threads import in_parts
from explorer.phase.arguments import returned_numbers
from explorer.phase.constants import constants
from explorer.phase.falling_set import falls
from explorer.phase.results import Table, in_shape, stacked
from explorer.phase.states import COORDINATES, States, require_states

_MOST_BATCH = 10**9  # states; more than memory holds
BATCH = 4096  # states; a trajectory of a few hundred times for each still takes some ten megabytes
_TAKEN = (*COORDINATES, "status")  # names of columns that no function gives
_PATIENCE = 2.0  # seconds before a bar is shown
Observable = str | Sequence[str] | Callable[[States], ArrayLike | Mapping[str, ArrayLike]]

# The observables that have names, by the call that computes them.
_SOURCES: dict[str, tuple[Callable[[States], Any], tuple[str, ...]]] = {
    "constants": (constants, ("sigma3_bar", "sigma4_bar", "eta_hat_plus", "eta_hat_minus", "energy")),
    "falls": (falls, ("face", "distance", "could_fall", "on_f")),
    "periods": (periods, ("theta_min", "period", "chi", "psi", "crosses")),
    "bounces": (bounces, ("race_angle", "delta_chi", "fall_angle", "side", "time")),
}
OBSERVABLES = {name: call for call, names in _SOURCES.values() for name in names}


@dataclass(frozen=True, repr=False, eq=False)
class Scan(Table):
    """Observables of states, arrays with their shape: what `scan` returns.

    Index it by the name of an observable, or like an array to get some of the states. If it has only one
    observable, numpy takes it as an array. `save` stores it, and `ex.picture("observable", found)` draws it.

    Attributes
    ----------
    states : States
        What was scanned.
    values : dict of arrays
        The observables by name. The name is that of the observable or of the function, or the key of the dict that
        the function returned. If an array has more axes than the states, the additional axes hold the several
        numbers of each state.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> states = ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 0.5, np.linspace(-1.0, 1.0, 5))
    >>> found = ex.scan(states, ["theta_min", "period"])
    >>> list(found), found["period"].round(3)
    (['theta_min', 'period'], array([3.49 , 4.536, 5.12 , 4.536, 3.49 ]))
    """

    states: States
    values: dict[str, NDArray[Any]]

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the states."""
        return self.states.shape

    def _arrays(self) -> dict[str, NDArray[Any]]:
        return {name: np.asarray(values) for name, values in self.values.items()}

    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: Any) -> Scan: ...
    def __getitem__(self, key: Any) -> Any:
        """An observable, by its name; or some of the states, indexed like an array of this shape."""
        if isinstance(key, str):
            return self.values[one_of("observable", key, self.values)]
        return super().__getitem__(key)

    def _with(self, arrays: dict[str, NDArray[Any]], states: States) -> Scan:
        return Scan(states, arrays)

    def __iter__(self) -> Iterator[str]:
        return iter(self.values)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if len(self.values) != 1:
            raise InputError(f"a scan of {', '.join(self.values)} is no single array; choose one by its name")
        (values,) = self.values.values()
        return np.array(values, dtype=dtype) if copy else np.asarray(values, dtype=dtype)


def scan(states: States, observable: Observable, *, jobs: int = 1, batch: int = BATCH) -> Scan:
    """Compute observables of every state: by name, or by a function of your own.

    Parameters
    ----------
    states : States
        The states, for instance of `phi_to_states`, `rates_to_states` or `coordinates_to_states`.
    observable : str, several, or callable
        Names: sigma3_bar, sigma4_bar, eta_hat_plus, eta_hat_minus, energy, face, distance, could_fall, on_f,
        theta_min, period, chi and psi (per period), crosses, and, of the next approach to flat, race_angle,
        delta_chi, fall_angle, side and time. Or a function f(batch) of `States` that returns an array with one
        entry for each state, or a dict of such arrays; it may call `constants`, `bounces`, `simulate` and so on.
    jobs : int
        Threads; the function is then called in no particular order.
    batch : int
        States in one call of the function, which bounds the memory.

    Returns
    -------
    Scan
        The arrays by name, with the shape of `states` first.

    Raises
    ------
    InputError
        For an unknown name; if the function does not return one real number, or a row of them, for each
        state; and if it gives an array the name of a coordinate or of the status. Errors that the function itself
        raises are passed on.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> states = ex.phi_to_states(ex.Disk.uniform(), 0.0, 1.0, 0.5, np.linspace(-1.0, 1.0, 5))
    >>> ex.scan(states, "theta_min")["theta_min"].round(4)
    array([0.6272, 0.1223, 0.3639, 0.1223, 0.6272])

    Turns of the contact point within a time of 10:

    >>> def turns(batch):
    ...     motion = ex.simulate(batch, t_eval=[10.0], observables=["chi"])
    ...     return motion.chi[:, 0] / (2.0 * np.pi)
    >>> ex.scan(states, turns)["turns"].round(3)
    array([-0.362, -0.637,  3.327, -0.824, -0.436])
    """
    from tqdm import tqdm

    require_states(states)
    jobs, batch = jobs_of("jobs", jobs), whole("batch", batch, 1, _MOST_BATCH)
    call, alone = _function_of(observable)
    blocks = max(1, -(-states.size // batch))
    with tqdm(desc=alone, total=blocks, disable=None, delay=_PATIENCE, leave=False) as bar:  # on a terminal

        def checked(rows: slice) -> dict[str, NDArray[Any]]:
            found = _checked(call, states.at(rows), alone)
            bar.update()
            return found

        found = in_parts(jobs, states.size, checked, batch)
    return Scan(states, {name: in_shape(each, states.shape) for name, each in stacked(found).items()})


def _function_of(observable: Any) -> tuple[Callable[[States], Any], str]:
    """A function of states, and what a single array that it returns is called. Raises InputError."""
    if isinstance(observable, str):
        return _function_of([observable])[0], observable
    if callable(observable):
        name = getattr(observable, "__name__", "observable")
        return observable, "observable" if name == "<lambda>" else name
    if not isinstance(observable, list | tuple) or not observable:
        raise InputError(f"observable = {shown(observable)} is neither a name nor a function of States")
    names = [one_of("observable", name, OBSERVABLES) for name in observable]

    def by_name(part: States) -> dict[str, NDArray[Any]]:
        results = {call: call(part) for call in {OBSERVABLES[name] for name in names}}
        return {name: np.reshape(getattr(results[OBSERVABLES[name]], name), part.size) for name in names}

    return by_name, ", ".join(names)


def _checked(observable: Callable[[States], Any], part: States, alone: str) -> dict[str, NDArray[Any]]:
    """What the function returned for some states, by name. alone: what a single array is called."""
    returned = observable(part)
    arrays = {}
    for name, values in (returned if isinstance(returned, Mapping) else {alone: returned}).items():
        if not isinstance(name, str) or name in _TAKEN:
            raise InputError(
                f"observable: the function returned {shown(name)} as a name; give text, "
                f"and none of {', '.join(_TAKEN)}"
            )
        arrays[name] = returned_numbers("observable", values)
        if arrays[name].shape[:1] != (part.size,):
            raise InputError(
                f"observable: the function returned {name!r} of shape {arrays[name].shape} for {part.size} "
                "states; return one entry for each state"
            )
    return arrays

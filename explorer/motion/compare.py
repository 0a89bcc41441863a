"""The same question by several methods: what each answers, how long it takes, how far the answers are apart."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from explorer.errors import InputError, one_of, words
from explorer.motion.bounces import Bounces, bounces
from explorer.phase.states import Array, States, require_states

ANGLES = ("race_angle", "delta_chi", "delta_psi")
COMPARED = (*ANGLES, "theta_min", "duration", "time")


def apart(name: str, found: Array, known: Array) -> Array:
    """How far answers are apart: ANGLES in rad, tilts and times relative; NaN where one is missing."""
    with np.errstate(divide="ignore", invalid="ignore"):
        away: Array = abs(found - known) if name in ANGLES else abs(found / known - 1.0)
    return away


@dataclass(frozen=True, repr=False)
class Comparison:
    """Bounces by several methods: what `compare` returns.

    Attributes
    ----------
    bounces : dict of Bounces
        The answer of each method, by its name.
    seconds : dict of float
        Time that each method took, on the clock.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.rates_to_states(ex.Disk.uniform(), [0.4, 0.5], 0.0, 1.0, 0.2)
    >>> found = ex.compare(states, ("quadrature", "rk8"))
    >>> found.bounces["rk8"].shape, bool(found.differences("race_angle")["rk8"].max() < 1e-6)
    ((2, 1), True)
    """

    bounces: dict[str, Bounces]
    seconds: dict[str, float]

    def differences(self, name: str) -> dict[str, Array]:
        """How far the others are from the first method in one column, by method: arrays of the bounces' shape.

        race_angle, delta_chi and delta_psi in rad, theta_min, duration and time relative; NaN where one of the two
        has no answer. Raises InputError for any other column.
        """
        first, *others = self.bounces
        one_of("column", name, COMPARED)
        known = getattr(self.bounces[first], name)
        return {method: apart(name, getattr(self.bounces[method], name), known) for method in others}

    def __repr__(self) -> str:
        first = next(iter(self.bounces))
        lines = [f"Comparison of {self.bounces[first].size:,} bounces; largest differences from {first}"]
        largest = {name: self.differences(name) for name in COMPARED}
        for method, found in self.bounces.items():
            said = [f"{found.ok.sum():,} ok", f"{self.seconds[method]:.3g} s"]
            for name in COMPARED if method != first else ():
                size = np.fmax.reduce(largest[name][method], axis=None, initial=np.nan)
                unit = "rad" if name in ANGLES else "relative"
                said += [] if np.isnan(size) else [f"{name} {size:.1e} {unit}"]  # no state has both answers
            lines.append(f"  {method}: {', '.join(said)}")
        return "\n".join(lines)


def compare(
    states: States,
    methods: Sequence[str] = ("quadrature", "dop853"),
    *,
    count: int = 1,
    accuracy: float = 1e-6,
    jobs: int = 1,
) -> Comparison:
    """Compute the bounces of the same states by several methods.

    Parameters
    ----------
    states : States
        As for `bounces`.
    methods : sequence of str
        Two or more of 'quadrature', 'rk4', 'rk8', 'dopri5', 'dop853'; the others are compared with the first.
    count, accuracy, jobs
        As for `bounces`.

    Returns
    -------
    Comparison
        The bounces and times by method. `differences(column)` says how far the others are from the first method in
        that column. If you print the result, you get one line for each method.

    Raises
    ------
    InputError
        As `bounces` does, and for fewer than two methods.

    Examples
    --------
    >>> import explorer as ex
    >>> states = ex.constants_to_states(ex.Disk.hoop(), 1.0, [1e-3, 1e-6], 1.0)
    >>> found = ex.compare(states, ("quadrature", "rk4", "dopri5"), accuracy=1e-8)
    >>> [bool(found.differences("theta_min")[method].max() < 1e-8) for method in ("rk4", "dopri5")]
    [True, True]
    """
    asked = tuple(dict.fromkeys(words("methods", methods)))
    if len(asked) < 2:
        raise InputError(f"methods = {', '.join(asked) or 'none'}: give two or more different ones")
    found, seconds = dict[str, Bounces](), dict[str, float]()
    first = require_states(states).at(slice(1))
    for method in asked:
        bounces(first, 1, accuracy=accuracy, method=method)  # so that no time is that of loading code
        began = time.perf_counter()
        found[method] = bounces(states, count, accuracy=accuracy, jobs=jobs, method=method)
        seconds[method] = time.perf_counter() - began
    return Comparison(found, seconds)

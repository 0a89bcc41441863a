"""The ladder: which model and which method a question needs, and how finely to integrate.

A scene names observables and an accuracy; this module answers with the lowest rung that gives
them and with the integrator's setting for every sample. No scene names a kernel.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

import numpy as np

from explorer import compiled
from explorer.errors import InputError
from explorer.states import Array, States

ALGEBRA, REDUCED, ANGLES, PATH = "algebra", "reduced", "angles", "path"
RUNGS = (ALGEBRA, REDUCED, ANGLES, PATH)
METHODS = ("auto", "rk4", "dopri5")

OBSERVABLES = {
    "constants": ALGEBRA,
    "side": ALGEBRA,
    "distance": ALGEBRA,
    "could_fall": ALGEBRA,
    "theta_min": REDUCED,
    "phi": REDUCED,
    "phidot": REDUCED,
    "sigma3": REDUCED,
    "sigma4": REDUCED,
    "time": ANGLES,
    "chi": ANGLES,
    "psi": ANGLES,
    "race_angle": ANGLES,
    "path": PATH,
    "contact": PATH,
}

ACCURACY_RANGE = (1e-11, 1e-1)

# Error over tolerance at the 99th percentile was measured at 3 to 20 for passages of the uniform
# disk, the hoop and a body with kappa = 10; 1/30 leaves room for other bodies and energies.
_DOPRI5_SHARE = 1.0 / 30.0
# RK4's error in chi over a passage is about 0.03 h^4, in eta about 8e-4 h^4 (h in units of
# 1/speed, uniform disk). Ten times that is assumed.
_RK4_CONSTANT = 0.3
# eta must be known to a hundredth for the direction of the race to be beyond doubt.
_SIDE_SHARE = 0.01
_TOLERANCE_FLOOR = 3e-15
_STEP_RANGE = (1e-3, 0.25)


@dataclass(frozen=True)
class Plan:
    """What will be run for a question: the rung, the method, and the reason in words."""

    rung: str
    method: str
    accuracy: float
    relative_tilt: bool  # theta_min is asked for, relative: eta must be known that well
    reason: str

    @property
    def kernel_method(self) -> int:
        steps = compiled.steps
        return steps.RK4 if self.method == "rk4" else steps.DOPRI5

    @property
    def kernel_depth(self) -> int:
        field = compiled.field
        return {REDUCED: field.REDUCED, ANGLES: field.ANGLES, PATH: field.PATH}[self.rung]

    @property
    def max_drift(self) -> float:
        """Relative drift of a constant of motion above which a sample is refused."""
        return self.accuracy

    def control(self, states: States, found: Array) -> Array:
        """Tolerance or step for every sample, from its constants of motion (natural units).

        The nearer to F, the better eta must be known: its error is the tolerance times
        sqrt(2 E I1), which is why the share of eta is taken in these units.
        """
        near = np.fmin(abs(found[1]), abs(found[2]))
        tilt = near / np.sqrt(2.0 * states.disk.body.I1 * found[3])
        share = self.accuracy if self.relative_tilt else _SIDE_SHARE
        target = np.fmin(self.accuracy, share * np.fmin(tilt, 1.0))
        if self.method == "rk4":
            return np.clip((target / _RK4_CONSTANT) ** 0.25, *_STEP_RANGE)
        return np.clip(target * _DOPRI5_SHARE, _TOLERANCE_FLOOR, None)


def plan(observables: Iterable[str], accuracy: float = 1e-6, method: str = "auto") -> Plan:
    """The lowest rung and the cheapest method that give `observables` to `accuracy`.

    accuracy: absolute error of angles (rad), relative error of times and theta_min.
    Raises InputError for an unknown observable or method, or an accuracy out of range.
    """
    asked = tuple(observables)
    for name in asked:
        if name not in OBSERVABLES:
            raise InputError(f"observable {name!r} is not known; {_suggest(name, OBSERVABLES)}")
    check_accuracy(accuracy)
    if method not in METHODS:
        raise InputError(f"--method {method!r} is not known; {_suggest(method, METHODS)}")
    rung = max((OBSERVABLES[name] for name in asked), key=RUNGS.index, default=ALGEBRA)
    deepest = ", ".join(name for name in asked if OBSERVABLES[name] == rung)
    if method == "auto":
        # The adaptive pair bends its step to each sample's distance from F, which spans decades
        # in any sampling; a fixed step must be small enough throughout the motion.
        method, why = "dopri5", "dopri5 because each sample sets its own step near flat"
    else:
        why = f"{method} as asked"
    reason = f"{rung} because of {deepest or 'nothing else'}; {why}"
    return Plan(rung, method, accuracy, "theta_min" in asked, reason)


def check_accuracy(accuracy: float) -> None:
    """Raise InputError unless the accuracy is one that an integrator here can hold."""
    low, high = ACCURACY_RANGE
    if not low <= accuracy <= high:
        raise InputError(f"--accuracy {accuracy} must lie between {low:g} and {high:g}")


def _suggest(name: str, known: Iterable[str]) -> str:
    names = list(known)
    near = get_close_matches(name, names, n=1)
    return (f"did you mean {near[0]!r}? " if near else "") + f"known: {', '.join(names)}"

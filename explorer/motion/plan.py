"""Levels of the model: which one and which method a question needs, and how finely to integrate.

A scene names observables and an accuracy; this module answers with the lowest level that gives
them, the method, and the integrator's setting. No scene names a kernel.

    algebra     constants of motion: face, distance, could-fall
    quadrature  passages and periods as integrals, theta_min as a root: eta exact, cost flat in eta
    reduced     integration of (phi, phidot, sigma3, sigma4)
    angles      and of time, chi, psi
    path        and of the centre and the contact point
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number, one_of, words
from explorer.motion.calibration import setting_for

ALGEBRA, QUADRATURE, REDUCED, ANGLES, PATH = "algebra", "quadrature", "reduced", "angles", "path"
LEVELS = (ALGEBRA, QUADRATURE, REDUCED, ANGLES, PATH)
FIXED, ADAPTIVE = {"rk4": 4, "rk8": 8}, ("dopri5", "dop853")  # fixed steps with their orders
INTEGRATORS = (*FIXED, *ADAPTIVE)
METHODS = ("auto", *INTEGRATORS, "quadrature")

_OF_LEVEL = {
    ALGEBRA: ("constants", "face", "distance", "could_fall"),
    QUADRATURE: ("theta_min", "race_angle", "delta_chi", "delta_psi", "duration", "period"),
    REDUCED: ("phi", "tilt", "phidot", "sigma3", "sigma4"),
    ANGLES: ("time", "chi", "psi"),
    PATH: ("path", "contact"),
}
OBSERVABLES = {name: level for level, names in _OF_LEVEL.items() for name in names}

# What an integrator must carry for an observable that quadrature would give.
_INTEGRATED = {"theta_min": REDUCED}

LOOSEST = 1e-1
# A passage's rounding is about 1e-13; an integrator's errors of rounding add up over its steps.
TIGHTEST = {"quadrature": 1e-13, **dict.fromkeys(INTEGRATORS, 1e-11)}

# Tolerances below some units in the last place of a number of order 1 only shorten the steps.
_TOLERANCE_FLOOR = 1e-15


@dataclass(frozen=True)
class Plan:
    """The way a question will be answered: the level, the method, and the reason in words.

    setting: the integrator's step or tolerance where that is what is tried; else `calibration` says it.
    """

    level: str
    method: str
    accuracy: float
    reason: str
    setting: float | None = None

    @property
    def kernel_method(self) -> int:
        """The number of the method in the kernels."""
        return int(getattr(compiled.attempt, self.method.upper()))

    @property
    def kernel(self) -> str:
        """The name of the kernel that follows motions, for `compiled.warmup`."""
        return f"engine.{self.method}_{self.level}"

    @property
    def in_time(self) -> "Plan":
        """The same for motions in time, which is carried from the angles on."""
        return replace(self, level=ANGLES) if self.level == REDUCED else self

    @property
    def kernel_depth(self) -> int:
        """The number of components of a state that the kernels carry along for this level."""
        return int(getattr(compiled.field, self.level.upper()))

    @property
    def adaptive(self) -> bool:
        """True where the method chooses its own steps."""
        return self.method in ADAPTIVE

    @property
    def control(self) -> float:
        """Tolerance or step for motions to their next turning point, held to sigma3_bar and eta.

        What is held cannot be lost, so the setting does not depend on the distance from F.
        """
        setting = setting_for(self.method, self.accuracy) if self.setting is None else self.setting
        return float(self.at_least(setting))

    def at_least(self, setting: Any) -> Any:
        """A step, or a tolerance that rounding does not refuse."""
        return np.fmax(setting, 0.0 if self.method in FIXED else _TOLERANCE_FLOOR)


def plan(observables: Iterable[str], accuracy: float = 1e-6, method: str = "auto") -> Plan:
    """The lowest level and the cheapest method that give `observables` to `accuracy`.

    accuracy: absolute error of angles (rad), relative error of times and theta_min.
    Raises InputError for an unknown observable or method, for a method that cannot give them, or for
    an accuracy out of its range.
    """
    asked = words("observables", observables)
    for name in asked:
        one_of("observable", name, OBSERVABLES)
    one_of("method", method, METHODS)
    accuracy = number("accuracy", accuracy)
    level, chosen, why = _choose(asked, method, accuracy)
    if chosen != ALGEBRA and not TIGHTEST[chosen] <= accuracy <= LOOSEST:
        raise InputError(f"accuracy {accuracy} must lie between {TIGHTEST[chosen]:g} and {LOOSEST:g} for {chosen}")
    return Plan(level, chosen, accuracy, why)


def method_in_words(method: str) -> str:
    """The way a result was computed, as pictures and pages say it; `method` as in Plan.method."""
    return f"by {method}" if method in (ALGEBRA, QUADRATURE) else f"integrated with {method}"


def _choose(asked: tuple[str, ...], method: str, accuracy: float) -> tuple[str, str, str]:
    """(level, method, reason)."""
    level = max((OBSERVABLES[name] for name in asked), key=LEVELS.index, default=ALGEBRA)
    deepest = ", ".join(name for name in asked if OBSERVABLES[name] == level) or "nothing else"
    if level == ALGEBRA:
        return level, ALGEBRA, f"{level} because of {deepest}; no motion is followed"
    if level == QUADRATURE and method in ("auto", "quadrature"):
        why = "as asked" if method == "quadrature" else "because it needs no steps and knows eta exactly"
        return level, "quadrature", f"{level} because of {deepest}; quadrature {why}"
    if method == "quadrature":
        raise InputError(f"method quadrature gives passages and periods, not {deepest}; use auto or an integrator")
    why = f"{method} as asked"
    if method == "auto":
        # Adaptive pairs bend their steps to each sample's distance from F, which spans decades in any sampling; a
        # fixed step must be small enough throughout the motion.
        method = "dop853"
        why = f"{method} because each sample sets its own step near flat, and it costs least at fine accuracies"
    if level == QUADRATURE:
        carried = (_INTEGRATED.get(name, ANGLES) for name in asked if OBSERVABLES[name] == QUADRATURE)
        level = max(carried, key=LEVELS.index)
    return level, method, f"{level} because of {deepest}; {why}"

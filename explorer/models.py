"""The ladder: which model and which method a question needs, and how finely to integrate.

A scene names observables and an accuracy; this module answers with the lowest rung that gives
them, the method, and the integrator's setting for every sample. No scene names a kernel.

    algebra     constants of motion: side of F, distance, could-fall
    quadrature  passages and periods as integrals, theta_min as a root: eta exact, cost flat in eta
    reduced     integration of (phi, phidot, sigma3, sigma4)
    angles      and of time, chi, psi
    path        and of the centre and the contact point
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from difflib import get_close_matches
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError
from explorer.states import Array, States

ALGEBRA, QUADRATURE, REDUCED, ANGLES, PATH = "algebra", "quadrature", "reduced", "angles", "path"
RUNGS = (ALGEBRA, QUADRATURE, REDUCED, ANGLES, PATH)
FIXED, ADAPTIVE = ("rk4", "rk8"), ("dopri5", "dop853")
METHODS = ("auto", *FIXED, *ADAPTIVE, "quadrature")

OBSERVABLES = {
    "constants": ALGEBRA,
    "side": ALGEBRA,
    "distance": ALGEBRA,
    "could_fall": ALGEBRA,
    "theta_min": QUADRATURE,
    "race_angle": QUADRATURE,
    "delta_chi": QUADRATURE,
    "delta_psi": QUADRATURE,
    "duration": QUADRATURE,
    "period": QUADRATURE,
    "phi": REDUCED,
    "phidot": REDUCED,
    "sigma3": REDUCED,
    "sigma4": REDUCED,
    "time": ANGLES,
    "chi": ANGLES,
    "psi": ANGLES,
    "path": PATH,
    "contact": PATH,
}

# What an integrator must carry for an observable that quadrature would give.
_INTEGRATED = {"theta_min": REDUCED}

LOOSEST = 1e-1
# A passage's rounding is about 1e-13; an integrator's errors of rounding add up over its steps.
TIGHTEST = {"quadrature": 1e-13, "rk4": 1e-11, "rk8": 1e-11, "dopri5": 1e-11, "dop853": 1e-11}

# Error over tolerance at the 99th percentile was measured at 3 to 20 for passages of the uniform
# disk, the hoop and a body with kappa = 10; 1/30 leaves room for other bodies and energies.
_TOLERANCE_SHARE = {"dopri5": 1.0 / 30.0, "dop853": 1.0 / 30.0}
# Error in chi over a passage is about constant * h^order, h in units of 1/speed (uniform disk: 0.03 h^4).
# Ten times what was measured is assumed.
_STEP_ERROR = {"rk4": (0.3, 4), "rk8": (0.3, 8)}
# eta must be known to a hundredth for the direction of the race to be beyond doubt.
_SIDE_SHARE = 0.01
_TOLERANCE_FLOOR = 3e-15
_STEP_RANGE = {"rk4": (1e-3, 0.25), "rk8": (1e-2, 0.6)}


@dataclass(frozen=True)
class Plan:
    """What will be run for a question: the rung, the method, and the reason in words.

    relative_tilt: theta_min is asked for to a relative accuracy, so eta must be known that well.
    slack: how much coarser than the accuracy needs, for error estimates.
    """

    rung: str
    method: str
    accuracy: float
    relative_tilt: bool
    reason: str
    slack: float = 1.0

    @property
    def kernel_method(self) -> int:
        return int(getattr(compiled.steps, self.method.upper()))

    @property
    def kernel_depth(self) -> int:
        field = compiled.field
        return {REDUCED: field.REDUCED, ANGLES: field.ANGLES, PATH: field.PATH}[self.rung]

    @property
    def max_drift(self) -> float:
        """Relative drift of a constant of motion above which a sample is refused."""
        return self.accuracy * self.slack

    def coarser(self, factor: float) -> "Plan":
        """The same with tolerances or steps larger by a factor."""
        return replace(self, slack=self.slack * factor)

    def control(self, states: States, found: Array) -> Array:
        """Tolerance or step for every sample, from its constants of motion (natural units).

        The nearer to F, the better eta must be known: its error is the tolerance times
        sqrt(2 E I1), which is why the share of eta is taken in these units.
        """
        near = np.fmin(abs(found[1]), abs(found[2]))
        tilt = near / np.sqrt(2.0 * states.disk.body.I1 * found[3])
        share = self.accuracy if self.relative_tilt else _SIDE_SHARE
        target = np.fmin(self.accuracy, share * np.fmin(tilt, 1.0))
        return self.slack * _setting(self.method, target)

    @property
    def held_control(self) -> float:
        """Tolerance or step for trajectories that are held to their constants: eta cannot drift."""
        return float(_setting(self.method, np.float64(self.accuracy)))

    @property
    def cost(self) -> str:
        """Expected work per sample in words."""
        if self.rung == ALGEBRA:
            return "one evaluation of Chaplygin's solutions per sample"
        if self.method == "quadrature":
            return "40 to 200 evaluations of the integrand per sample, the same at every distance from F"
        stages = {"rk4": 4, "dopri5": 7}.get(self.method, 12)
        if self.method in FIXED:
            steps = round(10.0 / self.held_control)
        else:
            steps = round(
                40.0 * (1e-6 / self.accuracy) ** 0.2
                if self.method == "dopri5"
                else 12.0 * (1e-6 / self.accuracy) ** 0.125
            )
        return f"about {stages * steps} evaluations of the field per passage, more near F"


def _setting(method: str, target: Any) -> Any:
    """Step (fixed methods) or tolerance (adaptive ones) for an error of `target` per passage."""
    if method in FIXED:
        constant, order = _STEP_ERROR[method]
        return np.clip((target / constant) ** (1.0 / order), *_STEP_RANGE[method])
    return np.clip(target * _TOLERANCE_SHARE[method], _TOLERANCE_FLOOR, None)


def plan(observables: Iterable[str], accuracy: float = 1e-6, method: str = "auto") -> Plan:
    """The lowest rung and the cheapest method that give `observables` to `accuracy`.

    accuracy: absolute error of angles (rad), relative error of times and theta_min.
    Raises InputError for an unknown observable or method, for a method that cannot give them, or for
    an accuracy out of its range.
    """
    asked = tuple(observables)
    if not isinstance(method, str):
        raise InputError(f"--method {method!r} is not a name; known: {', '.join(METHODS)}")
    if isinstance(accuracy, bool) or not isinstance(accuracy, int | float):
        raise InputError(f"--accuracy {accuracy!r} is not a number")
    for name in asked:
        if name not in OBSERVABLES:
            raise InputError(f"observable {name!r} is not known; {_suggest(name, OBSERVABLES)}")
    if method not in METHODS:
        raise InputError(f"--method {method!r} is not known; {_suggest(method, METHODS)}")
    rung, chosen, why = _choose(asked, method)
    if not TIGHTEST[chosen] <= accuracy <= LOOSEST:
        raise InputError(
            f"--accuracy {accuracy} must lie between {TIGHTEST[chosen]:g} and {LOOSEST:g} for {chosen}"
        )
    return Plan(rung, chosen, accuracy, "theta_min" in asked, why)


def _choose(asked: tuple[str, ...], method: str) -> tuple[str, str, str]:
    """(rung, method, reason)."""
    rung = max((OBSERVABLES[name] for name in asked), key=RUNGS.index, default=ALGEBRA)
    deepest = ", ".join(name for name in asked if OBSERVABLES[name] == rung) or "nothing else"
    integrals_only = RUNGS.index(rung) <= RUNGS.index(QUADRATURE)
    if method == "quadrature" and not integrals_only:
        raise InputError(
            f"--method quadrature gives passages and periods, not {deepest}; use auto or an integrator"
        )
    if method == "auto" and integrals_only:
        why = "quadrature because it needs no steps and knows eta exactly"
        return rung, "quadrature", f"{rung} because of {deepest}; {why}"
    if method in ("auto", "quadrature"):
        # The adaptive pair bends its step to each sample's distance from F, which spans decades
        # in any sampling; a fixed step must be small enough throughout the motion.
        chosen = "dopri5" if method == "auto" else method
        why = f"{chosen} because each sample sets its own step near flat" if method == "auto" else "as asked"
        return rung, chosen, f"{rung} because of {deepest}; {why}"
    if rung == QUADRATURE:
        carried = (_INTEGRATED.get(name, ANGLES) for name in asked if OBSERVABLES[name] == QUADRATURE)
        rung = max(carried, key=RUNGS.index)
    return rung, method, f"{rung} because of {deepest}; {method} as asked"


def _suggest(name: str, known: Iterable[str]) -> str:
    names = list(known)
    near = get_close_matches(name, names, n=1)
    return (f"did you mean {near[0]!r}? " if near else "") + f"known: {', '.join(names)}"

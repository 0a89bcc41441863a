"""How statements are checked: the bodies they are tried on, comparisons, and the motions that are judged."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from explorer.motion.plan import plan
from explorer.motion.trajectories import trajectories_by
from explorer.paper import eight_dimensions as plain
from explorer.paper.statement import Finding
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk
from explorer.phase.states import Array, States, phi_to_states

UNIFORM, HOOP, MATCHING = Disk.uniform(), Disk.hoop(), Disk.matching()
THICK = Disk(I1=0.5, I3=0.3, name="thick")  # I3 < 2 I1: not planar
PLANAR = (UNIFORM, HOOP, MATCHING)
BODIES = (*PLANAR, THICK)
# The same bodies, but the thick one has units of its own, so that a forgotten m, r or g shows.
WITH_UNITS = (*PLANAR, Disk(m=2.0, r=0.5, g=9.81, I1=0.25, I3=0.15, name="thick"))
OF_BODIES = "four bodies (uniform, hoop, mr²/I₁ = 3, thick)"
ROUNDING = "rounding of some dozen operations"
EXACT = 1e-11  # accuracy of the passages that statements compare with: as exact as they are known
SOLVER = "two integrations at relative tolerance 1e-11 and 1e-12"
ALL = ("phi", "phidot", "sigma3", "sigma4", "chi", "psi", "path", "contact")

# What a misprinted form gives, by the key of the misprint.
Printed = Mapping[str, Any]


def near(
    computed: str, measured: Any, expected: Any, tolerance: float, reason: str, printed: Printed | None = None
) -> Finding:
    """A Finding whose error is the largest absolute difference of numbers or arrays.

    printed: what the misprinted forms give in place of `measured`.
    """
    off = {where: distance(value, expected) for where, value in (printed or {}).items()}
    error = distance(measured, expected)
    return Finding(computed, _shown(measured), _shown(expected), error, tolerance, reason, off)


def at_most(computed: str, value: float, bound: float, reason: str, printed: Printed | None = None) -> Finding:
    """A Finding for a number that must not exceed a bound, as what a misprinted form gives does."""
    off = {where: float(value) for where, value in (printed or {}).items()}
    return Finding(computed, float(value), f"at most {bound:g}", float(value), bound, reason, off)


def at_least(computed: str, value: float, bound: float, reason: str) -> Finding:
    """A Finding for a number that must not fall below a bound."""
    return Finding(computed, float(value), f"at least {bound:g}", bound - float(value), 0.0, reason)


def _shown(values: Any) -> Any:
    array = np.asarray(values, dtype=float)
    return float(array) if array.ndim == 0 else ", ".join(f"{v:.9g}" for v in array.ravel()[:6])


def distance(one: Any, other: Any) -> float:
    """The largest distance of two arrays, entry by entry; NaN if there is one."""
    return float(np.max(np.abs(np.asarray(one, dtype=float) - np.asarray(other, dtype=float))))


def largest(values: Iterable[float]) -> float:
    """The largest of some numbers; NaN if there is one, where Python's max might pass it over."""
    return float(np.max(list(values)))


def worst(measure: Callable[[Disk], Any]) -> Any:
    """The largest of a distance, or of each of several, over the bodies with units; NaN if there is one."""
    return np.max([measure(disk) for disk in WITH_UNITS], axis=0)


def exponent(x: Any, y: Any) -> float:
    """The slope of ln|y| against ln|x|, least squares."""
    return float(np.polyfit(np.log(abs(np.asarray(x))), np.log(abs(np.asarray(y))), 1)[0])


def logarithmic(eta: Array, away: Array) -> tuple[float, float]:
    """(a, relative size of what is left) of the fit away = a eta ln(1/|eta|) + b eta."""
    terms = np.stack([eta * np.log(1.0 / abs(eta)), eta], axis=1) / abs(eta[:, None])
    scaled = away / abs(eta)
    fitted = np.linalg.lstsq(terms, scaled, rcond=None)[0]
    return float(fitted[0]), float(abs(terms @ fitted - scaled).max() / abs(scaled).max())


def sample(disk: Disk) -> Array:
    """A state (phi, phidot, sigma3, sigma4) that is nowhere special, in the units of the disk."""
    return np.array([0.3, *(np.array([0.8, 0.6, -0.5]) * disk.rate_unit)])


def random_body(rng: np.random.Generator) -> Disk:
    """A body with random m, r, g and moments that eq. (2.3) allows."""
    m, r, g = rng.uniform(0.2, 3.0, 3)
    I1 = m * r * r * rng.uniform(0.1, 1.0)
    return Disk(m=m, r=r, g=g, I1=I1, I3=I1 * rng.uniform(0.2, 2.0))


def random_state(rng: np.random.Generator, disk: Disk, steepest: float = 1.2) -> Array:
    """A random (phi, phidot, sigma3, sigma4) with |phi| < steepest."""
    return np.array([rng.uniform(-steepest, steepest), *(rng.uniform(-1.5, 1.5, 3) * disk.rate_unit)])


def random_ones(seed: int, count: int, steepest: float = 1.2) -> Iterator[tuple[Disk, Array, Array, Array]]:
    """Random bodies, each with a state of its own, and that as (A, omega) of the plain equations."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        disk = random_body(rng)
        state = random_state(rng, disk, steepest)
        yield disk, state, *plain.start(*[*state, *rng.uniform(-3.0, 3.0, 2)])


def observed(
    disk: Disk, start: Any, times: Any, *names: str, accuracy: float = 1e-11, chi0: float = 0.0
) -> list[Any]:
    """Observables of motions integrated by the explorer, each (n, times, ...).

    start: States, or one (phi, phidot, sigma3, sigma4).
    """
    states = start if isinstance(start, States) else phi_to_states(disk, *start)
    how, at = plan(names, accuracy, "dop853"), np.asarray(times, np.float64)
    run = trajectories_by(states.flat, how, at, names, chi0)
    return [getattr(run, name) for name in names]


def followed(disk: Disk, start: Any, times: Any, accuracy: float = 1e-11, chi0: float = 0.0) -> SimpleNamespace:
    """One motion integrated by the explorer with all observables, each (times, ...)."""
    run = observed(disk, start, times, *ALL, accuracy=accuracy, chi0=chi0)
    return SimpleNamespace(**{name: row[0] for name, row in zip(ALL, run, strict=True)})


def near_the_line(disk: Disk, eta_hat: float, face: int = 1, sigma3_bar: float = 1.0) -> States:
    """The start of sections 6 and 7: from the vertical with speed 1 towards `face`, eta_hat beside its line."""
    return constants_to_states(disk, sigma3_bar, eta_hat, 1.0, face)

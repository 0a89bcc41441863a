"""The measure dphi dphidot dsigma3 dsigma4 is invariant under the flow: exactly, and statistically.

"Measure zero" means this measure. Exactly: the derivative of the flow at a fixed time, by the variational
equations, has determinant 1. Statistically: states drawn from it within a bounded energy, an invariant set,
are distributed as before after any time.
"""

from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2_contingency, ks_2samp

from explorer import compiled
from explorer.errors import InputError
from explorer.measure.density import Density
from explorer.measure.laws import either_p
from explorer.measure.sampling import Box, chunk_stream
from explorer.motion.trajectories import simulate
from explorer.phase.disk import Disk
from explorer.phase.states import COORDINATES, Array, States, phi_to_states

_ACCURACY = 1e-6  # of the motions, far below what a test of some thousand states can see
_PARTS = 3  # of each coordinate, in the test of all four together


@dataclass(frozen=True)
class Stretch:
    """The flow's derivative along motions.

    time (n): in the units of the disk. matrix (n, 4, 4): of (phi, phidot, sigma3, sigma4) at that time by the
    same at the start, natural units. determinant (n): 1 for a measure that is invariant. rounding (n): the
    order of what rounding does to it, near flat the flow stretches one way and shrinks another.
    """

    time: Array
    matrix: Array
    determinant: Array
    rounding: Array


def flow_stretch(states: States, steps: int = 200, step: float = 0.05) -> Stretch:
    """Derivative of the flow after `steps` steps of `step` in units of 1/speed; time follows from that.

    Source: the reduced equations (2.15)-(2.18) and their variational equations.
    """
    if not (steps >= 1 and 0.0 < step <= 1.0):
        raise InputError(f"steps = {steps}, step = {step}: give at least one step, 0 < step <= 1")
    n, disk = len(states), states.disk
    matrix, ends = np.empty((n, 4, 4)), np.empty((6, n))
    compiled.variation.variation_batch(states.natural, step, steps, disk.body, matrix, ends)
    matrix[states.status != 0] = np.nan
    size = abs(matrix).max(axis=(1, 2))
    return Stretch(ends[5] * disk.time_unit, matrix, np.linalg.det(matrix), 2.2e-16 * steps * size)


@dataclass(frozen=True)
class Pushed:
    """Two samples of one measure, one of them pushed forward; arrays (4, n), and the p-value that they agree.

    p_values: by coordinate (Kolmogorov-Smirnov) and of all four together (chi-square of cells); p_value: of all.
    failed: motions that could not be followed; they are in no sample.
    """

    still: Array
    pushed: Array
    p_values: dict[str, float]
    p_value: float
    failed: int


def push_forward(
    disk: Disk,
    time: float,
    samples: int = 20_000,
    *,
    energy: float | None = None,
    seed: int = 0,
    twist: float = 0.0,
) -> Pushed:
    """Compare states of energy up to `energy` with others that have moved for `time` (units of the disk).

    energy: default 3 m g r. twist: draws from the measure times (cos phi)^twist instead, which is not
    invariant unless it is 0: a test of the test.
    """
    level = 3.0 * disk.energy_unit if energy is None else energy
    density = energy_density(disk, level, twist)
    still, start = (density.draw(disk, chunk_stream(seed, index), samples) for index in (0, 1))
    states = phi_to_states(disk, **start)
    moved = simulate(disk, states, t_eval=[time], observables=COORDINATES, accuracy=_ACCURACY)
    good = moved.status == 0
    pushed = np.stack([getattr(moved, name)[good, 0] for name in COORDINATES])
    first = np.stack([still[name] for name in COORDINATES])
    p_values = {name: float(ks_2samp(first[i], pushed[i]).pvalue) for i, name in enumerate(COORDINATES)}
    p_values["cells"] = _cells_p(first, pushed)
    return Pushed(first, pushed, p_values, either_p(*p_values.values()), int((~good).sum()))


def energy_density(disk: Disk, energy: float, twist: float = 0.0) -> Density:
    """The measure on the states of energy up to `energy`, in a box that holds them all."""
    b, unit = disk.body, disk.rate_unit
    level = energy / disk.energy_unit
    if not level > 1.0:
        raise InputError(
            f"energy = {energy:g}: give more than m g r = {disk.energy_unit:g}, that of an upright disk"
        )
    reach = [np.sqrt(2.0 * level / inertia) * unit for inertia in (b.M, b.I1, b.J)]
    half_pi = 0.5 * np.pi
    box = Box((-half_pi, half_pi), *((-float(r), float(r)) for r in reach))
    function = None if twist == 0.0 else lambda phi, *_: np.cos(phi) ** twist
    return Density(box, (-np.inf, energy), (), function)


def _cells_p(first: Array, second: Array) -> float:
    """p-value that two samples (4, n) share a distribution, from counts in cells of all four coordinates."""
    together = np.concatenate([first, second], axis=1)
    cell = np.zeros(together.shape[1], np.int64)
    for row in together:
        edges = np.quantile(row, np.arange(1, _PARTS) / _PARTS)
        cell = cell * _PARTS + np.searchsorted(edges, row)
    counts = np.stack([np.bincount(part, minlength=_PARTS**4) for part in np.split(cell, [first.shape[1]])])
    # Cells with few draws are joined: their chi-square is not one.
    few = counts.sum(axis=0) < 20
    joined = np.column_stack([counts[:, ~few], counts[:, few].sum(axis=1)])
    return float(chi2_contingency(joined[:, joined.sum(axis=0) > 0]).pvalue)

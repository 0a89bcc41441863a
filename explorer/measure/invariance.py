"""The measure dphi dphidot dsigma3 dsigma4 is invariant under the flow: exactly, and statistically.

"Measure zero" means this measure. Exactly: the derivative of the flow at a fixed time, by the variational
equations, has determinant 1. Statistically: states drawn from it within a bounded energy, an invariant set,
are distributed as before after any time.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError, number, positive, whole
from explorer.measure.distributions import Distribution
from explorer.measure.sampling import stream_of
from explorer.measure.statistics import either_p
from explorer.motion.threads import attended, blocks
from explorer.motion.trajectories import simulate
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.results import Result
from explorer.phase.states import COORDINATES, Array, States, phi_to_states, require_states

_ACCURACY = 1e-6  # of the motions (rad), far below what a test of some thousand states can see
_FEWEST = 20  # states of a test
_STEPS_AT_ONCE = 200_000  # some tenths of a second; one motion may take more
_MOST_SAMPLES = 10**7  # of a test; their coordinates take a gigabyte
_HIGHEST = 3.0  # energy over m g r, up to which states are drawn unless the user says otherwise


@dataclass(frozen=True, repr=False, eq=False)
class Stretch(Result):
    """The flow's derivative along motions, arrays of the states' shape: what `flow_stretch` returns.

    Attributes
    ----------
    time : array
        Time for which each motion was followed, in the units of the disk.
    matrix : (..., 4, 4) array
        Derivative of (phi, phidot, sigma3, sigma4) at that time with respect to their values at the start, natural
        units. NaN for states that are bad input.
    determinant : array
        1 for a measure that is invariant.
    rounding : array
        Order of magnitude of the determinant's rounding error. It grows near flat, where the flow stretches one
        direction and shrinks another.
    status : array of int8
        `Status` of each state; NOT_FINITE where the numbers overflow on the way.
    states : States
        The states; `to_pandas` and `to_arrow` have their phi, phidot, sigma3 and sigma4 as columns.

    Examples
    --------
    >>> import explorer as ex
    >>> stretch = ex.flow_stretch(ex.phi_to_states(ex.Disk.uniform(), 0.3, 1.0, 1.0, 0.7))
    >>> stretch.matrix.shape, stretch.determinant.round(9)
    ((4, 4), np.float64(1.0))
    """

    time: Array
    matrix: Array
    determinant: Array
    rounding: Array
    status: NDArray[np.int8]
    states: States


def flow_stretch(states: States, steps: int = 200, step: float = 0.05) -> Stretch:
    """Compute the derivative of the flow along motions.

    Parameters
    ----------
    states : States
        Where the motions start.
    steps : int
        Number of integration steps, 1 or more.
    step : float
        Size of an integration step, up to 1. Steps are equal in a variable s with dt = cos(phi) ds, so that they
        are short in time near flat. s is measured in units of 1/B, where B is an upper bound of the rates of the
        motion.

    Returns
    -------
    Stretch

    Raises
    ------
    InputError
        If `steps` or `step` is out of its range.

    References
    ----------
    The reduced equations (2.15)-(2.18) of the paper and their variational equations.

    Examples
    --------
    >>> import explorer as ex
    >>> stretch = ex.flow_stretch(ex.phi_to_states(ex.Disk.uniform(), 0.3, 1.0, 1.0, 0.7))
    >>> round(float(stretch.determinant), 9)
    1.0
    """
    require_states(states)
    steps, step = whole("steps", steps, 1, 2**31 - 1), positive("step", step, 1.0)
    n, disk, code = states.size, states.disk, compiled.status.Status
    matrix, time = np.empty((n, 4, 4)), np.empty(n)
    for rows in blocks(n, max(1, _STEPS_AT_ONCE // steps)):
        start, ends = np.ascontiguousarray(states.natural[:, rows]), np.empty((6, rows.stop - rows.start))
        attended(partial(compiled.variation.variation_batch, start, step, steps, disk.body, matrix[rows], ends))
        time[rows] = ends[compiled.field.ROW.t] * disk.time_unit
    with np.errstate(all="ignore"):
        determinant, size = np.linalg.det(matrix), abs(matrix).max(axis=(1, 2), initial=0.0)
    finite = np.isfinite(time) & np.isfinite(determinant) & np.isfinite(size)
    status = np.where((states.codes == code.OK) & ~finite, code.NOT_FINITE, states.codes).astype(np.int8)
    for found in (time, matrix, determinant, size):
        found[status != code.OK] = np.nan
    return Stretch(time, matrix, determinant, 2.2e-16 * steps * size, status, states).reshaped(states.shape)


@dataclass(frozen=True, repr=False, eq=False)
class Pushed:
    """Two samples of one measure, one of them pushed forward by the flow, and the test that they agree.

    Attributes
    ----------
    still, pushed : (4, n) arrays
        phi (rad), phidot, sigma3, sigma4 (units of the disk) of states that have not moved, and of others
        after the time that was given.
    p_values : dict of str to float
        By coordinate (Kolmogorov-Smirnov).
    p_value : float
        Of all these tests together, after Bonferroni.
    failed : int
        Number of motions that could not be followed; they are in no sample.

    Examples
    --------
    >>> import explorer as ex
    >>> pushed = ex.push_forward(ex.Disk.uniform(), 2.0, samples=500)
    >>> pushed.still.shape[0], pushed.failed, pushed.p_value > 1e-3
    (4, 0, True)
    """

    still: Array
    pushed: Array
    p_values: dict[str, float]
    p_value: float
    failed: int

    def __repr__(self) -> str:
        each = ", ".join(f"{name} {p:.3g}" for name, p in self.p_values.items())
        return (
            f"Pushed: {self.still.shape[1]:,} states still, {self.pushed.shape[1]:,} moved, {self.failed} failed"
            f"\n  p_value: {self.p_value:.3g} ({each})"
        )


def push_forward(
    disk: Disk, time: float, samples: int = 20_000, *, energy: float | None = None, rng: Any = 0
) -> Pushed:
    """Compare states drawn uniformly in phi, phidot, sigma3, sigma4 with others that have moved for some time.

    Parameters
    ----------
    disk : Disk
    time : float
        How long the second sample moves, in the units of the disk.
    samples : int
        States in each sample.
    energy : float, optional
        Only states with at most this energy are drawn; they form an invariant set (units of the disk; by default 3
        m g r).
    rng : int, SeedSequence or Generator
        Seed, or source of the random numbers.

    Returns
    -------
    Pushed

    Raises
    ------
    InputError
        If `energy` does not exceed that of an upright disk at rest, or if rounding leaves unknown where motions
        are at `time`.

    Examples
    --------
    >>> import explorer as ex
    >>> pushed = ex.push_forward(ex.Disk.uniform(), 2.0, 2000)
    >>> pushed.p_value > 0.01, pushed.failed
    (True, 0)
    """
    require_axial_inertia(disk)
    time, random = positive("time", time), stream_of(rng)
    samples = whole("samples", samples, _FEWEST, _MOST_SAMPLES)
    density = energy_density(disk, _HIGHEST * disk.energy_unit if energy is None else number("energy", energy))
    still, start = (density.draw(random, samples) for _ in range(2))
    states = phi_to_states(disk, **start)
    motions = simulate(states, t_eval=[time], observables=COORDINATES, accuracy=_ACCURACY)
    good = motions.status == compiled.status.Status.OK
    if not good.any():
        raise InputError(f"time = {time:g}: rounding leaves unknown where motions are then; give a shorter time")
    pushed = np.stack([getattr(motions, name)[good, 0] for name in COORDINATES])
    first = np.stack([still[name] for name in COORDINATES])
    p_values = {
        name: float(scipy.stats.ks_2samp(first[i], pushed[i]).pvalue) for i, name in enumerate(COORDINATES)
    }
    return Pushed(first, pushed, p_values, either_p(*p_values.values()), int((~good).sum()))


def energy_density(disk: Disk, energy: float) -> Distribution:
    """The measure on the states of energy up to `energy`, in a box that holds them all."""
    b, unit = disk.body, disk.rate_unit
    highest = energy / disk.energy_unit
    if not highest > 1.0:
        raise InputError(
            f"energy = {energy:g}: give more than m g r = {disk.energy_unit:g}, that of an upright disk"
        )
    reach = [np.sqrt(2.0 * highest / inertia) * unit for inertia in (b.M, b.I1, b.J)]
    ends = (0.5 * np.pi, *map(float, reach))
    box = {name: (-end, end) for name, end in zip(COORDINATES, ends, strict=True)}
    return replace(Distribution.box(disk, box), energy=(-np.inf, energy))

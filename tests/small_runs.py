"""Small runs: of race-angles, for what is stored; of measure-zero, for how often intervals contain the truth."""

import numpy as np

from explorer.measure import laws
from explorer.measure.falling_constant import constant_of
from explorer.measure.importance_sampling import NearFallingSet
from explorer.measure.laws import Estimate

SMALL_RACES = {"samples": 3000, "seed": 5, "eta_hat": "1e-4:1e-2", "chunk_size": 512}
DELTAS = np.array([1e-5, 1e-8, 1e-11, 1e-14])


def coverage(density, runs, draws, seed):
    """Shares of `runs` whose 95 % interval holds: of C, of the slope, and of P at the first rung.

    Every run has draws of its own, `draws` for each rung and face. The truth is C by an integral over F.
    """
    constant, near_f = constant_of(density), NearFallingSet(density, 2, 1e-4)
    means, errors = np.empty((DELTAS.size, runs)), np.empty((DELTAS.size, runs))
    random = np.random.default_rng(seed)
    for k, delta in enumerate(DELTAS):
        values, squares = np.zeros(runs), np.zeros(runs)
        for face in (1, -1):
            (found,) = near_f.draw(face, float(delta), random, runs * draws)
            hits = (found.weight * (found.theta_min < delta)).reshape(runs, draws)
            values += hits.mean(axis=1)
            squares += hits.var(axis=1, ddof=1) / draws
        means[k], errors[k] = values, np.sqrt(squares)
    truths = constant.value, 1.0, constant.value * DELTAS[0]
    inside = np.zeros(3)
    for run in range(runs):
        ladder = Estimate(means[:, run], errors[:, run], 2.0 * draws - 2.0)
        for i, found in enumerate((laws.fit_constant(DELTAS, ladder), laws.fit_slope(DELTAS, ladder), ladder[0])):
            low, high = found.interval()
            inside[i] += low <= truths[i] <= high
    return (inside / runs).tolist()

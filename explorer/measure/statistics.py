"""Probabilities and tests from counts, with honest intervals."""

import numpy as np
import scipy  # loads scipy.stats where it is used: it takes a second, and workers never do
from numpy.typing import NDArray


def share(count: int, total: int) -> dict[str, float | list[float]]:
    """A fraction with its exact (Clopper-Pearson) 95 % interval."""
    interval = scipy.stats.binomtest(count, total).proportion_ci(0.95, method="exact")
    return {"value": count / total, "interval_95": [float(interval.low), float(interval.high)]}


def upper_bound(count: int, total: int, confidence: float = 0.95) -> float:
    """The exact one-sided (Clopper-Pearson) upper bound of a probability after `count` of `total`."""
    interval = scipy.stats.binomtest(count, total, alternative="less").proportion_ci(confidence, method="exact")
    return float(interval.high)


def poisson_interval(counts: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Exact (Garwood) 95 % intervals of the means of counts."""
    low = np.where(counts > 0, 0.5 * scipy.stats.chi2.ppf(0.025, np.maximum(2 * counts, 1)), 0.0)
    return low, 0.5 * scipy.stats.chi2.ppf(0.975, 2 * counts + 2)


def either_p(*values: float) -> float:
    """p-value of several tests together, after Bonferroni."""
    return min(1.0, len(values) * min(values))

"""Counts and quantiles of samples, with honest intervals."""

from collections import Counter
from collections.abc import Iterable

import numpy as np
import scipy  # loads scipy.stats where it is used: it takes a second, and workers never do
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.states import Array

QUANTILES = (0.0, 0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)

KERNELS = ("counting.histogram_batch", "counting.sum_batch")  # of what counts samples, for `compiled.warmup`


def count_status(status: Iterable[NDArray[np.int8]]) -> dict[str, int]:
    """Number of samples that ended in each status, for those that occur; names in lower case."""
    Status = compiled.status.Status
    counts = np.bincount(np.concatenate([*status]), minlength=len(Status))
    return {Status(code).name.lower(): int(n) for code, n in enumerate(counts) if n}


def add_counts(parts: Iterable[dict[str, int]]) -> dict[str, int]:
    """Sums of counts by name, in the order of names."""
    total = Counter[str]()
    for part in parts:
        total.update(part)
    return dict(sorted(total.items()))


def histograms(values: Array, groups: NDArray[np.int64], edges: Array, count: int) -> NDArray[np.int32]:
    """Histograms (count, bins + 1) of the finite ones of values by group, 0 ... count - 1; -1 belongs nowhere.

    Edges are equally spaced; what lies outside comes last in each row.
    """
    counts = np.zeros((count, edges.size), np.int32)
    compiled.counting.histogram_batch(values, groups, edges, counts.reshape(-1))
    return counts


def sums(values: Array, groups: NDArray[np.int64], count: int) -> Array:
    """Sums of the finite ones of values by group, as `histograms`: (count, 3), parts that add up to each sum."""
    parts = np.zeros((count, 3))
    compiled.counting.sum_batch(values, groups, parts)
    return parts


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

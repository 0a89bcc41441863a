"""Counts and quantiles of samples, with honest intervals."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from explorer import compiled
from explorer.states import Array

QUANTILES = (0.0, 0.001, 0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)
# The central 68.27 % of a normal distribution: one standard deviation either way.
_ONE_SIGMA = (15.865525393145708, 84.13447460685429)


def count_status(status: Iterable[NDArray[np.int8]]) -> dict[str, int]:
    """How many samples ended in each status that occurs; names in lower case."""
    Status = compiled.status.Status
    counts = np.zeros(len(Status), dtype=np.int64)
    for part in status:
        counts += np.bincount(part, minlength=len(Status))
    return {Status(code).name.lower(): int(n) for code, n in enumerate(counts) if n}


def quantiles(values: Array) -> dict[str, float]:
    """Named quantiles of finite values; empty where there are none."""
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return {}
    found = np.quantile(finite, QUANTILES)
    return {f"{q:g}": float(v) for q, v in zip(QUANTILES, found, strict=True)}


def share(count: int, total: int) -> dict[str, float | list[float]]:
    """A fraction with its exact (Clopper-Pearson) 95 % interval."""
    interval = binomtest(count, total).proportion_ci(0.95, method="exact")
    return {"value": count / total, "interval_95": [float(interval.low), float(interval.high)]}


def half_width(values: Array) -> float:
    """Half the width of the central 68.27 %: the standard deviation of a normal sample, robust to tails."""
    low, high = np.percentile(values, _ONE_SIGMA)
    return float(0.5 * (high - low))

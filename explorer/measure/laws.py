"""Laws P(theta_min < delta) = law(delta): fitted to estimates on a ladder of delta, and tested.

Estimates of the rungs are independent and normal, with an error that is itself estimated (`dof`); counts of
plain draws are binomial. Nothing here is about disks.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer.measure.statistics import either_p
from explorer.phase.arguments import Array

Formula = Callable[[Array], Array]
CONFIDENCE = 0.95  # of intervals, and one less the level at which tests reject
_MANY = 25  # plain hits, enough for a normal distribution
# The wrong laws: a probability of falling, and a relative error of C.
PLATEAU, OFF = 1e-6, 0.02


class Law(NamedTuple):
    """The law P = C delta of small delta: C with its standard error, and from which delta on it holds.

    holds_below: P is within 5 % of C delta there and below, as far as 1e-12; powers of ten are tried.
    """

    constant: float
    error: float
    holds_below: float


@dataclass(frozen=True)
class Estimate:
    """Unbiased estimates with their standard errors, which are known to `dof` degrees of freedom.

    Numbers, or arrays that broadcast together.
    """

    value: Any
    error: Any
    dof: Any = np.inf

    def __getitem__(self, rows: Any) -> "Estimate":
        return Estimate(*(part[rows] for part in np.broadcast_arrays(self.value, self.error, self.dof)))

    def interval(self, confidence: float = CONFIDENCE) -> Array:
        """Two-sided interval of Student's distribution, (..., 2)."""
        reach = self.error * scipy.stats.t.ppf(0.5 + 0.5 * confidence, self.dof)
        return np.stack([self.value - reach, self.value + reach], axis=-1)

    def described(self) -> dict[str, Any]:
        """An estimate of one number, ready for JSON."""
        interval = self.interval().tolist()
        return {"value": float(self.value), "error": float(self.error), "interval_95": interval}


def mean_of_draws(sums: Array, squares: Array, draws: Array) -> Estimate:
    """The mean of independent draws, from the sums of batches of them (..., batches)."""
    count = draws.sum(axis=-1)
    mean = sums.sum(axis=-1) / count
    variance = np.maximum(squares.sum(axis=-1) / count - mean * mean, 0.0)
    return Estimate(mean, np.sqrt(variance / (count - 1.0)), count - 1.0)


def total(parts: Estimate, weights: Any = 1.0, axis: int = -1) -> Estimate:
    """Weighted sums of independent estimates along an axis, degrees of freedom after Welch and Satterthwaite."""
    squares = (weights * parts.error) ** 2
    variance = squares.sum(axis=axis)
    whole = np.expand_dims(variance, axis)
    share = np.divide(squares, whole, out=np.zeros_like(squares), where=whole > 0.0)
    with np.errstate(divide="ignore"):
        dof = 1.0 / (share**2 / parts.dof).sum(axis=axis)
    return Estimate((weights * parts.value).sum(axis=axis), np.sqrt(variance), dof)


def simultaneous(count: int, confidence: float = CONFIDENCE) -> float:
    """The confidence of each of `count` independent intervals for all to hold with `confidence` (Sidak)."""
    return float(confidence ** (1.0 / max(count, 1)))


def fit_constant(delta: Array, ladder: Estimate) -> Estimate:
    """C of P = C delta: the mean over the rungs, whose relative errors are alike."""
    return total(ladder, 1.0 / (delta * delta.size))


def fit_slope(delta: Array, ladder: Estimate) -> Estimate:
    """d ln P / d ln delta by least squares; needs two rungs with positive estimates."""
    x = np.log(delta) - np.log(delta).mean()
    factors = x / (x * x).sum()
    spread = total(ladder, factors / ladder.value)
    return Estimate((factors * np.log(ladder.value)).sum(), spread.error, spread.dof)


def ladder_p(delta: Array, ladder: Estimate, law: Formula, law_error: float = 0.0) -> float:
    """p-value of a law: chi-square of all rungs. law_error: relative, of the law itself."""
    expected = law(delta)
    error = np.hypot(ladder.error, law_error * expected)
    away = abs(ladder.value - expected) / np.maximum(error, 1e-300)
    # As many normal deviations as Student's distribution gives these.
    normal = scipy.stats.norm.isf(scipy.stats.t.sf(away, ladder.dof))
    return float(scipy.stats.chi2.sf((np.minimum(normal, 1e3) ** 2).sum(), delta.size))


def bins_of(delta: Array, law: Formula) -> Array:
    """Probabilities of the disjoint bins that a ladder (falling delta) cuts: ..., (d2, d1], and (0, smallest]."""
    at = law(delta)
    bins: Array = np.maximum(np.append(at[:-1] - at[1:], at[-1]), 0.0)
    return bins


def counts_p(delta: Array, below: NDArray[np.int64], draws: int, law: Formula) -> float:
    """p-value of a law from how many of `draws` lie below each delta: exact tests of bins, after Bonferroni."""
    counts = np.append(below[:-1] - below[1:], below[-1])
    bins = zip(counts, bins_of(delta, law), strict=True)
    each = [scipy.stats.binomtest(int(k), draws, min(p, 1.0)).pvalue for k, p in bins]
    return float(either_p(*each))


def known_laws(constant: float, top: float) -> dict[str, Formula]:
    """The law and those that codimension one rules out, by name. They are compared at delta up to `top`."""
    return {
        "law": lambda delta: constant * delta,
        "dimension_two": lambda delta: constant * delta * (delta / top),
        "plateau": lambda delta: constant * delta + PLATEAU,
        "constant_off": lambda delta: constant * (1.0 + OFF) * delta,
    }


def agreement_p(ladder: Estimate, below: NDArray[np.int64], draws: int) -> float:
    """p-value that a ladder and plain counts estimate the same, whatever the law; all rungs, after Bonferroni."""
    share = np.clip(ladder.value, 1e-300, 1.0)
    spread = np.sqrt(share * (1.0 - share) / draws + ladder.error**2)
    away = (abs(below / draws - ladder.value) / spread)[below >= _MANY]
    return either_p(*(2.0 * scipy.stats.norm.sf(away)).tolist()) if away.size else 1.0

"""Laws P(theta_min < delta) = law(delta): fitted to estimates on a ladder of delta, and tested.

Estimates of the rungs are independent and normal, with an error that is itself estimated (`dof`); counts of
plain draws are binomial. Nothing here is about disks.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer.measure.statistics import either_p

Array = NDArray[np.float64]
Law = Callable[[Array], Array]
CONFIDENCE = 0.95  # of intervals, and one less the level at which tests reject
# Below this many draws a rung and face its mean is not normal enough for the test.
FEWEST = 16
SHAPE_BINS = 20  # of theta_min / delta
# The wrong laws: a probability of falling, and a relative error of C.
PLATEAU, OFF = 1e-6, 0.02
_MOST_PLAIN = 1e15  # plain draws; no run has as many, and counts beyond are no longer exact in doubles


@dataclass(frozen=True)
class Estimate:
    """An unbiased estimate with its standard error, which is known to `dof` degrees of freedom."""

    value: float
    error: float
    dof: float = np.inf

    def interval(self, confidence: float = CONFIDENCE) -> list[float]:
        """Two-sided interval of Student's distribution."""
        reach = self.error * float(scipy.stats.t.ppf(0.5 + 0.5 * confidence, self.dof))
        return [self.value - reach, self.value + reach]


@dataclass(frozen=True)
class Ladder:
    """Independent estimates of P(theta_min < delta), one entry a rung."""

    delta: Array
    value: Array
    error: Array
    dof: Array

    def at(self, rows: NDArray[np.bool_]) -> "Ladder":
        return Ladder(self.delta[rows], self.value[rows], self.error[rows], self.dof[rows])

    def __len__(self) -> int:
        return self.delta.size


def total(parts: Sequence[Estimate], weights: Sequence[float] | Array | None = None) -> Estimate:
    """The weighted sum of independent estimates, degrees of freedom after Welch and Satterthwaite."""
    factors = np.ones(len(parts)) if weights is None else np.asarray(weights)
    squares = np.array([(f * part.error) ** 2 for f, part in zip(factors, parts, strict=True)])
    value = float(sum(f * part.value for f, part in zip(factors, parts, strict=True)))
    variance = float(squares.sum())
    spread = float((squares**2 / np.array([part.dof for part in parts])).sum())
    return Estimate(value, variance**0.5, variance**2 / spread if spread > 0.0 else np.inf)


def simultaneous(count: int, confidence: float = CONFIDENCE) -> float:
    """The confidence of each of `count` independent intervals for all to hold with `confidence` (Sidak)."""
    return float(confidence ** (1.0 / max(count, 1)))


def fit_constant(ladder: Ladder) -> Estimate:
    """C of P = C delta: the mean over the rungs, whose relative errors are alike."""
    parts = _estimates(ladder, ladder.delta)
    return total(parts, np.full(len(parts), 1.0 / len(parts)))


def fit_slope(ladder: Ladder) -> Estimate:
    """d ln P / d ln delta by least squares; needs two rungs with positive estimates."""
    x = np.log(ladder.delta) - np.log(ladder.delta).mean()
    factors = x / (x * x).sum()
    spread = total(_estimates(ladder, ladder.value), factors)
    return Estimate(float((factors * np.log(ladder.value)).sum()), spread.error, spread.dof)


def _estimates(ladder: Ladder, unit: Array) -> list[Estimate]:
    return [
        Estimate(float(v / u), float(e / u), float(d))
        for v, e, d, u in zip(ladder.value, ladder.error, ladder.dof, unit, strict=True)
    ]


def ladder_p(ladder: Ladder, law: Law, law_error: float = 0.0) -> float:
    """p-value of a law: chi-square of all rungs. law_error: relative, of the law itself."""
    expected = law(ladder.delta)
    error = np.hypot(ladder.error, law_error * expected)
    away = abs(ladder.value - expected) / np.maximum(error, 1e-300)
    # As many normal deviations as Student's distribution gives these.
    normal = scipy.stats.norm.isf(scipy.stats.t.sf(away, ladder.dof))
    return float(scipy.stats.chi2.sf((np.minimum(normal, 1e3) ** 2).sum(), len(ladder)))


def bins_of(delta: Array, law: Law) -> Array:
    """Probabilities of the disjoint bins that a ladder (falling delta) cuts: ..., (d2, d1], and (0, smallest]."""
    at = law(delta)
    bins: Array = np.maximum(np.append(at[:-1] - at[1:], at[-1]), 0.0)
    return bins


def counts_p(delta: Array, below: NDArray[np.int64], draws: int, law: Law) -> float:
    """p-value of a law from how many of `draws` lie below each delta: exact tests of bins, after Bonferroni."""
    counts = np.append(below[:-1] - below[1:], below[-1])
    bins = zip(counts, bins_of(delta, law), strict=True)
    each = [scipy.stats.binomtest(int(k), draws, min(p, 1.0)).pvalue for k, p in bins]
    return float(either_p(*each))


def draws_to_reject(delta: Array, law: Law, truth: Law, variance: float, power: float = 0.95) -> int:
    """Draws a rung for `ladder_p` to fall below 5 % with probability `power` where `truth` is the law.

    variance: relative, of one draw. The noncentral chi-square distribution gives the least shift.
    """
    from scipy.optimize import brentq

    threshold = scipy.stats.chi2.isf(1.0 - CONFIDENCE, delta.size)
    shift = brentq(lambda x: scipy.stats.ncx2.sf(threshold, delta.size, x) - power, 1e-6, 1e4)
    each = float((((truth(delta) / law(delta)) - 1.0) ** 2).sum())
    return max(FEWEST, int(np.ceil(shift * variance / each)))


def plain_draws_to_reject(delta: Array, law: Law, truth: Law, power: float = 0.95) -> float:
    """The same for `counts_p` and plain draws; infinite where 10^15 of them are too few."""
    nulls, trues = bins_of(delta, law), bins_of(delta, truth)
    tail = 0.5 * (1.0 - CONFIDENCE) / delta.size

    def missed(draws: float) -> float:
        binom = scipy.stats.binom
        low, high = binom.ppf(tail, draws, nulls), binom.isf(tail, draws, nulls)
        inside = binom.cdf(high, draws, trues) - np.where(low > 0, binom.cdf(low - 1, draws, trues), 0.0)
        return float(np.prod(inside))

    few, many = 1.0, _MOST_PLAIN
    if missed(many) > 1.0 - power:
        return np.inf
    while many > few + 1.0 and many > few * 1.001:
        middle = np.ceil((few * many) ** 0.5)
        few, many = (few, middle) if missed(middle) <= 1.0 - power else (middle, many)
    return float(many)


def wrong_laws(constant: float, top: float) -> dict[str, Law]:
    """Laws that codimension one rules out, by name. They are compared at delta up to `top`."""
    return {
        "dimension_two": lambda delta: constant * delta * (delta / top),
        "plateau": lambda delta: constant * delta + PLATEAU,
        "constant_off": lambda delta: constant * (1.0 + OFF) * delta,
    }

"""What scene measure-zero makes of its sums: estimates, fits, tests and how the probability splits."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from explorer.measure import laws, statistics
from explorer.measure.falling_constant import weight_on_f
from explorer.measure.invariance import flow_stretch, push_forward
from explorer.measure.laws import SHAPE_BINS, Estimate, Ladder, Law, wrong_laws
from explorer.measure.sampling import chunk_stream
from explorer.phase.states import Array, phi_to_states
from explorer.scenes.base import Tally
from explorer.scenes.measure_zero_draws import Question

FEWEST_HITS = 50  # worth of equal weight in a rung; with fewer its interval is not to be trusted
_MANY = 25  # plain hits, enough for a normal distribution
_ROUGHLY = 1e-4  # relative error of the predicted shares of energies, below those of the draws
# For the invariance of the measure: states, their stream, and a time in natural units.
_FOLLOWED, _INVARIANCE, _LATER = 256, (1 << 40) + 1, 5.0


@dataclass(frozen=True)
class Tubes:
    """Sums of the batches of every tube: arrays (rungs, 2 faces, batches, ...), face +1 first."""

    by_batches: bool
    draws: Array
    sum: Array
    squares: Array
    sum_eta_positive: Array
    hits: Array
    unresolved: Array
    energy: Array
    energy_squares: Array
    tilt: Array
    tilt_squares: Array

    @classmethod
    def of(cls, tallies: list[Tally], rungs: int, by_batches: bool) -> "Tubes":
        columns = {}
        for name in _COLUMNS:
            values = np.array([tally[name] for tally in tallies], np.float64)
            columns[name] = values.reshape(rungs, 2, -1, *values.shape[1:])
        return cls(by_batches, **columns)

    def first(self, batches: int) -> "Tubes":
        """Only the first batches of every tube."""
        return Tubes(self.by_batches, **{name: getattr(self, name)[:, :, :batches] for name in _COLUMNS})

    def estimate(self, rung: int, face: int) -> Estimate:
        """P(theta_min < delta) at one face."""
        return self.mean(self.sum[rung, face], self.squares[rung, face], self.draws[rung, face])

    def mean(self, sums: Array, squares: Array, draws: Array) -> Estimate:
        """Mean of the draws of all batches; of Sobol points the batches, each a scramble, tell the error."""
        count = float(draws.sum())
        mean = math.fsum(sums) / count
        if self.by_batches:
            each = sums / draws
            spread = float(((each - each.mean()) ** 2).sum()) / max(each.size - 1, 1)
            return Estimate(mean, math.sqrt(spread / each.size), max(each.size - 1, 1))
        variance = max(math.fsum(squares) / count - mean * mean, 0.0)
        return Estimate(mean, math.sqrt(variance / max(count - 1.0, 1.0)), max(count - 1.0, 1.0))

    def rung(self, rung: int) -> Estimate:
        """P(theta_min < delta), both faces."""
        return laws.total([self.estimate(rung, face) for face in (0, 1)])

    def ladder(self, delta: Array) -> Ladder:
        rungs = [self.rung(rung) for rung in range(delta.size)]
        columns = zip(*((e.value, e.error, e.dof) for e in rungs), strict=True)
        return Ladder(delta, *(np.array(column) for column in columns))

    def effective_size(self, rung: int) -> float:
        """Hits of equal weight that would say as much: (sum of weights)^2 / sum of their squares."""
        squares = math.fsum(self.squares[rung].ravel())
        return math.fsum(self.sum[rung].ravel()) ** 2 / squares if squares > 0.0 else 0.0


_COLUMNS = tuple(Tubes.__annotations__)[1:]


@dataclass(frozen=True)
class Counted:
    """All chunks together. below: hits of the plain draws, (rungs, 4); race: ways of the races of these hits."""

    status: dict[str, int]
    falls: int
    below: NDArray[np.int64]
    race: dict[str, int]
    tubes: Tubes

    @classmethod
    def of(cls, question: Question, tallies: list[Tally]) -> "Counted":
        plain = [tally for tally in tallies if tally["kind"] == "plain"]
        batches = [tally for tally in tallies if tally["kind"] == "tube"]
        return cls(
            status=statistics.add_counts(tally["status"] for tally in tallies),
            falls=sum(tally["status"].get("falls", 0) for tally in plain),
            below=np.sum([tally["hits"] for tally in plain], axis=0),
            race={key: sum(tally["race"][key] for tally in plain) for key in plain[0]["race"]},
            tubes=Tubes.of(batches, question.deltas.size, question.scrambled),
        )


def summarise(question: Question, total: Counted) -> dict[str, Any]:
    """The numbers of summary.json; without enough hits slope and constant are None, and there are no tests."""
    tubes, below, constant = total.tubes, total.below, question.constant
    summary: dict[str, Any] = {
        "samples": question.samples,
        "falls": total.falls,
        "upper_bound_95": statistics.upper_bound(total.falls, question.samples),
        "status": total.status,
        "constant_predicted": constant.value,
        "constant_predicted_error": constant.error,
        "ladder": _rows(question, tubes, below),
        "invariance": _invariance(question),
        "race": total.race,
        "slope": None,
        "constant": None,
    }
    ladder = tubes.ladder(question.deltas)
    tested = ladder.at(question.tested)
    enough = all(row["effective_sample_size"] >= FEWEST_HITS for row in summary["ladder"])
    if not (constant.value > 0.0 and enough):
        return summary
    summary["slope"] = _described(laws.fit_slope(tested))
    summary["constant"] = _described(laws.fit_constant(tested))
    summary["law_limit"] = question.law_limit
    summary |= _tests(question, tested, below.sum(axis=1))
    summary["power"] = _power(question, tubes)
    summary["p_value_counts_against_tubes"] = _agreement(question, ladder, below.sum(axis=1))
    summary["splits"] = _splits(question, tubes, ladder)
    summary["convergence"] = _convergence(question, tubes)
    if question.scrambled:
        summary["sobol_gain"] = _gain(question, tubes)
    return summary


def _invariance(question: Question) -> dict[str, float]:
    """Whether the measure is one: the flow's determinant, and states pushed forward."""
    start = question.source.draw(question.disk, chunk_stream(question.seed, _INVARIANCE), _FOLLOWED)
    stretch = flow_stretch(phi_to_states(question.disk, **start))
    time = _LATER * question.disk.time_unit
    return {
        "determinant_error": float(np.nanmax(abs(stretch.determinant - 1.0))),
        "determinant_rounding": float(np.nanmax(stretch.rounding)),
        "push_forward_p_value": push_forward(question.disk, time, seed=question.seed).p_value,
    }


def _described(estimate: Estimate) -> dict[str, Any]:
    return {"value": estimate.value, "error": estimate.error, "interval_95": estimate.interval()}


def _rows(question: Question, tubes: Tubes, below: NDArray[np.int64]) -> list[dict[str, Any]]:
    """The ladder: counts of plain draws with exact intervals, and estimates from the tubes."""
    level = laws.simultaneous(question.deltas.size)
    rows = []
    for k, delta in enumerate(question.deltas):
        count, estimate = int(below[k].sum()), tubes.rung(k)
        # A draw whose tilt is not known may be a hit or not.
        unknown = math.fsum((tubes.unresolved[k] / tubes.draws[k].sum(axis=1, keepdims=True)).ravel())
        rows.append(
            {
                "delta": float(delta),
                "count": count,
                "plain": statistics.share(count, question.samples),
                "estimate": estimate.value,
                "error": estimate.error,
                "interval_95": _widened(estimate.interval(), unknown),
                "interval_95_simultaneous": _widened(estimate.interval(level), unknown),
                "tube_draws": int(tubes.draws[k].sum()),
                "tube_hits": int(tubes.hits[k].sum()),
                "effective_sample_size": tubes.effective_size(k),
                "unresolved": unknown,
                "predicted": question.constant.value * float(delta),
            }
        )
    return rows


def _widened(interval: list[float], unknown: float) -> list[float]:
    return [max(interval[0], 0.0), interval[1] + unknown]


def _tests(question: Question, tested: Ladder, below: NDArray[np.int64]) -> dict[str, Any]:
    """p-values of the law and of wrong ones: from tubes, from plain counts, and the one that can tell."""
    constant = question.constant
    counts = below[question.tested]
    known: dict[str, Law] = {"law": lambda delta: constant.value * delta}
    known |= wrong_laws(constant.value, float(tested.delta[0]))
    apart: dict[str, dict[str, float]] = {"tubes": {}, "counts": {}}
    for name, law in known.items():
        apart["tubes"][name] = laws.ladder_p(tested, law, constant.error / constant.value)
        apart["counts"][name] = laws.counts_p(tested.delta, counts, question.samples, law)
    # Tubes hold what is beside F. Falls anywhere else are for plain draws to find.
    headline = {name: apart["counts" if name == "plateau" else "tubes"][name] for name in known}
    return {"p_value": headline, "p_value_tubes": apart["tubes"], "p_value_counts": apart["counts"]}


def _agreement(question: Question, ladder: Ladder, below: NDArray[np.int64]) -> float:
    """p-value that plain counts and tubes estimate the same, whatever the law; of all rungs, after Bonferroni."""
    share = np.clip(ladder.value, 1e-300, 1.0)
    spread = np.sqrt(share * (1.0 - share) / question.samples + ladder.error**2)
    many = below >= _MANY
    away = abs(below / question.samples - ladder.value)[many] / spread[many]
    return float(min(1.0, 2.0 * many.sum() * scipy.stats.norm.sf(away.max(initial=0.0)))) if many.any() else 1.0


def _relative_variance(tubes: Tubes, rungs: NDArray[np.intp]) -> float:
    """Relative variance of one draw of a tube with both faces taken in turn, mean over the rungs."""
    each = []
    for rung in rungs:
        estimate, draws = tubes.rung(int(rung)), tubes.draws[rung].sum()
        each.append((estimate.error / estimate.value) ** 2 * draws)
    return float(np.mean(each))


def _power(question: Question, tubes: Tubes) -> dict[str, Any]:
    """Draws with which the test rejects a wrong law, at 5 %, with probability 95 %."""
    rungs = np.flatnonzero(question.tested)
    delta, constant = question.deltas[rungs], question.constant.value
    variance = _relative_variance(tubes, rungs)

    def right(delta: Array) -> Array:
        return constant * delta

    power: dict[str, Any] = {"relative_variance_of_a_draw": variance}
    for name, law in wrong_laws(constant, float(delta[0])).items():
        beside = delta.size * laws.draws_to_reject(delta, right, law, variance)
        power[name] = {
            "tube_draws": None if name == "plateau" else beside,
            "plain_draws": _finite(laws.plain_draws_to_reject(delta, right, law)),
        }
    return power


def _splits(question: Question, tubes: Tubes, ladder: Ladder) -> dict[str, Any]:
    """By face, sign of eta, energy, and tilt; all shares of the rungs of the law but for the sign of eta."""
    rungs = np.flatnonzero(question.tested)
    unit = question.deltas[rungs]
    faces = []
    for face in (0, 1):
        parts = [tubes.estimate(int(rung), face) for rung in rungs]
        faces.append(laws.total(parts, 1.0 / (unit * unit.size)))
    both = laws.total(faces)
    error = math.hypot(faces[1].value * faces[0].error, faces[0].value * faces[1].error) / both.value**2
    plus = Estimate(faces[0].value / both.value, error, both.dof)
    return {
        "face_plus": {**_described(plus), "predicted": question.constant.plus / question.constant.value},
        "eta_positive": _signs(question, tubes, ladder),
        "energy": _by_energy(question, tubes, rungs),
        "tilt": _by_tilt(tubes, question.deltas, rungs),
    }


def _signs(question: Question, tubes: Tubes, ladder: Ladder) -> list[dict[str, Any]]:
    """(P(eta > 0) - P(eta < 0)) / P, rung by rung, and how much P itself is off C delta."""
    rows = []
    for k, delta in enumerate(question.deltas):
        # The sum over draws of +-weight has the same squares as that of weight.
        net = 2.0 * tubes.sum_eta_positive[k] - tubes.sum[k]
        signed = [tubes.mean(net[s], tubes.squares[k, s], tubes.draws[k, s]) for s in (0, 1)]
        asymmetry = laws.total(signed, np.full(2, 1.0 / ladder.value[k]))
        unit = question.constant.value * delta
        off = Estimate(ladder.value[k] / unit - 1.0, ladder.error[k] / unit)
        rows.append(
            {
                "delta": float(delta),
                "asymmetry": asymmetry.value,
                "asymmetry_interval_95": asymmetry.interval(),
                "correction": off.value,
                "correction_interval_95": off.interval(),
            }
        )
    return rows


def _shares(tubes: Tubes, name: str, unit: Array, rungs: NDArray[np.intp]) -> tuple[Array, Array]:
    """Shares of the bins of a histogram of weights, and their standard errors.

    Rungs count alike, whatever their delta. A share is a ratio: its error is that of (1 in the bin) - share.
    """
    scale = unit[:, None, None, None]
    sums = getattr(tubes, name)[rungs] / scale
    squares = getattr(tubes, f"{name}_squares")[rungs] / scale**2
    bins, total = sums.sum(axis=(0, 1, 2)), sums.sum()
    share = bins / total
    own = squares.sum(axis=(0, 1, 2))
    variance = own * (1.0 - 2.0 * share) + share**2 * own.sum()
    return share, np.sqrt(np.maximum(variance, 0.0)) / total


def _by_energy(question: Question, tubes: Tubes, rungs: NDArray[np.intp]) -> list[dict[str, Any]]:
    edges = question.energy_edges
    if not edges.size:
        return []
    share, error = _shares(tubes, "energy", question.deltas[rungs], rungs)
    low, high = question.source.energy
    below = [0.0]
    for edge in edges:
        part = weight_on_f(question.disk, replace(question.source, energy=(low, float(edge))), _ROUGHLY)
        below.append(part / (question.constant.value * question.constant.mass))
    ends = [low, *map(float, edges), high]
    return [
        {
            "energy_from": _finite(ends[i]),
            "energy_to": _finite(ends[i + 1]),
            "share": float(share[i]),
            "error": float(error[i]),
            "predicted": predicted,
        }
        for i, predicted in enumerate(np.diff([*below, 1.0]).tolist())
    ]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _by_tilt(tubes: Tubes, delta: Array, rungs: NDArray[np.intp]) -> dict[str, Any]:
    """theta_min / delta of the hits: uniform, if the density of theta_min is constant near 0."""
    share, error = _shares(tubes, "tilt", delta[rungs], rungs)
    expected = 1.0 / SHAPE_BINS
    with np.errstate(divide="ignore", invalid="ignore"):
        squares = np.where(error > 0.0, ((share - expected) / error) ** 2, 0.0)
    statistic = float(squares.sum()) * (1.0 - expected)
    return {
        "share": share.tolist(),
        "error": error.tolist(),
        "predicted": expected,
        "p_value": float(scipy.stats.chi2.sf(statistic, SHAPE_BINS - 1)),
    }


def _convergence(question: Question, tubes: Tubes) -> list[dict[str, Any]]:
    """C from the first 1, 2, 4 ... batches of every tube."""
    batches, rows = tubes.draws.shape[2], []
    rungs = question.tested
    counts = [2**j for j in range(30) if 2**j < batches] + [batches]
    for count in counts:
        if question.scrambled and count < 4:
            continue
        some = tubes.first(count)
        constant = laws.fit_constant(some.ladder(question.deltas).at(rungs))
        rows.append({"draws": int(some.draws[rungs].sum()), **_described(constant)})
    return rows


def _gain(question: Question, tubes: Tubes) -> float:
    """Variance of independent draws over that of Sobol points, the same number of each; over the law's rungs."""
    alone = replace(tubes, by_batches=False)
    variance = []
    for kind in (alone, tubes):
        ladder = kind.ladder(question.deltas).at(question.tested)
        variance.append(float(((ladder.error / ladder.value) ** 2).mean()))
    return variance[0] / variance[1]

"""Fits and tests of laws: on ladders drawn from a law that is known."""

from functools import cache

import numpy as np
import pytest
import scipy

from explorer.measure import laws
from explorer.measure.laws import Estimate

C = 1.5
DELTA = 10.0 ** -np.arange(4.0, 16.0)
KNOWN = laws.known_laws(C, DELTA[0])
RIGHT = KNOWN["law"]


def drawn(law, draws, variance, random, runs=1):
    """Ladders as tubes give them, were `law` true: means of `draws` weights with a given relative variance."""
    error = RIGHT(DELTA) * np.sqrt(variance / draws)
    values = law(DELTA) + error * random.standard_normal((runs, DELTA.size))
    return [Estimate(value, error, draws - 1.0) for value in values]


def test_the_slope_and_constant_of_an_exact_ladder_are_exact():
    exact = Estimate(RIGHT(DELTA), 1e-3 * RIGHT(DELTA))
    assert laws.fit_slope(DELTA, exact).value == pytest.approx(1.0, abs=1e-14)
    assert laws.fit_constant(DELTA, exact).value == pytest.approx(C, rel=1e-14)
    assert laws.ladder_p(DELTA, exact, RIGHT) == pytest.approx(1.0)


def test_intervals_of_slope_and_constant_cover_at_their_level():
    random = np.random.default_rng(5)
    inside = np.zeros(2)
    for ladder in drawn(RIGHT, 400, 0.5, random, 2000):
        for i, (fit, truth) in enumerate(((laws.fit_slope, 1.0), (laws.fit_constant, C))):
            low, high = fit(DELTA, ladder).interval()
            inside[i] += low <= truth <= high
    assert ((inside / 2000 > 0.935) & (inside / 2000 < 0.965)).all()


def test_p_values_of_the_right_law_are_uniform():
    random = np.random.default_rng(6)
    p = np.array([laws.ladder_p(DELTA, ladder, RIGHT) for ladder in drawn(RIGHT, 400, 0.5, random, 2000)])
    assert abs((p < 0.05).mean() - 0.05) < 0.015
    assert abs(p.mean() - 0.5) < 0.03


@pytest.mark.parametrize(("name", "draws"), [("dimension_two", 16), ("plateau", 16), ("constant_off", 3233)])
def test_draws_in_tubes_reject_the_law_were_another_one_true(name, draws):
    random = np.random.default_rng(7)

    def rejected(law):
        ladders = drawn(law, draws, 0.6, random, 400)
        return np.mean([laws.ladder_p(DELTA, ladder, RIGHT) < 0.05 for ladder in ladders])

    assert rejected(KNOWN[name]) > 0.92
    assert rejected(RIGHT) < 0.09


@pytest.mark.parametrize(
    ("name", "draws"), [("dimension_two", 1_022_752), ("plateau", 2_987_509), ("constant_off", 372_927_805)]
)
def test_plain_draws_reject_the_law_were_another_one_true(name, draws, monkeypatch):
    # Most bins hold few draws: the same tests again and again.
    monkeypatch.setattr(scipy.stats, "binomtest", cache(scipy.stats.binomtest))
    random = np.random.default_rng(8)

    def rejected(law):
        p = []
        for _ in range(80):
            counts = random.multinomial(draws, [*laws.bins_of(DELTA, law), 1.0 - law(DELTA[0])])[:-1]
            below = np.cumsum(counts[::-1])[::-1]
            p.append(laws.counts_p(DELTA, below, draws, RIGHT))
        return np.mean(np.array(p) < 0.05)

    assert rejected(KNOWN[name]) > 0.9
    assert rejected(RIGHT) < 0.08


def test_one_fall_in_ten_million_draws_rejects_the_law_and_counts_at_their_expectation_do_not():
    below = np.round(1e7 * RIGHT(DELTA)).astype(np.int64)
    assert laws.counts_p(DELTA, np.maximum(below, 1), 10**7, RIGHT) < 1e-6
    assert laws.counts_p(DELTA, below, 10**7, RIGHT) > 0.5


def test_intervals_of_many_rungs_hold_together():
    level = laws.simultaneous(15)
    assert level**15 == pytest.approx(0.95)
    low, high = Estimate(1.0, 0.1).interval(level)
    assert low == pytest.approx(1.0 - 0.1 * 2.927, abs=1e-3)
    assert high - 1.0 == pytest.approx(1.0 - low)


def test_few_degrees_of_freedom_widen_an_interval():
    assert Estimate(0.0, 1.0, 15).interval()[1] == pytest.approx(2.131, abs=1e-3)
    together = laws.total(Estimate(np.array([1.0, 2.0]), np.ones(2), 15))
    assert together.value == 3.0
    assert together.error == pytest.approx(2**0.5)
    assert together.dof == pytest.approx(30.0)


@pytest.mark.parametrize("scale", [1.0, 1e-103])
def test_totals_of_rungs_are_those_of_each_however_small(scale):
    error = scale * np.array([[1.0, 2.0], [0.0, 0.0]])
    found = laws.total(Estimate(error, error, np.array([[10.0, 20.0], [5.0, 5.0]])))
    np.testing.assert_allclose(found.error / scale, [5**0.5, 0.0])
    np.testing.assert_allclose(found.dof, [25.0 / (1.0 / 10.0 + 16.0 / 20.0), np.inf])


def test_the_error_of_equal_batches_is_that_of_their_spread_or_of_the_draws():
    sums, draws = np.array([1.0, 2.0, 3.0, 4.0]), np.full(4, 100.0)
    independent = laws.mean_of_draws(sums, sums, draws)
    assert independent.value == pytest.approx(0.025)
    assert independent.error == pytest.approx(np.sqrt((0.025 - 0.025**2) / 399))
    assert independent.dof == 399

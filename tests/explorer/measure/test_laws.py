"""Fits and tests of laws: on ladders drawn from a law that is known."""

from functools import cache

import numpy as np
import pytest
import scipy

from explorer.measure import laws
from explorer.measure.laws import Estimate, Ladder, wrong_laws

C = 1.5
DELTA = 10.0 ** -np.arange(4.0, 16.0)


def right(delta):
    return C * delta


def drawn(law, draws, variance, random, runs=1):
    """Ladders as tubes give them, were `law` true: means of `draws` weights with a given relative variance."""
    mean = law(DELTA)
    error = right(DELTA) * np.sqrt(variance / draws)
    values = mean + error * random.standard_normal((runs, DELTA.size))
    return [Ladder(DELTA, value, error, np.full(DELTA.size, draws - 1.0)) for value in values]


def test_the_slope_and_constant_of_an_exact_ladder_are_exact():
    exact = Ladder(DELTA, right(DELTA), 1e-3 * right(DELTA), np.full(DELTA.size, np.inf))
    assert laws.fit_slope(exact).value == pytest.approx(1.0, abs=1e-14)
    assert laws.fit_constant(exact).value == pytest.approx(C, rel=1e-14)
    assert laws.ladder_p(exact, right) == pytest.approx(1.0)


def test_intervals_of_slope_and_constant_cover_at_their_level():
    random = np.random.default_rng(5)
    inside = np.zeros(2)
    for ladder in drawn(right, 400, 0.5, random, 2000):
        for i, (fit, truth) in enumerate(((laws.fit_slope, 1.0), (laws.fit_constant, C))):
            low, high = fit(ladder).interval()
            inside[i] += low <= truth <= high
    assert ((inside / 2000 > 0.935) & (inside / 2000 < 0.965)).all()


def test_p_values_of_the_right_law_are_uniform():
    random = np.random.default_rng(6)
    p = np.array([laws.ladder_p(ladder, right) for ladder in drawn(right, 400, 0.5, random, 2000)])
    assert abs((p < 0.05).mean() - 0.05) < 0.015
    assert abs(p.mean() - 0.5) < 0.03


@pytest.mark.parametrize("name", ["dimension_two", "plateau", "constant_off"])
def test_the_draws_that_are_said_to_reject_a_wrong_law_do(name):
    """Were the wrong law true, the test rejects the right one with about the power asked for."""
    truth = wrong_laws(C, DELTA[0])[name]
    variance = 0.6
    draws = laws.draws_to_reject(DELTA, right, truth, variance)
    random = np.random.default_rng(7)
    rejected = np.mean(
        [laws.ladder_p(ladder, right) < 0.05 for ladder in drawn(truth, draws, variance, random, 400)]
    )
    assert rejected > 0.92
    if draws > laws.FEWEST:
        fewer = drawn(truth, draws // 4, variance, random, 400)
        assert np.mean([laws.ladder_p(ladder, right) < 0.05 for ladder in fewer]) < 0.7


@pytest.mark.parametrize("name", ["dimension_two", "plateau", "constant_off"])
def test_the_plain_draws_that_are_said_to_reject_a_wrong_law_do(name, monkeypatch):
    # Most bins hold few draws: the same tests again and again.
    monkeypatch.setattr(scipy.stats, "binomtest", cache(scipy.stats.binomtest))
    truth = wrong_laws(C, DELTA[0])[name]
    draws = int(laws.plain_draws_to_reject(DELTA, right, truth))
    random = np.random.default_rng(8)

    def share(draws, law):
        p = []
        for _ in range(80):
            counts = random.multinomial(draws, [*laws.bins_of(DELTA, law), 1.0 - law(DELTA[0])])[:-1]
            below = np.cumsum(counts[::-1])[::-1]
            p.append(laws.counts_p(DELTA, below, draws, right))
        return np.mean(np.array(p) < 0.05)

    assert share(draws, truth) > 0.9
    assert share(draws // 5, truth) < 0.8
    assert share(draws, right) < 0.08


def test_one_fall_in_ten_million_draws_rejects_the_law():
    below = np.maximum(np.round(1e7 * right(DELTA)), 1).astype(np.int64)
    assert laws.counts_p(DELTA, below, 10**7, right) < 1e-6


def test_counts_at_their_expectation_do_not():
    below = np.round(1e7 * right(DELTA)).astype(np.int64)
    assert laws.counts_p(DELTA, below, 10**7, right) > 0.5


def test_intervals_of_many_rungs_hold_together():
    level = laws.simultaneous(15)
    assert level**15 == pytest.approx(0.95)
    low, high = Estimate(1.0, 0.1).interval(level)
    assert low == pytest.approx(1.0 - 0.1 * 2.927, abs=1e-3)
    assert high - 1.0 == pytest.approx(1.0 - low)


def test_few_degrees_of_freedom_widen_an_interval():
    assert Estimate(0.0, 1.0, 15).interval()[1] == pytest.approx(2.131, abs=1e-3)
    together = laws.total([Estimate(1.0, 1.0, 15), Estimate(2.0, 1.0, 15)])
    assert together.value == 3.0
    assert together.error == pytest.approx(2**0.5)
    assert together.dof == pytest.approx(30.0)

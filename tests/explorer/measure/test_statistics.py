"""Counts with their intervals."""

import numpy as np
import pytest
from scipy.stats import beta

import explorer as ex
from explorer.measure.statistics import either_p, poisson_interval, share, upper_bound
from explorer.measure.tallies import histograms
from explorer.phase.results import count_status


def test_statuses_are_counted_by_name_and_only_those_that_occur():
    assert count_status(np.array([ex.Status.OK, ex.Status.FALLS, ex.Status.OK], np.int8)) == {"ok": 2, "falls": 1}


@pytest.mark.parametrize(("count", "total"), [(0, 10), (3, 100), (100, 100)])
def test_a_share_has_its_exact_interval(count, total):
    """Clopper and Pearson's, by quantiles of the beta distribution."""
    low = beta.ppf(0.025, count, total - count + 1) if count else 0.0
    high = beta.ppf(0.975, count + 1, total - count) if count < total else 1.0
    found = share(count, total)
    assert found["value"] == count / total
    assert found["interval_95"] == pytest.approx([low, high])


def test_after_no_event_the_bound_is_that_of_the_rule_of_three():
    assert upper_bound(0, 10**6) == pytest.approx(-np.log(0.05) / 1e6, rel=1e-5)
    assert upper_bound(0, 10**6, 0.99) > upper_bound(0, 10**6)


def test_several_tests_together_are_no_more_certain_than_all_of_them():
    assert either_p(0.2, 0.01, 0.7) == pytest.approx(0.03)
    assert either_p(0.9, 0.8) == 1.0


def test_intervals_of_counts_are_the_exact_ones():
    """At the ends 2.5 % of Poisson variables reach the count; Garwood's table for 0 and 10."""
    low, high = poisson_interval(np.array([0, 10]))
    np.testing.assert_allclose(low, [0.0, 4.7954], atol=1e-4)
    np.testing.assert_allclose(high, [3.6889, 18.3904], atol=1e-4)


def test_groups_have_histograms_of_their_own():
    values, groups = np.array([0.5, 1.5, 9.0, 0.5, np.nan]), np.array([0, 1, 1, -1, 0])
    assert histograms(values, groups, np.array([0.0, 1.0, 2.0]), 2).tolist() == [[1, 0, 0], [0, 1, 1]]

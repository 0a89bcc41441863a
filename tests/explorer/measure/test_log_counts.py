"""Counts in logarithmic bins: sums, quantiles and what JSON keeps of them."""

import json

import numpy as np
import pytest

from explorer.measure.log_counts import (
    PER_DECADE,
    LogCounts,
    LogRows,
    SignedLogCounts,
    pack,
    unpack,
)

VALUES = np.exp(np.random.default_rng(1).standard_normal(5000) * 4.0)
SHARES = [0.0, 0.01, 0.3, 0.5, 0.99, 1.0]


def test_quantiles_are_good_to_a_bin():
    counts = LogCounts.of(VALUES)
    for share in SHARES:
        exact = np.quantile(VALUES, share, method="inverted_cdf")
        assert counts.quantile(share) == pytest.approx(exact, rel=1.01 * np.log(10.0) / PER_DECADE)
    assert (counts.quantile(0.0), counts.quantile(1.0)) == (VALUES.min(), VALUES.max())


@pytest.mark.parametrize("kind", [LogCounts, SignedLogCounts])
def test_parts_add_up_in_any_order_and_survive_json(kind):
    signed = VALUES * np.where(np.arange(VALUES.size) % 3, 1.0, -1.0) if kind is SignedLogCounts else VALUES
    whole = kind.of(signed)
    parts = [kind(json.loads(json.dumps(kind.of(part).state()))) for part in np.array_split(signed, 7)]
    for order in (parts, parts[::-1]):
        total = kind()
        for part in order:
            total.add(part)
        assert total.state() == whole.state()
        assert [total.quantile(share) for share in SHARES] == [whole.quantile(share) for share in SHARES]


def test_zeros_are_counted_and_nan_and_infinity_are_not():
    counts = LogCounts.of(np.array([0.0, 0.0, np.nan, np.inf, 1.0, 10.0]))
    assert (counts.total, counts.zeros) == (4, 2)
    assert counts.quantile(0.4) == 0.0
    assert counts.quantile(0.9) == pytest.approx(10.0, rel=0.01)
    assert np.isnan(LogCounts().quantile(0.5))
    assert LogCounts().quantiles() == {}


def test_signed_quantiles_and_width_are_those_of_a_normal_sample():
    sample = np.random.default_rng(2).standard_normal(100_000)
    counts = SignedLogCounts.of(sample)
    assert counts.quantile(0.5) == pytest.approx(0.0, abs=0.01)
    assert counts.quantile(0.1) == pytest.approx(-1.2816, abs=0.02)
    assert counts.half_width() == pytest.approx(1.0, abs=0.02)


def test_packed_codes_come_back():
    codes = np.arange(1000, dtype=np.uint16) ** 2
    np.testing.assert_array_equal(unpack(pack(codes)), codes)


def test_groups_are_counted_each_as_by_itself():
    rng = np.random.default_rng(4)
    values = np.concatenate([VALUES * rng.choice([1.0, -1.0], VALUES.size), [0.0, 0.0, np.nan, np.inf, 1.0, 1.0]])
    groups = np.concatenate([rng.integers(-3, 2, VALUES.size), [-3.0, 1.0, 0.0, 0.0, np.nan, np.inf]])
    found = SignedLogCounts.by_group(values, groups)
    assert list(found) == [-3, -2, -1, 0, 1]
    for group, counts in found.items():
        assert counts.state() == SignedLogCounts.of(values[(groups == group) & np.isfinite(values)]).state()
    rows = LogRows()
    assert rows.counts() == {}
    for part in np.array_split(np.argsort(abs(values)), 7):  # each reaches further than those before it
        rows.add(values[part], groups[part])
    assert {n: c.state() for n, c in rows.counts().items()} == {n: c.state() for n, c in found.items()}
    assert not any(counts.total for counts in SignedLogCounts.by_group(np.ones(2), np.full(2, np.nan)).values())
    assert not any(counts.total for counts in SignedLogCounts.by_group(np.zeros(0), np.zeros(0)).values())

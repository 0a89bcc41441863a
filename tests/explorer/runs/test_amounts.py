"""Sizes and times in the units that people read."""

import pytest

from explorer.runs.amounts import duration, size


@pytest.mark.parametrize(
    ("count", "text"), [(0, "0 B"), (950, "950 B"), (999_600, "1 MB"), (83.6e12, "83.6 TB"), (5e18, "5e+03 PB")]
)
def test_sizes_have_three_digits_and_a_unit(count, text):
    assert size(count) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(1.25, "1.2 s"), (600, "10 min"), (30_000, "8 h"), (953_236, "11 days"), (1e9, "11,574 days")],
)
def test_times_are_in_seconds_to_days(seconds, text):
    assert duration(seconds) == text

"""Counts in one pass, against NumPy's."""

import numpy as np
import pytest

from kernels.disk.counting import Sizes, histogram_batch, log_count_batch

PER_DECADE = 10
RANDOM = np.random.default_rng(5)
VALUES = np.concatenate(
    [
        RANDOM.standard_normal(5000) * 10.0 ** RANDOM.uniform(-6, 1, 5000),
        [0.0, -0.0, np.nan, np.inf, -np.inf, 1e-3],
    ]
)
GROUPS = RANDOM.integers(-1, 3, VALUES.size)


def test_a_place_outside_the_row_writes_nowhere():
    counts, zeros, ends = np.zeros(4, np.int64), np.zeros(2, np.int64), np.zeros((2, 2))
    places = np.array([-1.0, 0.0, 1.5, 2.0, 1e300])
    log_count_batch(Sizes(np.ones(5), places, np.zeros(5)), 0, 0, counts, zeros, ends)
    assert counts.tolist() == [0, 0, 1, 1]
    groups = np.array([-1.0, 1.0, np.inf, -np.inf, np.nan])
    log_count_batch(Sizes(np.ones(5), np.ones(5), groups), 0, 0, counts, zeros, ends)
    assert counts.tolist() == [0, 0, 1, 1]


@pytest.mark.parametrize("bins", [3, 585])
def test_a_histogram_has_the_bins_of_numpy_also_at_their_edges(bins):
    edges = np.linspace(-1.7, 1.7, bins + 1)
    values = np.concatenate([VALUES, edges, np.nextafter(edges, 9.0), np.nextafter(edges, -9.0)])
    groups = np.concatenate([GROUPS, np.zeros(3 * edges.size, np.int64)])
    counts = np.zeros((3, bins + 1), np.int32)
    histogram_batch(values, groups, edges, counts.reshape(-1))
    for group in range(3):
        chosen = values[(groups == group) & np.isfinite(values)]
        np.testing.assert_array_equal(counts[group, :bins], np.histogram(chosen, edges)[0])
        assert counts[group, bins] == (abs(chosen) > edges[-1]).sum()

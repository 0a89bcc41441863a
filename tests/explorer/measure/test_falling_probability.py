"""P(theta_min < delta): what is counted of draws, and what becomes of the counts."""

import numpy as np
import pytest

from explorer.measure.density import Density
from explorer.measure.falling_probability import FallingProbability
from explorer.phase.disk import Disk

DELTAS = 10.0 ** -np.arange(1.0, 7.0)
DISK = Disk.uniform()


@pytest.fixture(scope="module")
def probability():
    return FallingProbability(DISK, Density.of(DISK), DELTAS, 1e-6, 5000, 0)


def drawn(probability, rung, count=512):
    return probability.draw(1, float(DELTAS[rung]), np.random.default_rng(rung), count)


def test_plain_draws_are_counted_between_rungs_and_those_whose_tilt_is_not_known_as_below_none(probability):
    counts = probability.below(np.array([0.0, 1e-7, 1e-6, 5e-6, 0.02, 0.1, 1.0, np.nan]))
    assert counts.tolist() == [2, 2, 0, 0, 0, 1, 3]


def test_the_sums_of_a_batch_are_those_of_its_hits_by_each_split(probability):
    draws = drawn(probability, 2)
    hit = draws.weight * (draws.theta_min < DELTAS[2])
    batch = probability.batch(2, 1, draws)
    assert batch["hits"] == np.count_nonzero(hit) > 0
    assert batch["sign"][0][1] == pytest.approx(hit[draws.eta_hat > 0.0].sum())
    for split in ("sign", "tilt"):
        sums, squares = batch[split]
        assert sum(sums) == pytest.approx(hit.sum())
        assert sum(squares) == pytest.approx((hit**2).sum())


def test_the_law_is_tested_where_its_next_term_is_small(probability):
    assert probability.law_limit <= 1e-4
    np.testing.assert_array_equal(probability.tested, probability.law_limit >= DELTAS)


def test_the_order_of_batches_of_several_tubes_does_not_matter(probability):
    batches = [probability.batch(rung, face, drawn(probability, rung)) for rung in range(6) for face in (1, -1)]
    counts = np.arange(7)
    ladders = [probability.summary(counts, 0, each)["ladder"] for each in (batches, batches[::-1])]
    assert ladders[0] == ladders[1]
    assert [row["count"] for row in ladders[0]] == [15, 10, 6, 3, 1, 0]
    assert [row["tube_draws"] for row in ladders[0]] == [1024] * 6

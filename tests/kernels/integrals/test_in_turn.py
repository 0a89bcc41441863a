"""Whole rows of groups: an answer does not depend on who stands beside a sample."""

import numpy as np
import pytest
from conftest import BODIES

from kernels.integrals import passages
from kernels.integrals.in_turn import in_turn
from kernels.integrals.sums import LANES
from kernels.status import Status


@pytest.mark.parametrize(
    ("group", "n", "follow"),
    [
        (np.arange(LANES) + 5, LANES, True),
        (np.arange(LANES), LANES - 1, False),
        (2 * np.arange(LANES), LANES, False),
        (np.append(np.arange(LANES - 1), LANES), LANES, False),
    ],
)
def test_a_group_is_in_turn_where_it_is_full_and_leaves_nobody_out(group, n, follow):
    assert in_turn(group, n) == follow


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-11])
def test_passages_are_the_same_in_every_digit_with_gaps_between_them(accuracy):
    """Some of the first grade fail at these distances, so both ways into the results meet in one group."""
    disk, rng, n = BODIES["uniform"], np.random.default_rng(4), 40 * LANES
    eta = 10.0 ** rng.uniform(-6.0, 0.0, n) * disk.body.I3 * disk.body.r0
    crossings = passages.Crossings(rng.uniform(-2.0, 2.0, n), eta, rng.uniform(0.05, 2.0, n))
    kernel = passages.rough_batch if accuracy > 1e-4 else passages.passage_batch
    found, code = np.zeros((3, 8, n)), np.zeros((3, n), np.int8)
    code[1, ::2], code[2, 1::2] = Status.BAD_INPUT, Status.BAD_INPUT
    for out, status in zip(found, code, strict=True):
        kernel(crossings, accuracy, disk.tables, disk.natural, out, status)
    assert 0.5 < np.isfinite(found[0, 0]).mean() < 1.0
    np.testing.assert_array_equal(found[0], np.where(code[1] == Status.OK, found[1], found[2]))
    assert np.isnan(found[1][:, ::2]).all()


@pytest.mark.parametrize("accuracy", [0.0, 1e-3])
def test_falls_are_the_same_in_every_digit_with_gaps_between_them(accuracy):
    disk, rng, n = BODIES["hoop"], np.random.default_rng(5), 40 * LANES
    bar, moving = rng.uniform(-2.0, 2.0, n), 10.0 ** rng.uniform(-4.0, 0.5, n)
    found, gap = np.zeros((3, 4, n)), np.arange(n) % 2
    for out, left_out in zip(found, (gap < 0, gap == 0, gap == 1), strict=True):
        level = np.where(left_out, -1.0, moving + 1.0 + bar**2)
        departures = passages.Departures(bar, level, moving, np.full(n, 1e-16))
        passages.fall_batch(departures, accuracy, disk.tables, disk.natural, out)
    assert np.isfinite(found[0, 0]).any()
    np.testing.assert_array_equal(found[0], np.where(gap == 1, found[1], found[2]))

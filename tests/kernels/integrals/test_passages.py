"""Batches of passages: each sample by itself, a status for every failure."""

import numpy as np
import pytest
from conftest import BODIES
from passing import batch, draw

import explorer as ex
from kernels.integrals.passages import lanes_in_line


@pytest.mark.parametrize("accuracy", [1e-9, 1e-4, 1e-3])
def test_a_sample_does_not_depend_on_its_neighbours_or_its_lane(accuracy):
    rng = np.random.default_rng(5)
    samples = draw(rng, 999, True)
    out, status = batch(BODIES["uniform"], *samples, accuracy, True)
    order = rng.permutation(999)
    again, again_status = batch(BODIES["uniform"], *(column[order] for column in samples), accuracy, True)
    assert np.array_equal(again, out[:, order], equal_nan=True)
    assert np.array_equal(again_status, status[order])
    one = batch(BODIES["uniform"], *(column[17:18] for column in samples), accuracy, True)[0]
    assert np.array_equal(one[:, 0], out[:, 17], equal_nan=True)


def test_bad_neighbours_change_nothing():
    samples = [np.ascontiguousarray(column) for column in draw(np.random.default_rng(6), 64, False)]
    disk = BODIES["hoop"]
    good, _ = batch(disk, *samples, 1e-9, True)
    for column, value in zip(samples, (1e200, 1e300, 1e160), strict=True):
        spoiled = [c.copy() for c in samples]
        spoiled[[c is column for c in samples].index(True)][::7] = value
        out, status = batch(disk, *spoiled, 1e-9, True)
        rest = np.arange(64) % 7 != 0
        assert np.array_equal(out[:, rest], good[:, rest])
        assert (status[~rest] != 0).all() or np.isfinite(out[:, ~rest]).all()


def test_samples_on_f_fall():
    disk, one = BODIES["uniform"], np.ones(4)
    found = ex.passages(disk, one, [1e-3, 0.0, np.nan, 0.0], one)
    assert found.status.tolist() == [ex.Status.OK, ex.Status.FALLS, ex.Status.BAD_INPUT, ex.Status.FALLS]
    assert np.isnan(found.delta_chi).tolist() == [False, True, True, True]


def test_a_window_that_the_motion_does_not_reach_is_bad_input():
    found = ex.passages(BODIES["uniform"], 1.0, 2.0, 1.0, window=1e-3)
    assert found.status[0] == ex.Status.BAD_INPUT
    assert np.isnan(found.delta_chi[0])


def test_lanes_begin_where_a_line_of_the_cache_does():
    kept = [lanes_in_line(n) for n in (1, 100, 101, 5000)]
    assert [room.size for room in kept] == [1, 100, 101, 5000]
    assert all(room.ctypes.data % 64 == 0 and (room == 1.0).all() for room in kept)

"""Rows of arrays are the fields of NamedTuples, on both sides of the wall."""

import numpy as np

from kernels.disk.constants import Constants
from kernels.disk.field import ROW, State
from kernels.disk.rows import put


def test_a_record_that_is_put_into_a_column_is_found_again_by_its_names():
    out = np.full((6, 3), -1.0)
    record = Constants(*np.arange(1.0, 7.0))
    put(record, out, 1)
    there = Constants(*out)
    for name in Constants._fields:
        np.testing.assert_array_equal(getattr(there, name), [-1.0, getattr(record, name), -1.0])


def test_an_array_with_fewer_rows_takes_the_first_fields():
    out = np.empty((8, 1))
    put(State(*np.arange(10.0)), out, 0)
    np.testing.assert_array_equal(out[:, 0], np.arange(8.0))
    assert out[ROW.chi, 0] == 6.0

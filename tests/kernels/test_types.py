"""Types of arguments: what mypy is told is what numba is told."""

import numba
import numpy as np
import pytest

from kernels import types
from kernels._jit import numba_type
from kernels.disk.body import Body, Disk, make_disk
from kernels.steps.events import TIME, Stops

ARRAYS = {
    types.Vector: np.empty(2),
    types.Matrix: np.empty((2, 2)),
    types.Table: np.empty((2, 2, 2)),
    types.Codes: np.empty(2, np.int8),
    types.Counts: np.empty(2, np.int32),
    types.Longs: np.empty(2, np.int64),
    types.Words: np.empty(2, np.uint64),
}


@pytest.mark.parametrize("alias", ARRAYS)
def test_an_alias_names_the_array_that_numba_sees(alias):
    assert numba_type(alias) == numba.typeof(ARRAYS[alias])


@pytest.mark.parametrize(
    ("annotation", "value"),
    [(float, 1.0), (int, 1), (bool, True), (Body, make_disk(0.25, 0.5).body), (Disk, make_disk(0.25, 0.5)),
     (Stops, Stops(TIME, np.ones(2)))],
)  # fmt: skip
def test_numbers_and_named_tuples_are_known_by_their_annotations(annotation, value):
    assert numba_type(annotation) == numba.typeof(value)

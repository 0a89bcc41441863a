"""Chunks in a folder and in memory say the same, and none may be missing."""

import numpy as np
import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.runs import store
from explorer.runs.chunks import add_up, tables


def test_a_run_in_memory_is_the_run_in_a_folder(finished):
    held = ex.run("race-angles", **SMALL_RACES)
    assert held.folder is None
    assert held.summary == finished.summary
    for one, other in zip(tables(held.parts), tables(finished.parts), strict=True):
        assert list(one) == list(other)
        assert all(np.array_equal(one[name], other[name]) for name in one)


def test_a_missing_chunk_is_counted_with_the_remedy(finished):
    store.found_chunks(finished.folder)[2].unlink()
    with pytest.raises(ex.RunError, match=r"1 of 5 chunks are missing; continue with: ex\.open\(.*\)\.resume\(\)"):
        add_up(finished.parts)
    with pytest.raises(ex.RunError, match="1 of 5 chunks are missing"):
        next(finished.tables())

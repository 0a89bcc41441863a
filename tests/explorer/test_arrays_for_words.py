"""What is compared with words, or with nothing, may be given an array by mistake."""

import numpy as np
import pandas as pd
import pytest

import explorer as ex

ARRAYS = {
    "numbers": np.array([1, 2, 3]),
    "words": np.array(["a", "b"]),
    "one number": np.array([[1.0]]),
    "masked": np.ma.masked,
    "a column": pd.Series([1.0, 2.0]),
    "a frame": pd.DataFrame({"a": [1, 2]}),
    "arrays": (np.array([1, 2]), np.array([3, 4])),
}
DISK = ex.Disk.uniform()
CALLS = {
    "scene of run": lambda given: ex.run(given),
    "scene of plan": lambda given: ex.plan(given),
    "disk": lambda given: ex.run("race-angles", disk=given),
    "states": lambda given: ex.run("falling-set", states=given),
    "start": lambda given: ex.run("race-angles", start=given),
    "box": lambda given: ex.run("race-angles", box=given),
    "method": lambda given: ex.run("race-angles", method=given),
    "format": lambda given: ex.run("race-angles", samples=10, format=given),
    "out": lambda given: ex.run("race-angles", samples=10, out=given),
    "box of C": lambda given: ex.falling_constant(DISK, given),
    "event": lambda given: ex.probability(DISK, event=given, tilt=0.5, precession=1.0, spin=1.0),
    "event by name": lambda given: ex.probability(DISK, event=(given, 1e-3), tilt=0.5, precession=1.0, spin=1.0),
    "slice": lambda given: ex.slice_map(DISK, given),
    "columns": lambda given: ex.run("race-angles", samples=10).frame(given),
    "picture": lambda given: ex.picture(given),
}


@pytest.mark.parametrize("kind", ARRAYS)
@pytest.mark.parametrize("name", CALLS)
def test_an_array_in_the_place_of_a_word_or_a_table_is_refused_in_words(name, kind):
    with pytest.raises(ex.InputError):
        CALLS[name](ARRAYS[kind])

"""Counts of chunks are what scenes give, and nothing else is: kinds, bounds, lengths."""

import copy
import json

import pytest
from fuzz.forged import NUMBERS
from small_runs import SMALL_RACES

from explorer.scenes.registry import build_scene
from explorer.scenes.tallies import CountError, Counts

ASKED = {
    "race-angles": SMALL_RACES,
    "falling-set": {"samples": 60},
    "measure-zero": {"samples": 200, "tube": 64},
}


def tally_of(scene):
    return json.loads(json.dumps(scene.process(0)[1]))


def places(value, path=()):
    """Where something stands, of entries that are alike the first with numbers."""
    for key, each in value.items() if isinstance(value, dict) else ():
        yield (*path, key)
        if path[:1] not in (("decades",), ("constants",)) or key == next(iter(value)):
            yield from places(each, (*path, key))


def changed(tally, path, *values):
    """The tally with another value in a place, or without it."""
    again = copy.deepcopy(tally)
    owner = again
    for key in path[:-1]:
        owner = owner[key]
    del owner[path[-1]]
    if values:
        owner[path[-1]] = values[0]
    return again


NONE = (10**400, True, None, "A" * 1000, [10**400] * 3, {"nonsense": 100}, -5, 10**18)
# Any finite number may stand there, and the length of a packed map is looked at when it is unpacked.
FREE = dict.fromkeys(("sum", "squares", "sum_eta_positive", "unresolved"), (-5, 10**18))
FREE |= {"first": (-5,), "plane": ("A" * 1000,)}


@pytest.mark.parametrize("name", ASKED)
def test_what_a_scene_counts_is_accepted_and_what_is_no_count_is_not(name):
    scene = build_scene(name, **ASKED[name])
    tally = tally_of(scene)
    scene.check_tally(0, tally)
    for path in places(tally):
        for value in NONE:
            if not any(value is each or value == each for each in FREE.get(path[-1], ())):
                with pytest.raises(ValueError, match=r".") as caught:
                    scene.check_tally(0, changed(tally, path, value))
                assert len(str(caught.value)) < 250, path
        if path[0] != "constants":  # of steps it may have any
            with pytest.raises(ValueError, match=r"."):
                scene.check_tally(0, changed(tally, path))


def test_numbers_that_are_none_are_no_counts():
    counts = Counts(100)
    for value in NUMBERS:
        with pytest.raises(CountError):
            counts.count("x", value)
    assert (counts.count("x", 0), counts.count("x", 100)) == (0, 100)


def test_names_of_entries_are_whole_numbers_within_bounds():
    counts = Counts(1)
    assert counts.whole("x", "-12", -400, 400) == -12
    for text in ("", "-", "1.0", "²", "9" * 5000, "401", "00000000000000500", "--1", " 1"):
        with pytest.raises(CountError):
            counts.whole("x", text, -400, 400)


def test_bins_are_bounded_over_all_counts_of_a_chunk():
    """A hundred bytes may span a quarter of a million bins."""
    wide = {"first": -130_000, "gaps": "4" + "oPcDAA==", "counts": "1AQE=", "zeros": 0, "range": [1e-300, 1e300]}
    counts = Counts(1000)
    for _ in range(64):
        counts.log_counts("x", wide)
    with pytest.raises(CountError, match="span more than"):
        counts.log_counts("x", wide)

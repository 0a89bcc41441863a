"""What users say about a run beside its question."""

import numpy as np
import pytest

import explorer as ex
from explorer.runs.settings import MOST_IN_MEMORY, asked, read_rng
from explorer.scenes.registry import build_scene


def test_random_numbers_are_named_as_numpy_names_them():
    """SPEC 7: an int, a SeedSequence and a Generator; the int is the seed of the command line."""
    assert read_rng("rng", 7) == read_rng("rng", np.random.SeedSequence(7)) == 7
    children = np.random.SeedSequence(7).spawn(2)
    assert len({7, *(read_rng("rng", child) for child in children)}) == 3
    drawn = [read_rng("rng", np.random.default_rng(7)) for _ in range(2)]
    assert drawn[0] == drawn[1] < 2**128
    for wrong in ("a lot", -1, 1.5, True, [1, 2]):
        with pytest.raises(ex.InputError, match="or a SeedSequence or Generator of numpy"):
            read_rng("rng", wrong)
    assert asked("race-angles", {"rng": 7}).scene == build_scene("race-angles", seed=7)
    with pytest.raises(ex.InputError, match="say the same"):
        asked("race-angles", {"rng": 7, "seed": 7})


def test_small_runs_of_python_have_no_folder_and_those_of_the_command_line_have(capsys):
    small, large = {"samples": MOST_IN_MEMORY}, {"samples": MOST_IN_MEMORY + 1}
    assert asked("race-angles", small).out is None
    assert asked("race-angles", large).out.name == "race-angles-uniform-0"
    assert "a run above 1,000,000 samples is stored: it is in results" in capsys.readouterr().err
    assert asked("race-angles", small, "nearflat run race-angles").out.name == "race-angles-uniform-0"


def test_pictures_may_be_left_out_and_have_other_formats():
    assert asked("portrait", {}).manner.formats is None
    assert asked("portrait", {"figures": False}).manner.formats == ()
    assert asked("portrait", {"format": "pdf"}).manner.formats == ("pdf",)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"exist": "maybe"}, "exist 'maybe' is not known; known: resume, replace, error"),
        ({"figures": "no"}, "figures = no must be true or false"),
        ({"out": 3}, "out = 3 is no path"),
        ({"progress": "yes"}, "progress = yes must be true or false"),
        ({"memory": "lots"}, "memory 'lots' is no amount"),
        ({"jobs": 1.5}, "jobs = 1.5 must be a whole number"),
        ({"format": "gif"}, "'gif' is no format"),
    ],
)
def test_what_makes_no_sense_is_named_in_python_words(given, message):
    with pytest.raises(ex.InputError, match=message):
        asked("race-angles", given)

"""One run at a time in a folder."""

import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.runs.lock import only_one


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_lives(finished):
    with only_one(finished.folder), pytest.raises(ex.InputError, match="another run is at work"):
        ex.run("race-angles", out=finished.folder, **SMALL_RACES)
    ex.run("race-angles", out=finished.folder, **SMALL_RACES)

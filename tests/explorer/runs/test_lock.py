"""One run at a time in a folder."""

import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.runs.lock import only_one


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_lives(finished):
    with only_one(finished.folder), pytest.raises(ex.InputError, match="another run is at work"):
        ex.run("race-angles", out=finished.folder, **SMALL_RACES)
    ex.run("race-angles", out=finished.folder, **SMALL_RACES)


def test_a_lock_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / ".lock").mkdir()
    with pytest.raises(ex.InputError, match=r"\.lock: cannot be the lock of a run"), only_one(tmp_path):
        pass

"""One run at a time in a folder."""

import os

import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.runs.lock import only_one


def test_a_second_run_in_the_same_folder_is_refused_while_the_first_lives(finished):
    with only_one(finished.folder), pytest.raises(ex.InputError, match="another run is at work"):
        ex.run("race-angles", out=finished.folder, **SMALL_RACES)
    ex.run("race-angles", out=finished.folder, **SMALL_RACES)


@pytest.mark.skipif(os.name != "posix", reason="links and pipes are those of POSIX")
@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_a_lock_that_is_no_plain_file_is_neither_written_nor_waited_for(kind, tmp_path):
    """Also where it was put there after the folder was checked."""
    lock, foreign = tmp_path / ".lock", tmp_path / "foreign"
    foreign.write_text("do not lose me")
    {"link": lambda: lock.symlink_to(foreign), "pipe": lambda: os.mkfifo(lock), "folder": lock.mkdir}[kind]()
    with pytest.raises(ex.InputError, match=r"\.lock: cannot be the lock of a run"), only_one(tmp_path):
        pass
    assert foreign.read_text() == "do not lose me"

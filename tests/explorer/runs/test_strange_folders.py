"""Folders of runs in which strangers left something: named in a sentence, put aside, never hung upon."""

import json
import os
from pathlib import Path

import pyarrow.parquet
import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.runs import store
from explorer.runs.inspect import verify


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="pipes with names are those of POSIX")
@pytest.mark.parametrize("name", ["run.json", "summary.json", "chunk"])
def test_a_pipe_in_place_of_a_file_of_a_run_hangs_nothing(finished, name, capsys):
    path = store.found_chunks(finished.folder)[0] if name == "chunk" else finished.folder / name
    path.unlink()
    os.mkfifo(path)
    expected = {"run.json": 2, "summary.json": 1, "chunk": 1}[name]
    assert main(["verify", str(finished.folder)]) == expected
    said = capsys.readouterr()
    assert len((said.out + said.err).splitlines()) <= 2


def test_a_disk_whose_name_leads_elsewhere_is_refused(finished, capsys):
    record = finished.folder / "run.json"
    content = json.loads(record.read_text("utf-8"))
    content["identity"]["options"]["disks"][0]["name"] = "../../up"
    record.write_text(json.dumps(content), "utf-8")
    assert main(["resume", str(finished.folder)]) == 2
    assert "is no name" in capsys.readouterr().err


DIGEST = "0123456789abcdef"
NO_NUMBERS = ("chunk-00000\u0663", "chunk-99999999999999999999", "chunk-0000003", "chunk-000099", "chunk-000003")


@pytest.mark.parametrize("name", NO_NUMBERS)
@pytest.mark.parametrize("make", ["file", "folder"])
def test_what_has_nearly_the_name_of_a_chunk_is_put_aside(finished, name, make, capsys):
    """Digits of other scripts, numbers beyond the end, and folders."""
    before, path = finished.summary, finished.folder / "chunks" / f"{name}-{DIGEST}.parquet"
    if make == "folder":
        path.mkdir()
    else:
        path.write_bytes(store.found_chunks(finished.folder)[2].read_bytes())
    assert any(path.name in fault for fault in verify(finished.folder))
    capsys.readouterr()
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert f"{path.name}: " in capsys.readouterr().err
    assert (finished.folder / "bad" / path.name).exists()
    assert verify(finished.folder) == []
    assert ex.open(finished.folder).summary == before


def test_only_digits_of_ours_make_the_name_of_a_chunk():
    numbers = [store.number_of(Path(f"{name}-{DIGEST}.parquet")) for name in NO_NUMBERS]
    assert numbers == [None, None, None, 99, 3]
    assert store.number_of(Path(f"chunk-1234567-{DIGEST}.parquet")) == 1_234_567


@pytest.mark.parametrize("command", ["verify", "resume", "summary", "status"])
def test_a_folder_in_the_place_of_a_summary_is_named_with_what_to_do(finished, command, capsys):
    path = finished.folder / "summary.json"
    path.unlink()
    path.mkdir()
    assert main([command, str(finished.folder)]) == 2
    assert f"{path}: it is a folder, and a run writes a file of that name; move it away" in capsys.readouterr().err


def test_a_chunk_that_says_nothing_of_itself_is_named(finished):
    path = store.found_chunks(finished.folder)[1]
    pyarrow.parquet.write_table(pyarrow.table({"phi": [0.1]}), path)
    with pytest.raises(ex.RunError, match="its metadata do not say which chunk it is"):
        store.read_note(path)

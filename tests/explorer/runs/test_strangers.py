"""Files that strangers left: refused in a sentence before they are used, whatever they are."""

import importlib
import json
import os
import time

import pytest

import explorer as ex
from explorer.commands.main import main
from explorer.runs import store
from explorer.runs.strangers import StrangeError, check_kinds, parquet_file, parse_json, plain_file


def test_a_link_a_folder_and_too_large_a_file_are_refused(tmp_path):
    (tmp_path / "file").write_bytes(b"12345")
    assert plain_file(tmp_path / "file", 5) == tmp_path / "file"
    with pytest.raises(StrangeError, match="has 5 bytes; 4 is the most"):
        plain_file(tmp_path / "file", 4)
    with pytest.raises(StrangeError, match="no plain file"):
        plain_file(tmp_path)
    (tmp_path / "link").symlink_to(tmp_path / "file")
    with pytest.raises(StrangeError, match="may lie outside"):
        plain_file(tmp_path / "link")


def test_json_is_an_object_of_bounded_depth():
    assert parse_json('{"a": [1]}') == {"a": [1]}
    for text in ("[" * 100_000, '{"a":' * 50 + "1" + "}" * 50, "[1]", "null"):
        with pytest.raises(StrangeError):
            parse_json(text)


def test_entries_are_of_their_kind_and_no_others():
    check_kinds({"index": 1}, {"index": int})
    for wrong in ({"index": True}, {"index": "1"}, {}, {"index": 1, "more": 2}):
        with pytest.raises(StrangeError):
            check_kinds(wrong, {"index": int})


def test_a_gigabyte_of_zeros_is_refused_at_once(tmp_path):
    with (tmp_path / "zeros").open("wb") as file:
        file.truncate(1 << 30)
    importlib.import_module("pyarrow.parquet")
    start = time.process_time()
    with pytest.raises(StrangeError, match="no Parquet"):
        parquet_file(tmp_path / "zeros")
    with pytest.raises(ex.RunError, match="bytes"):
        store.read_json(tmp_path / "zeros")
    assert time.process_time() - start < 1.0


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

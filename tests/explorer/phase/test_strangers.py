"""Files that strangers left: refused in a sentence before they are used, whatever they are."""

import importlib
import time

import pytest

import explorer as ex
from explorer.phase.strangers import StrangeError, check_kinds, parquet_file, parse_json, plain_file
from explorer.runs import store


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


def test_numbers_of_very_many_digits_are_refused_without_words_of_python():
    with pytest.raises(StrangeError, match="it holds a number of too many digits"):
        parse_json('{"a": ' + "9" * 5000 + "}")

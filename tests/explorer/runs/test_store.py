"""Chunks and JSON on disk: any change of a file is noticed."""

import json

import numpy as np
import pyarrow.dataset
import pyarrow.parquet
from small_runs import SMALL_RACES

import explorer as ex
from explorer.phase.results import to_arrow
from explorer.runs import store
from explorer.runs.inspect import verify


def text(run):
    return (run.folder / "summary.json").read_text()


def test_a_note_with_its_counts_as_text_is_the_note_as_json():
    tally = {"status": {"ok": 3}, "text": 'null} "ä"', "range": [1e-300, 0.1]}
    note = store.Note(4, "ab", 3, "cd", tally)
    assert store.as_text(note, json.dumps(tally)) == json.dumps(vars(note))


def test_any_flipped_bit_of_a_chunk_is_noticed(finished):
    rng = np.random.default_rng(0)
    path = store.found_chunks(finished.folder)[2]
    content = path.read_bytes()
    assert verify(finished.folder) == []
    for _ in range(40):
        broken = bytearray(content)
        broken[int(rng.integers(len(content)))] ^= 1 << int(rng.integers(8))
        path.write_bytes(broken)
        (fault,) = verify(finished.folder)
        assert path.name in fault
    path.write_bytes(content[:-100])
    assert len(verify(finished.folder)) == 1


def test_swapped_and_foreign_chunks_are_noticed(finished, tmp_path):
    other = ex.run("race-angles", out=tmp_path / "other", **{**SMALL_RACES, "seed": 6})
    mine, theirs = store.found_chunks(finished.folder), store.found_chunks(other.folder)
    content = [mine[i].read_bytes() for i in range(2)]
    mine[0].write_bytes(content[1])
    mine[1].write_bytes(content[0])
    assert len(verify(finished.folder)) == 2
    mine[0].write_bytes(content[0])
    mine[1].write_bytes(content[1])
    # Renamed as well, so that the bytes agree with the name.
    mine[2].unlink()
    (mine[2].parent / theirs[2].name).write_bytes(theirs[2].read_bytes())
    (fault,) = verify(finished.folder)
    assert "it belongs to another run" in fault
    (mine[2].parent / theirs[2].name).unlink()
    moved = mine[3].name.replace("000003", "000002")
    (mine[2].parent / moved).write_bytes(mine[3].read_bytes())
    (fault,) = verify(finished.folder)
    assert "it is chunk 3" in fault


def test_strangers_among_the_chunks_are_put_aside(finished, capsys):
    before, chunks = text(finished), finished.folder / "chunks"
    for name in ("x.parquet", "chunk-000001-0000000000000000.parquet", "chunk-000001-ffffffffffffffff.parquet"):
        (chunks / name).write_bytes(store.found_chunks(finished.folder)[2].read_bytes())
    assert len(verify(finished.folder)) >= 3
    again = ex.run("race-angles", out=finished.folder, **SMALL_RACES)
    assert text(again) == before
    assert verify(finished.folder) == []
    assert len(list((finished.folder / "bad").iterdir())) == 3
    assert pyarrow.dataset.dataset(chunks).to_table().num_rows == 3000
    assert "x.parquet: is no chunk of a run" in capsys.readouterr().err
    assert json.loads((finished.folder / "run.json").read_text())["chunks_computed"] == 0


def test_a_relative_folder_with_a_colon_is_a_folder_and_no_address(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = ex.run("race-angles", out="uniform:m=1", **SMALL_RACES)
    assert verify(run.folder) == []
    assert ex.open("uniform:m=1").summary == run.summary


def test_chunks_of_the_format_before_are_read(finished, tmp_path):
    path = store.found_chunks(finished.folder)[0]
    rows, note = store.read_chunk(path), store.read_note(path)
    content = pyarrow.parquet.read_metadata(path).metadata[b"nearflat"]
    before = to_arrow(rows).replace_schema_metadata({b"nearflat": content})
    pyarrow.parquet.write_table(before, tmp_path / path.name, compression="lz4", write_page_checksum=True)
    assert store.read_note(tmp_path / path.name) == note
    again = store.read_chunk(tmp_path / path.name)
    for name, values in rows.items():
        np.testing.assert_array_equal(again[name], values)
        assert again[name].dtype == values.dtype


def test_columns_whose_numbers_repeat_are_packed_and_others_are_not(tmp_path):
    rng = np.random.default_rng(0)
    own, fixed, unknown = rng.random(5000), np.full(5000, 0.1), np.full(5000, np.nan)
    table = {"phi": fixed, "phidot": own, "theta_min": unknown, "status": np.zeros(5000, np.int8)}
    tally = {"status": {"ok": 5000}}
    (tmp_path / "chunks").mkdir()
    note = store.Note(3, "a", 5000, store.digest_of(table, tally), tally)
    path = store.write_chunk(tmp_path, note, to_arrow(table))
    group = pyarrow.parquet.read_metadata(path).row_group(0)
    kinds = {group.column(i).path_in_schema: group.column(i) for i in range(4)}
    assert {name: kind.compression for name, kind in kinds.items()} == {
        "phi": "LZ4",
        "phidot": "UNCOMPRESSED",
        "theta_min": "LZ4",
        "status": "LZ4",
    }
    assert kinds["phi"].total_compressed_size < 1000 < own.nbytes <= kinds["phidot"].total_compressed_size
    assert store.read_note(path) == note
    for name, values in store.read_chunk(path).items():
        np.testing.assert_array_equal(values, table[name])

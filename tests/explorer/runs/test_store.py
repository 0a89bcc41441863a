"""Chunks and JSON on disk: any change of a file is noticed."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.dataset
import pyarrow.parquet
import pytest
from small_runs import SMALL_RACES

import explorer as ex
from explorer.commands.main import main
from explorer.phase.results import to_arrow
from explorer.runs import store
from explorer.runs.inspect import status, verify
from explorer.scenes.race_angles import RaceAngles


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


def rewritten(run, index, change):
    """A chunk with other rows, written as nearflat writes one."""
    path = store.found_chunks(run.folder)[index]
    note, table = store.read_note(path), change(pyarrow.parquet.read_table(path))
    path.unlink()
    return store.write_chunk(run.folder, note, table)


def test_a_chunk_without_a_column_of_its_scene_is_named_and_computed_anew(finished, capsys):
    """As an earlier version might have left it."""
    before = store.found_chunks(finished.folder)[1].read_bytes()
    lacking = rewritten(finished, 1, lambda table: table.drop(["race_angle"]))
    other = rewritten(finished, 3, lambda table: table.set_column(3, "face", pa.array([1.0] * table.num_rows)))
    assert verify(finished.folder) == [
        f"{lacking.name}: column 'race_angle' is missing",
        f"{other.name}: column 'face' holds double, not int8",
    ]
    with pytest.raises(ex.RunError, match=lacking.name):
        finished.arrow(["race_angle"])
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert "column 'race_angle' is missing; it is put aside" in capsys.readouterr().err
    assert verify(finished.folder) == []
    assert store.found_chunks(finished.folder)[1].read_bytes() == before


def test_other_rows_than_the_digest_is_of_are_found(finished):
    path = rewritten(finished, 1, lambda table: table.slice(0, table.num_rows // 2))
    assert verify(finished.folder) == [f"{path.name}: its rows and counts have another digest than it says"]


def test_two_chunks_of_one_number_are_refused_and_computed_anew(finished, capsys):
    path = store.found_chunks(finished.folder)[3]
    content = path.read_bytes()
    other = rewritten(finished, 3, lambda table: table.slice(0, 1))
    path.write_bytes(content)
    assert store.all_chunks(finished.folder)[3] == sorted([path, other])
    with pytest.raises(ex.RunError, match="holds two of chunk 3"):
        finished.arrow()
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert f"{other.name}: " in capsys.readouterr().err
    assert verify(finished.folder) == []


def test_a_chunk_that_another_program_wrote_anew_is_named(finished):
    path = store.found_chunks(finished.folder)[1]
    pyarrow.parquet.write_table(pa.table({"phi": [0.1]}), path)
    with pytest.raises(ex.RunError, match=rf"{path.name}: .*its metadata do not say which chunk it is"):
        store.read_note(path)
    assert status(finished.folder).chunks_done == 4


@pytest.mark.parametrize(
    "name", ["chunk-000003 (1)", "chunk-0000003-0123456789abcdef", "chunk-000099-0123456789abcdef"]
)
def test_what_has_nearly_the_name_of_a_chunk_is_put_aside(finished, name, capsys):
    before, path = finished.summary, finished.folder / "chunks" / f"{name}.parquet"
    path.write_bytes(store.found_chunks(finished.folder)[2].read_bytes())
    assert any(path.name in fault for fault in verify(finished.folder))
    assert main(["resume", str(finished.folder), "--no-figures"]) == 0
    assert f"{path.name}: " in capsys.readouterr().err
    assert (finished.folder / "bad" / path.name).exists()
    assert verify(finished.folder) == []
    assert ex.open(finished.folder).summary == before


def test_a_scene_that_makes_columns_of_different_lengths_is_told_so(monkeypatch):
    process = RaceAngles.process

    def with_more(self, index):
        rows, tally = process(self, index)
        return {**rows, "more": np.zeros(1)}, tally

    monkeypatch.setattr(RaceAngles, "process", with_more)
    with pytest.raises(ex.RunError, match="chunk 0: race-angles made what cannot be stored"):
        ex.run("race-angles", samples=10, eta_hat="1e-4:1e-2", keep="all")


def test_own_columns_may_be_of_other_types_in_other_chunks(tmp_path):
    """Whole numbers of which one is missing come as doubles."""
    columns = {name: np.linspace(0.1, 0.5, 8) for name in ("phi", "phidot", "sigma3", "sigma4")}
    table = pa.table({**columns, "own": pa.array([1, 2, 3, 4, 5, None, 7, 8])})
    pyarrow.parquet.write_table(table, tmp_path / "states.parquet", row_group_size=4)
    how = {"chunk_size": 4, "keep": "all", "out": tmp_path / "run", "figures": False}
    run = ex.run("falling-set", states=tmp_path / "states.parquet", **how)
    assert verify(run.folder) == []
    assert run.arrow(["own"])["own"].to_pylist()[:2] == [1.0, 2.0]
    assert json.loads((run.folder / "summary.json").read_text())["samples"] == 8


def test_other_files_among_the_chunks_are_put_aside(finished, capsys):
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

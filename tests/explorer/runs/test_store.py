"""A chunk is the bytes of a Parquet file: whole or not there, and whatever changes them is found."""

import errno
import hashlib
import json
import os
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from coins import SMALL, Coins

import explorer as ex
from explorer.runs import store


def chunk_of(run, number):
    return run.chunks[number].content


def test_a_stored_chunk_and_one_in_memory_are_the_same_bytes(finished):
    held = ex.run(Coins, **SMALL)
    assert held.folder is None
    assert [(each.name, each.data()) for each in held.chunks] == [
        (each.name, each.data()) for each in finished.chunks
    ]
    assert held.verify() == finished.verify() == []


def test_other_programs_read_chunks_with_units_and_meanings(finished):
    table = pq.read_table(chunk_of(finished, 0))
    assert table.schema.field("height").metadata[b"unit"] == b"length"
    assert table.schema.field("status").metadata[b"meaning"].startswith(b"Outcome of the sample")
    assert table.schema.field("status").type == pa.dictionary(pa.int8(), pa.string())
    assert table.to_pandas()["status"].unique().tolist() == ["ok"]
    duckdb = pytest.importorskip("duckdb")
    ((mean,),) = duckdb.sql(f"select avg(height) from '{finished.folder}/chunks/*.parquet'").fetchall()
    assert mean == pytest.approx(finished.summary["mean"])


def test_rows_come_back_as_they_were_computed(finished):
    (table,) = finished.scene.chunk(4)[:1]
    read = list(finished.tables())[4]
    assert list(read) == list(table)
    for name, values in table.items():
        np.testing.assert_array_equal(read[name], values)
        assert read[name].dtype == values.dtype
    assert list(next(finished.tables(["note"]))) == ["note"]


@pytest.mark.parametrize("place", [0.02, 0.3, 0.6, 0.9, 0.98])
def test_a_flipped_bit_is_found_by_name_moved_aside_and_computed_anew(place, finished):
    path, digest = chunk_of(finished, 1), finished.summary["digest"]
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= 4
    path.write_bytes(content)
    assert finished.verify() == [f"{path.name}: its bytes are not those that were written"]
    assert finished.resume(progress=False).summary["digest"] == digest
    assert finished.verify() == []
    assert (finished.folder / "bad" / path.name).read_bytes() == content


def test_changed_rows_are_found_where_the_bytes_have_their_digest_in_the_name(finished):
    """By the digest of rows and counts, which only `verify` looks at."""
    path = chunk_of(finished, 1)
    table, said = pq.read_table(path), pq.read_metadata(path).metadata
    changed = table.set_column(1, table.schema.field("height"), pa.array(table["height"].to_numpy() + 1e-9))
    made = pa.BufferOutputStream()
    with pq.ParquetWriter(made, table.schema) as writer:
        writer.write_table(changed)
        writer.add_key_value_metadata({key: value for key, value in said.items() if key.startswith(b"nearflat")})
    content = made.getvalue().to_pybytes()
    path.unlink()
    forged = path.with_name(f"chunk-000001-{hashlib.sha256(content).hexdigest()[:16]}.parquet")
    forged.write_bytes(content)
    assert finished.verify() == [f"{forged.name}: its rows and counts have another digest than it says"]


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda path, other: path.write_bytes(b""), "its bytes are not those that were written"),
        (lambda path, other: path.write_bytes(other.read_bytes()), "its bytes are not those that were written"),
        (
            lambda path, other: path.write_bytes(path.read_bytes()[:-9]),
            "its bytes are not those that were written",
        ),
        (lambda path, other: path.rename(path.with_name(path.name.replace("01-", "09-"))), "is beyond the end"),
        (
            lambda path, other: path.with_name(path.name.replace("01-", "01-0")[:29] + ".parquet").write_bytes(
                b"x"
            ),
            "there are two of its number",
        ),
    ],
    ids=["emptied", "exchanged", "cut", "beyond", "twice"],
)
def test_files_that_are_no_good_chunks_are_told_and_moved_aside(spoil, message, finished):
    digest = finished.summary["digest"]
    spoil(chunk_of(finished, 1), chunk_of(finished, 2))
    assert any(message in fault for fault in finished.verify())
    assert finished.resume(progress=False).summary["digest"] == digest
    assert finished.verify() == []
    assert [*(finished.folder / "bad").iterdir()]


def test_chunks_of_another_run_are_no_chunks_of_this_one(finished, tmp_path):
    other = ex.run(Coins, **{**SMALL, "seed": 6}, out=tmp_path / "other")
    theirs = chunk_of(other, 2)
    chunk_of(finished, 2).unlink()
    (finished.folder / "chunks" / theirs.name).write_bytes(theirs.read_bytes())
    assert finished.verify() == [f"{theirs.name}: it belongs to another run"]
    with pytest.raises(ex.RunError, match="it belongs to another run"):
        _ = ex.open(finished.folder).summary


def test_numbers_and_tables_of_a_damaged_chunk_are_never_given_out(finished):
    path = chunk_of(finished, 3)
    footer = path.read_bytes()
    spoilt = footer.replace(b'"heads": ', b'"heads": 1', 1)
    assert spoilt != footer
    path.write_bytes(spoilt)
    with pytest.raises(ex.RunError, match=f"{path.name}: cannot be read or is damaged"):
        _ = finished.summary


@pytest.mark.parametrize("step", [(os, "fsync"), (Path, "replace")])
def test_a_full_disk_leaves_no_half_written_chunk_and_can_be_resumed(step, tmp_path, monkeypatch, finished):
    owner, name = step
    plain, calls = getattr(owner, name), []

    def failing(*arguments):
        calls.append(1)
        if len(calls) > 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return plain(*arguments)

    monkeypatch.setattr(owner, name, failing)
    with pytest.raises(ex.RunError, match=r"cannot be written .No space left on device"):
        ex.run(Coins, out=tmp_path / "full", jobs=1, progress=False, **SMALL)
    monkeypatch.undo()
    assert not [*(tmp_path / "full").rglob("*.tmp")]
    run = ex.open(tmp_path / "full")
    assert 0 < run.status.chunks_done < 5
    assert run.resume(progress=False).summary == finished.summary


def test_a_file_that_says_the_same_stays_as_it_is(tmp_path):
    path = tmp_path / "some.json"
    store.write_json(path, {"a": 1})
    before = path.stat().st_mtime_ns, path.stat().st_ino
    store.write_json(path, {"a": 1})
    assert (path.stat().st_mtime_ns, path.stat().st_ino) == before
    assert json.loads(path.read_text()) == {"a": 1}
    with pytest.raises(ValueError, match="JSON compliant"):
        store.write_json(path, {"a": float("nan")})


def test_a_chunk_under_the_name_of_another_is_never_taken_for_it(finished):
    one, two = chunk_of(finished, 1), chunk_of(finished, 2)
    two.write_bytes(one.read_bytes())
    for ask in (lambda run: run.summary, lambda run: run.frame(), lambda run: [*run.tables()]):
        with pytest.raises(ex.RunError, match="it is chunk 1 under another name"):
            ask(ex.open(finished.folder))
    assert ex.open(finished.folder).status.chunks_done == 4


def test_rows_of_another_run_are_never_given_out(finished, tmp_path):
    other = ex.run(Coins, **{**SMALL, "seed": 6}, out=tmp_path / "other", figures=False)
    chunk_of(finished, 2).unlink()
    shutil.copy(chunk_of(other, 2), finished.folder / "chunks")
    with pytest.raises(ex.RunError, match="it belongs to another run"):
        ex.open(finished.folder).frame()


def test_a_damaged_chunk_that_has_the_name_of_its_bytes_is_computed_anew(finished):
    digest, path = finished.summary["digest"], chunk_of(finished, 3)
    content = bytearray(path.read_bytes())
    content[400] ^= 1
    path.unlink()
    name = f"chunk-000003-{store.sha256(bytes(content))[:16]}.parquet"
    path.with_name(name).write_bytes(content)
    assert ex.open(finished.folder).verify() != []
    assert finished.resume(progress=False).summary["digest"] == digest
    assert finished.verify() == []
    assert [each.name for each in (finished.folder / "bad").iterdir()] == [name]


def test_what_else_stands_among_the_chunks_is_the_user_s_and_stays(finished):
    """A pipe with the name of a chunk is not waited for."""
    there = finished.folder / "chunks"
    (there / "mine.parquet").write_text("mine")
    os.mkfifo(there / f"chunk-000002-{'0' * 16}.parquet")
    assert finished.verify() == []
    assert ex.open(finished.folder).status.chunks_done == 5
    finished.resume(progress=False)
    ex.run(Coins, out=finished.folder, exist="replace", samples=10, figures=False)
    assert (there / "mine.parquet").read_text() == "mine"
    assert not (finished.folder / "bad").exists()


def flipped(random, content):
    content = bytearray(content)
    content[random.integers(len(content))] ^= 1 << random.integers(8)
    return bytes(content)


def zeroed(random, content):
    first = random.integers(4, len(content) - 8)
    return content[:first] + b"\xff" + bytes(6) + content[first + 7 :]


DAMAGES = {
    "flipped": flipped,
    "zeroed": zeroed,
    "cut": lambda random, content: content[: random.integers(len(content))],
    "longer": lambda random, content: content + random.bytes(1 + random.integers(99)),
    "named by its bytes": flipped,
    "of another number": None,
    "of another run": None,
    "gone": None,
}


def damaged(kind, random, path, content, neighbour, theirs):
    """Damage a chunk that has this content; returns the name that it then has."""
    path.unlink()
    if kind == "of another run":
        return Path(shutil.copy(theirs, path.parent)).name
    if kind == "of another number":
        path.write_bytes(neighbour)
    elif DAMAGES[kind]:
        if kind != "named by its bytes":
            path.write_bytes(DAMAGES[kind](random, content))
        else:
            content = DAMAGES[kind](random, content)
            path = path.with_name(f"{path.name[:13]}{store.sha256(content)[:16]}.parquet")
            path.write_bytes(content)
    return path.name


def test_each_of_450_damaged_chunks_is_found_and_repaired(finished, tmp_path):
    random, digest, kinds = np.random.default_rng(54), finished.summary["digest"], [*DAMAGES]
    good, rows = [(chunk.content, chunk.data()) for chunk in finished.chunks], finished.arrow()
    other = ex.run(Coins, **{**SMALL, "seed": 6}, out=tmp_path / "other", figures=False)
    foreign = [chunk.content for chunk in other.chunks]
    for turn in range(90):
        done = []
        for number, (path, content) in enumerate(good):
            kind = kinds[random.integers(len(kinds))]
            about = (path, content, good[number - 1][1], foreign[number])
            done.append((kind, damaged(kind, random, *about)))
        faults = "\n".join(finished.verify())
        left = {chunk.name: chunk for chunk in finished.chunks}
        for kind, name in done:
            # A bit that no reader looks at changes no number.
            harmless = kind == "named by its bytes" and left[name].fault() == ""
            assert kind == "gone" or harmless or f"{name}: " in faults, (turn, kind)
        gone = [str(number) for number, (kind, _) in enumerate(done) if kind == "gone"]
        assert f"chunks are missing: {', '.join(gone)}" in faults or not gone, turn
        assert finished.resume(progress=False).summary["digest"] == digest
        assert finished.verify() == []
        assert finished.arrow().equals(rows)
        for chunk in finished.chunks:
            chunk.content.unlink()
        for path, content in good:
            path.write_bytes(content)

"""File formats of a run: immutable Parquet chunks and JSON, each committed by one rename.

A chunk's name carries its number and a digest of its bytes: chunk-000007-<16 hex digits>.parquet. Any
change of the file, and any exchange with another, is seen by hashing it. Its metadata carry the tally of
all samples of the chunk, also of those whose rows are not kept, so a summary reads footers only.
"""

import contextlib
import hashlib
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import InputError, RunError, shorten
from explorer.phase.results import status_codes, to_arrow
from explorer.phase.strangers import (
    LARGEST_JSON,
    StrangeError,
    check_kinds,
    parquet_file,
    parse_json,
    plain_file,
)
from explorer.runs import schema
from explorer.scenes.base import Scene, Table

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

_NAME = re.compile(r"chunk-([0-9]{6}|[1-9][0-9]{6,8})-([0-9a-f]{16})\.parquet")
_KEY = b"nearflat"
_LOOKED_AT = 256  # rows of a column, which tell whether its numbers repeat
_SMALL = 1 << 26  # bytes of a file that is read at once
_FEW = 1 << 14  # rows, which one thread has read before others are asked to
_LONGEST, _SHOWN = 300, 40  # characters of a message, and of a name in it
_NOTE: dict[str, type] = {"index": int, "identity": str, "samples": int, "digest": str, "tally": dict}


class DamagedError(InputError, RunError):
    """A file of a run is damaged, or is none; the message says how, and what would do."""


@dataclass(frozen=True)
class Note:
    """What a chunk says of itself. samples: how many it stands for; digest: of its rows and counts."""

    index: int
    identity: str
    samples: int
    digest: str
    tally: dict[str, Any]


def as_text(note: Note, tally: str) -> str:
    """A note as JSON, as `json.dumps` writes it, from that of its counts: these are nearly all of it."""
    said = json.dumps({**vars(note), "tally": None}, allow_nan=False)
    return f"{said.removesuffix('null}')}{tally}}}"


def found_chunks(folder: Path) -> dict[int, Path]:
    """The chunk files of a run by number; of two with the same number, one."""
    return {number: paths[-1] for number, paths in all_chunks(folder).items()}


def all_chunks(folder: Path) -> dict[int, list[Path]]:
    """All files whose name is that of a chunk, by number."""
    return by_number(files(folder))


def files(folder: Path) -> list[Path]:
    """What stands among the chunks of a run, in order of names; files that are being written have other names."""
    return sorted((folder / "chunks").glob("*.parquet"))


def by_number(paths: Iterable[Path]) -> dict[int, list[Path]]:
    """Those files whose name is that of a chunk, by number."""
    numbered: dict[int, list[Path]] = {}
    for path in paths:
        number = number_of(path)
        if number is not None:
            numbered.setdefault(number, []).append(path)
    return numbered


def number_of(path: Path) -> int | None:
    """The number in the name of a chunk; None where the name is not a chunk's."""
    match = _NAME.fullmatch(path.name)
    return int(match[1]) if match else None


def write_chunk(folder: Path, note: Note, table: "pa.Table", tally: str | None = None) -> Path:
    """Write a chunk so that its name exists only if its content is complete and on disk.

    table: as `made_table` gives it. tally: the counts of the note as JSON, where that is at hand.

    Page checksums are on: without them Parquet reads most single flipped bits back as data. The name is of the
    bytes that were to be written, so that a disk that kept others is found out.
    """
    import pyarrow as pa

    place = folder / "chunks"
    temporary = place / f".chunk-{note.index:06d}.{os.getpid()}.tmp"  # readers of the folder skip the dot
    try:
        text = as_text(note, json.dumps(note.tally, allow_nan=False) if tally is None else tally)
        content = json.dumps({"note": text, "check": _sha(text.encode())})
        made = pa.BufferOutputStream()
        write_parquet(table, made, {_KEY: content.encode()})
        whole = memoryview(made.getvalue())
        with temporary.open("wb") as stream:
            stream.write(whole)
            stream.flush()
            os.fsync(stream.fileno())
        if temporary.stat().st_size != whole.nbytes:
            raise RunError(f"{temporary}: the file is not as long as what was written")
        path = place / f"chunk-{note.index:06d}-{_sha(whole)[:16]}.parquet"
        temporary.replace(path)
        _sync(place)
    except OSError as error:
        raise RunError(
            f"{place}: chunk {note.index} cannot be written ({error.strerror or error}); finished chunks are "
            f"intact; make room and continue with: nearflat resume {folder}"
        ) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
    return path


def made_table(place: schema.Place, note: Note, table: Table) -> "pa.Table":
    """What a scene made as it is stored: with units and meanings, status by name.

    Raises RunError where readers of its chunks would refuse it; a user's scene may make such.
    """
    try:
        rows = {values.size for values in table.values()}
        if len(rows) != 1:
            raise StrangeError(f"its columns have {sorted(rows)} rows")
        arrow = to_arrow(table)
        if not _ours(place.scene):  # what it counts, our tests look at; to unpack that again takes a while
            place.check(note.index, note.samples, note.tally)
        schema.check_held(place.scene, place.index, schema.held_by(arrow.schema, rows.pop()))
        return arrow
    except _damage() as error:
        fault = shorten(" ".join(str(error).split()), 150)
        raise RunError(f"chunk {note.index}: {place.scene.name} made what cannot be stored ({fault})") from None


def write_parquet(table: "pa.Table", stream: Any, metadata: Mapping[bytes, bytes]) -> None:
    """Write the rows of a chunk as they are stored, and what the file says of itself.

    Digits of measured numbers repeat nowhere: lz4 took nothing off them and a fifth of the time, dictionaries made
    files a quarter larger in four times the time, and zstd takes off one part in eleven in twice the time. The
    metadata are added at the end, else the schema would hold them once more, in base 64.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    repeated = [field.name for field in table.schema if not pa.types.is_floating(field.type)]
    packed = {
        name: "lz4" if name in repeated or _repeats(table.column(name)) else "none" for name in table.column_names
    }
    with pq.ParquetWriter(
        stream,
        table.schema,
        compression=packed,
        use_dictionary=repeated or False,
        write_statistics=repeated or False,
        write_page_checksum=True,
    ) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(metadata)


def _repeats(column: "pa.ChunkedArray") -> bool:
    """Whether numbers repeat among the first ones: a coordinate that is fixed, NaN of what was not computed."""
    first = column.chunk(0)[:_LOOKED_AT]
    # Bits, so that NaN repeats too; from Arrow's memory, since arrays are converted with the help of pandas, which
    # takes a quarter of a second to load where it is installed.
    width, memory = first.type.bit_width // 8, first.buffers()[1]
    if not len(first):
        return False
    ordered = np.sort(np.frombuffer(memory, f"u{width}", len(first), first.offset * width))
    return bool((ordered[1:] == ordered[:-1]).any())


def _sync(place: Path) -> None:
    """Make a rename durable, where folders can be synced."""
    if os.name == "posix":
        handle = os.open(place, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _sha(content: "bytes | memoryview") -> str:
    return hashlib.sha256(content).hexdigest()


def _digest_of_bytes(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def read_note(path: Path, place: schema.Place | None = None) -> Note:
    """What the footer of a chunk says. Raises DamagedError naming the file, also where another one is due."""
    try:
        with _opened(path) as file:
            note = _noted(file)
            if place is not None:
                place.check(note.index, note.samples, note.tally)
                place.check_held(file)
            return note
    except _damage() as error:
        raise _damaged(path, error) from error


def read_chunk(path: Path, columns: Sequence[str] | None = None, place: schema.Place | None = None) -> Table:
    """The kept rows of a chunk, checksums verified; some columns, or all. Raises DamagedError as `read_note`."""
    try:
        with _opened(path) as file:
            if place is not None:
                place.check_held(file)
            return _rows(file, columns)
    except _damage() as error:
        raise _damaged(path, error) from error


@contextmanager
def _opened(path: Path, content: bytes | None = None) -> "Iterator[pq.ParquetFile]":
    """A chunk, whose file is read again only where its bytes are not at hand."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    # Arrow would look for the kind of file system in a path, which takes as long as to open the file.
    whole = pa.OSFile(str(parquet_file(path))) if content is None else pa.BufferReader(content)
    with whole as stream, closing(pq.ParquetFile(stream, page_checksum_verification=True)) as file:
        yield file


def _noted(file: "pq.ParquetFile") -> Note:
    """What a footer says, its checksum verified. Raises one of `_damage`."""
    content = (file.metadata.metadata or {}).get(_KEY)
    if content is None:
        raise StrangeError("its metadata do not say which chunk it is")
    if len(content) > LARGEST_JSON:
        raise StrangeError(f"its metadata have {len(content):,} bytes; {LARGEST_JSON:,} is the most that is read")
    signed = parse_json(content)
    check_kinds(signed, {"note": str, "check": str})
    if _sha(signed["note"].encode()) != signed["check"]:
        raise ValueError("checksum of its metadata")
    said = parse_json(signed["note"])
    check_kinds(said, _NOTE)
    return Note(**said)


def _rows(file: "pq.ParquetFile", columns: Sequence[str] | None) -> Table:
    """Columns of a chunk in the order asked. Raises one of `_damage`."""
    wanted = None if columns is None else list(columns)
    arrow = file.read(columns=wanted, use_threads=file.metadata.num_rows > _FEW)
    if arrow.num_rows != file.metadata.num_rows:
        raise StrangeError(f"it has {arrow.num_rows:,} rows, and says {file.metadata.num_rows:,}")
    return {name: _values(name, arrow.column(name)) for name in columns or arrow.column_names}


def _damage() -> tuple[type[Exception], ...]:
    """What reading a damaged file may raise."""
    import pyarrow as pa

    return (OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, OverflowError, pa.ArrowException)


def _values(name: str, column: "pa.ChunkedArray") -> NDArray[Any]:
    """A column as it was before it was written: statuses are numbers here."""
    import pyarrow as pa

    kind = column.type
    empty = column.null_count and not (pa.types.is_temporal(kind) or pa.types.is_string(kind))
    if empty:
        raise StrangeError(f"column {name[:_SHOWN]!r} lacks {column.null_count:,} values")
    if not pa.types.is_dictionary(kind):
        return np.asarray(column)
    names = column.unify_dictionaries().combine_chunks()
    codes = status_codes(np.array(names.dictionary.to_pylist(), dtype=str))
    return np.asarray(codes[np.asarray(names.indices)])


def _damaged(path: Path, error: Exception) -> DamagedError:
    """In one line, with the remedy: it is long where the path is."""
    folder = path.parents[1]
    fault = shorten(" ".join(str(error).split()), 110)
    then = f"continue with: nearflat resume {folder}"
    return DamagedError(f"{_named(path, then, fault)}: cannot be read or is damaged ({fault}); {then}")


def _named(path: Path, *others: str) -> str:
    """A path as long as a message has room for it."""
    room = _LONGEST - sum(map(len, others)) - 40
    return str(path) if len(str(path)) <= room else path.name


def examined(path: Path, place: schema.Place, identity: str) -> Note | str:
    """What the chunk says that is due in this place of this run, or what is wrong with it, to the last value."""
    content = _intact(path)
    if isinstance(content, str):
        return content
    try:
        with _opened(path, content) as file:
            note = _noted(file)
            if note.identity != identity:
                return "it belongs to another run"
            place.check(note.index, note.samples, note.tally)
            place.check_held(file)
            table = _rows(file, None)
        schema.check_values(place.scene, place.index, table, note.tally)
        _check_digest(place.scene, table, note)
    except _damage() as error:
        return shorten(" ".join(str(error).split()), 150)
    return note


def _intact(path: Path) -> bytes | str | None:
    """The bytes of a file whose name has their digest, None where they are many; or what is wrong with it."""
    match, other = _NAME.fullmatch(path.name), "its bytes are not those that were written"
    try:
        plain = parquet_file(path)
        content = plain.read_bytes() if plain.stat().st_size <= _SMALL else None
        digest = _digest_of_bytes(plain) if content is None else _sha(content)
    except StrangeError as error:
        return f"{other}: {error}"
    except OSError as error:
        return str(error)
    return content if match is not None and digest[:16] == match[2] else other


def _check_digest(scene: Scene, table: Table, note: Note) -> None:
    """Raise StrangeError where rows and counts are not those of which the note has a digest.

    Text and times come back as other types than they were written from, and so may what a user's scene stores.
    """
    numbers = all(values.dtype.kind in "fiub" for values in table.values())
    if _ours(scene) and numbers and digest_of(table, note.tally) != note.digest:
        raise StrangeError("its rows and counts have another digest than it says")


def _ours(scene: Scene) -> bool:
    return type(scene).__module__.startswith("explorer.")


def digest_of(table: Table, tally: dict[str, Any]) -> str:
    """SHA-256 over the kept rows and the counts of all: equal digests are equal numbers."""
    digest = hashlib.sha256(json.dumps(tally, sort_keys=True).encode())
    for name, values in table.items():
        digest.update(f"{name}:{values.dtype}:{values.size};".encode())
        digest.update(np.ascontiguousarray(values).view(np.uint8).data)
    return digest.hexdigest()


def digest_of_all(digests: Iterable[str]) -> str:
    """Digest of a run from those of its chunks, in order."""
    return _sha("".join(digests).encode())


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write JSON and commit it by a rename. NaN is refused: it is not JSON."""
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    temporary = path.with_suffix(f".{os.getpid()}.tmp")
    try:
        with temporary.open("w", encoding="utf-8") as stream:
            stream.write(text)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(path)
    except OSError as error:
        raise RunError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON object. Raises RunError naming the file."""
    try:
        return parse_json(plain_file(path, LARGEST_JSON).read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RunError(f"{path}: cannot be read ({error})") from error

"""File formats of a run: immutable Parquet chunks and JSON, each committed by one rename.

A chunk's name carries its number and a digest of its bytes: chunk-000007-<16 hex digits>.parquet. Any
change of the file, and any exchange with another, is seen by hashing it. Its metadata carry the tally of
all samples of the chunk, also of those whose rows are not kept, so a summary reads footers only.

These checks find what disks, networks and other programs do to files, and not a chunk that somebody writes anew
with checksums that fit.
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
from explorer.phase.columns import COLUMNS
from explorer.phase.results import status_codes, to_arrow
from explorer.scenes.base import Scene, Table

if TYPE_CHECKING:
    import pyarrow as pa
    import pyarrow.parquet as pq

_NAME = re.compile(r"chunk-([0-9]{6}|[1-9][0-9]{6,8})-([0-9a-f]{16})\.parquet")
_KEY = b"nearflat"
_LOOKED_AT = 256  # rows of a column, which tell whether its numbers repeat
_FEW = 1 << 14  # rows, which one thread has read before others are asked to


class CorruptFileError(InputError, RunError):
    """A run file is missing or damaged; the message gives the cause and the remedy."""


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
    """The Parquet files of a run, sorted by name; files that are being written have other names."""
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


def made_table(scene: Scene, index: int, table: Table) -> "pa.Table":
    """The rows of a chunk as they are stored: with units and meanings, status by name.

    Raises RunError where columns differ in length, or are not those of the scene: a user's scene may make such.
    """
    try:
        arrow = to_arrow(table)
        arrow.validate()
        _check_columns(scene, arrow.schema)
        return arrow
    except _damage() as error:
        fault = _in_one_line(error, 150)
        raise RunError(f"chunk {index}: {scene.name} made what cannot be stored ({fault})") from None


def _check_columns(scene: Scene, schema: "pa.Schema") -> None:
    """Raise ValueError where a column that the scene names is missing or has another type; there may be others."""
    known = {name: COLUMNS[name].kind for name in scene.columns if name in COLUMNS}
    due = to_arrow({name: np.empty(0, np.int8 if kind == "status" else kind) for name, kind in known.items()})
    for name in scene.columns:
        if name not in schema.names:
            raise ValueError(f"column {name!r} is missing")
        if name in known and schema.field(name).type != due.schema.field(name).type:
            raise ValueError(f"column {name!r} holds {schema.field(name).type}, not {due.schema.field(name).type}")


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
    # takes a quarter of a second to load.
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


def read_note(path: Path) -> Note:
    """What the footer of a chunk says. Raises CorruptFileError naming the file, also where it is another chunk."""
    try:
        with _opened(path) as file:
            note = _noted(file)
        if note.index != number_of(path):
            raise ValueError(f"it is chunk {note.index}")
        return note
    except _damage() as error:
        raise _corrupt(path, error) from error


def read_chunk(path: Path, columns: Sequence[str] | None = None) -> Table:
    """The kept rows of a chunk, checksums verified; some columns, or all. Raises CorruptFileError."""
    try:
        with _opened(path) as file:
            return _rows(file, columns)
    except _damage() as error:
        raise _corrupt(path, error) from error


@contextmanager
def _opened(path: Path, content: bytes | None = None) -> "Iterator[pq.ParquetFile]":
    """A chunk, whose file is read again only where its bytes are not at hand."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    # Arrow would look for the kind of file system in a path, which takes as long as to open the file, and would
    # take a relative one with a colon for an address.
    whole = pa.OSFile(str(path.absolute())) if content is None else pa.BufferReader(content)
    with whole as stream, closing(pq.ParquetFile(stream, page_checksum_verification=True)) as file:
        yield file


def _noted(file: "pq.ParquetFile") -> Note:
    """What a footer says, its checksum verified. Raises one of `_damage`."""
    content = (file.metadata.metadata or {}).get(_KEY)
    if content is None:
        raise ValueError("its metadata do not say which chunk it is")
    signed = json.loads(content)
    if _sha(signed["note"].encode()) != signed["check"]:
        raise ValueError("checksum of its metadata")
    return Note(**json.loads(signed["note"]))


def _rows(file: "pq.ParquetFile", columns: Sequence[str] | None) -> Table:
    """Columns of a chunk in the order asked. Raises one of `_damage`."""
    wanted = None if columns is None else list(columns)
    arrow = file.read(columns=wanted, use_threads=file.metadata.num_rows > _FEW)
    return {name: _values(arrow.column(name)) for name in columns or arrow.column_names}


def _damage() -> tuple[type[Exception], ...]:
    """What reading a damaged file may raise."""
    import pyarrow as pa

    return (OSError, ValueError, KeyError, TypeError, pa.ArrowException)


def _values(column: "pa.ChunkedArray") -> NDArray[Any]:
    """A column as it was before it was written: statuses are numbers here."""
    import pyarrow as pa

    if not pa.types.is_dictionary(column.type):
        return np.asarray(column)
    names = column.unify_dictionaries().combine_chunks()
    codes = status_codes(np.array(names.dictionary.to_pylist(), dtype=str))
    return np.asarray(codes[np.asarray(names.indices)])


def _in_one_line(error: Exception, most: int) -> str:
    return shorten(" ".join(str(error).split()), most)


def _corrupt(path: Path, error: Exception) -> CorruptFileError:
    """In one line, with the remedy: it is long where the path is."""
    folder = path.parents[1]
    fault = _in_one_line(error, 110)
    then = f"continue with: nearflat resume {folder}"
    return CorruptFileError(f"{path}: cannot be read or is damaged ({fault}); {then}")


def examined(path: Path, scene: Scene, identity: str) -> Note | str:
    """What a chunk of this run says, or what is wrong with the file: every byte is looked at."""
    try:
        content = path.read_bytes()
        match = _NAME.fullmatch(path.name)
        if match is None or _sha(content)[:16] != match[2]:
            return "its bytes are not those that were written"
        with _opened(path, content) as file:
            note = _noted(file)
            if note.identity != identity:
                return "it belongs to another run"
            if note.index != int(match[1]):
                return f"it is chunk {note.index}"
            if note.samples != scene.length(note.index):
                return f"it stands for {note.samples:,} samples, not {scene.length(note.index):,}"
            _check_columns(scene, file.schema_arrow)
            table = _rows(file, None)
        return note if _has_digest(scene, table, note) else "its rows and counts have another digest than it says"
    except _damage() as error:
        return _in_one_line(error, 150)


def _has_digest(scene: Scene, table: Table, note: Note) -> bool:
    """Whether rows and counts are those of which the note has a digest.

    Text and times come back as other types than they were written from, and so may what a user's scene stores.
    """
    numbers = all(values.dtype.kind in "fiub" for values in table.values())
    return not (_ours(scene) and numbers) or digest_of(table, note.tally) == note.digest


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


def digest_of_file(path: Path) -> str:
    """SHA-256 of the bytes of a file."""
    return _sha(path.read_bytes())


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write JSON and commit it by a rename. NaN is refused: it is not JSON.

    A file that says the same stays as it is: a finished run can be summed up where nothing can be written.
    """
    text = json.dumps(content, indent=2, allow_nan=False) + "\n"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        if path.read_text(encoding="utf-8") == text:
            return
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
    """Read a JSON object. Raises CorruptFileError naming the file."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        fault = getattr(error, "strerror", None) or str(error)
        raise CorruptFileError(f"{path}: cannot be read ({fault})") from error
    if not isinstance(content, dict):
        raise CorruptFileError(f"{path}: cannot be read (it holds no JSON object)")
    return content

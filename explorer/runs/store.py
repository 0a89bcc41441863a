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
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from explorer.errors import RunError
from explorer.phase.results import status_codes, to_arrow
from explorer.runs.strangers import (
    LARGEST_JSON,
    StrangeError,
    check_counts,
    check_kinds,
    parquet_file,
    parse_json,
    plain_file,
)
from explorer.scenes.base import Table

if TYPE_CHECKING:
    import pyarrow as pa

_NAME = re.compile(r"chunk-(\d{6,})-([0-9a-f]{16})\.parquet")
_KEY = b"nearflat"
_LOOKED_AT = 256  # rows of a column, which tell whether its numbers repeat
_NOTE: dict[str, type] = {"index": int, "identity": str, "samples": int, "digest": str, "tally": dict}


@dataclass(frozen=True)
class Note:
    """What a chunk says of itself. samples: how many it stands for; digest: of its rows and counts."""

    index: int
    identity: str
    samples: int
    digest: str
    tally: dict[str, Any]


def found_chunks(folder: Path) -> dict[int, Path]:
    """The chunk files of a run by number; of two with the same number, one."""
    paths = {}
    for path in sorted((folder / "chunks").glob("chunk-*.parquet")):
        match = _NAME.fullmatch(path.name)
        if match:
            paths[int(match[1])] = path
    return paths


def number_of(path: Path) -> int | None:
    """The number in the name of a chunk; None where the name is not a chunk's."""
    match = _NAME.fullmatch(path.name)
    return int(match[1]) if match else None


def write_chunk(folder: Path, note: Note, table: Table) -> Path:
    """Write a chunk so that its name exists only if its content is complete and on disk.

    Page checksums are on: without them Parquet reads most single flipped bits back as data. The name is of the
    bytes that were to be written, so that a disk that kept others is found out.
    """
    import pyarrow as pa

    place = folder / "chunks"
    temporary = place / f".chunk-{note.index:06d}.{os.getpid()}.tmp"  # readers of the folder skip the dot
    try:
        text = json.dumps(vars(note), allow_nan=False)
        content = json.dumps({"note": text, "check": _sha(text.encode())})
        made = pa.BufferOutputStream()
        write_parquet(to_arrow(table), made, {_KEY: content.encode()})  # with units and meanings; status by name
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
    some = np.asarray(column.slice(0, _LOOKED_AT))
    return np.unique(some).size < some.size


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


def read_note(path: Path) -> Note:
    """What the footer of a chunk says. Raises RunError naming the file."""
    import pyarrow.parquet as pq

    try:
        content = parse_json((pq.read_metadata(parquet_file(path)).metadata or {})[_KEY])
        if _sha(content["note"].encode()) != content["check"]:
            raise ValueError("checksum of its metadata")
        said = parse_json(content["note"])
        check_kinds(said, _NOTE)
        check_counts(said["tally"])
        return Note(**said)
    except _damage() as error:
        raise _damaged(path, error) from error


def read_chunk(path: Path, columns: Sequence[str] | None = None) -> Table:
    """The kept rows of a chunk, checksums verified; some columns, or all. Raises RunError naming the file."""
    import pyarrow.parquet as pq

    try:
        arrow = pq.read_table(parquet_file(path), columns=columns, page_checksum_verification=True)
        return {name: _values(arrow.column(name)) for name in arrow.column_names}
    except _damage() as error:
        raise _damaged(path, error) from error


def _damage() -> tuple[type[Exception], ...]:
    """What reading a damaged file may raise."""
    import pyarrow as pa

    return (OSError, ValueError, KeyError, TypeError, AttributeError, IndexError, pa.ArrowException)


def _values(column: "pa.ChunkedArray") -> NDArray[Any]:
    """A column as it was before it was written: statuses are numbers here."""
    import pyarrow as pa

    if not pa.types.is_dictionary(column.type):
        return np.asarray(column)
    names = column.unify_dictionaries().combine_chunks()
    codes = status_codes(np.array(names.dictionary.to_pylist(), dtype=str))
    return np.asarray(codes[np.asarray(names.indices)])


def _damaged(path: Path, error: Exception) -> RunError:
    return RunError(f"{path}: cannot be read or is damaged ({error}); continue with: nearflat resume DIR")


def fault_of(path: Path, index: int, identity: str, samples: int) -> str | None:
    """What is wrong with a chunk that should have this number, identity and size; None if nothing is."""
    match = _NAME.fullmatch(path.name)
    try:
        if match is None or _digest_of_bytes(parquet_file(path))[:16] != match[2]:
            return "its bytes are not those that were written"
        note = read_note(path)
    except StrangeError as error:
        return f"its bytes are not those that were written: {error}"
    except (OSError, RunError) as error:
        return str(error)
    if note.identity != identity:
        return "it belongs to another run"
    if note.index != index:
        return f"it is chunk {note.index}"
    if note.samples != samples:
        return f"it stands for {note.samples} samples, not {samples}"
    return None


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

"""File formats of a run: immutable Parquet chunks and JSON, each committed by one rename."""

import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from explorer.errors import RunError
from explorer.scenes.base import Table


def chunk_path(folder: Path, index: int) -> Path:
    return folder / "chunks" / f"chunk-{index:06d}.parquet"


def write_chunk(path: Path, table: Table) -> None:
    """Write a chunk so that its name exists only if its content is complete and on disk.

    Page checksums are on: without them Parquet reads most single flipped bits back as data.
    """
    temporary = path.with_suffix(f".{os.getpid()}.tmp")
    try:
        arrow = pa.table({name: pa.array(values) for name, values in table.items()})
        with temporary.open("wb") as stream:
            pq.write_table(arrow, stream, compression="zstd", write_page_checksum=True)
            stream.flush()
            os.fsync(stream.fileno())
        if pq.read_metadata(temporary).num_rows != arrow.num_rows:
            raise RunError(f"{path}: the file read back differs from what was written")
        temporary.replace(path)
    except OSError as error:
        raise RunError(f"{path}: cannot be written ({error.strerror or error})") from error
    finally:
        temporary.unlink(missing_ok=True)


def read_chunk(path: Path) -> Table:
    """Read a chunk and verify its checksums. Raises RunError naming the file."""
    try:
        arrow = pq.read_table(path, page_checksum_verification=True)
    except (OSError, pa.ArrowException) as error:
        raise RunError(f"{path}: cannot be read or is damaged ({error}); run again with --resume") from error
    return {name: np.asarray(arrow.column(name)) for name in arrow.column_names}


def is_intact(path: Path) -> bool:
    """True if the chunk is there and every page agrees with its checksum."""
    if not path.exists():
        return False
    try:
        read_chunk(path)
    except RunError:
        return False
    return True


def read_chunks(folder: Path, count: int) -> Iterator[Table]:
    """All chunks in order."""
    for index in range(count):
        yield read_chunk(chunk_path(folder, index))


def digest_of(tables: Iterator[Table]) -> str:
    """SHA-256 over all columns of all chunks, in order: equal digests are equal numbers."""
    digest = hashlib.sha256()
    for table in tables:
        for name, values in table.items():
            digest.update(f"{name}:{values.dtype}:{values.size};".encode())
            digest.update(np.ascontiguousarray(values).tobytes())
    return digest.hexdigest()


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
        temporary.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """Read a JSON object. Raises RunError naming the file."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise RunError(f"{path}: cannot be read ({error})") from error

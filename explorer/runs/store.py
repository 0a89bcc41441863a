"""Files of a run: immutable chunks, each the bytes of a Parquet file, and JSON; each committed by one rename.

A chunk's name carries its number and a digest of its bytes: chunk-000007-<16 hex digits>.parquet. Any change of
the file is seen by hashing it. Its footer has the tally of all samples of the chunk, also of those whose rows are
not kept, so a summary reads footers only. A run without a folder holds the same bytes in memory.

These checks find what disks, networks and other programs do to files, and not a chunk that somebody writes anew
with checksums that fit.
"""

import contextlib
import errno
import hashlib
import json
import os
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from explorer.errors import RunError, shorten
from explorer.motion.threads import require_wanted
from explorer.paths import on_disk
from explorer.phase.columns import COLUMNS
from explorer.phase.results import Columns, status_codes, to_arrow
from explorer.runs.machine import arithmetic
from explorer.scenes.scene import Scene

NAME = r"chunk-[0-9]{6}-[0-9a-f]{16}\.parquet"
BEGUN = rf"\.({NAME}|run\.json|summary\.json)\.[0-9]+\.tmp"  # while it is written
_NOTE, _CHECK = b"nearflat", b"nearflat.sha256"  # of the footer: what it says, and the digest of that
# What file systems answer that cannot sync folders (older CIFS, network drives of WSL, some FUSE), or lock files
# (Lustre mounted plainly, NFS without the service for locks)
UNABLE = (errno.EINVAL, errno.EBADF, errno.EOPNOTSUPP, errno.ENOTSUP, errno.ENOSYS, errno.ENOLCK)
_DAMAGE = (OSError, ValueError, KeyError, TypeError, RecursionError, pa.ArrowException)  # of damaged files


class Chunk(NamedTuple):
    """A chunk of a run: its name, the file that has its bytes or these themselves, and what all chunks share.

    Whoever reads it is told where it is the chunk of another run, or another one under its name.
    """

    name: str
    content: Path | bytes
    identity: str

    @property
    def number(self) -> int:
        """The number in its name."""
        return int(self.name.split("-")[1])

    def data(self) -> bytes:
        """Its bytes."""
        return self.content if isinstance(self.content, bytes) else self.content.read_bytes()

    def note(self) -> dict[str, Any]:
        """What its footer says: index, identity, drawn, digest of rows and counts, tally, arithmetic of its maker.

        Raises RunError where it cannot be read, or belongs elsewhere.
        """
        with self._opened() as (_, note):
            return note

    def columns(self) -> list[str]:
        """The names of its columns. Raises RunError where it is damaged."""
        with self._opened() as (file, _):
            return list(file.schema_arrow.names)

    def arrow(self, columns: Sequence[str] | None = None) -> pa.Table:
        """Its kept rows, with units and meanings; some columns, or all. Raises RunError where it is damaged."""
        with self._opened() as (file, _):
            wanted = list(columns or file.schema_arrow.names)
            table = file.read(columns=wanted, use_threads=False)  # of a chunk one thread has soon read all
            return table.select(wanted).replace_schema_metadata()

    @contextlib.contextmanager
    def _opened(self) -> Iterator[tuple[pq.ParquetFile, dict[str, Any]]]:
        try:
            # Arrow would look for the kind of file system in a path, which takes as long as to open the file, and
            # would take a relative one with a colon for an address.
            content = self.content
            source = pa.BufferReader(content) if isinstance(content, bytes) else pa.OSFile(str(content.absolute()))
            with source, pq.ParquetFile(source, page_checksum_verification=True) as file:
                note = _noted(file)
                if note["identity"] != self.identity:
                    raise ValueError("it belongs to another run")
                if note["index"] != self.number:
                    raise ValueError(f"it is chunk {note['index']} under another name")
                yield file, note
        except _DAMAGE as error:
            where, fault = self.name if isinstance(self.content, bytes) else self.content, in_one_line(error)
            raise RunError(f"{where}: cannot be read or is damaged ({fault}); resume the run") from error

    def fault(self) -> str:
        """What is wrong with it as a chunk of this run, by all of its bytes and rows; empty where all is well."""
        try:
            content = self.data()
            if not self.name.endswith(f"-{sha256(content)[:16]}.parquet"):
                return "its bytes are not those that were written"
            inside = self._replace(content=content)
            note, table = inside.note(), table_of(inside.arrow())
            if digest_of(table, note["tally"]) != note["digest"]:
                return "its rows and counts have another digest than it says"
        except (RunError, *_DAMAGE) as error:
            return in_one_line(error.__cause__ or error)
        return ""


def chunks_in(folder: Path, identity: str) -> list[Chunk]:
    """The chunks of a run, in order: all files that have the name of one; they may be damaged."""
    return [Chunk(path.name, path, identity) for path in files_in(folder / "chunks", NAME)]


def files_in(folder: Path, pattern: str) -> list[Path]:
    """The files of a folder that have such a name, in order. All others are the user's; a pipe is no file."""
    there = folder.iterdir() if folder.is_dir() else ()
    return sorted(path for path in there if re.fullmatch(pattern, path.name) and path.is_file())


def examined(chunks: Sequence[Chunk], count: int) -> Iterator[tuple[Chunk, str]]:
    """Each chunk of a run of `count` with what is wrong with it; empty where all is well."""
    known = Counter(chunk.number for chunk in chunks)
    for chunk in chunks:
        if known[chunk.number] > 1:
            yield chunk, "there are two of its number"
        elif chunk.number >= count:
            yield chunk, f"is beyond the end of the run, which has {count:,} chunks"
        else:
            yield chunk, chunk.fault()


Done = tuple[Chunk, dict[str, int]]  # a chunk, and in which status its samples ended


def make_chunk(scene: Scene, index: int, identity: str, folder: Path | None) -> Done:
    """Compute a chunk, and write it where there is a folder; and in which status its samples ended."""
    table, tally = scene.chunk(index)
    arrow = to_arrow(table, known=COLUMNS | (scene.columns if isinstance(scene.columns, dict) else {}))
    read = {name: _values(arrow.column(name)) for name in table if table[name].dtype.kind not in "fiub"}
    note = {"index": index, "identity": identity, "drawn": scene.drawn(index), "tally": tally.state()}
    note["digest"], note["arithmetic"] = digest_of({**table, **read}, note["tally"]), arithmetic()
    text = json.dumps(note, allow_nan=False).encode()
    stream = pa.BufferOutputStream()
    _write_parquet(arrow, stream, {_NOTE: text, _CHECK: sha256(text).encode()})
    content = stream.getvalue().to_pybytes()
    chunk = Chunk(f"chunk-{index:06d}-{sha256(content)[:16]}.parquet", content, identity)
    if folder is not None:
        require_wanted()  # after a second interrupt the folder's lock is free, and nothing is written
        chunk = chunk._replace(content=commit(folder / "chunks" / chunk.name, content))
    return chunk, dict(tally.status)


def _write_parquet(table: pa.Table, stream: Any, metadata: dict[bytes, bytes]) -> None:
    """Write the rows of a chunk, and what the file says of itself.

    Digits of measured numbers repeat nowhere: lz4 took nothing off them and a fifth of the time, dictionaries made
    files a quarter larger in four times the time, and zstd takes off one part in eleven in twice the time. The
    metadata are added at the end, else the schema would hold them once more, in base 64. Without checksums of
    pages Parquet reads most single flipped bits back as data.
    """
    words = [field.name for field in table.schema if not pa.types.is_floating(field.type)]
    how: dict[str, Any] = {"compression": "none", "use_dictionary": words or False, "write_page_checksum": True}
    with pq.ParquetWriter(stream, table.schema, write_statistics=words or False, **how) as writer:
        writer.write_table(table)
        writer.add_key_value_metadata(metadata)


def _noted(file: pq.ParquetFile) -> dict[str, Any]:
    """What a footer says, its checksum verified. Raises one of `_DAMAGE`."""
    metadata = file.metadata.metadata or {}
    if _NOTE not in metadata or _CHECK not in metadata:
        raise ValueError("its metadata do not say which chunk it is")
    if sha256(metadata[_NOTE]).encode() != metadata[_CHECK]:
        raise ValueError("checksum of its metadata")
    return dict(json.loads(metadata[_NOTE]))


def table_of(arrow: pa.Table) -> Columns:
    """Rows as arrays."""
    return {name: _values(arrow.column(name)) for name in arrow.column_names}


def _values(column: pa.ChunkedArray) -> NDArray[Any]:
    """A column as an array: statuses are numbers here."""
    if not pa.types.is_dictionary(column.type):
        return np.asarray(column)
    names = column.unify_dictionaries().combine_chunks()
    codes = status_codes(np.array(names.dictionary.to_pylist(), dtype=str))
    return np.asarray(codes[np.asarray(names.indices)])


def digest_of(table: Columns, tally: dict[str, Any]) -> str:
    """SHA-256 over the kept rows and the counts of all: equal digests are equal numbers."""
    digest = hashlib.sha256(json.dumps(tally, sort_keys=True).encode())
    for name, values in table.items():
        digest.update(f"{name}:{values.size};".encode())
        if values.dtype.kind in "fiub":
            digest.update(f"{values.dtype}".encode())
            digest.update(np.ascontiguousarray(values).view(np.uint8).data)
        else:  # words and times of a user, which an array only points at
            digest.update(repr(values.tolist()).encode())
    return digest.hexdigest()


def sha256(content: str | bytes) -> str:
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()


def in_one_line(error: BaseException) -> str:
    """What an exception says, not too long."""
    return shorten(" ".join(str(error).split()), 150)


def commit(path: Path, content: bytes) -> Path:
    """Write a file so that its name exists only if its content is complete and on disk. Raises RunError."""
    begun = path.with_name(f".{path.name}.{os.getpid()}.tmp")  # readers of the folder skip the dot
    with on_disk(path), contextlib.ExitStack() as after:
        after.callback(begun.unlink, missing_ok=True)
        with begun.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        begun.replace(path)
        synced(path.parent)
    return path


def synced(folder: Path) -> bool:
    """Make the names of new files in a folder durable; False where the file system cannot. Raises OSError."""
    if os.name != "posix":
        return True
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
        return True
    except OSError as error:
        if error.errno not in UNABLE:
            raise
        return False
    finally:
        os.close(handle)


def as_json(content: dict[str, Any]) -> bytes:
    """As it stands in a file. Raises ValueError for NaN, which is not JSON."""
    return (json.dumps(content, indent=2, allow_nan=False) + "\n").encode()


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write JSON and commit it by a rename.

    A file that says the same stays as it is: a finished run can be summed up where nothing can be written.
    """
    if not path.is_file() or path.read_bytes() != as_json(content):
        commit(path, as_json(content))

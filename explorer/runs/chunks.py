"""The chunks of a run, in its folder or in memory, and what they make together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any, Protocol

from explorer.errors import InputError, RunError
from explorer.runs import store
from explorer.scenes.base import Chunks, Scene, Table, Tally

Columns = Sequence[str] | None


class Chunk(Protocol):
    """One computed chunk: what it says of itself, and its kept rows; RunError where it is damaged."""

    def note(self) -> store.Note: ...

    def table(self, columns: Columns = None) -> Table: ...


@dataclass(frozen=True)
class StoredChunk:
    """A chunk in a file."""

    path: Path

    def note(self) -> store.Note:
        return store.read_note(self.path)

    def table(self, columns: Columns = None) -> Table:
        return store.read_chunk(self.path, columns)


@dataclass(frozen=True)
class HeldChunk:
    """A chunk in memory."""

    said: store.Note
    rows: Table

    def note(self) -> store.Note:
        return self.said

    def table(self, columns: Columns = None) -> Table:
        return self.rows if columns is None else {name: self.rows[name] for name in columns}


@dataclass(frozen=True)
class Part:
    """One run of a scene and its chunks, stored in a folder or held in memory."""

    scene: Scene
    folder: Path | None = None
    held: dict[int, HeldChunk] = field(default_factory=dict)

    def __str__(self) -> str:
        return str(self.folder or "the run in memory")

    def found(self) -> Mapping[int, Chunk]:
        """The chunks that are there, by number; of two with the same number, one."""
        if self.folder is None:
            return self.held
        return {index: StoredChunk(path) for index, path in store.found_chunks(self.folder).items()}

    def complete(self) -> list[Chunk]:
        """All chunks, in order. Raises RunError where one is missing, or where there are two of its number."""
        paths = {} if self.folder is None else store.all_chunks(self.folder)
        found, count = self.found(), self.scene.chunks()
        missing = sum(index not in found for index in range(count))
        if missing:
            raise RunError(
                f"{self}: {missing} of {count} chunks are missing; continue with: nearflat resume {self}"
            )
        twice = [index for index, some in paths.items() if len(some) > 1]
        if twice:
            raise store.CorruptFileError(
                f"{self}: holds two of chunk {twice[0]}; continue with: nearflat resume {self}"
            )
        return [found[index] for index in range(count)]


def tables(parts: Sequence[Part], columns: Columns = None) -> Iterator[Table]:
    """The kept rows of all parts, chunk by chunk, in order."""
    return (chunk.table(columns) for chunk in chain.from_iterable(part.complete() for part in parts))


def add_up(parts: Sequence[Part]) -> tuple[Any, str]:
    """What the scene makes of all chunks of all parts, and their digest. Every footer is read once.

    Raises RunError where a chunk is missing or damaged.
    """
    digests: dict[int, list[str]] = {}

    def tallies(number: int, chunks: list[Chunk]) -> Iterator[Tally]:
        for chunk in chunks:
            note = chunk.note()
            digests.setdefault(number, []).append(note.digest)
            yield note.tally

    made = []
    for number, part in enumerate(parts):
        chunks = part.complete()
        made.append((part.scene, Chunks(tallies(number, chunks), (chunk.table() for chunk in chunks))))
    try:
        total = whole_scene(parts).add_up_several(made)
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        where = parts[0].folder or "the run"
        text = f"{where}: its counts are not those of {parts[0].scene.name}; see: nearflat verify {where}"
        raise RunError(text) from error
    for _, each in made:
        for _ in each.tallies:
            pass  # a scene that asks for rows only leaves the footers, and with them the digests, to be read
    return total, store.digest_of_all(chain.from_iterable(digests[number] for number in range(len(parts))))


def whole_scene(parts: Sequence[Part]) -> Scene:
    """The scene of all parts together."""
    return parts[0].scene.together([part.scene for part in parts[1:]])


def summary_of(parts: Sequence[Part]) -> tuple[Any, dict[str, Any]]:
    """All chunks added up, for pictures, and the scene's numbers."""
    total, digest = add_up(parts)
    scene = whole_scene(parts)
    numbers = {**scene.options(), **scene.summarise(total), "digest": digest}
    if len(parts) > 1:
        numbers["seed"] = [part.scene.seed for part in parts]
    return total, numbers

"""What a run will take, from parts of a few of its own chunks that are begun and thrown away.

What Parquet would write is told from how far some rows can be compressed: its library, with those that it loads,
takes longer to start than all the rest.
"""

import json
import shutil
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from explorer import compiled
from explorer.errors import InputError
from explorer.runs.amounts import size
from explorer.scenes.base import Scene, Table, Tally

_SECONDS = 0.05  # of computing: long against the clock's steps, short for whoever waits
_PARTS = 16  # of a chunk, one of which is computed
_MOST_PROBES = 16  # parts in all: a whole chunk
_FOOTER = 800.0  # bytes of a file for each column, measured
_PACKED_ROWS = 4096  # of a column are compressed
# Samples whose room is not asked for: they take some hundred megabytes at most, and less time than to look.
_FEW = 1_000_000


@dataclass
class Probed:
    """Sums over parts of some chunks.

    chunks: how many; samples: in the parts; of: in the whole chunks. seconds: of the processor; rows: bytes of the
    parts' rows that are kept; largest: the same of a whole chunk; stored: bytes of the whole chunks as files.
    """

    chunks: int = 0
    samples: int = 0
    of: int = 0
    seconds: float = 0.0
    rows: float = 0.0
    largest: float = 0.0
    stored: float = 0.0


def probe(scene: Scene, chunks: Sequence[int], say: Callable[[str], None]) -> Probed:
    """Begin some of these chunks, the middle one first, until they took long enough; writes nothing.

    Time is that of the processor, so that other programs do not count. say: is told when kernels are compiled.
    """
    sums = Probed()
    compiled.compile_missing(scene.kernels, say)
    for place in _spread(len(chunks)):
        index = chunks[place]
        if sums.chunks == 0:
            scene.begin(index, _PARTS)  # loads compiled code and fills caches, which no other chunk has to do
        began = time.process_time()
        rows, tally, samples = scene.begin(index, _PARTS)
        sums.seconds += time.process_time() - began
        plain, times = float(sum(column.nbytes for column in rows.values())), scene.length(index) / samples
        sums.chunks += 1
        sums.samples += samples
        sums.of += scene.length(index)
        sums.rows += plain
        sums.largest = max(sums.largest, plain * times)
        sums.stored += bytes_stored(rows, tally, times)
        if sums.seconds > _SECONDS or sums.chunks == _MOST_PROBES:
            break
    return sums


def bytes_stored(rows: Table, tally: Tally, times: float = 1.0) -> float:
    """What a chunk with these counts, and so many times these rows, takes as a Parquet file, about."""
    total = float(len(json.dumps(json.dumps(tally))))  # as text in the footer
    for values in rows.values():
        some = values[:_PACKED_ROWS]
        text = some.tobytes() if some.dtype.kind in "biuf" else "\n".join(map(str, some)).encode()
        total += _FOOTER + len(zlib.compress(text, 1)) * times * max(1.0, len(values) / _PACKED_ROWS)
    return total


def _spread(count: int) -> Iterator[int]:
    """Chunks from all over the run, evenly, however soon one stops: 1/2, 1/4, 3/4, 1/8, ..."""
    seen, step = set[int](), 2
    while len(seen) < count and step <= 4 * _MOST_PROBES:
        for part in range(1, step, 2):
            index = part * count // step
            if index not in seen:
                seen.add(index)
                yield index
        step *= 2


def free_bytes(folder: Path) -> int | None:
    """How much may be written where a folder is, or will be made; None where the system does not tell."""
    there = next((place for place in (folder, *folder.absolute().parents) if place.is_dir()), folder)
    try:
        room = shutil.disk_usage(there)
    except OSError:
        return None
    return room.free if room.total else None


def require_room(
    scene: Scene, chunks: Sequence[int], folder: Path, begun: bool, say: Callable[[str], None]
) -> None:
    """Raise InputError where chunks that are to be computed need more room than there is on the disk.

    begun: whether there are some already, so that the run is continued.
    """
    samples = sum(map(scene.length, chunks))
    free = free_bytes(folder) if samples > _FEW else None
    if free is None:
        return
    sums = probe(scene, chunks, say)
    needed = sums.stored * samples / sums.of
    if needed > free:
        onward = f"make room, then continue with: nearflat resume {folder}"
        remedy = onward if begun else "give --keep none, fewer --samples, or another --out"
        raise InputError(
            f"--out {folder}: the run needs about {size(needed)}, and {size(free)} are free there; {remedy}"
        )

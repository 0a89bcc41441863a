"""What a run will cost: time, memory and room on the disk, from parts of a few of its own chunks.

Chunks from all over the run are begun and thrown away, the middle one first, until they took long enough. Time
is that of the processor, so that other programs do not count. What Parquet would write is told from how far some
rows can be compressed: its library, with those that it loads, takes longer to start than all the rest.
"""

import json
import sys
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from os import cpu_count

from explorer import compiled
from explorer.errors import note
from explorer.runs.settings import Asked
from explorer.scenes.base import Scene, Table, Tally

_SECONDS = 0.05  # of computing: long against the clock's steps, short for whoever waits for a plan
_PARTS = 16  # of a chunk, one of which is computed
_MOST_PROBES = 16  # parts in all: a whole chunk
_MOST_COUNTED = 100_000  # chunks whose lengths are added up one by one
_DRAWING = 90e6  # memory that drawing takes, measured
# Of Parquet files: time for each byte before compression, and the footer's share of each column; measured.
_SECONDS_PER_BYTE, _FOOTER = 0.5e-8, 800.0
_PACKED_ROWS = 4096  # of a column are compressed
# Of one picture in PNG and SVG, measured over all scenes; maps take 0.75, and histograms 0.5.
_SECONDS_PER_PICTURE, _BYTES_PER_PICTURE = 0.6, 250_000


@dataclass(frozen=True)
class Estimate:
    """What a run is expected to cost on this machine.

    seconds: from its start to its last picture, where the cores are free and the kernels are compiled;
    seconds_for_figures: those of them that the pictures take. memory: of the whole process, bytes. disk: of the
    folder, bytes; 0 where there is none. probed: of how many chunks a part was computed to say so.
    """

    chunks: int
    samples: int
    seconds: float
    seconds_for_figures: float
    memory: float
    disk: float
    probed: int


def estimate(asked: Asked) -> Estimate:
    """Compute a few chunks and extrapolate; writes nothing."""
    scene, manner = asked.scene, asked.manner
    base = _memory_now()
    count = scene.chunks()
    starting, seconds, written, largest, probes, probed, stood = 0.0, 0.0, 0.0, 0.0, 0, 0, 0
    for index in _spread(count):
        if probes == 0:
            # A command starts as this one did; in Python all is loaded by now.
            starting = time.process_time() if manner.command is not None else 0.0
            compiled.compile_missing(scene.kernels, lambda text: note(text, manner.quiet))
            scene.begin(index, _PARTS)  # loads compiled code and fills caches, which no other chunk has to do
        began = time.process_time()
        rows, tally, length = scene.begin(index, _PARTS)
        seconds += time.process_time() - began
        plain, times = float(sum(column.nbytes for column in rows.values())), scene.length(index) / length
        if asked.out is not None:
            seconds += plain * _SECONDS_PER_BYTE
            written += bytes_stored(rows, tally, times)
        largest = max(largest, plain * times)
        probes, probed, stood = probes + 1, probed + length, stood + scene.length(index)
        if seconds > _SECONDS or probes == _MOST_PROBES:
            break
    pictures = scene.figure_count if manner.formats != () and asked.out is not None else 0
    drawing = pictures * _SECONDS_PER_PICTURE
    lanes = max(1, min(manner.workers.jobs, cpu_count() or 1, count))
    samples = sum(map(scene.length, range(min(count, _MOST_COUNTED)))) * max(1, count // _MOST_COUNTED)
    share = samples / probed
    return Estimate(
        count,
        samples,
        starting + seconds * share / lanes + drawing,
        drawing,
        base + min(manner.workers.jobs, count) * _bytes_at_work(scene, largest) + (_DRAWING if pictures else 0.0),
        (written * samples / stood + pictures * _BYTES_PER_PICTURE) if asked.out is not None else 0.0,
        probes,
    )


def bytes_stored(rows: Table, tally: Tally, times: float = 1.0) -> float:
    """What a chunk with these counts, and so many times these rows, takes as a Parquet file, about."""
    size = float(len(json.dumps(json.dumps(tally))))  # as text in the footer
    for values in rows.values():
        some = values[:_PACKED_ROWS]
        text = some.tobytes() if some.dtype.kind in "biuf" else "\n".join(map(str, some)).encode()
        size += _FOOTER + len(zlib.compress(text, 1)) * times * max(1.0, len(values) / _PACKED_ROWS)
    return size


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


def _bytes_at_work(scene: Scene, kept: float) -> float:
    """Memory of one chunk while it is computed."""
    each = getattr(scene, "bytes_per_sample", 0.0)
    return max(kept, float(each * scene.length(0)))


def _memory_now() -> float:
    """What this process takes at its largest, with all libraries loaded; bytes."""
    if sys.platform == "win32":
        from explorer.scenes.base import BASE_MEMORY

        return BASE_MEMORY
    import resource

    largest = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return float(largest if sys.platform == "darwin" else 1024 * largest)

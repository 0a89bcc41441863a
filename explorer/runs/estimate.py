"""What a run will cost: time, memory and room on the disk, from a few of its own chunks.

Chunks from all over the run are computed and thrown away, the middle one first, until they took some seconds. Time
is that of the processor, so that other programs do not count; what is written is the chunk's own Parquet file.
"""

import io
import json
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from os import cpu_count

from explorer import compiled
from explorer.phase.results import to_arrow
from explorer.runs.settings import Asked
from explorer.runs.store import write_parquet
from explorer.scenes.base import Scene

_SECONDS = 1.5
_MOST_PROBES = 16
_MOST_COUNTED = 100_000  # chunks whose lengths are added up one by one
_DRAWING = 90e6  # memory that drawing takes, measured
# Of one picture in PNG and SVG, measured over all scenes; slices and maps take more, and histograms less.
_SECONDS_PER_PICTURE, _BYTES_PER_PICTURE = 1.2, 250_000
_PICTURES = {"falling-set": 4, "measure-zero": 3, "one-sided": 7, "portrait": 10, "race-angles": 2}


@dataclass(frozen=True)
class Estimate:
    """What a run is expected to cost on this machine.

    seconds: from its start to its last picture, where the cores are free and the kernels are compiled;
    seconds_for_figures: those of them that the pictures take. memory: of the whole process, bytes. disk: of the
    folder, bytes; 0 where there is none. probed: how many chunks were computed to say so.
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
    compiled.warmup()
    scene, manner = asked.scene, asked.manner
    base = _memory_now()
    count = scene.chunks()
    starting, seconds, written, largest, probes, probed = 0.0, 0.0, 0.0, 0.0, 0, 0
    for index in _spread(count):
        if probes == 0:
            scene.process(index)  # loads compiled code and fills caches, which no other chunk has to do
            # A command starts as this one did; in Python all is loaded by now.
            starting = time.process_time() if manner.command is not None else 0.0
        began = time.thread_time()
        rows, tally = scene.process(index)
        content = io.BytesIO()
        table = to_arrow(rows).replace_schema_metadata({"nearflat": json.dumps(json.dumps(tally))})
        write_parquet(table, content)
        seconds += time.thread_time() - began
        written += content.getbuffer().nbytes
        largest = max(largest, float(sum(column.nbytes for column in rows.values())))
        probes, probed = probes + 1, probed + scene.length(index)
        if seconds > _SECONDS or probes == _MOST_PROBES:
            break
    pictures = _PICTURES.get(scene.name, 0) if manner.formats != () and asked.out is not None else 0
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
        (written * share + pictures * _BYTES_PER_PICTURE) if asked.out is not None else 0.0,
        probes,
    )


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

"""What a run will cost: time, memory and room on the disk, from parts of a few of its own chunks."""

import sys
import time
from dataclasses import dataclass
from os import cpu_count

from explorer.errors import note
from explorer.runs.probes import free_bytes, probe
from explorer.runs.settings import Asked
from explorer.scenes.base import Scene

_DRAWING = 90e6  # memory that drawing takes, measured
_SECONDS_PER_BYTE = 0.5e-8  # to write Parquet, before compression; measured
# Of one picture in PNG and SVG, measured over all scenes; maps take 0.75, and histograms 0.5.
_SECONDS_PER_PICTURE, _BYTES_PER_PICTURE = 0.6, 250_000


@dataclass(frozen=True)
class Estimate:
    """What a run is expected to cost on this machine.

    seconds: from its start to its last picture, where the cores are free and the kernels are compiled;
    seconds_for_figures: those of them that the pictures take. memory: of the whole process, bytes. disk: of the
    folder, bytes; 0 where there is none. free: bytes that may be written there; None where there is no folder, or
    the system does not tell. probed: of how many chunks a part was computed to say so.
    """

    chunks: int
    samples: int
    seconds: float
    seconds_for_figures: float
    memory: float
    disk: float
    free: int | None
    probed: int


def estimate(asked: Asked) -> Estimate:
    """Compute a few chunks and extrapolate; writes nothing."""
    scene, manner, stored = asked.scene, asked.manner, asked.out is not None
    base = _memory_now()
    # A command starts as this one did; in Python all is loaded by now.
    starting = time.process_time() if manner.command is not None else 0.0
    count = scene.chunks()
    samples = sum(map(scene.length, range(count)))
    sums = probe(scene, range(count), lambda text: note(text, manner.quiet))
    seconds = sums.seconds + (sums.rows * _SECONDS_PER_BYTE if stored else 0.0)
    pictures = scene.figure_count if manner.formats != () and stored else 0
    drawing = pictures * _SECONDS_PER_PICTURE
    lanes = max(1, min(manner.workers.jobs, cpu_count() or 1, count))
    return Estimate(
        count,
        samples,
        starting + seconds * samples / sums.samples / lanes + drawing,
        drawing,
        base
        + min(manner.workers.jobs, count) * _bytes_at_work(scene, sums.largest)
        + (_DRAWING if pictures else 0.0),
        (sums.stored * samples / sums.of + pictures * _BYTES_PER_PICTURE) if stored else 0.0,
        None if asked.out is None else free_bytes(asked.out),
        sums.chunks,
    )


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

"""What a run will cost, time, memory and room on the disk: some of its chunks are computed and thrown away."""

import contextlib
import shutil
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from explorer import compiled
from explorer.errors import InputError, note
from explorer.measure.sampling import PER_STREAM
from explorer.runs.settings import Settings, samples_of
from explorer.scenes.scene import SampledScene, Scene

_BASE_MEMORY = 270e6  # bytes of libraries and compiled code in the process of a run, measured
_LOADING = 1.5  # s of a command for compiled code, Arrow, and SciPy of the summary; measured
_COPIES = 5  # of the rows of a chunk, while it is made: block by block, joined, of Arrow, as bytes; measured


@dataclass(frozen=True)
class RunCost:
    """What a run is expected to cost on this machine.

    seconds: without pictures, where the cores are free and the kernels are compiled; with those that the command
    takes to start. memory: of its process, bytes. disk: of the folder, bytes; 0 where there is none. free: bytes
    that may be written there; None where there is no folder. probed: how many chunks were computed to say so.
    """

    chunks: int
    samples: int
    seconds: float
    memory: float
    disk: float
    free: int | None
    probed: int


def estimate(scene: Scene, settings: Settings) -> RunCost:
    """Compute a few chunks and scale what they take; writes nothing."""
    from explorer.runs.store import make_chunk  # loads Arrow

    jobs, count = min(settings.jobs, scene.chunks), scene.chunks
    # A command starts as this one did; in Python all is loaded by now.
    starting = time.process_time() + _LOADING if settings.command is not None else 0.0
    compiled.warmup(scene.kernels, lambda text: note(text, not settings.progress))
    probed = _to_probe(scene)
    make_chunk(scene, probed[0], "", None)  # loads compiled code and fills caches, which no other has to do
    began = time.process_time()  # of the processor, so that other programs do not count
    sizes = [len(make_chunk(scene, index, "", None)[0].data()) for index in probed]
    seconds = (time.process_time() - began) * count / len(probed) / min(jobs, compiled.usable_cores())
    stored, free = sum(sizes) * count / len(probed), _free_bytes(settings.out) if settings.out else None
    disk, held = (stored, 0.0) if settings.out else (0.0, stored)
    at_work = scene.bytes_per_sample * min(scene.length(0), PER_STREAM) + _COPIES * max(sizes)
    memory = max(_BASE_MEMORY, _peak_memory()) + jobs * at_work + held
    return RunCost(count, samples_of(scene), starting + seconds, memory, disk, free, len(probed))


def require_room(scene: Scene, settings: Settings, missing: int) -> None:
    """Raise InputError where the chunks that are missing would fill the disk, unless the settings allow it.

    Where even the memory for all samples would fit, nothing is probed.
    """
    free, at_most = _free_bytes(settings.out or Path()), missing * scene.length(0) * scene.bytes_per_sample
    if not settings.overfill and free < at_most:
        needed = estimate(scene, settings).disk * missing / scene.chunks
        if free < needed:
            sizes = f"needs {tqdm.format_sizeof(needed)}B, and {tqdm.format_sizeof(free)}B are free"
            raise InputError(f"out {settings.out}: the run {sizes}; store fewer rows (keep), or set overfill")


def _peak_memory() -> float:
    """Most bytes that this process has had, with states that a user gives; 0 where the system does not say."""
    with contextlib.suppress(ImportError):
        import resource

        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        return float(peak if sys.platform == "darwin" else 1024 * peak)
    return 0.0


def _to_probe(scene: Scene) -> list[int]:
    """Chunks that stand for all: the middle one, and the outer ones too where they differ."""
    alike = isinstance(scene, SampledScene) and type(scene).length is SampledScene.length
    return [scene.chunks // 2] if alike else sorted({0, scene.chunks // 2, scene.chunks - 1})


def _free_bytes(folder: Path) -> int:
    """How much may be written where a folder is, or will be made."""
    return shutil.disk_usage(next(place for place in (folder, *folder.absolute().parents) if place.is_dir())).free

"""What a run will cost, time, memory and room on the disk: some of its chunks are computed and thrown away."""

import json
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

from explorer import compiled
from explorer.errors import note
from explorer.measure.tallies import Tally
from explorer.runs.settings import Settings, samples_of
from explorer.scenes.scene import SampledScene, Scene, Table

_BASE_MEMORY = 270e6  # bytes of libraries and compiled code in the process of a run, measured


@dataclass(frozen=True)
class Estimate:
    """What a run is expected to cost on this machine.

    seconds: without pictures, where the cores are free and the kernels are compiled. memory: of its process,
    bytes. disk: of the folder, bytes; 0 where there is none. free: bytes that may be written there; None where
    there is no folder. probed: how many chunks were computed to say so.
    """

    chunks: int
    samples: int
    seconds: float
    memory: float
    disk: float
    free: int | None
    probed: int


def estimate(scene: Scene, settings: Settings) -> Estimate:
    """Compute a few chunks and scale what they take; writes nothing."""
    jobs, count = min(settings.jobs, scene.chunks), scene.chunks
    # A command starts as this one did; in Python all is loaded by now.
    starting = time.process_time() if settings.command is not None else 0.0
    compiled.compile_missing(scene.kernels, lambda text: note(text, not settings.progress))
    probed = _to_probe(scene)
    scene.chunk(probed[0])  # loads compiled code and fills caches, which no other has to do
    began = time.process_time()  # of the processor, so that other programs do not count
    sizes = [_bytes_of(*scene.chunk(index)) for index in probed]
    seconds = (time.process_time() - began) * count / len(probed) / min(jobs, compiled.usable_cores())
    stored, free = sum(sizes) * count / len(probed), _free_bytes(settings.out) if settings.out else None
    disk, held = (stored, 0.0) if settings.out else (0.0, stored)
    at_work = scene.bytes_per_sample * scene.length(0) if isinstance(scene, SampledScene) else max(sizes)
    memory = _BASE_MEMORY + jobs * at_work + held
    return Estimate(count, samples_of(scene), starting + seconds, memory, disk, free, len(probed))


def _bytes_of(table: Table, tally: Tally) -> int:
    """What a chunk takes, about: Parquet, which is slow to load, takes little off measured numbers."""
    return sum(values.nbytes for values in table.values()) + len(json.dumps(tally.state()))


def _to_probe(scene: Scene) -> list[int]:
    """Chunks that stand for all: the middle one, and the outer ones too where they differ."""
    alike = isinstance(scene, SampledScene) and type(scene).length is SampledScene.length
    return [scene.chunks // 2] if alike else sorted({0, scene.chunks // 2, scene.chunks - 1})


def _free_bytes(folder: Path) -> int:
    """How much may be written where a folder is, or will be made."""
    return shutil.disk_usage(next(place for place in (folder, *folder.absolute().parents) if place.is_dir())).free

"""What the command line calls, for Python."""

from pathlib import Path
from typing import Any

from explorer.errors import InputError, note
from explorer.runs.run import Run, execute
from explorer.runs.workers import Workers
from explorer.scenes.base import SampledScene
from explorer.scenes.options import build_scene, chunk_size_for
from explorer.scenes.registry import scene_class


def run(
    scene: str,
    *,
    out: Path | str | None = None,
    jobs: int = 2,
    backend: str = "threads",
    scheduler: str | None = None,
    memory: str | float | None = None,
    resume: bool = False,
    quiet: bool = True,
    **options: Any,
) -> Run:
    """Run a scene and store it; returns its summary, folder and samples.

    scene: 'falling-set', 'measure-zero', 'one-sided', 'portrait' or 'race-angles'. options, as on the command
    line: disk (a Disk, a name, or several for one-sided), samples, seed, box, max_energy, eta_hat,
    accuracy, method, slices, grid, keep ('near', 'all', 'none': which samples are stored), states (a
    Parquet file instead of box), chunk_size; for measure-zero energy, gaussian, density (a function of four
    arrays), ladder, tube, sampling; for portrait sigma3_bar, sigma4_bar or eta_hat, energies, well. memory:
    a budget such as '1GB', which decides chunk_size. backend: 'threads',
    'processes' or 'dask', with the scheduler's address.
    out: a folder that holds no run yet (default results/<scene>-<disk>-<seed>).
    Raises InputError before anything is written; RunError if writing fails.
    """
    workers = Workers(jobs, backend, scheduler)
    if memory is not None:
        options["chunk_size"] = _chunk_size(scene, memory, jobs, options.get("chunk_size"))
        note(f"--memory {memory}: chunks of {options['chunk_size']:,} samples", quiet)
    return execute(build_scene(scene, **options), out, workers=workers, resume=resume, quiet=quiet)


def _chunk_size(scene: str, memory: str | float, jobs: int, given: int | None) -> int:
    kind = scene_class(scene)
    if given is not None or not issubclass(kind, SampledScene):
        raise InputError(f"--memory {memory}: is for falling-set and race-angles, and without chunk_size")
    return chunk_size_for(kind, memory, jobs)

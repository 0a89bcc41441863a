"""What the command line calls, for Python."""

from pathlib import Path
from typing import Any

from explorer.runs.run import Run, execute
from explorer.scenes.build import build_scene


def run(
    scene: str,
    *,
    out: Path | str | None = None,
    jobs: int = 2,
    backend: str = "threads",
    resume: bool = False,
    quiet: bool = True,
    **options: Any,
) -> Run:
    """Run a scene and store it; returns its summary, folder and samples.

    scene: 'falling-set', 'one-sided' or 'race-angles'. options, as on the command line: disk (a Disk,
    a name, or several for one-sided), samples, seed, box, max_energy, eta_hat, accuracy, method,
    slices, grid. out: a folder that holds no run yet (default results/<scene>-<disk>-<seed>).
    Raises InputError before anything is written; RunError if writing fails.
    """
    made = build_scene(scene, **options)
    return execute(made, out, jobs=jobs, backend=backend, resume=resume, quiet=quiet)

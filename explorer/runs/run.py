"""One run from start to end: folder, chunks, summary, figures."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.errors import InputError, RunError
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.progress import Progress, note
from explorer.runs.workers import check_workers, compute_chunks
from explorer.scenes.base import Scene, Table


@dataclass(frozen=True)
class Run:
    """A finished run: its scene, folder and summary; `tables()` reads the samples, chunk by chunk."""

    scene: Scene
    folder: Path
    summary: dict[str, Any]

    def tables(self) -> Iterator[Table]:
        return store.read_chunks(self.folder, self.scene.chunks())


def execute(
    scene: Scene,
    out: Path | str | None = None,
    *,
    jobs: int = 2,
    backend: str = "threads",
    resume: bool = False,
    quiet: bool = True,
    figures: bool = True,
) -> Run:
    """Compute a scene into a folder. Raises InputError before anything is written, RunError after.

    The numbers depend on the scene alone, never on jobs, backend or an interruption.
    """
    check_workers(jobs, backend)
    folder = Path(out) if out is not None else folders.default_folder(scene)
    folders.open_folder(folder, scene, resume)
    try:
        return _fill(scene, folder, jobs, backend, quiet, figures)
    except InputError as error:
        # Only a run can tell that some input leads nowhere; by then the folder holds it.
        raise RunError(f"{error} ({folder} holds what was computed)") from error


def _fill(scene: Scene, folder: Path, jobs: int, backend: str, quiet: bool, figures: bool) -> Run:
    """Compute, store, summarise and draw."""
    compiled.warmup(lambda text: note(text, quiet))
    started, clock = folders.now(), time.monotonic()
    folders.write_record(folder, scene, started, finished=None, jobs=jobs, backend=backend)
    progress = Progress(scene.chunks(), scene.name, quiet)
    try:
        computed = compute_chunks(scene, folder, jobs, backend, progress)
    finally:
        progress.close()
    seconds = time.monotonic() - clock

    def tables() -> Iterator[Table]:
        return store.read_chunks(folder, scene.chunks())

    summary = {**scene.options(), **scene.summarise(tables), "digest": store.digest_of(tables())}
    store.write_json(folder / "summary.json", summary)
    if figures:
        for name, picture in scene.figures(summary, tables):
            for kind in ("png", "svg"):
                picture.savefig(folder / "figures" / f"{name}.{kind}", dpi=150)
    folders.write_record(
        folder,
        scene,
        started,
        finished=folders.now(),
        jobs=jobs,
        backend=backend,
        chunks_computed=computed,
        seconds_for_chunks=round(seconds, 3),
    )
    return Run(scene, folder, summary)

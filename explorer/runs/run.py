"""One run from start to end: folder, chunks, summary, figures."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.errors import InputError, Interrupted, RunError, note
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.interrupt import graceful
from explorer.runs.lock import only_one
from explorer.runs.progress import Progress
from explorer.runs.workers import Workers
from explorer.scenes.base import Chunks, Scene, Table


@dataclass(frozen=True)
class Run:
    """A finished run: its scene, folder and summary; `tables()` reads the kept samples, chunk by chunk."""

    scene: Scene
    folder: Path
    summary: dict[str, Any]

    def tables(self) -> Iterator[Table]:
        return stored(self.folder, self.scene).tables()


def stored(folder: Path, scene: Scene) -> Chunks:
    """The chunks of a finished run. Raises RunError where one is missing or damaged."""
    paths = store.found_chunks(folder)
    missing = [index for index in range(scene.chunks()) if index not in paths]
    if missing:
        raise RunError(
            f"{folder}: {len(missing)} of {scene.chunks()} chunks are missing; continue with: "
            f"nearflat resume {folder}"
        )
    order = [paths[index] for index in range(scene.chunks())]
    return Chunks(
        tallies=lambda: (store.read_note(path).tally for path in order),
        tables=lambda: (store.read_chunk(path) for path in order),
    )


def execute(
    scene: Scene,
    out: Path | str | None = None,
    *,
    workers: Workers | None = None,
    resume: bool = False,
    quiet: bool = True,
    figures: bool = True,
) -> Run:
    """Compute a scene into a folder. Raises InputError before anything is written, RunError after.

    The numbers depend on the scene alone, never on workers or an interruption. The first Ctrl-C or SIGTERM
    lets running chunks finish; then Interrupted is raised, which says how to continue.
    """
    workers = workers or Workers()
    folder = Path(out) if out is not None else folders.default_folder(scene)
    folders.open_folder(folder, scene, resume)
    with only_one(folder):
        try:
            return _fill(scene, folder, workers, quiet, figures)
        except InputError as error:
            # Only a run can tell that some input leads nowhere; by then the folder holds it.
            raise RunError(f"{error} ({folder} holds what was computed)") from error


def _fill(scene: Scene, folder: Path, workers: Workers, quiet: bool, figures: bool) -> Run:
    """Compute, store, summarise and draw."""
    compiled.warmup(lambda text: note(text, quiet))
    started, clock = folders.begun(folder), time.monotonic()
    how = {"jobs": workers.jobs, "backend": workers.backend}
    folders.write_record(folder, scene, started, finished=None, **how)
    computed = _compute(scene, folder, workers, quiet)
    seconds = time.monotonic() - clock
    summary = summarise(folder, scene)
    if figures:
        for name, picture in scene.figures(summary, stored(folder, scene)):
            for kind in ("png", "svg"):
                picture.savefig(folder / "figures" / f"{name}.{kind}", dpi=150)
    folders.write_record(
        folder,
        scene,
        started,
        finished=folders.now(),
        **how,
        chunks_computed=computed,
        seconds_for_chunks=round(seconds, 3),
    )
    return Run(scene, folder, summary)


def _compute(scene: Scene, folder: Path, workers: Workers, quiet: bool) -> int:
    """Compute what is missing or bad; returns how many chunks that was."""
    identity = folders.digest_of_identity(scene)
    missing = folders.missing_chunks(folder, scene, identity, lambda text: note(text, quiet))
    progress = Progress(scene.chunks(), scene.name, quiet)
    progress.already(scene.chunks() - len(missing))
    done = 0
    with graceful(folder, quiet) as stop:
        try:
            for status in workers.compute(scene, identity, missing, folder, stop):
                done += 1
                progress.advance(status)
        except KeyboardInterrupt:
            stop.set()
        finally:
            progress.close()
        if stop.is_set() and done < len(missing):
            there = scene.chunks() - len(missing) + done
            raise Interrupted(
                f"stopped with {there} of {scene.chunks()} chunks done; continue with: nearflat resume {folder}"
            )
    return done


def summarise(folder: Path, scene: Scene) -> dict[str, Any]:
    """The scene's numbers from the stored chunks, written to summary.json."""
    chunks, paths = stored(folder, scene), store.found_chunks(folder)
    notes = (store.read_note(paths[index]) for index in range(scene.chunks()))
    summary = {**scene.options(), **scene.summarise(chunks), "digest": store.digest_of_all(notes)}
    store.write_json(folder / "summary.json", summary)
    return summary

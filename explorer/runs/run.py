"""One run from start to end: folder, chunks, summary, figures."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from explorer import compiled
from explorer.errors import InputError, Interrupted, RunError, note
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.interrupt import graceful
from explorer.runs.lock import only_one
from explorer.runs.progress import Progress
from explorer.runs.workers import Task, Workers
from explorer.scenes.base import Chunks, Scene, Table, Tally


@dataclass(frozen=True)
class Run:
    """A finished run: its scene, folder and summary; `tables()` reads the kept samples, chunk by chunk."""

    scene: Scene
    folder: Path
    summary: dict[str, Any]

    def tables(self) -> Iterator[Table]:
        """The kept samples, chunk by chunk, in order. Raises RunError where a chunk is missing or damaged."""
        return (store.read_chunk(path) for path in _chunks_of(self.folder, self.scene))


def _chunks_of(folder: Path, scene: Scene) -> list[Path]:
    """The chunks of a finished run, in order. Raises RunError where one is missing."""
    paths = store.found_chunks(folder)
    missing = [index for index in range(scene.chunks()) if index not in paths]
    if missing:
        raise RunError(
            f"{folder}: {len(missing)} of {scene.chunks()} chunks are missing; continue with: "
            f"nearflat resume {folder}"
        )
    return [paths[index] for index in range(scene.chunks())]


def add_up(folder: Path, scene: Scene) -> tuple[Any, str]:
    """What the scene makes of all chunks, and the digest of the run. Every footer is read once.

    Raises RunError where a chunk is missing or damaged.
    """
    paths, digests = _chunks_of(folder, scene), []

    def tallies() -> Iterator[Tally]:
        for path in paths:
            note = store.read_note(path)
            digests.append(note.digest)
            yield note.tally

    chunks = Chunks(tallies(), (store.read_chunk(path) for path in paths))
    total = scene.add_up(chunks)
    for _ in chunks.tallies:
        pass  # a scene that asks for rows only leaves the footers, and with them the digests, to be read
    return total, store.digest_of_all(digests)


class Manner(NamedTuple):
    """What a run says and leaves besides its numbers."""

    quiet: bool
    figures: bool
    command: str | None


def execute(
    scene: Scene,
    out: Path | str | None = None,
    *,
    workers: Workers | None = None,
    resume: bool = False,
    quiet: bool = True,
    figures: bool = True,
    command: str | None = None,
) -> Run:
    """Compute a scene into a folder. Raises InputError before anything is written, RunError after.

    The numbers depend on the scene alone, never on workers or an interruption. The first Ctrl-C or SIGTERM
    lets running chunks finish; then Interrupted is raised, which says how to continue. command: the command line
    that asked for the run, for run.json.
    """
    workers = workers or Workers()
    folder = Path(out) if out is not None else folders.default_folder(scene)
    folders.open_folder(folder, scene, resume)
    with only_one(folder):
        try:
            return _fill(scene, folder, workers, Manner(quiet, figures, command))
        except InputError as error:
            # Only a run can tell that some input leads nowhere; by then the folder holds it.
            raise RunError(f"{error} ({folder} holds what was computed)") from error


def _fill(scene: Scene, folder: Path, workers: Workers, manner: Manner) -> Run:
    """Compute, store, summarise and draw."""
    compiled.warmup(lambda text: note(text, manner.quiet))
    clock = time.monotonic()
    how = {**folders.begun(folder, manner.command), "jobs": workers.jobs, "backend": workers.backend}
    folders.write_record(folder, scene, finished=None, **how)
    computed = _compute(scene, folder, workers, manner.quiet)
    seconds = round(time.monotonic() - clock, 3)
    total, summary = summarise(folder, scene)
    if manner.figures:
        from explorer.plot import save

        for name, picture in scene.figures(summary, total):
            for kind in ("png", "svg"):
                save(picture, folder / "figures" / f"{name}.{kind}")
    done = {"finished": folders.now(), "chunks_computed": computed, "seconds_for_chunks": seconds}
    folders.write_record(folder, scene, **how, **done)
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
            for status in workers.compute(Task(scene, identity, folder), missing, stop):
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


def summarise(folder: Path, scene: Scene) -> tuple[Any, dict[str, Any]]:
    """The stored chunks added up, for pictures, and the scene's numbers, which are written to summary.json."""
    total, digest = add_up(folder, scene)
    summary = {**scene.options(), **scene.summarise(total), "digest": digest}
    store.write_json(folder / "summary.json", summary)
    return total, summary

"""What a stored run says of itself: how far, intact, its numbers."""

import contextlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

from explorer.errors import RunError
from explorer.measure import statistics
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.chunks import Part, summary_of
from explorer.runs.pictures import there
from explorer.scenes.base import Scene

_MOST_MISSING = 10  # chunks that are named one by one


@dataclass(frozen=True)
class Progressed:
    """How far a run is: chunks and samples done, of all; counts of each status; what of it is missing.

    missing: some of "chunks", "summary" and "figures"; figures are missed only where they were asked for.
    """

    scene: str
    chunks: int
    chunks_done: int
    samples_done: int
    status: dict[str, int]
    finished: str | None
    seconds_for_chunks: float | None
    missing: tuple[str, ...] = ()


def status(folder: Path) -> Progressed:
    """How far the run in `folder` is, from the footers of its chunks. Raises InputError."""
    scene = folders.scene_of(folder)
    return progressed([Part(scene, folder)], scene)


def progressed(parts: Sequence[Part], whole: Scene) -> Progressed:
    """How far all of these runs are together."""
    notes, missing, record = [], list[str](), dict[str, Any]()
    for part in parts:
        for index, chunk in part.found().items():
            if index >= part.scene.chunks():
                continue
            try:
                notes.append(chunk.note())
            except RunError:
                continue  # counts as not done; `verify` says what is wrong with it
        if part.folder is not None:
            record = folders.read_record(part.folder)
            missing += _missing(part.folder, record)
    chunks = sum(part.scene.chunks() for part in parts)
    return Progressed(
        whole.name,
        chunks,
        len(notes),
        sum(note.samples for note in notes),
        statistics.add_counts(note.tally["status"] for note in notes),
        record.get("finished") if len(parts) == 1 else None,
        record.get("seconds_for_chunks") if len(parts) == 1 else None,
        (*(["chunks"] if len(notes) < chunks else []), *dict.fromkeys(missing)),
    )


def _missing(folder: Path, record: dict[str, Any]) -> Iterator[str]:
    """What a stored run should have beside its chunks and has not."""
    if not (folder / "summary.json").is_file():
        yield "summary"
    # Before `formats` were written, a run was finished only when its figures were drawn.
    formats, figures = record.get("formats", []), record.get("figures")
    if formats and not there(folder, figures, formats) and figures != []:
        yield "figures"


def stored_summary(folder: Path, scene: Scene) -> dict[str, Any] | None:
    """The content of summary.json where it is there, as it was written and of these options, else None."""
    try:
        content = store.read_json(folder / "summary.json")
    except store.CorruptFileError:
        return None
    if not _as_written(folder):
        return None
    options = json.loads(json.dumps(scene.options()))
    return content if all(content.get(key) == value for key, value in options.items()) else None


def _as_written(folder: Path) -> bool:
    """Whether summary.json has the digest in run.json, or there is none, as in a run of an earlier version."""
    digest = store.digest_of_file(folder / "summary.json")
    return bool(folders.read_record(folder).get("summary_digest", digest) == digest)


def faults(part: Part) -> list[str]:
    """Everything that is wrong with a run, stored or in memory, a line each."""
    if part.folder is not None:
        return verify(part.folder)
    return [
        f"chunk {index}: was changed in memory"
        for index, chunk in part.held.items()
        if store.digest_of(chunk.rows, chunk.said.tally) != chunk.said.digest
    ]


def verify(folder: Path) -> list[str]:
    """Everything that is wrong with a stored run, a line each; empty where all is well. Raises InputError."""
    scene = folders.scene_of(folder)
    shared, files = folders.digest_of_identity(scene), store.files(folder)
    numbered = store.by_number(files)
    paths = {number: some[-1] for number, some in numbered.items()}
    faults, digests = list[str](), list[str]()
    before, now = folders.read_record(folder)["identity"], folders.identity(scene)
    for what in ("kernels", "code", "calibration"):
        if before.get(what) != now.get(what):
            # Its own code made these chunks; only what they say of themselves can be checked.
            shared = _said_identity(paths) or shared
            faults.append(f"run.json: other {what} than these computed the run; it cannot be resumed with them")
    known = {some[0] for some in numbered.values() if len(some) == 1}
    others = [path for path in files if path not in known]
    faults += [f"{path.name}: is no chunk of this run, or there are two of its number" for path in others]
    due, missing = range(scene.chunks()), scene.chunks() - sum(index < scene.chunks() for index in paths)
    faults += [f"chunk {i}: is missing" for i in islice((i for i in due if i not in paths), _MOST_MISSING)]
    if missing > _MOST_MISSING:
        faults.append(f"chunks: {missing - _MOST_MISSING:,} more are missing, {missing:,} of {len(due):,} in all")
    for index in sorted(index for index in paths if index in due):
        found = store.examined(paths[index], scene, shared)
        if isinstance(found, store.Note):
            digests.append(found.digest)
        else:
            faults.append(f"{paths[index].name}: {found}")
    faults += [f"{paths[i].name}: is beyond the end of the run" for i in sorted(paths) if i >= scene.chunks()]
    return faults or _summary_faults(folder, digests)


def _said_identity(paths: dict[int, Path]) -> str | None:
    """The run to which the first chunk that can be read says to belong."""
    for path in paths.values():
        with contextlib.suppress(RunError):
            return store.read_note(path).identity
    return None


def _summary_faults(folder: Path, digests: list[str]) -> list[str]:
    """A summary that was changed, or does not belong to the chunks, whose digests are given in order."""
    if not (folder / "summary.json").exists():
        return []
    try:
        digest = store.read_json(folder / "summary.json").get("digest")
    except store.CorruptFileError as error:
        return [str(error)]
    if digest != store.digest_of_all(digests):
        return ["summary.json: does not belong to these chunks; run `nearflat summary`"]
    changed = "summary.json: its bytes are not those that were written; run `nearflat summary`"
    return [] if _as_written(folder) else [changed]


def summary(folder: Path) -> dict[str, Any]:
    """The numbers of a complete run, added up anew from its chunks, and stored where they are others than before.

    Raises InputError or RunError.
    """
    scene = folders.scene_of(folder)
    notes = {index: chunk.note() for index, chunk in Part(scene, folder).found().items()}
    identities = {note.identity for note in notes.values()}
    before, now = folders.read_record(folder)["identity"], folders.identity(scene)
    if all(before.get(what) == now.get(what) for what in ("kernels", "calibration")):
        identities |= {folders.digest_of_identity(scene)}
    if len(identities) > 1:
        raise RunError(
            f"{folder}: its chunks are not those that run.json describes; see: nearflat verify {folder}"
        )
    numbers = summary_of([Part(scene, folder)])[1]
    store.write_json(folder / "summary.json", numbers)
    record = folders.read_record(folder)
    if "summary_digest" in record:
        record["summary_digest"] = store.digest_of_file(folder / "summary.json")
        store.write_json(folder / "run.json", record)
    return numbers

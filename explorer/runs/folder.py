"""The folder of a run: may it be used, what does it say, is it the same run.

run.json carries a format number. Every later version of nearflat reads the run.json of an earlier one: a number
is raised only together with a reader of the format before. Options in it are those of `Scene.options`, which the
readers of the scene's table take back, so `ex.run` accepts them too. A run.json without a number was written
before 0.2; it is read where this version knows all of its options. In format 1 the counts of a chunk stood in
its schema too; both formats are read where they stand in the file's own metadata.
"""

import contextlib
import hashlib
import inspect
import json
import os
import platform
import re
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from explorer import compiled
from explorer.errors import InputError, RunError, shorten, shown
from explorer.phase.paths import path_of
from explorer.runs import store
from explorer.runs.machine import arithmetic, machine
from explorer.runs.pictures import KNOWN, files_of
from explorer.scenes.base import Scene
from explorer.scenes.registry import scene_from_options
from explorer.version import installed_version

FORMAT = 2
_LEFT = re.compile(r"\.probe-\d+|(run|summary)\.\d+\.tmp")  # names of a moment, which a killed run leaves
_PLACES = ("chunks", "bad", "figures")
# What run.json lists, if it says so at all.
_LISTS = ("arithmetic", "figures", "formats", "pictures")
PACKAGES = ("nearflat", "numba", "numpy", "scipy", "matplotlib", "joblib", "pandas", "pyarrow", "tqdm")


def default_folder(scene: Scene) -> Path:
    return path_of("--out", f"results/{scene.name}-{scene.label}-{scene.seed}")


def identity(scene: Scene) -> dict[str, Any]:
    """What decides the numbers: two runs with equal identities have equal numbers."""
    made: dict[str, Any] = {"options": scene.options(), "kernels": compiled.source_digest()}
    if not type(scene).__module__.startswith("explorer."):
        made["code"] = _code_of(type(scene))
    measured = own_calibration(scene)
    return made if measured is None else {**made, "calibration": measured}


def own_calibration(scene: Scene) -> str | None:
    """Digest of the steps that the machine's own calibration sets for this scene; None where it sets none."""
    steps = [plan.own_steps for plan in scene.plans if plan.own_steps]
    return hashlib.sha256(json.dumps(steps).encode()).hexdigest()[:16] if steps else None


def _code_of(kind: type) -> str | None:
    """Digest of the source of a user's scene; None where there is no source."""
    try:
        return hashlib.sha256(inspect.getsource(kind).encode()).hexdigest()
    except (OSError, TypeError):
        return None


def digest_of_identity(scene: Scene) -> str:
    """The part of the identity that all chunks of a run share, however many there are; 16 hex digits."""
    shared = identity(scene)
    shared["options"] = {key: value for key, value in shared["options"].items() if key != "samples"}
    return hashlib.sha256(json.dumps(shared, sort_keys=True).encode()).hexdigest()[:16]


def missing_chunks(folder: Path, scene: Scene, shared: str, say: Callable[[str], None]) -> list[int]:
    """Chunks that are not there or not good. A bad one is renamed to *.bad and reported to `say`."""
    begun = (path for path in folder.iterdir() if _LEFT.fullmatch(path.name))
    for leftover in (*begun, *(folder / "chunks").glob(".chunk-*.tmp")):
        with contextlib.suppress(OSError):  # a folder of that name for instance
            leftover.unlink(missing_ok=True)
    good = dict[int, list[Path]]()
    for path in store.files(folder):
        index = store.number_of(path)
        if index is None:
            found: store.Note | str = "is no chunk of a run"
        elif index >= scene.chunks():
            found = f"is beyond the end of the run, which has {scene.chunks():,} chunks"
        else:
            found = store.examined(path, scene, shared)
        if isinstance(found, store.Note):
            good.setdefault(found.index, []).append(path)
        else:
            say(f"{path.name}: {found}; it is put aside in {folder / 'bad'}")
            _put_aside(path, folder / "bad")
    for index, paths in [(index, paths) for index, paths in good.items() if len(paths) > 1]:
        # Nothing says which is the right one.
        del good[index]
        for path in paths:
            say(f"{path.name}: there are two of its number; both are put aside in {folder / 'bad'}")
            _put_aside(path, folder / "bad")
    return [index for index in range(scene.chunks()) if index not in good]


def _put_aside(path: Path, place: Path) -> None:
    """Move what is no good chunk out of the way. Raises RunError where it cannot be moved."""
    try:
        place.mkdir(exist_ok=True)
        path.replace(place / path.name)
    except OSError as error:
        raise RunError(f"{path}: cannot be put aside in {place} ({error.strerror}); remove both") from error


def read_record(folder: Path) -> dict[str, Any]:
    """What run.json says, of this format or an earlier one. Raises InputError."""
    record = path_of("DIR", folder) / "run.json"
    if not os.path.exists(record):  # noqa: PTH110, since a path may be none
        raise InputError(f"{shorten(str(folder), 120)}: holds no run (there is no {record.name})")
    try:
        content = store.read_json(record)
        written, identity = content.get("format", 0), content["identity"]
        content["identity"] = {**identity, "kernels": identity["kernels"], "options": dict(identity["options"])}
        for name in _LISTS:
            if not isinstance(content.get(name), list | None):
                raise TypeError(f"{name} is no list")
    except (store.CorruptFileError, KeyError, TypeError, ValueError) as error:
        fault = shorten(str(error), 120)
        raise InputError(f"{record}: is damaged ({fault}); start the run anew in another folder") from None
    if written not in range(FORMAT + 1):
        raise InputError(
            f"{record}: has format {shown(written)}, and this version of nearflat reads up to {FORMAT}; use "
            "the version that wrote it, or a later one"
        )
    return content


def scene_of(folder: Path) -> Scene:
    """The scene of a stored run, from its run.json. Raises InputError."""
    content, record = read_record(folder), folder / "run.json"
    try:
        return scene_from_options(content["identity"]["options"])
    except KeyError as error:
        raise InputError(f"{record}: names no {error}; start the run anew in another folder") from None
    except InputError as error:
        if "format" in content:
            raise
        raise InputError(
            f"{record}: an earlier version of nearflat wrote it, and this one does not know all of its options "
            f"({shorten(str(error), 90)}); start the run anew in another folder"
        ) from None


def clear(folder: Path) -> None:
    """Remove the run in a folder, and nothing else: chunks by their names, pictures that run.json names.

    Raises RunError.
    """
    try:
        for place in (folder / "chunks", folder / "bad"):
            chunks = [path for path in place.glob("*.parquet") if store.number_of(path) is not None]
            for path in (*chunks, *place.glob(".chunk-*.tmp")):
                path.unlink()
        for name in _drawn_before(folder):
            (folder / "figures" / name).unlink(missing_ok=True)
        for name in ("summary.json", "run.json"):
            (folder / name).unlink(missing_ok=True)
    except OSError as error:
        raise RunError(f"--out {folder}: cannot be cleared ({error.strerror})") from None


def _drawn_before(folder: Path) -> list[str]:
    """The files in `figures` that runs made, as far as run.json can be read."""
    try:
        return _pictures_of(read_record(folder))
    except InputError:
        return []


def _pictures_of(record: dict[str, Any]) -> list[str]:
    """The files of pictures that a record names; by names and formats where it is from before it listed files."""
    files = record.get("pictures")
    if files is None:
        files = files_of(record.get("figures") or (), record.get("formats") or KNOWN)
    return [Path(str(name)).name for name in files]


def take_back(folder: Path, highest: Path) -> None:
    """Remove what a run that is refused has made: its files, and the folders from `highest` down."""
    clear(folder)
    with contextlib.suppress(OSError):  # what is not ours stays, and the folders around it
        for place in _PLACES:
            if (folder / place).is_dir():
                (folder / place).rmdir()
        (folder / ".lock").unlink(missing_ok=True)
        while folder.is_relative_to(highest):
            folder.rmdir()
            folder = folder.parent


def highest_made(folder: Path) -> Path:
    """The first folder on the way to this one that is not there yet; a place inside it where all are."""
    ways = [place for place in (folder, *folder.parents) if not os.path.exists(place)]  # noqa: PTH110, since a path may be none
    return ways[-1] if ways else folder / "chunks"


def open_folder(folder: Path, scene: Scene, exist: str) -> bool:
    """Check that the run may be written here and make the folder; whether there was no run.

    Raises InputError; then nothing is written.
    """
    record = folder / "run.json"
    try:
        exists = record.exists()
    except (OSError, ValueError) as error:
        raise InputError(f"--out {str(folder)[:80]}: is no usable path ({error}); give another folder") from None
    if exists:
        if exist == "error":
            raise InputError(
                f"--out {folder}: holds a run already; add --resume or --replace, or give another folder"
            )
        if exist == "resume":
            _check_same(folder, scene)
    if not exists and folder.is_dir() and not _only_begun(folder):
        raise InputError(f"--out {folder}: is not empty and holds no run; give another folder")
    try:
        (folder / "chunks").mkdir(parents=True, exist_ok=True)
        (folder / "figures").mkdir(exist_ok=True)
        probe = folder / f".probe-{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written ({error.strerror}); give a folder that can") from None
    return not exists


def _only_begun(folder: Path) -> bool:
    """Whether there is nothing in a folder but what a run leaves that was stopped before it wrote run.json."""
    for path in folder.iterdir():
        if path.name in ("chunks", "figures"):
            if path.is_symlink() or not path.is_dir() or any(path.iterdir()):
                return False
        elif path.name != ".lock" and not _LEFT.fullmatch(path.name):
            return False
    return True


def _check_same(folder: Path, scene: Scene) -> None:
    """Raise InputError where the folder holds another run, or one of more samples."""
    before, now = read_record(folder)["identity"], identity(scene)
    if before["kernels"] != now["kernels"]:
        raise InputError(
            f"--resume: {folder} was computed by another version of the kernels; give another folder or --replace"
        )
    if before.get("code") != now.get("code"):
        raise InputError(
            f"--resume: {folder} was computed by other code of scene {scene.name}; "
            "give another folder or --replace"
        )
    if before.get("calibration") != now.get("calibration"):
        raise InputError(
            f"--resume: {folder} was computed by steps of another calibration; put it back, name it by "
            "NEARFLAT_CALIBRATION, or give another folder or --replace"
        )
    old, new = before["options"], now["options"]
    # More samples may be added to a run: its chunks are those of the longer one.
    differing = [key for key in {**old, **new} if key != "samples" and old.get(key) != new.get(key)]
    if differing:
        key = differing[0]
        raise InputError(
            f"--resume: {folder} was run with {key} = {old.get(key)}, now {key} = {new.get(key)}; "
            "give the same options, another folder, or --replace"
        )
    if not isinstance(old.get("samples", 0), int):
        raise InputError(f"{folder / 'run.json'}: samples = {shown(old['samples'])} is no number; start anew")
    if new.get("samples", 0) < old.get("samples", 0):
        raise InputError(
            f"--samples {new['samples']}: {folder} has {old['samples']}; give as many, or more, or --replace"
        )


def begun(folder: Path, command: str | None) -> dict[str, Any]:
    """When the run in `folder` was first started, by which command line, if by any, and on which processors."""
    if not (folder / "run.json").exists():
        return {"started": now(), "command": command, "pictures": [], "arithmetic": []}
    before = read_record(folder)
    return {
        "started": before.get("started"),
        "command": command or before.get("command"),
        "figures": before.get("figures"),
        "formats": before.get("formats"),
        "pictures": _pictures_of(before),
        "arithmetic": before.get("arithmetic") or [],
    }


def add_kind(before: dict[str, Any]) -> str | None:
    """Add this processor to those that computed a run; what to tell who asked where others differ."""
    kinds, this = before["arithmetic"], arithmetic()
    others = [kind for kind in kinds if kind != this]
    before["arithmetic"] = [*others, this]
    if not others:
        return None
    return (
        f"another kind of processor computed a part of this run ({others[0]}; this one: {this}): the last digits "
        "of some samples differ between them, so the run has a digest of its own; run.json names both"
    )


def write_record(folder: Path, scene: Scene, **more: Any) -> None:
    """Write run.json: everything needed to run it again, and what it ran on."""
    versions = {name: installed_version(name) for name in PACKAGES}
    content = {
        "format": FORMAT,
        "identity": identity(scene),
        **more,
        "versions": {"python": platform.python_version(), **versions},
        "machine": machine(),
    }
    store.write_json(folder / "run.json", content)


def now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")

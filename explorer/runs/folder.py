"""The folder of a run: may it be used, what does it say, is it the same run.

run.json has what decides the numbers (options of the scene, which `ex.run` accepts, and digests of what computed
them), when and how the run was made, and what it ran on.
"""

import contextlib
import inspect
import json
import linecache
import os
import platform
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime
from functools import cache
from pathlib import Path
from typing import Any

from filelock import FileLock, Timeout

from explorer import compiled
from explorer.errors import InputError, shorten, shown, warn, whole, words
from explorer.paths import made_folder, path_of
from explorer.runs import store
from explorer.runs.machine import machine
from explorer.runs.settings import MOST_CHUNKS, read_formats
from explorer.scenes.options import plain
from explorer.scenes.scene import NAMES, Scene, file_of, is_known, known_scene, scene_class, scene_of
from explorer.version import installed_version

FORMAT = 3
PACKAGES = ("nearflat", "numba", "numpy", "scipy", "matplotlib", "joblib", "pandas", "pyarrow", "tqdm")
_STAY = ("chunk_size", "theta_min")  # which have other defaults in a longer run
MADE_BY = ("kernels", "code")  # what decides the numbers beside the options


def identity(scene: Scene) -> dict[str, Any]:
    """What decides the numbers: two runs with equal identities have equal numbers.

    code: digest of the file of a user's scene.
    """
    return {"options": scene.options, "kernels": compiled.source_digest(), "code": _code_of(type(scene))}


@cache
def _code_of(kind: type[Scene]) -> str | None:
    """Digest of the file of a user's scene; None of ours, and where there is no file.

    Of all of it, since a scene calls what stands beside it. For the class alone Python would parse the file, and
    it fails where another thread parses as well.
    """
    if not kind.__module__.startswith("explorer."):
        with contextlib.suppress(OSError, TypeError):
            return _code_in(inspect.getfile(kind))
    return None


def _code_in(file: str) -> str | None:
    """Digest of a file of Python, or of what a notebook knows by that name; None where there is none."""
    linecache.checkcache(file)  # it may have been edited since it was read
    lines = linecache.getlines(file)
    return store.sha256("".join(lines))[:16] if lines else None


def _code_at(where: str) -> str | None:
    """Digest of the file of "FILE.py:CLASS", which run.json has in full; None where there is none."""
    file = where.rpartition(":")[0]
    return _code_in(file) if Path(file).is_absolute() else None


def digest_of_identity(known: dict[str, Any]) -> str:
    """The part of an identity, or of a run.json, that all chunks share, however many there are."""
    options = {key: value for key, value in known["options"].items() if key != "samples"}
    return store.sha256(json.dumps([options, *(known[name] for name in MADE_BY)], sort_keys=True))[:16]


def read_record(folder: Path) -> dict[str, Any]:
    """What run.json says. Raises InputError."""
    path = path_of("DIR", folder) / "run.json"
    if not path.is_file():
        why = "holds no run (there is no run.json)" if path.parent.exists() else "there is no such folder"
        raise InputError(f"{shown(str(folder))}: {why}")
    anew = "start the run anew in another folder"
    try:
        record = dict(json.loads(path.read_bytes()))
        if record.get("format") == FORMAT:
            digest_of_identity(record)  # which looks at what others need
            (scene,) = words("scene", [record["options"]["scene"]])
            record["chunks"] = whole("chunks", record["chunks"], 1, MOST_CHUNKS)
            record["from"] = None if scene in NAMES else words("from", [record.get("from") or ""])[0]
            if record.get("check", check := _check(record)) != check:
                raise ValueError("other options, chunks, kernels or code stand there than were written")
            store.as_json(record)  # which refuses infinite numbers
            words("arithmetic", record["arithmetic"])
            read_formats("formats", words("formats", record["formats"]))
            record["pictures"] = words("pictures", record.get("pictures", ()))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"{path}: is damaged ({store.in_one_line(error)}); {anew}") from None
    if record.get("format") != FORMAT:
        other = f"another version of nearflat wrote it (format {shown(record.get('format'))}, not {FORMAT})"
        raise InputError(f"{path}: {other}; use that version, or {anew}")
    return record


def _check(record: dict[str, Any]) -> str:
    """Digest of what a run.json says of the question: a wrong word there would make good chunks bad ones."""
    asked = [record[name] for name in ("options", "chunks", *MADE_BY)]
    return store.sha256(json.dumps(asked, sort_keys=True))[:16]


def stored_scene(folder: Path | None, record: dict[str, Any], trust: bool) -> Scene:
    """The scene of a run.json. Raises InputError.

    A user's that is not known is loaded from its file, which may do anything: only if `trust` says so, the file is
    as it was when the run began, and the folder has not brought it along.
    """
    where = record["from"]
    if where and not is_known(record["options"]["scene"], where):
        file, _, name = where.rpartition(":")
        if not (code := _code_at(where)):
            raise InputError(
                f"scene {shown(where)}: the file is gone; put it back, or continue with: nearflat run "
                f"NEW.py:{shorten(name, 60)} ... --resume --out DIR, where ... stands for the options in run.json"
            )
        if folder and Path(file).resolve().is_relative_to(folder.resolve()):
            raise InputError(f"scene {where}: code in the folder of a run is not run; move the file elsewhere")
        if code != record["code"]:
            raise InputError(_remedy("code", record))
        if not trust:
            raise InputError(f"scene {where}: its code is run only if you say that you trust it; give trust")
        scene_class(where)
    return scene_of(record["options"])


def changed(record: dict[str, Any]) -> list[str]:
    """What computed a run and is other now, in sentences."""
    code = _code_at(record["from"] or "")
    with contextlib.suppress(InputError):  # a user's, from a script or a notebook, is known only there
        code = code or _code_of(known_scene(record["options"]["scene"]))
    now = {"kernels": compiled.source_digest(), "code": code or record["code"]}  # a file that is gone says nothing
    return [_remedy(what, record) for what in MADE_BY if now[what] != record[what]]


def _remedy(what: str, record: dict[str, Any]) -> str:
    """What can be done where one of MADE_BY is other now."""
    was, back = {
        "kernels": ("the kernels of nearflat were", "install that version again, as run.json names it,"),
        "code": (f"{record.get('from') or 'the code of the scene'} was", "put that file back as it was"),
    }[what]
    return f"{was} changed since; {back} to resume the run, or replace the run"


def differing(one: dict[str, Any], two: dict[str, Any]) -> Iterator[tuple[str, Any, Any]]:
    """In what two identities differ: its name, and what the one and the other have."""
    both = [{name: known[name] for name in MADE_BY} | plain(known["options"]) for known in (one, two)]
    for key in both[0] | both[1]:
        here, there = (known.get(key) for known in both)
        if here != there:
            yield key, here, there


def require_same(folder: Path, record: dict[str, Any], scene: Scene) -> None:
    """Raise InputError where the folder holds another run; one of fewer samples is a part of the same."""
    for key, before, now in differing(record, identity(scene)):
        if key in MADE_BY:
            raise InputError(f"{folder}: {_remedy(key, record)}")
        if not (key == "samples" and whole("samples", before) < now):
            raise InputError(
                f"{folder} was run with {key} = {shown(before)}, now {key} = {shown(now)}; give the "
                "same (or more samples), another folder, or replace the run"
            )


def _locked(path: Path) -> contextlib.AbstractContextManager[Any]:
    """Take the lock of a folder; it ends with this process, and its file names the process. Raises InputError.

    Where there are no locks, a run goes on without. filelock would take the file itself for the lock instead,
    which stays when a run is killed.
    """

    def sign(handle: int) -> None:
        os.truncate(handle, 0)
        os.write(handle, f"process {os.getpid()} on {platform.node()}".encode())

    try:
        return FileLock(path, fallback_to_soft=False, on_acquired=sign).acquire(timeout=0)
    except Timeout:
        # Windows lets nobody else read what is locked.
        owner = f" ({shown(path.read_text(errors='replace'))})" if os.name == "posix" else ""
        remedy = f"wait, end that process, or give another folder; if its machine has failed, delete {path}"
        raise InputError(f"out {path.parent}: another run is at work there{owner}; {remedy}") from None
    except OSError as error:
        if error.errno not in store.UNABLE:
            raise OSError(error.errno, error.strerror, str(path)) from None
        warn(f"out {path.parent}: its file system has no locks; start no second run in this folder")
        return contextlib.nullcontext()


@contextlib.contextmanager
def opened(folder: Path, scene: Scene, exist: str) -> Iterator[tuple[Scene, dict[str, Any]]]:
    """The folder, for one run at a time: the scene as it goes on there, and run.json where the run is begun.

    Raises InputError; then nothing is written.
    """
    fresh = not folder.exists()
    record = made_folder("out", folder) / "run.json"
    own = rf"\.lock|chunks|bad|figures|{store.BEGUN}"
    if not record.exists() and not all(re.fullmatch(own, path.name) for path in folder.iterdir()):
        raise InputError(f"out {folder}: is not empty and holds no run; give another folder")
    with _locked(folder / ".lock"):
        if record.exists() and exist == "error":
            raise InputError(f"out {folder}: holds a run already; resume it, replace it, or give another folder")
        if exist == "replace":
            remove(folder, "bad")
        (folder / "chunks").mkdir(exist_ok=True)
        if not store.synced(folder):
            warn(f"out {folder}: its file system syncs no folders; a power cut may take the last chunks")
        known = read_record(folder) if record.exists() else {}
        if known:
            scene = replace(scene, **{name: known["options"].get(name) for name in _STAY if name in scene.unsaid})
            require_same(folder, known, scene)
        try:
            yield scene, known
        finally:
            if not record.exists():  # it was not begun, or nothing came of it
                for undo in ((folder / ".lock").unlink, (folder / "chunks").rmdir, *([folder.rmdir] * fresh)):
                    with contextlib.suppress(OSError):  # something stays, or the lock is held too firmly
                        undo()


def remove(folder: Path, *more: str) -> None:
    """Delete the run of a folder, by the names of its files; all others stay, and folders that have some.

    more: other folders of it in which its files may be.
    """
    with contextlib.suppress(InputError):
        remove_pictures(folder, read_record(folder)["pictures"])
    for place in (*(folder / name for name in ("chunks", "figures", *more)), folder):
        for path in store.files_in(place, rf"{store.NAME}|{store.BEGUN}|run\.json|summary\.json"):
            path.unlink()
        with contextlib.suppress(OSError):  # something stays, if only the lock
            place.rmdir()


def remove_pictures(folder: Path, names: Sequence[str]) -> None:
    """Delete pictures of a run that are finished or begun, by the names that run.json has."""
    for path in store.files_in(folder / "figures", rf"\.?({'|'.join(map(re.escape, names))})"):
        path.unlink()


def missing_chunks(folder: Path, scene: Scene, say: Callable[[str], None]) -> list[int]:
    """The numbers of chunks that are not there or not good. What is no good chunk is moved to bad/ and told."""
    for leftover in (*store.files_in(folder, store.BEGUN), *store.files_in(folder / "chunks", store.BEGUN)):
        leftover.unlink(missing_ok=True)
    good, shared = set[int](), digest_of_identity(identity(scene))
    for chunk, fault in store.examined(store.chunks_in(folder, shared), scene.chunks):
        path, place = folder / "chunks" / chunk.name, folder / "bad"
        if not fault and chunk.note()["drawn"] < scene.drawn(chunk.number):
            say(f"{chunk.name}: it was at the end of a run of fewer samples; it is computed anew")
            path.unlink()
        elif not fault:
            good.add(chunk.number)
        else:
            say(f"{chunk.name}: {fault}; it is put aside in {place}")
            place.mkdir(exist_ok=True)
            path.replace(place / chunk.name)
    return [index for index in range(scene.chunks) if index not in good]


def write_record(folder: Path, scene: Scene, how: dict[str, Any]) -> None:
    """Write run.json: everything needed to run it again, how it was made, and what it ran on."""
    versions = {"python": platform.python_version(), **{name: installed_version(name) for name in PACKAGES}}
    content = {"format": FORMAT, **identity(scene), "from": file_of(type(scene)), "chunks": scene.chunks, **how}
    about = {"check": _check(content), "versions": versions, "machine": machine()}
    store.write_json(folder / "run.json", content | about)


def now() -> str:
    """The time as run.json has it."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")

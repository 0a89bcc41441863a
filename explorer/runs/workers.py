"""Who computes chunks: threads (kernels release the GIL) or processes, by joblib, or a dask cluster."""

import contextlib
import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Generator
from concurrent.futures import BrokenExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from explorer.errors import RunError
from explorer.motion.threads import Group
from explorer.runs import folder as folders
from explorer.runs.cluster import on_cluster
from explorer.runs.interrupt import SIGNALS, withheld
from explorer.runs.settings import Settings
from explorer.runs.store import Done, in_one_line, make_chunk
from explorer.scenes.scene import Scene

_KEPT = 31 << 20  # bytes; glibc takes no notice of blocks of 32 MB and more
_OTHERS = (
    "the worker would compute other numbers than this run; give all machines the same nearflat, Python and "
    "numba, and the same code of the scene"
)


@cache
def keep_memory() -> None:
    """Have the C library keep what arrays of a chunk leave, for those of the next.

    glibc gives large blocks back to the system until it has seen one of this size come and go. Each array then
    costs new pages, which the system fills with zeros: a sixth of the time of a run of passages.
    """
    np.empty(_KEPT, np.uint8)


def compute(scene: Scene, known: dict[str, Any], folder: Path | None, index: int) -> Done:
    """Compute one chunk of the run with this identity, and store it where there is a folder."""
    keep_memory()
    here, identity = folders.identity(scene), folders.digest_of_identity(known)
    if type(scene).__module__ == "__main__":  # it came by value, with the code that the run began with
        here["code"] = known["code"]
    if identity != folders.digest_of_identity(here):
        raise RunError(f"chunk {index}: {_OTHERS}")
    try:
        return make_chunk(scene, index, identity, folder)
    except MemoryError:
        raise RunError(
            f"chunk {index}: {scene.length(index):,} samples do not fit into memory; give a smaller chunk_size"
        ) from None
    except Exception as error:  # of a user's scene; joblib's threads lose the line that raised it
        file = getattr(sys.modules[type(scene).__module__], "__file__", None)
        own = [at for at in traceback.extract_tb(error.__traceback__) if at.filename == file]
        if type(scene).__module__.startswith("explorer.") or (isinstance(error, RunError) and not own):
            raise
        where = f"{file}, line {own[-1].lineno}, in {own[-1].name}" if own else "what it returns or counts"
        raise RunError(f"scene {scene.name}: {where}: {type(error).__name__}: {in_one_line(error)}") from error


def compute_all(scene: Scene, missing: list[int], settings: Settings, stop: threading.Event) -> Generator[Done]:
    """Compute and store chunks, in any order, and give each as it is done.

    Starts no further chunk once `stop` is set. Raises RunError where a chunk or a worker fails.
    """
    folder = settings.out and settings.out.resolve()  # workers see the same file system
    task = partial(compute, scene, folders.identity(scene), folder)
    if settings.backend == "dask":
        yield from on_cluster(task, missing, settings, stop)
        return
    # By one thread joblib means this one, in which each kernel needs a thread of its own so that Ctrl-C is heard.
    # With two, chunks go to other threads than this one, no more at once than there are jobs.
    group, jobs = Group(), min(settings.jobs, len(missing))
    call: Callable[[int], Done] = partial(group.call, task)
    how: dict[str, Any] = {"n_jobs": max(jobs, 2), "backend": "threading", "pre_dispatch": jobs}
    if settings.backend == "processes":
        call, how = task, {"n_jobs": jobs, "backend": "loky", "initializer": begin_worker}
        how["initargs"] = (os.getpid(), sys.path)
    pool = Parallel(**how, return_as="generator_unordered", batch_size=1)
    with withheld() if settings.backend == "processes" else contextlib.nullcontext():
        made = pool(delayed(call)(index) for index in missing if not stop.is_set())
    try:
        with contextlib.closing(made):
            yield from made
    except BrokenExecutor as error:
        if not stop.is_set():
            how_so = "a worker was killed (out of memory? give fewer jobs or a smaller chunk_size)"
            raise RunError(f"backend processes: {how_so}; {settings.onward}") from error
    finally:
        group.end()


def begin_worker(parent: int, path: list[str]) -> None:
    """Prepare another process: it imports what this one can. Signals are its parent's, and it ends with it."""
    sys.path += [place for place in path if place not in sys.path]
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if os.name == "posix":
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)  # in the middle of a chunk, which another run computes

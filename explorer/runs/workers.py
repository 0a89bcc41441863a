"""Who computes chunks: threads (kernels release the GIL), processes or a dask cluster; joblib hands them out."""

import contextlib
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
from joblib import Parallel, delayed

from explorer.errors import RunError
from explorer.runs import folder as folders
from explorer.runs.interrupt import SIGNALS, withheld
from explorer.runs.settings import Settings
from explorer.runs.store import Done, in_one_line, make_chunk
from explorer.scenes.scene import Scene

# Seconds without a worker of a cluster after which none will come: a nanny starts a new one in two or three.
_WITHOUT_WORKERS = 7.0
_KEPT = 31 << 20  # bytes; glibc takes no notice of blocks of 32 MB and more
_OTHERS = (
    "the worker would compute other numbers than this run; give all machines the same nearflat, Python, numba, "
    "NEARFLAT_ARITHMETIC and NEARFLAT_CALIBRATION, and the same code of the scene"
)


@cache
def keep_memory() -> None:
    """Have the C library keep what arrays of a chunk leave, for those of the next.

    glibc gives large blocks back to the system until it has seen one of this size come and go. Each array then
    costs new pages, which the system fills with zeros: a sixth of the time of a run of passages.
    """
    np.empty(_KEPT, np.uint8)


def compute(scene: Scene, identity: str, folder: Path | None, index: int) -> Done:
    """Compute one chunk of the run with this identity, and store it where there is a folder."""
    keep_memory()
    if identity != folders.digest_of_identity(folders.identity(scene)):
        raise RunError(f"chunk {index}: {_OTHERS}")
    try:
        return make_chunk(scene, index, identity, folder)
    except MemoryError:
        raise RunError(
            f"chunk {index}: {scene.length(index):,} samples do not fit into memory; give a smaller --memory"
        ) from None


def compute_all(scene: Scene, missing: list[int], settings: Settings, stop: threading.Event) -> Iterator[Done]:
    """Compute and store chunks, in any order, and give each as it is done.

    Starts no further chunk once `stop` is set. Raises RunError where a chunk or a worker fails.
    """
    folder = settings.out and settings.out.resolve()  # workers see the same file system
    call: Callable[[int], Done | None]
    task = call = partial(compute, scene, folders.digest_of_identity(folders.identity(scene)), folder)
    how: dict[str, Any] = {"n_jobs": min(settings.jobs, len(missing)), "backend": "threading"}
    if settings.backend == "processes":
        how |= {"backend": "loky", "initializer": begin_worker, "initargs": (os.getpid(), sys.path)}
    with contextlib.ExitStack() as until_done:
        if settings.backend == "dask":
            cluster = until_done.enter_context(_cluster(settings, stop))
            call, how["n_jobs"] = partial(cluster.compute, task), cluster.places
        pool = Parallel(**how, return_as="generator_unordered", pre_dispatch="n_jobs", batch_size=1)
        with withheld() if settings.backend == "processes" else contextlib.nullcontext():
            made = pool(delayed(call)(index) for index in missing if not stop.is_set())
        until_done.enter_context(contextlib.closing(made))
        try:
            yield from filter(None, made)
        except BrokenExecutor as error:
            if not stop.is_set():
                how_so = "a worker was killed (out of memory? give fewer --jobs or a smaller --memory)"
                raise RunError(f"--backend processes: {how_so}; {settings.onward}") from error


def begin_worker(parent: int | None, path: list[str]) -> None:
    """Prepare another process: it imports what this one can. Signals are its parent's, and it ends with it."""
    sys.path += [place for place in path if place not in sys.path]
    if parent is not None:
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        if os.name == "posix":
            threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)  # in the middle of a chunk, which another run computes


@contextlib.contextmanager
def _cluster(settings: Settings, stop: threading.Event) -> "Iterator[_Cluster]":
    """The cluster at the scheduler's address, or one of its own on the loopback. Raises RunError."""
    import distributed

    of_its_own = {"n_workers": settings.jobs, "threads_per_worker": 1, "host": "127.0.0.1"}
    with contextlib.ExitStack() as until_done:
        try:
            address = settings.scheduler
            with withheld():
                if address is None:
                    # A dashboard None would ask for a port that another run has; no user can mend what dask logs.
                    of_its_own |= {"dashboard_address": "127.0.0.1:0", "silence_logs": logging.CRITICAL}
                    address = until_done.enter_context(distributed.LocalCluster(**of_its_own))
                client = until_done.enter_context(distributed.Client(address, timeout=5))
        except Exception as error:  # of whatever kind: dask's settings for TLS raise nearly any
            raise RunError(
                f"--scheduler {settings.scheduler}: cannot be reached ({in_one_line(error)}); look at the "
                "address, and whether scheduler, workers and this process have the same settings for TLS"
            ) from error
        yield _Cluster(client, settings, stop)


class _Cluster:
    """Chunks computed on a dask cluster, each awaited by a thread that notices when nobody works any more.

    joblib's own backend for dask would wait for ever where the last worker is lost.
    """

    def __init__(self, client: Any, settings: Settings, stop: threading.Event) -> None:
        self._client, self._settings, self._stop = client, settings, stop
        self._wait(lambda: bool(client.nthreads()))
        parent = os.getpid() if settings.scheduler is None else None
        for found in client.run(begin_worker, parent, sys.path, on_error="return").values():
            if isinstance(found, Exception):
                raise self._error(f"a worker cannot load nearflat ({in_one_line(found)}); install it there")
        self.places = 2 * sum(client.nthreads().values()) or 1  # two for each, so that none waits

    def compute(self, task: Callable[[int], Done], index: int) -> Done | None:
        """A chunk; None where the run was stopped and nobody is there to compute it."""
        import distributed

        future = self._client.submit(task, index, pure=False)
        try:
            found: Done | None = future.result() if self._wait(future.done) else None
        except (distributed.KilledWorker, distributed.client.FutureCancelledError) as error:
            raise self._error(f"workers or their scheduler were killed ({in_one_line(error)})") from error
        return found

    def _wait(self, done: Callable[[], bool]) -> bool:
        """Wait until something is done; False where the run is stopped and there is no worker.

        Raises RunError where no worker is there for a while.
        """
        seen = looked = time.monotonic()
        while not done():
            time.sleep(0.01)
            if (now := time.monotonic()) - looked > 0.5:
                looked = now
                try:
                    seen = now if self._client.nthreads() else seen
                except OSError:
                    raise self._error("the scheduler is gone; start it anew with its workers") from None
                if self._stop.is_set() and seen < now:
                    return False
                if now - seen > _WITHOUT_WORKERS:
                    raise self._error(
                        f"there is no worker; start one with: dask worker {self._settings.scheduler}"
                    )
        return True

    def _error(self, text: str) -> RunError:
        where = f"--scheduler {self._settings.scheduler}" if self._settings.scheduler else "--backend dask"
        return RunError(f"{where}: {text}; {self._settings.onward}")

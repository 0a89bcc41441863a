"""Who computes the chunks: threads (kernels release the GIL), processes, or a dask cluster.

A chunk that a worker took with it when it was killed is computed again by another.
"""

import contextlib
import io
import json
import logging
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, ThreadPoolExecutor, wait
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple, is_typeddict

import cloudpickle
import numpy as np

from explorer import compiled
from explorer.errors import InputError, RunError, jobs_of, one_of, shorten
from explorer.runs import folder as folders
from explorer.runs import store
from explorer.runs.chunks import HeldChunk
from explorer.runs.interrupt import SIGNALS, withheld
from explorer.scenes.base import Scene

BACKENDS = ("threads", "processes", "dask")
# Rounds without a single new chunk after which killed workers are no longer an accident.
_PATIENCE = 3
_IDLE = 20  # seconds after which a process without work ends; orphans do where they cannot look for their parent
# Seconds without a worker of a cluster after which none will come: a nanny starts a new one in two or three.
_WITHOUT_WORKERS = 7.0
_KEPT = 31 << 20  # bytes; glibc takes no notice of blocks of 32 MB and more
_OTHER_KERNELS = (
    "the worker has other kernels than this run; install the same nearflat, Python and numba on all machines, and "
    "start workers with the same NEARFLAT_ARITHMETIC"
)
_OTHER_CALIBRATION = (
    "the worker has another calibration than this run, and would take other steps; give all machines the same "
    "file, named by NEARFLAT_CALIBRATION"
)


class _Pickler(cloudpickle.Pickler):  # type: ignore[misc]
    """Packs classes whole, but for tables of keywords: no worker reads any, and Python cannot make them anew."""

    def reducer_override(self, value: Any) -> Any:
        return (dict, ()) if is_typeddict(value) else super().reducer_override(value)


def _dumped(scene: Scene) -> bytes:
    content = io.BytesIO()
    _Pickler(content).dump(scene)
    return content.getvalue()


@dataclass(frozen=True)
class Packed:
    """A scene whose code travels with it: workers elsewhere cannot import the file that a user wrote."""

    content: bytes

    @classmethod
    def of(cls, scene: Scene) -> "Packed":
        module = sys.modules.get(type(scene).__module__)
        if module is None or module.__name__ == "__main__":  # such classes always travel whole
            return cls(_dumped(scene))
        cloudpickle.register_pickle_by_value(module)
        try:
            return cls(_dumped(scene))
        finally:
            cloudpickle.unregister_pickle_by_value(module)

    @lru_cache(maxsize=8)  # noqa: B019 - a worker unpacks a scene once, not for each chunk
    def unpacked(self) -> Scene:
        scene: Scene = cloudpickle.loads(self.content)
        return scene


class Task(NamedTuple):
    """What is computed, and where it goes: a folder, or back to who asked.

    identity, kernels, calibration: of the run; the last where it is the machine's own and sets steps.
    """

    scene: Scene | Packed
    identity: str
    folder: Path | None
    kernels: str
    calibration: str | None

    def packed(self) -> "Task":
        """The task for workers in other processes."""
        if isinstance(self.scene, Packed) or type(self.scene).__module__.startswith("explorer."):
            return self
        return self._replace(scene=Packed.of(self.scene))


class Done(NamedTuple):
    """A computed chunk: how many samples ended in each status, and the chunk where it is not in a folder."""

    number: int
    status: dict[str, int]
    held: HeldChunk | None


Made = Generator[Done, None, None]


@dataclass(frozen=True)
class Workers:
    """How many, of which kind; scheduler: address of a dask scheduler, or None for one of its own."""

    jobs: int = 2
    backend: str = "threads"
    scheduler: str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "jobs", jobs_of("--jobs", self.jobs))
        one_of("--backend", self.backend, BACKENDS)
        if self.scheduler is not None and self.backend != "dask":
            raise InputError(f"--scheduler {self.scheduler}: is for --backend dask; give both")
        if self.backend == "dask":
            _distributed()

    def compute(self, task: Task, indices: list[int], stop: threading.Event) -> Made:
        """Compute and store chunks, in any order, and yield each as it is done.

        Starts no further chunk once `stop` is set. Close what is not read to its end: processes are shared with
        later runs, and joblib would end them whenever it is collected.
        """
        if self.backend == "dask":
            yield from _by_dask(self, task.packed(), indices, stop)
        elif self.backend == "threads":
            yield from _by_threads(self.jobs, task, indices, stop)
        else:
            yield from _by_processes(self.jobs, task.packed(), indices, stop)


@cache
def keep_memory() -> None:
    """Have the C library keep what arrays of a chunk leave, for those of the next.

    glibc gives large blocks back to the system until it has seen one of this size come and go. Each array then
    costs new pages, which the system fills with zeros: a tenth of the time of a run of passages.
    """
    np.empty(_KEPT, np.uint8)


def compute_chunk(task: Task, index: int) -> Done:
    """Compute one chunk, and store it where the task has a folder."""
    keep_memory()
    if task.kernels != compiled.source_digest():
        raise RunError(f"chunk {index}: {_OTHER_KERNELS}")
    scene = task.scene.unpacked() if isinstance(task.scene, Packed) else task.scene
    if task.calibration != folders.own_calibration(scene):
        raise RunError(f"chunk {index}: {_OTHER_CALIBRATION}")
    try:
        kept, tally = scene.process(index)
        text = json.dumps(tally, allow_nan=False)
        tally = json.loads(text)  # as a footer gives it back
        note = store.Note(index, task.identity, scene.length(index), store.digest_of(kept, tally), tally)
        table = store.made_table(scene, index, kept)
        if task.folder is None:
            return Done(index, tally["status"], HeldChunk(note, kept))
        store.write_chunk(task.folder, note, table, text)
    except MemoryError:
        raise RunError(
            f"chunk {index}: {scene.length(index):,} samples do not fit into memory; start the run anew with "
            "a smaller --memory"
        ) from None
    return Done(index, tally["status"], None)


def begin_worker(parent: int) -> None:
    """Prepare a process for its chunks: signals are its parent's, and it ends when its parent does."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    if os.name == "posix":
        threading.Thread(target=_end_with, args=(parent,), daemon=True).start()


def _end_with(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)  # in the middle of a chunk, which another run computes


def _until(indices: list[int], stop: threading.Event) -> Iterator[int]:
    for index in indices:
        if stop.is_set():
            return
        yield index


def _by_threads(jobs: int, task: Task, indices: list[int], stop: threading.Event) -> Iterator[Done]:
    # The pool waits for its threads, whatever went wrong: one that still writes a chunk when the interpreter ends
    # is a fatal error of Python.
    count = min(jobs, max(1, len(indices)))
    with ThreadPoolExecutor(count) as pool:
        yield from _by_pool(pool, count, task, _until(indices, stop))


def _by_pool(
    pool: Executor, count: int, task: Task, indices: Iterator[int], has_workers: Callable[[], bool] = lambda: True
) -> Iterator[Done]:
    """Chunks as they are done, so many at once; ends early where no worker is left and the run is stopped."""
    running = {pool.submit(compute_chunk, task, index) for index in islice(indices, count)}
    while running:
        # Only a wait that ends can be interrupted on Windows, and can see that nobody works any more.
        done, running = wait(running, timeout=0.1, return_when=FIRST_COMPLETED)
        for future in done:
            yield future.result()
        running |= {pool.submit(compute_chunk, task, index) for index in islice(indices, len(done))}
        if not done and not has_workers():
            return


def _by_joblib(jobs: int, task: Task, indices: list[int], stop: threading.Event) -> Made:
    from joblib import Parallel, delayed

    pool = Parallel(
        n_jobs=min(jobs, max(1, len(indices))),
        backend="loky",
        return_as="generator_unordered",
        pre_dispatch="n_jobs",
        batch_size=1,
        idle_worker_timeout=_IDLE,
        initializer=begin_worker,
        initargs=(os.getpid(),),
    )
    with withheld():
        made = pool(delayed(compute_chunk)(task, index) for index in _until(indices, stop))
    yield from made


@contextlib.contextmanager
def _let_go(chunks: Made) -> Iterator[Made]:
    """End what was begun and is not wanted, without joblib's word on it: whoever stopped the run says it."""
    try:
        yield chunks
    finally:
        with warnings.catch_warnings(action="ignore", category=UserWarning):
            chunks.close()


def _by_processes(jobs: int, task: Task, indices: list[int], stop: threading.Event) -> Iterator[Done]:
    from joblib.externals.loky.process_executor import TerminatedWorkerError

    missing, idle, there = indices, 0, set[int]()
    while missing and not stop.is_set():
        try:
            with _let_go(_by_joblib(jobs, task, missing, stop)) as chunks:
                for done in chunks:
                    there.add(done.number)
                    yield done
            return
        except TerminatedWorkerError as error:
            # joblib gives up the whole call; what is on disk counts.
            there |= set(store.found_chunks(task.folder) if task.folder else ())
            left = [index for index in missing if index not in there]
            idle = idle + 1 if len(left) == len(missing) else 0
            if idle >= _PATIENCE:
                raise RunError(
                    f"--backend processes: workers are killed again and again ({len(left)} chunks are left; "
                    f"out of memory?); give fewer --jobs or a smaller --memory. {error}"
                ) from error
            missing = left


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError("--backend dask: needs the extra 'cluster': pip install 'nearflat[cluster]'") from None
    return distributed


@contextlib.contextmanager
def _client(workers: Workers) -> Iterator[Any]:
    """A client of the scheduler, or of one of its own on the loopback. Raises RunError where there is none."""
    distributed = _distributed()
    cluster = None
    try:
        with withheld():
            if workers.scheduler is None:
                # What goes wrong with a chunk comes back as its error. What dask logs beside that, as on
                # connections that end while it is stopped, is nothing that a user can mend.
                cluster = distributed.LocalCluster(
                    n_workers=workers.jobs,
                    threads_per_worker=1,
                    dashboard_address="127.0.0.1:0",  # None would ask for a port that another run has
                    host="127.0.0.1",
                    silence_logs=logging.CRITICAL,
                )
            client = distributed.Client(workers.scheduler or cluster, timeout=5)
    except Exception as error:  # of whatever kind: dask's settings for TLS raise nearly any
        if cluster is not None:
            cluster.close()
        what = f"--scheduler {workers.scheduler}" if workers.scheduler else "--backend dask"
        raise RunError(
            f"{what}: cannot be reached ({shorten(' '.join(str(error).split()), 200)}); look at the address, and "
            "whether scheduler, workers and this process have the same settings for TLS"
        ) from error
    try:
        yield client
    finally:
        client.close()
        if cluster is not None:
            cluster.close()


@dataclass
class _WorkerWatch:
    """The workers of a cluster. since: when it was first seen that there are none; None where there are."""

    client: Any
    scheduler: str | None
    folder: Path | None
    stop: threading.Event
    since: float | None = None

    def has_workers(self) -> bool:
        """Whether a worker is there, or may still come; RunError where none did, or the scheduler is gone."""
        try:
            there = self.client.nthreads()
        except OSError:
            raise self.error("the scheduler is gone; start it anew with its workers") from None
        if there:
            self.since = None
            return True
        now = time.monotonic()
        self.since = self.since or now
        if now - self.since > _WITHOUT_WORKERS:
            if self.scheduler is None:
                raise self.error("its workers are gone; give fewer --jobs or a smaller --memory")
            raise self.error(f"there is no worker; start one with: dask worker {self.scheduler}")
        return not self.stop.is_set()

    def error(self, text: str) -> RunError:
        """What went wrong, with where, and how to go on."""
        where = f"--scheduler {self.scheduler}" if self.scheduler else "--backend dask"
        cluster = f" --scheduler {self.scheduler}" if self.scheduler else ""
        anew = f", then continue with: nearflat resume {self.folder} --backend dask{cluster}"
        then = anew if self.folder else ""
        return RunError(f"{where}: {text}{then}")

    def wait(self) -> bool:
        """Wait for the first worker; False where the run was stopped meanwhile."""
        while self.has_workers():
            if self.since is None:
                return True
            time.sleep(0.1)
        return False


def _by_dask(workers: Workers, task: Task, indices: list[int], stop: threading.Event) -> Iterator[Done]:
    distributed = _distributed()
    shared = task._replace(folder=task.folder and task.folder.resolve())  # workers see the same file system
    with _client(workers) as client:
        watch = _WorkerWatch(client, workers.scheduler, task.folder, stop)
        if not watch.wait():
            return
        _check_kernels(client, task.kernels)
        pool, count = client.get_executor(pure=False, retries=2), 2 * len(client.nthreads())
        try:
            yield from _by_pool(pool, count, shared, _until(indices, stop), watch.has_workers)
        except CancelledError:
            raise watch.error("the scheduler is gone; start it anew with its workers") from None
        except distributed.KilledWorker as error:
            raise RunError(f"--backend dask: a chunk killed several workers ({error}); out of memory?") from error


def _check_kernels(client: Any, digest: str) -> None:
    """Raise RunError, naming a worker, where one cannot compute what this process would."""

    def theirs() -> str:  # travels as code, not by name: a worker need not have this version, or any
        from explorer.compiled import source_digest

        return source_digest()

    for address, found in client.run(theirs, on_error="return").items():
        if isinstance(found, Exception):
            fault = shorten(f"{type(found).__name__}: {found}", 100)
            raise RunError(f"--backend dask: {address} cannot load nearflat ({fault}); install it there")
        if found != digest:
            raise RunError(f"--backend dask: {address}: {_OTHER_KERNELS}")

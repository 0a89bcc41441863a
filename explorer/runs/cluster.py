"""Chunks from a dask cluster: one that a user started, or workers on this machine's loopback.

joblib's own backend for dask would wait for ever where the last worker is lost. Here the main thread waits, so
that it hears Ctrl-C, and looks whether anybody is still there.
"""

import contextlib
import logging
import math
import pickle
import time
from collections.abc import Callable, Iterator
from functools import partial
from itertools import islice
from threading import Event
from typing import Any

from explorer.errors import RunError
from explorer.motion.threads import side_by_side
from explorer.runs.interrupt import withheld
from explorer.runs.settings import Settings
from explorer.runs.store import Done, in_one_line

_PAUSE = 0.05  # seconds between two looks at the chunks; no worker waits, since each has a second one
_LOOK = 1.0  # seconds between two looks at the workers
_PATIENCE = 7.0  # seconds for an answer, and without any worker; a nanny starts a new one in two or three
# Seconds without a sign of life; code of a user that holds Python's lock keeps a worker from giving one.
_SILENCE = 60.0


def on_cluster(task: Callable[[int], Done], missing: list[int], settings: Settings, stop: Event) -> Iterator[Done]:
    """Give chunks as they are done, two at a time for each thread of the workers. Raises RunError."""
    import cloudpickle
    import distributed

    content, folder = cloudpickle.dumps(task), settings.out and settings.out.resolve()

    def at_worker(index: int) -> tuple[str, Any]:
        """Compute a chunk, or nothing without a folder. Sent by value: a worker without nearflat can say so."""
        name = f"worker {distributed.get_worker().address}"
        try:
            return name, pickle.loads(content)(index) if not folder or folder.is_dir() else None
        except Exception as error:
            error.args = (f"{name}: {error}",)
            raise

    where = f"scheduler {settings.scheduler}" if settings.scheduler else "backend dask"
    due, running, workers = iter(missing), set[Any](), dict[str, Any]()
    heard, looked = time.monotonic(), -math.inf
    try:
        with _cluster(settings) as client:
            while True:
                if time.monotonic() > looked + _LOOK:
                    before, known = workers, client.sync(client.scheduler.identity, callback_timeout=_SILENCE)
                    workers, looked = known["workers"], time.monotonic()  # it has when each was last seen
                    heard = looked if workers != before else heard
                    if stop.is_set() and not workers:
                        return
                    if looked > heard + (_SILENCE if workers else _PATIENCE):
                        start = f"there is no worker; start one with: dask worker {client.scheduler.address}"
                        raise RunError("the workers are silent" if workers else start)
                most = 0 if stop.is_set() else 2 * max(1, sum(each["nthreads"] for each in workers.values()))
                more = islice(due, max(0, most - len(running)))
                running |= {client.submit(at_worker, index, pure=False) for index in more}
                if not running:
                    return
                time.sleep(_PAUSE)
                with contextlib.suppress(TimeoutError):  # of a result that is lost with its worker
                    for future in filter(distributed.Future.done, [*running]):
                        name, done = future.result(_PATIENCE)
                        running.remove(future)
                        if not done or (folder and not (folder / "chunks" / done[0].name).is_file()):
                            raise RunError(f"{name} has not this folder {folder}; all machines must share it")
                        heard = time.monotonic()
                        yield done
    except (RunError, ImportError) as error:
        fault = str(error)
    except TimeoutError:
        fault = "the scheduler does not answer"
    except (OSError, distributed.KilledWorker, distributed.CancelledError) as error:
        fault = f"workers or their scheduler were killed ({in_one_line(error)})"
    raise RunError(f"{where}: {fault}; {settings.onward}")


@contextlib.contextmanager
def _cluster(settings: Settings) -> Iterator[Any]:
    """A client of the cluster at the scheduler's address, or of one on the loopback. Raises RunError."""
    import distributed

    # A dashboard None would ask for a port that another run has; no user can mend what dask logs.
    quiet = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", "silence_logs": logging.CRITICAL}
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    logging.getLogger("asyncio").addFilter(_is_other)
    local = partial(distributed.LocalCluster, n_workers=settings.jobs, threads_per_worker=1, **quiet)
    with contextlib.ExitStack() as until_done:
        try:
            with withheld():
                address = settings.scheduler or until_done.enter_context(local())
            # dask itself waits for ever where somebody accepts the connection and says nothing.
            connect = partial(distributed.Client, address, timeout=_PATIENCE, set_as_default=False)
            (client,) = side_by_side([connect], 2.0 * _PATIENCE)
        except Exception as error:  # of whatever kind: dask's settings for TLS raise nearly any
            remedy = "look at the address, and whether all have the same settings for TLS"
            remedy = remedy if settings.scheduler else "give the address of a scheduler, or another backend"
            raise RunError(f"cannot be reached ({in_one_line(error) or 'no answer'}); {remedy}") from error
        yield until_done.enter_context(client)


def _is_other(record: logging.LogRecord) -> bool:
    """Than what dask leaves of a result that is lost with its worker; another worker computes it."""
    return "AllExit" not in str(record.exc_info)

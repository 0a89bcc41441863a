"""Ctrl-C, SIGTERM and SIGHUP while a run is made: the first lets running chunks finish, the second stops at once.

Chunks are computed in other threads or processes while the main thread waits. So the second signal can raise
KeyboardInterrupt there, as Python users expect; a library must not end the user's process.

A signal that whoever started the program told it to ignore, as `nohup` and shells do for jobs in the background,
stays ignored.
"""

import contextlib
import multiprocessing.resource_tracker
import signal
import sys
import threading
from collections.abc import Iterator
from types import FrameType

from joblib.externals.loky.backend import resource_tracker as joblib_tracker

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


@contextlib.contextmanager
def stopping(onward: str) -> Iterator[threading.Event]:
    """An event that the first signal sets. Elsewhere than in the main thread signals are left alone.

    onward: how to go on with the run.
    """
    stop, before = threading.Event(), {}

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.is_set():
            raise KeyboardInterrupt(f"stopped; {onward}")
        stop.set()
        with contextlib.suppress(OSError):  # the terminal may be closed
            text = "stopping when the running chunks are done; interrupt again to stop now"
            print(text, file=sys.stderr, flush=True)

    if threading.current_thread() is threading.main_thread():
        heard = [number for number in SIGNALS if signal.getsignal(number) not in (signal.SIG_IGN, None)]
        before = {number: signal.signal(number, handle) for number in heard}
    try:
        yield stop
    finally:
        for number, known in before.items():
            signal.signal(number, known)


@contextlib.contextmanager
def withheld() -> Iterator[None]:
    """Processes that are started meanwhile never get SIGNALS, which a terminal sends to all; here they wait."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        # The first process of Python's or of joblib's starts a tracker, and doing so lets SIGINT and SIGTERM
        # through again, for this thread and for all that it starts later.
        multiprocessing.resource_tracker.ensure_running()
        joblib_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)

"""Ctrl-C and SIGTERM: the first lets running chunks finish, the second stops at once."""

import contextlib
import signal
import threading
from collections.abc import Iterator
from types import FrameType

from explorer.runs.progress import note


@contextlib.contextmanager
def graceful(quiet: bool) -> Iterator[threading.Event]:
    """An event that the first signal sets. Elsewhere than in the main thread signals are left alone."""
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        stop.set()
        note("stopping when the running chunks are done; once more stops now", quiet)

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield stop
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)

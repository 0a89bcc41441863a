"""Ctrl-C and SIGTERM: the first lets running chunks finish, the second stops at once."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from explorer.errors import in_words, note


@contextlib.contextmanager
def graceful(folder: Path | None, quiet: bool) -> Iterator[threading.Event]:
    """An event that the first signal sets. Elsewhere than in the main thread signals are left alone."""
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield stop
        return

    def handle(number: int, frame: FrameType | None) -> None:
        if stop.is_set():
            # Threads may be deep in compiled code: leave without asking them. Chunks are whole or not there.
            how = f"; continue with: nearflat resume {folder}" if folder else ""
            print(in_words(f"stopped{how}"), file=sys.stderr, flush=True)
            os._exit(130)
        stop.set()
        note("stopping when the running chunks are done; once more stops now", quiet)

    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, handle) for number in signals]
    try:
        yield stop
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)

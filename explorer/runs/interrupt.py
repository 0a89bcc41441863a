"""Ctrl-C, SIGTERM and SIGHUP: the first lets running chunks finish, the second stops at once.

A signal that whoever started the program told it to ignore, as `nohup` and shells do for jobs in the background,
stays ignored.
"""

import contextlib
import errno
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType
from typing import NoReturn

from explorer.errors import in_words, note

STATUS = 130  # exit status of a command that was interrupted
SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
Handler = Callable[[int, FrameType | None], None]
# While a command runs: that it runs, and whether it was asked to stop; a KeyboardInterrupt in a callback is lost.
_command, _told = threading.Event(), threading.Event()


@contextlib.contextmanager
def graceful(folder: Path | None, quiet: bool) -> Iterator[threading.Event]:
    """An event that the first signal sets. Elsewhere than in the main thread signals are left alone."""
    stop = threading.Event()
    if was_told():
        stop.set()

    def handle(number: int, frame: FrameType | None) -> None:
        leave_lost_terminal()
        if stop.is_set():
            # Threads may be deep in compiled code: leave without asking them. Chunks are whole or not there.
            how = f"; continue with: nearflat resume {folder}" if folder else ""
            _leave(in_words(f"stopped{how}"))
        stop.set()
        if _command.is_set():
            _told.set()
        with contextlib.suppress(OSError):  # a closed pipe is noticed where the run says something
            note("stopping when the running chunks are done; once more stops now", quiet)

    with _handled_by(handle):
        yield stop


@contextlib.contextmanager
def as_interrupts() -> Iterator[None]:
    """While a command runs, every signal of SIGNALS is a KeyboardInterrupt; the second one ends the program."""
    _told.clear()
    _command.set()

    def handle(number: int, frame: FrameType | None) -> None:
        leave_lost_terminal()
        if _told.is_set():
            _leave("stopped")
        _told.set()
        raise KeyboardInterrupt

    try:
        with _handled_by(handle):
            yield
    finally:
        _command.clear()
        _told.clear()


def was_told() -> bool:
    """Whether a signal asked the command that runs to stop."""
    return _told.is_set()


def ignore() -> None:
    """From here on the work is done, and only the interpreter ends: a signal must not change the exit status."""
    _set_all(signal.SIG_IGN)


@contextlib.contextmanager
def withheld() -> Iterator[None]:
    """Threads and processes that are started meanwhile never get SIGNALS; for this thread they only wait.

    A terminal and a batch system send them to a whole group of processes; the parent decides what becomes of
    running chunks.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    from multiprocessing import resource_tracker

    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        # The first process or lock of `multiprocessing` starts a tracker, and doing so Python (up to 3.13) lets
        # SIGINT and SIGTERM through again, for this thread and for all that it starts later.
        resource_tracker.ensure_running()
        signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _handled_by(handler: Handler) -> Iterator[None]:
    before = _set_all(handler)
    try:
        yield
    finally:
        for number, each in before.items():
            signal.signal(number, each)


def _set_all(handler: Handler | signal.Handlers) -> dict[int, Handler | int]:
    """Handle all signals that are not ignored, in the main thread; returns who handled them before."""
    if threading.current_thread() is not threading.main_thread():
        return {}
    before = {number: signal.getsignal(number) for number in SIGNALS}
    known = {number: each for number, each in before.items() if each not in (signal.SIG_IGN, None)}
    for number in known:
        signal.signal(number, handler)
    return known


def _leave(text: str) -> NoReturn:
    """End the program now, without asking anyone."""
    with contextlib.suppress(OSError):
        print(text, file=sys.stderr, flush=True)
    os._exit(STATUS)


def leave_lost_terminal() -> bool:
    """Where the terminal was closed, let what is still said go nowhere, and say that it was."""
    lost = False
    for handle in (1, 2):
        try:
            os.write(handle, b"")
        except BrokenPipeError:
            continue
        except OSError as error:
            lost = lost or error.errno == errno.EIO
            with contextlib.suppress(OSError):
                os.dup2(os.open(os.devnull, os.O_WRONLY), handle)
    return lost

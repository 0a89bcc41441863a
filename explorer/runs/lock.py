"""One run at a time in a folder: a lock that dies with its owner, so nobody ever clears it by hand."""

import contextlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from explorer.errors import InputError

if sys.platform == "win32":
    import msvcrt

    def _take(stream: IO[str]) -> None:
        msvcrt.locking(stream.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _take(stream: IO[str]) -> None:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextlib.contextmanager
def only_one(folder: Path) -> Iterator[None]:
    """Hold the folder's lock. Raises InputError where a living run holds it, or where it cannot be written."""
    path = folder / ".lock"
    try:
        opened = path.open("a+", encoding="utf-8")
    except OSError as error:
        raise InputError(
            f"{path}: cannot be the lock of a run ({error.strerror}); remove it or give another folder"
        ) from None
    with opened as stream:
        try:
            _take(stream)
        except OSError:
            stream.seek(0)
            owner = stream.read().strip()
            raise InputError(
                f"--out {folder}: another run is at work there{f' (process {owner})' if owner else ''}; "
                "wait for it or give another folder"
            ) from None
        stream.truncate(0)
        stream.write(str(os.getpid()))
        stream.flush()
        yield

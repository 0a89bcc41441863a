"""Progress for people: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import sys
import time
from typing import Any

from tqdm import tqdm

_SECONDS_BETWEEN_LINES = 5.0


class Progress:
    """Counts finished chunks of a run on stderr."""

    def __init__(self, total: int, label: str, quiet: bool) -> None:
        self._total, self._label, self._quiet = total, label, quiet
        self._done = 0
        self._spoke = time.monotonic()
        self._bar: Any = None
        if not quiet and sys.stderr.isatty():
            self._bar = tqdm(total=total, desc=label, unit="chunk", file=sys.stderr, leave=False)

    def advance(self) -> None:
        """One more chunk is done."""
        self._done += 1
        if self._bar is not None:
            self._bar.update()
        elif not self._quiet and time.monotonic() - self._spoke > _SECONDS_BETWEEN_LINES:
            self._spoke = time.monotonic()
            print(f"{self._label}: {self._done} of {self._total} chunks", file=sys.stderr, flush=True)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


def note(text: str, quiet: bool) -> None:
    """A line for people, on stderr."""
    if not quiet:
        print(text, file=sys.stderr, flush=True)

"""Progress as users see it: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import sys
import time
from typing import Any

from tqdm import tqdm

_SECONDS_BETWEEN_LINES = 5.0


class Progress:
    """Finished chunks of a run on stderr, with samples per second, time left and failures by status."""

    def __init__(self, total: int, label: str, quiet: bool) -> None:
        self._total, self._label, self._quiet = total, label, quiet
        self._done = self._fresh = 0
        self._counts: dict[str, int] = {}
        self._started = self._spoke = time.monotonic()
        self._bar: Any = None
        if not quiet and sys.stderr.isatty():
            self._bar = tqdm(total=total, desc=label, unit="chunk", file=sys.stderr, leave=False)

    def already(self, chunks: int) -> None:
        """So many chunks were there before."""
        self._done = chunks
        if self._bar is not None:
            self._bar.update(chunks)

    def advance(self, status: dict[str, int]) -> None:
        """One more chunk is done, with so many samples in each status."""
        self._done += 1
        self._fresh += 1
        for name, count in status.items():
            self._counts[name] = self._counts.get(name, 0) + count
        if self._bar is not None:
            self._bar.set_postfix_str(self._failures())
            self._bar.update()
        elif not self._quiet and time.monotonic() - self._spoke > _SECONDS_BETWEEN_LINES:
            self._spoke = time.monotonic()
            print(self._line(), file=sys.stderr, flush=True)

    def _line(self) -> str:
        seconds = max(time.monotonic() - self._started, 1e-9)
        rate = sum(self._counts.values()) / seconds
        left = (self._total - self._done) * seconds / self._fresh
        line = f"{self._label}: {self._done} of {self._total} chunks, {rate:,.0f} samples/s, {left:.0f} s left"
        failures = self._failures()
        return f"{line}; {failures}" if failures else line

    def _failures(self) -> str:
        return ", ".join(f"{count:,} {name}" for name, count in self._counts.items() if name != "ok")

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()

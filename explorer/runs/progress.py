"""Progress as users see it: a bar on a terminal and in a notebook, plain lines elsewhere, nothing when quiet."""

import contextlib
import os
import sys
import time
from typing import Any

from explorer.runs.amounts import duration

_SECONDS_BETWEEN_LINES = 5.0


class Progress:
    """Steps of a run, its chunks and then its pictures, with samples per second, time left and failures."""

    def __init__(self, total: int, label: str, quiet: bool) -> None:
        self._total, self._label, self._quiet = total, label, quiet
        self._done = self._fresh = 0
        self._counts: dict[str, int] = {}
        self._started = self._spoke = time.monotonic()
        self._bar: Any = None
        if not quiet and (in_notebook() or sys.stderr.isatty()):
            # Lines are left where the environment says of tqdm what it cannot use (TQDM_NCOLS and the like).
            with contextlib.suppress(Exception):
                from tqdm.auto import tqdm

                how: dict[str, Any] = {"total": total, "desc": label, "unit": "step", "leave": False}
                self._bar = tqdm(**how, ncols=_width(), file=sys.stderr)

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
        self._show(self._failures(), self._line)

    def expect(self, pictures: int) -> None:
        """So many pictures will be drawn."""
        self._total += pictures
        if self._bar is not None:
            self._bar.total = self._total
            self._bar.refresh()

    def drawing(self, name: str) -> None:
        """The next picture is begun."""
        if self._bar is not None:
            self._bar.set_postfix_str(f"drawing {name}")
        elif not self._quiet and self._late():
            line = f"{self._label}: drawing {name}, {self._done} of {self._total} steps done"
            print(line, file=sys.stderr, flush=True)

    def drawn(self) -> None:
        """It is done."""
        self._done += 1
        if self._bar is not None:
            self._bar.update()

    def _show(self, beside: str, line: Any) -> None:
        if self._bar is not None:
            self._bar.set_postfix_str(beside)
            self._bar.update()
        elif not self._quiet and self._late():
            print(line(), file=sys.stderr, flush=True)

    def _late(self) -> bool:
        """Whether the last line was written long enough ago."""
        late = time.monotonic() - self._spoke > _SECONDS_BETWEEN_LINES
        if late:
            self._spoke = time.monotonic()
        return late

    def _line(self) -> str:
        seconds = max(time.monotonic() - self._started, 1e-9)
        rate = sum(self._counts.values()) / seconds
        left = (self._total - self._done) * seconds / self._fresh
        line = f"{self._label}: {self._done} of {self._total} chunks, {rate:,.0f} samples/s, {duration(left)} left"
        failures = self._failures()
        return f"{line}; {failures}" if failures else line

    def _failures(self) -> str:
        return ", ".join(f"{count:,} {name}" for name, count in self._counts.items() if name != "ok")

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


def _width() -> int | None:
    """Columns of a bar; None lets it follow the terminal. One that reports no width would show nothing."""
    try:
        return None if os.get_terminal_size(sys.stderr.fileno()).columns else 80
    except (OSError, ValueError):  # no terminal: a notebook
        return None


def in_notebook() -> bool:
    """Whether a notebook shows what is printed; its stderr is no terminal, yet a bar can be drawn."""
    shell = sys.modules.get("IPython")
    running = shell.get_ipython() if shell is not None else None
    return running is not None and "IPKernelApp" in running.config

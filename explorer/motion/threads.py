"""Work in parts: in threads, and such that Ctrl-C is answered while kernels are at work.

Python hears a signal between two steps of its own, never within a kernel. So samples go to kernels in blocks that
take less than a second. Integrators follow all motions at once, since lanes stand empty at the end of a block: a
thread does that, and the one that hears signals waits for it.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_EXCEPTION, Future, wait
from functools import partial
from itertools import pairwise
from typing import Any, TypeVar

import numpy as np

Done = TypeVar("Done")

BLOCK = 16384  # samples at a time: hundredths of a second, and what is found between stays in the cache
_HEARD = 0.2  # seconds between two looks at signals, on systems where these do not break off a wait


class Group:
    """Calls side by side that somebody waits for, and what ends the kernels that are at work for them."""

    def __init__(self) -> None:
        self.wanted = True
        self.ends = list[Callable[[], None]]()

    def call(self, call: Callable[..., Done], *given: Any) -> Done:
        """The result of a call of the group, in a thread that does nothing else."""
        _here.group = self
        return call(*given)

    def end(self) -> None:
        """Make its calls end soon, because nobody waits for them any more."""
        self.wanted = False
        for end in list(self.ends):
            end()


class _UnwantedError(Exception):
    """Nobody waits for this call, so nobody sees this."""


class _Here(threading.local):
    group: Group | None = None  # that this thread works for


_here = _Here()


def require_wanted() -> None:
    """Raise an exception if nobody waits any more for what this thread does."""
    if _here.group is not None and not _here.group.wanted:
        raise _UnwantedError


def blocks(count: int, size: int = BLOCK) -> Iterator[slice]:
    """The rows of `count` samples, some at a time; an empty slice where there are none."""
    for first in range(0, max(count, 1), size):
        require_wanted()
        yield slice(first, min(first + size, count))


def in_parts(jobs: int, count: int, call: Callable[[slice], Done], size: int | None = None) -> list[Done]:
    """`call` on the rows of up to `jobs` parts of `count` samples, in as many threads.

    size: samples at a time; by default all of a part.
    """
    ends = np.linspace(0, count, max(1, min(jobs, count)) + 1).astype(int).tolist()

    def in_turn(first: int, last: int) -> list[Done]:
        parts = blocks(last - first, size or max(last - first, 1))
        return [call(slice(first + rows.start, first + rows.stop)) for rows in parts]

    calls = [partial(in_turn, *part) for part in pairwise(ends)]
    return [each for part in (side_by_side(calls) if len(calls) > 1 else [calls[0]()]) for each in part]


def attended(kernel: Callable[[], None], end: Callable[[], None] = lambda: None) -> None:
    """Call a kernel that may take long; where Ctrl-C breaks that off, `end` makes the kernel end soon.

    What nothing ends goes on to its end, unseen.
    """
    group = _here.group
    if group is not None:
        group.ends.append(end)
        try:
            require_wanted()  # after `end` is there: one of both ends the kernel, whenever nobody waits any more
            kernel()
        finally:
            group.ends.remove(end)
    elif threading.current_thread() is threading.main_thread():
        side_by_side([partial(attended, kernel, end)])
    else:
        kernel()


def side_by_side(calls: Sequence[Callable[[], Done]], seconds: float = math.inf) -> list[Done]:
    """The results of calls, each in a thread of its own; where one fails, its error, and the others are left.

    seconds: for how long; then TimeoutError is raised. Python does not wait for these threads where it ends.
    """
    limit = time.monotonic() + seconds
    group, futures = Group(), [Future[Done]() for _ in calls]

    def run(call: Callable[[], Done], future: Future[Done]) -> None:
        try:
            future.set_result(group.call(call))
        except BaseException as error:
            future.set_exception(error)

    try:
        for each in zip(calls, futures, strict=True):
            threading.Thread(target=run, args=each, daemon=True).start()
        left = set(futures)
        while left:
            if time.monotonic() > limit:
                raise TimeoutError
            ended, left = wait(left, _HEARD, FIRST_EXCEPTION)
            for future in ended:
                future.result()
    except BaseException:
        group.end()
        raise
    return [future.result() for future in futures]

"""Motions in time as the kernels follow them: to given times, at their own steps, and between those.

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.plan import Plan
from explorer.motion.starts import held_constants
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants
from explorer.phase.states import Array, States

Done = TypeVar("Done")

# Chords of such arcs of the rim stay within half a per cent of the radius.
LONGEST_ANGLE = 0.2  # rad of chi
# In this time, in units of 1/speed, no other angle changes by much more than as many radians.
LONGEST_TIME = 0.1
MOST_POINTS = 4_000_000  # of all curves of a call, padding included: about a gigabyte with all observables
_PIECE = 4096  # records that a kernel writes before it is asked whether there is room for more


class Motions(NamedTuple):
    """Motions before they are followed; initial (10, n), held: what they are held to, control: their tolerance."""

    disk: Disk
    plan: Plan
    max_steps: int
    initial: Array
    held: LinearConstants
    status: NDArray[np.int8]
    control: float

    def at(self, rows: NDArray[np.intp]) -> Motions:
        """Some of them."""
        held = LinearConstants(*(column[rows] for column in self.held))
        initial = np.ascontiguousarray(self.initial[:, rows])
        return self._replace(initial=initial, held=held, status=self.status[rows].copy())

    def how(self, count: int) -> compiled.attempt.Integration:
        """The plan for `count` of them as the kernels take it."""
        # Time itself is carried from this depth on.
        return self.plan.integration(np.full(count, self.control), self.max_steps, compiled.field.ANGLES)

    @property
    def number(self) -> int:
        """How many they are."""
        return int(self.status.size)


class Outcome(NamedTuple):
    """What became of motions: status (n), attempted steps (n), errors of the constants (3, n)."""

    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array


def motions(states: States, how: Plan, chi0: float, max_steps: int) -> Motions:
    """The motions through `states`, as they are before they are followed."""
    initial = np.zeros((10, len(states)))
    initial[:5] = states.natural
    initial[compiled.field.ROW.chi] = chi0
    status, held = held_constants(states, natural_constants(states))
    return Motions(states.disk, how, max_steps, initial, held, status, how.held_control)


def in_parts(jobs: int, count: int, call: Callable[[NDArray[np.intp]], Done]) -> list[Done]:
    """`call` on the numbers of up to `jobs` parts of `count` motions, in as many threads."""
    parts = np.array_split(np.arange(count), max(1, min(jobs, count)))
    if len(parts) == 1:
        return [call(parts[0])]
    from joblib import Parallel, delayed

    return list(Parallel(n_jobs=len(parts), backend="threading")(delayed(call)(rows) for rows in parts))


def sample(given: Motions, times: Array, jobs: int = 1) -> tuple[Array, Outcome]:
    """States (n, nt, 10) at increasing times >= 0, NaN where a motion is not OK."""
    if min(jobs, given.number) <= 1:
        return _sample(given._replace(status=given.status.copy()), times)
    parts = in_parts(jobs, given.number, lambda rows: _sample(given.at(rows), times))
    states = np.concatenate([part for part, _ in parts])
    columns = zip(*(outcome for _, outcome in parts), strict=True)
    return states, Outcome(*(np.concatenate(column, axis=-1) for column in columns))


def _sample(given: Motions, times: Array) -> tuple[Array, Outcome]:
    n, later = given.number, times[times > 0.0]  # the kernel takes times above 0; the state at 0 is known
    outcome = Outcome(given.status, np.empty(n, np.int32), np.empty((3, n)))
    out, last, disk = np.empty((n, later.size, 10)), np.empty((10, n)), given.disk
    how, pinned, reached = given.how(n), np.stack(given.held), compiled.attempt.Outcome(*outcome)
    work = compiled.motions.Motions(how, later, given.initial, pinned, out, last, np.empty(n), reached)
    if later.size == 0:
        outcome.steps[:] = 0
        outcome.constants_error[:] = np.where(given.status == compiled.status.Status.OK, 0.0, np.nan)
    else:
        compiled.motions.MOTIONS[how.method, how.depth](work, disk.natural, disk.whole)
        compiled.motions.judge_batch(work, _constants(disk, given.initial), _constants(disk, last), disk.natural)
    if later.size < times.size:
        out = np.concatenate([given.initial.T[:, None], out], axis=1)
    out[outcome.status != compiled.status.Status.OK] = np.nan
    return out, outcome


def _constants(disk: Disk, states: Array) -> Array:
    """Constants of motion of states (5 or more, n), rows as `kernels.disk.constants.Constants`."""
    found = np.empty((6, states.shape[1]))
    compiled.algebra.constants_batch(states[:5], disk.whole, disk.natural, found)
    return found


class Records(NamedTuple):
    """Motions at their own steps. rows: for each motion (k, 11), states and the step in s that was taken there."""

    rows: list[Array]
    outcome: Outcome

    @property
    def lengths(self) -> NDArray[np.int64]:
        """How many records each motion has; 0 where it is not OK."""
        return np.array([len(rows) for rows in self.rows], np.int64)

    def padded(self) -> Array:
        """(n, longest, 10): the states, each motion's last one repeated up to the longest; NaN where not OK."""
        longest = max((len(rows) for rows in self.rows), default=0)
        out = np.full((len(self.rows), max(longest, 1), 10), np.nan)
        for motion, rows in zip(out, self.rows, strict=True):
            if len(rows):
                motion[: len(rows)] = rows[:, :10]
                motion[len(rows) :] = rows[-1, :10]
        return out


def record(given: Motions, t_end: float, jobs: int = 1) -> Records:
    """Every motion at its own steps up to t_end. Raises InputError where that takes too much memory."""
    most = MOST_POINTS // max(given.number, 1)
    parts = in_parts(jobs, given.number, lambda rows: [_record(given, int(row), t_end, most) for row in rows])
    found = [motion for part in parts for motion in part]
    columns = zip(*(outcome for _, outcome in found), strict=True)
    empty = Outcome(given.status, np.empty(0, np.int32), np.empty((3, 0)))
    outcome = Outcome(*(np.concatenate(column, axis=-1) for column in columns)) if found else empty
    return Records([rows for rows, _ in found], outcome)


def _record(given: Motions, row: int, t_end: float, most: int) -> tuple[Array, Outcome]:
    """One motion: its records (k, 11), none where it is not OK, and what became of it."""
    kernels, code = compiled.recording, compiled.status.Status
    one = given.at(np.array([row]))
    outcome = Outcome(one.status, np.zeros(1, np.int32), np.full((3, 1), np.nan))
    if outcome.status[0] != code.OK:
        return np.empty((0, 11)), outcome
    curve = kernels.Curve(LONGEST_ANGLE, LONGEST_TIME, t_end)
    start = kernels.Start(one.initial, np.stack(one.held))
    going = kernels.Going(np.zeros((10, 1)), *np.zeros((4, 1)), *np.zeros((3, 1), np.int64))
    how, buffer, pieces = one.how(1), np.empty((_PIECE, 11)), [np.empty((0, 11))]
    while going.stage[0] != kernels.ENDED:
        kernels.record_piece(
            how, curve, start, one.disk.natural, going, buffer, compiled.attempt.Outcome(*outcome)
        )
        pieces.append(buffer[: going.rows[0]].copy())
        if sum(map(len, pieces)) > most:
            raise InputError(
                f"t_end: so dense, curves of {given.number} motion(s) take more than {MOST_POINTS:,} times; "
                "give t_eval, fewer states or a smaller t_end"
            )
    if outcome.status[0] != code.OK:
        return np.empty((0, 11)), outcome
    rows = np.concatenate(pieces)
    rows[-1, compiled.field.ROW.t] = t_end  # where it was located, but for rounding
    return rows, outcome


def between(given: Motions, records: Records, times: Array) -> Array:
    """States (n, nt, 10) of recorded motions at any times, which are in the units of the disk; NaN where not OK.

    A time of the record itself, in these units, is that record: rounding of units must not move it within a race.
    """
    unit = given.disk.time_unit
    out = np.full((given.number, times.size, 10), np.nan)
    for motion, rows in zip(out, records.rows, strict=True):
        if len(rows):
            known = rows[:, compiled.field.ROW.t]
            own = known * unit
            places = np.clip(np.searchsorted(own, times, side="right") - 1, 0, len(rows) - 1)
            natural = np.where(own[places] == times, known[places], times * given.disk.rate_unit)
            columns = np.empty((10, times.size))
            compiled.recording.at_times(given.how(1), rows, places, natural, given.disk.natural, columns)
            motion[:] = columns.T
    return out

"""Motions in time as the kernels follow them: at given times, as dense curves, and between the points of these.

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.error_estimates import (
    accepted,
    amplified_at,
    error_of,
    in_race,
    less_where_amplified,
    rounding_of_path,
)
from explorer.motion.integration import InitialValues, Integrated, follow, follow_accurately
from explorer.motion.plan import PATH, Plan
from explorer.motion.starts import status_at_start
from explorer.motion.threads import blocks, in_parts
from explorer.phase.linear_constants import motion_through
from explorer.phase.states import Array, States

# Chords of such arcs of the rim stay within half a per cent of the radius.
LONGEST_ANGLE = 0.2  # rad of chi
# In this time, in units of 1/speed, no other angle changes by much more than as many radians.
LONGEST_TIME = 0.1
MOST_POINTS = 4_000_000  # of all curves of a call, padding included: about a gigabyte with all observables
_AT_ONCE = 200_000  # states between points in one call of a kernel: a tenth of a second of most


class Outcome(NamedTuple):
    """What became of motions: status (n), attempted steps (n), errors of the constants (3, n), estimates of others
    (n)."""

    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array
    error_estimate: Array


def motions(states: States, how: Plan, chi0: float, max_steps: int) -> InitialValues:
    """The motions through `states`, as they are before they are followed."""
    initial = np.zeros((10, states.size))
    initial[:5] = states.natural
    initial[compiled.field.ROW.chi] = chi0
    control = np.full(states.size, how.control)
    if how.level == PATH and not how.adaptive:
        control = np.fmin(control, compiled.attempt.MOST_TURNED / states.disk.kappa)
    status = status_at_start(states)
    return InitialValues(states.disk, how.in_time, initial, states.motion, status, control, max_steps)


def sample(motions: InitialValues, times: Array, jobs: int = 1) -> tuple[Array, Outcome]:
    """States (n, nt, 10) at increasing times >= 0, NaN where a motion is not OK."""
    parts = in_parts(jobs, motions.status.size, lambda rows: _sample(motions.at(rows), times)[:2])
    return np.concatenate([part for part, _ in parts]), _joined([outcome for _, outcome in parts])


def _joined(parts: list[Outcome]) -> Outcome:
    return Outcome(*(np.concatenate(column, axis=-1) for column in zip(*parts, strict=True)))


def _sample(given: InitialValues, times: Array) -> tuple[Array, Outcome, InitialValues]:
    """The same, and the motions with the steps by which they are as accurate as was asked."""
    disk, how, code, n = given.disk, given.plan, compiled.status.Status, given.status.size
    start, last = given.motion, float(times[-1]) if times.size else 0.0
    later = times[times > 0.0]  # the kernel takes values above 0; the state at 0 is known
    if later.size == 0:
        out, none = np.empty((n, 0, 10)), np.where(given.status == code.OK, 0.0, np.nan)
        outcome = Outcome(given.status.copy(), np.zeros(n, np.int32), np.tile(none, (3, 1)), none)
    else:
        amplified, seen = amplified_at(disk, how, given.initial, start, last)
        given, asked = given.finer(less_where_amplified(how, amplified)), accepted(how, last)

        def estimate(found: Integrated, rows: Any) -> Array:
            return error_of(disk, how, found.moved, found.out[:, -1].T, seen[rows], last)

        found, error, given = follow_accurately(given, compiled.events.TIME, later, estimate, asked)
        out, ended = found.out, np.ascontiguousarray(found.out[:, -1].T)
        if how.level == PATH:
            rounded = rounding_of_path(disk, start.energy, found.steps, last)
            followed = np.isin(found.status, [code.OK, code.STEP_LIMIT])
            found.status[followed & (rounded > asked)] = code.STEP_TOO_SMALL
            error = error + rounded
        error[~np.isin(found.status, (code.OK, code.STEP_TOO_SMALL))] = np.nan
        then, plus = motion_through(disk, ended[:5]), start.nearer_plus
        energy = then.energy / start.energy - 1.0
        moved = np.stack([energy, then.sigma3_bar - start.sigma3_bar, then.eta(plus) - start.eta(plus)])
        outcome = Outcome(found.status, found.steps, moved, in_race(disk, ended, error))
    if later.size < times.size:
        out = np.concatenate([given.initial.T[:, None], out], axis=1)
    out[outcome.status != code.OK] = np.nan
    return out, outcome, given


class Records(NamedTuple):
    """Curves of motions. points (11, all): rows as State, and the step in s to take from a point; first (n + 1):
    where each curve begins, which has no points where its motion is not OK."""

    points: Array
    first: NDArray[np.int64]

    @property
    def lengths(self) -> NDArray[np.int64]:
        """How many points each motion has; 0 where it is not OK."""
        return self.first[1:] - self.first[:-1]

    def at(self, rows: NDArray[np.intp]) -> Records:
        """The curves of some motions."""
        each = [np.arange(self.first[row], self.first[row + 1]) for row in rows]
        first = np.append(0, np.cumsum(self.lengths[rows]))
        return Records(np.ascontiguousarray(self.points[:, np.concatenate([*each, np.arange(0)])]), first)

    def padded(self, values: Array) -> Array:
        """(n, longest, ...): values of all points, the last of each motion repeated; NaN where it is not OK."""
        lengths = self.lengths[:, None]
        places = self.first[:-1, None] + np.minimum(np.arange(max(lengths.max(initial=0), 1)), lengths - 1)
        missing = np.full((1, *values.shape[1:]), np.nan)
        return np.concatenate([values, missing])[np.where(lengths > 0, places, len(values))]


def record(motions: InitialValues, t_end: float, jobs: int = 1) -> tuple[Records, Outcome]:
    """Curves of all motions up to t_end, and their outcome. Raises InputError where memory is too little."""
    number = motions.status.size
    found = in_parts(jobs, number, lambda rows: _record(motions.at(rows), t_end, number))
    sizes = np.concatenate([part.lengths for part, _ in found])
    points = np.concatenate([part.points for part, _ in found], axis=1)
    return Records(points, np.append(0, np.cumsum(sizes))), _joined([outcome for _, outcome in found])


def _record(given: InitialValues, t_end: float, number: int) -> tuple[Records, Outcome]:
    """Curves of a part of `number` motions: first how finely they are to be followed, then each of their steps."""
    _ends, outcome, given = _sample(given, np.full(1, t_end))
    given, code = given._replace(status=outcome.status), compiled.status.Status
    # Memory that nothing is written to is not taken.
    room = given.status.size * (MOST_POINTS // max(number, 1))
    rows, used = np.empty((room, compiled.curves.COLUMNS)), np.zeros(1, np.int64)
    history = compiled.curves.History(LONGEST_ANGLE, LONGEST_TIME, rows, used, room + 1)
    found = follow(given, compiled.events.TIME, np.full(1, t_end), history)
    if used[0] > room:
        raise InputError(
            f"t_end = {t_end:g}: the curves of {number} motion(s) would take more than {MOST_POINTS:,} times; "
            "give t_eval, fewer states or a smaller t_end"
        )
    ends = found.out[:, 0]
    ends[:, compiled.field.ROW.t] = t_end  # where it was located, but for rounding
    records = _in_order(rows[: used[0]], ends, found.status == code.OK)
    return records, outcome._replace(status=found.status, steps=found.steps)


def _in_order(rows: Array, ends: Array, drawn: NDArray[np.bool_]) -> Records:
    """The points of curves one after another, the end of each behind its steps; of motions that are `drawn`."""
    owner = np.append(rows[:, compiled.curves.OWNER].astype(np.int64), np.arange(drawn.size))
    order = np.argsort(owner, kind="stable")
    order = order[drawn[owner[order]]]
    last = np.pad(ends, ((0, 0), (0, 1)))  # from which there is no step
    points = np.stack([np.append(rows[:, k], last[:, k])[order] for k in range(last.shape[1])])
    return Records(points, np.append(0, np.cumsum(np.bincount(owner[order], minlength=drawn.size))))


def between(motions: InitialValues, records: Records, times: Array) -> Array:
    """States (n, nt, 10) of recorded motions at any times in the units of the disk; NaN where not OK."""
    number, disk, how = motions.status.size, motions.disk, motions.plan
    out = np.empty((number, times.size, 10))
    moments = compiled.curves.Moments(times, disk.time_unit, disk.rate_unit)
    for rows in blocks(number, max(1, _AT_ONCE // max(times.size, 1))):
        curves = compiled.curves.Curves(records.points, records.first[rows.start : rows.stop + 1])
        compiled.curves.at_times(how.kernel_method, how.kernel_depth, curves, moments, disk.body, out[rows])
    return out

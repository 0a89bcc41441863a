"""Motions in time as the kernels follow them: to given times, as dense curves, and between the points of these.

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion import precision
from explorer.motion.parts import attended, blocks, in_parts
from explorer.motion.plan import Plan
from explorer.motion.starts import held_constants
from explorer.phase.constants import NaturalConstants, natural_constants
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants
from explorer.phase.states import Array, States

# Chords of such arcs of the rim stay within half a per cent of the radius.
LONGEST_ANGLE = 0.2  # rad of chi
# In this time, in units of 1/speed, no other angle changes by much more than as many radians.
LONGEST_TIME = 0.1
MOST_POINTS = 4_000_000  # of all curves of a call, padding included: about a gigabyte with all observables
# Of all motions together: units of time, and longest ways in them (r), that take a tenth of a second at most.
_LONG = 20_000.0
_AT_ONCE = 200_000  # states between points in one call of a kernel: a tenth of a second of most
_RACING = 0.1  # cos phi at the end, below which an error of the time counts more than that of the angles
# For which there is room at first: of each motion, and in each unit of its time; and how many times that then.
_POINTS, _PER_TIME, _MORE = 256, 512, 8


class Motions(NamedTuple):
    """Motions before they are followed; initial (10, n), constants (6, n): of these, rows as NaturalConstants.

    held: what they are held to. control (n): their steps or tolerances. apart (n): how far from there those that
    were followed before ended by other steps; NaN of the others.
    """

    disk: Disk
    plan: Plan
    max_steps: int
    initial: Array
    constants: Array
    held: LinearConstants
    status: NDArray[np.int8]
    control: Array
    apart: Array

    def at(self, rows: NDArray[np.intp]) -> Motions:
        """Some of them."""
        held = LinearConstants(*(column[rows] for column in self.held))
        initial, constants = (np.ascontiguousarray(part[:, rows]) for part in (self.initial, self.constants))
        alike = {name: getattr(self, name)[rows] for name in ("status", "control", "apart")}
        return self._replace(initial=initial, constants=constants, held=held, **alike)

    def again(self, outcome: Outcome, apart: Array, time: float) -> Motions:
        """The same by finer steps, where they came too far apart (n)."""
        control = precision.finer(self.plan, self.control)
        control = np.where(precision.astray(self.plan, apart, time), control, self.control)
        return self._replace(control=control, apart=np.fmax(self.apart, apart), status=outcome.status.copy())

    @property
    def how(self) -> compiled.attempt.Integration:
        """The plan as the kernels take it."""
        # Time itself is carried from this depth on.
        return self.plan.integration(self.control, self.max_steps, compiled.field.ANGLES)

    @property
    def number(self) -> int:
        """How many they are."""
        return int(self.status.size)


class Outcome(NamedTuple):
    """What became of motions: status (n), attempted steps (n), errors of the constants (3, n), estimates of others
    (n)."""

    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array
    error_estimate: Array

    @classmethod
    def of(cls, given: Motions) -> Outcome:
        """Room for it, with the status in which motions start."""
        n = given.number
        return cls(given.status.copy(), np.empty(n, np.int32), np.empty((3, n)), np.full(n, np.nan))

    def put(self, rows: NDArray[np.intp], found: Outcome) -> None:
        """What became of some of the motions in the end."""
        self.status[rows], self.steps[rows] = found.status, found.steps
        self.constants_error[:, rows], self.error_estimate[rows] = found.constants_error, found.error_estimate


def motions(states: States, how: Plan, chi0: float, max_steps: int) -> Motions:
    """The motions through `states`, as they are before they are followed."""
    initial = np.zeros((10, len(states)))
    initial[:5] = states.natural
    initial[compiled.field.ROW.chi] = chi0
    natural = natural_constants(states)
    status, held = held_constants(states, natural)
    control = precision.steps(states.disk, how, natural.energy)
    apart = np.full(len(states), np.nan)
    return Motions(states.disk, how, max_steps, initial, np.array(natural), held, status, control, apart)


def sample(given: Motions, times: Array, jobs: int = 1) -> tuple[Array, Outcome]:
    """States (n, nt, 10) at increasing times >= 0, NaN where a motion is not OK."""
    if min(jobs, given.number) <= 1:
        return _sample(given, times)
    parts = in_parts(jobs, given.number, lambda rows: _sample(given.at(rows), times))
    states = np.concatenate([part for part, _ in parts])
    columns = zip(*(outcome for _, outcome in parts), strict=True)
    return states, Outcome(*(np.concatenate(column, axis=-1) for column in columns))


def _sample(given: Motions, times: Array) -> tuple[Array, Outcome]:
    later = times[times > 0.0]  # the kernel takes times above 0; the state at 0 is known
    if later.size == 0:
        out, outcome = np.empty((given.number, 0, 10)), Outcome.of(given)
        outcome.steps[:] = 0
        outcome.constants_error[:] = np.where(given.status == compiled.status.Status.OK, 0.0, np.nan)
        outcome.error_estimate[:] = outcome.constants_error[0]
    else:
        out, outcome, apart = _followed(given, later)
        rows = np.flatnonzero(
            precision.astray(given.plan, apart, later[-1]) & (outcome.status == compiled.status.Status.OK)
        )
        if rows.size:
            better = given.again(outcome, apart, later[-1]).at(rows)
            out[rows], found, _ = _followed(better, later)
            outcome.put(rows, found)
    if later.size < times.size:
        out = np.concatenate([given.initial.T[:, None], out], axis=1)
    out[outcome.status != compiled.status.Status.OK] = np.nan
    return out, outcome


def _followed(given: Motions, times: Array) -> tuple[Array, Outcome, Array]:
    """States (n, nt, 10) at times > 0, what became of the motions, and as `_judge`."""
    outcome = Outcome.of(given)
    work = _work(given, times, outcome)
    _run(given, work, _no_trail(), outcome)
    return work.out, outcome, _judge(given, work, outcome)


def _work(given: Motions, times: Array, outcome: Outcome) -> compiled.motions.Motions:
    """What the kernels are given and what they fill; outcome: its statuses are read and written."""
    n, how, reached = given.number, given.how, compiled.attempt.Outcome(*outcome[:3])
    out, last, taken = np.empty((n, times.size, 10)), np.empty((10, n)), np.empty((3, n))
    pinned = np.stack(given.held)
    return compiled.motions.Motions(how, times, given.initial, pinned, out, last, taken, reached)


def _run(given: Motions, work: compiled.motions.Motions, trail: compiled.trail.Trail, outcome: Outcome) -> None:
    """Follow motions.

    A kernel ends motions whose status somebody else changes: by that it ends where nobody waits for it.
    """
    disk, how = given.disk, work.how
    follow = partial(compiled.motions.MOTIONS[how.method, how.depth], work, trail, disk.natural, disk.whole)
    if _long(given, work.times[-1]):
        attended(follow, partial(outcome.status.fill, compiled.status.Status.STEP_LIMIT))
    else:
        follow()


def _long(given: Motions, time: float) -> bool:
    """Whether motions take so long up to a time that it does not matter to wait for a thread."""
    way = precision.way(given.disk, NaturalConstants(*given.constants).energy)
    return not float(time) * float(given.number + np.nansum(way)) < _LONG


def _judge(given: Motions, work: compiled.motions.Motions, outcome: Outcome) -> Array:
    """Tell how far motions that were followed may have erred, and which of them have no answer for that.

    Returns how far from there they end by other steps (n), NaN of those that were not followed twice.
    """
    disk, code = given.disk, compiled.status.Status
    last = np.empty_like(given.constants)
    compiled.algebra.constants_batch(work.last[:5], disk.whole, disk.natural, last)
    compiled.motions.judge_batch(work, given.constants, last, disk.natural)
    start, ok = NaturalConstants(*given.constants), outcome.status == code.OK
    reached = work.last[compiled.field.ROW.t]
    ends = precision.Ends(reached, outcome.steps, outcome.constants_error[0], work.taken)
    found = precision.error_estimate(disk, given.plan, start, ends)
    found = precision.estimate_in_race(disk, given.plan, work.out[:, -1].T, found)
    apart, unknown = _second_run(given, work, outcome)
    found = np.fmax(np.fmax(found, apart), given.apart)
    outcome.status[unknown], ok[unknown] = code.STEP_LIMIT, False
    outcome.error_estimate[ok] = found[ok]
    lost = ok & precision.lost_to_rounding(disk, given.plan, start.energy, ends)
    outcome.status[lost] = code.STEP_TOO_SMALL
    return apart


def _second_run(
    given: Motions, work: compiled.motions.Motions, outcome: Outcome
) -> tuple[Array, NDArray[np.intp]]:
    """How far doubtful motions end from where they do by other steps (n), NaN of others; and which have no answer.

    Those have none whose second run came to no end, or ended elsewhere.
    """
    start, ended, time = NaturalConstants(*given.constants), work.out[:, -1], float(work.times[-1])
    asked = (outcome.status == compiled.status.Status.OK) & np.isnan(given.apart)
    rows = np.flatnonzero(asked & precision.doubtful(given.disk, given.plan, start, time))
    apart = np.full(given.number, np.nan)
    if rows.size:
        apart[rows] = _apart(given.at(rows), work.times[-1:], ended[rows])
    racing = ended[rows, compiled.field.ROW.q] < _RACING
    elsewhere = ~racing & (apart[rows] > precision.most_apart(given.disk, given.plan, time))
    return apart, rows[elsewhere | np.isnan(apart[rows])]


def _apart(given: Motions, time: Array, ended: Array) -> Array:
    """How far motions (n) end from where they do by other steps, angles (rad) or path (r).

    time (1): at which they `ended` (n, 10). NaN where that takes more steps than a motion may: it needs up to ten
    times as many as the first run, in the median two (dop853) or four (dopri5).
    """
    row = compiled.field.ROW
    other = given._replace(control=precision.finer(given.plan, given.control))
    outcome = Outcome.of(other)
    work = _work(other, time, outcome)
    _run(other, work, _no_trail(), outcome)
    known = (outcome.status == compiled.status.Status.OK)[:, None]
    apart = np.where(known, abs(work.out[:, 0] - ended), np.nan).T
    tilt, path = np.hypot(apart[row.q], apart[row.z]), np.hypot(apart[row.a1], apart[row.a2])
    farthest: Array = np.max([tilt, apart[row.chi], apart[row.psi], path], axis=0)
    return farthest


def _no_trail() -> compiled.trail.Trail:
    """Of motions that are sampled only."""
    return compiled.trail.Trail(compiled.trail.Curve(0.0, 0.0), np.empty((0, 12)), np.zeros(1, np.int64), 0)


class Records(NamedTuple):
    """Curves of motions. points (11, all): rows as State, and the step in s to take from a point; first (n + 1):
    where each curve begins, which has no points where its motion is not OK."""

    points: Array
    first: NDArray[np.int64]
    outcome: Outcome

    @property
    def lengths(self) -> NDArray[np.int64]:
        """How many points each motion has; 0 where it is not OK."""
        return self.first[1:] - self.first[:-1]

    @property
    def places(self) -> NDArray[np.int64]:
        """(n, longest): the points of each motion, whose last one is repeated up to the longest."""
        lengths = self.lengths
        longest = max(int(lengths.max(initial=0)), 1)
        places: NDArray[np.int64] = np.minimum(
            self.first[:-1, None] + np.arange(longest), self.first[1:, None] - 1
        )
        return places

    def padded(self, values: Array, places: NDArray[np.int64]) -> Array:
        """(n, longest, ...): values of all points, (all, ...), at these places; NaN where a motion is not OK."""
        if places.size == len(values):
            return values.reshape(*places.shape, *values.shape[1:])
        failed = self.lengths == 0
        if failed.all():
            return np.full((*places.shape, *values.shape[1:]), np.nan)
        out = values.take(places, axis=0, mode="clip")
        out[failed] = np.nan
        return out


def record(given: Motions, t_end: float, jobs: int = 1) -> Records:
    """Curves of all motions up to t_end. Raises InputError where that takes too much memory."""
    if min(jobs, given.number) <= 1:
        return _record(given, t_end, given.number)
    found = in_parts(jobs, given.number, lambda rows: _record(given.at(rows), t_end, given.number))
    sizes = np.concatenate([part.lengths for part in found])
    columns = zip(*(part.outcome for part in found), strict=True)
    outcome = Outcome(*(np.concatenate(column, axis=-1) for column in columns))
    points = np.concatenate([part.points for part in found], axis=1)
    return Records(points, np.concatenate([[0], np.cumsum(sizes)]), outcome)


def _record(given: Motions, t_end: float, number: int) -> Records:
    """Curves of a part of `number` motions."""
    n, curve = given.number, compiled.trail.Curve(LONGEST_ANGLE, LONGEST_TIME)
    most = n * (MOST_POINTS // max(number, 1))
    likely = int(min(n * (_POINTS + _PER_TIME * t_end), most))
    room = likely
    while True:
        outcome = Outcome.of(given)
        work = _work(given, np.full(1, t_end), outcome)
        # What there is no room for ends the kernel: followed to their end twice, motions would take twice as long.
        trail = compiled.trail.Trail(curve, np.empty((room, 12)), np.zeros(1, np.int64), room + 1)
        _run(given, work, trail, outcome)
        used = int(trail.used[0])
        if used <= room:
            apart = _judge(given, work, outcome)
            astray = precision.astray(given.plan, apart, t_end)
            if not (astray & (outcome.status == compiled.status.Status.OK)).any():
                break
            given = given.again(outcome, apart, t_end)
            continue
        _require(room < most, number)
        room = min(_MORE * room, most)
    state_at_end, how = work.out, work.how
    course = compiled.recording.Course(
        *(curve, trail.rows[:used], work.last, state_at_end, outcome.status, t_end, how.method, how.depth),
        most=MOST_POINTS // max(number, 1),
    )
    points, first = _drawn(course, given.disk, max(used, likely), number)
    seen = np.fmax(outcome.error_estimate, precision.strayed(given.disk, points, first))
    return Records(points, first, outcome._replace(error_estimate=seen))


def _drawn(
    course: compiled.recording.Course, disk: Disk, room: int, number: int
) -> tuple[Array, NDArray[np.int64]]:
    """The points of curves, and where each begins; room: for how many points at first."""
    most = MOST_POINTS // max(number, 1)
    while True:
        found = compiled.recording.Drawing(np.empty((11, room)), np.empty(course.status.size + 1, np.int64))
        compiled.recording.draw_batch(course, found, disk.natural)
        _require(int(np.diff(found.first).max(initial=0)) <= most, number)
        total = int(found.first[-1])
        if total <= room:
            return np.ascontiguousarray(found.points[:, :total]), found.first
        room = total


def _require(enough: bool, number: int) -> None:
    if not enough:
        raise InputError(
            f"t_end: so dense, curves of {number} motion(s) take more than {MOST_POINTS:,} times; "
            "give t_eval, fewer states or a smaller t_end"
        )


def between(given: Motions, records: Records, times: Array) -> Array:
    """States (n, nt, 10) of recorded motions at any times in the units of the disk; NaN where not OK."""
    out, disk, kernels = np.empty((given.number, times.size, 10)), given.disk, compiled.recording
    for rows in blocks(given.number, max(1, _AT_ONCE // max(times.size, 1))):
        curves = kernels.Drawing(records.points, records.first[rows.start : rows.stop + 1])
        for some in blocks(times.size, _AT_ONCE):
            moments = kernels.Moments(times[some], disk.time_unit, disk.rate_unit)
            kernels.at_times(given.how, curves, moments, disk.natural, out[rows, some])
    return out

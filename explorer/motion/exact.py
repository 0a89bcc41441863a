"""Motions that are known for all time, from one rise of the tilt each (`kernels.arcs.motions`).

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.errors import InputError
from explorer.motion.error_estimates import PASSAGE
from explorer.motion.orbits import WITH_PLACES
from explorer.motion.plan import LOOSEST
from explorer.motion.rises import rises_of
from explorer.motion.starts import ArcStarts, arc_starts, face_of, status_at_start
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import rows_of
from explorer.phase.states import Array, Rows, States

KERNELS = (*WITH_PLACES, "motions.motion_batch")  # for `compiled.warmup`
# Chords of such arcs of the rim stay within half a per cent of the radius; in such a time, in units of 1/speed, no
# other angle changes by much more than as many radians.
LONGEST_ANGLE, LONGEST_TIME = 0.2, 0.1
_RESERVE = 0.9  # of these, since times between the points of a piece are found by straight lines
MOST_POINTS = 4_000_000  # of all curves of a call, padding included: about a gigabyte with all observables
SINCE_START = np.full((1, 1), np.nan)
_AT_ONCE, _CURVES_AT_ONCE = 1 << 16, 256  # states, and curves, of which a kernel finds all at a time


class Outcome(NamedTuple):
    """What became of motions: status (n), attempted steps (n), errors of the constants (3, n), estimates of others
    (n); of exact ones a period and the errors of that (9, n), rows as `motions.PeriodRow`."""

    status: NDArray[np.int8]
    steps: NDArray[np.int32]
    constants_error: Array
    error_estimate: Array
    period: Any = None


class Exact(NamedTuple):
    """Motions (n) by their rises: states, from which faces they are seen, the jump of chi at flat on F; chi at the
    start; their status; the error (rad, r) that is allowed in a passage; whether paths are asked for."""

    disk: Disk
    rows: Rows
    starts: ArcStarts
    own: Array
    jump: Array
    chi0: Array
    energy: Array
    status: NDArray[np.int8]
    accuracy: float
    path: bool

    @classmethod
    def through(cls, states: States, chi0: Array, accuracy: float, path: bool) -> "Exact":
        """The motions through states in a row."""
        own = face_of(states)
        starts = arc_starts(states.disk, states.rows, states.motion, own > 0.0)
        jump, status = np.zeros(states.size), status_at_start(states)
        energy = states.motion.energy
        return cls(states.disk, states.rows, starts, own, jump, chi0, energy, status, accuracy, path)

    def at(self, rows: Any) -> "Exact":
        """Some of them."""
        tables = rows_of(self.rows, rows), rows_of(self.starts, rows)
        own, jump, chi0, energy = (each[rows] for each in (self.own, self.jump, self.chi0, self.energy))
        return Exact(self.disk, *tables, own, jump, chi0, energy, self.status[rows], self.accuracy, self.path)

    def at_once(self, times: int) -> int:
        """Of how many motions a call finds states at so many times."""
        return max(1, _AT_ONCE // max(times, 1))

    def seen(self, times: Array, lows: Array = SINCE_START) -> tuple[Array, Outcome]:
        """States (10, n, nt) at times (n or 1, nt), NaN where a motion is not OK, and what became of motions.

        lows (n or 1, nt or 1): since which lower turning point times count, 0 that nearest to the start, or since
        the start where NaN.
        """
        n, m, code = self.status.size, times.shape[1], compiled.status.Status
        period = np.empty((len(compiled.motions.PeriodRow._fields), n))
        out = np.empty((n, m, compiled.motions.OUT))
        rises = rises_of(self.disk, self.rows, self.starts, self.own, self.jump)
        when = np.ascontiguousarray(times), np.ascontiguousarray(lows)
        compiled.motions.motion_batch(rises, *when, self.path, self.disk.arc_disk, period, out)
        states, (raced, angle, path) = np.moveaxis(out[..., :10], -1, 0), np.moveaxis(out[..., 10:], -1, 0)
        states += 0.0  # of what is seen in a mirror, -0
        states[compiled.field.ROW.chi] += self.chi0[:, None]
        sine, cosine = np.sin(self.chi0)[:, None], np.cos(self.chi0)[:, None]
        for a1, a2 in (states[8:], period[3:5, :, None]):
            a1[:], a2[:] = cosine * a1 - sine * a2, sine * a1 + cosine * a2
        error = np.maximum(angle, path if self.path else 0.0)
        allowed = np.fmin(self.accuracy * np.fmax(1.0, abs(states[compiled.field.ROW.t]) / PASSAGE), LOOSEST)
        known, found = (error <= allowed).all(axis=1), ~np.isnan(period[[0, 5]]).any(axis=0)
        status = np.where(known & found, code.OK, np.where(found, code.TOO_FEW_DIGITS, code.STEP_LIMIT))
        status = np.where(self.status == code.OK, status, self.status).astype(np.int8)
        # Inside a race an error of the time is a larger one of chi, and at most all of that race.
        error = (error + np.fmin(raced, 2.0 * self.disk.race_limit)).max(axis=1, initial=0.0)
        lost = status != code.OK
        out[lost], error[self.status != code.OK] = np.nan, np.nan
        kept = np.where(lost, np.nan, np.zeros((3, n)))
        return states, Outcome(status, np.zeros(n, np.int32), kept, error, period)

    def lowest(self) -> Array:
        """The numbers (n) of the first lower turning points at or after the starts, as `seen` counts them."""
        period = self.seen(np.zeros((1, 1)))[1].period
        return np.where(compiled.motions.PeriodRow(*period).since > 0.0, 1.0, 0.0)

    def curve(self, end: float) -> tuple[Array, Array, NDArray[np.int64]]:
        """Times (n, nt) from the start to an end, dense enough for curves, since which lower turning points they
        count, and how many times each motion has; rows go on with the end.

        By symmetry the points of one rise serve all rises and falls.
        """
        _, outcome = self.seen(np.zeros((1, 1)))
        alike = [
            points
            for rows in range(0, self.status.size, _CURVES_AT_ONCE)
            for points in self.at(slice(rows, rows + _CURVES_AT_ONCE))._points()
        ]
        period = compiled.motions.PeriodRow(*outcome.period)
        half, since = 0.5 * period.time, period.since
        good = outcome.status == compiled.status.Status.OK
        points = np.array([each.size for each in alike], float)
        with np.errstate(invalid="ignore", over="ignore"):
            most = np.where(good, 2.0 + 2.0 * points * (2.0 + end / half), 1.0)
        if self.status.size * most.max(initial=1.0) > MOST_POINTS:
            raise InputError(
                f"t_end = {end * self.disk.time_unit:g}: the curves of {self.status.size} motion(s) would take "
                f"more than {MOST_POINTS:,} times; give t_eval, fewer states or a smaller t_end"
            )
        courses = [
            _unfolded(each, float(since[j]), float(half[j]), end) if good[j] else (np.zeros(1), np.full(1, np.nan))
            for j, each in enumerate(alike)
        ]
        lengths = np.array([times.size for times, _ in courses], np.int64)
        padded = np.full((self.status.size, lengths.max(initial=1)), end)
        lows = np.full(padded.shape, np.nan)
        for j, (times, numbers) in enumerate(courses):
            padded[j, : times.size], lows[j, : times.size] = times, numbers
        return padded, lows, np.where(good, lengths, 0)

    def _points(self) -> list[Array]:
        """Times since the lower turning point of points on each rise, from there to the upper one."""
        n, module = self.status.size, compiled.motions
        first = np.zeros(n + 1, np.int64)
        out = np.empty((2, n * compiled.pieces.MOST * (compiled.pieces.N + 1)))
        rises = rises_of(self.disk, self.rows, self.starts, self.own, self.jump)
        module.course_batch(rises, self.disk.arc_disk, first, out)
        speed, found = np.sqrt(2.0 * self.disk.body.inv_M * self.energy), []
        for low, high, pace in zip(first[:-1], first[1:], speed, strict=True):
            time, chi = out[:, low:high]
            if not time.size:
                found.append(np.zeros(1))
                continue
            moved = np.fmax(abs(np.diff(chi)) / LONGEST_ANGLE, np.diff(time) * pace / LONGEST_TIME) / _RESERVE
            way = np.append(0.0, np.cumsum(moved))
            steps = max(2, int(np.ceil(way[-1])))
            found.append(np.interp(np.linspace(0.0, way[-1], steps + 1), way, time))
        return found


def _unfolded(points: Array, since: float, half: float, end: float) -> tuple[Array, Array]:
    """The times of a curve and since which lower turning points they count, from those of a rise; NaN: the start.

    points: times since the lower turning point; since: that of the start.
    """
    around = np.append(-points[:0:-1], points[:-1])
    last = int(np.floor(0.5 * (since + end) / half + 0.5))
    numbers = np.repeat(np.arange(last + 1.0), around.size)
    times = np.tile(around, last + 1)
    at = (times - since) + 2.0 * half * numbers
    inside = (at > 0.0) & (at < end)
    return np.append(np.append(0.0, times[inside]), end), np.append(np.append(np.nan, numbers[inside]), np.nan)

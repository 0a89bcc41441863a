"""Motions in time by integration, at given times.

All in natural units. A state has the ten components of kernels.disk.field.State.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.error_estimates import (
    accepted,
    amplified_at,
    error_of,
    in_race,
    less_where_amplified,
    rounding_of_path,
)
from explorer.motion.exact import Outcome
from explorer.motion.integration import InitialValues, Integrated, follow_accurately
from explorer.motion.plan import PATH, Plan
from explorer.motion.starts import status_at_start
from explorer.phase.disk import Disk
from explorer.phase.linear_constants import motion_through
from explorer.phase.states import Array, States


class ByIntegration(NamedTuple):
    """Motions (n) as integrators follow them from their starts."""

    given: InitialValues

    @classmethod
    def through(cls, states: States, how: Plan, chi0: Array, max_steps: int) -> ByIntegration:
        """The motions through states in a row."""
        initial = np.zeros((10, states.size))
        initial[:5] = states.natural
        initial[compiled.field.ROW.chi] = chi0
        control = np.full(states.size, how.control)
        if how.level == PATH and not how.adaptive:
            control = np.fmin(control, compiled.attempt.MOST_TURNED / states.disk.kappa)
        status = status_at_start(states)
        return cls(InitialValues(states.disk, how.in_time, initial, states.motion, status, control, max_steps))

    @property
    def disk(self) -> Disk:
        """The body."""
        return self.given.disk

    @property
    def status(self) -> NDArray[np.int8]:
        """Before they are followed."""
        return self.given.status

    def at(self, rows: Any) -> ByIntegration:
        """Some of them."""
        return ByIntegration(self.given.at(rows))

    def at_once(self, _times: int) -> None:
        """Lanes of a kernel stand empty at its end, so that it follows as many motions as there are."""
        return

    def seen(self, times: Array, _lows: Any = None) -> tuple[Array, Outcome]:
        """States (10, n, nt) at increasing times (1, nt) >= 0, NaN where a motion is not OK, and what became of
        motions."""
        given, disk, how, code = self.given, self.disk, self.given.plan, compiled.status.Status
        start, n, last = given.motion, given.status.size, float(times[0, -1]) if times.size else 0.0
        later = times[0, times[0] > 0.0]  # the kernel takes values above 0; the state at 0 is known
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
        return np.moveaxis(out, -1, 0), outcome

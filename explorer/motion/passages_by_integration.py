"""Passages by integration to the turning point, twice: the second, finer one tells the error of the first.

The factors below are such that the estimate covers the true error, known by quadrature, of every one of some
10^5 passages from any start at the vertical, for every method (tests of this file and of `passages`).
"""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.passages_by_quadrature import Followed
from explorer.motion.plan import Plan
from explorer.motion.turning_points import TurningPoints, turning_points
from explorer.motion.vertical import Starts
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk
from explorer.phase.states import Array, constants_to_states

# The finer integration: its share of the tolerance, or of the step. Its error is then a sixtieth of that of the
# coarser one or less (rk4, of order 4: a sixteenth), so that the difference of both is the coarser one's error.
_FINER = {"dopri5": 1e-3, "dop853": 1e-4, "rk4": 0.5, "rk8": 0.6}
# The answer is that of the finer one and the estimate that of the coarser, so an estimate above the accuracy asked
# by less than this is let pass.
LENIENCE = 10.0
# Both may happen to lie on the same side of the truth, and closer to each other than to it.
_CAUTION = 5.0
# The rounding of some hundred steps, each of some ten operations.
_ROUNDING = 3e-12
# Near the vertical at rest the motion leaves an unstable equilibrium, which amplifies rounding like 1/speed: below
# this speed (natural units) it is felt. Rounding also ends a rest: it acts like this least speed.
_SLOW, _LEAST_SPEED = 0.15, 5e-5
# eta is known to the rounding of the initial state, and goes on losing digits over the steps.
_ETA_LOSS = 3.0


def by_integration(disk: Disk, starts: Starts, how: Plan) -> Followed:
    """Passages from the vertical to the turning point, doubled: the second half is the first run backwards."""
    face = starts.face
    states = constants_to_states(disk, starts.sigma3_bar, starts.eta_hat, face * starts.speed, face)
    natural = natural_constants(states)
    finer = how.scaled(_FINER[how.method])
    rough, fine = turning_points(states, how, natural), turning_points(states, finer, natural)
    rounding = natural.rounding(face > 0.0)
    error = estimate_error(disk, starts, rounding, rough, fine)
    if how.adaptive:
        # On short ways both may take much the same steps; then their difference tells nothing.
        error = error + _CAUTION * finer.control(disk, natural)
    missed = ~(error <= LENIENCE * how.accuracy)
    status = statuses(disk, starts, rounding, rough, fine)
    ok = status == compiled.status.Status.OK
    # A passage ends at the flat state it was sent to; one that turns elsewhere was never near it.
    status[ok & (fine.face != face)] = compiled.status.Status.BAD_INPUT
    status[ok & missed] = compiled.status.Status.STEP_LIMIT
    return Followed(
        fine.theta, 2.0 * fine.chi, 2.0 * fine.psi * face, 2.0 * fine.time, fine.way, natural.energy, error, status
    )


def estimate_error(
    disk: Disk, starts: Starts, rounding: Array, rough: TurningPoints, fine: TurningPoints
) -> Array:
    """Estimated error of passages: of angles (rad), or of time and tilt (relative), whichever is larger.

    rounding: that of eta at the start, natural units.
    """
    eta, unit = starts.natural(disk)[1], disk.rate_unit
    unknown = rounding / np.where(eta == 0.0, 1.0, abs(eta))
    apart = np.fmax(2.0 * abs(fine.chi - rough.chi), 2.0 * abs(fine.psi - rough.psi))
    apart = np.fmax(apart, abs(rough.time / fine.time - 1.0))
    apart = np.fmax(apart, abs(rough.theta / fine.theta - 1.0))
    of_steps = _ROUNDING * (1.0 + _SLOW * unit / (starts.speed + _LEAST_SPEED * unit))
    return _CAUTION * apart + _ETA_LOSS * unknown + of_steps


def statuses(
    disk: Disk, starts: Starts, rounding: Array, rough: TurningPoints, fine: TurningPoints
) -> NDArray[np.int8]:
    """Status of passages, before their error is looked at: what is bad from the start, then what failed.

    A state in doubles knows eta to its rounding. Where that is not small, it does not know its race.
    """
    code, eta = compiled.status.Status, starts.natural(disk)[1]
    doubtful = (fine.status == code.FALLS) | (rounding > compiled.attempt.RESOLVED_SHARE * abs(eta))
    status = np.where(rough.status == code.OK, fine.status, rough.status)
    status = np.where(doubtful, code.UNRESOLVED_SIDE, status)
    status = np.where(eta == 0.0, code.FALLS, status)
    return np.where(starts.status == code.OK, status, starts.status).astype(np.int8)

"""Knowledge of a motion before it is followed: its status, its constants, its place in the orbit kernels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Disk
from explorer.phase.falling_set import falls
from explorer.phase.linear_constants import Motion
from explorer.phase.states import Array, Rows, States

_AS_FROM_REST = 1e-135  # of speeds: less changes no digit, and 1e-30 of its square, where rules begin, has none
# An error in eta above this share of |eta| makes the direction of the race doubtful. Ten times stricter than the
# sign needs: the error is only seen where the motion is checked.
_RESOLVED = 0.1


def status_at_start(states: States, sided: bool = True) -> NDArray[np.int8]:
    """Status before a motion is followed: bad input, on F, or, where its side matters (`sided`), off F.

    A state whose eta is not known to a tenth on the nearer face has no known direction of its race. Whether a
    motion could fall is asked only where its side is in doubt.
    """
    code, motion = compiled.status.Status, states.motion
    near = motion.nearer_plus
    unresolved = motion.rounding(near) >= _RESOLVED * abs(motion.eta(near))
    if not (states.disk.body.I3 > 0.0 and unresolved.any()):
        return states.codes.copy()
    found = falls(states.flat)
    unknown = sided & unresolved & found.could_fall & ~found.on_f & (found.status == code.OK)
    return np.where(unknown, code.UNRESOLVED_SIDE, found.status).astype(np.int8)


def face_of(states: States) -> Array:
    """The face, +1 or -1, in whose hemisphere states are; one that crosses the vertical is in both.

    That one is seen from the face of the smaller |eta|, and at rest from the one to which it begins to fall.
    """
    _q, z, p, ratio, sigma4 = states.rows
    plus = np.where(p == 0.0, ratio * sigma4 >= 0.0, states.motion.nearer_plus)
    return np.where((z > 0.0) | ((z == 0.0) & plus), 1.0, -1.0)


def kinetic(body: "compiled.body.Body", speed: Array) -> Array:
    """E - V of a motion that tilts with this speed."""
    return np.where(abs(speed) > _AS_FROM_REST, 0.5 * body.M * speed * speed, 0.0)


class ArcStarts(NamedTuple):
    """What arcs of motions start from, natural units, as seen from one face; Y_far: Y of the other face.

    unsure, unsure_far: the share of Y and of Y_far that rounding of the state leaves unknown.
    """

    starts: "compiled.turning_points.Starts"
    Y_far: Array
    unsure: Array
    unsure_far: Array

    def status(self, known: NDArray[np.bool_], crosses: NDArray[np.bool_], accuracy: float) -> NDArray[np.int8]:
        """OK where an answer is known to an accuracy; elsewhere whether digits of the state or of the way lack.

        crosses: whether motions come to the other face.
        """
        code, unsure = compiled.status.Status, np.fmax(self.unsure, np.where(crosses, self.unsure_far, 0.0))
        missed = np.where(unsure > accuracy, code.TOO_FEW_DIGITS, code.STEP_LIMIT)
        return np.where(known, code.OK, missed).astype(np.int8)


@np.errstate(over="ignore", divide="ignore", invalid="ignore")  # motions on F have no theta_min
def arc_starts(disk: Disk, rows: Rows, motion: Motion, plus: NDArray[np.bool_]) -> ArcStarts:
    """The same of rows of states and their motions; plus: whether each is seen from face +1.

    States that are no input give any numbers.
    """
    b, (q, z, p, ratio, sigma4) = disk.body, rows
    near, far = motion.eta(plus), motion.eta(~plus)
    unsure, unsure_far = motion.rounding(plus) / abs(near), motion.rounding(~plus) / abs(far)
    r, w = q / (1.0 + abs(z)), 2.0 * abs(z) / (1.0 + abs(z))
    spin = np.where(plus, sigma4, -sigma4)
    columns = motion.sigma3_bar / b.r0, near / b.I1, kinetic(b, p), r, w, q * ratio, spin
    starts = compiled.turning_points.Starts(*map(np.ascontiguousarray, columns))
    return ArcStarts(starts, far / b.I1, unsure, unsure_far)

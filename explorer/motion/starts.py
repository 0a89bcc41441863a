"""Knowledge of a motion before it is followed: its status, its constants, its place in the orbit kernels."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.constants import NaturalConstants
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants, nearer_plus
from explorer.phase.membership import falls_of
from explorer.phase.states import Array, Rows, States

# An error in eta above this share of |eta| makes the direction of the race doubtful. Ten times stricter than the
# sign needs: the error is only seen where the motion is checked.
_RESOLVED = 0.1


def status_at_start(states: States, natural: NaturalConstants) -> NDArray[np.int8]:
    """Status before any integration: bad input, or on the falling set."""
    if states.disk.body.I3 > 0.0:
        return falls_of(states, natural).status.copy()
    return states.status.copy()


def held_constants(states: States, natural: NaturalConstants) -> tuple[NDArray[np.int8], LinearConstants]:
    """Status before integration, and the constants that trajectories are held to.

    Constants that were given win over those computed from the state. A state whose eta is not known to a tenth
    on the nearer face has no known direction of its race. With I3 = 0 the constants are NaN and trajectories
    run free.
    """
    code = compiled.status.Status
    if not states.disk.body.I3 > 0.0:
        return states.status.copy(), LinearConstants(*np.full((3, len(states)), np.nan))
    linear = natural.linear if states.exact is None else states.exact
    near_plus = nearer_plus(linear.eta_plus, linear.eta_minus)
    eta = abs(np.where(near_plus, linear.eta_plus, linear.eta_minus))
    doubtful = eta == 0.0
    if states.exact is None:
        doubtful |= natural.rounding(near_plus) > _RESOLVED * eta
    status = states.status
    # Whether a motion could fall is asked only where its side is in doubt.
    if doubtful.any():
        falls = falls_of(states, natural)
        if states.exact is None:
            unknown = doubtful & falls.could_fall & ~falls.on_f
            status = np.where((falls.status == code.OK) & unknown, code.UNRESOLVED_SIDE, falls.status)
        else:
            status = np.where((status == code.OK) & doubtful & falls.could_fall, code.FALLS, status)
    held = np.array(linear)
    if not np.isfinite(held).all():
        held = np.nan_to_num(held)
    return status.astype(np.int8), LinearConstants(*held)


def seen_from(states: States, linear: LinearConstants) -> Array:
    """The face, +1 or -1, in whose hemisphere states are; one that crosses the vertical is in both.

    That one is seen from the face of the smaller |eta|, and at rest from the one to which it begins to fall.
    """
    _q, z, p, ratio, sigma4 = states.rows
    plus = np.where(p == 0.0, ratio * sigma4 >= 0.0, nearer_plus(linear.eta_plus, linear.eta_minus))
    return np.where((z > 0.0) | ((z == 0.0) & plus), 1.0, -1.0)


class Motions(NamedTuple):
    """Motions through states, natural units, as seen from the face in whose hemisphere these are; Y_far: of the
    other one."""

    starts: "compiled.turning_points.Starts"
    Y_far: Array

    def at(self, rows: NDArray[np.intp]) -> "Motions":
        """Some of the motions."""
        return Motions(compiled.turning_points.Starts(*(column[rows] for column in self.starts)), self.Y_far[rows])


def orbit_starts(states: States, linear: LinearConstants) -> Motions:
    """Motions as arcs need them; states that are no input give any numbers."""
    return motions_through(states.disk, states.rows, linear, seen_from(states, linear) > 0.0)


@np.errstate(over="ignore", invalid="ignore")
def motions_through(disk: Disk, rows: Rows, linear: LinearConstants, plus: NDArray[np.bool_]) -> Motions:
    """The same of rows of states; plus: whether each is seen from face +1."""
    b, (q, z, p, ratio, sigma4) = disk.body, rows
    near = np.where(plus, linear.eta_plus, linear.eta_minus) / b.I1
    far = np.where(plus, linear.eta_minus, linear.eta_plus) / b.I1
    r, w = q / (1.0 + abs(z)), 2.0 * abs(z) / (1.0 + abs(z))
    columns = linear.sigma3_bar / b.r0, near, 0.5 * b.M * p * p, r, w, q * ratio, np.where(plus, sigma4, -sigma4)
    return Motions(compiled.turning_points.Starts(*map(np.ascontiguousarray, columns)), far)


def fallen(linear: LinearConstants, status: NDArray[np.int8]) -> NDArray[np.int8]:
    """`status`, with FALLS where an eta is exactly 0: such a motion has no period."""
    code = compiled.status.Status
    zero = (linear.eta_plus == 0.0) | (linear.eta_minus == 0.0)
    return np.where((status == code.OK) & zero, code.FALLS, status).astype(np.int8)

"""Knowledge of a motion before it is followed: its status, its constants, its place in the orbit kernels."""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.constants import NaturalConstants
from explorer.phase.disk import Disk
from explorer.phase.lines import LinearConstants, nearer_plus
from explorer.phase.membership import falls_of
from explorer.phase.states import Array, States

# Of a potential, for each unit of its terms; and how much larger those from flat are where that is felt.
_ROUNDING, _FELT = 2.2e-16, 50.0


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
        doubtful |= natural.rounding(near_plus) > compiled.attempt.RESOLVED_SHARE * eta
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

    It is seen from the face of the smaller |eta|: as a difference of two large numbers the energy has few digits
    where I3 is small.
    """
    z = states.rows.z
    nearer = nearer_plus(linear.eta_plus, linear.eta_minus) | (states.rows.p == 0.0)
    return np.where((z > 0.0) | ((z == 0.0) & nearer), 1.0, -1.0)


def orbit_starts(states: States, linear: LinearConstants) -> "compiled.point.Orbits":
    """Motions in the chart of the quadrature kernels, as seen from the hemisphere they start in."""
    q, z, p, _, _ = states.rows
    plus = seen_from(states, linear) > 0.0
    near = np.where(plus, linear.eta_plus, linear.eta_minus)
    far = np.where(plus, linear.eta_minus, linear.eta_plus)
    h = 2.0 * np.sin(0.5 * np.arctan2(q, abs(z)))
    return compiled.point.Orbits(
        *np.nan_to_num(np.stack([h, np.where(plus, p, -p), linear.sigma3_bar, near, far, abs(z)]))
    )


def told_upright(
    disk: Disk, starts: "compiled.point.Orbits", one_face: NDArray[np.bool_]
) -> tuple[NDArray[np.bool_], Array]:
    """Whether the potential of motions is told from the vertical, and the rounding of what it is told from flat.

    Where I3 is little, sigma4 at flat may be of the size of 1/I3, and V - V_0 a difference of squares of that.
    From the vertical on sigma4 changes by no more than sigma3 does. one_face: which do not cross the vertical.
    """
    b = disk.body
    # Rows of samples that are no motions hold any numbers.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        X, here, there = abs(starts.sigma3_bar) / b.r0, starts.near / b.I1, starts.far / b.I1
        flat = starts.sigma3_bar / b.r0 / b.k
        upright = flat * b.dr0 - here / b.r0 / b.k
        rise = X + abs(here) + abs(there)
        from_upright = rise * (2.0 * abs(upright) + rise)
        near, far = (abs(rise) * (2.0 * abs(flat) + abs(rise)) for rise in (upright - flat, upright + flat))
        from_flat = b.J * np.where(one_face, near, np.fmax(near, far))
        return from_flat > _FELT * (1.0 + from_upright), _ROUNDING * from_flat


def fallen(starts: "compiled.point.Orbits", status: NDArray[np.int8]) -> NDArray[np.int8]:
    """`status`, with FALLS where an eta is exactly 0: such a motion has no period."""
    code = compiled.status.Status
    zero = (starts.near == 0.0) | (starts.far == 0.0)
    return np.where((status == code.OK) & zero, code.FALLS, status).astype(np.int8)

"""The linear constants of motions, sigma3_bar, eta and eta_hat, and the lines l_+ and l_- where an eta is zero.

A motion that stays beside flat has three linear constants: sigma3_bar, eta_plus and eta_minus. They hang
together by eta_plus + eta_minus = 2 I1 r'(0) sigma3_bar, eq. (6.2), and eta_plus vanishes on l_+, eq. (6.1).
Everything here is in natural units.
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.phase.disk import Array, Disk, require_axial_inertia
from explorer.phase.energy import eta_hat_to_eta, eta_to_eta_hat

Record = TypeVar("Record", bound=tuple[Any, ...])


class Motion(NamedTuple):
    """Motions by their constants, natural units, arrays of one length: given, or computed from states.

    rounding_plus, rounding_minus: an eta below its rounding in size cannot be told from zero; 0 where it was
    given.
    """

    sigma3_bar: Array
    eta_plus: Array
    eta_minus: Array
    energy: Array
    rounding_plus: Array
    rounding_minus: Array

    @property
    def nearer_plus(self) -> NDArray[np.bool_]:
        """True where face +1 is the nearer one."""
        return nearer_plus(self.eta_plus, self.eta_minus)

    def eta(self, plus: NDArray[np.bool_]) -> Array:
        """eta on face +1 where `plus`, on face -1 elsewhere."""
        return np.where(plus, self.eta_plus, self.eta_minus)

    def rounding(self, plus: NDArray[np.bool_]) -> Array:
        """A bound of the rounding error of that eta."""
        return np.where(plus, self.rounding_plus, self.rounding_minus)


def rows_of(record: Record, rows: NDArray[Any] | slice) -> Record:
    """Some rows of a named tuple of columns, or of such tuples."""
    return type(record)(*(rows_of(each, rows) if isinstance(each, tuple) else each[rows] for each in record))


def motion_through(disk: Disk, states: Array) -> Motion:
    """The motions through states (5, n), rows as `phase.states.Rows`, computed from these."""
    out = np.empty((len(Motion._fields), states.shape[1]))
    compiled.algebra.constants_batch(np.ascontiguousarray(states), disk.natural, out)
    return Motion(*out)


def motion_given(disk: Disk, sigma3_bar: Array, eta_hat: Array, plus: NDArray[np.bool_]) -> Motion:
    """The motions with constants that are given exactly; their energy, which the tilt and its rate make, is NaN.

    eta_hat: on face +1 where `plus`, on face -1 elsewhere.
    """
    here = eta_hat_to_eta(disk.body, eta_hat)
    there = 2.0 * disk.body.I1 * disk.body.dr0 * sigma3_bar - here
    none = np.zeros(sigma3_bar.size)
    etas = np.where(plus, here, there), np.where(plus, there, here)
    return Motion(sigma3_bar, *etas, np.full(sigma3_bar.size, np.nan), none, none)


def line_chart(disk: Disk, q: Array, z: Array) -> "compiled.falling.LineChart[Array]":
    """The chart where cos phi = q and sin phi = z, arrays of one length. Needs I3 > 0."""
    rows = np.empty((4, q.size))
    compiled.falling.line_chart_batch(np.ascontiguousarray(q), np.ascontiguousarray(z), disk.natural, rows)
    return compiled.falling.LineChart(*rows)


def line_slope(disk: Disk) -> float:
    """sigma4_bar / sigma3_bar on l_+, eq. (6.1); minus that on l_-. Needs I3 > 0."""
    require_axial_inertia(disk)
    return eta_to_eta_hat(disk.body, disk.body.I1 * disk.body.dr0)


def other_eta_hat(disk: Disk, sigma3_bar: Any, eta_hat: Any) -> Any:
    """eta_hat on one face from that on the other, eq. (6.2)."""
    return 2.0 * line_slope(disk) * sigma3_bar - eta_hat


def nearer_plus(plus: Array, minus: Array) -> NDArray[np.bool_]:
    """True where the face of the smaller |eta| is +1: the rule for "the nearer face" of a state.

    plus, minus: eta or eta_hat on face +1 and on face -1. Ties and NaN count as +1.
    """
    found: NDArray[np.bool_] = ~compiled.constants.nearer_minus(plus, minus)
    return found

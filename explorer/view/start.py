"""Where a page begins: one motion, from numbers, from states or from a result that knows either."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number, shown, whole
from explorer.motion.starts import held_constants
from explorer.phase.constants import natural_constants
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.lines import nearer_plus
from explorer.phase.states import States

_UPRIGHT = 0.5 * math.pi
# The page takes steps in proportion to ln(1/|eta_hat|), some ten milliseconds of them here: it still keeps up
# with the hand.
_SMALLEST = 1e-30
_LARGEST = 1e3  # natural units; faster motions are over before anything is seen


@dataclass(frozen=True)
class Start:
    """The motion with which a page begins, in natural units.

    Attributes
    ----------
    sigma3_bar, eta_hat : float
        Constants of motion, eta_hat on `face`; in sqrt(g/r).
    phidot : float
        Speed towards the flat state of `face`, in sqrt(g/r).
    face : int
        The flat state that is meant, +1 or -1.
    theta : float
        Tilt (rad) from that flat state; pi/2 at the vertical.
    """

    sigma3_bar: float
    eta_hat: float
    phidot: float
    face: int = 1
    theta: float = _UPRIGHT


def start_at_vertical(disk: Disk, sigma3_bar: Any, eta_hat: Any, phidot: Any, face: Any) -> Start:
    """The motion that passages start with, from numbers in the units of the disk."""
    require_axial_inertia(disk)
    unit = disk.rate_unit
    given = {"sigma3_bar": sigma3_bar, "eta_hat": eta_hat, "phidot": phidot}
    rates = {name: number(name, value, -_LARGEST * unit, _LARGEST * unit) / unit for name, value in given.items()}
    facing = whole("face", face, -1, 1)
    if facing == 0:
        raise InputError(f"face = {shown(face)} must be 1 or -1")
    _require_side(rates["eta_hat"], "eta_hat")
    return Start(rates["sigma3_bar"], rates["eta_hat"], rates["phidot"], facing)


def _require_side(eta_hat: float, name: str) -> None:
    if abs(eta_hat) < _SMALLEST:
        raise InputError(
            f"{name}: with eta_hat = {eta_hat:g} the disk falls flat, and what comes next depends on the "
            "side of F; give a small number with its sign, such as 1e-12 or -1e-12"
        )


def start_in(source: Any, row: int) -> tuple[Disk, Start]:
    """The body and the motion of one row of states, or of a result that knows its states or its arguments."""
    states = source if isinstance(source, States) else getattr(source, "states", None)
    if isinstance(states, States):
        return states.disk, _start_of_state(states, whole("row", row, 0, len(states) - 1))
    try:
        arguments = [np.ravel(getattr(source, name)) for name in ("sigma3_bar", "eta_hat", "phidot", "face")]
        disk = source.disk
    except AttributeError:
        raise InputError(
            f"states: {type(source).__name__} is neither States nor a result that knows its states or arguments; "
            "give ex.constants_to_states(...), ex.phi_to_states(...) or one of their rows"
        ) from None
    columns = np.broadcast_arrays(*arguments)
    at = whole("row", row, 0, columns[0].size - 1)
    return disk, start_at_vertical(disk, *(column[at] for column in columns))


def _start_of_state(states: States, row: int) -> Start:
    """The motion through one state: its constants, and its tilt from the face whose line is nearer."""
    disk = states.disk
    require_axial_inertia(disk)
    one = states.at(np.array([row]))
    code = compiled.status.Status
    status, held = held_constants(one, natural_constants(one))
    if status[0] not in (code.OK, code.FALLS):
        verdict = code(int(status[0]))
        raise InputError(f"states, row {row}: {verdict.sentence} {verdict.remedy}")
    plus = bool(nearer_plus(held.eta_plus, held.eta_minus)[0])
    face = 1 if plus else -1
    eta = held.eta_plus if plus else held.eta_minus
    eta_hat = float(disk.eta_to_eta_hat(eta)[0])
    _require_side(0.0 if status[0] == code.FALLS else eta_hat, f"states, row {row}")
    q, z, p, _, _ = (float(row[0]) for row in one.rows)
    theta = _UPRIGHT if z == 0.0 else math.atan2(q, face * z)
    return Start(float(held.sigma3_bar[0]), eta_hat, -face * p, face, theta)

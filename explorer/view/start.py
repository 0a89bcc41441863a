"""Where a page begins: one motion, from numbers, from a state or from a result that knows either."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from explorer import compiled
from explorer.errors import InputError, number, sign, whole
from explorer.motion.bounces import Bounces
from explorer.motion.limit_motions import LimitMotion
from explorer.motion.starts import status_at_start
from explorer.phase.coordinates import constants_to_states
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.energy import eta_to_eta_hat
from explorer.phase.states import States

_UPRIGHT = 0.5 * math.pi
# The page takes steps in proportion to ln(1/|eta_hat|), some ten milliseconds of them here: it still keeps up
# with the hand.
_SMALLEST = 1e-30
_LARGEST = 1e3  # natural units; faster motions are over before anything is seen
_BESIDE = 1e-12  # natural units: a motion that the eye cannot tell from the limit motion of its side
_PASSAGE = ("sigma3_bar", "eta_hat", "phidot")


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


class AtVertical(NamedTuple):
    """What `view` is given for a motion from the vertical, in the units of the disk; None where it is not."""

    sigma3_bar: Any
    eta_hat: Any
    phidot: Any
    face: Any


_USUAL = AtVertical(sigma3_bar=1.0, eta_hat=1e-3, phidot=1.0, face=1)  # natural units


def start_at_vertical(disk: Disk, given: AtVertical) -> Start:
    """The motion that passages start with, from numbers in the units of the disk."""
    require_axial_inertia(disk)
    unit = disk.rate_unit

    def natural(name: str) -> float:
        value = getattr(given, name)
        if value is None:
            return float(getattr(_USUAL, name))
        return number(name, value, -_LARGEST * unit, _LARGEST * unit) / unit

    rates = {name: natural(name) for name in _PASSAGE}
    facing = sign("face", _USUAL.face if given.face is None else given.face)
    _require_side(rates["eta_hat"], "eta_hat")
    return Start(rates["sigma3_bar"], rates["eta_hat"], rates["phidot"], facing)


def _require_side(eta_hat: float, name: str) -> None:
    if abs(eta_hat) < _SMALLEST:
        raise InputError(
            f"{name}: with eta_hat = {eta_hat:g} the disk falls flat, and what comes next depends on the "
            "side of F; give a small number with its sign, such as 1e-12 or -1e-12"
        )


def start_in(motion: Any, row: Any) -> tuple[Disk, Start]:
    """The body and one motion of states, of a limit, or of a result that knows its states or its arguments.

    Raises InputError for what is no motion.
    """
    if isinstance(motion, LimitMotion):
        _one_of(1, row, "limit motion")
        return motion.disk, _start_of_limit(motion)
    if isinstance(getattr(motion, "states", motion), States):
        of_bounce = isinstance(motion, Bounces)
        place = _one_of(motion.size, row, "bounces" if of_bounce else "states")
        one = motion.at(np.array([place]))
        state = getattr(one, "states", one)
        return state.disk, _start_of_bounce(one, place) if of_bounce else _start_of_state(state, place)
    disk, known = getattr(motion, "disk", None), [getattr(motion, name, ()) for name in _PASSAGE]
    if not isinstance(disk, Disk) or not all(np.size(column) for column in known):
        raise InputError(
            f"motion: {type(motion).__name__} is not a motion; give a disk or its name, States, "
            "or what simulate, passages, bounces or limit_motion return"
        )
    # Forces are the same on both faces, so that their result has none.
    columns = [np.ravel(column) for column in np.broadcast_arrays(*known, getattr(motion, "face", 1))]
    place = _one_of(columns[0].size, row, "passages")
    return disk, start_at_vertical(disk, AtVertical(*(column[place] for column in columns)))


def _one_of(count: int, row: Any, things: str) -> int:
    """Which one is meant: the only one, or `row`."""
    if row is None and count == 1:
        return 0
    if count == 0:
        raise InputError(f"motion: there are no {things}, and a page shows one motion")
    if row is None:
        raise InputError(f"row: a page shows one motion; say which of the {count:,} {things}, 0 to {count - 1}")
    return whole("row", row, 0, count - 1)


def _start_of_state(one: States, row: int) -> Start:
    """The motion through one state: its constants, and its tilt from the face whose line is nearer."""
    disk, code = one.disk, compiled.status.Status
    require_axial_inertia(disk)
    status, held = status_at_start(one), one.motion
    if status[0] not in (code.OK, code.FALLS):
        verdict = code(int(status[0]))
        raise InputError(f"states, row {row}: {verdict.sentence} {verdict.remedy}")
    face = 1 if held.nearer_plus[0] else -1
    eta_hat = float(eta_to_eta_hat(disk.body, held.eta(held.nearer_plus))[0])
    _require_side(0.0 if status[0] == code.FALLS else eta_hat, f"states, row {row}")
    q, z, p, _, _ = (float(row[0]) for row in one.rows)
    theta = _UPRIGHT if z == 0.0 else math.atan2(q, face * z)
    return Start(float(held.sigma3_bar[0]), eta_hat, -face * p, face, theta)


def _start_of_bounce(bounce: Bounces, row: int) -> Start:
    """The motion from the vertical before one bounce; where it never crosses the vertical, from its state."""
    one, face = bounce.states, int(bounce.face[0])
    through, disk, unit = _start_of_state(one, row), one.disk, one.disk.rate_unit
    eta_hat = float(eta_to_eta_hat(disk.body, one.motion.eta_plus if face > 0 else one.motion.eta_minus)[0])
    upright = constants_to_states(disk, through.sigma3_bar * unit, eta_hat * unit, 0.0, face)
    left = one.motion.energy[0] - upright.motion.energy[0]
    if left <= 0.0:
        return through
    _require_side(eta_hat, f"bounces, row {row}")
    return Start(through.sigma3_bar, eta_hat, math.sqrt(2.0 * left / disk.body.M), face)


def _start_of_limit(limit: LimitMotion) -> Start:
    """The motion that follows a limit motion so closely, on its side of F, that nobody sees the difference."""
    unit, at = limit.disk.rate_unit, limit(0.0)
    theta, speed = _UPRIGHT - limit.face * float(at.phi), limit.face * float(at.phidot) / unit
    return Start(limit.sigma3_bar / unit, limit.side * _BESIDE, speed, limit.face, theta)

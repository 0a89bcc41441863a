"""Passages as users get them: the fall taken out of chi, units, and what is known of each sample."""

import math
from typing import Generic, NamedTuple

from kernels._jit import kernel
from kernels.disk.body import Disk
from kernels.disk.rows import Entry, put
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)
_BAD = int(Status.BAD_INPUT)
_LIMIT = int(Status.STEP_LIMIT)


class Units(NamedTuple):
    """Natural units in those of the user, and kappa pi."""

    time: float
    energy: float
    rate: float
    race: float


class Terms(NamedTuple):
    """On what terms passages are measured.

    allowed: the error above which a sample is refused; floor: the same where rounding is all that is left, times
    one plus the time of the fall.
    """

    allowed: float
    floor: float


class Ways(NamedTuple):
    """Passages (n) as a method followed them, natural units, angles as on face +1.

    speed: theta-dot at the vertical. way: sigma3/q at the flattest moment. status: of each; those that miss the
    bounds are marked.
    """

    sigma3_bar: Vector
    eta: Vector
    speed: Vector
    face: Vector
    theta_min: Vector
    chi: Vector
    psi: Vector
    time: Vector
    way: Vector
    energy: Vector
    error: Vector
    status: Codes


class Falls(NamedTuple):
    """Falls (n) on F with the same energies; level: E - V_0."""

    time: Vector
    chi: Vector
    level: Vector
    error: Vector


class RaceRow(NamedTuple, Generic[Entry]):
    """One passage in the units of the user; NaN what is not known. wrong_way: 1 or 0, of all that is ok."""

    race_angle: Entry
    delta_chi: Entry
    delta_psi: Entry
    fall_angle: Entry
    theta_min: Entry
    duration: Entry
    fall_time: Entry
    energy: Entry
    impact_speed: Entry
    limit: Entry
    error_estimate: Entry
    wrong_way: Entry


@kernel
def race_batch(ways: Ways, falls: Falls, terms: Terms, units: Units, disk: Disk, first: int, out: Matrix) -> None:
    """Passages without their falls -> out (12, m), as RaceRow, from column `first` on.

    The status of those that miss is marked.
    """
    b, nan = disk.body, math.nan
    for i in range(ways.status.size):
        fall_time, fall_error = falls.time[i], falls.error[i]
        fallen = ways.status[i] == _FALLS
        ok = ways.status[i] == _OK
        # The fall angle is a part of the race angle, and all there is of a fall.
        error = fall_error if fallen else 2.0 * fall_error
        error = ways.error[i] if ok and ways.error[i] > error else error
        allowed = max(terms.allowed, terms.floor * (1.0 + fall_time))
        if (ok or fallen) and not error <= allowed:
            ways.status[i] = _LIMIT
            ok = fallen = False
        known = ok or fallen
        eta, energy = ways.eta[i], ways.energy[i]
        side = 1.0 if eta > 0.0 else -1.0 if eta < 0.0 else 0.0
        fall_angle = 2.0 * falls.chi[i] if known else nan
        race = RaceRow(
            race_angle=ways.chi[i] - fall_angle if ok else nan,
            delta_chi=ways.chi[i] if ok else nan,
            delta_psi=ways.psi[i] * ways.face[i] if ok else nan,
            fall_angle=fall_angle,
            theta_min=ways.theta_min[i] if ok else 0.0 if fallen else nan,
            duration=ways.time[i] * units.time if ok else nan,
            fall_time=fall_time * units.time if fallen else nan,
            energy=energy * units.energy if known else nan,
            impact_speed=math.sqrt(2.0 * falls.level[i] / b.M) * units.rate if known else nan,
            limit=side * units.race if ways.status[i] != _BAD else nan,
            error_estimate=error if known else nan,
            wrong_way=1.0 if ok and not ways.way[i] * side > 0.0 else 0.0,
        )
        put(race, out, first + i)

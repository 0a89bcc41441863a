"""Passages as users get them: the fall taken out of chi, units, and what is known of each sample."""

import math
from typing import Generic, NamedTuple

import numpy as np

from kernels._jit import kernel, subroutine
from kernels.disk.body import Disk
from kernels.disk.rows import Entry
from kernels.status import Status
from kernels.types import Codes, Matrix, Vector

_OK = int(Status.OK)
_FALLS = int(Status.FALLS)
_BAD = int(Status.BAD_INPUT)
_LIMIT = int(Status.STEP_LIMIT)
LANES = 64  # as in `algebra`
# Rows of the work array: what is given, and then the rows of RaceRow.
_ETA, _FACE, _THETA_MIN, _CHI, _PSI, _TIME, _TURN_RATE, _ENERGY, _ERROR, _STATUS = range(10)
_FALL_TIME, _FALL_CHI, _LEVEL, _FALL_ERROR = range(10, 14)
_FOUND = 14


class Units(NamedTuple):
    """Natural units in those of the user, and kappa pi."""

    time: float
    energy: float
    rate: float
    race: float


class Terms(NamedTuple):
    """On what terms passages are measured.

    allowed: the error above which a sample is refused. Where rounding is all that is left, floor: the same times
    one plus the time of the fall; rounding: the same for each radian of the angles.
    """

    allowed: float
    floor: float
    rounding: float


class Samples(NamedTuple):
    """Passages (n) as a method followed them, natural units, angles as on face +1.

    speed: theta-dot at the vertical. turn_rate: sigma3/q at the flattest moment. status: of each; those that miss
    the bounds are marked.
    """

    sigma3_bar: Vector
    eta: Vector
    speed: Vector
    face: Vector
    theta_min: Vector
    chi: Vector
    psi: Vector
    time: Vector
    turn_rate: Vector
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


# Their places in the work array, as in `RaceRow`.
_ROW = RaceRow(*(_FOUND + row for row in range(12)))
_ROWS = _FOUND + len(_ROW)


@subroutine
def load(values: Vector, row: int, W: Vector) -> None:
    """One row of the work array. Of a slice all indices count from its start, so it is copied in lanes."""
    room = W[row * LANES : (row + 1) * LANES]
    for i in range(values.size):
        room[i] = values[i]


@subroutine
def store(W: Vector, row: int, values: Vector) -> None:
    """One row of the work array to where it is wanted."""
    found = W[row * LANES : (row + 1) * LANES]
    for i in range(values.size):
        values[i] = found[i]


@subroutine
def measure(W: Vector, terms: Terms) -> None:
    """Errors of the races, and the status of those that miss."""
    for i in range(LANES):
        code, error, fall_error = W[_STATUS * LANES + i], W[_ERROR * LANES + i], W[_FALL_ERROR * LANES + i]
        ok, fallen = code == _OK, code == _FALLS
        # With an energy up to V_0 nothing falls: such a passage has no race.
        races = W[_LEVEL * LANES + i] > 0.0
        # The fall angle is a part of the race angle, and all there is of a fall.
        part = fall_error if fallen else 2.0 * fall_error if races else 0.0
        error = error if ok & (error > part) else part
        turned = abs(W[_CHI * LANES + i]) + abs(W[_PSI * LANES + i]) if ok else 0.0
        fall_time = W[_FALL_TIME * LANES + i] if races else 0.0
        allowed = max(terms.allowed, terms.floor * (1.0 + fall_time), terms.rounding * turned)
        inexact = (ok | fallen) & (not error <= allowed)
        W[_ERROR * LANES + i] = error
        W[_STATUS * LANES + i] = _LIMIT if inexact else code


@subroutine
def lanes(W: Vector, units: Units, M: float) -> None:
    """Rows of RaceRow from what is given."""
    nan = math.nan
    for i in range(LANES):
        code, eta, chi = W[_STATUS * LANES + i], W[_ETA * LANES + i], W[_CHI * LANES + i]
        ok, fallen = code == _OK, code == _FALLS
        known = ok | fallen
        side = 1.0 if eta > 0.0 else -1.0 if eta < 0.0 else 0.0
        fall_angle = 2.0 * W[_FALL_CHI * LANES + i] if known else nan
        speed = math.sqrt(2.0 * W[_LEVEL * LANES + i] / M) * units.rate
        W[_ROW.race_angle * LANES + i] = chi - fall_angle if ok else nan
        W[_ROW.delta_chi * LANES + i] = chi if ok else nan
        W[_ROW.delta_psi * LANES + i] = W[_PSI * LANES + i] * W[_FACE * LANES + i] if ok else nan
        W[_ROW.fall_angle * LANES + i] = fall_angle
        W[_ROW.theta_min * LANES + i] = W[_THETA_MIN * LANES + i] if ok else 0.0 if fallen else nan
        W[_ROW.duration * LANES + i] = W[_TIME * LANES + i] * units.time if ok else nan
        W[_ROW.fall_time * LANES + i] = W[_FALL_TIME * LANES + i] * units.time if fallen else nan
        W[_ROW.energy * LANES + i] = W[_ENERGY * LANES + i] * units.energy if known else nan
        W[_ROW.impact_speed * LANES + i] = speed if known else nan
        races = (code != _BAD) & (speed > 0.0)
        W[_ROW.limit * LANES + i] = side * units.race if races else nan
        W[_ROW.error_estimate * LANES + i] = W[_ERROR * LANES + i] if known else nan
        against = ok & (side != 0.0) & (not W[_TURN_RATE * LANES + i] * side > 0.0)
        W[_ROW.wrong_way * LANES + i] = 1.0 if against else 0.0


class Work(NamedTuple):
    """Passages to take their falls from, and where they go: from column `first` of out (12, m) on."""

    samples: Samples
    falls: Falls
    terms: Terms
    units: Units
    first: int
    out: Matrix


@subroutine
def in_lanes(work: Work, M: float, W: Vector) -> None:
    """`race_batch`."""
    samples, falls, terms, units, first, out = work
    for begin in range(0, samples.status.size, LANES):
        end = min(begin + LANES, samples.status.size)
        status = samples.status[begin:end]
        for i in range(status.size):
            W[_STATUS * LANES + i] = float(status[i])
        load(samples.eta[begin:end], _ETA, W)
        load(samples.face[begin:end], _FACE, W)
        load(samples.theta_min[begin:end], _THETA_MIN, W)
        load(samples.chi[begin:end], _CHI, W)
        load(samples.psi[begin:end], _PSI, W)
        load(samples.time[begin:end], _TIME, W)
        load(samples.turn_rate[begin:end], _TURN_RATE, W)
        load(samples.energy[begin:end], _ENERGY, W)
        load(samples.error[begin:end], _ERROR, W)
        load(falls.time[begin:end], _FALL_TIME, W)
        load(falls.chi[begin:end], _FALL_CHI, W)
        load(falls.level[begin:end], _LEVEL, W)
        load(falls.error[begin:end], _FALL_ERROR, W)
        measure(W, terms)
        lanes(W, units, M)
        for row in range(len(_ROW)):
            store(W, _FOUND + row, out[row, first + begin : first + end])
        for i in range(status.size):
            status[i] = int(W[_STATUS * LANES + i])


@kernel
def race_batch(
    samples: Samples, falls: Falls, terms: Terms, units: Units, disk: Disk, first: int, out: Matrix
) -> None:
    """Passages without their falls -> out (12, m), as RaceRow, from column `first` on.

    The status of those that miss is marked.
    """
    in_lanes(Work(samples, falls, terms, units, first, out), disk.body.M, np.zeros(_ROWS * LANES))

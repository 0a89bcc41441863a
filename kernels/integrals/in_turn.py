"""Groups of samples that stand in turn: whole rows of them go into lanes and out again.

Most samples of a call are settled by the first grade of rules, in the order in which they were given. One by one,
as `passages` moves those that waited, they would take a tenth of all time where few digits are asked. What a lane
without an answer leaves is overwritten by a finer grade, or by NaN.
"""

from typing import Any, Generic, NamedTuple

from kernels._jit import device, subroutine
from kernels.disk.body import Body
from kernels.disk.falling import potential_at_flat
from kernels.disk.rows import Entry
from kernels.integrals import sums
from kernels.integrals.near_flat import tilt_of
from kernels.integrals.sums import CHECK, LANES
from kernels.integrals.tables import Series
from kernels.types import Longs, Matrix, Vector


class PassageRow(NamedTuple, Generic[Entry]):
    """A passage from its start to the turning point and back, natural units, face +1.

    theta_min: smallest tilt; chi, psi, time: increases; angle_error (rad), time_error (relative): of these.
    way: sigma3/q at the turning point, whose sign is the direction of the race.
    """

    theta_min: Entry
    chi: Entry
    psi: Entry
    time: Entry
    energy: Entry
    angle_error: Entry
    time_error: Entry
    way: Entry


class FallRow(NamedTuple, Generic[Entry]):
    """The fall on F to flat: time, increases of chi and psi, and their error. psi changes sign on face -1."""

    time: Entry
    chi: Entry
    psi: Entry
    error: Entry


# Where the rows of results stand in arrays of them.
_OF_PASSAGE, _OF_FALL = PassageRow(*range(8)), FallRow(*range(4))


@subroutine
def in_turn(group: Longs, n: int) -> bool:
    """Whether a group of n is full, and of samples that follow one another."""
    follow = n == LANES
    for i in range(LANES):
        follow &= group[i] == group[0] + i
    return follow


@device
def stands(W: Vector, k: int) -> bool:
    """Whether what was found in lane k is an answer."""
    return W[CHECK * LANES + k] == 0.0


@subroutine
def load(values: Vector, unit: float, row: int, W: Vector) -> None:
    """Numbers in units into a row. Of a slice all indices count from its start, so this runs in lanes."""
    room = W[row * LANES : (row + 1) * LANES]
    for i in range(LANES):
        room[i] = values[i] / unit


@subroutine
def store(W: Vector, row: int, factor: float, values: Vector) -> None:
    """A row times a factor to where it is wanted."""
    found = W[row * LANES : (row + 1) * LANES]
    for i in range(LANES):
        values[i] = factor * found[i]


@subroutine
def load_crossings(W: Vector, first: int, crossings: Any, b: Body) -> None:
    """The crossings from the first one on."""
    end = first + LANES
    load(crossings.sigma3_bar[first:end], b.r0, sums.X, W)
    load(crossings.eta[first:end], b.I1, sums.Y, W)
    load(crossings.speed[first:end], 1.0, sums.SPEED, W)


@subroutine
def load_departures(W: Vector, first: int, departures: Any, b: Body) -> None:
    """The departures of falls from the first one on."""
    end = first + LANES
    load(departures.sigma3_bar[first:end], b.r0, sums.X, W)
    load(departures.level[first:end], 1.0, sums.LEVEL, W)
    load(departures.moving[first:end], 1.0, sums.MOVING, W)
    load(departures.doubt[first:end], 1.0, sums.START, W)


@subroutine
def tilts_and_energies(W: Vector, low: Series, b: Body, tilts: Vector, energies: Vector) -> None:
    """What lanes hold in other terms."""
    turn = W[sums.H_TURN * LANES : (sums.H_TURN + 1) * LANES]
    x = W[sums.X * LANES : (sums.X + 1) * LANES]
    level = W[sums.LEVEL * LANES : (sums.LEVEL + 1) * LANES]
    for i in range(LANES):
        tilts[i] = tilt_of(turn[i], low)
    for i in range(LANES):
        energies[i] = level[i] + potential_at_flat(x[i], b)


@subroutine
def store_passages(W: Vector, first: int, low: Series, b: Body, out: Matrix) -> None:
    """The passages that were found into the columns from the first one on, as `passages.in_lane` gives them."""
    end, of = first + LANES, _OF_PASSAGE
    tilts_and_energies(W, low, b, out[of.theta_min, first:end], out[of.energy, first:end])
    store(W, sums.CHI, 1.0, out[of.chi, first:end])
    store(W, sums.PSI, 1.0, out[of.psi, first:end])
    store(W, sums.TIME, 1.0, out[of.time, first:end])
    store(W, sums.ANGLE_ERROR, 1.0, out[of.angle_error, first:end])
    store(W, sums.TIME_ERROR, 1.0, out[of.time_error, first:end])
    store(W, sums.WAY, 1.0, out[of.way, first:end])


@subroutine
def fall_errors(W: Vector, errors: Vector) -> None:
    """Of the angles of falls, and of their time, whichever is larger."""
    angle = W[sums.ANGLE_ERROR * LANES : (sums.ANGLE_ERROR + 1) * LANES]
    share = W[sums.TIME_ERROR * LANES : (sums.TIME_ERROR + 1) * LANES]
    time = W[sums.TIME * LANES : (sums.TIME + 1) * LANES]
    for i in range(LANES):
        errors[i] = max(0.5 * angle[i], share[i] * (0.5 * time[i]))


@subroutine
def store_falls(W: Vector, first: int, out: Matrix) -> None:
    """The falls that were found, as `passages.fall_in_lane` gives them."""
    end, of = first + LANES, _OF_FALL
    store(W, sums.TIME, 0.5, out[of.time, first:end])
    store(W, sums.CHI, 0.5, out[of.chi, first:end])
    store(W, sums.PSI, 0.5, out[of.psi, first:end])
    fall_errors(W, out[of.error, first:end])

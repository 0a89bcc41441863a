"""Passages as integrals between turning points: eta is what was given, and no step is taken."""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.arcs import from_place, next_inward, places
from explorer.motion.fall_integrals import OF_FALL, by_tables
from explorer.motion.orbits import ends_of, orbits_of
from explorer.motion.passage_starts import Followed, VerticalStarts
from explorer.motion.plan import Plan
from explorer.motion.starts import ArcStarts, kinetic
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at
from explorer.phase.linear_constants import line_slope, rows_of
from explorer.phase.states import Array


def by_quadrature(disk: Disk, starts: VerticalStarts, how: Plan, edge: float, tables: bool = True) -> Followed:
    """Passages as integrals: by the tables of the body where these serve, else as arcs.

    edge: how far below the vertical they start and stop, in x = ln tan(theta/2). tables: False for arcs alone.
    """
    crossings = starts.natural(disk)
    n, code = starts.status.size, compiled.status.Status
    out, most = np.full((8, n), np.nan), (1.0 - OF_FALL) * how.accuracy
    found, status = compiled.passages.PassageRow(*out), starts.status.copy()

    def left() -> NDArray[np.intp]:
        error = np.maximum(found.angle_error, found.time_error)  # NaN where there is no answer
        return np.flatnonzero((status == code.OK) & ~(error <= most))

    if tables and edge == 0.0:
        by_tables(disk, compiled.passages.passage_batch, crossings, how.accuracy, left, out)
    rows = left()
    if rows.size:
        out[:, rows], status[rows] = as_arcs(disk, rows_of(crossings, rows), edge, most)
    (bar, eta, speed), energy, falls = crossings, found.energy, status == code.FALLS
    if falls.any():  # these were left out
        energy = np.where(falls, energy_at(disk.body, speed, bar, line_slope(disk) * bar, 1.0), energy)
    error = np.fmax(found.angle_error, found.time_error)
    followed = found.theta_min, found.chi, found.psi, found.time, found.turn_rate
    return Followed(bar, eta, speed, starts.face, *followed, energy, error, status)


@np.errstate(over="ignore", invalid="ignore")  # of motions that are no input
def as_arcs(
    disk: Disk, crossings: "compiled.passages.Crossings", edge: float, accuracy: float
) -> tuple[Array, NDArray[np.int8]]:
    """Passages (8, n), rows as PassageRow, and their status: twice the way from the edge to flattest.

    A motion that does not come as far as the edge is BAD_INPUT.
    """
    b, code, place = disk.body, compiled.status.Status, compiled.turning_points.Place
    motions, n = from_vertical(disk, crossings), crossings.speed.size
    X, Y = motions.starts.X, motions.starts.Y
    energy = energy_at(b, crossings.speed, crossings.sigma3_bar, motions.starts.sigma4, 1.0)
    missed = np.zeros(n, np.bool_)
    if edge > 0.0:
        at = places(disk, motions.starts, np.full(n, edge), True)
        missed = ~(next_inward(disk, motions.starts).d > edge)
        motions = motions._replace(starts=from_place(X, Y, place(*at)))
    kept = np.flatnonzero(~missed)
    motions = rows_of(motions, kept)
    ends = ends_of(disk, motions)
    lead, inner = orbits_of(disk, motions, ends, accuracy, False, True, False).lead, ends.inner
    with np.errstate(divide="ignore"):  # of motions that do not come this way
        turn_rate = 0.5 * inner.sigma3 * (1.0 + inner.r * inner.r) / inner.r
        found = compiled.passages.PassageRow(
            theta_min=2.0 * np.arctan(inner.r),
            chi=2.0 * lead.chi,
            psi=2.0 * lead.psi,
            time=2.0 * lead.time,
            energy=energy[kept],
            angle_error=2.0 * lead.angle_error,
            time_error=lead.time_error / lead.time,
            turn_rate=turn_rate,
        )
    out, status = np.full((8, n), np.nan), np.full(n, code.BAD_INPUT, np.int8)
    out[:, kept] = np.stack(found)
    status[kept] = np.where(np.isnan(found.time_error), code.STEP_LIMIT, code.OK)
    status[kept[inner.d == 0.0]] = code.BAD_INPUT
    return out, status


def from_vertical(disk: Disk, crossings: "compiled.passages.Crossings") -> ArcStarts:
    """Motions where they cross the vertical, as arcs need them."""
    b, (bar, eta, speed) = disk.body, crossings
    X, Y = bar / b.r0, eta / b.I1
    one, none = np.ones_like(bar), np.zeros_like(bar)
    starts = compiled.turning_points.Starts(X, Y, kinetic(b, speed), one, none, bar, (X * b.dr0 - Y / b.r0) / b.k)
    return ArcStarts(starts, 2.0 * b.dr0 * bar - Y, none, none)

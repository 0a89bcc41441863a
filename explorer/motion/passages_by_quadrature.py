"""Passages and falls as integrals between turning points: eta is what was given, and no step is taken."""

import numpy as np
from numpy.typing import NDArray

from explorer import compiled
from explorer.motion.plan import Plan
from explorer.motion.vertical import Starts
from explorer.phase.disk import Disk
from explorer.phase.energy import energy_at, potential_at_flat
from explorer.phase.gauss import packed_rules
from explorer.phase.lines import line_slope
from explorer.phase.states import Array

# The least accuracy for which there are rules of few digits; less by a little, since a power of ten may be rounded
# down.
ROUGH = 1e-5 * (1.0 - 1e-9)
# Rows of doubles whose lengths are multiples of this displace one another in the cache.
_ALIKE = 512
# Of speeds at the vertical, natural units. Where a motion at rest there is known to fall, less changes no digit.
_AS_FROM_REST = 1e-60


def rows_apart(rows: int, n: int) -> Array:
    """Room for results: n in each row, or a few more where rows would displace one another in the cache."""
    return np.empty((rows, n + 8 if n % _ALIKE == 0 else n))


def by_quadrature(disk: Disk, starts: Starts, how: Plan, edge: float) -> "compiled.races.Ways":
    """Passages as integrals. edge: the tilt phi (rad) at which they start and stop, 0 for the vertical."""
    crossings = starts.natural(disk)
    n = starts.status.size
    out, status = rows_apart(8, n), starts.status.copy()
    if edge == 0.0:
        by_tables(disk, crossings, how.accuracy, out, status)
    else:
        out.fill(np.nan)
    if unanswered(out, status == compiled.status.Status.OK):
        _by_adaptive_rules(disk, crossings, chord(edge), how.accuracy, out, status)
    return _ways(disk, starts.face, crossings, out[:, :n], status)


def _by_adaptive_rules(
    disk: Disk,
    crossings: "compiled.passages.Crossings",
    h_end: float,
    accuracy: float,
    out: Array,
    status: NDArray[np.int8],
) -> None:
    """Passages that are still NaN in `out`, cut at h_end; the slowest that no rule finds start as from rest."""
    batch, code, rules = compiled.passages.passage_by_rules_batch, compiled.status.Status, packed_rules()
    batch(crossings, h_end, accuracy, rules, disk.natural, out, status)
    slow = (crossings.speed < _AS_FROM_REST) & (crossings.speed > 0.0)
    rows = np.flatnonzero(slow & (status == code.STEP_LIMIT))
    if rows.size:
        rest = compiled.passages.Crossings(crossings.sigma3_bar[rows], crossings.eta[rows], np.zeros(rows.size))
        found, told = np.full((out.shape[0], rows.size), np.nan), np.full(rows.size, code.OK, np.int8)
        batch(rest, h_end, accuracy, rules, disk.natural, found, told)
        kept = told == code.OK
        out[:, rows[kept]], status[rows[kept]] = found[:, kept], code.OK


def by_tables(
    disk: Disk,
    crossings: "compiled.passages.Crossings",
    accuracy: float,
    out: Array,
    status: NDArray[np.int8],
) -> None:
    """Passages from the vertical by the tables of the body, where they serve -> out (8, n or more)."""
    near_flat(disk, crossings, accuracy, out, status)
    if unanswered(out, status == compiled.status.Status.OK):
        compiled.passages.wide_batch(crossings, accuracy, disk.tables, disk.natural, out, status)


def near_flat(
    disk: Disk,
    crossings: "compiled.passages.Crossings",
    accuracy: float,
    out: Array,
    status: NDArray[np.int8],
) -> None:
    """As `by_tables`, only those that come near flat."""
    kernel = compiled.passages.rough_batch if few_digits(accuracy) else compiled.passages.passage_batch
    kernel(crossings, accuracy, disk.tables, disk.natural, out, status)


def table_kernel(accuracy: float) -> str:
    """The name of the kernel that `near_flat` calls at an accuracy: it answers most passages."""
    return "passages.rough_batch" if few_digits(accuracy) else "passages.passage_batch"


def few_digits(accuracy: float) -> bool:
    """Whether short series and few nodes serve."""
    return accuracy >= ROUGH


def unanswered(out: Array, asked: NDArray[np.bool_]) -> bool:
    """Whether one of the samples that are asked for still is NaN in the first row of results."""
    return bool((np.isnan(out[0, : asked.size]) & asked).any())


def by_rules(disk: Disk, starts: Starts, how: Plan) -> "compiled.races.Ways":
    """As `by_quadrature` from the vertical, all by adaptive rules, without tables of the body."""
    crossings = starts.natural(disk)
    out, status = np.full((8, starts.status.size), np.nan), starts.status.copy()
    _by_adaptive_rules(disk, crossings, chord(0.0), how.accuracy, out, status)
    return _ways(disk, starts.face, crossings, out, status)


def _ways(
    disk: Disk, face: Array, crossings: "compiled.passages.Crossings", out: Array, status: NDArray[np.int8]
) -> "compiled.races.Ways":
    """What a kernel wrote: rows of PassageRow."""
    found, (bar, eta, speed) = compiled.quadrature.PassageRow(*out), crossings
    energy, on_f = found.energy, eta == 0.0
    if on_f.any():  # the kernel skips what lies on F
        energy = np.where(on_f, energy_on_f(disk, bar, speed), energy)
    error = np.fmax(found.angle_error, found.time_error)
    followed = found.theta_min, found.chi, found.psi, found.time, found.way
    return compiled.races.Ways(bar, eta, speed, face, *followed, energy, error, status)


def energy_on_f(disk: Disk, sigma3_bar: Array, speed: Array) -> Array:
    """Energy of a start at the vertical on a line l_+-, eqs (2.19), (6.1); natural units."""
    energy: Array = energy_at(disk.body, speed, sigma3_bar, line_slope(disk) * sigma3_bar, 1.0)
    return energy


def chord(phi: float) -> float:
    """2 sin(theta/2) at the tilt phi (rad), as the kernels measure tilt; at the vertical exactly theirs."""
    return 2.0 * float(np.sin(0.5 * (0.5 * np.pi - phi))) if phi > 0.0 else float(compiled.point.VERTICAL)


def fall_from_vertical(
    disk: Disk, sigma3_bar: Array, energy: Array, edge: float = 0.0, accuracy: float = 0.0
) -> "compiled.quadrature.FallRow[Array]":
    """The fall on F with these constants from the vertical to flat, face +1, natural units; as `falls_of`."""
    return falls_of(disk, departures_of_energy(disk, sigma3_bar, energy), edge, accuracy)


def falls_of(
    disk: Disk, departures: "compiled.passages.Departures", edge: float = 0.0, accuracy: float = 0.0
) -> "compiled.quadrature.FallRow[Array]":
    """The falls on F that leave the vertical so, to flat, face +1, natural units.

    edge: phi (rad) at which they begin instead. accuracy: of twice the angle, and of the time; 0: the best there
    is.
    """
    n = departures.level.size
    out = rows_apart(4, n)
    if edge == 0.0:
        compiled.passages.fall_batch(departures, accuracy, disk.tables, disk.natural, out)
    else:
        out.fill(np.nan)
    if unanswered(out, np.isfinite(departures.level)):
        compiled.passages.fall_by_rules_batch(departures, chord(edge), packed_rules(), disk.natural, out)
    return compiled.quadrature.FallRow(*out[:, :n])


def vertical_above_flat(disk: Disk, sigma3_bar: Array) -> Array:
    """V - V_0 at the vertical on F, eq. (3.8), natural units."""
    none = np.zeros(sigma3_bar.size)
    return departures_of_moving(disk, sigma3_bar, none, none, none).level


@np.errstate(over="ignore", invalid="ignore")  # of motions that are no input
def departures_of_energy(disk: Disk, sigma3_bar: Array, energy: Array) -> "compiled.passages.Departures":
    """Falls with these energies, as far as a difference of energies tells their start; natural units."""
    bar, given = np.ascontiguousarray(sigma3_bar), np.ascontiguousarray(energy)
    at_flat = potential_at_flat(disk.body, bar)
    level = given - at_flat
    moving = level - vertical_above_flat(disk, bar)
    return compiled.passages.Departures(bar, level, moving, compiled.passages.ROUNDING * (abs(given) + at_flat))


def departures_beside(disk: Disk, crossings: "compiled.passages.Crossings") -> "compiled.passages.Departures":
    """Falls on F with the sigma3_bar and energies of motions beside it that cross the vertical; natural units."""
    with np.errstate(over="ignore", invalid="ignore"):  # of motions that are no input
        given = 0.5 * disk.body.M * crossings.speed**2
    return departures_of_moving(disk, crossings.sigma3_bar, crossings.eta, given, given)


def departures_of_moving(
    disk: Disk, sigma3_bar: Array, eta: Array, given: Array, size: Array
) -> "compiled.passages.Departures":
    """The same from E - V of motions beside F at the vertical, and the size of what that is a difference of."""
    motions = compiled.passages.Beside(*map(np.ascontiguousarray, (sigma3_bar, eta, given, size)))
    out = rows_apart(3, sigma3_bar.size)
    # The polynomial of (r'(S) - 1)/S at S = 1.
    compiled.passages.departure_batch(motions, disk.natural.series[4].sum(), disk.natural, out)
    return compiled.passages.Departures(motions.sigma3_bar, *out[:, : sigma3_bar.size])

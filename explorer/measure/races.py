"""Race angles counted for pictures: by decade of |eta_hat| around their limit, and against their law.

Beside F a race angle is sgn(eta) kappa pi + K eta (ln(1/|eta|) - c) + ... The constant c depends on the motion
and, for small eta, no longer on eta.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.errors import whole
from explorer.measure.tallies import PER_DECADE, LogHistogram, LogRow
from explorer.phase.disk import Disk, require_disk
from explorer.phase.states import Array, columns_of

SIDES = {"plus": 1, "minus": -1}
BINS = 40  # a decade of the deviation, in a summary: a picture joins some of them
_JOINED = PER_DECADE // BINS
# Of race angles between -1.5 and 1.5 kappa pi: 0 and +-kappa pi are middles of bins, also of five joined ones.
ANGLE_BINS, _REACH = 585, 1.5
PER_STEP = 3  # steps of |eta_hat| a decade, at which the law is looked at
_SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)
_MOST_BINS = 1_000_000


def angle_edges(limit: float, bins: int = ANGLE_BINS) -> Array:
    """Edges of the bins of race angles. limit: kappa pi."""
    return np.linspace(-_REACH * limit, _REACH * limit, bins + 1)


@dataclass
class RaceRidges:
    """Deviations of race angles from sgn(eta) kappa pi, counted by decade of |eta_hat| and side of F.

    Attributes
    ----------
    limit : float
        kappa pi (rad).
    ridges : dict
        By the exponent of the decade and the side, +-1: `LogHistogram` of race angle - side kappa pi (rad).
    angles : dict
        By the side: race angles in the bins of `edges`, and how many lie outside them.
    edges : array
        Of the bins of the wide view (rad).

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.measure.races import race_ridges
    >>> disk, eta_hat = ex.Disk.uniform(), [1e-3, -2e-3, 1e-5]
    >>> found = race_ridges(disk, eta_hat, ex.passages(disk, 1.0, eta_hat, 1.0).race_angle)
    >>> sorted(found.ridges)
    [-5, -3]
    """

    limit: float
    ridges: dict[int, dict[int, LogHistogram]] = field(default_factory=dict)
    angles: dict[int, tuple[NDArray[np.int64], int]] = field(default_factory=dict)
    edges: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def of_summary(cls, summary: Mapping[str, Any]) -> RaceRidges:
        """From the summary of a run of scene race-angles."""
        histogram = summary["histogram"]
        angles = {
            side: (np.array(histogram[f"counts_{name}"]), int(histogram[f"outside_{name}"]))
            for name, side in SIDES.items()
        }
        ridges = {
            int(row["decade"]): {side: _unpacked(row[name]) for name, side in SIDES.items()}
            for row in summary["ridges"]
        }
        return cls(float(summary["limit"]), ridges, angles, np.array(histogram["edges"]))


def race_ridges(disk: Disk, eta_hat: ArrayLike, race_angle: ArrayLike, bins: int = ANGLE_BINS) -> RaceRidges:
    """Count race angles of one's own, for picture race-histogram.

    Parameters
    ----------
    disk : Disk
    eta_hat : array_like
        Distance from F with its sign, units of the disk.
    race_angle : array_like
        Rad; of `passages`, `bounces` or one's own. What is not finite is left out.
    bins : int
        Of the wide view, between -1.5 and 1.5 kappa pi.

    Returns
    -------
    RaceRidges

    Raises
    ------
    InputError
        Where the shapes do not go together.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.measure.races import race_ridges
    >>> disk = ex.Disk.hoop()
    >>> found = race_ridges(disk, [1e-4, -1e-4], ex.passages(disk, 1.0, [1e-4, -1e-4], 1.0).race_angle)
    >>> found.ridges[-4][1].total, found.ridges[-4][-1].total
    (1, 1)
    """
    require_disk(disk)
    eta, race = columns_of(eta_hat=eta_hat, race_angle=race_angle)
    bins = whole("bins", bins, 1, _MOST_BINS)
    limit = disk.race_limit
    deviations = LogHistogram()
    deviations.count(race - np.sign(eta) * limit, decades_and_sides(eta))
    edges = angle_edges(limit, bins)
    angles = {}
    for side in (1, -1):
        chosen = race[(side * eta > 0.0) & np.isfinite(race)]
        counts = np.histogram(chosen, edges)[0]
        angles[side] = (counts, int(chosen.size - counts.sum()))
    return RaceRidges(limit, by_decade(deviations), angles, edges)


def decades_and_sides(eta_hat: Array) -> Array:
    """2 n + 1 for each positive number with 10^n <= |eta_hat| < 10^(n + 1), 2 n for the others; -inf of 0."""
    with np.errstate(divide="ignore"):
        groups = np.floor(np.log10(abs(eta_hat)) + 1e-12)
    groups *= 2.0
    groups += eta_hat > 0.0
    return np.asarray(groups)


def by_decade(deviations: LogHistogram) -> dict[int, dict[int, LogHistogram]]:
    """By decade and by side what was counted by `decades_and_sides`; decades in which there is something."""
    decades = range(deviations.lowest // 2, deviations.groups.stop // 2 + 1)
    found = {n: {side: deviations.part([2 * n + (side > 0)]) for side in SIDES.values()} for n in decades}
    return {n: sides for n, sides in found.items() if any(counts.total for counts in sides.values())}


_ROUNDING = 1e-12  # rad; a deviation is known to some 1e-15, and its law to a percent from here on


def count_law(
    tally: LogHistogram, disk: Disk, eta_hat: Array, race: Array, speed: Array, error: Array | None = None
) -> None:
    """Count c of the law of passages by step of |eta| (natural units), of which there are PER_STEP a decade.

    Nothing is counted where rounding is felt in the deviation, or nearer to F than where errors move c by more
    than 1, in all but a hundredth of the passages: a choice by motions would choose c. speed: of impact, units of
    the disk. error: of the race angles (rad), as estimated; None of none.
    """
    unit, side = disk.rate_unit, np.sign(eta_hat)
    eta = abs(disk.eta_hat_to_eta(eta_hat / unit))
    with np.errstate(all="ignore"):  # a speed of a user's own may be anything
        scale = 2.0 * eta / (disk.body.I1 * disk.body.M * (speed / unit) ** 3)
        constant = np.log(1.0 / eta) - side * (race - side * disk.race_limit) / scale
        constant[~(np.isfinite(constant) & (scale > _ROUNDING))] = np.nan
        step = np.floor(np.log10(eta) * PER_STEP + 1e-9)
        doubt = None if error is None else (error * eta / scale)[np.isfinite(constant)]
    if doubt is not None and doubt.size:
        largest = 99 * doubt.size // 100
        step[~(eta > np.partition(doubt, largest)[largest])] = np.nan
    tally.count(constant, step)


def law_rows(disk: Disk, found: LogHistogram) -> list[dict[str, Any]]:
    """Rows of a summary: |eta| in the middle of each step (eta natural, eta_hat not), and quantiles of c there."""
    steps = ((10.0 ** ((n + 0.5) / PER_STEP), found.part([n])) for n in found.groups)
    return [
        {
            "eta": eta,
            "eta_hat": float(disk.eta_to_eta_hat(eta)) * disk.rate_unit,
            "passages": constants.total,
            "constant": {f"{share:g}": constants.quantile(share) for share in _SHARES},
        }
        for eta, constants in steps
        if constants.total
    ]


def race_law(
    disk: Disk, eta_hat: ArrayLike, race_angle: ArrayLike, impact_speed: ArrayLike
) -> list[dict[str, Any]]:
    """The constant of the law by |eta|, of race angles of one's own, as picture race-deviation shows it.

    Parameters
    ----------
    disk : Disk
    eta_hat, impact_speed : array_like
        Distance from F with its sign, and the speed A at impact, units of the disk.
    race_angle : array_like
        Rad.

    Returns
    -------
    list of dict
        By increasing |eta|: eta (natural units), eta_hat, passages, and quantiles of the constant.

    Raises
    ------
    InputError
        Where the shapes do not go together.

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> found = ex.passages(disk, 1.0, 1e-6, 1.0, accuracy=1e-9)
    >>> row, = ex.race_law(disk, 1e-6, found.race_angle, found.impact_speed)
    >>> round(row["constant"]["0.5"], 1)
    6.0
    """
    require_disk(disk)
    eta, race, speed = columns_of(eta_hat=eta_hat, race_angle=race_angle, impact_speed=impact_speed)
    found = LogHistogram()
    count_law(found, disk, eta, race, speed)
    return law_rows(disk, found)


def ridge_rows(ridges: Mapping[int, Mapping[int, LogHistogram]]) -> list[dict[str, Any]]:
    """Rows of a summary: the deviations of each decade, in BINS bins a decade of their size."""
    return [
        {"decade": n, **{name: _packed(sides[side]) for name, side in SIDES.items()}}
        for n, sides in sorted(ridges.items())
    ]


def binned(counts: LogRow, edges: Array) -> Array:
    """Counts of magnitudes between edges (rad), each bin of `counts` shared out evenly on the logarithmic axis."""
    if not counts.counts.size:
        return np.zeros(edges.size - 1)
    ends = (counts.first + np.arange(counts.counts.size + 1)) / PER_DECADE
    below = np.concatenate([[0.0], np.cumsum(counts.counts)])
    shared: Array = np.diff(np.interp(np.log10(edges), ends, below))
    return shared


def _packed(deviations: LogHistogram) -> dict[str, Any]:
    return {"below": _coarse(deviations.row(above=False)), "above": _coarse(deviations.row(below=False))}


def _coarse(counts: LogRow) -> dict[str, Any]:
    """Counts with PER_DECADE / BINS of their bins joined."""
    filled = np.flatnonzero(counts.counts)
    bins, where = np.unique((filled + counts.first) // _JOINED, return_inverse=True)
    sums = np.bincount(where, counts.counts[filled], bins.size).astype(int)
    ends = [counts.smallest, counts.largest] if counts.total else []
    return {"bins": bins.tolist(), "counts": sums.tolist(), "zeros": counts.zeros, "range": ends}


def _unpacked(state: Mapping[str, Any]) -> LogHistogram:
    """What `_packed` wrote, each of its bins spread over those that were joined."""
    halves = state["below"], state["above"]
    used = [place for half in halves for place in half["bins"]] or [0]
    first, last = min(used), max(used)
    counts = np.zeros((2, last - first + 1, _JOINED), np.int64)
    for row, half in enumerate(halves):
        joined = np.array(half["counts"], np.int64)[:, None]
        # Whole numbers that add up to what they came from
        counts[row, np.array(half["bins"], int) - first] = (joined + np.arange(_JOINED)) // _JOINED
    zeros, ends = [half["zeros"] for half in halves], [half["range"] or [np.inf, -np.inf] for half in halves]
    return LogHistogram(0, first * _JOINED, counts.reshape(2, -1), np.array(zeros), np.array(ends))

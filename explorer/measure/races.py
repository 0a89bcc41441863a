"""Race angles counted for pictures: by decade of |eta_hat| around their limit, and against their law.

Beside F a race angle is sgn(eta) kappa pi + K eta (ln(1/|eta|) - c) + ... The constant c depends on the motion
and, for small eta, no longer on eta.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer.measure.tallies import PER_DECADE, LogHistogram, LogRow, histograms
from explorer.phase.arguments import read_columns
from explorer.phase.disk import Disk, require_axial_inertia, require_disk
from explorer.phase.energy import eta_hat_to_eta, eta_to_eta_hat
from explorer.phase.states import Array

SIDES = {"plus": 1, "minus": -1}
BINS = 40  # a decade of the deviation, in a summary: a picture joins some of them
# Of race angles between -1.5 and 1.5 kappa pi: 0 and +-kappa pi are middles of bins, also of five joined ones.
ANGLE_BINS, _REACH = 585, 1.5
PER_STEP = 3  # steps of |eta_hat| a decade, at which the law is looked at
_SHARES = (0.05, 0.25, 0.5, 0.75, 0.95)


def angle_edges(limit: float) -> Array:
    """Edges of the bins of race angles. limit: kappa pi."""
    return np.linspace(-_REACH * limit, _REACH * limit, ANGLE_BINS + 1)


def race_ridges(disk: Disk, eta_hat: ArrayLike, race_angle: ArrayLike) -> dict[str, Any]:
    """Count race angles of one's own, for picture race-histogram.

    Parameters
    ----------
    disk : Disk
    eta_hat : array_like
        Distance from F with its sign, units of the disk.
    race_angle : array_like
        Rad; of `passages`, `bounces` or one's own. What is not finite is left out.

    Returns
    -------
    dict
        limit, histogram and ridges, as in the summary of a run of scene race-angles.

    Raises
    ------
    InputError
        If the shapes do not fit together.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.measure.races import race_ridges
    >>> disk = ex.Disk.hoop()
    >>> found = race_ridges(disk, [1e-4, -1e-4], ex.passages(disk, 1.0, [1e-4, -1e-4], 1.0).race_angle)
    >>> [row["decade"] for row in found["ridges"]]
    [-4]
    """
    require_disk(disk)
    (eta, race), _ = read_columns(eta_hat=eta_hat, race_angle=race_angle)
    limit, deviations = disk.race_limit, LogHistogram()
    deviations.count(race - np.sign(eta) * limit, decades_and_sides(eta))
    counts = dict(zip(SIDES, count_angles(limit, eta, race), strict=True))
    return {"limit": limit, "histogram": histogram(limit, counts), "ridges": ridge_rows(by_decade(deviations))}


def count_angles(limit: float, eta_hat: Array, race: Array) -> NDArray[np.int32]:
    """Race angles in the bins of `angle_edges`, and last what lies outside them; rows in the order of SIDES."""
    side = np.where(eta_hat > 0.0, 0, np.where(eta_hat < 0.0, 1, -1))  # a motion on F has none
    return histograms(race, side, angle_edges(limit), len(SIDES))


def histogram(limit: float, counts: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """The entry of a summary, from counts by the names of SIDES."""
    entry: dict[str, Any] = {"edges": angle_edges(limit).tolist()}
    for name in SIDES:
        *entry[f"counts_{name}"], entry[f"outside_{name}"] = counts[name].tolist()
    return entry


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
    eta = abs(eta_hat_to_eta(disk.body, eta_hat / unit))
    with np.errstate(all="ignore"):  # a speed of a user's own may be anything
        scale = 2.0 * eta / (disk.body.I1 * disk.body.M * (speed / unit) ** 3)
        constant = np.log(1.0 / eta) - side * (race - side * disk.race_limit) / scale
        constant[~(np.isfinite(constant) & (scale > _ROUNDING))] = np.nan
        step = np.floor(np.log10(eta) * PER_STEP + 1e-9)
        bound = None if error is None else (error * eta / scale)[np.isfinite(constant)]
    if bound is not None and bound.size:
        largest = 99 * bound.size // 100
        step[~(eta > np.partition(bound, largest)[largest])] = np.nan
    tally.count(constant, step)


def law_rows(disk: Disk, found: LogHistogram) -> list[dict[str, Any]]:
    """Rows of a summary: |eta| in the middle of each step (eta natural, eta_hat not), and quantiles of c there."""
    steps = ((10.0 ** ((n + 0.5) / PER_STEP), found.part([n])) for n in found.groups)
    return [
        {
            "eta": eta,
            "eta_hat": float(eta_to_eta_hat(disk.body, eta)) * disk.rate_unit,
            "passages": constants.total,
            "constant": {f"{share:g}": constants.quantile(share) for share in _SHARES},
        }
        for eta, constants in steps
        if constants.total
    ]


def race_law(
    disk: Disk, eta_hat: ArrayLike, race_angle: ArrayLike, impact_speed: ArrayLike
) -> list[dict[str, Any]]:
    """Estimate, from your own race angles, the number c in the law of races near F.

    The result has quantiles of c at each |eta|; the picture race-deviation draws it. By the law, near F a race
    angle is side * (kappa pi + K |eta| (ln(1/|eta|) - c)), natural units. K = 2 m g r/(I1 M A^3), with M = I1 + m
    r^2 and the impact speed A; c differs from passage to passage.

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
        By increasing |eta|: eta (natural units), eta_hat, passages, and quantiles of c.

    Raises
    ------
    InputError
        If the shapes do not fit together, or if the disk has I3 = 0.

    Examples
    --------
    >>> import explorer as ex
    >>> disk = ex.Disk.uniform()
    >>> found = ex.passages(disk, 1.0, 1e-6, 1.0, accuracy=1e-9)
    >>> row, = ex.race_law(disk, 1e-6, found.race_angle, found.impact_speed)
    >>> round(row["constant"]["0.5"], 1)
    6.0
    """
    require_axial_inertia(disk)
    (eta, race, speed), _ = read_columns(eta_hat=eta_hat, race_angle=race_angle, impact_speed=impact_speed)
    found = LogHistogram()
    count_law(found, disk, eta, race, speed)
    return law_rows(disk, found)


def ridge_rows(ridges: Mapping[int, Mapping[int, LogHistogram]]) -> list[dict[str, Any]]:
    """Rows of a summary: the deviations of each decade by side and sign, in BINS bins a decade of their size."""
    return [
        {
            "decade": n,
            **{
                name: {
                    "below": _coarse(sides[side].row(above=False)),
                    "above": _coarse(sides[side].row(below=False)),
                }
                for name, side in SIDES.items()
            },
        }
        for n, sides in sorted(ridges.items())
    ]


def _coarse(counts: LogRow) -> dict[str, Any]:
    """Counts with PER_DECADE / BINS of their bins joined."""
    filled = np.flatnonzero(counts.counts)
    bins, where = np.unique((filled + counts.first) // (PER_DECADE // BINS), return_inverse=True)
    sums = np.bincount(where, counts.counts[filled], bins.size).astype(int)
    ends = [counts.smallest, counts.largest] if counts.total else []
    return {"bins": bins.tolist(), "counts": sums.tolist(), "zeros": counts.zeros, "range": ends}


def binned(part: Mapping[str, Any], edges: Array) -> Array:
    """Sizes of a part of a ridge between edges (rad), each bin shared out evenly on the logarithmic axis."""
    if not part["bins"]:
        return np.zeros(edges.size - 1)
    ends = np.add.outer(part["bins"], [0, 1]).ravel() / BINS
    below = np.repeat([0, *np.cumsum(part["counts"])], 2)[1:-1]
    shared: Array = np.diff(np.interp(np.log10(edges), ends, below))
    return shared

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

from explorer import compiled
from explorer.errors import whole
from explorer.measure.log_counts import PER_DECADE, LogCounts, SignedLogCounts
from explorer.measure.statistics import upper_quantile
from explorer.phase.disk import Disk, require_disk
from explorer.phase.states import Array, columns_of

SIDES = {"plus": 1, "minus": -1}
BINS = 40  # a decade of the deviation, in a summary: a picture joins some of them
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
        By the exponent of the decade and the side, +-1: `SignedLogCounts` of race angle - side kappa pi (rad).
    angles : dict
        By the side: race angles in the bins of `edges`, and how many lie outside them.
    edges : array
        Of the bins of the wide view (rad).

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.portrait import race_ridges
    >>> disk, eta_hat = ex.Disk.uniform(), [1e-3, -2e-3, 1e-5]
    >>> found = race_ridges(disk, eta_hat, ex.passages(disk, 1.0, eta_hat, 1.0).race_angle)
    >>> sorted(found.ridges)
    [-5, -3]
    """

    limit: float
    ridges: dict[int, dict[int, SignedLogCounts]] = field(default_factory=dict)
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
    """Count race angles of one's own for `plot.race_histogram`.

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
    >>> from explorer.portrait import race_ridges
    >>> disk = ex.Disk.hoop()
    >>> found = race_ridges(disk, [1e-4, -1e-4], ex.passages(disk, 1.0, [1e-4, -1e-4], 1.0).race_angle)
    >>> found.ridges[-4][1].total, found.ridges[-4][-1].total
    (1, 1)
    """
    require_disk(disk)
    eta, race = columns_of(eta_hat=eta_hat, race_angle=race_angle)
    bins = whole("bins", bins, 1, _MOST_BINS)
    limit = disk.race_limit
    deviation = race - np.sign(eta) * limit
    edges = angle_edges(limit, bins)
    angles = {}
    for side in (1, -1):
        chosen = race[(side * eta > 0.0) & np.isfinite(race)]
        counts = np.histogram(chosen, edges)[0]
        angles[side] = (counts, int(chosen.size - counts.sum()))
    return RaceRidges(limit, by_decade(eta, deviation), angles, edges)


def decades_of(eta_hat: Array) -> Array:
    """The decade of each |eta_hat|: n where 10^n <= |eta_hat| < 10^(n + 1); -inf of 0."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.floor(np.log10(abs(eta_hat)) + 1e-12))


def by_decade(eta_hat: Array, deviation: Array) -> dict[int, dict[int, SignedLogCounts]]:
    """Deviations counted by decade and by side; zeros and what is not finite belong nowhere."""
    return sides_of_decades(SignedLogCounts.by_group(deviation, decades_and_sides(eta_hat)))


def decades_and_sides(eta_hat: Array) -> Array:
    """A number for each decade and side: 2 n + 1 of what is positive in decade n, 2 n of the others."""
    groups = decades_of(eta_hat)
    groups *= 2.0
    groups += eta_hat > 0.0
    return groups


def sides_of_decades(found: Mapping[int, SignedLogCounts]) -> dict[int, dict[int, SignedLogCounts]]:
    """By decade and by side what was counted by `decades_and_sides`; decades in which there is something."""
    sides = {n: {side: found.get(2 * n + (side > 0)) for side in (1, -1)} for n in {n // 2 for n in found}}
    return {
        n: {side: counts or SignedLogCounts() for side, counts in both.items()}
        for n, both in sorted(sides.items())
        if any(counts and counts.total for counts in both.values())
    }


class LawCounts:
    """c of the law of passages that come block by block, counted by step of |eta| (natural units).

    There are PER_STEP steps a decade. Nothing is counted where rounding is felt in the deviation, or nearer to F
    than where errors move c by more than 1, in all but a hundredth of the passages: a choice by motions would
    choose c. most: how many passages may come.
    """

    def __init__(self, disk: Disk, most: int) -> None:
        self._disk, self._judged = disk, True
        self._eta, self._constant, self._doubt = np.empty((3, most))
        self._count, self._known = 0, np.zeros(1, np.int64)

    def add(self, eta_hat: Array, race_angle: Array, speed: Array, error: Array | None = None) -> None:
        """Find the constants of more passages.

        speed: of impact, units of the disk. error: of the race angles (rad), as estimated; None of none.
        """
        law, unit, disk = compiled.race_law, self._disk.rate_unit, self._disk
        rows = slice(self._count, self._count + eta_hat.size)
        eta = np.abs(disk.eta_hat_to_eta(eta_hat / unit), out=self._eta[rows])
        side, race, own = map(np.ascontiguousarray, (eta_hat, race_angle, eta if error is None else error))
        with np.errstate(all="ignore"):  # a speed of a user's own may be anything
            races = law.Races(side, race, own, eta, (speed / unit) ** 3, np.log(1.0 / eta))
        limit, body = disk.race_limit, disk.body
        law.constant_batch(races, limit, body, self._constant[rows], self._doubt, self._known)
        self._count, self._judged = rows.stop, self._judged and error is not None

    def counts(self) -> dict[int, SignedLogCounts]:
        """What was counted, by step."""
        eta, known = self._eta[: self._count], int(self._known[0])
        with np.errstate(all="ignore"):
            step = np.log10(eta)
        step *= PER_STEP
        step += 1e-9
        np.floor(step, out=step)
        if self._judged and known:
            step[~(eta > upper_quantile(self._doubt[:known], 0.99))] = np.nan
        found = SignedLogCounts.by_group(self._constant[: self._count], step)
        return {n: counts for n, counts in found.items() if counts.total}


def law_rows(disk: Disk, found: Mapping[int, SignedLogCounts]) -> list[dict[str, Any]]:
    """Rows of a summary: |eta| in the middle of each step (eta natural, eta_hat not), and quantiles of c there."""
    return [
        {
            "eta": eta,
            "eta_hat": float(disk.eta_to_eta_hat(eta)) * disk.rate_unit,
            "passages": found[n].total,
            "constant": {f"{share:g}": found[n].quantile(share) for share in _SHARES},
        }
        for n, eta in ((n, 10.0 ** ((n + 0.5) / PER_STEP)) for n in sorted(found))
        if found[n].total
    ]


def race_law(
    disk: Disk, eta_hat: ArrayLike, race_angle: ArrayLike, impact_speed: ArrayLike
) -> list[dict[str, Any]]:
    """The constant of the law by |eta|, of race angles of one's own, for `plot.race_deviation`.

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
    >>> from explorer.portrait import race_law
    >>> disk = ex.Disk.uniform()
    >>> found = ex.passages(disk, 1.0, 1e-6, 1.0, accuracy=1e-9)
    >>> row, = race_law(disk, 1e-6, found.race_angle, found.impact_speed)
    >>> round(row["constant"]["0.5"], 1)
    6.0
    """
    require_disk(disk)
    eta, race, speed = columns_of(eta_hat=eta_hat, race_angle=race_angle, impact_speed=impact_speed)
    counts = LawCounts(disk, eta.size)
    counts.add(eta, race, speed)
    return law_rows(disk, counts.counts())


def ridge_rows(ridges: Mapping[int, Mapping[int, SignedLogCounts]]) -> list[dict[str, Any]]:
    """Rows of a summary: the deviations of each decade, in BINS bins a decade of their size."""
    return [
        {"decade": n, **{name: _packed(sides[side]) for name, side in SIDES.items()}}
        for n, sides in sorted(ridges.items())
    ]


def binned(counts: LogCounts, edges: Array) -> Array:
    """Counts of magnitudes between edges (rad), each bin of `counts` shared out evenly on the logarithmic axis."""
    if not counts.counts.size:
        return np.zeros(edges.size - 1)
    ends = (counts.first + np.arange(counts.counts.size + 1)) / PER_DECADE
    below = np.concatenate([[0.0], np.cumsum(counts.counts)])
    shared: Array = np.diff(np.interp(np.log10(edges), ends, below))
    return shared


def _packed(signed: SignedLogCounts) -> dict[str, Any]:
    return {name: _coarse(getattr(signed, name)) for name in ("below", "above")}


def _coarse(counts: LogCounts) -> dict[str, Any]:
    """The state of LogCounts with PER_DECADE / BINS of its bins joined."""
    joined = PER_DECADE // BINS
    filled = np.flatnonzero(counts.counts)
    bins, where = np.unique((filled + counts.first) // joined, return_inverse=True)
    sums = np.bincount(where, counts.counts[filled], bins.size).astype(int)
    ends = [counts.smallest, counts.largest] if counts.total else []
    return {"bins": bins.tolist(), "counts": sums.tolist(), "zeros": counts.zeros, "range": ends}


def _unpacked(state: Mapping[str, Any]) -> SignedLogCounts:
    made = SignedLogCounts()
    made.below, made.above = (_fine(state[name]) for name in ("below", "above"))
    return made


def _fine(state: Mapping[str, Any]) -> LogCounts:
    """Counts of the first of PER_DECADE / BINS bins for each that `_coarse` made, spread over all of them."""
    joined = PER_DECADE // BINS
    bins = np.array(state["bins"], np.int64)
    fine = (joined * bins[:, None] + np.arange(joined)).ravel()
    counts = np.array(state["counts"], np.int64)
    # Whole numbers that add up to what they came from
    parts = (counts[:, None] + np.arange(joined)) // joined
    return LogCounts({**state, "bins": fine.tolist(), "counts": parts.ravel().tolist()})

"""How probable an event is for initial states with a distribution: by plain draws, or by draws near F."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from explorer import compiled
from explorer.errors import InputError, RunError, flag, number, shown, whole
from explorer.measure import statistics
from explorer.measure.distributions import Distribution
from explorer.measure.importance_sampling import FEWEST, LARGEST_DELTA, LEAST, NearFallingSet
from explorer.measure.laws import Law
from explorer.measure.sampling import Stream, stream_of
from explorer.measure.tubes import may_come
from explorer.motion.bounces import MOST, Bounces, bounces
from explorer.motion.threads import blocks
from explorer.motion.turning_points import smallest_tilts
from explorer.phase.arguments import returned_numbers
from explorer.phase.disk import Disk, require_axial_inertia
from explorer.phase.states import States

Event = tuple[str, float] | str | Callable[[Bounces], ArrayLike]
_SHARE = 8  # plain draws over weighted ones at each face

_NO_LAW = (
    "no law C delta down to delta = 1e-12: the falling set is hardly met, or states so near flat from the "
    "beginning decide"
)


@dataclass(frozen=True, repr=False)
class Probability:
    """The probability of an event with its 95 % interval: what `probability` returns.

    Attributes
    ----------
    estimate : float
        The probability.
    interval : (float, float)
        The probability lies between these two numbers with a confidence of 95 %. If the event happens in none of
        the plain draws, the lower end is 0, and the upper end is a one-sided bound (Clopper-Pearson).
    effective_samples : float
        Number of hits of equal weight that would give the same precision; for plain draws, the number of hits.
    law : Law or None
        For the event theta_min < delta: the `constant` C of the law P = C delta, its standard `error`, and
        `holds_below`, the delta below which the law holds. None for other events.
    method : str
        "plain" or "importance".
    note : str
        Anything else worth knowing, in words; mostly empty.
    asked : str
        The event and the distribution.

    Examples
    --------
    >>> import explorer as ex
    >>> found = ex.probability(ex.Disk.uniform(), ("theta_min", 1e-9), phi=0, phidot=(-2, 2), sigma3=(-2, 2),
    ...                        sigma4=(-2, 2), count=2)
    >>> found.method, bool(found.effective_samples > 1000), f"{found.estimate:.1e}"
    ('importance', True, '1.5e-09')
    """

    estimate: float
    interval: tuple[float, float]
    effective_samples: float
    law: Law | None
    method: str
    note: str
    asked: str

    def __repr__(self) -> str:
        low, high = self.interval
        sure = f"95 % interval {low:.4g} to {high:.4g}"
        if not self.effective_samples:
            sure = f"no hit: with a confidence of 95 % it is at most {high:.4g}"
        how = {"plain": "plain draws", "importance": "importance sampling"}[self.method]
        lines = [
            f"Probability of {self.asked}",
            f"  estimate: {self.estimate:.4g} ({sure})",
            f"  effective samples: {self.effective_samples:,.0f}, by {how}",
        ]
        if self.law is not None:
            constant, error, below = self.law
            where = f"for delta up to {below:.0g} rad within 5 %"
            lines.append(f"  law: C delta with C = {constant:.4g} +- {error:.1g} holds {where}")
        return "\n".join([*lines, *([f"  note: {self.note}"] if self.note else [])])


def probability(
    disk: Disk,
    event: Event = ("theta_min", 1e-3),
    *,
    count: int = 1,
    degrees: bool = False,
    accuracy: float = 1e-6,
    samples: int = 1_000_000,
    rng: Any = 0,
    **coordinates: Any,
) -> Probability:
    """The probability of an event for randomly distributed initial states, with its uncertainty.

    Parameters
    ----------
    disk : Disk
        Needs I3 > 0.
    event : (str, float) or callable
        ("theta_min", delta): the tilt becomes smaller than delta (rad). Or a function of `Bounces` that returns a
        bool for each state, or for each state and bounce; then a state counts if this is True for at least one of
        its bounces. For motions that fall, theta_min is 0, and the other columns are NaN or 0.
    count : int
        The event counts if it happens within this number of bounces. The tilt is periodic: bounces of one state
        have at most two theta_min, one on each face, so two bounces give all values of theta_min.
    degrees : bool
        Whether angles and rates are in degrees instead of rad; theta_min never is.
    accuracy : float
        As for `bounces`; for theta_min it is relative. 1e-13 to 0.1.
    samples : int
        Number of plain draws, from the whole distribution. Close to the falling set an eighth as many are drawn
        for each face, but at least 4,096.
    rng : int, SeedSequence or Generator
        Where random numbers come from; the same int gives the same numbers.
    **coordinates
        For each coordinate a frozen distribution of scipy.stats, a range (low, high) or a number; the coordinates
        are independent. They are tilt, precession and spin, with tilt_rate (0 if left out) and face (+1); or phi,
        phidot, sigma3, sigma4; or constants of motion, as `coordinates_to_states` takes them; in the units of the
        disk. Text such as "norm:20:2" stands for scipy.stats.norm(20, 2).

    Returns
    -------
    Probability
        estimate, interval, effective_samples, law, method.

    Raises
    ------
    InputError
        If the names do not determine a state, or if an argument cannot be used.
    RunError
        If hardly any draw describes a state: one with a negative tilt, for example, does not.

    Notes
    -----
    Draws that are not states, such as a negative tilt, are left out of the distribution. If plain draws see at
    least 100 hits, they are the answer, with the exact interval of Clopper and Pearson. Otherwise the probability
    of theta_min < delta is estimated from weighted draws near the falling set, on both faces; a state that is
    beside both lines counts once. For small delta the probability tends to C delta; with count = 2 this C is that
    of `falling_constant`. The law does not hold if many of the initial states are already as near flat as delta.

    Examples
    --------
    A coin of which tilt, precession and spin are known, in degrees:

    >>> import explorer as ex
    >>> from scipy.stats import norm
    >>> coin = ex.Disk.uniform(m=5.67e-3, r=12.1e-3, g=9.81)
    >>> found = ex.probability(coin, ("theta_min", 1e-6), tilt=norm(60, 5), precession=norm(0, 900),
    ...                        spin=(-900, 900), degrees=True)
    >>> found.method, 0 < found.interval[0] < found.estimate < found.interval[1] < 1e-5
    ('importance', True)
    """
    require_axial_inertia(disk)
    source = Distribution.of(disk, coordinates, flag("degrees", degrees))
    count, samples = whole("count", count, 1, MOST), whole("samples", samples, 10, 10**9)
    accuracy, random = number("accuracy", accuracy, 1e-13, 0.1), stream_of(rng)
    delta = None if callable(event) else read_delta("event", event)
    counted = _counted(source, event if callable(event) else delta, count, accuracy, samples, random)
    what = f"theta_min < {delta:g}" if delta is not None else getattr(event, "__name__", "the event")
    bounds = "1 bounce" if count == 1 else f"{count} bounces"
    asked = f"{what} within {bounds}, disk {disk.name}: {source}"
    near = NearFallingSet(source, count, accuracy)
    if delta is None:
        return _plainly(counted, None, "", asked)
    if source.why_not_near_f:
        return _plainly(counted, None, f"{source.why_not_near_f}: the share of plain draws is counted", asked)
    draws = max(samples // _SHARE, LEAST)
    law = near.law(random, draws, counted.share)
    note = "" if law else _NO_LAW
    if counted.hits >= FEWEST or delta > LARGEST_DELTA:
        return _plainly(counted, law, note, asked)
    rare = near.below(delta, random, draws, counted.share)
    if rare.effective < FEWEST or not math.isfinite(rare.unknown):
        why = (
            f"weighted draws are worth {rare.effective:.0f} hits, and {FEWEST} are needed: plain draws are counted"
        )
        return _plainly(counted, law, why, asked)
    value, share = float(rare.estimate.value), counted.share
    error = math.hypot(rare.estimate.error, value * math.sqrt((1.0 - share) / counted.states))
    low, high = replace(rare.estimate, error=error).interval()
    interval = float(max(low, 0.0)), float(high + rare.unknown)
    return Probability(value, interval, rare.effective, law, "importance", note, asked)


def read_delta(name: str, event: Any) -> float:
    """Read the tilt of ("theta_min", delta) or "theta_min:delta". Raises InputError."""
    parts = tuple(event.split(":")) if isinstance(event, str) else event
    pair = isinstance(parts, tuple | list) and len(parts) == 2 and isinstance(parts[0], str)
    if not pair or parts[0] != "theta_min":
        raise InputError(f'{name} = {shown(event)}: give theta_min:DELTA, or ("theta_min", delta), or a function')
    return number(f"{name} theta_min", parts[1], 1e-100, 1.0)


class _Counted(NamedTuple):
    """Plain draws: how many, which of them are states, what was seen and what could not be told."""

    draws: int
    states: int
    hits: int
    unknown: int

    @property
    def share(self) -> float:
        """Of draws that are states."""
        return self.states / self.draws


def _counted(
    source: Distribution, event: Any, count: int, accuracy: float, samples: int, random: Stream
) -> _Counted:
    """What plain draws see."""
    total = np.zeros(4, np.int64)
    for rows in blocks(samples):
        states = source.states(source.draw(random, rows.stop - rows.start))
        good = states.status != compiled.status.Status.BAD_INPUT
        if callable(event):
            hit, unknown = _seen(states.at(np.flatnonzero(good)), event, count, accuracy)
        else:
            near = states.at(np.flatnonzero(good & may_come(states, event)))
            theta, _ = smallest_tilts(near, count, accuracy)
            hit, unknown = theta < event, np.isnan(theta)
        total += good.size, good.sum(), hit.sum(), unknown.sum()
    if total[1] < 0.001 * total[0]:
        raise RunError(
            f"only {total[1]:,} of {total[0]:,} draws are states; give tilts between 0 and pi, and "
            "degrees=True where they are in degrees"
        )
    return _Counted(*total.tolist())


def _seen(
    states: States, event: Callable[[Bounces], ArrayLike], count: int, accuracy: float
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Of which states the event is true, and of which that is not known."""
    found, code = bounces(states, count, accuracy=accuracy), compiled.status.Status
    falls = found.status == code.FALLS
    found = replace(found, theta_min=np.where(falls, 0.0, found.theta_min))
    given = returned_numbers("event", event(found))
    if given.shape not in (found.shape, found.shape[:1]) or given.dtype.kind != "b":
        raise InputError(
            f"event: returned {shown(given)} for bounces of shape {found.shape}; return a bool for each state, "
            "or for each of its bounces"
        )
    hit = given.reshape(states.size, -1).any(axis=1)
    # Of a fall nothing but theta_min is known, and with it an event that is true.
    known = (found.status == code.OK).all(axis=-1) | (falls.any(axis=-1) & hit)
    return known & hit, ~known


def _plainly(counted: _Counted, law: Law | None, note: str, asked: str) -> Probability:
    """What plain draws say; a draw that could not be told may be a hit or not."""
    hits, states, most = counted.hits, counted.states, counted.hits + counted.unknown
    low, high = (statistics.share(n, states)["interval_95"][i] for i, n in enumerate((hits, most)))  # type: ignore[index]
    notes = [note] if note else []
    if counted.unknown:
        notes.append(f"{counted.unknown:,} of {states:,} states have no answer; the interval allows for them")
    if not hits:
        high = statistics.upper_bound(most, states)
        notes.append("more samples may see one, or lower the bound")
    return Probability(hits / states, (low, high), float(hits), law, "plain", "; ".join(notes), asked)

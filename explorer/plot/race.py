"""Pictures of the race of the contact point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from explorer.errors import InputError, whole
from explorer.measure.tallies import LogHistogram
from explorer.phase.arguments import read_range
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import LAW, SIGN_COLOURS, SMALL, axes_or_new, dress, legend_below, number, styled
from explorer.portrait.races import RaceRidges, binned

_BINS, _MOST_BINS = 12, 1000  # a decade of the deviation: 21 % wide
_STRIP = 0.15  # of the height, for the view of both sides on one axis
_TALLEST = 0.46  # of the distance between two ridges


@captioned(
    Question.HOW_FAR,
    "The distribution of race angles around their limits, one ridge for each decade of |η̂|: above each line η > 0 "
    "around +κπ, below it η < 0 around −κπ. The nearer to F, the narrower: each ridge down the page is some ten "
    "times nearer to the limit. The strip shows both sides on one plain axis, where they are two spikes.",
)
def race_histogram(
    races: Mapping[str, Any] | RaceRidges,
    ax: Axes | None = None,
    bins: int = _BINS,
    range: tuple[float, float] | None = None,
    **look: Any,
) -> Axes:
    """Draw the distribution of race angles about +-kappa pi, a ridge for each decade of |eta_hat|.

    Parameters
    ----------
    races : mapping or RaceRidges
        The summary of a run of scene race-angles, or what `explorer.portrait.race_ridges` counts.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    bins : int
        For each decade of the distance from the limit.
    range : (float, float), optional
        Distances from the limit (rad) at which the axis turns from linear to logarithmic, and where it ends; by
        default such that all ridges are seen.
    **look
        Passed on to matplotlib for the ridges.

    Returns
    -------
    Axes
        Race angle less its limit (rad), logarithmic on either side of 0, and |eta_hat|. The strip on top, race
        angles (rad) between -1.5 and 1.5 kappa pi, is an inset of it.

    Raises
    ------
    InputError
        For a range that does not lie above 0.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.portrait import race_ridges
    >>> disk, eta_hat = ex.Disk.uniform(), [1e-3, -2e-3, 1e-5]
    >>> found = race_ridges(disk, eta_hat, ex.passages(disk, 1.0, eta_hat, 1.0).race_angle)
    >>> ax = ex.plot.race_histogram(found, bins=4)
    >>> [label.get_text() for label in ax.get_yticklabels()]
    ['$10^{-5}$', '$10^{-3}$']
    """
    found = races if isinstance(races, RaceRidges) else RaceRidges.of_summary(races)
    least, most = _reach(found) if range is None else _above_zero(*read_range("range", range))
    ax = axes_or_new(ax)
    edges = _edges(least, most, whole("bins", bins, 1, _MOST_BINS))
    names = _ridges(ax, found, edges, least, look)
    _around_limits(ax, names, least, most)
    _strip(ax, found)
    legend_below(ax)
    wrong = races.get("wrong_way") if isinstance(races, Mapping) else None
    told = "" if wrong is None else f"; wrong way: {wrong:,}"
    title = f"Race angles collapse onto ±κπ = ±{found.limit:.4f} rad{told}"
    decades = r"decades of $|\hat\eta|$, each from ($\sqrt{g/r}$)"
    return dress(ax, "race angle less its limit ±κπ (rad)", decades, title)


def _above_zero(least: float, most: float) -> tuple[float, float]:
    """Distances as they are. Raises InputError for those that no logarithmic axis has."""
    if not 0.0 < least < most:
        raise InputError(f"range = {least:g}:{most:g}: both distances must be above 0, the smaller first")
    return least, most


def _ridges(ax: Axes, found: RaceRidges, edges: Array, least: float, look: dict[str, Any]) -> list[int]:
    """Draw a ridge for each decade and side; returns the decades."""
    widths = np.diff(_scaled(edges, least))
    names = sorted(found.ridges)
    for row, decade in enumerate(names):
        sides = found.ridges[decade]
        heights = {side: _counted(counts, edges) / widths for side, counts in sides.items()}
        tallest = max((h.max() for h in heights.values()), default=0.0) or 1.0
        for side, height in heights.items():
            where = "above: $\\eta > 0$, about +κπ" if side > 0 else "below: $\\eta < 0$, about −κπ"
            values = row + side * _TALLEST * height / tallest
            style = styled(look, fill=True, color=SIGN_COLOURS[side], label=where if row == 0 else None)
            ax.stairs(values, edges, baseline=row, **style)
        ax.axhline(row, color=LAW, lw=0.6)
    return names


def _around_limits(ax: Axes, names: list[int], least: float, most: float) -> None:
    """The axes of the ridges: logarithmic on both sides of the limits, a line for each decade."""
    ax.axvline(0.0, color=LAW, lw=1.0, ls="--")
    ax.set_xscale("symlog", linthresh=least, linscale=0.5)
    ax.set_xlim(-most, most)
    _log_ticks(ax, least, most)
    top = len(names) - 0.4
    ax.set_ylim(-0.6, top + 0.42 + (top + 1.2) * _STRIP / (1.0 - _STRIP))
    ax.set_yticks(np.arange(len(names)), [f"$10^{{{n}}}$" for n in names])


def _reach(found: RaceRidges) -> tuple[float, float]:
    """Where the axis turns linear, below most of the narrowest ridge, and where it ends, beyond all."""
    every = [counts for sides in found.ridges.values() for counts in sides.values() if counts.total]
    if not every:
        return 1e-3, 1.0
    most = max(counts.row().largest for counts in every)
    low = min(max(min(abs(counts.quantile(0.05)), abs(counts.quantile(0.95))), 1e-15) for counts in every)
    most = 10.0 ** np.ceil(np.log10(max(most, 1e-14)) + 0.1)
    return float(min(0.1 * 10.0 ** np.floor(np.log10(low)), 0.1 * most)), float(most)


def _edges(least: float, most: float, bins: int) -> Array:
    """Bins on both sides of zero, `bins` for each decade between least and most, and the rest in one each."""
    outer = np.geomspace(least, most, max(1, round(bins * np.log10(most / least))) + 1)
    edges: Array = np.concatenate([-outer[::-1], [0.0], outer])
    return edges


def _scaled(edges: Array, least: float) -> Array:
    """Edges as the axis places them, in decades; the linear part is half a decade on either side."""
    size = np.maximum(abs(edges) / least, 1e-300)
    scaled: Array = np.sign(edges) * np.where(size < 1.0, 0.5 * size, 0.5 + np.log10(np.maximum(size, 1.0)))
    return scaled


def _counted(deviations: LogHistogram, edges: Array) -> Array:
    """Counts in the bins of `edges`."""
    outer = edges[edges > 0.0]
    halves = []
    for counts in (deviations.row(above=False), deviations.row(below=False)):
        tiny = np.concatenate([[1e-300], outer])
        half = binned(counts, tiny)
        half[0] += counts.zeros
        halves.append(half)
    together: Array = np.concatenate([halves[0][::-1], halves[1]])
    return together


def _log_ticks(ax: Axes, least: float, most: float) -> None:
    decades = np.arange(round(np.log10(least)) + 1, round(np.log10(most)) + 1)
    shown = decades[:: -max(1, -(-len(decades) // 3))][::-1]
    ticks = [-(10.0**n) for n in shown[::-1]] + [0.0] + [10.0**n for n in shown]
    names = [f"$-10^{{{n}}}$" for n in shown[::-1]] + ["±κπ"] + [f"$10^{{{n}}}$" for n in shown]
    ax.set_xticks(ticks, names)
    ax.xaxis.set_minor_locator(NullLocator())


def _strip(ax: Axes, found: RaceRidges) -> None:
    """Both sides on one plain axis, on top."""
    strip = ax.inset_axes((0.0, 1.0 - _STRIP, 1.0, _STRIP))
    for side, (counts, outside) in found.angles.items():
        top = max(int(counts.max(initial=0)), 1)
        strip.stairs(counts / top, found.edges, fill=True, color=SIGN_COLOURS[side], lw=1.5)
        if outside:
            share = outside / (outside + counts.sum())
            place = {1: (0.99, "right"), -1: (0.01, "left")}[side]
            text = f"outside: {number(100.0 * share, '.2g')} %"
            strip.text(place[0], 0.9, text, ha=place[1], va="top", fontsize=SMALL, transform=strip.transAxes)
    limit = found.limit
    strip.set(xlim=(-1.5 * limit, 1.5 * limit), ylim=(0.0, 1.15), yticks=[])
    strip.set_xticks([-limit, -np.pi, 0.0, np.pi, limit], ["−κπ", "−π", "0", "π", "+κπ"])
    strip.tick_params(labelsize=SMALL, pad=1)
    for edge in ("top", "right", "left"):
        strip.spines[edge].set_visible(False)


@captioned(
    Question.HOW_FAR,
    "How far race angles are from ±κπ, over K|η|, against |η̂|, where K is each passage's own 2mgr/(I₁MA³). The "
    "median follows the line ln(1/|η|) − c with one constant c; half and nine tenths of the passages lie in the "
    "bands. The constant is as large as the logarithm here: the deviation changes its sign on the way.",
)
def race_deviation(
    races: Mapping[str, Any] | Sequence[Mapping[str, Any]], ax: Axes | None = None, **look: Any
) -> Axes:
    """Draw how far race angles are from their limit, over K |eta|, with the law ln(1/|eta|) - c.

    Parameters
    ----------
    races : mapping or sequence of mappings
        The summary of a run of scene race-angles, or the rows of `explorer.portrait.race_law`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the medians.

    Returns
    -------
    Axes
        |eta_hat|, logarithmic, and the deviation over K |eta| (dimensionless): positive where the contact point
        races further than kappa pi.

    Examples
    --------
    >>> import explorer as ex
    >>> from explorer.portrait import race_law
    >>> disk, eta_hat = ex.Disk.uniform(), [1e-6, 1e-4]
    >>> found = ex.passages(disk, 1.0, eta_hat, 1.0, accuracy=1e-9)
    >>> ax = ex.plot.race_deviation(race_law(disk, eta_hat, found.race_angle, found.impact_speed))
    >>> ax.get_xscale()
    'log'
    """
    ax = axes_or_new(ax)
    rows = races["law"] if isinstance(races, Mapping) else races
    ax.set_xscale("log")
    if not rows:
        ax.text(0.5, 0.5, "no deviation is above rounding", ha="center", transform=ax.transAxes)
    else:
        eta_hat, eta = (np.array([row[name] for row in rows]) for name in ("eta_hat", "eta"))
        logarithm = np.log(1.0 / eta)
        left = {share: logarithm - [row["constant"][share] for row in rows] for share in rows[0]["constant"]}
        for low, high, shade, name in (("0.95", "0.05", 0.12, "nine tenths"), ("0.75", "0.25", 0.25, "half")):
            ax.fill_between(eta_hat, left[low], left[high], color=LAW, alpha=shade, lw=0, label=name)
        # The constant where |eta| is smallest, of steps that hold enough
        counted = [row for row in rows if row["passages"] >= 0.2 * max(row["passages"] for row in rows)]
        constant = float(np.median([row["constant"]["0.5"] for row in counted[: max(1, len(counted) // 2)]]))
        law = rf"$\ln(1/|\eta|) - {constant:.2f}$"
        ax.plot(eta_hat, logarithm - constant, color=LAW, lw=1.6, ls="--", label=law)
        style = styled(look, color=LAW, marker="o", ls="", ms=5, mfc="white", label="median")
        ax.plot(eta_hat, left["0.5"], **style)
        ax.axhline(0.0, color=LAW, lw=0.6)
        legend_below(ax, ncols=4)
    return dress(
        ax,
        r"$|\hat\eta|$ ($\sqrt{g/r}$)",
        r"$\pm$(race angle $\mp\,\kappa\pi$) / $K|\eta|$",
        r"Distance from $\kappa\pi$: $K\eta\,(\ln(1/|\eta|) - c)$, $K = 2mgr/I_1MA^3$",
        grid=True,
    )

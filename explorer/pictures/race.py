"""The race of the contact point: its angles about their limit, and how the distance from the limit shrinks."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from explorer.errors import InputError, whole
from explorer.measure.races import RaceRidges, binned, race_ridges
from explorer.measure.tallies import LogHistogram
from explorer.motion.bounces import Bounces, motion_constants
from explorer.motion.passages import Passages
from explorer.phase.arguments import read_range
from explorer.phase.states import Array
from explorer.pictures.register import Question, picture
from explorer.pictures.style import LAW, SIGN_COLOURS, SMALL, dress, legend_below, number

_MOST_BINS = 1000
_STRIP = 0.15  # of the height, for the view of both sides on one axis
_TALLEST = 0.46  # of the distance between two ridges


@picture(
    Question.HOW_FAR,
    "The distribution of race angles around their limits, one ridge for each decade of |η̂|: above each line η > 0 "
    "around +κπ, below it η < 0 around −κπ. The nearer to F, the narrower: each ridge down the page is some ten "
    "times nearer to the limit. The strip shows both sides on one plain axis, where they are two spikes.",
)
def race_histogram(
    ax: Axes,
    races: Mapping[str, Any] | RaceRidges | Passages | Bounces,
    bins: int = 12,
    range: tuple[float, float] | None = None,
) -> None:
    """Draw the distribution of race angles about +-kappa pi, a ridge for each decade of |eta_hat|.

    races: the summary of a run of scene race-angles, or what `explorer.passages` or `explorer.bounces`
    returned. bins: for each decade of the distance from the limit. range: distances from the limit (rad) at
    which the axis turns from linear to logarithmic, and where it ends; by default such that all ridges are
    seen.
    """
    found = ridges_of(races)
    least, most = _reach(found) if range is None else read_range("range", range)
    if not 0.0 < least < most:
        raise InputError(f"range = {least:g}:{most:g}: both distances must be above 0, the smaller first")
    names = _ridges(ax, found, _edges(least, most, whole("bins", bins, 1, _MOST_BINS)), least)
    ax.axvline(0.0, color=LAW, lw=1.0, ls="--")
    ax.set_xscale("symlog", linthresh=least, linscale=0.5)
    ax.set_xlim(-most, most)
    _log_ticks(ax, least, most)
    top = len(names) - 0.4
    ax.set_ylim(-0.6, top + 0.42 + (top + 1.2) * _STRIP / (1.0 - _STRIP))
    ax.set_yticks(np.arange(len(names)), [f"$10^{{{n}}}$" for n in names])
    _strip(ax, found)
    legend_below(ax)
    wrong = races.get("wrong_way") if isinstance(races, Mapping) else None
    told = "" if wrong is None else f"; wrong way: {wrong:,}"
    title = f"Race angles collapse onto ±κπ = ±{found.limit:.4f} rad{told}"
    decades = r"decades of $|\hat\eta|$, each from ($\sqrt{g/r}$)"
    dress(ax, "race angle less its limit ±κπ (rad)", decades, title)


def ridges_of(races: Mapping[str, Any] | RaceRidges | Passages | Bounces) -> RaceRidges:
    """What is drawn of a summary or a result. Raises InputError for anything else."""
    if isinstance(races, Passages):
        return race_ridges(races.disk, races.eta_hat, races.race_angle)
    if isinstance(races, Bounces):
        return race_ridges(races.states.disk, motion_constants(races)["eta_hat"], races.race_angle)
    if isinstance(races, Mapping) and "ridges" in races:
        return RaceRidges.of_summary(races)
    if not isinstance(races, RaceRidges):
        raise InputError("races: give the summary of a run of race-angles, or what passages or bounces returned")
    return races


def _ridges(ax: Axes, found: RaceRidges, edges: Array, least: float) -> list[int]:
    """Draw a ridge for each decade and side; returns the decades."""
    size = np.maximum(abs(edges) / least, 1e-300)
    # Edges as the axis places them, in decades; the linear part is half a decade on either side.
    places = np.sign(edges) * np.where(size < 1.0, 0.5 * size, 0.5 + np.log10(np.maximum(size, 1.0)))
    names = sorted(found.ridges)
    for row, decade in enumerate(names):
        heights = {
            side: _counted(counts, edges) / np.diff(places) for side, counts in found.ridges[decade].items()
        }
        tallest = max((h.max() for h in heights.values()), default=0.0) or 1.0
        for side, height in heights.items():
            where = "above: $\\eta > 0$, about +κπ" if side > 0 else "below: $\\eta < 0$, about −κπ"
            values = row + side * _TALLEST * height / tallest
            look: dict[str, Any] = {"fill": True, "color": SIGN_COLOURS[side], "label": None if row else where}
            ax.stairs(values, edges, baseline=row, **look)
        ax.axhline(row, color=LAW, lw=0.6)
    return names


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
    return np.concatenate([-outer[::-1], [0.0], outer])


def _counted(deviations: LogHistogram, edges: Array) -> Array:
    """Counts in the bins of `edges`."""
    halves = []
    for counts in (deviations.row(above=False), deviations.row(below=False)):
        half = binned(counts, np.concatenate([[1e-300], edges[edges > 0.0]]))
        half[0] += counts.zeros
        halves.append(half)
    return np.concatenate([halves[0][::-1], halves[1]])


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
            text = f"outside: {number(100.0 * outside / (outside + counts.sum()), '.2g')} %"
            place: dict[str, Any] = {
                "ha": "right" if side > 0 else "left",
                "va": "top",
                "transform": strip.transAxes,
            }
            strip.text(0.99 if side > 0 else 0.01, 0.9, text, fontsize=SMALL, **place)
    limit = found.limit
    strip.set(xlim=(-1.5 * limit, 1.5 * limit), ylim=(0.0, 1.15), yticks=[])
    strip.set_xticks([-limit, -np.pi, 0.0, np.pi, limit], ["−κπ", "−π", "0", "π", "+κπ"])
    strip.tick_params(labelsize=SMALL, pad=1)
    strip.spines[["top", "right", "left"]].set_visible(False)


@picture(
    Question.HOW_FAR,
    "How far race angles are from ±κπ, over K|η|, against |η̂|, where K is each passage's own 2mgr/(I₁MA³). The "
    "median follows the line ln(1/|η|) − c with one constant c; half and nine tenths of the passages lie in the "
    "bands. The constant is as large as the logarithm here: the deviation changes its sign on the way.",
)
def race_deviation(ax: Axes, races: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
    """Draw how far race angles are from their limit, over K |eta|, with the law ln(1/|eta|) - c.

    races: the summary of a run of scene race-angles, or the rows of `explorer.race_law`. The deviation is positive
    where the contact point races further than kappa pi.
    """
    rows = races["law"] if isinstance(races, Mapping) else races
    ax.set_xscale("log")
    title = r"Distance from $\kappa\pi$: $K\eta\,(\ln(1/|\eta|) - c)$, $K = 2mgr/I_1MA^3$"
    dress(ax, r"$|\hat\eta|$ ($\sqrt{g/r}$)", r"$\pm$(race angle $\mp\,\kappa\pi$) / $K|\eta|$", title, grid=True)
    if not rows:
        ax.text(0.5, 0.5, "no deviation is above rounding", ha="center", transform=ax.transAxes)
        return
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
    ax.plot(eta_hat, left["0.5"], color=LAW, marker="o", ls="", ms=5, mfc="white", label="median")
    ax.axhline(0.0, color=LAW, lw=0.6)
    legend_below(ax, ncols=4)

"""The race of the contact point: its angles about their limit, and how the distance from the limit shrinks."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from explorer.errors import InputError, whole
from explorer.measure.races import BINS, binned, race_law, race_ridges
from explorer.measure.races import SIDES as _SIDES
from explorer.motion.bounces import Bounces, motion_constants
from explorer.motion.passages import Passages
from explorer.phase.arguments import read_range
from explorer.pictures.register import Question, picture
from explorer.pictures.style import LAW, SERIES, SIDES, SIGN_COLOURS, SIZE, SMALL, dress, legend_below

_MOST_BINS = 1000
_JOINED = 13  # bins of the plain axis, so that a side is seen though it is one spike
_TALLEST = 0.46  # of the distance between two ridges


@picture(
    Question.HOW_FAR,
    "Above, the race angles of all passages on one plain axis: whatever the start, the contact point races by "
    "+κπ on one side of F, blue, and by −κπ on the other, vermilion. Below, on a logarithmic axis, how far the "
    "angles are from ±κπ, with one ridge for each decade of |η̂| and the two sides of F back to back. Ten times "
    "closer to F, the angles are some ten times closer to ±κπ.",
    (SIZE[0], 6.4),
)
def race_histogram(
    figure: Figure,
    races: Mapping[str, Any] | Passages | Bounces,
    bins: int = 12,
    range: tuple[float, float] | None = None,
) -> None:
    """Draw the distribution of race angles, and of their distance from +-kappa pi by the decade of |eta_hat|.

    races: the summary of a run of scene race-angles, or what `explorer.passages` or `explorer.bounces` returned.
    bins: for each decade of the distance from the limit. range: the smallest and the largest distance from the
    limit (rad) on the lower axis; by default such that the ridge of every decade is seen.
    """
    found = summary_of(races)
    least, most = _reach(found) if range is None else read_range("range", range)
    if not 0.0 < least < most:
        raise InputError(f"range = {least:g}:{most:g}: both distances must be above 0, the smaller first")
    above, below = figure.subplots(2, 1, height_ratios=(1.0, 2.2))
    _angles(above, found)
    bins = whole("bins", bins, 1, _MOST_BINS)
    edges = np.geomspace(least, most, max(1, round(bins * np.log10(most / least))) + 1)
    ridges = found["ridges"]
    for row, ridge in enumerate(ridges):
        parts = {side: ridge[name].values() for name, side in _SIDES.items()}
        heights = {side: np.sum([binned(part, edges) for part in both], axis=0) for side, both in parts.items()}
        tallest = max((height.max() for height in heights.values()), default=0.0) or 1.0
        for side, height in heights.items():
            look: dict[str, Any] = {"fill": True, "color": SIGN_COLOURS[side], "label": SIDES[side]}
            below.stairs(row + side * _TALLEST * height / tallest, edges, baseline=row, **look)
        below.axhline(row, color=LAW, lw=0.6)
    below.set_xscale("log")
    below.set_xlim(least, most)
    below.set_yticks(np.arange(len(ridges)), [f"$10^{{{ridge['decade']}}}$" for ridge in ridges])
    legend_below(below, bbox_to_anchor=(0.5, -0.2))
    title = "The closer to $F$, the exacter"
    dress(
        below,
        r"distance of the race angle from $\pm\kappa\pi$ (rad)",
        r"decade of $|\hat\eta|$, from (units of the disk)",
        title,
    )


def summary_of(races: Mapping[str, Any] | Passages | Bounces) -> Mapping[str, Any]:
    """What is drawn, of a summary or a result. Raises InputError for anything else."""
    if isinstance(races, Passages):
        disk, eta_hat, speed = races.disk, races.eta_hat, races.impact_speed
    elif isinstance(races, Bounces):
        known, disk = motion_constants(races), races.states.disk
        eta_hat, speed = known["eta_hat"], known["impact_speed"]
    elif isinstance(races, Mapping) and {"ridges", "law"} <= set(races):
        return races
    else:
        raise InputError("races: give the summary of a run of race-angles, or what passages or bounces returned")
    rows = race_law(disk, eta_hat, races.race_angle, speed)
    return {**race_ridges(disk, eta_hat, races.race_angle), "law": rows}


def _reach(found: Mapping[str, Any]) -> tuple[float, float]:
    """Where the axis begins, below most of the narrowest ridge, and where it ends, beyond all."""
    every = [[*ridge[name].values()] for ridge in found["ridges"] for name in _SIDES]
    sizes = [part["range"][1] for parts in every for part in parts if part["range"]]
    if not sizes:
        return 1e-3, 1.0
    most = 10.0 ** np.ceil(np.log10(max(*sizes, 1e-14)) + 0.1)
    low = max(min(map(_least, every)), 1e-15)
    return float(min(0.01 * 10.0 ** np.floor(np.log10(low)), 0.1 * most)), float(most)


def _least(parts: Sequence[Mapping[str, Any]]) -> float:
    """The size below which a twentieth of a ridge lies."""
    bins, counts = (np.concatenate([part[name] for part in parts]) for name in ("bins", "counts"))
    if not bins.size:
        return np.inf
    order = np.argsort(bins)
    below = np.cumsum(counts[order])
    return float(10.0 ** (bins[order][np.searchsorted(below, 0.05 * below[-1])] / BINS))


def _angles(ax: Axes, found: Mapping[str, Any]) -> None:
    """Race angles of both sides on one plain axis, and how many go the other way, where that is known."""
    limit, wrong, notes = found["limit"], found.get("wrong_way"), []
    histogram = found["histogram"]
    for name, side in _SIDES.items():
        counts, outside = np.array(histogram[f"counts_{name}"]), histogram[f"outside_{name}"]
        high, edges = np.add.reduceat(counts, np.arange(0, counts.size, _JOINED)), histogram["edges"][::_JOINED]
        ax.stairs(high / max(int(high.max()), 1), edges, fill=True, color=SIGN_COLOURS[side])
        words = f"{counts.sum() + outside:,}\nwith {SIDES[side]}"
        ax.text(0.5 * side * limit, 0.9, words, ha="center", va="top", fontsize=SMALL)
        notes += [f"{outside:,} of {SIDES[side]} lie outside"] if outside else []
    notes += [] if wrong is None else [f"{wrong:,} race the wrong way" if wrong else "none races the wrong way"]
    ax.text(0.5, 0.15, "\n".join(notes), ha="center", transform=ax.transAxes, fontsize=SMALL)
    ax.set(xlim=(-1.5 * limit, 1.5 * limit), ylim=(0.0, 1.1), yticks=[])
    ticks = [-limit, -np.pi, 0.0, np.pi, limit]
    ax.set_xticks(ticks, [r"$-\kappa\pi$", "−π", "0", "π", r"$+\kappa\pi$"])
    title = rf"The contact point races by $\pm\kappa\pi$ = ±{limit:.4f} rad"
    dress(ax, "race angle (rad)", "passages", title)


@picture(
    Question.HOW_FAR,
    "The deviation of race angles from ±κπ, plotted against the distance from F. Half of the passages lie below "
    "the lower line, nine tenths below the upper one, and both lines fall about as steeply as the dashed line, "
    "the law |η| ln(1/|η|). The deviation of a single passage differs from the law by |η| times a factor, which "
    "is not the same for all passages. Each deviation is divided by K = 2mgr/(I₁MA³) of its passage, where A is "
    "the speed at impact and M is I₁ + mr².",
)
def race_deviation(ax: Axes, races: Mapping[str, Any] | Passages | Bounces | list[dict[str, Any]]) -> None:
    """Draw how far race angles are from +-kappa pi, divided by K (see the caption), and the law |eta| ln(1/|eta|).

    races: the summary of a run of scene race-angles, what `explorer.passages` or `explorer.bounces` returned, or
    the rows of `explorer.race_law`.
    """
    rows = races if isinstance(races, list) else summary_of(races)["law"]
    ax.set(xscale="log", yscale="log")
    title = r"Ten times closer to $F$, some ten times closer to $\pm\kappa\pi$"
    dress(
        ax,
        r"$|\hat\eta|$ (units of the disk)",
        "distance of the race angle\nfrom $\\pm\\kappa\\pi$, over $K$ ($\\sqrt{g/r}$)",
        title,
        grid=True,
    )
    if not rows:
        ax.text(0.5, 0.5, "no deviation is above rounding", ha="center", transform=ax.transAxes)
        return
    eta_hat, eta = (np.array([row[name] for row in rows]) for name in ("eta_hat", "eta"))
    for low, high, marker, name in (("0.05", "0.95", "s", "nine tenths"), ("0.25", "0.75", "o", "half")):
        # Of (race angle - kappa pi)/(K eta), which may have either sign
        ends = [np.log(1.0 / eta) - [row["constant"][share] for row in rows] for share in (low, high)]
        ax.plot(
            eta_hat, eta * np.max(np.abs(ends), axis=0), color=SERIES[1], marker=marker, label=f"{name} are below"
        )
    ax.plot(
        eta_hat, eta * np.log(1.0 / eta), color=LAW, lw=1.6, ls="--", label=r"the law, $|\eta|\,\ln(1/|\eta|)$"
    )
    legend_below(ax)

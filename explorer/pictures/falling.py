"""Samples near the falling set: the flattest over the constants of motion, and how rare the flattest are."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from explorer.errors import InputError
from explorer.measure.slices import ConstantsPlane
from explorer.measure.statistics import poisson_interval
from explorer.measure.tallies import LogHistogram
from explorer.phase.arguments import column
from explorer.phase.linear_constants import line_slope
from explorer.pictures.register import Question, picture
from explorer.pictures.slices import colour_tilt
from explorer.pictures.style import ACCENT, LAW, TEXT, dress, label, legend_below

_FEWEST = 100  # samples that a guide of slope one is drawn through


@picture(
    Question.FROM_WHERE,
    "The plane of the two constants of motion, divided into cells: the colour of a cell is that of the flattest "
    "motion among its samples. Only motions on two lines through the origin come flat; the exact lines are drawn "
    "only near the edges, so that they do not hide the ridges of samples. The more samples a cell has, the "
    "flatter is the flattest of them.",
)
def constants_plane(ax: Axes, plane: ConstantsPlane) -> None:
    """Draw the flattest motion in each cell of the plane of constants, and both lines l_+-.

    plane: a ConstantsPlane, which a run of falling-set makes from random states or from yours.
    """
    colour_tilt(ax, plane.sigma3_edges, plane.sigma4_edges, plane.smallest, plane.method)
    (left, right), (low, high) = plane.sigma3_edges[[0, -1]], plane.sigma4_edges[[0, -1]]
    ax.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    slope = line_slope(plane.disk)
    reach = min(right, high / abs(slope)) if slope else right
    for face, name in ((1, "$l_+$"), (-1, "$l_-$")):
        for end in (-1.0, 1.0):
            x = end * reach * np.array([0.72, 1.0])
            words = "exact lines, at their outer ends"
            ax.plot(x, face * slope * x, color=LAW, lw=1.6, ls=(0, (4, 2)), label=words)
        box: dict[str, Any] = {"facecolor": "white", "alpha": 0.85, "lw": 0, "pad": 1.5}
        place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": TEXT, "bbox": box}
        ax.text(0.62 * reach, face * (0.62 * reach * slope + 0.09 * (high - low)), name, **place)
    title = f"Only motions on two lines come flat, {plane.disk.name} disk"
    legend_below(ax)
    label(ax, plane.disk, "sigma3_bar", "sigma4_bar", title)


@picture(
    Question.HOW_RARELY,
    "The share of samples that come flatter than δ; the band is the 95 % uncertainty of the counts. The share "
    "decreases in proportion to δ, as the dashed line does, because F has just one dimension less than the space "
    "of states (codimension one). So nearly falling flat is rare, and falling flat has probability zero.",
)
def theta_min(ax: Axes, theta: LogHistogram | ArrayLike, samples: int | None = None) -> None:
    """Draw the share of samples that come flatter than delta, and a line on which the share is proportional to it.

    theta: smallest tilts (rad), of `explorer.periods` for instance, or counts of them. samples: the number
    of all samples, including those whose tilt is not known; by default the number of tilts.
    """
    counts = (theta if isinstance(theta, LogHistogram) else _counted(theta)).row()
    samples = samples if samples is not None else counts.total
    if samples < counts.total:
        raise InputError(f"samples = {samples}: theta has {counts.total}; give the number of all, or leave it out")
    dress(
        ax,
        r"$\delta$ (rad)",
        r"share of samples with $\theta_{\min} < \delta$",
        "The flatter, the rarer",
        grid=True,
    )
    if not counts.counts.any():
        text = "all samples fall flat" if counts.total else "no sample was computed"
        ax.text(0.5, 0.5, text, ha="center", transform=ax.transAxes, fontsize=TEXT)
        return
    values, below = counts.cumulative()
    share = below / samples
    ax.loglog(values, share, color=ACCENT, lw=2, marker="o" if values.size == 1 else "", label="samples")
    low, high = poisson_interval(below)
    ax.fill_between(values, low / samples, high / samples, color=ACCENT, alpha=0.25, lw=0, label="95 %")
    if counts.total > _FEWEST:
        middle = int(np.searchsorted(below, counts.total // 100))
        ends = np.array([values[0], min(1.0, values[-1])])
        guide = rf"$\propto \delta$, through the flattest {100.0 * share[middle]:.2g} %"
        ax.loglog(ends, share[middle] * ends / values[middle], color=LAW, ls="--", lw=1.2, label=guide)
        ax.set_ylim(0.5 / samples, 1.5)
    legend_below(ax, ncols=3)


def _counted(theta: ArrayLike) -> LogHistogram:
    """Tilts in bins; those that are not known are left out. Raises InputError for negative ones."""
    tilts = column("theta", theta)
    if (tilts < 0.0).any():
        raise InputError(f"theta has {np.nanmin(tilts):g}; give smallest tilts, 0 or more (rad)")
    counts = LogHistogram()
    counts.count(tilts.ravel())
    return counts

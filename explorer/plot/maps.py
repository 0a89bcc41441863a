"""Pictures of the falling set: the smallest tilt in colour, the exact set as lines."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from explorer.measure.log_counts import LogCounts
from explorer.motion.plan import method_in_words
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    DARK,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    TILT_COLOURS,
    axes_or_new,
    coordinate_label,
    dress,
    legend,
    rates_of,
    values_label,
)
from explorer.portrait.slices import ConstantsPlane, SliceMap

_FLATTEST = -3.0  # colours end at theta_min = 1e-3 rad: a picture resolves no narrower valley
_FALLS = (0, (8, 5))  # gaps let the valley show through the exact line that lies on it
_EDGES = {1: (0, (4, 4)), -1: (4, (4, 4))}  # where both edges coincide, each shows in the gaps of the other
_FEWEST = 100  # samples that a guide of slope one is drawn through


def _colour_tilt(ax: Axes, x: Array, y: Array, theta: Array, method: str) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        tilt = np.clip(np.log10(theta), _FLATTEST, None)
    mesh = ax.pcolormesh(
        x, y, tilt, cmap=TILT_COLOURS, vmin=_FLATTEST, vmax=np.log10(0.5 * np.pi), rasterized=True
    )
    bar = ax.figure.colorbar(mesh, ax=ax)
    bar.set_label(rf"$\log_{{10}}\,\theta_{{\min}}$ (rad), {method_in_words(method)}", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)


@captioned(
    Question.FROM_WHERE,
    "The flattest motion among the samples of each cell, over the two constants of motion. Only motions on "
    "two lines through the origin come flat; short marks at the frame say where these lines are exactly.",
)
def constants_plane(plane: ConstantsPlane, ax: Axes | None = None) -> Axes:
    """Draw all samples of a run over the plane of constants: the flattest motion per cell, and both lines l_+-.

    Parameters
    ----------
    plane : ConstantsPlane
        From a run of scene falling-set.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Colours are log10 theta_min (theta_min in rad), the axes are sigma3_bar and sigma4_bar.

    Examples
    --------
    >>> import numpy as np
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.slices import ConstantsPlane
    >>> edges = np.linspace(-2.0, 2.0, 4)
    >>> plane = ConstantsPlane(Disk.uniform(), edges, edges, np.full((3, 3), 0.1), 0.7286, "quadrature")
    >>> [line.get_label() for line in plot.constants_plane(plane).lines]
    ['$l_+$, exact', '$l_-$, exact']
    """
    ax = axes_or_new(ax)
    _colour_tilt(ax, plane.sigma3_edges, plane.sigma4_edges, plane.smallest, plane.method)
    ends = plane.sigma3_edges[[0, -1]]
    ax.plot(ends, plane.slope * ends, color=PLUS, lw=1.5, ls=_FALLS, label=r"$l_+$, exact")
    ax.plot(ends, -plane.slope * ends, color=MINUS, lw=1.5, ls=_FALLS, label=r"$l_-$, exact")
    ax.set_xlim(*ends)
    ax.set_ylim(*plane.sigma4_edges[[0, -1]])
    legend(ax, loc="upper center", ncols=2)
    unit = rates_of(plane.disk)
    return dress(
        ax,
        rf"$\bar\sigma_3$ ({unit})",
        rf"$\bar\sigma_4$ ({unit})",
        f"Flattest motion among the samples, {plane.disk.name} disk",
    )


@captioned(
    Question.FROM_WHERE,
    "How flat the disk comes, for every start in a plane of the phase space. The bright valleys are the "
    "falling set F, and the broken lines are F as the algebra gives it.",
)
def slice_map(cut: SliceMap, ax: Axes | None = None) -> Axes:
    """Draw theta_min on a slice of the phase space, and the exact falling set over it.

    Parameters
    ----------
    cut : SliceMap
        From `explorer.slice_map`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Colours are log10 theta_min (theta_min in rad). Broken lines are F on face + and on face -, dotted ones
        are eta = 0 where the disk would not fall, thin ones the edge between the two.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.slices import Slice, slice_map
    >>> disk = Disk.uniform()
    >>> ax = plot.slice_map(slice_map(disk, Slice.defaults(disk)[0], points=21))
    >>> ax.figure.axes[1].get_ylabel().rpartition(", ")[2]
    'by quadrature'
    """
    ax = axes_or_new(ax)
    _colour_tilt(ax, cut.x, cut.y, cut["theta_min"], cut.method)
    handles = [
        *_falling_set(ax, cut, 1, cut.falls.distance_plus, cut.falls.could_fall_plus),
        *_falling_set(ax, cut, -1, cut.falls.distance_minus, cut.falls.could_fall_minus),
    ]
    if handles:
        legend(ax, handles=handles, loc="upper center", bbox_to_anchor=(0.55, -0.15), ncols=2, columnspacing=1.0)
    first, second = (coordinate_label(name, cut.disk) for name in cut.slice.axes)
    return dress(ax, first, second, f"Where the disk falls: slice {values_label(cut.slice.fixed)}")


def _falling_set(ax: Axes, cut: SliceMap, face: int, distance: Array, could: NDArray[np.bool_]) -> list[Line2D]:
    """Draw eta = 0 on one face, and return what the legend says of it."""
    colour, name = (PLUS, "+") if face > 0 else (MINUS, "-")
    styles: list[tuple[str, Any, float]] = []
    for mask, label, style, width in (
        (could, rf"$F$, face ${name}$", _FALLS, 1.5),
        (~could, rf"$\eta_{name}=0$, no fall", ":", 1.3),
    ):
        kept = np.where(mask, distance, np.nan)
        look: dict[str, Any] = {"colors": colour, "linewidths": width, "linestyles": [style]}
        if _has_zero(kept) and any(
            np.size(path.vertices) for path in ax.contour(cut.x, cut.y, kept, [0.0], **look).get_paths()
        ):
            styles.append((label, style, width))
    if could.any() and not could.all():
        ax.contour(cut.x, cut.y, could, [0.5], colors=colour, linewidths=0.8, linestyles=[_EDGES[face]])
        styles.append((rf"would fall at $\eta_{name}=0$: edge", _EDGES[1], 0.8))
    return [Line2D([], [], color=colour, ls=style, lw=width, label=label) for label, style, width in styles]


def _has_zero(values: Array) -> bool:
    """True where values that are not NaN change their sign; matplotlib warns of contours that are not there."""
    finite = values[np.isfinite(values)]
    return finite.size > 0 and finite.min() <= 0.0 <= finite.max()


@captioned(
    Question.HOW_RARELY,
    "The share of samples that come flatter than δ. It falls in proportion to δ: F has codimension one, so "
    "nearly falling flat is rare and falling flat has probability zero.",
)
def theta_min_distribution(theta: LogCounts, samples: int, ax: Axes | None = None) -> Axes:
    """Draw the share of samples that come flatter than delta, and a guide of slope one: codimension one.

    Parameters
    ----------
    theta : LogCounts
        Counts of theta_min (rad).
    samples : int
        Number of all samples, also of those whose theta_min was not computed.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        delta (rad) and the share, both logarithmic.

    Examples
    --------
    >>> import numpy as np
    >>> from explorer import plot
    >>> from explorer.measure.log_counts import LogCounts
    >>> ax = plot.theta_min_distribution(LogCounts.of(np.geomspace(1e-5, 1.0, 500)), 1000)
    >>> float(ax.lines[0].get_ydata()[-1])
    0.5
    """
    ax = axes_or_new(ax)
    if not theta.counts.any():
        ax.text(0.5, 0.5, "no sample was computed", ha="center", transform=ax.transAxes, fontsize=TEXT)
        return dress(ax, r"$\delta$ (rad)", "share of samples")
    values, below = theta.cumulative()
    share = below / samples
    ax.loglog(values, share, color=PLUS, lw=2, label="samples")
    if theta.total > _FEWEST:
        middle = int(np.searchsorted(below, theta.total // 100))
        guide = np.array([values[0], values[middle]])
        ax.loglog(
            guide, share[middle] * guide / guide[1], color=DARK, ls="--", lw=1.2, label=r"slope one: $C\,\delta$"
        )
    legend(ax, loc="upper left")
    ax.grid(alpha=0.3)
    return dress(
        ax, r"$\delta$ (rad)", r"share of samples with $\theta_{\min} < \delta$", "The flatter, the rarer"
    )

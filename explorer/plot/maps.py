"""Pictures of the falling set: the smallest tilt in colour, the exact set as lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from explorer.errors import InputError
from explorer.measure.statistics import poisson_interval
from explorer.measure.tallies import LogHistogram, LogRow
from explorer.motion.plan import method_in_words
from explorer.phase.arguments import column
from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    ACCENT,
    LAW,
    SMALL,
    TEXT,
    TILT_COLOURS,
    axes_or_new,
    coordinate_label,
    dress,
    legend_below,
    say_if_nothing,
    styled,
    values_label,
)
from explorer.portrait.slices import ConstantsPlane, SliceMap

_FLATTEST = -3.0  # colours end at theta_min = 1e-3 rad: a picture resolves no narrower valley
_FALLS = (0, (8, 5))  # gaps let the valley show through the exact line that lies on it
_TILTS = (0.001, 0.01, 0.1, 1.0)
_FEWEST = 100  # samples that a guide of slope one is drawn through


def _colour_tilt(ax: Axes, x: Array, y: Array, theta: Array, method: str, **look: Any) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        tilt = np.log10(theta)
    shade = styled(look, cmap=TILT_COLOURS, vmin=_FLATTEST, vmax=np.log10(0.5 * np.pi), rasterized=True)
    mesh = ax.pcolormesh(x, y, tilt, **shade)
    bar = ax.figure.colorbar(mesh, ax=ax, extend="min")
    bar.set_ticks(np.log10(_TILTS).tolist(), labels=[f"{tilt:g}" for tilt in _TILTS])
    bar.set_label(rf"$\theta_{{\min}}$ (rad), {method_in_words(method)}", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)
    say_if_nothing(ax, theta, "no sample was computed")


@captioned(
    Question.FROM_WHERE,
    "The flattest motion among the samples of each cell, over the two constants of motion. Only motions on two "
    "lines through the origin come flat; the exact lines are drawn over their outer ends, so that the ridges of "
    "samples between them can be compared. A cell with more samples finds flatter ones.",
)
def constants_plane(plane: ConstantsPlane, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw all samples of a run over the plane of constants: the flattest motion per cell, and both lines l_+-.

    Parameters
    ----------
    plane : ConstantsPlane
        From `explorer.portrait.flattest_per_cell`; a run of scene falling-set draws its own by `figure`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib's pcolormesh.

    Returns
    -------
    Axes
        Colours are theta_min (rad) on a logarithmic scale, the axes are sigma3_bar and sigma4_bar.

    Examples
    --------
    >>> import numpy as np, explorer as ex
    >>> from explorer import plot
    >>> draw = np.random.default_rng(0).uniform(-1.0, 1.0, (3, 500))
    >>> plane = ex.portrait.flattest_per_cell(ex.phi_to_states(ex.Disk.uniform(), 0.0, *draw), cells=10)
    >>> [text.get_text() for text in plot.constants_plane(plane).texts]
    ['$l_+$', '$l_-$']
    """
    ax = axes_or_new(ax)
    _colour_tilt(ax, plane.sigma3_edges, plane.sigma4_edges, plane.smallest, plane.method, **look)
    (left, right), (low, high) = plane.sigma3_edges[[0, -1]], plane.sigma4_edges[[0, -1]]
    ax.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    reach = min(right, high / abs(plane.slope)) if plane.slope else right
    for face, name in ((1, "$l_+$"), (-1, "$l_-$")):
        for end in (-1.0, 1.0):
            x = end * reach * np.array([0.72, 1.0])
            ax.plot(x, face * plane.slope * x, color=LAW, lw=1.6, ls=(0, (4, 2)))
        box: dict[str, Any] = {"facecolor": "white", "alpha": 0.85, "lw": 0, "pad": 1.5}
        place: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": TEXT, "bbox": box}
        ax.text(0.62 * reach, face * (0.62 * reach * plane.slope + 0.09 * (high - low)), name, **place)
    x, y = (coordinate_label(name, plane.disk) for name in ("sigma3_bar", "sigma4_bar"))
    return dress(ax, x, y, f"Only motions on two lines come flat, {plane.disk.name} disk")


@captioned(
    Question.FROM_WHERE,
    "How flat the disk comes, for every start in a plane of the phase space. The bright valleys are the falling "
    "set F, and the broken lines on them are F as the algebra gives it. A step of the colour elsewhere is a "
    "separatrix: beyond it the disk stays in another well and does not come near this flat state.",
)
def slice_map(cut: SliceMap, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw theta_min on a slice of the phase space, and the exact falling set over it.

    Parameters
    ----------
    cut : SliceMap
        From `explorer.slice_map`.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib's pcolormesh.

    Returns
    -------
    Axes
        Colours are theta_min (rad) on a logarithmic scale. Lines are F, broken on face + and dash-dotted on face
        -; dotted ones are eta = 0 where the disk would not fall.

    Examples
    --------
    >>> import explorer as ex
    >>> cut = ex.slice_map(ex.Disk.uniform(), "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=21)
    >>> ax = ex.plot.slice_map(cut)
    >>> ax.figure.axes[1].get_ylabel().rpartition(", ")[2]
    'by quadrature'
    """
    ax = axes_or_new(ax)
    _colour_tilt(ax, cut.x, cut.y, cut["theta_min"], cut.method, **look)
    handles = [
        *_falling_set(ax, cut, 1, cut.falls.distance_plus, cut.falls.could_fall_plus),
        *_falling_set(ax, cut, -1, cut.falls.distance_minus, cut.falls.could_fall_minus),
    ]
    if handles:
        legend_below(ax, handles=handles)
    first, second = (coordinate_label(name, cut.disk) for name in cut.slice.axes)
    return dress(ax, first, second, f"Where the disk falls: slice {values_label(cut.slice.fixed)}")


def _falling_set(ax: Axes, cut: SliceMap, face: int, distance: Array, could: NDArray[np.bool_]) -> list[Line2D]:
    """Draw eta = 0 on one face, and return what the legend says of it."""
    from scipy.ndimage import binary_dilation

    name = "+" if face > 0 else "−"
    handles: list[Line2D] = []
    falls = _FALLS if face > 0 else (0, (8, 3, 1.5, 3))
    # A state that hardly moves could fall on one side of F alone: with eta set to 0 it would be below its own V.
    beside = binary_dilation(could, np.ones((3, 3)))
    for mask, label, style, width in (
        (beside, f"$F$, face {name}", falls, 1.4),
        (~could, rf"$\eta = 0$ on face {name}, no fall", (0, (1, 2)), 1.2),
    ):
        kept = np.where(mask, distance, np.nan)
        if not _has_zero(kept):
            continue
        look: dict[str, Any] = {"colors": LAW, "linewidths": width, "linestyles": [style]}
        drawn = ax.contour(cut.x, cut.y, kept, [0.0], **look)
        if any(np.size(path.vertices) for path in drawn.get_paths()):
            handles.append(Line2D([], [], color=LAW, ls=style, lw=width, label=label))
    return handles


def _has_zero(values: Array) -> bool:
    """True where values that are not NaN change their sign; matplotlib warns of contours that are not there."""
    finite = values[np.isfinite(values)]
    return finite.size > 0 and finite.min() <= 0.0 <= finite.max()


@captioned(
    Question.HOW_RARELY,
    "The share of samples that come flatter than δ, with the band of 95 % that counting leaves. It falls in "
    "proportion to δ, as the broken line does: F has codimension one, so nearly falling flat is rare, and falling "
    "flat has probability zero.",
)
def theta_min_distribution(
    theta: LogHistogram | ArrayLike, samples: int | None = None, ax: Axes | None = None, **look: Any
) -> Axes:
    """Draw the share of samples that come flatter than delta, and a guide of slope one: codimension one.

    Parameters
    ----------
    theta : LogHistogram or array_like
        theta_min (rad) of samples, of `explorer.periods` for instance, or counts of it.
    samples : int, optional
        Number of all samples, also of those whose theta_min was not computed; by default as many as `theta` has.
    ax : Axes, optional
        Where to draw; by default on a new figure.
    **look
        Passed on to matplotlib for the line of the samples.

    Returns
    -------
    Axes
        delta (rad) and the share, both logarithmic.

    Raises
    ------
    InputError
        For tilts below 0, and where there are more of them than samples.

    Examples
    --------
    >>> import numpy as np
    >>> from explorer import plot
    >>> ax = plot.theta_min_distribution(np.geomspace(1e-5, 1.0, 500), 1000)
    >>> float(ax.lines[0].get_ydata()[-1])
    0.5
    """
    counts = theta.row() if isinstance(theta, LogHistogram) else _counted(column("theta", theta))
    samples = samples if samples is not None else counts.total
    if samples < counts.total:
        raise InputError(f"samples = {samples}: theta has {counts.total}; give the number of all, or leave it out")
    ax = axes_or_new(ax)
    if not counts.counts.any():
        told = "all samples fall flat" if counts.total else "no sample was computed"
        ax.text(0.5, 0.5, told, ha="center", transform=ax.transAxes, fontsize=TEXT)
        return dress(ax, r"$\delta$ (rad)", "share of samples")
    values, below = counts.cumulative()
    share = below / samples
    mark = "o" if values.size == 1 else ""
    ax.loglog(values, share, **styled(look, color=ACCENT, lw=2, marker=mark, label="samples"))
    low, high = poisson_interval(below)
    ax.fill_between(values, low / samples, high / samples, color=ACCENT, alpha=0.25, lw=0, label="95 %")
    if counts.total > _FEWEST:
        _guide(ax, values, share, int(np.searchsorted(below, counts.total // 100)))
        ax.set_ylim(0.5 / samples, 1.5)
    legend_below(ax, ncols=3)
    share_name = r"share of samples with $\theta_{\min} < \delta$"
    return dress(ax, r"$\delta$ (rad)", share_name, "The flatter, the rarer", grid=True)


def _guide(ax: Axes, values: Array, share: Array, middle: int) -> None:
    """A line of slope one through the point `middle`."""
    ends = np.array([values[0], min(1.0, values[-1])])
    label = rf"$\propto \delta$, through the flattest {100.0 * share[middle]:.2g} %"
    ax.loglog(ends, share[middle] * ends / values[middle], color=LAW, ls="--", lw=1.2, label=label)


def _counted(theta: Array) -> LogRow:
    """Tilts in bins; those that are not known are left out. Raises InputError for negative ones."""
    if (theta < 0.0).any():
        raise InputError(f"theta has {np.nanmin(theta):g}; give smallest tilts, 0 or more (rad)")
    counts = LogHistogram()
    counts.count(theta.ravel())
    return counts.row()

"""Slices of the phase space coloured by tilt and by the side of F: which way the contact point races."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from explorer.phase.states import Array
from explorer.plot.captions import Question, captioned
from explorer.plot.style import (
    DARK,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    axes_or_new,
    coordinate_label,
    dress,
    legend,
    values_label,
)
from explorer.portrait.slices import SliceMap

_FLATTEST = -3.0  # the two colours meet at theta_min = 1e-3 rad
_TOP = float(np.log10(0.5 * np.pi))
_NEVER = "#A8A8A8"
# Strongest where flattest, and there the two meet: F is the edge between them.
_SIDES = LinearSegmentedColormap.from_list(
    "sides", [(0.0, "#FBEDE2"), (0.5, MINUS), (0.5, PLUS), (1.0, "#E6F1F8")], N=512
).with_extremes(bad=_NEVER)


def signed_tilt(cut: SliceMap) -> Array:
    """side times log theta_min on a scale from 0 (1e-3 rad or flatter) to 1 (pi/2); NaN where it never falls."""
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.clip((np.log10(cut["theta_min"]) - _FLATTEST) / (_TOP - _FLATTEST), 1e-9, 1.0)
    return np.where(cut.side == 0, np.nan, cut.side * height)


@captioned(
    Question.FROM_WHERE,
    "Which way the contact point races, for every start in a plane of the phase space: blue on one side of F, "
    "vermilion on the other, the stronger the flatter the disk comes. F is the edge where the strong colours "
    "meet.",
)
def race_slice_map(cut: SliceMap, ax: Axes | None = None) -> Axes:
    """Draw to which side the contact point races and how flat the disk comes; F is the edge of blue and vermilion.

    Parameters
    ----------
    cut : SliceMap
        From `explorer.slice_map`.
    ax : Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    Axes
        Blue where eta > 0 on the nearer face, vermilion where eta < 0, the stronger the smaller theta_min; grey
        where the disk would not fall on that face even if eta were exactly 0.

    Examples
    --------
    >>> from explorer import Disk, plot
    >>> from explorer.portrait.slices import Slice, slice_map
    >>> disk = Disk.uniform()
    >>> plot.race_slice_map(slice_map(disk, Slice.defaults(disk)[0], points=21)).get_xlabel()
    '$\\\\sigma_3$ ($\\\\sqrt{g/r}$)'
    """
    ax = axes_or_new(ax)
    mesh = ax.pcolormesh(cut.x, cut.y, signed_tilt(cut), cmap=_SIDES, vmin=-1.0, vmax=1.0, rasterized=True)
    _tilt_bar(ax, mesh)
    handles: list[Artist] = []
    if (cut.side == 0).any():
        handles.append(Patch(color=_NEVER, label=r"would not fall if $\eta$ were 0"))
    if cut.falls.face.min() < cut.falls.face.max():
        ax.contour(cut.x, cut.y, cut.falls.face, [0.0], colors=DARK, linewidths=0.9, linestyles=":")
        handles.append(Line2D([], [], color=DARK, lw=0.9, ls=":", label="the other face is nearer"))
    if handles:
        legend(ax, handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)
    first, second = (coordinate_label(name, cut.disk) for name in cut.slice.axes)
    return dress(ax, first, second, f"$F$ is where the strong colours meet: {values_label(cut.slice.fixed)}")


def _tilt_bar(ax: Axes, mesh: ScalarMappable) -> None:
    bar = ax.figure.colorbar(mesh, ax=ax)
    decades = np.array([-2.0, -1.0, 0.0])
    heights = (decades - _FLATTEST) / (_TOP - _FLATTEST)
    names = ["0.01", "0.1", "1"]
    bar.set_ticks([*-heights[::-1], 0.0, *heights], labels=[*names[::-1], r"$F$", *names])
    bar.set_label(r"$\theta_{\min}$ (rad);  $\eta < 0$ below, $\eta > 0$ above", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)

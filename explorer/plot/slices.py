"""Slices of the phase space coloured by tilt and by the way the contact point races."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from explorer.phase.states import Array
from explorer.plot.style import DARK, MINUS, PLUS, SMALL, TEXT, axes_or_new, axis_label, dress, legend

if TYPE_CHECKING:
    from explorer.portrait.slices import RaceSlice

_FLATTEST = -3.0  # the two colours meet at theta_min = 1e-3 rad
_TOP = float(np.log10(0.5 * np.pi))
_NEVER = "#A8A8A8"
# Strongest where flattest, and there the two meet: F is the edge between them.
_WAYS = LinearSegmentedColormap.from_list(
    "ways", [(0.0, "#FBEDE2"), (0.5, MINUS), (0.5, PLUS), (1.0, "#E6F1F8")], N=512
).with_extremes(bad=_NEVER)


def signed_tilt(found: "RaceSlice") -> Array:
    """way times log theta_min on a scale from 0 (1e-3 rad or flatter) to 1 (pi/2); NaN where it never falls."""
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.clip((np.log10(found.map.theta_min) - _FLATTEST) / (_TOP - _FLATTEST), 1e-9, 1.0)
    return np.where(found.way == 0, np.nan, found.way * height)


def race_slice_map(found: "RaceSlice", ax: Axes | None = None) -> Axes:
    """Which way the contact point races and how flat the disk comes; F is the edge of blue and vermilion."""
    ax = axes_or_new(ax)
    at = found.map
    mesh = ax.pcolormesh(at.x, at.y, signed_tilt(found), cmap=_WAYS, vmin=-1.0, vmax=1.0, rasterized=True)
    _tilt_bar(ax, mesh)
    handles: list[Artist] = []
    if (found.way == 0).any():
        handles.append(Patch(color=_NEVER, label="cannot fall there"))
    if found.face.min() < found.face.max():
        ax.contour(at.x, at.y, found.face, [0.0], colors=DARK, linewidths=0.9, linestyles=":")
        handles.append(Line2D([], [], color=DARK, lw=0.9, ls=":", label="the other flat side is nearer"))
    if handles:
        legend(ax, handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)
    fixed = ", ".join(f"{axis_label(key).split(' ')[0]} = {value:g}" for key, value in at.slice.fixed.items())
    first, second = at.slice.axes
    return dress(ax, axis_label(first), axis_label(second), f"$F$ is where the strong colours meet: {fixed}")


def _tilt_bar(ax: Axes, mesh: ScalarMappable) -> None:
    bar = ax.figure.colorbar(mesh, ax=ax)
    decades = np.array([-2.0, -1.0, 0.0])
    heights = (decades - _FLATTEST) / (_TOP - _FLATTEST)
    names = ["0.01", "0.1", "1"]
    bar.set_ticks([*-heights[::-1], 0.0, *heights], labels=[*names[::-1], r"$F$", *names])
    bar.set_label(r"$\theta_{\min}$ (rad);  $\eta < 0$ below, $\eta > 0$ above", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)

"""Slices of the phase space coloured by tilt and by the side of F: which way the contact point races."""

from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

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
    legend_below,
    say_if_nothing,
    styled,
    values_label,
)
from explorer.portrait.slices import SliceMap

_FLATTEST = -3.0  # the two colours meet at theta_min = 1e-3 rad
_TOP = float(np.log10(0.5 * np.pi))
# Strongest where flattest, and there the two meet: F is the edge between them.
_SIDES = LinearSegmentedColormap.from_list(
    "sides", [(0.0, "#FBEDE2"), (0.5, MINUS), (0.5, PLUS), (1.0, "#E6F1F8")], N=512
).with_extremes(bad="#A8A8A8")
_HATCH = "#00000030"
_NAMED = 0.03  # of the picture: smaller parts have no room for a name


def signed_tilt(cut: SliceMap) -> Array:
    """Sign of eta on the nearer face times log theta_min, from 0 (1e-3 rad or flatter) to 1 (pi/2)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        height = np.clip((np.log10(cut["theta_min"]) - _FLATTEST) / (_TOP - _FLATTEST), 1e-9, 1.0)
    falls = cut.falls
    signed: Array = np.where(falls.face > 0, np.sign(falls.distance_plus), np.sign(falls.distance_minus)) * height
    return signed


@captioned(
    Question.FROM_WHERE,
    "Which way the contact point races, for every start in a plane of the phase space: blue on one side of F, "
    "vermilion on the other, the stronger the flatter the disk comes. F is where the strong colours meet. Hatched "
    "motions come near flat too, but no change of η alone, at the same φ, σ̄₃ and energy, would make them fall.",
)
def race_slice_map(cut: SliceMap, ax: Axes | None = None, **look: Any) -> Axes:
    """Draw to which side the contact point races and how flat the disk comes; F is the edge of blue and vermilion.

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
        Blue where eta > 0 on the nearer face, vermilion where eta < 0, the stronger the smaller theta_min; hatched
        where the disk would not fall on that face if eta were exactly 0 at the same phi, sigma3_bar and energy.

    Examples
    --------
    >>> import explorer as ex
    >>> cut = ex.slice_map(ex.Disk.uniform(), "phi=0,phidot=1,sigma3=-2:2,sigma4=-2:2", points=21)
    >>> ex.plot.race_slice_map(cut).get_xlabel()
    '$\\\\sigma_3$ ($\\\\sqrt{g/r}$)'
    """
    ax = axes_or_new(ax)
    signed = signed_tilt(cut)
    mesh = ax.pcolormesh(cut.x, cut.y, signed, **styled(look, cmap=_SIDES, vmin=-1.0, vmax=1.0, rasterized=True))
    _tilt_bar(ax, mesh)
    say_if_nothing(ax, signed, "no sample was computed")
    _name_sides(ax, cut, signed)
    handles: list[Artist] = []
    never = cut.side == 0
    if never.any() and not never.all():
        marks = ax.contourf(cut.x, cut.y, never, [0.5, 1.5], colors="none", hatches=["////"])
        marks.set_edgecolor(_HATCH)
        marks.set_linewidth(0.0)
        name = r"no fall with $\eta$ set to 0 alone"
        handles.append(Patch(facecolor="white", edgecolor=_HATCH, hatch="////", label=name))
    if cut.falls.face.min() < cut.falls.face.max():
        # The face is not known on a line where both are as near: a contour of it would only follow rounding.
        smooth = abs(cut.falls.distance_plus) - abs(cut.falls.distance_minus)
        ax.contour(cut.x, cut.y, smooth, [0.0], colors=DARK, linewidths=0.9, linestyles=":")
        handles.append(Line2D([], [], color=DARK, lw=0.9, ls=":", label="the other face is nearer"))
    if handles:
        legend_below(ax, handles=handles)
    first, second = (coordinate_label(name, cut.disk) for name in cut.slice.axes)
    return dress(ax, first, second, f"$F$ is where the strong colours meet: {values_label(cut.slice.fixed)}")


def _name_sides(ax: Axes, cut: SliceMap, signed: Array) -> None:
    """Write the side into the middle of each large part: in grey both colours are the same."""
    from scipy.ndimage import distance_transform_edt, label

    for side, name in ((1, r"$\eta > 0$"), (-1, r"$\eta < 0$")):
        parts, count = label(np.sign(signed) == side)
        for part in range(1, count + 1):
            inside = parts == part
            if inside.mean() > _NAMED:
                depth = distance_transform_edt(np.pad(inside, 1))[1:-1, 1:-1]
                row, column = np.unravel_index(int(np.argmax(depth)), depth.shape)
                text = ax.text(
                    cut.x[column], cut.y[row], name, ha="center", va="center", fontsize=SMALL, color=DARK
                )
                text.set_path_effects([withStroke(linewidth=2.5, foreground="#FFFFFFB0")])


def _tilt_bar(ax: Axes, mesh: ScalarMappable) -> None:
    bar = ax.figure.colorbar(mesh, ax=ax)
    decades = np.array([-2.0, -1.0, 0.0])
    heights = (decades - _FLATTEST) / (_TOP - _FLATTEST)
    names = ["0.01", "0.1", "1"]
    bar.set_ticks([*-heights[::-1], 0.0, *heights], labels=[*names[::-1], r"$F$", *names])
    bar.set_label(r"$\eta < 0$      $\theta_{\min}$ (rad)      $\eta > 0$", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)

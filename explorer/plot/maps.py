"""Pictures of the falling set: integrated tilt in colour, the exact set as lines."""

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from explorer.measure.log_counts import LogCounts
from explorer.phase.states import Array
from explorer.plot.style import (
    DARK,
    MINUS,
    PLUS,
    SMALL,
    TEXT,
    TILT_COLOURS,
    axes_or_new,
    axis_label,
    dress,
    legend,
)

if TYPE_CHECKING:
    from explorer.portrait.slices import ConstantsPlane, SliceMap

_FLATTEST = -3.0  # colours end at theta_min = 1e-3 rad


# Gaps let the valley show through the exact line that lies on it.
_FALLS = (0, (8, 5))


def _colour_tilt(ax: Axes, x: Array, y: Array, theta: Array) -> None:
    with np.errstate(divide="ignore", invalid="ignore"):
        tilt = np.clip(np.log10(theta), _FLATTEST, None)
    mesh = ax.pcolormesh(
        x, y, tilt, cmap=TILT_COLOURS, vmin=_FLATTEST, vmax=np.log10(0.5 * np.pi), rasterized=True
    )
    bar = ax.figure.colorbar(mesh, ax=ax)
    bar.set_label(r"$\log_{10}\,\theta_{\min}$ (rad), integrated", fontsize=TEXT)
    bar.ax.tick_params(labelsize=SMALL)


def constants_plane(plane: "ConstantsPlane", ax: Axes | None = None) -> Axes:
    """All samples of a run over the plane of constants: the flattest motion per cell, and l_+-."""
    ax = axes_or_new(ax)
    _colour_tilt(ax, plane.sigma3_edges, plane.sigma4_edges, plane.smallest)
    ends = plane.sigma3_edges[[0, -1]]
    ax.plot(ends, plane.slope * ends, color=PLUS, lw=1.5, ls=_FALLS, label=r"$l_+$, exact")
    ax.plot(ends, -plane.slope * ends, color=MINUS, lw=1.5, ls=_FALLS, label=r"$l_-$, exact")
    ax.set_xlim(*ends)
    ax.set_ylim(*plane.sigma4_edges[[0, -1]])
    legend(ax, loc="upper center", ncols=2)
    unit = "(rad per unit of time)"
    return dress(
        ax,
        rf"$\bar\sigma_3$ {unit}",
        rf"$\bar\sigma_4$ {unit}",
        f"Flattest motion among the samples, {plane.disk.name} disk",
    )


def slice_map(found: "SliceMap", ax: Axes | None = None) -> Axes:
    """theta_min on a slice of the phase space with the exact falling set drawn over it."""
    ax = axes_or_new(ax)
    _colour_tilt(ax, found.x, found.y, found.theta_min)
    handles: list[Any] = []
    for distance, could, colour, name, edge_style in (
        (found.distance_plus, found.could_fall_plus, PLUS, "+", (0, (4, 4))),
        (found.distance_minus, found.could_fall_minus, MINUS, "-", (4, (4, 4))),
    ):
        falls = _zero_line(ax, found, distance, could, colour, _FALLS, 1.5)
        stays = _zero_line(ax, found, distance, ~could, colour, ":", 1.3)
        edge = bool(could.any() and not could.all())
        if edge:
            ax.contour(found.x, found.y, could, [0.5], colors=colour, linewidths=0.8, linestyles=[edge_style])
        for label, style, width, shown in (
            (rf"$F$, side ${name}$", _FALLS, 1.5, falls),
            (rf"$\eta_{name}=0$, no fall", ":", 1.3, stays),
            (rf"could fall: edge, ${name}$", (0, (4, 4)), 0.8, edge),
        ):
            if shown:
                handles.append(Line2D([], [], color=colour, ls=style, lw=width, label=label))
    if handles:
        legend(ax, handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2)
    fixed = ", ".join(f"{axis_label(key).split(' ')[0]} = {value:g}" for key, value in found.slice.fixed.items())
    first, second = found.slice.axes
    return dress(ax, axis_label(first), axis_label(second), f"Where the disk falls: slice {fixed}")


def _zero_line(
    ax: Axes, found: "SliceMap", distance: Array, mask: NDArray[np.bool_], colour: str, style: Any, width: float
) -> bool:
    """Draw distance = 0 where the mask holds; True if anything was drawn."""
    kept = np.where(mask, distance, np.nan)
    finite = kept[np.isfinite(kept)]
    if finite.size == 0 or finite.min() > 0.0 or finite.max() < 0.0:
        return False
    lines = ax.contour(found.x, found.y, kept, [0.0], colors=colour, linewidths=width, linestyles=[style])
    return any(np.size(path.vertices) for path in lines.get_paths())


def theta_min_distribution(theta: LogCounts, samples: int, ax: Axes | None = None) -> Axes:
    """Share of `samples` that come flatter than delta, and the slope one of codimension one."""
    ax = axes_or_new(ax)
    if not theta.counts.any():
        ax.text(0.5, 0.5, "no sample was computed", ha="center", transform=ax.transAxes, fontsize=TEXT)
        return dress(ax, r"$\delta$ (rad)", "share of samples")
    values, below = theta.cumulative()
    share = below / samples
    ax.loglog(values, share, color=PLUS, lw=2, label="samples")
    if theta.total > 100:
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
